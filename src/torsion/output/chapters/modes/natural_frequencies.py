"""Chapter: natural frequencies with their certificate, mode plots, Holzer tables and energy shares."""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.modes.holzer import holzer
from torsion.analyses.modes.steps_and_hubs import HubMoves, SharpSteps
from torsion.analyses.response.amplitudes import FrequencyResponse, Response
from torsion.analyses.response.fillet_stresses import Fillets
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.chapters.modes.critical_speeds import matrix
from torsion.output.figures import mode_shape
from torsion.output.figures.figure import Figure
from torsion.output.numbers import LESS, counted, number, rpm, symbols
from torsion.output.records import along
from torsion.output.station_layout import MOST_NAMES, layout
from torsion.results import listed

STEPS = (
    "The file does not describe the corner between shafts of different diameter. The frequencies above "
    "neglect the flexibility of the shoulder (`steps: none`). To include it, set `steps: sharp` (upper limit)"
    " or state a fillet or chamfer with `step` of the shaft."
)
HUBS = (
    "A part of the seat of a hub twists with the shaft. The model is bonded (finite elements) or keyed "
    "(formula); slip at the mouth of the seat is not included. The comparison without a hub assumes that the "
    "whole seat twists."
)
FILLETS = (
    "K_{t} is the maximum shear stress in the fillet over the nominal stress T/W_{p} of the smaller end, for "
    "a shoulder between two long shafts (finite elements of axisymmetric torsion). The column Peterson gives "
    "the fit of chart 3.12 (Pilkey 1997, edition not confirmed) for solid shafts and 0.25 ≤ shoulder height /"
    " radius ≤ 4. The peak stress is K_{t} times the total nominal stress amplitude at its worst speed. Class"
    " limits apply to nominal stresses and include their own factors. Corners without a stated radius, the "
    "second corner of a flange or undercut, corners between different bores and hub mouths are not included. "
    "A short shaft between two larger shafts is computed with both shoulders. At a larger shaft with a thin "
    "wall the peak is at least its nominal stress."
)
NOTCHES = (
    "Keyways and splines: K_{t} of the section over T/W_{p} of the plain shaft, by plane finite elements. The"
    " pressure of the key and the ends of the groove are not included. For a keyway of width d/4 and depth "
    "d/8 the column Peterson gives the fit of chart 5.2 (edition not confirmed), 2 % (radius d/100) to 7 % "
    "(0.07 d) above the finite elements; their error is below 1e-3. Radial oil holes: the formula of IACS UR "
    "M53 for the maximum normal stress, over √3. The nominal stress is at the end of the shaft with the "
    "highest notch stress."
)


def steps_and_hubs(findings: Findings) -> Iterator[Block]:
    """Yield how far sharp steps would move the natural frequencies, and how far hubs do; nothing without either."""
    if (sharp := findings.get(SharpSteps)) is not None:
        yield Heading("Steps between shafts", 2)
        yield Paragraph(STEPS)
        yield Points(tuple(f"{step.shaft}: {symbols(step.remark)}." for step in sharp.steps))
        if any(step.flexibility for step in sharp.steps):
            yield table(
                "mode: Mode -> | frequency: With sharp steps [Hz]:7 -> Hz | change: Change [%]:3 -> change, %",
                along(sharp, "mode"),
                "Natural frequencies with sharp steps between the shafts",
            )

    if (hubs := findings.get(HubMoves)) is not None:
        yield Heading("Hubs on shafts", 2)
        yield Paragraph(HUBS)
        yield table(
            "shaft: < Shaft | end: < End | seat: Seat [mm] | twisting: Twists as [mm]:4 | error: Error [mm]:1",
            hubs.each,
            "Hubs on the ends of shafts",
        )
        yield table(
            "shaft: < Shaft | end: < End | mode: Mode | frequency: Without the hub [Hz]:7 | change: Change [%]:3",
            [row for hub in hubs.each for row in along(hub, "mode")],
            "Effect of each hub on the natural frequencies",
        )


def fillets(findings: Findings) -> Iterator[Block]:
    """Yield the shear stress in the stated fillets and notches of shafts, with K_t and its error."""
    details = findings.need(Fillets).each
    yield Heading("Stress in fillets")
    yield Paragraph(FILLETS)
    if any(detail.following is None for detail in details):
        yield Paragraph(NOTCHES)
    yield table(
        "shaft: < Shaft | label: < Detail | radius: Radius [mm]:4 | diameter: d [mm] | larger: D [mm] | "
        "factor: K_{t}:4 | error: Error of K_{t} [%]:2 | peterson: Peterson:4 | nominal: Nominal [N/mm²]:4 | "
        "peak: Peak [N/mm²]:4 | speed: Speed [rpm] | endurance: Endurance limit [N/mm²]:4 -> endurance | "
        "utilisation: Utilisation [%]:4",
        details,
        "Shear stress in fillets and notches",
        marks=["fail" if (detail.utilisation or 0.0) > 1.0 else "" for detail in details],
    )


MOST_IN_SUMMARY = 6  # on the terminal without `-v`
MOST_MODES = 12  # with a shape and a Holzer table in the full report
MODES_WITHOUT_ORDERS = 6  # with a shape where nothing excites
MOST_TABLES, FEW_ROWS = 3, 50  # Holzer tables of the report, and their rows
MOST_ROWS = 600  # rows of all Holzer tables of the full report
SMALLEST_SHARE = 0.02  # of the energy of a mode; smaller shares are not listed
HOLZER, SQUARE = 7, 11  # significant digits of a Holzer table, and of its squared frequency
RESIDUAL = "residual / largest torque"
HOW_TO_READ = (
    "Each row of a Holzer table follows from the row that it names: twist = flexibility × torque, angle = angle of "
    "that row − twist. Torque in acts at the end of the part toward that row, torque out at its other end. The "
    "residual is the torque balance of a station: torque in + ω² J × angle − torque toward the next rows. A shaft with "
    "distributed inertia has θ' = A θ − H T and T' = B θ + D T, with angle θ and torque T at its first end. The "
    f"lumped model adds the shaft's inertia to its end stations. A printed 0 is {LESS}."
)
RIGID = {0: "The train has no rigid-body mode", 1: "The train has one rigid-body mode (0 Hz)"}
CERTIFIED = (
    "The frequencies are certified: Sturm counts prove that exactly one mode lies between its two bounds and that "
    "no mode is missing."
)
OVERDAMPED = 8  # roots that are listed


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the frequencies, and the shapes of the modes up to the highest excited frequency."""
    modes, damped, train = (
        findings.get(Modes),
        findings.get(DampedModes),
        findings.study.train,
    )
    if modes is None:
        return
    yield Heading("Natural frequencies and mode shapes")
    rigid = RIGID.get(modes.rigid, f"The train has {modes.rigid} rigid-body modes (0 Hz)")
    elastic = counted(len(modes.frequency), "elastic mode")
    bounds = "The bounds of these frequencies are not certified by Sturm counts."
    yield Paragraph(f"{rigid} and {elastic} (undamped). {CERTIFIED if modes.certified else bounds}")
    if nonlinear := [
        f"{part.name} {part.nonlinear.words}" for part in train.parts if part.nonlinear
    ]:
        text = f"The modes take these couplings as linear: {listed(nonlinear, '; ')}. The error depends on the amplitude."
        yield Paragraph(text, "note")
    if train.follows_speed and findings.study.operation.speed is not None:
        speed = rpm(findings.study.operation.speed)
        yield Paragraph(f"A stiffness depends on the speed. The modes are those at {speed} rpm.")
    if len(modes.frequency) == 0:
        return

    yield frequencies(modes)
    yield from steps_and_hubs(findings)
    if damped is not None:
        title = "Damped natural frequencies"
        title += f", damping at {rpm(damped.speed)} rpm" if damped.speed > 0 else ""
        yield table(
            "mode: Mode -> | frequency: Frequency [Hz]:7 -> Hz | "
            "damping_ratio: Damping ratio [%]:4 -> damping ratio, %",
            along(damped, "mode"),
            title,
            short=title,
        )
        if len(damped.overdamped):
            roots = ", ".join(number(root, 4) for root in damped.overdamped.tolist()[:OVERDAMPED])
            ellipsis = ", …" if len(damped.overdamped) > OVERDAMPED else ""
            yield Paragraph(f"Overdamped modes (decay without oscillation): {roots}{ellipsis} 1/s.")
    count = excited_modes(findings, modes)
    yield from plots(findings, modes, range(count))
    if count < len(modes.frequency):
        yield Paragraph(
            f"The figures show the lowest {count} of {len(modes.frequency)} modes, up to the highest excited frequency. "
            f"The full report (--full) shows at most {MOST_MODES}."
        )


def excited_modes(findings: Findings, modes: Modes) -> int:
    """Return the number of modes up to the highest excited frequency, at least 1 and at most MOST_MODES."""
    highest = 0.0
    for response in (findings.get(Response), findings.get(FrequencyResponse)):
        if response is not None:
            highest = max(highest, float(response.frequency.max(initial=0.0)))
    count = int((modes.frequency <= highest).sum()) if highest else MODES_WITHOUT_ORDERS
    return min(max(count, 1), len(modes.frequency), MOST_MODES)


def appendix(findings: Findings) -> Iterator[Block]:
    """Yield Holzer tables of the lowest excited modes, energy shares, and the order-by-mode matrix."""
    modes = findings.get(Modes)
    if modes is None or len(modes.frequency) == 0:
        return
    yield Heading("Appendix: Holzer tables")
    yield Paragraph(HOW_TO_READ)
    for mode in range(_table_count(findings, modes)):
        yield next(holzer_tables(findings, modes, mode))

    # Of named stations, of all inner stations of a shaft together, and of elements.
    shown = range(1, min(len(modes.frequency), MOST_MODES) + 1)
    titles = "component: < Component" + "".join(f" | share@{k}: Mode {k} [%]:3" for k in shown)
    shares = [
        replace(share, share=np.where(share.share >= SMALLEST_SHARE, share.share, np.nan))
        for share in modes.energy_shares
        if share.share.max() >= SMALLEST_SHARE
    ]
    caption = f"Shares of the kinetic and elastic energy, from {100 * SMALLEST_SHARE:g} % on"
    yield table(titles, shares, caption)
    yield from matrix(findings)


def _table_count(findings: Findings, modes: Modes) -> int:
    """Return the number of Holzer tables in the report: at most MOST_TABLES, and FEW_ROWS rows of all of them."""
    by_rows = max(1, FEW_ROWS // len(findings.study.train.stations))
    return min(excited_modes(findings, modes), MOST_TABLES, by_rows)


def all_modes(findings: Findings) -> Iterator[Block]:
    """Yield the other shapes and Holzer tables of the full report, and the constants of distributed shafts."""
    modes = findings.get(Modes)
    if modes is None or len(modes.frequency) == 0:
        return
    yield Heading("Appendix: all modes")
    drawn, count = excited_modes(findings, modes), min(len(modes.frequency), MOST_MODES)
    yield from plots(findings, modes, range(drawn, count))
    tables = max(MOST_TABLES, MOST_ROWS // len(findings.study.train.stations))
    for mode in range(min(count, tables)):
        printed = 1 if mode < _table_count(findings, modes) else 0
        yield from islice(holzer_tables(findings, modes, mode), printed, None)
    if tables < count:
        yield Paragraph(f"The first {tables} modes have a Holzer table.")
    if count < len(modes.frequency):
        yield Paragraph(f"Modes {count + 1} to {len(modes.frequency)} are in results.json.")


def frequencies(modes: Modes, most: int | None = None) -> Table:
    """Return the table of undamped natural frequencies with their bounds, at most so many rows."""
    lowest = ", ".join(number(frequency) for frequency in modes.frequency[:MOST_IN_SUMMARY])
    ellipsis = ", ..." if len(modes.frequency) > MOST_IN_SUMMARY else ""
    return table(
        "mode: Mode -> | frequency: Frequency [Hz]:7 -> Hz | frequency: Per minute [1/min]:7 -> per minute | "
        "nodes: Nodes -> | lower: Lower bound [Hz]:10 | upper: Upper bound [Hz]:10",
        along(modes, "mode"),
        "Natural frequencies of the undamped train",
        most=most,
        short="Natural frequencies",
        summary=f"Natural frequencies: {lowest}{ellipsis} Hz" if lowest else "",
    )


def holzer_tables(findings: Findings, modes: Modes, mode: int) -> Iterator[Table]:
    """Yield the table of a mode (from 0), and the constants of shafts with inertia between their ends, if any."""
    result = holzer(findings.system, modes, mode)
    rows = list(result.rows(findings.system))
    scaled = "first" if result.angle[0] == 1.0 else "largest"
    yield table(
        "number: No. | station: < Station | inertia: J referred [kg m²]:7 | angle: Angle [rad]:7 | "
        "inertia_torque: ω² J × angle [N m]:7 | before: From no. | through: < Through | torque_in: Torque in [N m]:7 | "
        "flexibility: Flexibility [rad/(N m)]:7 | twist: Twist [rad]:7 | torque_out: Torque out [N m]:7",
        rows,
        f"Holzer table of mode {mode + 1}, ω² = {number(result.square, SQUARE)} rad²/s², referred to the reference "
        f"speed, {scaled} amplitude 1 rad, {RESIDUAL} {number(result.relative_residual, 2)}",
    )
    if constants := [row for row in rows if row.a is not None]:
        titles = "through: < Shaft | a: A:7 | h: H [rad/(N m)]:7 | b: B [N m/rad]:7 | d: D:7"
        caption = f"Constants of the shafts at the frequency of mode {mode + 1}"
        yield table(titles, constants, caption)


def plots(findings: Findings, modes: Modes, chosen: Iterable[int]) -> Iterator[Figure]:
    """Yield angle and torque of modes, counted from 0, over the train."""
    system, positions = findings.system, layout(findings.system)
    drawn = (part for part in system.train.parts if part.stations)
    main_line = [part for part in drawn if positions.row[part.stations[-1]] == 0]
    ticks = [
        (float(positions.x[list(part.stations)].mean()), part.name)
        for part in main_line
        if part.is_point or len(main_line) <= MOST_NAMES
    ]
    caption = "angle and torque, referred to the reference speed and relative to their maximum"
    for mode in chosen:
        angle = modes.shape[:, mode] / system.speed_ratio
        torque = modes.torque[:, mode] * system.span_ratio
        yield mode_shape.mode(
            f"mode-{mode + 1}",
            f"Mode {mode + 1}, {number(float(modes.frequency[mode]))} Hz: {caption}",
            x=positions.x,
            row=positions.row,
            ends=np.column_stack([system.driving, system.driven]),
            marked=np.arange(len(system.stations)) < len(system.train.stations),
            angle=angle / angle[np.argmax(np.abs(angle))],
            torque=torque / np.abs(torque).max(initial=np.finfo(float).tiny),
            ticks=ticks,
            stations=[station.name for station in system.train.stations],
            spans=[span.name for span in system.spans],
        )
