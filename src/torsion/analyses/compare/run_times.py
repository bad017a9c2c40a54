"""Error against run time for one train: every model, and every discretisation of its shafts."""

import os
import platform
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from importlib import metadata
from math import pi

import numpy as np

from torsion.analyses.compare.model_errors import (
    Loaded,
    Torques,
    candidates,
    loaded,
    loop_faults,
    over_peaks,
    plain,
    reference,
    relative_errors,
    response_torques,
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
from torsion.analyses.undamped_modes import Modes, modes
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.findings import Progress, silent
from torsion.kernels.trees.tree_response import Status
from torsion.study import Study

TOLERANCE = 1e-3
NOTHING_TO_DIVIDE = (
    "no shaft of the train has inertia, so there is nothing to divide: lumped, fem and exact are one model, and its "
    "frequencies are right to rounding"
)
OWN_SEGMENTS = (
    "The `segments` that the file gives its shafts are not used: the study divides them itself."
)
SECTIONS = "Sections given by a mesh were solved beforehand and are not part of the time."
EPS = float(np.finfo(np.float64).eps)
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
LINES = 3  # that are compared: those with the largest torques
MODES = (
    "The error is the largest relative error of the compared modes; the time includes shapes and torques. A "
    "discretisation with fewer modes has no error."
)
TORQUES = (
    "The error is the error of the complex torque at the driving end of a component, relative to the largest amplitude of "
    "this torque over the compared speeds; the worst of all torques counts. The torque of a lumped shaft is that of its "
    "first segment less the inertia torque of half a segment. The time is the sum over all speeds, sources and mean "
    "torque counted as assembly."
)
ENCLOSED = (
    "Reference: the exact model in twice as many pieces. Its bound is the larger of half its certified enclosure, "
    "of the difference to the exact model in half as many pieces, and of the rounding unit."
)
DIVIDED = (
    "Reference: the exact model in twice as many pieces. Its bound is the larger of the difference to the exact model in "
    "half as many pieces and of the worst residual."
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
    """Return run times and errors of all models and discretisations, quantity by quantity.

    highest: Hz, of the requested response, 0 where none. count: requested modes, None for those up to
    `highest`. no_response: why there is no response to compare, '' where there is one. Raises InputError for a train
    without shafts to divide and for shafts in a train with closed loops, of which there is no exact model, and
    SolveError.
    """
    if not study.train.has_shafts:
        raise InputError([Fault(("train",), NOTHING_TO_DIVIDE, "give a shaft its density")])
    if faults := loop_faults(study, ("links",)):
        raise InputError(faults)
    effort = QUICK if quick else FULL
    bare = plain(study)

    quantities = [timed_frequencies(bare, highest, count, effort, progress)]
    remarks = [f"No response is compared: {no_response}."] if no_response else []
    if not no_response:
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
    differences = np.abs(relative_errors(coarse.frequency, wanted))

    def errors(solved_modes: Modes) -> tuple[float, ...]:
        return tuple(np.abs(relative_errors(solved_modes.frequency, wanted)).tolist())

    named = partial(Candidate, solve=partial(modes, count=len(wanted)), errors=errors)
    curves = candidates(study.train, max(highest, float(wanted[-1])), effort, named)
    rows, remarks = timed(curves, effort, "natural frequencies", progress)
    return TimedQuantity(
        "frequencies",
        "Natural frequencies",
        MODES,
        ENCLOSED,
        max(float(half.max()), float(differences.max()), EPS),
        highest if count is None and highest > 0.0 else float(wanted[-1]),
        tuple(f"mode {k}, {f:.6g} Hz" for k, f in enumerate(wanted.tolist(), start=1)),
        rows,
        remarks,
    )


def machine(
    packages: Sequence[str] = ("numpy", "scipy", "scikit-fem"),
) -> tuple[tuple[str, str], ...]:
    """Return on what the times were taken: system, threads, interpreter and the versions of packages."""
    threads = ", ".join(f"{name}={os.environ[name]}" for name in THREADS if name in os.environ)
    versions = dict.fromkeys(packages, "absent")
    for name in packages:
        with suppress(metadata.PackageNotFoundError):
            versions[name] = metadata.version(name)
    return (
        ("System", f"{platform.system()}, {platform.machine()}, {os.cpu_count()} processors"),
        ("Threads of the libraries", threads or "as they choose"),
        ("Python", platform.python_version()),
        *versions.items(),
    )


def timed_torques(
    study: Study, highest: float, effort: Effort, progress: Progress
) -> TimedQuantity:
    """Time the response torques of a study in the exact model; highest: Hz excited.

    Raises SolveError where the exact model cannot take the train, or where no torque or no speed can be compared.
    """
    speeds = study.operation.speeds
    if speeds is None:
        raise SolveError("a response over speed needs the speeds; give `operation: speeds`")
    coarse, fine = (solved_modes.system for solved_modes in reference(study, highest, 1))
    speed = np.linspace(speeds.first, speeds.last, effort.speeds)
    # The harmonics with the largest torques, at speeds at which all of them have a solution to be trusted.
    solutions = response_torques(loaded(fine, study, speed))
    good = [solution.status == Status.OK for solution in solutions]
    sizes = [
        float(np.abs(solution.torque[is_good]).max(initial=0.0))
        for solution, is_good in zip(solutions, good, strict=True)
    ]
    largest = sorted(sorted(range(len(sizes)), key=lambda k: -sizes[k])[:LINES])
    is_sound = np.all([good[k] for k in largest], axis=0)
    if not np.any(is_sound):
        message = "at none of the compared speeds the response is beyond doubt; give the damping of the train"
        raise SolveError(message)
    speed = speed[is_sound]

    def load(assemble: Callable[[], System]) -> Loaded:
        given = loaded(assemble(), study, speed)
        return replace(given, loads=tuple(given.loads[k] for k in largest))

    given = load(lambda: fine)
    solutions = response_torques(given)
    wanted = [solution.torque for solution in solutions]

    def errors(torques: Sequence[Torques]) -> tuple[float, ...]:
        return over_peaks(wanted, [solution.torque for solution in torques])

    def named(curve: str, words: str, size: int, assemble: Callable[[], System]) -> Candidate:
        return Candidate(curve, words, size, partial(load, assemble), response_torques, errors)

    top = max(given.highest, highest)
    curves = candidates(study.train, top, effort, named)
    rows, remarks = timed(curves, effort, "response", progress)
    if lost := int(np.count_nonzero(~is_sound)):
        words = f"{lost} of {is_sound.size} speeds are omitted: an undamped train is in resonance there."
        remarks = (words, *remarks)
    first, last = speed[[0, -1]] * 30.0 / pi
    return TimedQuantity(
        "response",
        "Response torques",
        f"{TORQUES} {speed.size} speeds from {first:.6g} to {last:.6g} rpm.",
        DIVIDED,
        max(
            *errors(response_torques(load(lambda: coarse))),
            *(float(solution.residual.max()) for solution in solutions),
        ),
        given.highest,
        tuple(load.line.words for load in given.loads),
        rows,
        remarks,
    )
