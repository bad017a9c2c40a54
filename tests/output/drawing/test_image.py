"""Maps of growth as images: the right cell at the right place, unknown ones clear, the zero line where it is zero."""

import re
import struct
import zlib
from base64 import b64decode

import numpy as np
import pytest

from torsion.output.drawing.image import SHADES, cells, level_line, palette
from torsion.output.figures.figure import Cells

X, Y = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0])
MAP = Cells(X, Y, np.array([[-1.0, np.nan, 1.0], [-0.5, 0.5, 9.0]]), "growth", "1/s", 1.0)


def pixels(text: str) -> np.ndarray:
    """(rows, columns) numbers of colours of the image."""
    data = b64decode(re.search(r'base64,([^"]+)"', text)[1])
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    place, chunks = 8, {}
    while place < len(data):
        size, kind = struct.unpack(">I4s", data[place : place + 8])
        body = data[place + 8 : place + 8 + size]
        assert struct.unpack(">I", data[place + 8 + size : place + 12 + size])[0] == zlib.crc32(
            kind + body
        )
        chunks[kind], place = body, place + 12 + size
    wide, high = struct.unpack(">II", chunks[b"IHDR"][:8])
    assert len(chunks[b"PLTE"]) == 3 * (SHADES + 1)
    assert chunks[b"tRNS"][-1] == 0
    return np.frombuffer(zlib.decompress(chunks[b"IDAT"]), dtype=np.uint8).reshape(high, wide + 1)[
        :, 1:
    ]


def test_cells_stand_from_below_to_above_and_unknown_ones_are_clear() -> None:
    found = pixels("".join(cells(MAP, lambda x: 100 * x, lambda y: 50 - 50 * y)))
    half = (SHADES - 1) / 2
    assert found.tolist() == [
        [round(half * 0.5), round(half * 1.5), SHADES - 1],
        [0, SHADES, SHADES - 1],
    ]


def test_unequal_steps_are_drawn_by_their_widths() -> None:
    wide = Cells(np.array([0.0, 1.0, 9.0]), Y, np.array([[-1.0, 0.0, 1.0]] * 2), "g", "", 1.0)
    found = pixels("".join(cells(wide, lambda x: 20 * x, lambda y: 50 - 50 * y)))
    edges = np.array([-0.5, 0.5, 5.0, 13.0])
    share = np.diff(edges) / np.ptp(edges)
    counts = [np.mean(found[0] == one) for one in np.unique(found[0])]
    np.testing.assert_allclose(counts, share, atol=2.0 / found.shape[1])


def test_colours_are_darker_the_larger_the_value_on_either_side_of_zero() -> None:
    light = palette().astype(float) @ [0.299, 0.587, 0.114]
    assert (np.diff(light[: SHADES // 2]) <= 0).all()
    assert (np.diff(light[SHADES // 2 :]) <= 0).all()
    assert light[0] > 240
    assert light[-1] < 60


def test_shades_of_logarithms_are_even_in_decades_and_go_from_paper_to_nearly_black() -> None:
    sizes = np.array([[0.0, 1e-5, 2e-3], [2e-2, 0.2, 2.0]])
    drawn = "".join(
        cells(
            Cells(X, Y, sizes, "torque", "N m", 2.0, 3.0), lambda x: 100 * x, lambda y: 50 - 50 * y
        )
    )
    top = SHADES - 1
    assert pixels(drawn).tolist() == [[round(top / 3), round(2 * top / 3), top], [0, 0, 0]]
    assert "<path" not in drawn
    light = palette(is_log=True).astype(float) @ [0.299, 0.587, 0.114]
    assert (np.diff(light) < 0).all()
    assert (light[0], light[-1] < 30) == (pytest.approx(255.0), True)


def test_the_zero_line_of_a_plane_lies_on_it() -> None:
    x, y = np.linspace(0.0, 1.0, 11), np.linspace(0.0, 1.0, 7)
    plane = Cells(x, y, x[None, :] - 0.3 * y[:, None] - 0.42, "g", "", 1.0)
    pieces = list(level_line(plane.x, plane.y, plane.values))
    for across, up in pieces:
        np.testing.assert_allclose(across - 0.3 * up - 0.42, 0.0, atol=1e-14)
    ends = np.concatenate([up for _, up in pieces])
    assert (ends.min(), ends.max()) == (0.0, 1.0)
    assert (
        list(level_line(MAP.x, MAP.y, MAP.values)) == []
    )  # one corner of every square is not known


@pytest.mark.parametrize("even", [True, False])
def test_a_map_of_more_cells_than_px_keeps_its_peaks_and_stays_small(even: bool) -> None:
    x = np.linspace(0.0, 1.0, 5_000) if even else np.linspace(0.0, 1.0, 5_000) ** 2
    values = np.full((2, 5_000), np.nan)
    values[:, :] = 0.1
    peaks = np.array([7, 2_501, 4_990])
    values[0, peaks] = 1.0
    text = "".join(
        cells(Cells(x, Y, values, "growth", "1/s", 1.0), lambda x: 500 * x, lambda y: 50 - 50 * y)
    )
    found = pixels(text)
    assert found.shape[1] == 500
    assert len(text) < 5_000
    at = np.flatnonzero(found[-1] == SHADES - 1)
    assert set(np.rint(499 * x[peaks]).astype(int).tolist()) <= {
        one + d for one in at.tolist() for d in (-1, 0, 1)
    }
    assert at.size <= 2 * peaks.size
