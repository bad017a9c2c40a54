"""A stability map of 200 x 200 points of a train of 20 stations: `python -m benchmarks.stability_map`.

Writes reports/stability_map.md; it takes some minutes of all processors. `--points N` makes a smaller one
and prints only.
"""

import resource
from time import perf_counter

import numpy as np

from benchmarks.page_file import Report, verdict
from torsion.analyses.stability.stability_over_speed import StabilityMap, stability_map
from torsion.assembly import assemble
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.joint import Joint
from torsion.model.machine import Motor
from torsion.study import Operation, Study
from torsion.train import train

POINTS, TARGET = 200, 600.0  # along each side; s on two cores


def main() -> None:
    """Measures and prints; writes the page of the whole map."""
    report = Report(__doc__, "stability_map", points=POINTS)
    points = report.chosen.points
    report.chosen.quick = points != POINTS
    study = _study()
    system = assemble(study.train)
    speeds, angles = np.linspace(60.0, 120.0, points), np.radians(np.linspace(2.0, 30.0, points))
    wall, processor = perf_counter(), _processor_seconds()
    found = stability_map(study, system, speeds, "angle", angles)
    times = perf_counter() - wall, _processor_seconds() - processor
    report.publish(
        "A stability map over speed and joint angle", _parts(found, len(system.stations), *times)
    )


def _processor_seconds() -> float:
    """Processor time of this process and of those that it has ended, s."""
    usages = map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def _study() -> Study:
    """Eighteen discs, seventeen couplings, two joints in line with yokes of their own."""
    line: list = [Motor(inertia=2.0, damping=0.2)]
    for k in range(16):
        if k in (4, 11):
            line.append(Joint(angle="20 deg", inertia=(0.05, 0.05)))
        line += [Coupling(stiffness=4e4 + 3e3 * k, viscous=0.2), Disc(inertia=0.08)]
    line += [Coupling(stiffness=5e4, viscous=0.2), Disc(inertia=0.8, damping=0.6)]
    return Study(
        "map", train(line), operation=Operation(load=[["1 rad/s", 300.0], ["1000 rad/s", 300.0]])
    )


def _parts(found: StabilityMap, stations: int, wall: float, processor: float) -> tuple[str, str]:
    growth = found.growth
    what = (
        f"{growth.shape[0]} speeds (60 to 120 rad/s) x {growth.shape[1]} joint angles (2 to 30 degrees), a train of "
        f"{stations} stations with two joints, reduced to {found.modes} of {found.of_modes} elastic modes."
    )
    lines = (
        f"- time: {wall:.0f} s by the clock, {processor:.0f} s of the processors; meant < {TARGET:g} s on two cores: "
        + verdict(wall < TARGET),
        f"- largest difference to the whole train at the points that were checked: {found.error:.1e} 1/s",
        f"- points without a result: {int(np.isnan(growth).sum())} of {growth.size}",
        f"- unstable points: {int((growth > 0).sum())}; fastest growth {np.nanmax(growth):.3f} 1/s",
    )
    return what, "\n".join(lines)


if __name__ == "__main__":
    main()
