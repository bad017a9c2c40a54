"""The train twisted by one mode, seen from its driven end and from above: coloured by angle, with stripes that turn."""

from collections.abc import Callable

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.output.drawing.curves import outline
from torsion.output.drawing.frame import MIDDLE, WIDTH
from torsion.output.drawing.pens import COLOURS, INK, Stroke
from torsion.output.drawing.text import HALO, shown, words
from torsion.output.drawing.words import SIZE, Room
from torsion.output.figures.figure import Twisted

(SIN_ASIDE, COS_ASIDE), (SIN_ABOVE, COS_ABOVE) = (  # from where the train is looked at
    (np.sin(angle), np.cos(angle)) for angle in np.radians([30.0, 14.0])
)
SCREEN = np.array([  # what goes to the right and what goes up
    [COS_ASIDE, SIN_ASIDE, 0.0], [-SIN_ASIDE * SIN_ABOVE, COS_ASIDE * SIN_ABOVE, COS_ABOVE],
])  # fmt: skip
EYE = np.cross(*SCREEN)  # the direction to who looks
LIGHT = np.array([0.45, -0.5, 0.74]) / np.linalg.norm([0.45, -0.5, 0.74])
AROUND, STRIPE = 32, 4  # sides of every body; one side in so many is dark
HIGHEST, ASIDE = 350.0, 0.97  # px: of the surface; share of the width that it fills
SHADES, LIGHTS = 21, 12  # angles and lights of different colours
MOST_ROWS = 12  # of words above or below the train
STOPS = (COLOURS[0], "#9fc6de", "#f2f1ec", "#f0b48a", COLOURS[1])  # from the angle -1 to 1


def drawn(surface: Twisted, top: float) -> tuple[float, str]:
    """Height in px and elements of the picture below `top`."""
    corners = ring_corners(surface)
    flat = corners @ SCREEN.T
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    metre = float(min(ASIDE * WIDTH / (high - low)[0], HIGHEST / (high - low)[1]))  # px
    middle = float(low[0] + high[0]) / 2

    def on_paper(points: FloatArray) -> FloatArray:
        """px of points (..., 2)."""
        return (points - [middle, 0.0]) * [metre, -metre] + [WIDTH / 2, 0.0]

    room = Room((0.0, -9e9, WIDTH, 9e9), np.zeros((0, 2)))
    texts = _labels(surface, on_paper, room)
    upper = min([float(on_paper(high)[1]), *(box[1] for box in room.taken)]) - 3.0
    lower = max([float(on_paper(low)[1]), *(box[3] for box in room.taken)]) + 6.0
    ties = "".join(
        "M{:.1f} {:.1f}L{:.1f} {:.1f}".format(*on_paper(np.array(ends) @ SCREEN.T).ravel()) for ends in surface.ties
    )
    parts = [f'<path d="{ties}" fill="none" {Stroke(INK, 0.9, "1.6 2").attributes()}/>'] if ties else []
    parts += _sides(surface, corners, np.rint(10.0 * on_paper(flat)).astype(np.int64))
    body = "".join([*parts, *texts, *_scale(lower + 8.0)])
    return lower - upper + 34.0, f'<g transform="translate(0 {shown(top - upper)})" font-size="{SIZE:g}">{body}</g>'


def ring_corners(surface: Twisted) -> FloatArray:
    """(rings, AROUND, 3) points of the twisted surface."""
    at = surface.turn[:, None] + 2.0 * np.pi / AROUND * np.arange(AROUND)
    y, z = (surface.place[:, k, None] + surface.radius[:, None] * f(at) for k, f in enumerate((np.cos, np.sin)))
    return np.stack([np.broadcast_to(surface.x[:, None], y.shape), y, z], axis=2)


def order(x: FloatArray, place: FloatArray, strip: IntArray, body: IntArray) -> IntArray:
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
    waiting, done = hidden.sum(axis=0), list[int]()
    left = rank.tolist()
    while left:
        free = next((one for one in left if waiting[one] == 0), left[0])
        left.remove(free)
        done.append(free)
        waiting -= hidden[free]
    return np.concatenate([np.arange(first[one], last[one] + 1) for one in done])


def _sides(surface: Twisted, corners: FloatArray, flat: IntArray) -> list[str]:
    """The sides that can be seen, over each other; those of one colour after one another are one element."""
    strips = order(surface.x, surface.place, surface.strip, surface.body)
    here = surface.strip[strips]
    along = np.roll(np.arange(AROUND), -1)
    a, b, c, d = corners[here], corners[here][:, along], corners[here + 1][:, along], corners[here + 1]
    normal = np.cross(c - a, d - b)  # (strips, AROUND, 3)
    seen = normal @ EYE > 0
    normal /= np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), np.finfo(float).tiny)
    light = np.rint(LIGHTS * np.clip(normal @ LIGHT, 0.0, 1.0)).astype(np.int64)
    angle = (surface.angle[here] + surface.angle[here + 1]) / 2
    shade = np.rint((angle + 1.0) / 2.0 * (SHADES - 1)).astype(np.int64)[:, None] + 0 * light
    dark = np.broadcast_to(np.arange(AROUND) % STRIPE == 0, light.shape)
    look = np.where(seen, 2 * (shade * (LIGHTS + 1) + light) + dark, -1)
    grouped: list[tuple[int, list[str]]] = []
    points = np.stack([flat[here], flat[here][:, along], flat[here + 1][:, along], flat[here + 1]], axis=2)
    for row, corner in zip(look.tolist(), points.tolist(), strict=True):
        for side in sorted((k for k in range(AROUND) if row[k] >= 0), key=row.__getitem__):
            a, b, c, d = corner[side]
            steps = [(there[0] - here[0], there[1] - here[1]) for here, there in ((a, b), (b, c), (c, d))]
            if not grouped or grouped[-1][0] != row[side]:
                grouped.append((row[side], []))
            grouped[-1][1].append(outline([a, *steps]) + "z")
    paths = [f'<path d="{"".join(lines)}" {_paint(colour)}/>' for colour, lines in grouped]
    return ['<g transform="scale(.1)" stroke-width="3" stroke-linejoin="round">', *paths, "</g>"]


def _paint(look: int) -> str:
    """Colour of a side by its angle, its light and whether it is a stripe."""
    rest, dark = divmod(look, 2)
    shade, light = divmod(rest, LIGHTS + 1)
    bright = (0.62 + 0.43 * light / LIGHTS) * (0.45 if dark else 1.0)
    word = _hex(np.clip(_colour(2.0 * shade / (SHADES - 1) - 1.0) * bright, 0.0, 255.0))
    return f'fill="{word}" stroke="{word}"'


def _colour(angle: float) -> FloatArray:
    """Red, green and blue of an angle from -1 to 1."""
    stops = np.array([[int(word[k : k + 2], 16) for k in (1, 3, 5)] for word in STOPS], dtype=float)
    return np.array([np.interp(angle, np.linspace(-1.0, 1.0, len(STOPS)), stops[:, k]) for k in range(3)])


def _hex(colour: FloatArray) -> str:
    return "#" + "".join(f"{round(part):02x}" for part in colour.tolist())


def _labels(surface: Twisted, on_paper: Callable[[FloatArray], FloatArray], room: Room) -> list[str]:
    """Words above the train (below it where their room is below), clear of each other, with lines to the axis."""
    made = []
    for point, free, text in surface.labels:
        axis = SCREEN @ np.asarray(point)
        (x, foot), (_, tip) = on_paper(axis), on_paper(axis + np.array([0.0, free * SCREEN[1, 2]]))
        word = room.place(text, np.array([[x, tip]]), ways=(0,) if free > 0 else (5,), reach=MOST_ROWS)
        if word is not None:
            left, upper, right, lower = word.box
            end = lower if free > 0 else upper
            made.append(f'<path d="M{shown(x)} {shown(foot)}V{shown(end)}" stroke="#999999" stroke-width=".6"/>')
            made.append(words((left + right) / 2, (upper + lower) / 2 + 3.7, text, f'{MIDDLE} fill="{INK}"{HALO}'))
    return made


def _scale(top: float) -> list[str]:
    """The colours of the angles."""
    long = 210.0 / SHADES
    left = WIDTH / 2 - 105.0
    parts = [
        f'<rect x="{shown(left + k * long)}" y="{shown(top)}" width="{shown(long + 0.3)}" height="7" '
        f'fill="{_hex(_colour(2.0 * k / (SHADES - 1) - 1.0))}"/>'
        for k in range(SHADES)
    ]
    title = words(WIDTH / 2, top + 19, "angle / largest, each at its own speed", f'{MIDDLE} fill="{INK}"')
    ends = [words(left + at, top + 7, text, f'{anchor} fill="{INK}"') for at, text, anchor in (
        (-5.0, "−1", ' text-anchor="end"'), (215.0, "1", ""))]  # fmt: skip
    return [*parts, title, *ends]
