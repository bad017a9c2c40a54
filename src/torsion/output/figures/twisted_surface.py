"""The train twisted by one mode, seen from its driven end and from above: coloured by angle, with stripes that turn."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from torsion.arrays import FloatArray, IntArray
from torsion.output.figures.style import COLOURS, INK, WIDTH, plots

Label = tuple[Sequence[float], float, str]
(SIN_ASIDE, COS_ASIDE), (SIN_ABOVE, COS_ABOVE) = (  # from where the train is looked at
    (np.sin(angle), np.cos(angle)) for angle in np.radians([30.0, 14.0])
)
SCREEN = np.array([  # what goes to the right and what goes up
    [COS_ASIDE, SIN_ASIDE, 0.0], [-SIN_ASIDE * SIN_ABOVE, COS_ASIDE * SIN_ABOVE, COS_ABOVE],
])  # fmt: skip
EYE = np.cross(*SCREEN)  # the direction to who looks
LIGHT = np.array([0.45, -0.5, 0.74])
AROUND, STRIPE = 64, 8  # sides of every body; one side in so many is dark
HIGHEST = 3.9  # inch: of the surface
DOTS = 220  # per inch, of the surface; words stay words
LETTER, LINE, BAR = 0.064, 0.15, 0.55  # inch: mean width of a letter, distance of two lines, height of the colour scale
SCALE = LinearSegmentedColormap.from_list("angle", [COLOURS[0], "#9fc6de", "#f2f1ec", "#f0b48a", COLOURS[1]])


def twisted_shaft(
    sheet: Figure, *, x: FloatArray, radius: FloatArray, place: FloatArray, turn: FloatArray, angle: FloatArray,
    strip: IntArray, body: IntArray, labels: Sequence[Label],
    ties: Sequence[tuple[Sequence[float], Sequence[float]]] = (),
) -> None:  # fmt: skip
    """x, radius, place (y, z), turn (rad about x), angle (-1..1): of every ring; first ring and body of every strip.

    labels: point on the axis, how far above it (or below) there is free room, text; ties: from point to point.
    """
    corners = _corners(x, radius, place, turn)
    flat = corners @ SCREEN.T
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    metre = float(min(0.97 * WIDTH / (high - low)[0], HIGHEST / (high - low)[1]))  # inch
    words = _lines(labels, metre)
    bottom = min([float(low[1]), *(word.tip - LINE / metre for word in words)])
    top = max([float(high[1]), *(word.tip + LINE / metre for word in words)])
    sheet.set_dpi(DOTS)
    (axes,) = plots(sheet, (top - bottom) * metre + BAR)
    axes.axis("off")
    axes.set_aspect("equal")
    middle = float(low[0] + high[0]) / 2
    axes.set_xlim(middle - WIDTH / metre / 2, middle + WIDTH / metre / 2)
    axes.set_ylim(bottom, top)
    for first, last in ties:
        axes.plot(*(np.array([first, last]) @ SCREEN.T).T, color=INK, lw=0.7, ls=(0, (1, 2)), zorder=0)
    _draw(axes, corners, flat, _order(x, place, strip, body), strip, angle)
    for word in words:
        axes.plot([word.x, word.x], [word.foot, word.tip], color="#999999", lw=0.4, zorder=0)
        up = "bottom" if word.tip > word.foot else "top"
        axes.text(word.x, word.tip, word.text, ha="center", va=up, fontsize=7.5, color=INK)
    bar = sheet.colorbar(
        ScalarMappable(Normalize(-1.0, 1.0), SCALE), ax=axes, orientation="horizontal", shrink=0.35, aspect=32,
        pad=0.02, ticks=[-1.0, -0.5, 0.0, 0.5, 1.0],
    )  # fmt: skip
    bar.set_label("angle / largest, each at its own speed", fontsize=7.5)
    bar.ax.tick_params(labelsize=7.5, length=2)
    bar.outline.set_linewidth(0.4)


def _corners(x: FloatArray, radius: FloatArray, place: FloatArray, turn: FloatArray) -> FloatArray:
    """(rings, AROUND, 3) points of the twisted surface."""
    at = turn[:, None] + 2.0 * np.pi / AROUND * np.arange(AROUND)
    y, z = (place[:, k, None] + radius[:, None] * f(at) for k, f in enumerate((np.cos, np.sin)))
    return np.stack([np.broadcast_to(x[:, None], y.shape), y, z], axis=2)


def _order(x: FloatArray, place: FloatArray, strip: IntArray, body: IntArray) -> IntArray:
    """The strips from the farthest to the nearest: of two bodies side by side the one whose axis is farther, of two
    one after another that towards the driving end; inside a body from its driving end."""
    count = int(body[-1]) + 1
    first = np.searchsorted(body, np.arange(count))
    last = np.append(first[1:], body.size) - 1
    start, end = x[strip[first]], x[strip[last] + 1]
    depth = place[strip[first]] @ EYE[1:]
    reach = 1e-9 * float(np.ptp(x))
    rank = np.lexsort((start, depth))
    hidden = (end[:, None] <= start + reach) | (
        ~(end <= start[:, None] + reach) & (depth[:, None] < depth - reach)
    )  # (bodies, bodies): the row is drawn before the column
    np.fill_diagonal(hidden, False)
    waiting, drawn = hidden.sum(axis=0), list[int]()
    left = rank.tolist()
    while left:
        free = next((one for one in left if waiting[one] == 0), left[0])
        left.remove(free)
        drawn.append(free)
        waiting -= hidden[free]
    return np.concatenate([np.arange(first[one], last[one] + 1) for one in drawn])


def _draw(
    axes: Axes, corners: FloatArray, flat: FloatArray, order: IntArray, strip: IntArray, angle: FloatArray
) -> None:
    """The sides that can be seen, over each other in that order."""
    here = strip[order]
    along = np.roll(np.arange(AROUND), -1)

    def sides(values: FloatArray) -> FloatArray:
        a, b = values[here], values[here + 1]
        return np.stack([a, a[:, along], b[:, along], b], axis=2).reshape(-1, 4, values.shape[2])

    seen, solid = sides(flat), sides(corners)
    across, up = seen[:, 2] - seen[:, 0], seen[:, 3] - seen[:, 1]
    towards = across[:, 0] * up[:, 1] - across[:, 1] * up[:, 0] > 0
    normal = np.cross(solid[:, 2] - solid[:, 0], solid[:, 3] - solid[:, 1])[towards]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    light = 0.62 + 0.43 * np.clip(normal @ (LIGHT / np.linalg.norm(LIGHT)), 0.0, 1.0)
    middle = np.repeat((angle[here] + angle[here + 1]) / 2, AROUND)[towards]
    dark = np.tile(np.arange(AROUND) % STRIPE == 0, len(here))[towards]
    colour = SCALE((middle + 1.0) / 2.0)
    colour[:, :3] *= np.where(dark, 0.45, 1.0)[:, None] * light[:, None]
    colour = np.clip(colour, 0.0, 1.0)
    axes.add_collection(
        PolyCollection(list(seen[towards]), facecolors=colour, edgecolors=colour, lw=0.25, rasterized=True)
    )


@dataclass(frozen=True)
class Word:
    """A label with its line from the axis."""

    x: float
    foot: float
    tip: float
    text: str


def _lines(labels: Sequence[Label], metre: float) -> list[Word]:
    """Labels above the train (below it where their room is below), moved away until they are clear of each other."""
    taken: list[tuple[FloatArray, FloatArray]] = []
    found = []
    for point, room, text in labels:
        foot = SCREEN @ np.asarray(point)
        tip = foot + room * SCREEN[:, 2]
        sign, half = np.sign(room), np.array([LETTER * len(text) + 0.08, LINE]) / metre / 2
        away = 0.2 * LINE / metre * sign
        while True:
            middle = np.array([foot[0], tip[1] + away + half[1] * sign])
            if not any(np.all(np.abs(middle - other) < half + size) for other, size in taken):
                break
            away += LINE / metre * sign
        taken.append((middle, half))
        found.append(Word(float(foot[0]), float(foot[1]), float(tip[1] + away), text))
    return found
