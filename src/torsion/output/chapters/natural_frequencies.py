"""Chapter: natural frequencies with their certificate, mode plots, Holzer tables and energy shares."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.holzer import holzer
from torsion.analyses.undamped_modes import Modes
from torsion.assembly.system import segment_groups
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import mode_shape
from torsion.output.figures.figure import Figure
from torsion.output.numbers import NONE, counted, number, rpm
from torsion.output.selection import elements
from torsion.output.station_layout import MOST_NAMES, layout

MOST_MODES = 12  # of which plots and tables are printed
MOST_SEGMENTS = 500  # of a shaft that are drawn
SMALLEST_SHARE = 0.005  # of the energy of a mode; less is not listed
MOST_TIMES_FIRST = 1e3  # an amplitude larger than so many times the first: then the largest of a Holzer table is 1
OVERDAMPED = 8  # roots that are listed


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing when no frequency was requested."""
    modes, damped = findings.get(Modes), findings.get(DampedModes)
    if modes is None:
        return
    yield Heading("Natural frequencies")
    yield _introduction(modes)
    if len(modes.frequency) == 0:
        return
    yield _frequencies(modes)
    if damped is not None:
        yield from _damped(damped)
    yield Heading("Energy shares", 2)
    yield _shares(findings, modes)
    shown = min(len(modes.frequency), MOST_MODES)
    for mode, frequency in enumerate(modes.frequency[:shown].tolist()):
        yield Heading(f"Mode {mode + 1}: {number(frequency)} Hz", 2)
        yield _plot(findings, modes, mode)
        yield holzer_table(findings, modes, mode)
    if shown < len(modes.frequency):
        text = f"Plots and tables of modes {shown + 1} to {len(modes.frequency)} are left out; see results.json."
        yield Paragraph(text)


def _introduction(modes: Modes) -> Paragraph:
    rigid = {0: "The train has no rigid motion", 1: "The train turns freely: one rigid motion of exactly 0 Hz"}
    first = rigid.get(modes.rigid, f"{modes.rigid} rigid motions of exactly 0 Hz")
    enclosed = (
        "Counts of eigenvalues below and above each value (Sturm sequences) prove that exactly the listed mode lies "
        "between the two bounds, and that none was missed."
        if modes.certified
        else "The bounds of these frequencies were not certified by counts."
    )
    return Paragraph(f"{first}; {counted(len(modes.frequency), 'elastic mode')} of the undamped train. {enclosed}")


def _frequencies(modes: Modes) -> Table:
    bounds = np.transpose([modes.frequency, modes.lower, modes.upper, modes.nodes]).tolist()
    return table(
        "Mode -> | Frequency [Hz] -> Hz | Per minute [1/min] -> per minute | Angular [rad/s] | Nodes -> | "
        "Lower bound [Hz] | Upper bound [Hz] | Width / frequency",
        [
            (mode, number(f, 7), number(60.0 * f, 7), number(2 * math.pi * f, 7), int(nodes), number(low, 10),
             number(high, 10), number((high - low) / f, 2))
            for mode, (f, low, high, nodes) in enumerate(bounds, start=1)
        ],
        "Natural frequencies of the undamped train",
        short="Natural frequencies",
    )  # fmt: skip


def _damped(damped: DampedModes) -> Iterator[Block]:
    roots = np.transpose([damped.frequency, damped.damping_ratio, damped.eigenvalue.real]).tolist()
    title = "Damped natural frequencies" + (f", damping as at {rpm(damped.speed)} rpm" if damped.speed > 0 else "")
    yield table(
        "Mode -> | Frequency [Hz] -> Hz | Per minute [1/min] -> per minute | Damping ratio [%] -> damping ratio, % | "
        "Magnifier 1/(2ζ) | Decay [1/s]",
        [
            (mode, number(f, 7), number(60.0 * f, 7), number(100 * ratio, 4),
             number(0.5 / ratio if ratio > 0 else math.inf, 4), number(-real, 4))
            for mode, (f, ratio, real) in enumerate(roots, start=1)
        ],
        title,
        short=title,
    )  # fmt: skip
    if len(damped.overdamped):
        listed = ", ".join(number(root, 4) for root in damped.overdamped.tolist()[:OVERDAMPED])
        more = ", …" if len(damped.overdamped) > OVERDAMPED else ""
        yield Paragraph(f"Motions that decay without oscillation (overdamped): {listed}{more} 1/s.")


def _shares(findings: Findings, modes: Modes) -> Table:
    """Of stations by name, of all inner stations of a shaft together, and of elements."""
    system, own, shown = findings.system, len(findings.system.train.stations), min(len(modes.frequency), MOST_MODES)
    shares = [(f"kinetic: {system.stations[k].name}", modes.kinetic[k]) for k in range(own)]
    inside = "inner segments" if system.bars is None else "between its pieces"
    for bar in system.train.bars:
        inner = own + np.flatnonzero(system.station_part[own:] == bar.part)
        if inner.size:
            shares.append((f"kinetic: {bar.name} ({inside})", modes.kinetic[inner].sum(axis=0)))
    shares += [(f"elastic: {e.name}", modes.elastic[list(e.spans)].sum(axis=0)) for e in elements(system)]
    rows = [
        (name, *(f"{100 * value:.1f}" if value >= SMALLEST_SHARE else "" for value in share[:shown].tolist()))
        for name, share in shares
        if (share[:shown] >= SMALLEST_SHARE).any()
    ]
    titles = "< Part" + "".join(f" | Mode {mode + 1} [%]" for mode in range(shown))
    caption = f"Shares of the kinetic and the elastic energy; below {100 * SMALLEST_SHARE:g} % left blank"
    return table(titles, rows, caption)


def holzer_table(findings: Findings, modes: Modes, mode: int) -> Table:
    """Of a train with loops the rows of its tree; inner segments of a shaft are summed into the row of its end."""
    system, found = findings.system, holzer(findings.system, modes, mode)
    largest, own = float(np.abs(found.angle).max()), len(system.train.stations)
    scale, first = (largest, "largest") if largest > MOST_TIMES_FIRST else (1.0, "first")
    printed = np.flatnonzero(found.station < own)
    starts, end = np.append(0, printed[:-1] + 1), int(printed[-1]) + 1  # what is behind the last belongs to no row
    bars = {bar.part: bar.name for bar in system.train.bars}
    columns = found.referred_inertia, found.inertia_torque, found.flexibility, found.twist
    sums = [np.add.reduceat(column[:end], starts).tolist() for column in columns]
    rows = []
    for place, row in enumerate(printed.tolist()):
        inertia, torque, flexibility, twist = (column[place] for column in sums)
        span, through = int(found.span[row]), [NONE] * 4
        if span >= 0:
            name = bars.get(system.spans[span].part, system.spans[span].name)
            stiff = "rigid" if flexibility == 0 else number(flexibility)
            through = [name, number(float(found.torque[row]) / scale), stiff, number(twist / scale)]
        rows.append((
            system.stations[int(found.station[row])].name, "held" if math.isinf(inertia) else inertia,
            number(float(found.angle[row]) / scale, 6), torque / scale, *through,
        ))  # fmt: skip
    pieces = "segments"
    if system.bars is not None:
        pieces = "pieces, each the spring between two inertias that it is at this frequency,"
    also = f" A shaft's {pieces} are summed up in the row of its end." if own < len(system.stations) else ""
    return table(
        "< Station | J referred [kg m²] | Angle [rad] | ω² J × angle [N m] | < Through | Torque [N m] | "
        "Flexibility [rad/(N m)] | Twist [rad]",
        rows,
        f"Holzer table of mode {mode + 1}, referred to the reference speed, {first} amplitude 1 rad.{also}",
    )


def _plot(findings: Findings, modes: Modes, mode: int) -> Figure:
    system, place = findings.system, layout(findings.system)
    drawn = segment_groups(system, MOST_SEGMENTS)
    angle = (modes.shape[:, mode] / system.speed_ratio)[drawn.stations]
    torque = (modes.torque[:, mode] * system.span_ratio)[drawn.spans]
    parts = [part for part in system.train.parts if part.stations and place.row[part.stations[-1]] == 0]
    links = len(parts) <= MOST_NAMES  # on the main line: more are not named
    f = number(float(modes.frequency[mode]))
    caption = (
        f"Mode {mode + 1}, {f} Hz: angle and torque referred to the reference speed, relative to their largest value"
    )
    if not drawn.is_whole:
        longest = drawn.longest * (1 if system.groups is None else system.groups.longest)
        caption += f"; of long shafts every {longest}th segment is drawn"
    return mode_shape.mode(
        f"mode-{mode + 1}", caption, x=place.x[drawn.stations], row=place.row[drawn.stations], ends=drawn.ends,
        marked=drawn.stations < len(system.train.stations), angle=angle / angle[np.argmax(np.abs(angle))],
        torque=torque / np.abs(torque).max(initial=np.finfo(float).tiny),
        ticks=[(float(place.x[list(p.stations)].mean()), p.name) for p in parts if p.is_point or links],
    )  # fmt: skip
