"""Chapter: temperatures of couplings under their own heat."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.coupling_temperatures import (
    CouplingTemperature,
    CouplingTemperatures,
)
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.figures.ranges import SPEED
from torsion.output.numbers import RPM, number, rpm

TEXT = (
    "A coupling softens with temperature, and its power loss depends on its stiffness. At thermal equilibrium"
    " the coupling loses as much heat as it generates. The table lists all equilibria up to the permissible "
    "temperature. A run-up reaches the lowest; a coast-down can stay at the highest. Without a stable "
    "equilibrium above the last unstable one, the coupling overheats. Each coupling is computed with the "
    "others cold. All other results are for cold couplings."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Every coupling that warms."""
    each = findings.need(CouplingTemperatures).each
    yield Heading("Temperatures of couplings")
    yield Paragraph(TEXT)
    for one in each:
        away = np.flatnonzero(np.isnan(one.highest))
        if away.size:
            ends = f"{rpm(float(one.speed[away[0]]))} to {rpm(float(one.speed[away[-1]]))} rpm"
            text = (
                f"{one.coupling} overheats at {away.size} of {one.speed.size} speeds, from {ends}."
            )
            yield Paragraph(text, "note")
    rows = [
        (
            one.coupling,
            rpm(root.speed),
            number(root.temperature, 6),
            number(root.heat),
            number(root.stiffness, 7),
            number(root.loss_factor),
            "stable" if root.is_stable else "unstable",
        )
        for one in each
        for root in one.equilibria
    ]
    yield table(
        "< Coupling -> | Speed [rpm] -> rpm | Temperature [°C] -> °C | Power loss [W] -> W | k own [N m/rad] | "
        "Loss factor η | < Equilibrium -> is",
        rows,
        "Equilibrium temperatures of couplings, at the worst speed and at speeds with several equilibria",
        short="Temperatures of couplings",
    )
    for place, one in enumerate(each, 1):
        yield _figure(one, f"coupling-temperature-{place}")


def _figure(one: CouplingTemperature, name: str) -> Figure:
    x = one.speed * RPM
    lines = (Line("lowest", x, one.lowest, 0), Line("highest", x, one.highest, 1))
    levels = (
        Level("permissible", one.permissible, is_reached=True),
        Level("surroundings", one.surroundings, "pale"),
    )
    y = Axis("temperature", "°C", low=min(0.0, one.surroundings))
    return Figure(
        name, f"{one.coupling}: equilibrium temperatures", (Panel(SPEED, y, lines, levels),)
    )
