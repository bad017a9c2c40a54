"""A stability map of 200 x 200 points of a train of 20 stations: `python -m benchmarks.stability_map`.

Writes reports/stability_map.md; it takes some minutes of one core. `--points N` makes a smaller one
and prints only.
"""

import argparse
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from benchmarks import machine
from torsion.analyses.motion.stability_map import StabilityMap, stability_map
from torsion.assembly import assemble
from torsion.components.coupling import Coupling
from torsion.components.disc import Disc
from torsion.components.joint import Joint
from torsion.components.motor import Motor
from torsion.study import Operation, Study
from torsion.train import train

REPORT = Path(__file__).parents[1] / "reports" / "stability_map.md"
POINTS, TARGET = 200, 600.0  # along each side; s on two cores


def main() -> None:
    """Measures and prints; writes the page of the whole map."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=POINTS)
    chosen = parser.parse_args()
    about = machine.lines()
    study = _study()
    system = assemble(study.train)
    speeds, angles = np.linspace(60.0, 120.0, chosen.points), np.radians(np.linspace(2.0, 30.0, chosen.points))
    wall, processor = perf_counter(), process_time()
    found = stability_map(study, system, speeds, "angle", angles)
    text = _page(about, found, len(system.stations), perf_counter() - wall, process_time() - processor)
    print(text)
    if chosen.points == POINTS:
        REPORT.write_text(text)


def _study() -> Study:
    """Eighteen discs, seventeen couplings, two joints in line with yokes of their own."""
    line: list = [Motor(inertia=2.0, damping=0.2)]
    for k in range(16):
        if k in (4, 11):
            line.append(Joint(angle="20 deg", inertia=(0.05, 0.05)))
        line += [Coupling(stiffness=4e4 + 3e3 * k, viscous=0.2), Disc(inertia=0.08)]
    line += [Coupling(stiffness=5e4, viscous=0.2), Disc(inertia=0.8, damping=0.6)]
    return Study("map", train(line), operation=Operation(load=[["1 rad/s", 300.0], ["1000 rad/s", 300.0]]))


def _page(about: list[str], found: StabilityMap, stations: int, wall: float, processor: float) -> str:
    growth = found.growth
    lines = [
        "# A stability map over speed and joint angle",
        "",
        "Written by `python -m benchmarks.stability_map`.",
        "",
        *(f"- {line}" for line in about),
        "",
        f"{growth.shape[0]} speeds (60 to 120 rad/s) x {growth.shape[1]} joint angles (2 to 30 degrees), a train of",
        f"{stations} stations with two joints, reduced to {found.modes} of {found.of_modes} elastic modes.",
        "",
        f"- time: {wall:.0f} s by the clock, {processor:.0f} s of one processor;",
        f"  meant < {TARGET:g} s on two cores: {'met' if wall < TARGET else 'MISSED'}",
        f"- largest difference to the whole train at the points that were checked: {found.error:.1e} 1/s",
        f"- points without an answer: {int(np.isnan(growth).sum())} of {growth.size}",
        f"- unstable points: {int((growth > 0).sum())}; fastest growth {np.nanmax(growth):.3f} 1/s",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
