"""The picture of the twisted train: what is near hides what is far, labels stay clear of each other."""

import re
import xml.etree.ElementTree as ET

import numpy as np

from torsion.output.figures import twisted_surface as plot
from torsion.output.figures.style import page

TUBE = {"x": np.array([0.0, 0, 1, 1]), "radius": np.array([0.0, 0.1, 0.1, 0]), "strip": np.array([0, 1, 2])}


def bodies(*moved: tuple[float, float, float]) -> tuple[np.ndarray, ...]:
    """x, place, strip and body of tubes moved along x, y and z."""
    x = np.concatenate([TUBE["x"] + m[0] for m in moved])
    place = np.repeat([m[1:] for m in moved], 4, axis=0)
    strip = np.concatenate([TUBE["strip"] + 4 * k for k in range(len(moved))])
    return x, place, strip, np.repeat(np.arange(len(moved)), 3)


def first_seen(*moved: tuple[float, float, float]) -> list[int]:
    """Bodies in the order in which they are drawn."""
    order = plot._order(*bodies(*moved))
    return list(dict.fromkeys((order // 3).tolist()))


def test_the_driven_end_is_nearer() -> None:
    assert first_seen((1, 0, 0), (0, 0, 0), (2, 0, 0)) == [1, 0, 2]


def test_of_two_side_by_side_the_one_above_and_in_front_is_nearer() -> None:
    assert first_seen((0, 0, 1), (0, 0, 0)) == [1, 0]
    assert first_seen((0, 0, 0), (0, 1, 0)) == [1, 0]


def test_one_behind_the_end_of_another_is_drawn_after_it_wherever_it_lies() -> None:
    assert first_seen((0, 0, 0), (1, 5, -5)) == [0, 1]


def test_strips_of_a_body_stay_together_from_its_driving_end() -> None:
    order = plot._order(*bodies((0.5, 0, 0), (0, 0, -1)))
    assert order.tolist() == [3, 4, 5, 0, 1, 2]


def test_the_eye_is_above_in_front_and_at_the_driven_end() -> None:
    x, y, z = plot.EYE
    assert x > 0 > y
    assert z > 0
    np.testing.assert_allclose(np.linalg.norm([x, y, z]), 1.0, rtol=1e-14)


def test_labels_stay_clear_of_each_other() -> None:
    labels = [((0.02 * k, 0.0, 0.0), 0.2 * (-1) ** k, f"{k} a long name") for k in range(12)]
    words = plot._lines(labels, 4.0)
    half = np.array([plot.LETTER * 14, plot.LINE]) / 4.0 / 2
    middles = [np.array([w.x, w.tip + np.sign(w.tip - w.foot) * half[1]]) for w in words]
    for k, one in enumerate(middles):
        for other in middles[:k]:
            assert np.any(np.abs(one - other) >= 1.9 * half)


def test_the_surface_is_an_image_and_words_are_words() -> None:
    text = page(
        "f", plot.twisted_shaft, **TUBE, place=np.zeros((4, 2)), turn=np.zeros(4), angle=np.zeros(4),
        body=np.zeros(3, dtype=np.int64), labels=[((0.5, 0.0, 0.0), 0.2, "1 <shaft> & $x$")],
    )  # fmt: skip
    assert ET.fromstring(text).tag.endswith("svg")
    assert len(re.findall("<image", text)) == 2  # the surface, and the scale of its colours
    assert "1 &lt;shaft&gt; &amp; $x$" in text
