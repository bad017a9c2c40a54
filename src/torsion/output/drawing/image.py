"""Values on a grid as an image: light to dark from the lowest to the highest, so that it reads in gray too."""

import struct
import zlib
from base64 import b64encode
from collections.abc import Callable, Iterator

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.drawing.curves import path
from torsion.output.drawing.pens import INK
from torsion.output.figures.figure import Cells


def level_line(
    x: FloatArray, y: FloatArray, values: FloatArray, level: float = 0.0
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield pieces (x, y) on which values (rows, columns), linear along the sides of each square, are the level."""
    z = values - level
    four = np.stack([z[:-1, :-1], z[:-1, 1:], z[1:, :-1], z[1:, 1:]])  # corners of the squares
    above = (four > 0).sum(axis=0)
    # Squares in which the sign changes, and all of whose values are known.
    squares = np.argwhere(np.isfinite(four).all(axis=0) & (above > 0) & (above < 4))
    for row, column in squares.tolist():
        corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
        met = []
        for (r0, c0), (r1, c1) in zip(corners, corners[1:] + corners[:1], strict=True):
            a, b = float(z[r0, c0]), float(z[r1, c1])
            if (a > 0) != (b > 0):
                share = a / (a - b)
                met.append((x[c0] + share * (x[c1] - x[c0]), y[r0] + share * (y[r1] - y[r0])))
        for first, last in zip(met[::2], met[1::2], strict=False):
            yield np.array([first[0], last[0]]), np.array([first[1], last[1]])


SHADES = 64
STOPS = (
    (-1.0, "#f3f8fc"),
    (-1e-9, "#8fbcdc"),
    (0.0, "#f6c76b"),
    (0.5, "#d4642a"),
    (1.0, "#6a0f14"),
)  # of the range
LOG_STOPS = ((-1.0, "#ffffff"), (-0.3, "#f6c76b"), (0.3, "#d4642a"), (1.0, "#3d060a"))
Across = Callable[[FloatArray], FloatArray]


def palette(*, is_log: bool = False) -> np.ndarray:
    """Return (SHADES, 3) colours from the lowest to the highest value; each half, or the whole, is darker upwards."""
    shares = np.linspace(-1.0, 1.0, SHADES)
    places, words = zip(*(LOG_STOPS if is_log else STOPS), strict=True)
    colours = (
        np.interp(shares, places, [int(word[k : k + 2], 16) for word in words]) for k in (1, 3, 5)
    )
    return np.column_stack([*colours]).round().astype(np.uint8)


def png(pixels: np.ndarray, colours: np.ndarray) -> bytes:
    """Return an image of (rows, columns) numbers of colours, the last of which is clear."""
    rows, columns = pixels.shape
    lines = np.column_stack([np.zeros(rows, dtype=np.uint8), pixels.astype(np.uint8)]).tobytes()
    chunks = {
        b"IHDR": struct.pack(">IIBBBBB", columns, rows, 8, 3, 0, 0, 0),
        b"PLTE": colours.tobytes() + bytes(3),
        b"tRNS": bytes([255] * len(colours) + [0]),
        b"IDAT": zlib.compress(lines, 9),
        b"IEND": b"",
    }
    image = b"\x89PNG\r\n\x1a\n"
    for kind, data in chunks.items():
        image += struct.pack(">I", len(data)) + kind + data
        image += struct.pack(">I", zlib.crc32(kind + data))
    return image


def cells(grid: Cells, across: Across, down: Across) -> Iterator[str]:
    """Yield the image in tenths of px, where a cell reaches half way to its neighbours, and the zero line over it."""
    x, y = _edges(grid.x), _edges(grid.y)
    wide, high = (10 * float(np.ptp(scale(edges))) for scale, edges in ((across, x), (down, y)))
    left, top = 10 * float(across(x).min()), 10 * float(down(y).min())
    size = max(2, round(wide / 10)), max(2, round(high / 10))
    even = all(np.allclose(np.diff(edges), np.diff(edges)[0], rtol=1e-6) for edges in (x, y))
    values = grid.values
    for axis, edges, n in ((1, x, size[0]), (0, y, size[1])):
        if not even or edges.size > n + 1:
            # One value for each px: the largest of the cells that begin in it, else that of its cell. No peak is lost.
            px = np.linspace(edges[0], edges[-1], n + 1)
            first = np.clip(np.searchsorted(edges, (px[1:] + px[:-1]) / 2) - 1, 0, edges.size - 2)
            begin, end = (np.searchsorted(edges[:-1], ends) for ends in (px[:-1], px[1:]))
            columns = values.take(first, axis=axis)
            for pixel in np.flatnonzero(end > begin + 1).tolist():
                inside = values.take(range(begin[pixel], end[pixel]), axis=axis)
                columns[(slice(None), pixel) if axis else pixel] = np.fmax.reduce(inside, axis=axis)
            values = columns
    # Each value between the first colour, 0, and the last, 1; a place without a value is clear.
    relative = np.nan_to_num(values / grid.largest, nan=0.0)
    share = (np.clip(relative, -1.0, 1.0) + 1.0) / 2.0
    if grid.decades:
        share = 1.0 + np.log10(np.clip(relative, 10.0**-grid.decades, 1.0)) / grid.decades
    shade = np.where(np.isfinite(values), np.rint(share * (SHADES - 1)), SHADES)[::-1]
    data = b64encode(png(shade, palette(is_log=bool(grid.decades)))).decode()
    box = f'x="{left:.0f}" y="{top:.0f}" width="{wide:.0f}" height="{high:.0f}" preserveAspectRatio="none"'
    yield f'<image {box} image-rendering="optimizeSpeed" href="data:image/png;base64,{data}"/>'
    zeros = () if grid.decades else level_line(grid.x, grid.y, grid.values)
    line = "".join(path(10 * across(a), 10 * down(b), 1000) for a, b in zeros)
    if line:
        yield f'<path d="{line}" stroke="{INK}" stroke-width="13"/>'


def _edges(places: FloatArray) -> FloatArray:
    """Return the points half way between the places, and as far beyond the ends."""
    if places.size == 1:
        return np.array([places[0] - 0.5, places[0] + 0.5])
    middle = (places[1:] + places[:-1]) / 2
    return np.concatenate([[2 * places[0] - middle[0]], middle, [2 * places[-1] - middle[-1]]])
