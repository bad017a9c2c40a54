"""The Campbell diagram: what meets in the numbers meets on the paper."""

import re

import numpy as np

from torsion.output.figures.frequencies_over_speed import campbell
from torsion.output.figures.style import page as drawn_on

NUMBER = r"(-?\d+(?:\.\d+)?)"


def test_lines_of_the_orders_pass_through_the_crossings_with_the_modes() -> None:
    """Orders 1 and 3 meet 2 Hz at 120 and 40 rpm, and 5 Hz at 300 (beyond the axis) and 100 rpm."""
    page = drawn_on(
        "c", campbell, frequencies=[2.0, 5.0], orders=[(1.0, "one"), (3.0, "three")],
        crossings=[(120.0, 2.0, True), (40.0, 2.0, True), (100.0, 5.0, True)], speeds=(30.0, 150.0), rated=None,
    )  # fmt: skip
    path = rf'<path d="M {NUMBER} {NUMBER} \nL {NUMBER} {NUMBER} \n" clip-path'
    drawn = np.array([[float(one) for one in line] for line in re.findall(path, page)])
    sloped = drawn[(drawn[:, 0] != drawn[:, 2]) & (drawn[:, 1] != drawn[:, 3])]
    assert len(sloped) == 2
    mark = re.search(rf'<use xlink:href="(#\w+)" x="{NUMBER}" y="{NUMBER}" style="fill: #d55e00', page)[1]
    marks = np.array([[float(one) for one in at] for at in re.findall(rf'"{mark}" x="{NUMBER}" y="{NUMBER}"', page)])
    for line, points in zip(sloped, (marks[:1], marks[1:3]), strict=True):
        slope = (line[3] - line[1]) / (line[2] - line[0])
        np.testing.assert_allclose(line[1] + slope * (points[:, 0] - line[0]), points[:, 1], atol=1e-3)
    across = drawn[(drawn[:, 1] == drawn[:, 3])][:, 1]
    assert all(np.abs(across - y).min() < 1e-3 for y in marks[:3, 1])
    origin = sloped[0, :2]
    np.testing.assert_allclose((marks[0] - origin) / (marks[1] - origin), [3.0, 1.0], rtol=1e-4)
