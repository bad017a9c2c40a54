"""Chapter: the mean torque of every element, and the power balance of the machines."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.steady import MeanLoads, PowerBalance, Steady
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield nothing without a mean torque."""
    steady, loads = findings.get(Steady), findings.get(MeanLoads)
    if steady is None or loads is None or not np.any(steady.torque):
        return
    yield Heading("Mean torque")
    yield Paragraph(f"{steady.sharing} Values are for the rated speed, or the highest without one.")
    yield table(
        "component: < Component | speed: Speed of the component [rpm] | torque: Mean torque [~N m] | "
        "power: Power [kW] | largest: Maximum over the speed range [~N m]",
        loads.each,
        "Mean torque, each at the speed of the component",
    )
    yield table(
        "name: < Machine | < Power | speed: Speed [rpm] | power: Power [kW] | torque: Torque [~N m] | "
        "law: < Law of load:? | free: Power computed",
        [
            (machine, "delivers" if machine.enters else "absorbs")
            for machine in findings.need(PowerBalance).machines
        ],
        "Power balance of the machines, each at its speed",
    )
