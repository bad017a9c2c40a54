"""Error against run time on three lines of shafts, openTorsion beside: `python -m benchmarks.accuracy [--quick]`.

Writes reports/accuracy.md and its figures in under five minutes; `--quick` takes half a minute, prints, and writes only
with `--out`.
"""

import argparse
import sys
import warnings
from pathlib import Path
from time import perf_counter

from benchmarks import accuracy_page, accuracy_references, machine
from benchmarks.accuracy_methods import MODES, Method, elements, exact, lumped, peer
from benchmarks.accuracy_page import Study
from benchmarks.accuracy_rows import FULL, QUICK, Effort, Row, frequencies, mode_rows, torque_rows
from benchmarks.accuracy_scenes import LINES, STEPPED, Line

REPORT = Path(__file__).parents[1] / "reports" / "accuracy.md"
ROUNDS_OF_STEPPED = 5
PATIENCE_OF_STEPPED = 60.0  # s: every method is called in every round
FINENESS = (1, 2, 4, 8, 16, 32, 64, 128, 256)  # finite elements a shaft


def main() -> None:
    """Measures, prints the page and writes it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="half a minute, nothing written unless --out")
    parser.add_argument("--out", type=Path, help=f"the page to write (default: reports/{REPORT.name})")
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")  # of the peer
    effort = QUICK if chosen.quick else FULL
    about, start = machine.lines(), perf_counter()
    stepped = _stepped(quick=chosen.quick)
    studies = [_study(line, effort) for line in LINES]
    how = f"Written by `python -m benchmarks.accuracy` in {perf_counter() - start:.0f} s."
    page = accuracy_page.text(studies, stepped, about, how + (" Quick run: fewer methods." if chosen.quick else ""))
    print(page)
    target = chosen.out or (None if chosen.quick else REPORT)
    if target:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(page, encoding="utf-8")
        for study in studies:
            (target.parent / accuracy_page.figure_name(study)).write_text(accuracy_page.figure(study), encoding="utf-8")


def _study(line: Line, effort: Effort) -> Study:
    known = accuracy_references.frequencies(line, MODES)
    highest = float(known[-1]) * (1 + 1e-9)
    shafts = len(line.shafts)
    methods = [lumped(line, number) for number in effort.segments]
    for degree in effort.degrees:
        methods += [elements(line, degree, n) for n in FINENESS if n * degree <= effort.unknowns]
    peers = [peer(line, max(1, number // shafts)) for number in effort.peer]
    modes = mode_rows([*methods, exact(line, highest), *peers], known, effort.rounds, effort.patience)
    w = frequencies(known, effort.frequencies)
    torques = torque_rows(
        line, [*methods, exact(line, highest, halved=True), *peers], w, effort.rounds, effort.patience
    )
    print(f"{line.name}: {len(modes)} and {len(torques)} rows", file=sys.stderr, flush=True)
    return Study(line.name, modes, torques)


def _stepped(*, quick: bool) -> list[Row]:
    """Exact, degree 10, and openTorsion's 40 and 500 elements, in turns."""
    known = accuracy_references.frequencies(STEPPED, MODES)
    methods: list[Method] = [exact(STEPPED, float(known[-1]) * (1 + 1e-9))]
    methods += [elements(STEPPED, 10, number) for number in (1, 2, 4)]
    methods += [peer(STEPPED, number) for number in (8, 100)]
    return mode_rows(methods, known, 1 if quick else ROUNDS_OF_STEPPED, PATIENCE_OF_STEPPED)


if __name__ == "__main__":
    main()
