"""torsion beside the figures that others published of engines: `python -m benchmarks.peers_engines`.

It puts the last section of reports/peers.md anew in some seconds; all before it stays as it was measured.
"""

import json
import math
from pathlib import Path

import numpy as np

import torsion
from benchmarks.page_file import REPORTS
from benchmarks.papers.writing import table
from torsion.analyses.response.amplitudes import Synthesis

ROOT = Path(__file__).parents[1]
ORACLES = ROOT / "tests" / "kernels" / "engine" / "oracles.json"
HEAD = "## Engine trains: published figures"
WHAT = """\
This section was put by `python -m benchmarks.peers_engines`; openTorsion was not run anew for it: its two figures are
those recorded of version 0.3.2, the others as their authors print them.

The six-cylinder engine of Mendes et al. (2008), with the digitised pressure of openTorsion's example, at 2000 rpm.
openTorsion adds the magnitudes of all orders, which no moment of the cycle reaches, of the elastic share of the torque
alone: the whole torque is |1 + 0.035 i| times that, by the loss factor of the crank. torsion sums the orders as phasors
over the cycle; half of what lies between its extremes is the half range that a rule compares, and the sum of
magnitudes is given as a bound."""
HENDRIKSE = (
    "[disc: {{inertia: 0.15}}, coupling: {{stiffness: {}}}, disc: {{inertia: 0.02}}, coupling: {{stiffness: 5000}}, "
    "disc: {{inertia: 0.05}}]"
)
PAIRS = {  # title: train and its published frequencies, Hz
    "TMS26, benchmark 004, free": (
        "[disc: {inertia: 0.1}, coupling: {stiffness: 1000}, disc: {inertia: 0.2}]", ("19.492420030841906",),
    ),
    "TMS26, benchmark 004, hub fixed": (
        "[disc: {held: true}, coupling: {stiffness: 1000}, disc: {inertia: 0.2}]", ("11.253953951963826",),
    ),
    "Hendrikse, k1 500": (HENDRIKSE.format(500), ("15.9", "96.6")),
    "Hendrikse, k1 100": (HENDRIKSE.format(100), ("7.2", "94.6")),
}  # fmt: skip
SUMS = {0: 452.7654025132531, -1: 6051.564198348469}  # N m, openTorsion 0.3.2 `vibratory_torque`, first and last span
LOSS = abs(1.0 + 0.035j)


def main() -> None:
    """Solves, prints the section and puts it at the end of the page."""
    text = "\n\n".join([HEAD, WHAT, engine(), frequencies()]) + "\n"
    print(text)
    page = REPORTS / "peers.md"
    kept = page.read_text(encoding="utf-8").partition(HEAD)[0].rstrip()
    page.write_text(f"{kept}\n\n{text}", encoding="utf-8")


def engine() -> str:
    """Sums and half ranges of the first and the last span."""
    known = json.loads(ORACLES.read_text(encoding="utf-8"))["six_cylinder_mendes_pressure"]["by rpm"]["2000"]
    found = torsion.run(torsion.read(ROOT / "shafting_specs" / "six_cylinder_pressure.yaml"))
    total = found.need(Synthesis)
    at = int(np.argmin(np.abs(found.results["response"].speed - 2000.0 * math.pi / 30.0)))
    rows = []
    for span, printed in SUMS.items():
        bound, half = float(total.bound[at, span]), float(total.half_range[at, span])
        dense = known["half range s1..s8"][span]
        rows.append([
            "first" if span == 0 else "last", f"{printed:.7f}", f"{bound / LOSS:.7f}",
            f"{bound / LOSS / printed - 1:.1e}", f"{bound:.4f}", f"{half:.4f}", f"{dense:.4f}", f"{bound / half:.3f}",
        ])  # fmt: skip
    head = ["span", "openTorsion, sum, N m", "torsion, sum, elastic share, N m", "difference", "torsion, sum, N m",
            "torsion, half range, N m",
            "dense solution of 7200 samples, half range, N m", "sum / half range"]  # fmt: skip
    return table(head, rows)


def frequencies() -> str:
    """Natural frequencies beside those printed."""
    rows = []
    for title, (train, printed) in PAIRS.items():
        found = torsion.run(torsion.parse(f"name: x\ntrain: {train}\n"), only=("modes",)).results["modes"].frequency
        for text, value in zip(printed, found.tolist(), strict=True):
            half = 0.5 * 10.0 ** -len(text.partition(".")[2])
            same = abs(value - float(text)) <= max(half * 1.0001, 1e-14 * value)
            rows.append([title, text, f"{value:.15g}", "all digits" if same else "DIFFERENT"])
    return table(["train", "printed, Hz", "torsion, Hz", ""], rows)


if __name__ == "__main__":
    main()
