"""Response torques of one train by every discretisation and every method: error against run time."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import pi
from typing import Any

import numpy as np

from torsion.analyses.compare.candidates import candidates, counted, doubled, has_shafts, lumped, ready, reference
from torsion.analyses.compare.dense_solve import dense, solved
from torsion.analyses.compare.frontier import TimedQuantity
from torsion.analyses.compare.loads import Harmonics, Loaded, eliminated, elimination, loaded
from torsion.analyses.compare.model_errors import over_peaks
from torsion.analyses.compare.superposition import superposed
from torsion.analyses.compare.timing import Candidate, Effort, timed
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.undamped_modes import modes
from torsion.arrays import BoolArray, ComplexArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress
from torsion.kernels.tree_response import NEAR_SINGULAR_LOSS, Status
from torsion.study import Study

LINES = 3  # that are compared: those with the largest torques
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
    wanted: list[ComplexArray]  # torques (speeds, ends) of every harmonic
    top: float  # Hz, what the shafts are divided for by themselves
    has_joints: bool

    def named(
        self, curve: str, words: str, size: int, assemble: Callable[[], System],
        solve: Callable[[Any], Any] = eliminated, finish: Callable[[Loaded], Any] | None = None,
    ) -> Candidate:  # fmt: skip
        """A candidate of which the loads, and what `finish` makes of them, are part of the assembly."""

        def made() -> Any:
            given = loaded(assemble(), self.harmonics)
            return given if finish is None else finish(given)

        return Candidate(curve, words, size, made, solve, partial(over_peaks, self.wanted))


def timed_torques(study: Study, highest: float, effort: Effort, progress: Progress) -> TimedQuantity:
    """study: in the exact model, or without shafts that have inertia; its operation has speeds. highest: Hz excited.

    Raises SolveError where the exact model cannot take the train, or where no torque or no speed can be compared.
    """
    speeds = study.operation.speeds
    if speeds is None:
        raise SolveError("a response over speed needs the speeds; give `operation: speeds`")
    coarse, fine = _references(study, highest)
    harmonics, lost = _sound(Harmonics(study, np.linspace(speeds.first, speeds.last, effort.speeds)), fine)
    given = loaded(fine, harmonics)
    if not given.ends.name:
        raise SolveError("no elastic coupling, mesh or shaft carries a torque that could be compared")
    found = elimination(given)
    wanted = [one.torque for one in found]
    lines = tuple(_words(load.line) for load in given.loads)
    has_joints = any(load.sources.twist is not None for load in given.loads)
    case = _Case(study, harmonics, wanted, max(given.highest, highest), has_joints)
    differences = over_peaks(wanted, eliminated(loaded(coarse, harmonics)))
    bound = max(*differences, *(float(one.residual.max()) for one in found))
    rows, remarks = timed(_curves(case, effort), effort, "response", progress)
    return TimedQuantity(
        "response", "Response torques", _meaning(harmonics, lines), _reference_words(study), bound, given.highest,
        lines, rows, (*lost, *((JOINTS,) if has_joints else ()), *remarks),
    )  # fmt: skip


def _references(study: Study, highest: float) -> tuple[System, System]:
    """The train as it is divided by itself and twice as finely; twice the same where there is nothing to divide."""
    if has_shafts(study.train):
        found = reference(study, highest, 1)
        return found.system, found.finer
    system = ready(study.train, "lumped")
    return system, system


def _sound(harmonics: Harmonics, system: System) -> tuple[Harmonics, tuple[str, ...]]:
    """The harmonics with the largest torques, at the speeds at which all of them have an answer to be trusted."""
    given = loaded(system, harmonics)
    found = elimination(given)
    good: list[BoolArray] = [one.status == Status.OK for one in found]
    size = [float(np.abs(one.torque[here]).max(initial=0.0)) for one, here in zip(found, good, strict=True)]
    kept = sorted(sorted(range(len(size)), key=lambda k: -size[k])[:LINES])
    sound: BoolArray = np.all([good[k] for k in kept], axis=0)
    if not np.any(sound):
        raise SolveError("at none of the compared speeds the response is beyond doubt; give the damping of the train")
    keys = tuple((given.loads[k].line.order, given.loads[k].line.frequency) for k in kept)
    lost = int(np.count_nonzero(~sound))
    remark = (f"{lost} of {len(sound)} speeds are left out: an undamped train is in resonance there.",) if lost else ()
    return replace(harmonics, speed=harmonics.speed[sound], keys=keys), remark


def _curves(case: _Case, effort: Effort) -> list[list[Candidate]]:
    train = case.study.train
    if not has_shafts(train):
        bare = partial(ready, train, "lumped")
        swept = case.named(ELIMINATION, "as given", 1, bare)
        return [[swept], *_superpositions(case, effort), [case.named(DENSE, "as given", 1, bare, solved, dense)]]
    degrees = tuple(degree for degree in DEGREES if degree in effort.degrees)
    swept_curves = candidates(train, case.top, effort, degrees, case.named, ", elimination")
    dense_curve = lumped(train, effort.dense, f"lumped, {DENSE}", partial(case.named, solve=solved, finish=dense))
    return [*swept_curves, *_superpositions(case, effort), dense_curve]


def _superpositions(case: _Case, effort: Effort) -> list[list[Candidate]]:
    """Modes of the exact model: its error is that of the superposition alone."""
    curves: list[list[Candidate]] = [[], []]
    system = ready(case.study.train, case.study.model, frequency=case.top)
    for count in doubled(effort.modes):
        found = modes(system, count)
        system = found.system
        if len(found.frequency) < count:
            break
        made = partial(ready, case.study.train, case.study.model, frequency=max(case.top, float(found.frequency[-1])))
        for curve, name, is_corrected in zip(curves, (MODAL, CORRECTED), (False, True), strict=True):
            if is_corrected or not case.has_joints:
                solve = partial(superposed, count=count, corrected=is_corrected)
                curve.append(case.named(name, counted(count, "mode"), count, made, solve))
    return [curve for curve in curves if curve]


def _words(line: Line) -> str:
    what = f"order {line.order}" if line.order is not None else f"{line.frequency:g} Hz"
    return f"{what} ({', '.join(line.sources)})"


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
