"""torsion next to openTorsion and ROSS: `python -m benchmarks.peers` writes reports/peers.md in about six minutes.

Its last section is put by `python -m benchmarks.peers_engines`, to be run after it.
`--quick` takes a minute, leaves the largest trains out and prints without writing.
"""

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks import cases, frequency_rows, response_rows
from benchmarks.page_file import Report
from benchmarks.peers_page import parts
from benchmarks.programs import FULL, QUICK, Effort, Row


def main() -> None:
    """Measures, prints the page and writes it."""
    report = Report(__doc__, "peers", "a minute, small trains")
    effort = QUICK if report.chosen.quick else FULL
    with tempfile.TemporaryDirectory() as folder:
        frequencies = _progress(_frequency_rows(effort, Path(folder)))
    report.publish(
        "torsion next to openTorsion and ROSS",
        parts(frequencies, _progress(_response_rows(effort))),
    )


def _frequency_rows(effort: Effort, folder: Path) -> Iterator[Row]:
    for size in effort.sizes:
        for make in (cases.chain, cases.geared_tree):
            for stiff in (False, True):
                yield frequency_rows.compare(make(size, stiff=stiff), effort, folder)


def _response_rows(effort: Effort) -> Iterator[Row]:
    for size, requested, requested_of_peers in effort.response:
        for make in (cases.chain, cases.geared_tree):
            for stiff in (False, True):
                yield response_rows.compare(
                    make(size, stiff=stiff), effort, requested, requested_of_peers
                )
    for stiff in (False, True):
        case = cases.with_span_dampers(cases.chain(10, stiff=stiff))
        yield response_rows.compare(case, effort, 1000, 200)


def _progress(rows: Iterator[Row]) -> list[Row]:
    done = []
    for row in rows:
        done.append(row)
        print(f"{row.size:5d}  {row.case}", file=sys.stderr)
    return done


if __name__ == "__main__":
    main()
