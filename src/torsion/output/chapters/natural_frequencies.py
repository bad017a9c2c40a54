"""Chapter: natural frequencies with their certificate, mode plots, Holzer tables and energy shares."""

import math
from collections.abc import Iterable, Iterator
from itertools import islice

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.modes.holzer import HolzerTable, holzer
from torsion.analyses.modes.hub_moves import HubMoves
from torsion.analyses.modes.sharp_steps import SharpSteps
from torsion.analyses.response.amplitudes import FrequencyResponse, Response
from torsion.analyses.undamped_modes import Modes
from torsion.assembly.system import segment_groups
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.chapters.critical_speeds import matrix
from torsion.output.chapters.sharp_steps import moved_by_hubs, sharp_steps
from torsion.output.figures import mode_shape
from torsion.output.figures.figure import Figure
from torsion.output.numbers import LESS, NONE, ROUNDING, counted, number, rpm
from torsion.output.selection import by_part, elements
from torsion.output.station_layout import MOST_NAMES, layout
from torsion.results import listed

MOST_IN_SUMMARY = 6  # on the terminal without `-v`
MOST_MODES = 12  # with a shape and a Holzer table in the full report
MODES_WITHOUT_ORDERS = 6  # with a shape where nothing excites
MOST_TABLES, FEW_ROWS = 3, 50  # Holzer tables of the report, and their rows
MOST_ROWS = 600  # rows of all Holzer tables of the full report
MOST_SEGMENTS = 500  # of a shaft that are drawn
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
OVERDAMPED = 8  # roots that are listed


def chapter(findings: Findings) -> Iterator[Block]:
    """Frequencies, and the shapes of the modes up to the highest excited frequency."""
    modes, damped = findings.get(Modes), findings.get(DampedModes)
    if modes is None:
        return
    yield Heading("Natural frequencies and mode shapes")
    yield _introduction(modes)
    nonlinear = [
        f"{part.name} {part.nonlinear.words}"
        for part in findings.study.train.parts
        if part.nonlinear
    ]
    if nonlinear:
        text = f"The modes take these couplings as linear: {listed(nonlinear, '; ')}. The error depends on the amplitude."
        yield Paragraph(text, "note")
    if findings.study.train.follows_speed and findings.study.operation.speed is not None:
        yield Paragraph(
            f"A stiffness depends on the speed. The modes are those at {rpm(findings.study.operation.speed)} rpm."
        )
    if len(modes.frequency) == 0:
        return
    yield frequencies(modes)
    if (steps := findings.get(SharpSteps)) is not None:
        yield from sharp_steps(steps)
    if (hubs := findings.get(HubMoves)) is not None:
        yield from moved_by_hubs(hubs)
    if damped is not None:
        yield from _damped(damped)
    count = excited_modes(findings, modes)
    yield from plots(findings, modes, range(count))
    if count < len(modes.frequency):
        yield Paragraph(
            f"The figures show modes 1 to {count} of {len(modes.frequency)}, up to the highest excited frequency. "
            f"The full report (--full) shows {MOST_MODES}."
        )


def excited_modes(findings: Findings, modes: Modes) -> int:
    """Return the number of modes up to the highest excited frequency, at least 1 and at most MOST_MODES."""
    responses = findings.get(Response), findings.get(FrequencyResponse)
    highest = max(
        (
            float(response.frequency.max(initial=0.0))
            for response in responses
            if response is not None
        ),
        default=0.0,
    )
    count = int((modes.frequency <= highest).sum()) if highest else MODES_WITHOUT_ORDERS
    return min(max(count, 1), len(modes.frequency), MOST_MODES)


def appendix(findings: Findings) -> Iterator[Block]:
    """Appendix: Holzer tables of the lowest excited modes, energy shares, and the order-by-mode matrix."""
    modes = findings.get(Modes)
    if modes is None or len(modes.frequency) == 0:
        return
    yield Heading("Appendix: Holzer tables")
    yield Paragraph(HOW_TO_READ)
    for mode in range(_tables(findings, modes)):
        yield next(holzer_tables(findings, modes, mode))
    yield _shares(findings, modes)
    yield from matrix(findings)


def _tables(findings: Findings, modes: Modes) -> int:
    """Return the number of Holzer tables in the report: at most MOST_TABLES, and FEW_ROWS rows of all of them."""
    by_rows = max(1, FEW_ROWS // len(findings.study.train.stations))
    return min(excited_modes(findings, modes), MOST_TABLES, by_rows)


def all_modes(findings: Findings) -> Iterator[Block]:
    """Appendix of the full report: the other shapes and Holzer tables, and the constants of distributed shafts."""
    modes = findings.get(Modes)
    if modes is None or len(modes.frequency) == 0:
        return
    yield Heading("Appendix: all modes")
    drawn, count = excited_modes(findings, modes), min(len(modes.frequency), MOST_MODES)
    yield from plots(findings, modes, range(drawn, count))
    tables = max(MOST_TABLES, MOST_ROWS // len(findings.study.train.stations))
    for mode in range(min(count, tables)):
        printed = 1 if mode < _tables(findings, modes) else 0
        yield from islice(holzer_tables(findings, modes, mode), printed, None)
    if tables < count:
        yield Paragraph(f"The first {tables} modes have a Holzer table.")
    if count < len(modes.frequency):
        yield Paragraph(f"Modes {count + 1} to {len(modes.frequency)} are in results.json.")


def _introduction(modes: Modes) -> Paragraph:
    rigid = {0: "The train has no rigid-body mode", 1: "The train has one rigid-body mode (0 Hz)"}
    first = rigid.get(modes.rigid, f"The train has {modes.rigid} rigid-body modes (0 Hz)")
    enclosed = (
        "The frequencies are certified: Sturm counts prove that exactly one mode lies between its two bounds and that "
        "no mode is missing."
        if modes.certified
        else "The bounds of these frequencies are not certified by Sturm counts."
    )
    return Paragraph(
        f"{first} and {counted(len(modes.frequency), 'elastic mode')} (undamped). {enclosed}"
    )


def frequencies(modes: Modes) -> Table:
    """Of the undamped train, with their bounds."""
    bounds = np.transpose([modes.frequency, modes.lower, modes.upper, modes.nodes]).tolist()
    lowest = ", ".join(number(frequency) for frequency in modes.frequency[:MOST_IN_SUMMARY])
    more = ", ..." if len(modes.frequency) > MOST_IN_SUMMARY else ""
    return table(
        "Mode -> | Frequency [Hz] -> Hz | Per minute [1/min] -> per minute | Nodes -> | Lower bound [Hz] | "
        "Upper bound [Hz]",
        [
            (mode, number(f, 7), number(60.0 * f, 7), int(nodes), number(low, 10), number(high, 10))
            for mode, (f, low, high, nodes) in enumerate(bounds, start=1)
        ],
        "Natural frequencies of the undamped train",
        short="Natural frequencies",
        summary=f"Natural frequencies: {lowest}{more} Hz" if lowest else "",
    )


def _damped(damped: DampedModes) -> Iterator[Block]:
    roots = np.transpose([damped.frequency, damped.damping_ratio]).tolist()
    title = "Damped natural frequencies" + (
        f", damping at {rpm(damped.speed)} rpm" if damped.speed > 0 else ""
    )
    yield table(
        "Mode -> | Frequency [Hz] -> Hz | Damping ratio [%] -> damping ratio, % | Magnifier 1/(2ζ)",
        [
            (
                mode,
                number(f, 7),
                number(100 * ratio, 4),
                number(0.5 / ratio if ratio > 0 else math.inf, 4),
            )
            for mode, (f, ratio) in enumerate(roots, start=1)
        ],
        title,
        short=title,
    )
    if len(damped.overdamped):
        roots_shown = ", ".join(number(root, 4) for root in damped.overdamped.tolist()[:OVERDAMPED])
        more = ", …" if len(damped.overdamped) > OVERDAMPED else ""
        yield Paragraph(f"Overdamped modes (decay without oscillation): {roots_shown}{more} 1/s.")


def _shares(findings: Findings, modes: Modes) -> Table:
    """Of stations by name, of all inner stations of a shaft together, and of elements."""
    system, own, shown = (
        findings.system,
        len(findings.system.train.stations),
        min(len(modes.frequency), MOST_MODES),
    )
    shares = [(f"kinetic: {system.stations[k].name}", modes.kinetic[k]) for k in range(own)]
    inside = "inner segments"
    inner = by_part(system.station_part[own:])
    for bar in system.train.bars:
        if bar.part in inner:
            shares.append(
                (
                    f"kinetic: {bar.name} ({inside})",
                    modes.kinetic[own + inner[bar.part]].sum(axis=0),
                )
            )
    shares += [
        (f"elastic: {e.name}", modes.elastic[list(e.spans)].sum(axis=0)) for e in elements(system)
    ]
    rows = [
        (
            name,
            *(
                f"{100 * value:.1f}" if value >= SMALLEST_SHARE else ""
                for value in share[:shown].tolist()
            ),
        )
        for name, share in shares
        if (share[:shown] >= SMALLEST_SHARE).any()
    ]
    titles = "< Part" + "".join(f" | Mode {mode + 1} [%]" for mode in range(shown))
    caption = f"Shares of the kinetic and elastic energy; below {100 * SMALLEST_SHARE:g} % blank"
    return table(titles, rows, caption)


def holzer_tables(findings: Findings, modes: Modes, mode: int) -> Iterator[Table]:
    """The table of a mode, and the constants of shafts with inertia between their ends, where there are such."""
    system, found = findings.system, holzer(findings.system, modes, mode)
    rows, constants = [], []
    for row, (angle, moved, enters, leaves, twist) in enumerate(_settled(found)):
        inertia = float(found.inertia[row])
        link, station = found.links[row], system.stations[int(found.station[row])].name
        own = ["fixed", number(angle, HOLZER), "fixed"]
        if math.isfinite(inertia):
            own = [number(value, HOLZER) for value in (inertia, angle, moved)]
        if found.is_chord[row]:
            station, own = f"{station}, closing a loop", [NONE, number(angle, HOLZER), NONE]
        through = [NONE] * 6
        if link is not None:
            at_rest = (
                number(float(found.flexibility[row]), HOLZER) if found.flexibility[row] else "rigid"
            )
            if np.isfinite(found.transfer[row]).all():
                at_rest = "A, H, B, D"
                (a, h), (b, d) = found.transfer[row].tolist()
                constants.append((link.name, *(number(one, HOLZER) for one in (a, -h, b, d))))
            torques = (number(one, HOLZER) for one in (enters, twist, leaves))
            before, (entering, turned, leaving) = str(int(found.before[row]) + 1), torques
            through = [before, link.name, entering, at_rest, turned, leaving]
        rows.append((row + 1, station, *own, *through))
    scaled = "first" if found.angle[0] == 1.0 else "largest"
    yield table(
        "No. | < Station | J referred [kg m²] | Angle [rad] | ω² J × angle [N m] | From no. | < Through | "
        "Torque in [N m] | Flexibility [rad/(N m)] | Twist [rad] | Torque out [N m]",
        rows,
        f"Holzer table of mode {mode + 1}, ω² = {number(found.square, SQUARE)} rad²/s², referred to the reference "
        f"speed, {scaled} amplitude 1 rad, {RESIDUAL} {number(found.relative_residual, 2)}",
    )
    if constants:
        titles = "< Shaft | A | H [rad/(N m)] | B [N m/rad] | D"
        yield table(
            titles, constants, f"Constants of the shafts at the frequency of mode {mode + 1}"
        )


def _settled(found: HolzerTable) -> list[list[float]]:
    """Angle, omega^2 J angle, torque in and out and twist of every row, 0 where they may be rounding.

    A heavy station may hardly move and yet carry a torque: an angle and its torque are 0 together, likewise a torque
    and its twist.
    """
    at = np.array([found.angle, found.inertia_torque])
    link = np.array([found.torque_in, found.torque_out, found.twist])
    torque, angle = np.abs(link[:2]).max(), np.abs(found.angle).max()
    at[
        :,
        (np.abs(at) < ROUNDING * np.array([[angle], [max(torque, np.abs(at[1]).max())]])).all(
            axis=0
        ),
    ] = 0.0
    link[:, (np.abs(link) < ROUNDING * np.array([[torque], [torque], [angle]])).all(axis=0)] = 0.0
    rows: list[list[float]] = np.transpose([*at, *link]).tolist()
    return rows


def plots(findings: Findings, modes: Modes, chosen: Iterable[int]) -> Iterator[Figure]:
    """Angle and torque of modes, counted from 0, over the train."""
    system, place = findings.system, layout(findings.system)
    drawn = segment_groups(system, MOST_SEGMENTS)
    parts = [
        part for part in system.train.parts if part.stations and place.row[part.stations[-1]] == 0
    ]
    links = len(parts) <= MOST_NAMES  # on the main line: more are not named
    ticks = [
        (float(place.x[list(p.stations)].mean()), p.name) for p in parts if p.is_point or links
    ]
    caption = "angle and torque, referred to the reference speed and relative to their maximum"
    if not drawn.is_whole:
        longest = drawn.longest * (1 if system.groups is None else system.groups.longest)
        caption += f"; long shafts are drawn with every {longest}th segment"
    for mode in chosen:
        angle = (modes.shape[:, mode] / system.speed_ratio)[drawn.stations]
        torque = (modes.torque[:, mode] * system.span_ratio)[drawn.spans]
        yield mode_shape.mode(
            f"mode-{mode + 1}",
            f"Mode {mode + 1}, {number(float(modes.frequency[mode]))} Hz: {caption}",
            x=place.x[drawn.stations],
            row=place.row[drawn.stations],
            ends=drawn.ends,
            marked=drawn.stations < len(system.train.stations),
            angle=angle / angle[np.argmax(np.abs(angle))],
            torque=torque / np.abs(torque).max(initial=np.finfo(float).tiny),
            ticks=ticks,
            stations=[one.name for one in system.train.stations],
            spans=[system.spans[one].name for one in drawn.spans.tolist()],
        )
