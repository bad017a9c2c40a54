"""Response torques of one train by every division and every method: error against run time."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import pi
from typing import Any

import numpy as np

from torsion.analyses.division import divided_modes
from torsion.analyses.response.solver import Answer, answer
from torsion.analyses.study.dense import dense, solved
from torsion.analyses.study.division import divided, divisions, has_shafts, ready, reference
from torsion.analyses.study.loads import LINES, Harmonics, Loaded, eliminated, errors, loaded
from torsion.analyses.study.modal import superposed
from torsion.analyses.study.rows import TimedQuantity
from torsion.analyses.study.timing import Effort, Method, Progress, timed
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.tree import BoolArray, ComplexArray
from torsion.kernels.tree_response import NEAR_SINGULAR_LOSS, Status
from torsion.study import Study

DEGREES = (1, 2, 4, 8)  # of finite elements, where there are many other methods
ELIMINATION, DENSE = "two-sided elimination", "dense solve"
MODAL, CORRECTED = "modal superposition", "modal superposition, static correction"
MEANING = (
    "The error is that of the complex torque at an end of a shaft, in a coupling or in an elastic gear mesh, relative "
    "to the largest amplitude of that torque over the compared speeds; the worst of all torques counts. Where "
    "a shaft is lumped, the torque at its end is that of the last segment and of the inertia of half a segment beyond."
)
JOINTS = (
    f"{MODAL} without static correction is not drawn: joints excite, and modes alone do not add up to the twist that "
    "a joint imposes."
)


@dataclass(frozen=True)
class _Case:
    study: Study
    harmonics: Harmonics
    wanted: list[ComplexArray]  # torques (speeds, probes) of every line
    top: float  # Hz, what the shafts are divided for by themselves
    lines: tuple[str, ...]
    has_joints: bool

    def method(
        self, curve: str, words: str, size: int, made: Callable[[], System], solve: Callable[[Any], Any],
        finish: Callable[[Loaded], Any] | None = None,
    ) -> Method:  # fmt: skip
        """A method of which the loads, and what `finish` makes of them, are part of the assembly."""

        def assemble() -> Any:
            given = loaded(made(), self.harmonics)
            return given if finish is None else finish(given)

        return Method(curve, words, size, assemble, solve, partial(errors, self.wanted))


def timed_response(study: Study, highest: float, effort: Effort, progress: Progress) -> TimedQuantity:
    """study: in the exact model, or without shafts that have inertia; its operation has speeds. highest: Hz excited.

    Raises SolveError where the exact model cannot take the train, or where no torque or no speed can be compared.
    """
    speeds = study.operation.speeds
    if speeds is None:
        raise SolveError("a response over speed needs the speeds; give `operation: speeds`")
    harmonics = Harmonics(study, np.linspace(speeds.first, speeds.last, effort.speeds))
    coarse, fine = _references(study, highest)
    harmonics, lost = _sound(harmonics, fine)
    given = loaded(fine, harmonics)
    if not given.probes.name:
        raise SolveError("no elastic coupling, mesh or shaft carries a torque that could be compared")
    wanted = eliminated(given)
    top = max(float(load.w.max()) for load in given.loads) / (2.0 * pi)
    lines = tuple(_told(load.line.order, load.line.frequency, load.line.sources) for load in given.loads)
    has_joints = any(load.sources.twist is not None for load in given.loads)
    case = _Case(study, harmonics, wanted, max(top, highest), lines, has_joints)
    bound = _bound(errors(wanted, eliminated(loaded(coarse, harmonics))), fine, harmonics)
    rows, remarks = timed(_curves(case, effort), effort, "response", progress)
    return TimedQuantity(
        "response", "Response torques", _meaning(harmonics, lines), _reference_words(study), bound, top, lines, rows,
        (*lost, *((JOINTS,) if has_joints else ()), *remarks),
    )  # fmt: skip


def _references(study: Study, highest: float) -> tuple[System, System]:
    """The train as it is divided by itself and twice as finely; twice the same where there is nothing to divide."""
    if has_shafts(study.train):
        found = reference(study, highest, 1)
        return found.system, found.finer
    system = ready(study.train, "lumped")
    return system, system


def _sound(harmonics: Harmonics, system: System) -> tuple[Harmonics, tuple[str, ...]]:
    """The lines with the largest torques, at the speeds at which all of them have an answer to be trusted."""
    given = loaded(system, harmonics)
    found = [answer(system, load.w, load.sources, load.ground) for load in given.loads]
    size = [_largest(given, k, one) for k, one in enumerate(found)]
    kept = sorted(sorted(range(len(size)), key=lambda k: -size[k])[:LINES])
    sound: BoolArray = np.all([found[k].status == Status.OK for k in kept], axis=0)
    if not np.any(sound):
        raise SolveError("at none of the compared speeds the response is beyond doubt; give the damping of the train")
    keys = tuple((given.loads[k].line.order, given.loads[k].line.frequency) for k in kept)
    lost = int(np.count_nonzero(~sound))
    remark = (f"{lost} of {len(sound)} speeds are left out: an undamped train is in resonance there.",) if lost else ()
    return replace(harmonics, speed=harmonics.speed[sound], keys=keys), remark


def _largest(given: Loaded, number: int, found: Answer) -> float:
    """The largest torque of a line, N m."""
    torque = np.abs(given.probes.torque(given.loads[number].w, found.angle, found.torque))
    return float(torque[found.status == Status.OK].max(initial=0.0))


def _bound(differences: tuple[float, ...], fine: System, harmonics: Harmonics) -> float:
    """The larger of the difference of both exact divisions and the worst residual, relative."""
    residuals = [
        answer(fine, load.w, load.sources, load.ground).residual.max() for load in loaded(fine, harmonics).loads
    ]
    return max(*differences, float(np.max(residuals)))


def _curves(case: _Case, effort: Effort) -> list[list[Method]]:
    curves = []
    if has_shafts(case.study.train):
        degrees = tuple(degree for degree in DEGREES if degree in effort.degrees)
        for curve in divisions(case.study.train, case.top, effort, degrees):
            curves.append([
                case.method(f"{name}, elimination", words, size, made, eliminated) for name, words, size, made in curve
            ])  # fmt: skip
    else:
        curves.append([case.method(ELIMINATION, "as given", 1, partial(ready, case.study.train, "lumped"), eliminated)])
    return [*curves, *_superpositions(case, effort), _dense(case, effort)]


def _superpositions(case: _Case, effort: Effort) -> list[list[Method]]:
    """Modes of the exact model: its error is that of the superposition alone."""
    curves: list[list[Method]] = [[], []]
    system = ready(case.study.train, case.study.model, frequency=case.top)
    for count in (2**k for k in range(effort.modes.bit_length())):
        system, found = divided_modes(case.study, system, case.top, count)
        if len(found.frequency) < count:
            break
        top = max(case.top, float(found.frequency[-1]))
        made = partial(ready, case.study.train, case.study.model, frequency=top)
        words = f"{count} mode{'s' if count > 1 else ''}"
        if not case.has_joints:
            plain = partial(superposed, count=count, corrected=False)
            curves[0].append(case.method(MODAL, words, count, made, plain))
        corrected = partial(superposed, count=count, corrected=True)
        curves[1].append(case.method(CORRECTED, words, count, made, corrected))
    return [curve for curve in curves if curve]


def _dense(case: _Case, effort: Effort) -> list[Method]:
    """`numpy.linalg.solve` of the lumped model."""
    if not has_shafts(case.study.train):
        return [case.method(DENSE, "as given", 1, partial(ready, case.study.train, "lumped"), solved, dense)]
    numbers = [2**k for k in range(effort.dense.bit_length())]
    return [
        case.method(f"lumped, {DENSE}", f"{n} segment{'s' if n > 1 else ''}", n,
                    partial(ready, divided(case.study.train, n), "lumped"), solved, dense)
        for n in numbers
    ]  # fmt: skip


def _told(order: Any, frequency: float | None, names: tuple[str, ...]) -> str:
    what = f"order {order}" if order is not None else f"{frequency:g} Hz"
    return f"{what} ({', '.join(names)})"


def _meaning(harmonics: Harmonics, lines: tuple[str, ...]) -> str:
    speed = harmonics.speed * 30.0 / pi
    lines_of = f"{len(lines)} lines" if len(lines) > 1 else "one line"
    return (
        f"{MEANING} Compared: {lines_of} at {len(speed)} speeds from {speed[0]:.6g} to {speed[-1]:.6g} rpm; the time "
        "is that of all of them together, sources and mean torque counted as assembly."
    )


def _reference_words(study: Study) -> str:
    if has_shafts(study.train):
        return (
            "Reference: two-sided elimination of the exact model in twice as many pieces. Its bound is the larger of "
            "the difference to the exact model in half as many pieces and of the worst residual."
        )
    return (
        "Reference: two-sided elimination itself, whose error is given as 0 for that reason; its bound is its worst "
        f"residual, and every line is `ok`: rounding moves it by at most {NEAR_SINGULAR_LOSS:g} of itself."
    )
