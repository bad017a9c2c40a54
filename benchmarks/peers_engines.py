"""torsion next to the figures that others published of engines: `python -m benchmarks.peers_engines`.

It puts the last section of reports/peers.md anew in some seconds; all before it stays as it was measured.
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import opentorsion

import torsion
from benchmarks.page_file import REPORTS
from benchmarks.papers.writing import table
from benchmarks.peers_opentorsion import NAME
from torsion.analyses.response.amplitudes import Synthesis
from torsion.arrays import ComplexArray, FloatArray

ROOT = Path(__file__).parents[1]
ORACLES = ROOT / "tests" / "kernels" / "engine" / "oracles.json"
HEAD = "## Engine trains: published figures"
WHAT = """\
This section was put by `python -m benchmarks.peers_engines`, which runs {name} next to torsion; what is called printed
is as its authors print it.

The six-cylinder engine of Mendes et al. (2008), with the harmonics of openTorsion's digitised pressure, at 2000 rpm.
`vibratory_torque` of openTorsion, with the loss factor by its `C_func`, adds the magnitudes of all orders, which no
moment of the cycle reaches, of the elastic share of the torque only: the whole torque is |1 + 0.035 i| times that, by
the loss factor of the crank. torsion sums the orders as phasors over the cycle; half of what lies between its extremes
is the amplitude that a rule compares, and the sum of magnitudes is given as a bound. The model file has its harmonics
in nine digits."""
HENDRIKSE = (
    "[disc: {{inertia: 0.15}}, coupling: {{stiffness: {}}}, disc: {{inertia: 0.02}}, coupling: {{stiffness: 5000}}, "
    "disc: {{inertia: 0.05}}]"
)
PAIRS = {  # title: train and its published frequencies, Hz
    "TMS26, benchmark 004, free": (
        "[disc: {inertia: 0.1}, coupling: {stiffness: 1000}, disc: {inertia: 0.2}]",
        ("19.492420030841906",),
    ),
    "TMS26, benchmark 004, hub fixed": (
        "[disc: {held: true}, coupling: {stiffness: 1000}, disc: {inertia: 0.2}]",
        ("11.253953951963826",),
    ),
    "Hendrikse, k1 500": (HENDRIKSE.format(500), ("15.9", "96.6")),
    "Hendrikse, k1 100": (HENDRIKSE.format(100), ("7.2", "94.6")),
}
LOSS = 0.035
WHOLE = abs(1.0 + LOSS * 1j)  # torque / elastic share of it
SPEED = 2000.0 * math.pi / 30.0


def main() -> None:
    """Solves, prints the section and puts it at the end of the page."""
    text = "\n\n".join([HEAD, WHAT.format(name=NAME), engine(), frequencies()]) + "\n"
    print(text)
    page = REPORTS / "peers.md"
    kept = page.read_text(encoding="utf-8").partition(HEAD)[0].rstrip()
    page.write_text(f"{kept}\n\n{text}", encoding="utf-8")


def engine() -> str:
    """Sums and amplitudes of the first and the last span."""
    known = json.loads(ORACLES.read_text(encoding="utf-8"))["six_cylinder_mendes_pressure"]
    at_speed = known["by rpm"]["2000"]
    sums = sums_of_magnitudes(
        known["train"], np.array(at_speed["C re, im, orders 0..12"]) @ [1.0, 1.0j]
    )
    found = torsion.run(torsion.read(ROOT / "shafting_specs" / "six_cylinder_pressure.yaml"))
    total = found.need(Synthesis)
    at = int(np.argmin(np.abs(found.results["response"].speed - SPEED)))
    rows = []
    for span in (0, -1):
        bound, half = float(total.bound[at, span]), float(total.half_range[at, span])
        dense, printed = at_speed["half range s1..s8"][span], float(sums[span])
        rows.append(
            [
                "first" if span == 0 else "last",
                f"{printed:.7f}",
                f"{bound / WHOLE:.7f}",
                f"{bound / WHOLE / printed - 1:.1e}",
                f"{bound:.4f}",
                f"{half:.4f}",
                f"{dense:.4f}",
                f"{bound / half:.3f}",
            ]
        )
    head = [
        "span",
        "openTorsion, sum, N m",
        "torsion, sum, elastic share, N m",
        "difference",
        "torsion, sum, N m",
        "torsion, amplitude, N m",
        "dense solution of 7200 samples, amplitude, N m",
        "sum / amplitude",
    ]
    return table(head, rows)


def sums_of_magnitudes(train: dict[str, Any], harmonics: ComplexArray) -> FloatArray:
    """(spans,) N m of openTorsion: disks, shafts and a loss factor as its example of this engine has them.

    harmonics: N m of a cylinder from its firing top dead centre, orders 0, 0.5, 1, ..
    """
    fires = train["cylinders_at_stations"]
    damping = [train["damping_cylinders"] * (node in fires) for node in range(len(train["J"]))]
    disks = [
        opentorsion.Disk(node, J, c=c)
        for node, (J, c) in enumerate(zip(train["J"], damping, strict=True))
    ]
    shafts = [opentorsion.Shaft(left, left + 1, k=k, I=0.0) for left, k in enumerate(train["k"])]
    assembly = opentorsion.Assembly(shafts, disk_elements=disks)
    order = np.arange(1, len(harmonics)) / 2.0
    periodic = opentorsion.PeriodicExcitation(len(disks), order * SPEED)
    for node, firing in zip(fires, np.radians(train["firing_deg"]), strict=True):
        periodic.add_sines(
            node, order * SPEED, np.abs(harmonics[1:]), np.angle(harmonics[1:]) - order * firing
        )
    _, found = assembly.vibratory_torque(
        periodic, C_func=lambda w: np.diag(damping) + LOSS / w * assembly.K
    )
    return np.asarray(found)


def frequencies() -> str:
    """Natural frequencies next to those printed."""
    rows = []
    for title, (train, printed) in PAIRS.items():
        found = (
            torsion.run(torsion.parse(f"name: x\ntrain: {train}\n"), only=("modes",))
            .results["modes"]
            .frequency
        )
        for text, value in zip(printed, found.tolist(), strict=True):
            half = 0.5 * 10.0 ** -len(text.partition(".")[2])
            same = abs(value - float(text)) <= max(half * 1.0001, 1e-14 * value)
            rows.append([title, text, f"{value:.15g}", "all digits" if same else "DIFFERENT"])
    return table(["train", "printed, Hz", "torsion, Hz", ""], rows)


if __name__ == "__main__":
    main()
