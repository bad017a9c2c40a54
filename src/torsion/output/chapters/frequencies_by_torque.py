"""Chapter: natural frequencies over the speed, where a stiffness follows the speed or the mean torque."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import number, rpm, scale

MOST_ROWS, MOST_MODES = 13, 8
TEXT = (
    "Every coupling with a table over mean torque has the tangent stiffness at the mean torque of each speed."
    " The natural frequencies therefore depend on the speed, and an order can have no, one or several "
    "critical speeds. The program searches the speed range."
)
OF_PENDULUMS = (
    "The restoring force of a pendulum grows with the square of the speed. The natural frequencies therefore "
    "depend on the speed. The program searches the speed range for critical speeds."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Speeds evenly through the range."""
    found = findings.need(FrequenciesOverSpeed)
    chosen = np.unique(np.linspace(0, len(found.speed) - 1, MOST_ROWS).round().astype(int)).tolist()
    unit = scale("N m", [float(one.torque.max()) for one in found.couplings])
    yield Heading("Frequencies over the speed")
    yield Paragraph(TEXT if found.couplings else OF_PENDULUMS)
    titles = "Speed [rpm] -> rpm"
    for one in found.couplings:
        titles += f" | Mean torque of {one.coupling} [{unit.unit}] | k of {one.coupling} [N m/rad]"
    shown = range(min(len(found.frequency), MOST_MODES))
    titles += "".join(f" | Mode {mode + 1} [Hz]" for mode in shown)
    rows = [
        (
            rpm(float(found.speed[k])),
            *(
                text
                for one in found.couplings
                for text in (unit.text(float(one.torque[k])), number(float(one.stiffness[k]), 7))
            ),
            *(number(float(found.frequency[mode, k]), 7) for mode in shown),
        )
        for k in chosen
    ]
    yield table(titles, rows, "Natural frequencies over the speed")
