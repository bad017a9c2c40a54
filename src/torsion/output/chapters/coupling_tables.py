"""Chapter: couplings and dampers whose stiffness and damping follow a table, as given and at the modes."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.modes.coupling_tables import CouplingTables, Table
from torsion.findings import Findings
from torsion.output import blocks
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.coupling_table import coupling_table
from torsion.output.figures.figure import Axis, Figure
from torsion.output.numbers import NONE, given, number, rpm, scale

GIVEN = 8  # significant digits of a figure of the file
LINEAR = "Stiffness k and loss factor η are interpolated linearly between the points of a table."
BEYOND = {True: "constant outside the table", False: "not computed outside the table"}
BY_FREQUENCY = (
    "Every harmonic component has k and η at its frequency. Every mode has k at its natural frequency and its"
    " own Holzer table. These modes are not orthogonal. On every interval of a table d ln k/d ln ω is at most"
    " {}. Below 2 every mode has exactly one frequency, which Sturm counts prove."
)
BY_TORQUE = (
    "A table over mean torque gives the tangent stiffness. Every speed has k at its mean torque. Modes have k"
    " at {} rpm."
)
BY_VIBRATION = (
    "A table over vibratory torque gives k and η at the total torque amplitude of each speed. Modes have the "
    "first stiffness of the table (small vibration)."
)
LOSS = (
    "The modal loss factor is the sum of elastic energy share times loss factor over all components. The "
    "damping ratio is about half of it."
)
NO_COMPLEX = "A table gives k and η only at real frequencies. Complex modes are not computed."
LAW = (
    "A viscoelastic law holds at every complex s. Harmonic components use K(iω) = k (1 + iη), modes use k(ω),"
    " and damped modes use K(s) with one state for each relaxing term. The points below are samples of the "
    "law. In N m/rad:"
)
UNITS = {
    "frequency": Axis("frequency", "Hz"),
    "mean torque": Axis("mean torque of the coupling", "N m"),
}
UNITS["vibratory torque"] = Axis("vibratory torque of the coupling", "N m")


def chapter(findings: Findings) -> Iterator[Block]:
    """Tables as given, their figures, and the modes."""
    found = findings.need(CouplingTables)
    yield Heading("Couplings and dampers with tables or laws")
    if linear := [one for one in found.tables if one.law is None]:
        yield Paragraph(
            f"{LINEAR} {'; '.join(f'{one.coupling}: {BEYOND[one.holds]}' for one in linear)}."
        )
    for one in found.tables:
        if one.law is not None and not one.is_complex:
            yield Paragraph(f"{one.coupling}: {one.law}.")
    if laws := [one for one in found.tables if one.is_complex]:
        yield Paragraph(f"{LAW} {'; '.join(f'{one.coupling}: {one.law}' for one in laws)}.")
    steepest = [one.steepest for one in found.tables if one.over == "frequency"]
    if steepest:
        yield Paragraph(BY_FREQUENCY.format(number(max(steepest), 3)))
    if found.speed is not None:
        yield Paragraph(BY_TORQUE.format(rpm(found.speed)))
    if any(one.over == "vibratory torque" for one in found.tables):
        yield Paragraph(BY_VIBRATION)
    yield _as_given(found)
    for place, one in enumerate(found.tables, 1):
        yield _figure(found, one, f"coupling-table-{place}")
    if found.at_modes:
        yield Paragraph(
            f"{LOSS} {NO_COMPLEX}" if any(not one.is_complex for one in found.tables) else LOSS
        )
        yield _at_modes(found)


def _as_given(found: CouplingTables) -> blocks.Table:
    rows = [
        (
            one.coupling,
            one.over,
            f"{given(at, GIVEN)} {UNITS[one.over].unit}",
            given(k, GIVEN),
            given(eta, GIVEN) if eta else NONE,
            given(c, GIVEN) if c else NONE,
        )
        for one in found.tables
        for at, k, eta, c in zip(
            *(values.tolist() for values in (one.at, one.stiffness, one.loss_factor, one.viscous)),
            strict=True,
        )
    ]
    titles = "< Component -> | < Over -> | At -> | k own [N m/rad] -> k | Loss factor η -> η | Viscous c [N m s/rad]"
    return table(titles, rows, "Couplings and dampers with tables: input data")


def _at_modes(found: CouplingTables) -> blocks.Table:
    lost = found.modal_loss_factor.tolist()
    rows = [
        (
            one.mode,
            number(one.frequency, 7),
            one.coupling,
            number(one.stiffness, 7),
            number(one.loss_factor),
            number(100.0 * one.share, 4),
            number(lost[one.mode - 1]),
        )
        for one in sorted(found.at_modes, key=lambda one: one.mode)
    ]
    titles = (
        "Mode -> | Frequency [Hz] -> Hz | < Component -> | k own [N m/rad] -> k | Loss factor η -> η | "
        "Share of the elastic energy [%] -> share, % | Modal loss factor of the train -> modal η"
    )
    return table(titles, rows, "Couplings and dampers with tables: values at the modes")


def _figure(found: CouplingTables, one: Table, name: str) -> Figure:
    unit = scale("N m/rad", one.stiffness.tolist())
    modes = [
        (
            mode.frequency,
            mode.stiffness * unit.factor,
            f"mode {mode.mode}: {number(mode.frequency)} Hz",
        )
        for mode in found.at_modes
        if mode.coupling == one.coupling
        and one.over == "frequency"
        and one.at[0] <= mode.frequency <= one.at[-1]
    ]
    return coupling_table(
        name,
        f"{one.coupling}: stiffness and loss factor over {UNITS[one.over].quantity}",
        over=UNITS[one.over],
        at=np.asarray(one.at),
        stiffness=one.stiffness * unit.factor,
        unit=unit.unit,
        loss_factor=one.loss_factor,
        modes=modes,
    )
