"""Chapter: couplings whose stiffness follows their own vibratory torque."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.vibratory_torques import VibratoryTorque, VibratoryTorques
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.figure import Axis, Figure, Line, Panel
from torsion.output.figures.ranges import SPEED
from torsion.output.numbers import RPM, number, rpm, scale

MOST_ROWS = 9
TEXT = (
    "At every speed the stiffness and the loss factor follow from the total torque amplitude T, which depends"
    " on them. The program finds all solutions T of every interval of the table. The report shows the largest"
    " solution, and every check uses the worst. The residual compares T with the amplitude of the whole train"
    " at this stiffness. If it stays above 10⁻⁹ or T does not converge, no check passes at this speed."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Every coupling at its worst speed, through the range, and where it has several solutions."""
    each = findings.need(VibratoryTorques).each
    yield Heading("Couplings with a table over vibratory torque")
    yield Paragraph(TEXT)
    for one in each:
        if lost := int(np.count_nonzero(~one.settled)):
            yield Paragraph(
                f"{one.coupling}: {lost} of {one.speed.size} speeds did not converge.", "note"
            )
    unit = scale("N m", [float(one.torque.max(initial=0.0)) for one in each])
    rows = [
        (
            one.coupling,
            rpm(float(one.speed[k])),
            unit.text(float(one.torque[k])),
            int(one.number[k]),
            unit.text(float(one.smallest[k])),
            number(float(one.stiffness[k]), 7),
            number(float(one.loss_factor[k])),
            number(float(one.residual[k]), 2),
            int(one.rounds[k]),
            "converged" if one.settled[k] else "not converged",
        )
        for one in each
        for k in _chosen(one)
    ]
    yield table(
        f"< Coupling -> | Speed [rpm] -> rpm | T [{unit.unit}] -> T | Solutions -> solutions | "
        f"Smallest [{unit.unit}] | k own [N m/rad] -> k | Loss factor η -> η | Residual | Rounds | < Status",
        rows,
        "Couplings with a table over vibratory torque, at the worst speeds and over the range",
        short="Couplings with a table over vibratory torque",
    )
    for place, one in enumerate(each, 1):
        yield _figure(one, f"coupling-vibration-{place}")


def _chosen(one: VibratoryTorque) -> list[int]:
    """Speeds through the range, the worst, the ends of those with several solutions, and the first without any."""
    through = np.linspace(0, one.speed.size - 1, min(MOST_ROWS, one.speed.size)).round().astype(int)
    several, lost = np.flatnonzero(one.number > 1), np.flatnonzero(~one.settled)
    ends = np.concatenate([several[:1], several[-1:], lost[:1], [int(np.argmax(one.torque))]])
    found: list[int] = np.unique(np.concatenate([through, ends])).astype(int).tolist()
    return found


def _figure(one: VibratoryTorque, name: str) -> Figure:
    x, unit = one.speed * RPM, scale("N m", [float(one.torque.max(initial=0.0))])
    stiff = scale("N m/rad", one.stiffness.tolist())
    lines = [Line("largest solution", x, one.torque * unit.factor, 0)]
    if (one.number > 1).any():
        lines.append(Line("smallest solution", x, one.smallest * unit.factor, 1))
    panels = (
        Panel(SPEED, Axis("total vibratory torque", unit.unit, low=0.0), tuple(lines)),
        Panel(
            SPEED,
            Axis("stiffness", stiff.unit, low=0.0),
            (Line("k", x, one.stiffness * stiff.factor, 0),),
        ),
    )
    return Figure(name, f"{one.coupling}: total vibratory torque and stiffness", panels)
