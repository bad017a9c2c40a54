"""Error against run time on three lines of shafts, openTorsion next to: `python -m benchmarks.accuracy [--quick]`.

Writes reports/accuracy.md and its figures in under five minutes; `--quick` takes half a minute, prints, and writes only
with `--out`.
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from time import process_time
from typing import Any

import numpy as np

from benchmarks import accuracy_page, accuracy_references
from benchmarks.accuracy_methods import MODES, mode_curves, torque_curves
from benchmarks.accuracy_scenes import LINES, STEPPED, Line
from benchmarks.page_file import Report
from torsion.analyses.compare.timing import Effort, timed

# the processor's time, one run a round; what takes long runs in one round
FULL = Effort(
    rounds=5,
    runs=1,
    slow=0.4,
    slow_rounds=1,
    clock=process_time,
    segments=1024,
    unknowns=260,
    degrees=tuple(range(1, 11)),
    speeds=40,
)
QUICK = replace(FULL, rounds=2, slow=0.2, segments=64, degrees=(1, 2, 10), unknowns=70, speeds=8)
PEERS = (6, 12, 24, 48, 96, 192, 336)  # elements a line
TENTH = replace(FULL, slow=60.0, segments=1, degrees=(10,), unknowns=40)  # of the stepped shaft
PEERS_OF_STEPPED = (8, 100)  # elements a shaft


def main() -> None:
    """Measures, prints the page and writes it."""
    report = Report(__doc__, "accuracy", "half a minute")
    is_quick = report.chosen.quick
    effort, tenth = (QUICK, replace(TENTH, rounds=1)) if is_quick else (FULL, TENTH)
    known = accuracy_references.frequencies(STEPPED, MODES)
    stepped = timed(mode_curves(STEPPED, known, tenth, PEERS_OF_STEPPED)[1:], tenth)[0]
    studies = [_study(line, effort, PEERS[: 5 if is_quick else None]) for line in LINES]
    figures = {accuracy_page.figure_name(study): accuracy_page.figure(study) for study in studies}
    report.publish(accuracy_page.TITLE, accuracy_page.parts(studies, stepped), figures)


def _study(line: Line, effort: Effort, peers: Sequence[int]) -> accuracy_page.Study:
    known = accuracy_references.frequencies(line, MODES)
    each = sorted({max(1, number // len(line.shafts)) for number in peers})
    modes, remarks = timed(mode_curves(line, known, effort, each), effort)
    half = replace(effort, segments=effort.segments // 2, unknowns=effort.unknowns // 2)
    halves = sorted({max(1, number // 2) for number in each})
    torques, more = timed(
        torque_curves(line, frequencies(known, effort.speeds), half, halves), half
    )
    print(f"{line.name}: {len(modes)} and {len(torques)} rows", file=sys.stderr, flush=True)
    return accuracy_page.Study(line.name, modes, torques, (*remarks, *more))


def frequencies(exact: Sequence[Any], count: int) -> np.ndarray:
    """Random rad/s, even in the logarithm, from half the first natural frequency to the tenth, ascending."""
    low, high = float(exact[0]) / 2, float(exact[MODES - 1])
    return np.sort(
        2 * np.pi * np.exp(np.random.default_rng(4).uniform(np.log(low), np.log(high), count))
    )


if __name__ == "__main__":
    main()
