"""The models of one train side by side: frequencies, shapes and response torques of each against the exact model."""

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Annotated, Literal, get_args

import numpy as np

from torsion.analyses.compare.model_errors import (
    COUNT,
    Loaded,
    Torques,
    loaded,
    loop_faults,
    over_largest,
    relative_errors,
    response_torques,
    shape_errors,
)
from torsion.analyses.compare.timing import Candidate, run
from torsion.analyses.discretisation import assembled, discretisation_words
from torsion.analyses.response.harmonic_components import excitations
from torsion.analyses.response.over_speed import requested_orders
from torsion.analyses.undamped_modes import Modes, modes, modes_as_discretised, undamped_tree
from torsion.arrays import FloatArray
from torsion.assembly import SHARE_OF_ERROR
from torsion.assembly.segments import bar_segments
from torsion.assembly.system import System
from torsion.errors import InputError
from torsion.fields import Declared, Quantity, given, refuse
from torsion.findings import Progress, Work, silent
from torsion.kernels.trees.tree_response import Status
from torsion.results import derived, reported, result
from torsion.study import Study

Model = Literal["lumped", "fem", "exact"]
TORQUE_FACTOR = 10.0  # error of a torque over that of a frequency in a shaft divided for the highest excited frequency
SAME_WITHOUT_SHAFTS = "No shaft of this train has inertia: all models are the same."


class CheckSettings(Declared):
    """Settings of `check`."""

    models: tuple[Model, ...] | None = given(
        "the models compared with the exact one (default: all)"
    )
    tolerance: Annotated[float, Quantity("1", above=0, usual="tolerance")] = given(
        "largest relative error of frequencies and shapes (1 - MAC); default: what the lumped model promises",
        SHARE_OF_ERROR,
    )
    torque_tolerance: Annotated[float, Quantity("1", above=0, usual="tolerance")] | None = given(
        f"largest relative error of torques; default: {TORQUE_FACTOR:g} times `tolerance`, as the lumped model promises"
    )

    def refuse_clashes(self) -> None:
        """Refuse to compare the exact model with itself alone."""
        if self.models is not None and not set(self.models) - {"exact"}:
            raise refuse(
                "every error is one against the exact model", "name lumped or fem too", "models"
            )


@reported
class TorquesCompared:
    """How far a model is from the exact one: in the norm of the largest torque of any end, at each speed and order.

    Both are compared equally far from their own resonances: peaks with peaks.
    """

    error: FloatArray = result("1", "speed", "relative, the largest of all orders; null if unknown")
    largest: float  # of all; NaN where there is none
    worst_speed: int | None = result("position of the speed of the largest error, or null")
    worst_order: Fraction | None = result("its order of the reference, or null")
    worst_frequency: float | None = result("Hz", "its fixed frequency, or null")
    component: str = result("component of the largest error", key="worst_component")
    left_out: int = result("speeds and orders at which a model has no reliable solution")


@reported
class ModelCompared:
    """One model of the train and its errors, all relative and against the exact model."""

    model: str = result("exact (first), lumped or fem")
    division: str = result("segments, elements or pieces of the shafts, in words")
    certified: bool = result("counts prove the frequencies", key="is_certified")
    frequency: FloatArray = result("Hz", "mode", "null if the model has no such mode")
    frequency_error: FloatArray = result("1", "mode", "signed; null if the model has no such mode")
    shape_error: FloatArray = (
        result(  # infinite where it has no such mode, NaN where no station has a shape
            "1",
            "mode",
            "1 - MAC at the stations of the train, weighted by inertia; null for none",
        )
    )
    below: int = result("elastic modes below `check.highest_Hz`", key="modes_below")
    torques: TorquesCompared | None = result("of the response; null if not compared")
    modes_seconds: float = result("s", "time of assembly and modes", key="modes_seconds")
    torques_seconds: float = result(
        "s", "time of the response torques; 0 without a response", key="torques_seconds"
    )
    tolerances: tuple[float, float, float]  # of frequencies, shapes and torques

    @derived("1", "magnitude; null if a mode is missing")
    def largest_frequency_error(self) -> float:
        """The largest error of a natural frequency; NaN if there is none."""
        return float(np.fmax.reduce(np.abs(self.frequency_error), initial=math.nan))

    @derived("1", "null if a mode is missing or no shape could be compared")
    def largest_shape_error(self) -> float:
        """The largest error of a mode shape, 1 - MAC; NaN if there is none."""
        return float(np.fmax.reduce(self.shape_error, initial=math.nan))

    @derived("1", "null if no torque was compared")
    def largest_torque_error(self) -> float:
        """The largest error of the response torques; NaN if there is none."""
        return math.nan if self.torques is None else self.torques.largest

    @property
    def largest(self) -> tuple[float, float, float]:
        """Largest error of a frequency, of a shape and of the torques; NaN where there is none."""
        return self.largest_frequency_error, self.largest_shape_error, self.largest_torque_error

    @derived("no error exceeds the tolerance")
    def passes(self) -> bool:
        """Whether frequencies, shapes and torques are within their tolerances."""
        return not any(
            error > limit for error, limit in zip(self.largest, self.tolerances, strict=True)
        )


@reported
class Compared:
    """The models side by side; `exact` is what the others are compared with."""

    tolerance: float = result("largest relative error of frequencies and shapes that passes")
    torque_tolerance: float = result("largest relative error of torques that passes")
    exact: ModelCompared | None = None
    models: tuple[ModelCompared, ...] = ()
    highest: float = result(  # between the last mode compared and the next
        "Hz",
        "frequency below which modes are counted, between the last mode compared and the next",
        default=0.0,
    )
    speed: FloatArray | None = result(
        "rad/s", "speed", "reference speeds at which torques are compared, or null", default=None
    )
    same: str = result("why all models are the same; empty if they were compared", default="")
    no_torques: str = result("why no torques were compared", default="")

    @derived("models with an error above the tolerance")
    def failed(self) -> tuple[str, ...]:
        """The names of the models that exceed the tolerance."""
        return tuple(model.model for model in self.models if not model.passes)

    @derived(
        "every model with its errors, which are relative and against the exact one",
        key="models",
    )
    def all_models(self) -> tuple[ModelCompared, ...]:
        """Every model, the exact one first."""
        return () if self.exact is None else (self.exact, *self.models)

    @property
    def fails(self) -> bool:
        """A model is not within the tolerance."""
        return bool(self.failed)


def check(
    study: Study, requested: CheckSettings | None = None, *, progress: Progress = silent
) -> Compared:
    """Return every requested model against the exact one, for the modes and the orders that the study says.

    Raises InputError for closed loops, SolveError where a model cannot take the train.
    """
    settings = requested or CheckSettings()
    # Of frequencies and shapes, and of torques.
    limits = settings.tolerance, settings.torque_tolerance or TORQUE_FACTOR * settings.tolerance
    if not study.train.has_shafts:
        return Compared(*limits, same=SAME_WITHOUT_SHAFTS)
    if faults := loop_faults(study, ("links",)):
        raise InputError(faults)
    count = getattr(study.analyses.get("modes"), "count", COUNT)
    speed, top, lacking = operating_speeds(study, assembled(replace(study, model="lumped")))
    requested_models = settings.models or get_args(Model)
    names = [name for name in get_args(Model) if name in requested_models and name != "exact"]
    progress("check: exact", 0.0)
    exact = _solved(replace(study, model="exact"), count, top, speed)
    excited = _frequencies(exact.modes, _count_below(exact.modes, top))
    solutions = [exact]
    for position, name in enumerate(names, start=1):
        progress(f"check: {name}", position / (len(names) + 1))
        solutions.append(_solved(replace(study, model=name), count, top, speed, excited))
    highest = math.sqrt(exact.modes.frequency[count - 1] * exact.modes.frequency[count])
    compared = [_compared(solution, exact, count, highest, limits) for solution in solutions]
    return Compared(*limits, compared[0], tuple(compared[1:]), highest, speed, "", lacking)


def operating_speeds(study: Study, system: System) -> tuple[FloatArray | None, float, str]:
    """Return the requested speeds (speeds,) rad/s and the highest frequency (Hz) of the requested orders at them.

    None, 0 and why where no torques can be compared.
    """
    speeds = study.operation.speeds
    orders = requested_orders(study)
    if not excitations(system, orders):
        return None, 0.0, "nothing excites the train at an order or a fixed frequency"
    if speeds is None:
        return None, 0.0, "`operation` says no speeds"
    try:
        highest = loaded(system, study, np.array([speeds.first, speeds.last]), orders).highest
    except InputError as error:
        return None, 0.0, "; ".join(fault.message for fault in error.faults)
    return speeds.values(), highest, ""


@dataclass(frozen=True)
class _Solved:
    """A model with one mode more than is compared, and its torques."""

    modes: Modes
    loaded: Loaded | None
    torques: list[Torques]
    modes_seconds: float
    torques_seconds: float


def _solved(
    study: Study,
    count: int,
    top: float,
    speed: FloatArray | None,
    exact: FloatArray | None = None,
) -> _Solved:
    """Return the modes and torques of a model, its shafts divided as a study of that model alone would have it.

    exact: natural frequencies (modes,) Hz of the exact model, all of those that are excited; None of that model itself.
    Both models are compared as far from resonance as each other: how far resonances lie apart is the error of the
    frequency, which at one speed would count once more, over half the width of the peak. Between two natural
    frequencies the ratio of both models goes from that of the one to that of the other.
    """

    def solve(solved_modes: Modes) -> tuple[Modes, Loaded | None, list[Torques]]:
        if speed is None:
            return solved_modes, None, []
        given = loaded(solved_modes.system, study, speed, requested_orders(study))
        if exact is not None:
            frequency = _frequencies(solved_modes, exact.size)
            number = min(frequency.size, exact.size)
            ratio = frequency[:number] / exact[:number]
            exact_w = 2.0 * math.pi * exact[:number]
            loads = (
                replace(load, w=load.w * np.interp(load.w, exact_w, ratio)) for load in given.loads
            )
            given = replace(given, loads=tuple(loads)) if number else given
        return solved_modes, given, response_torques(given)

    modes(assembled(study, 0.0), 1)  # imports what the model needs, which is no time of its own
    candidate = Candidate(
        study.model, "", 0, lambda: modes(assembled(study, top), count + 1), solve, lambda _: ()
    )
    (solved_modes, given, torques), modes_seconds, torques_seconds = run(candidate)
    seconds = modes_seconds, 0.0 if speed is None else torques_seconds
    return _Solved(solved_modes, given, torques, *seconds)


def _frequencies(solved_modes: Modes, number: int) -> FloatArray:
    """Return the natural frequencies (modes,) Hz of a model, so many at least where it has them."""
    if number <= solved_modes.frequency.size:
        return solved_modes.frequency
    return modes_as_discretised(solved_modes.system, number).frequency


def _compared(
    model: _Solved, exact: _Solved, count: int, highest: float, limits: tuple[float, float]
) -> ModelCompared:
    system = model.modes.system
    train = exact.modes.system.train
    known_modes = min(count, model.modes.frequency.size)
    own_stations = len(train.stations)
    frequency = np.full(count, math.nan)
    shape = np.full(count, math.inf)
    frequency[:known_modes] = model.modes.frequency[:known_modes]
    # Inertias, and at either end of a shaft the half next to it: the same for every model of a train.
    weights = np.zeros(own_stations)
    for lump in train.inertias:
        weights[lump.station] += lump.inertia
    for bar in train.bars:
        weights[[bar.driving, bar.driven]] += bar_segments(bar, 1)[1]
    weights[exact.modes.system.held[:own_stations]] = 0.0
    shape[:known_modes] = shape_errors(
        model.modes.shape[:own_stations, :known_modes],
        exact.modes.shape[:own_stations],
        exact.modes.frequency,
        weights,
    )
    torques = None
    if model.loaded is not None and exact.loaded is not None:
        torques = _torques(model, exact, exact.loaded)
    return ModelCompared(
        system.model,
        discretisation_words(system),
        model.modes.certified,
        frequency,
        relative_errors(frequency[:known_modes], exact.modes.frequency[:count]),
        shape,
        _count_below(model.modes, highest),
        torques,
        model.modes_seconds,
        model.torques_seconds,
        (limits[0], *limits),
    )


def _torques(compared: _Solved, exact: _Solved, given: Loaded) -> TorquesCompared:
    """Return the relative difference at every speed and order, where both answers can be trusted."""
    # referred to the reference speed, so that the torques of all ends are of one size
    ratio = given.system.span_ratio[given.ends.span]
    models = compared.torques, exact.torques
    torques, wanted = (np.array([line.torque * ratio for line in lines]) for lines in models)
    uncertain = np.any([[line.status != Status.OK for line in lines] for lines in models], axis=0).T
    errors = [over_largest(*pair) for pair in zip(torques, wanted, strict=True)]
    error = np.array(errors).T  # (speeds, lines)
    error[uncertain] = np.nan
    over_lines = np.fmax.reduce(error, axis=1)
    left_out = int(np.count_nonzero(uncertain))
    if np.isnan(error).all():
        return TorquesCompared(over_lines, math.nan, None, None, None, "", left_out)
    speed, row = (int(position) for position in np.unravel_index(np.nanargmax(error), error.shape))
    end = int(np.argmax(np.abs(torques[row, speed] - wanted[row, speed])))
    line = given.loads[row].line
    largest = float(error[speed, row])
    return TorquesCompared(
        over_lines, largest, speed, line.order, line.frequency, given.ends.name[end], left_out
    )


def _count_below(solved_modes: Modes, highest: float) -> int:
    """Return the number of elastic modes below a frequency (Hz), by counts if these reach so far."""
    tree = undamped_tree(solved_modes.system)
    w = 2.0 * math.pi * highest
    if tree.shafts is None:
        from torsion.kernels.modes.natural_modes import count_below

        return int(count_below(tree, w)[0]) - solved_modes.rigid
    from torsion.analyses.modes.mode_nodes import reach

    reached = reach(tree, w)
    if reached.frequency >= w:
        return reached.count
    return int(np.count_nonzero(solved_modes.frequency < highest))


def run_check(work: Work) -> None:
    """Return the models of the shafts side by side."""
    with work.log.step("comparison of the models", "requested") as step:
        settings = work.settings("check", CheckSettings)
        comparison = check(work.study, settings, progress=work.progress)
        names = ", ".join(model.model for model in comparison.all_models)
        step.method = names or "all models are the same"
        step.size = "; ".join(f"{model.model}: {model.division}" for model in comparison.all_models)
    if comparison.no_torques:
        work.log.without("comparison of response torques", comparison.no_torques)
    work.put(check=comparison)
