"""Chapter: natural frequencies with their certificate, mode plots, Holzer tables and energy shares."""

import math

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly.segment_groups import segment_groups
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Figure, Heading, Paragraph, Table, head, texts
from torsion.output.chapters.holzer_table import holzer_table
from torsion.output.elastic_elements import elements
from torsion.output.numbers import number, rpm
from torsion.output.station_layout import Layout, layout

MOST_NAMES = 14  # components on the main line up to which links are named under a mode plot
MOST_MODES = 12  # of which plots and tables are printed
MOST_SEGMENTS = 500  # of a shaft that are drawn
SMALLEST_SHARE = 0.005  # of the energy of a mode; less is not listed


def chapter(findings: Findings) -> list[Block]:
    """Nothing when no frequency was requested."""
    modes = findings.get(Modes)
    if modes is None:
        return []
    blocks: list[Block] = [Heading("Natural frequencies"), _introduction(modes)]
    if len(modes.frequency) == 0:
        return blocks
    blocks.append(_frequencies(modes))
    damped = findings.get(DampedModes)
    if damped is not None:
        blocks.extend(_damped(damped))
    blocks.extend([Heading("Energy shares", 2), _shares(findings, modes)])
    shown = min(len(modes.frequency), MOST_MODES)
    for mode in range(shown):
        title = f"Mode {mode + 1}: {number(float(modes.frequency[mode]))} Hz"
        blocks.extend([Heading(title, 2), _plot(findings, modes, mode), *holzer_table(findings, modes, mode)])
    if shown < len(modes.frequency):
        text = f"Plots and tables of modes {shown + 1} to {len(modes.frequency)} are left out; see results.json."
        blocks.append(Paragraph(text))
    return blocks


def _introduction(modes: Modes) -> Paragraph:
    rigid = {0: "The train has no rigid motion", 1: "The train turns freely: one rigid motion of exactly 0 Hz"}
    first = rigid.get(modes.rigid, f"{modes.rigid} rigid motions of exactly 0 Hz")
    count = len(modes.frequency)
    enclosed = (
        "Counts of eigenvalues below and above each value (Sturm sequences) prove that exactly the listed mode lies "
        "between the two bounds, and that none was missed."
        if modes.certified
        else "The bounds of these frequencies were not certified by counts."
    )
    return Paragraph(f"{first}; {count} elastic mode{'' if count == 1 else 's'} of the undamped train. {enclosed}")


def _frequencies(modes: Modes) -> Table:
    columns = head(
        "Mode -> | Frequency [Hz] -> Hz | Per minute [1/min] -> per minute | Angular [rad/s] | Nodes -> | "
        "Lower bound [Hz] | Upper bound [Hz] | Width / frequency"
    )
    rows = []
    for index, f in enumerate(modes.frequency.tolist()):
        low, high = float(modes.lower[index]), float(modes.upper[index])
        rows.append((
            str(index + 1), number(f, 7), number(60.0 * f, 7), number(2 * math.pi * f, 7),
            str(int(modes.nodes[index])), number(low, 10), number(high, 10), number((high - low) / f, 2),
        ))  # fmt: skip
    return Table(columns, tuple(rows), "Natural frequencies of the undamped train", short="Natural frequencies")


def _damped(damped: DampedModes) -> list[Block]:
    columns = head(
        "Mode -> | Frequency [Hz] -> Hz | Per minute [1/min] -> per minute | Damping ratio [%] -> damping ratio, % | "
        "Magnifier 1/(2ζ) | Decay [1/s]"
    )
    rows = []
    for index, f in enumerate(damped.frequency.tolist()):
        ratio = float(damped.damping_ratio[index])
        rows.append((
            str(index + 1), number(f, 7), number(60.0 * f, 7), number(100 * ratio, 4),
            number(0.5 / ratio if ratio > 0 else math.inf, 4), number(-float(damped.eigenvalue[index].real), 4),
        ))  # fmt: skip
    at = f", damping as at {rpm(damped.speed)} rpm" if damped.speed > 0 else ""
    title = f"Damped natural frequencies{at}"
    blocks: list[Block] = [Table(columns, tuple(rows), title, short=title)]
    if len(damped.overdamped):
        roots = ", ".join(number(root, 4) for root in damped.overdamped.tolist()[:8])
        more = ", …" if len(damped.overdamped) > 8 else ""
        blocks.append(Paragraph(f"Motions that decay without oscillation (overdamped): {roots}{more} 1/s."))
    return blocks


def _shares(findings: Findings, modes: Modes) -> Table:
    shown = min(len(modes.frequency), MOST_MODES)
    columns = (texts("Part"), *(Column(f"Mode {m + 1}", "%") for m in range(shown)))
    rows = [_share_row(f"kinetic: {name}", values) for name, values in _kinetic(findings, modes, shown)]
    for element in elements(findings.system):
        share = modes.elastic[list(element.spans), :shown].sum(axis=0)
        rows.append(_share_row(f"elastic: {element.name}", share))
    kept = tuple(row for row in rows if any(cell != "" for cell in row[1:]))
    caption = f"Shares of the kinetic and the elastic energy; below {100 * SMALLEST_SHARE:g} % left blank"
    return Table(columns, kept, caption)


def _kinetic(findings: Findings, modes: Modes, shown: int) -> list[tuple[str, FloatArray]]:
    """Kinetic shares: of the train's own stations by name, of all inner stations of a shaft together."""
    system, own = findings.system, len(findings.system.train.stations)
    found = [(system.stations[k].name, modes.kinetic[k, :shown]) for k in range(own)]
    inside = "inner segments" if system.bars is None else "between its pieces"
    for bar in system.train.bars:
        inner = own + np.flatnonzero(system.station_part[own:] == bar.part)
        if inner.size:
            found.append((f"{bar.name} ({inside})", modes.kinetic[inner, :shown].sum(axis=0)))
    return found


def _share_row(name: str, share: FloatArray) -> tuple[str, ...]:
    return (name, *(f"{100 * value:.1f}" if value >= SMALLEST_SHARE else "" for value in share.tolist()))


def _ticks(findings: Findings, place: Layout) -> list[tuple[float, str]]:
    """Names of what stands on the main line: of links too where there is room for them."""
    parts = [part for part in findings.system.train.parts if part.stations and place.row[part.stations[-1]] == 0]
    links = len(parts) <= MOST_NAMES
    return [(float(place.x[list(part.stations)].mean()), part.name) for part in parts if part.is_point or links]


def _plot(findings: Findings, modes: Modes, mode: int) -> Figure:
    system, place = findings.system, layout(findings.system)
    drawn = segment_groups(system, MOST_SEGMENTS)
    angle = (modes.shape[:, mode] / system.speed_ratio)[drawn.stations]
    torque = (modes.torque[:, mode] * system.span_ratio)[drawn.spans]
    largest = angle[np.argmax(np.abs(angle))]
    own = drawn.stations < len(system.train.stations)
    values = {
        "x": place.x[drawn.stations], "row": place.row[drawn.stations], "ends": drawn.ends, "marked": own,
        "angle": angle / largest, "torque": torque / np.abs(torque).max(initial=np.finfo(float).tiny),
        "ticks": _ticks(findings, place),
    }  # fmt: skip
    f = number(float(modes.frequency[mode]))
    caption = (
        f"Mode {mode + 1}, {f} Hz: angle and torque referred to the reference speed, relative to their largest value"
    )
    if not drawn.is_whole:
        longest = drawn.longest * (1 if system.groups is None else system.groups.longest)
        caption += f"; of long shafts every {longest}th segment is drawn"
    return Figure(f"mode-{mode + 1}", caption, "mode", values)
