"""The models of one train side by side: frequencies, shapes and response torques of each against the exact model."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, Self, get_args

import numpy as np
from pydantic import model_validator

from torsion import fields
from torsion.analyses.check.shapes import shape_errors, shape_weights
from torsion.analyses.check.torques import Torques, TorquesCompared, compared_torques, end_torques, operating_speeds
from torsion.analyses.division import assembled, divided_modes, told_division
from torsion.analyses.modes import Modes, undamped_tree
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path
from torsion.fields import Declared, given, refuse
from torsion.kernels.tree import FloatArray
from torsion.study import Study

Model = Literal["lumped", "fem", "exact"]
Progress = Callable[[str, float], None]  # (what, share done 0..1)
COUNT = 6  # elastic modes compared where the file does not say how many
SAME_WITHOUT_SHAFTS = "No shaft of this train has an inertia of its own: all models of it are the same."


class Asked(Declared):
    """Settings of `check`."""

    models: tuple[Model, ...] | None = given("the models compared with the exact one (default: all)")
    tolerance: fields.Number = given("largest relative error of frequencies, shapes (1 - MAC) and torques", 1e-3)

    @model_validator(mode="after")
    def _compares(self) -> Self:
        if self.models is not None and not set(self.models) - {"exact"}:
            raise refuse("every error is one against the exact model", "name lumped or fem too", "models")
        return self


@dataclass(frozen=True)
class ModelCompared:
    """One model of the train and its errors, all relative and against the exact model."""

    model: str
    division: str  # segments, elements or pieces of every shaft, in words
    certified: bool  # counts prove its frequencies
    frequency: FloatArray  # (modes,) Hz; NaN where the model has no such mode
    frequency_error: FloatArray  # (modes,) signed; infinite where the model has no such mode
    shape_error: FloatArray  # (modes,) 1 - MAC; infinite where it has no such mode, NaN where no station tells a shape
    below: int  # elastic modes below `Compared.highest`
    torques: TorquesCompared | None
    modes_seconds: float  # assembly and modes
    torques_seconds: float  # response torques; 0 where there are none

    @property
    def mac(self) -> FloatArray:
        """(modes,) modal assurance criterion, 1 for the shape of the exact model; 0 where there is no such mode."""
        return np.maximum(1.0 - self.shape_error, 0.0)

    @property
    def largest(self) -> tuple[float, float, float]:
        """Largest error of a frequency, of a shape and of the torques; NaN where there is none."""
        torque = math.nan if self.torques is None else self.torques.largest
        return _largest(np.abs(self.frequency_error)), _largest(self.shape_error), torque

    def passes(self, tolerance: float) -> bool:
        """No error exceeds the tolerance."""
        return not any(error > tolerance for error in self.largest)


@dataclass(frozen=True)
class Compared:
    """The models side by side; `exact` is what the others are held against."""

    tolerance: float
    exact: ModelCompared | None = None
    models: tuple[ModelCompared, ...] = ()
    highest: float = 0.0  # Hz, between the last mode compared and the next, below which modes are counted
    speed: FloatArray | None = None  # (speeds,) rad/s of the reference station, at which torques are compared
    same: str = ""  # why all models are the same; empty where they were compared
    no_torques: str = ""  # why no torques were compared

    @property
    def failed(self) -> tuple[str, ...]:
        """The models whose errors exceed the tolerance."""
        return tuple(found.model for found in self.models if not found.passes(self.tolerance))


def loop_faults(study: Study, path: Path) -> list[Fault]:
    """Why there is no exact model of a train: its closed loops."""
    closed = any(part.path[0] == "links" for part in study.train.parts)
    if not closed or not has_distributed(study):
        return []
    message = "errors are against the exact model, which takes no closed loops, and `links` closes one"
    return [Fault(path, message, "leave `links` or the check out")]


def has_distributed(study: Study) -> bool:
    """Some shaft has an inertia of its own."""
    return any(bar.density > 0 for bar in study.train.bars)


def check(study: Study, asked: Asked | None = None, *, progress: Progress | None = None) -> Compared:
    """Every model asked for against the exact one, for the modes and the orders that the study says.

    Raises InputError for closed loops, SolveError where a model cannot take the train.
    """
    settings, tell = asked or Asked(), progress or (lambda what, share: None)
    if not has_distributed(study):
        return Compared(settings.tolerance, same=SAME_WITHOUT_SHAFTS)
    faults = loop_faults(study, ("links",))
    if faults:
        raise InputError(faults)
    count = getattr(study.analyses.get("modes"), "count", COUNT)
    speed, lacking = operating_speeds(study, assembled(replace(study, model="lumped")))
    names = [name for name in get_args(Model) if name != "exact" and name in (settings.models or get_args(Model))]
    tell("check: exact", 0.0)
    exact = _solved(study, "exact", count, speed)
    found = [exact]
    for place, name in enumerate(names, start=1):
        tell(f"check: {name}", place / (len(names) + 1))
        found.append(_solved(study, name, count, speed))
    highest = _between(exact.modes.frequency, count)
    compared = [_compared(one, exact, count, highest) for one in found]
    return Compared(settings.tolerance, compared[0], tuple(compared[1:]), highest, speed, "", lacking)


@dataclass(frozen=True)
class _Solved:
    """A model with one mode more than is compared, and its torques."""

    system: System
    modes: Modes
    torques: Torques | None
    modes_seconds: float
    torques_seconds: float


def _solved(study: Study, model: Model, count: int, speed: FloatArray | None) -> _Solved:
    """The modes and torques of one model, its shafts divided as a study of that model alone would have it."""
    own = replace(study, model=model)
    coarse = divided_modes(own, assembled(own), 0.0, 1)[0]  # imports what the model needs, which is no time of its own
    top = 0.0 if speed is None else _highest(study, coarse, speed)
    start = time.perf_counter()
    system, modes = divided_modes(own, assembled(own, top), top, count + 1)
    middle = time.perf_counter()
    torques = None if speed is None else end_torques(study, system, speed)
    return _Solved(system, modes, torques, middle - start, 0.0 if speed is None else time.perf_counter() - middle)


def _highest(study: Study, system: System, speed: FloatArray) -> float:
    from torsion.analyses.check.torques import frequencies

    return float(frequencies(study, system, speed[-1:]).max(initial=0.0))


def _between(frequency: FloatArray, count: int) -> float:
    """A frequency (Hz) between the mode `count` and the next."""
    return float(math.sqrt(frequency[count - 1] * frequency[count]))


def _compared(one: _Solved, exact: _Solved, count: int, highest: float) -> ModelCompared:
    known = min(count, one.modes.frequency.size)
    frequency, error = np.full(count, math.nan), np.full(count, math.inf)
    reference = exact.modes.frequency[:count]
    frequency[:known] = one.modes.frequency[:known]
    error[:known] = (frequency[:known] - reference[:known]) / reference[:known]
    shape = np.full(count, math.inf)
    weights, own = shape_weights(exact.system), len(exact.system.train.stations)
    shape[:known] = shape_errors(one.modes.shape[:own, :known], exact.modes.shape[:own], exact.modes.frequency, weights)
    torques = None
    if one.torques is not None and exact.torques is not None:
        torques = compared_torques(one.torques, exact.torques)
    return ModelCompared(
        one.system.model, told_division(one.system), one.modes.certified, frequency, error, shape,
        _count_below(one, highest), torques, one.modes_seconds, one.torques_seconds,
    )  # fmt: skip


def _count_below(one: _Solved, highest: float) -> int:
    """Elastic modes below a frequency (Hz), by counts where these reach so far."""
    tree, bars, w = undamped_tree(one.system.folded), one.system.folded_bars, 2.0 * math.pi * highest
    if bars is None:
        from torsion.kernels.sturm import count_below

        return int(count_below(tree, w)[0]) - one.modes.rigid
    from torsion.analyses.bars import reach

    known = reach(tree, bars, w)
    return known.count if known.frequency >= w else int(np.count_nonzero(one.modes.frequency < highest))


def _largest(errors: FloatArray) -> float:
    """NaN where there is no number."""
    known = errors[~np.isnan(errors)]
    return float(known.max()) if known.size else math.nan
