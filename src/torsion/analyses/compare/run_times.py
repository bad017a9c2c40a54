"""Error against run time for one train: every model and discretisation of its shafts, every method of the response."""

import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import metadata
from math import pi
from typing import Any

import numpy as np

from torsion.analyses.compare.model_errors import over_peaks, relative_errors
from torsion.analyses.compare.shaft_divisions import (
    candidates,
    counted,
    doubled,
    loop_faults,
    lumped,
    plain,
    ready,
    reference,
)
from torsion.analyses.compare.timing import (
    FULL,
    QUICK,
    Candidate,
    Effort,
    TimedQuantity,
    Timings,
    timed,
)
from torsion.analyses.compare.torque_methods import (
    Harmonics,
    Loaded,
    dense,
    eliminated,
    elimination,
    loaded,
    solved,
    superposed,
)
from torsion.analyses.undamped_modes import Modes, modes
from torsion.arrays import BoolArray, ComplexArray
from torsion.assembly.system import System
from torsion.errors import InputError, SolveError
from torsion.findings import Progress, silent
from torsion.kernels.tree_response import NEAR_SINGULAR_LOSS, Status
from torsion.study import Study

TOLERANCE = 1e-3
NOTHING_TO_DIVIDE = (
    "No shaft of the train has inertia, so there is nothing to divide: lumped, fem and exact are one model, and its "
    "frequencies are right to rounding."
)
OWN_SEGMENTS = (
    "The `segments` that the file gives its shafts are not used: the study divides them itself."
)
SECTIONS = "Sections given by a mesh were solved beforehand and are not part of the time."
EPS = float(np.finfo(np.float64).eps)
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
LINES = 3  # that are compared: those with the largest torques
DEGREES = (1, 2, 4, 8)  # of finite elements, where there are many other methods
ELIMINATION, DENSE = "two-sided elimination", "dense solve"
MODAL, CORRECTED = "modal superposition", "modal superposition, static correction"
MEANING = (
    "The error is the error of the complex torque at an end of a shaft, in a coupling or in an elastic gear mesh. "
    "It is relative to the largest amplitude of this torque over the compared speeds; the worst of all torques "
    "counts. The torque at the end of a lumped shaft includes the last segment and the inertia of half a segment "
    "beyond."
)
ENCLOSED = (
    "Reference: the exact model in twice as many pieces. Its bound is the larger of half its certified enclosure, "
    "of the difference to the exact model in half as many pieces, and of the rounding unit."
)
DIVIDED = (
    "Reference: two-sided elimination of the exact model in twice as many pieces. Its bound is the larger of "
    "the difference to the exact model in half as many pieces and of the worst residual."
)
AS_GIVEN = (
    "Reference: two-sided elimination, whose error is therefore 0. Its bound is its worst residual. Every line is "
    f"`ok`: rounding changes it by at most {NEAR_SINGULAR_LOSS:g} of its value."
)
JOINTS = (
    f"{MODAL} without static correction is not drawn: joints excite, and the modes do not add up to the twist that a "
    "joint imposes."
)


def study_times(
    study: Study,
    *,
    highest: float = 0.0,
    count: int | None = None,
    no_response: str = "",
    tolerance: float = TOLERANCE,
    quick: bool = False,
    progress: Progress = silent,
) -> Timings:
    """Run times and errors of all methods, quantity by quantity.

    highest: Hz, of the requested response, 0 where none. count: requested modes, None for those up to
    `highest`. no_response: why there is no response to compare, '' where there is one. Raises InputError for
    shafts in a train with closed loops, of which there is no exact model, and SolveError.
    """
    if faults := loop_faults(study, ("links",)):
        raise InputError(faults)
    effort = QUICK if quick else FULL
    bare = plain(study)
    quantities, remarks = list[TimedQuantity](), list[str]()
    if bare.train.has_shafts:
        quantities.append(timed_frequencies(bare, highest, count, effort, progress))
    else:
        remarks.append(NOTHING_TO_DIVIDE)
    if no_response:
        remarks.append(f"No response is compared: {no_response}.")
    else:
        quantities.append(timed_torques(bare, highest, effort, progress))
    if any(bar.segments is not None and bar.density > 0 for bar in study.train.bars):
        remarks.append(OWN_SEGMENTS)
    if any(bar.section is not None for bar in study.train.bars):
        remarks.append(SECTIONS)
    return Timings(tolerance, tuple(quantities), tuple(remarks), effort.rounds, machine())


def timed_frequencies(
    study: Study, highest: float, count: int | None, effort: Effort, progress: Progress
) -> TimedQuantity:
    """Time the natural frequencies of a study in the exact model; highest: Hz of the response; count: of modes or None.

    Raises SolveError where the exact model cannot take the train.
    """
    coarse, fine = reference(study, highest, count)
    wanted = fine.frequency
    half = (fine.upper - fine.lower) / (2.0 * wanted)
    bound = max(
        float(half.max()), float(np.abs(relative_errors(coarse.frequency, wanted)).max()), EPS
    )

    def errors(solved_modes: Modes) -> tuple[float, ...]:
        return tuple(np.abs(relative_errors(solved_modes.frequency, wanted)).tolist())

    named = partial(Candidate, solve=partial(modes, count=len(wanted)), errors=errors)
    top = max(highest, float(wanted[-1]))
    curves = candidates(study.train, top, effort, effort.degrees, named)
    rows, remarks = timed(curves, effort, "natural frequencies", progress)
    number = len(wanted)
    which_modes = "the first elastic mode" if number == 1 else f"the first {number} elastic modes"
    meaning = (
        f"The error is the largest relative error of {which_modes}; the time includes shapes and torques. A discretisation "
        "with fewer modes has no error and is not drawn."
    )
    columns = tuple(f"mode {k + 1}, {f:.6g} Hz" for k, f in enumerate(wanted.tolist()))
    last = highest if count is None and highest > 0.0 else float(wanted[-1])
    return TimedQuantity(
        "frequencies", "Natural frequencies", meaning, ENCLOSED, bound, last, columns, rows, remarks
    )


def machine(
    packages: Sequence[str] = ("numpy", "scipy", "scikit-fem"),
) -> tuple[tuple[str, str], ...]:
    """Return on what the times were taken: system, threads, interpreter and the versions of packages."""
    threads = ", ".join(f"{name}={os.environ[name]}" for name in THREADS if name in os.environ)
    return (
        ("System", f"{platform.system()}, {platform.machine()}, {os.cpu_count()} processors"),
        ("Threads of the libraries", threads or "as they choose"),
        ("Python", platform.python_version()),
        *((name, _version(name)) for name in packages),
    )


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "absent"


@dataclass(frozen=True)
class _Case:
    study: Study
    harmonics: Harmonics
    wanted: list[ComplexArray]  # torques (speeds, ends) of every harmonic
    top: float  # Hz, what the shafts are divided for by themselves
    has_joints: bool

    def named(
        self,
        curve: str,
        words: str,
        size: int,
        assemble: Callable[[], System],
        solve: Callable[[Any], Any] = eliminated,
        finish: Callable[[Loaded], Any] | None = None,
    ) -> Candidate:
        """Return a candidate of which the loads, and what `finish` makes of them, are part of the assembly."""

        def made() -> Any:
            given = loaded(assemble(), self.harmonics)
            return given if finish is None else finish(given)

        return Candidate(curve, words, size, made, solve, partial(over_peaks, self.wanted))


def timed_torques(
    study: Study, highest: float, effort: Effort, progress: Progress
) -> TimedQuantity:
    """Time the response torques of a study in the exact model, or without shafts with inertia; highest: Hz excited.

    Raises SolveError where the exact model cannot take the train, or where no torque or no speed can be compared.
    """
    speeds = study.operation.speeds
    if speeds is None:
        raise SolveError("a response over speed needs the speeds; give `operation: speeds`")
    if study.train.has_shafts:  # as they are divided by themselves and twice as finely
        coarse, fine = (answers.system for answers in reference(study, highest, 1))
    else:
        coarse = fine = ready(study.train, "lumped")
    harmonics, lost = _sound(
        Harmonics(study, np.linspace(speeds.first, speeds.last, effort.speeds)), fine
    )
    given = loaded(fine, harmonics)
    if not given.ends.name:
        raise SolveError(
            "no elastic coupling, mesh or shaft carries a torque that could be compared"
        )
    answers = elimination(given)
    wanted = [answer.torque for answer in answers]
    lines = tuple(load.line.words for load in given.loads)
    has_joints = any(load.sources.twist is not None for load in given.loads)
    case = _Case(study, harmonics, wanted, max(given.highest, highest), has_joints)
    differences = over_peaks(wanted, eliminated(loaded(coarse, harmonics)))
    bound = max(*differences, *(float(answer.residual.max()) for answer in answers))
    rows, remarks = timed(_curves(case, effort), effort, "response", progress)
    rpm, number = (
        harmonics.speed * 30.0 / pi,
        "one line" if len(lines) == 1 else f"{len(lines)} lines",
    )
    compared = (
        f"Compared: {number} at {len(rpm)} speeds from {rpm[0]:.6g} to {rpm[-1]:.6g} rpm; the time is the sum over "
        "all speeds, sources and mean torque counted as assembly."
    )
    return TimedQuantity(
        "response",
        "Response torques",
        f"{MEANING} {compared}",
        DIVIDED if study.train.has_shafts else AS_GIVEN,
        bound,
        given.highest,
        lines,
        rows,
        (*lost, *((JOINTS,) if has_joints else ()), *remarks),
    )


def _sound(harmonics: Harmonics, system: System) -> tuple[Harmonics, tuple[str, ...]]:
    """Return the harmonics with the largest torques, at the speeds at which all of them have an answer to be trusted."""
    given = loaded(system, harmonics)
    answers = elimination(given)
    good: list[BoolArray] = [answer.status == Status.OK for answer in answers]
    size = [
        float(np.abs(answer.torque[is_good]).max(initial=0.0))
        for answer, is_good in zip(answers, good, strict=True)
    ]
    kept = sorted(sorted(range(len(size)), key=lambda k: -size[k])[:LINES])
    sound: BoolArray = np.all([good[k] for k in kept], axis=0)
    if not np.any(sound):
        raise SolveError(
            "at none of the compared speeds the response is beyond doubt; give the damping of the train"
        )
    keys = tuple((given.loads[k].line.order, given.loads[k].line.frequency) for k in kept)
    lost = int(np.count_nonzero(~sound))
    remark = (
        (f"{lost} of {len(sound)} speeds are omitted: an undamped train is in resonance there.",)
        if lost
        else ()
    )
    return replace(harmonics, speed=harmonics.speed[sound], keys=keys), remark


def _curves(case: _Case, effort: Effort) -> list[list[Candidate]]:
    train = case.study.train
    if not train.has_shafts:
        bare = partial(ready, train, "lumped")
        swept = case.named(ELIMINATION, "as given", 1, bare)
        return [
            [swept],
            *_superpositions(case, effort),
            [case.named(DENSE, "as given", 1, bare, solved, dense)],
        ]
    degrees = tuple(degree for degree in DEGREES if degree in effort.degrees)
    swept_curves = candidates(train, case.top, effort, degrees, case.named, ", elimination")
    dense_curve = lumped(
        train, effort.dense, f"lumped, {DENSE}", partial(case.named, solve=solved, finish=dense)
    )
    return [*swept_curves, *_superpositions(case, effort), dense_curve]


def _superpositions(case: _Case, effort: Effort) -> list[list[Candidate]]:
    """Return curves over modes of the exact model: the error is that of the superposition alone."""
    curves: list[list[Candidate]] = [[], []]
    system = ready(case.study.train, case.study.model, frequency=case.top)
    for count in doubled(effort.modes):
        solved_modes = modes(system, count)
        system = solved_modes.system
        if len(solved_modes.frequency) < count:
            break
        made = partial(
            ready,
            case.study.train,
            case.study.model,
            frequency=max(case.top, float(solved_modes.frequency[-1])),
        )
        for curve, name, is_corrected in zip(
            curves, (MODAL, CORRECTED), (False, True), strict=True
        ):
            if is_corrected or not case.has_joints:
                solve = partial(superposed, count=count, corrected=is_corrected)
                curve.append(case.named(name, counted(count, "mode"), count, made, solve))
    return [curve for curve in curves if curve]
