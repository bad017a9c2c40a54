"""Chapter: the mean torque of every element."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.steady import PowerBalance, Steady
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import curves_over_speed
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import NONE, RPM, number, rpm, scale
from torsion.output.reported_values import rated, rated_rpm
from torsion.output.selection import elements

MOST_LINES = 10  # in the figure: the largest
SAME = 1e-9  # of the largest torque: neighbours that differ by less are one line


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without a mean torque."""
    steady, speed = findings.get(Steady), rated(findings)
    if steady is None or not np.any(steady.torque):
        return
    size = np.abs(steady.torque).T
    found = [(element, float(element.largest(size).max())) for element in elements(findings.system)]
    unit = scale("N m", [largest for _, largest in found])
    at = int(np.argmin(np.abs(steady.speed - speed))) if speed is not None else len(steady.speed) - 1
    rows = []
    for element, largest in found:
        own, signed = float(steady.speed[at]) * element.ratio, float(steady.torque[element.spans[0], at])
        rows.append((element.name, rpm(own), unit.text(signed), number(signed * own / 1e3), unit.text(largest)))
    yield Heading("Mean torque")
    yield Paragraph(steady.sharing)
    yield table(
        f"< Element | Own speed [rpm] | Mean torque [{unit.unit}] | Power [kW] | Largest over the range [{unit.unit}]",
        rows,
        f"Mean torque at {rpm(float(steady.speed[at]))} rpm, each at its own speed",
    )
    yield from _balance(findings)
    if len(steady.speed) > 1:
        together = _together([(element.name, steady.torque[element.spans[0]] * unit.factor) for element, _ in found])
        ranked = sorted(range(len(together)), key=lambda k: -float(np.abs(together[k][1]).max()))[:MOST_LINES]
        lines = [together[k] for k in sorted(ranked)]
        rest = "" if len(together) <= MOST_LINES else f" (the {MOST_LINES} largest of {len(together)})"
        yield of_torsion(findings, curves_over_speed.steady(
            "steady", f"Mean torque over the speed{rest}", speed=steady.speed * RPM, lines=lines, unit=unit.unit,
            rated=rated_rpm(findings),
        ))  # fmt: skip


def _balance(findings: Findings) -> Iterator[Table]:
    """Where power enters and leaves, machine by machine."""
    balance = findings.get(PowerBalance)
    if balance is None:
        return
    unit = scale("N m", [machine.torque for machine in balance.machines])
    rows = [
        (
            machine.name, "enters" if machine.enters else "leaves", rpm(machine.speed), number(machine.power / 1e3),
            unit.text(machine.torque), machine.law or NONE, "computed" if machine.free else "stated",
        )
        for machine in balance.machines
    ]  # fmt: skip
    yield table(
        f"< Machine | < Power | Own speed [rpm] | Power [kW] | Torque [{unit.unit}] | < Law of load | < Its power is",
        rows,
        "Balance of power, every machine at its own speed",
    )


def _together(found: list[tuple[str, FloatArray]]) -> list[tuple[str, FloatArray]]:
    """Neighbours that carry the same torque as one line."""
    groups: list[tuple[list[str], FloatArray]] = []
    for name, values in found:
        if groups and np.all(np.abs(groups[-1][1] - values) <= SAME * np.abs(values).max()):
            groups[-1][0].append(name)
        else:
            groups.append(([name], values))
    return [(names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}", values) for names, values in groups]
