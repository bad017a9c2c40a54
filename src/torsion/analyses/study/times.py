"""Error against run time for one train: every model and division of its shafts, every method of the response."""

import os
import platform
import sys
from importlib import metadata

from torsion.analyses.study.division import has_shafts, plain
from torsion.analyses.study.frequencies import timed_frequencies
from torsion.analyses.study.response import timed_response
from torsion.analyses.study.rows import TimedQuantity, Timings
from torsion.analyses.study.timing import FULL, QUICK
from torsion.assembly import assemble
from torsion.errors import Fault, InputError
from torsion.findings import Progress
from torsion.study import Study

TOLERANCE = 1e-3
NOTHING_TO_DIVIDE = (
    "No shaft of the train has inertia, so there is nothing to divide: lumped, fem and exact are one model, and its "
    "frequencies are right to rounding."
)
OWN_SEGMENTS = "The `segments` that the file gives its shafts are not used: the study divides them itself."
SECTIONS = "Sections given by a mesh were solved beforehand; that time is not counted."
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

    highest: Hz, of the response that the file asks for, 0 where none. count: modes asked for, None for those up to
    `highest`. no_response: why there is no response to compare, '' where there is one. Raises InputError for
    shafts in a train with closed loops, of which there is no exact model, and SolveError.
    """
    if has_shafts(study.train) and assemble(study.train).folded.extra.size:
        message = (
            "errors are against the exact model of the shafts, which takes no closed loops, and one is closed here"
        )
        raise InputError([Fault(("links",), message, "take the link out, or solve the scene with `model: lumped`")])
    effort = QUICK if quick else FULL
    tell = progress or (lambda what, share: None)
    bare = plain(study)
    quantities, remarks = list[TimedQuantity](), list[str]()
    if has_shafts(bare.train):
        quantities.append(timed_frequencies(bare, highest, count, effort, tell))
    else:
        remarks.append(NOTHING_TO_DIVIDE)
    if no_response:
        remarks.append(f"No response is compared: {no_response}.")
    else:
        quantities.append(timed_response(bare, highest, effort, tell))
    if any(bar.segments is not None and bar.density > 0 for bar in study.train.bars):
        remarks.append(OWN_SEGMENTS)
    if any(bar.section is not None for bar in study.train.bars):
        remarks.append(SECTIONS)
    return Timings(tolerance, tuple(quantities), tuple(remarks), effort.rounds, _machine())


def _machine() -> tuple[tuple[str, str], ...]:
    """On what the times were taken."""
    threads = ", ".join(f"{name}={os.environ[name]}" for name in THREADS if name in os.environ)
    python = ".".join(str(part) for part in sys.version_info[:3])
    return (
        ("System", f"{platform.system()}, {platform.machine()}, {os.cpu_count()} processors"),
        ("Threads of the libraries", threads or "as they choose"),
        ("Python", python),
        *((name, metadata.version(name)) for name in ("numpy", "scipy", "scikit-fem")),
    )
