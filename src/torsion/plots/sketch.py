"""The plant sketch: discs as bars by their inertia, shafts, couplings, gears and joints in their places."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle

from torsion.plots.style import COLOURS, INK, page

ROW = 2.9  # distance of the rows, in the unit of the places
FILLS = {"motor": "#bcd5e8", "propeller": "#bfe3d5", "damper": "#ead2e0", "disc": "#dcdcdc"}


@dataclass(frozen=True)
class Disc:
    """A point of the train as it is drawn."""

    x: float
    row: float
    size: float  # 0..1 by the logarithm of the inertia
    label: str
    kind: str
    is_held: bool = False
    is_grounded: bool = False  # a spring to ground
    ring: float = 0.0  # size of a damper's ring


@dataclass(frozen=True)
class Link:
    """A link of the train as it is drawn."""

    kind: str  # shaft, coupling, gear, joint, rigid, tie (down to a branch)
    start: tuple[float, float]  # x, row
    end: tuple[float, float]
    label: str = ""
    bore: float = 0.0  # of a shaft: bore / diameter
    taper: tuple[float, float] = (1.0, 1.0)  # of a shaft: relative diameters at its ends
    ratio: float = 1.0  # of a gear: speed of the driven / speed of the driving wheel


def sketch(name: str, *, points: Sequence[Mapping[str, Any]], links: Sequence[Mapping[str, Any]]) -> str:
    """The train from its driving end, branches on lower rows, not to scale: the fields of every Disc and Link."""
    return _drawn(name, [Disc(**point) for point in points], [Link(**link) for link in links])


def _drawn(name: str, discs: Sequence[Disc], links: Sequence[Link]) -> str:
    rows = [0.0, *(disc.row for disc in discs), *(end[1] for link in links for end in (link.start, link.end))]
    top, low = min(rows), max(rows)
    with page(name, 0.55 + 1.45 * (1.0 + low - top)) as sheet:
        axes = sheet.axes[0]
        axes.axis("off")
        for link in links:
            DRAWINGS[link.kind](axes, link)
        for disc in discs:
            _disc(axes, disc)
        _labels(axes, discs, links)
        x = [d.x for d in discs] + [v for k in links for v in (k.start[0], k.end[0])]
        axes.set_xlim(min(x, default=0.0) - 0.5, max(x, default=1.0) + 0.5)
        axes.set_ylim(_y(low) - 1.55, _y(top) + 1.5)
    return sheet.svg


def _y(row: float) -> float:
    return -ROW * row


def _disc(axes: Axes, disc: Disc) -> None:
    y, half, thick = _y(disc.row), 0.25 + 0.55 * disc.size, 0.17
    if disc.is_held:
        _ground(axes, disc.x, y, 0.5, vertical=True)
        return
    if disc.ring:
        tall = half + 0.13 + 0.12 * disc.ring
        _box(axes, disc.x, y, thick + 0.14, tall, "white", linestyle="--")
    _box(axes, disc.x, y, thick, half, FILLS.get(disc.kind, FILLS["disc"]))
    if disc.is_grounded:
        _zigzag(axes, (disc.x, y - half), (disc.x, y - half - 0.45), 0.07)
        _ground(axes, disc.x, y - half - 0.45, 0.2, vertical=False)


def _box(axes: Axes, x: float, y: float, width: float, half: float, fill: str, linestyle: str = "-") -> None:
    corner = (x - width / 2, y - half)
    axes.add_patch(Rectangle(corner, width, 2 * half, facecolor=fill, edgecolor=INK, lw=0.8, ls=linestyle, zorder=3))


def _ground(axes: Axes, x: float, y: float, half: float, *, vertical: bool) -> None:
    marks = np.linspace(-half, half, 6)
    if vertical:
        axes.plot([x, x], [y - half, y + half], color=INK, lw=1.4)
        for mark in marks:
            axes.plot([x, x + 0.12], [y + mark, y + mark - 0.14], color=INK, lw=0.6)
    else:
        axes.plot([x - half, x + half], [y, y], color=INK, lw=1.4)
        for mark in marks:
            axes.plot([x + mark, x + mark - 0.07], [y, y - 0.13], color=INK, lw=0.6)


def _zigzag(axes: Axes, start: tuple[float, float], end: tuple[float, float], size: float = 0.16) -> None:
    """A spring between two places."""
    along = np.array([0.0, 0.2, 0.26, 0.38, 0.5, 0.62, 0.74, 0.8, 1.0])
    across = np.array([0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 1.0, 0.0, 0.0]) * size
    span = np.subtract(end, start)
    normal = np.array([-span[1], span[0]]) / max(float(np.hypot(*span)), 1e-9)
    points = np.array(start) + along[:, None] * span + across[:, None] * normal
    axes.plot(points[:, 0], points[:, 1], color=INK, lw=0.9, solid_joinstyle="miter")


def _coupling(axes: Axes, link: Link) -> None:
    _zigzag(axes, (link.start[0], _y(link.start[1])), (link.end[0], _y(link.end[1])))


def _shaft(axes: Axes, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), (_y(link.start[1]), _y(link.end[1]))
    first, last = (0.12 * share for share in link.taper)
    corners = [(x0, y[0] - first), (x0, y[0] + first), (x1, y[1] + last), (x1, y[1] - last)]
    axes.add_patch(Polygon(corners, facecolor="#f3f3f3", edgecolor=INK, lw=0.8, zorder=2))
    for sign in (-1, 1) if link.bore else ():
        ends = [y[0] + sign * first * link.bore, y[1] + sign * last * link.bore]
        axes.plot([x0, x1], ends, color=INK, lw=0.5, ls=(0, (3, 2)), zorder=3)


def _gear(axes: Axes, link: Link) -> None:
    """Two wheels that mesh; their heights follow the ratio."""
    (x0, row0), (x1, row1) = link.start, link.end
    small = 0.26
    driving, driven = (small, small / link.ratio) if link.ratio < 1 else (small * link.ratio, small)
    largest = max(driving, driven)
    driving, driven = (0.75 * half / largest if largest > 0.75 else half for half in (driving, driven))
    if row0 == row1:
        middle = (x0 + x1) / 2
        axes.plot([x0, x1], [_y(row0), _y(row1)], color=INK, lw=1.1)
        _wheel(axes, middle - 0.08, _y(row0), max(driving, 0.16))
        _wheel(axes, middle + 0.08, _y(row1), max(driven, 0.16))
    else:
        axes.plot([x0, x0, x1], [_y(row0), _y(row1), _y(row1)], color=INK, lw=0.7, ls=(0, (1, 2)))
        _wheel(axes, x1 - 0.1, _y(row1), max(driven, 0.16))


def _wheel(axes: Axes, x: float, y: float, half: float) -> None:
    corner = (x - 0.07, y - half)
    axes.add_patch(
        Rectangle(corner, 0.14, 2 * half, facecolor="#fbe3c8", edgecolor=INK, lw=0.7, hatch="-----", zorder=3)
    )


def _joint(axes: Axes, link: Link) -> None:
    (x0, x1), y = (link.start[0], link.end[0]), _y(link.start[1])
    middle = (x0 + x1) / 2
    axes.plot([x0, middle - 0.14], [y, y], color=INK, lw=1.1)
    axes.plot([middle + 0.14, x1], [y, y], color=INK, lw=1.1)
    for sign in (-1, 1):
        axes.plot([middle - 0.14, middle + 0.14], [y - sign * 0.26, y + sign * 0.26], color=COLOURS[1], lw=1.8)
    axes.plot([middle], [y], "o", color="white", markeredgecolor=COLOURS[1], markersize=4, zorder=4)


def _line(axes: Axes, link: Link) -> None:
    (x0, row0), (x1, row1) = link.start, link.end
    style = {"rigid": "-", "tie": (0, (1, 2))}[link.kind]
    axes.plot([x0, x0, x1], [_y(row0), _y(row1), _y(row1)], color=INK, lw=1.1, ls=style)


def _labels(axes: Axes, discs: Sequence[Disc], links: Sequence[Link]) -> None:
    """Points above, links below; neighbours on two heights so that names do not run into each other."""
    above: dict[float, int] = {}
    for disc in discs:
        level = above[disc.row] = above.get(disc.row, -1) + 1
        y = _y(disc.row) + 0.95 + 0.28 * (level % 2)
        axes.text(disc.x, y, disc.label, ha="center", va="bottom", fontsize=7.5, color=INK)
        axes.plot([disc.x, disc.x], [_y(disc.row) + 0.3, y], color="#bbbbbb", lw=0.4, zorder=0)
    below: dict[float, int] = {}
    for link in links:
        if not link.label:
            continue
        row = link.end[1]
        level = below[row] = below.get(row, -1) + 1
        x, y = (link.start[0] + link.end[0]) / 2, _y(row) - 0.85 - 0.28 * (level % 2)
        axes.text(x, y, link.label, ha="center", va="top", fontsize=7.5, color="#33506b")
        axes.plot([x, x], [_y(row) - 0.3, y], color="#bbbbbb", lw=0.4, zorder=0)


DRAWINGS = {"shaft": _shaft, "coupling": _coupling, "gear": _gear, "joint": _joint, "rigid": _line, "tie": _line}
