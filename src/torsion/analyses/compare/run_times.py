"""Error against run time for one train: every model and discretisation of its shafts, every method of the response."""

import os
import platform
from collections.abc import Sequence
from functools import partial
from importlib import metadata

import numpy as np

from torsion.analyses.compare.candidates import candidates, has_shafts, loop_fault, plain, reference
from torsion.analyses.compare.frontier import TimedQuantity, Timings
from torsion.analyses.compare.model_errors import relative_errors
from torsion.analyses.compare.timed_torques import timed_torques
from torsion.analyses.compare.timing import FULL, QUICK, Candidate, Effort, timed
from torsion.analyses.undamped_modes import Modes, modes
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.findings import Progress, silent
from torsion.study import Study

TOLERANCE = 1e-3
NOTHING_TO_DIVIDE = (
    "No shaft of the train has inertia, so there is nothing to divide: lumped, fem and exact are one model, and its "
    "frequencies are right to rounding."
)
OWN_SEGMENTS = "The `segments` that the file gives its shafts are not used: the study divides them itself."
SECTIONS = "Sections given by a mesh were solved beforehand; that time is not counted."
EPS = float(np.finfo(np.float64).eps)
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def study_times(
    study: Study,
    *,
    highest: float = 0.0,
    count: int | None = None,
    no_response: str = "",
    tolerance: float = TOLERANCE,
    quick: bool = False,
    progress: Progress | None = None,
) -> Timings:
    """Run times and errors of all methods, quantity by quantity.

    highest: Hz, of the requested response, 0 where none. count: requested modes, None for those up to
    `highest`. no_response: why there is no response to compare, '' where there is one. Raises InputError for
    shafts in a train with closed loops, of which there is no exact model, and SolveError.
    """
    if has_shafts(study.train) and assemble(study.train).folded.extra.size:
        raise InputError([loop_fault(("links",))])
    effort = QUICK if quick else FULL
    report = progress or (silent)
    bare = plain(study)
    quantities, remarks = list[TimedQuantity](), list[str]()
    if has_shafts(bare.train):
        quantities.append(timed_frequencies(bare, highest, count, effort, report))
    else:
        remarks.append(NOTHING_TO_DIVIDE)
    if no_response:
        remarks.append(f"No response is compared: {no_response}.")
    else:
        quantities.append(timed_torques(bare, highest, effort, report))
    if any(bar.segments is not None and bar.density > 0 for bar in study.train.bars):
        remarks.append(OWN_SEGMENTS)
    if any(bar.section is not None for bar in study.train.bars):
        remarks.append(SECTIONS)
    return Timings(tolerance, tuple(quantities), tuple(remarks), effort.rounds, machine())


def timed_frequencies(
    study: Study, highest: float, count: int | None, effort: Effort, progress: Progress
) -> TimedQuantity:
    """study: in the exact model. highest: Hz, of the response; count: of modes, None for those up to `highest`.

    Raises SolveError where the exact model cannot take the train.
    """
    exact = reference(study, highest, count)
    wanted = exact.finer_found.frequency
    half = (exact.finer_found.upper - exact.finer_found.lower) / (2.0 * wanted)
    bound = max(float(half.max()), float(np.abs(relative_errors(exact.found.frequency, wanted)).max()), EPS)

    def errors(found: Modes) -> tuple[float, ...]:
        return tuple(np.abs(relative_errors(found.frequency, wanted)).tolist())

    named = partial(Candidate, solve=partial(modes, count=len(wanted)), errors=errors)
    top = max(highest, float(wanted[-1]))
    curves = candidates(study.train, top, effort, effort.degrees, named)
    rows, remarks = timed(curves, effort, "natural frequencies", progress)
    number = len(wanted)
    whole = "the first elastic mode" if number == 1 else f"the first {number} elastic modes"
    return TimedQuantity(
        "frequencies",
        "Natural frequencies",
        f"The error is the largest relative error of {whole}, shapes and torques included in the time. Where a "
        "discretisation has fewer modes it has no error and is not drawn.",
        "Reference: the exact model in twice as many pieces. Its bound is the larger of half its certified enclosure, "
        "of the difference to the exact model in half as many pieces, and of the rounding unit.",
        bound,
        highest if count is None and highest > 0.0 else float(wanted[-1]),
        tuple(f"mode {k + 1}, {f:.6g} Hz" for k, f in enumerate(wanted.tolist())),
        rows,
        remarks,
    )


def machine(packages: Sequence[str] = ("numpy", "scipy", "scikit-fem")) -> tuple[tuple[str, str], ...]:
    """On what the times were taken: system, threads, interpreter and the versions of packages."""
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
