"""Chapter: the mean torque of every element, and the power balance of the machines."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.steady import PowerBalance, Steady
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import rpm
from torsion.output.reported_values import rated
from torsion.output.selection import elements


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield nothing without a mean torque."""
    steady, speed = findings.get(Steady), rated(findings)
    if steady is None or not np.any(steady.torque):
        return
    point = len(steady.speed) - 1 if speed is None else int(np.argmin(np.abs(steady.speed - speed)))
    rows = []
    for element in elements(findings.system):
        own_speed, torque = (
            steady.speed[point] * element.ratio,
            steady.torque[element.spans[0], point],
        )
        largest = np.abs(steady.torque[list(element.spans)]).max()
        rows.append((element.name, own_speed, torque, torque * own_speed, largest))
    yield Heading("Mean torque")
    yield Paragraph(steady.sharing)
    yield table(
        "< Component | Speed of the component [rpm] | Mean torque [~N m] | Power [kW] | "
        "Maximum over the speed range [~N m]",
        rows,
        f"Mean torque at {rpm(float(steady.speed[point]))} rpm, each at the speed of the component",
    )
    if (balance := findings.get(PowerBalance)) is not None:
        yield table(
            "< Machine | < Power | Speed [rpm] | Power [kW] | Torque [~N m] | < Law of load | < Its power is",
            [
                (
                    machine.name,
                    "delivers" if machine.enters else "absorbs",
                    machine.speed,
                    machine.power,
                    machine.torque,
                    machine.law or None,
                    "computed" if machine.free else "stated",
                )
                for machine in balance.machines
            ],
            "Power balance of the machines, each at its speed",
        )
