"""Chapter: the mean torque of every element."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.steady import PowerBalance, Steady
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, number, rpm, scale
from torsion.output.reported_values import rated
from torsion.output.selection import elements


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without a mean torque."""
    steady, speed = findings.get(Steady), rated(findings)
    if steady is None or not np.any(steady.torque):
        return
    size = np.abs(steady.torque).T
    found = [(element, float(element.largest(size).max())) for element in elements(findings.system)]
    unit = scale("N m", [largest for _, largest in found])
    at = (
        int(np.argmin(np.abs(steady.speed - speed))) if speed is not None else len(steady.speed) - 1
    )
    rows = []
    for element, largest in found:
        own, signed = (
            float(steady.speed[at]) * element.ratio,
            float(steady.torque[element.spans[0], at]),
        )
        rows.append(
            (
                element.name,
                rpm(own),
                unit.text(signed),
                number(signed * own / 1e3),
                unit.text(largest),
            )
        )
    yield Heading("Mean torque")
    yield Paragraph(steady.sharing)
    yield table(
        f"< Component | Speed of the component [rpm] | Mean torque [{unit.unit}] | Power [kW] | "
        f"Maximum over the speed range [{unit.unit}]",
        rows,
        f"Mean torque at {rpm(float(steady.speed[at]))} rpm, each at the speed of the component",
    )
    yield from _balance(findings)


def _balance(findings: Findings) -> Iterator[Table]:
    """Where power enters and leaves, machine by machine."""
    balance = findings.get(PowerBalance)
    if balance is None:
        return
    unit = scale("N m", [machine.torque for machine in balance.machines])
    rows = [
        (
            machine.name,
            "delivers" if machine.enters else "absorbs",
            rpm(machine.speed),
            number(machine.power / 1e3),
            unit.text(machine.torque),
            machine.law or NONE,
            "computed" if machine.free else "stated",
        )
        for machine in balance.machines
    ]
    yield table(
        f"< Machine | < Power | Speed [rpm] | Power [kW] | Torque [{unit.unit}] | < Law of load | < Its power is",
        rows,
        "Power balance of the machines, each at its speed",
    )
