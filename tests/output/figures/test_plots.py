"""Figures are SVG, the same every time, with what they were given in them."""

import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pytest

from torsion.output.blocks import Figure
from torsion.output.figures.drawing import PLOTS, svg

SPEED = np.linspace(300.0, 1800.0, 61)
BUMP = 100.0 / (1.0 + ((SPEED - 900.0) / 60.0) ** 2)
BAD = np.abs(SPEED - 1500.0) < 1.0
TURN, RAD = np.linspace(0.0, 360.0, 361), np.pi / 180.0
OVER_SPEED: dict[str, Any] = {"speed": SPEED, "bad": BAD, "rated": 1500.0, "barred": ((800.0, 1000.0),)}
VALUES: dict[str, dict[str, Any]] = {
    "sketch": {
        "points": [
            {"x": 0.0, "row": 0.0, "size": 0.5, "label": "1 <motor> & $x$", "kind": "motor"},
            {"x": 3.0, "row": 0.0, "size": 1.0, "label": "2", "kind": "damper", "ring": 0.5, "is_grounded": True},
            {"x": 3.0, "row": -1.0, "size": 0.0, "label": "3", "kind": "disc", "is_held": True},
        ],
        "links": [
            {"kind": kind, "start": (0.0, 0.0), "end": (1.0, 0.0), "label": kind}
            for kind in ("shaft", "coupling", "gear", "joint", "rigid", "tie")
        ],
    },
    "mode": {
        "x": np.array([0.0, 1, 2, 2]), "row": np.array([0.0, 0, 0, 1]), "ends": np.array([[0, 1], [1, 2], [2, 3]]),
        "marked": np.ones(4, dtype=bool), "angle": np.array([1.0, 0, -1, -0.5]), "torque": np.array([1.0, 0.5, -0.2]),
        "ticks": [(0.0, "motor <A>")],
    },
    "campbell": {
        "frequencies": [10.0, 40.0], "orders": [(1.0, "order 1"), (2.0, "order 2")],
        "crossings": [(600.0, 10.0, True), (100.0, 10.0, False)], "speeds": (300.0, 1800.0), "rated": 1500.0,
    },
    "steady": {"speed": SPEED, "lines": [("a & b", BUMP)], "unit": "kN m", "rated": 1500.0},
    "torque": {
        **OVER_SPEED, "lines": [("order 1", BUMP)], "synthesis": BUMP, "unit": "N m",
        "limits": [("T_KW", 80.0)],
    },
    "stress": {**OVER_SPEED, "synthesis": BUMP, "continuous": BUMP + 1, "transient": np.full(61, np.nan)},
    "gear": {**OVER_SPEED, "vibratory": BUMP, "mean": BUMP * 0 + 50, "unit": "N m", "limit": 70.0},
    "frequency": {
        "frequency": SPEED, "lines": [("<disc>", BUMP)], "bad": BAD, "quantity": "torque amplitude, N m",
        "natural": [900.0],
    },
    "joint turn": {
        "angle": TURN, "quantity": "angle of the shaft before joint-1, deg",
        "panels": [
            ("angle error, deg", 57.3, [("behind <a> & $b$", np.sin(2 * RAD * TURN)), ("behind joint-2", 0 * TURN)]),
            ("speed, rpm", 1500.0, [("behind <a> & $b$", 1500 + np.cos(2 * RAD * TURN)), ("behind joint-2", TURN)]),
        ],
    },
    "joint index": {
        "values": TURN, "index": 5 + 4 * np.cos(2 * RAD * TURN), "quantity": "phase of <a> & $b$, deg",
        "present": (10.0, 9.0), "best": (90.0, 1.0),
    },
    "check modes": {
        "frequency": [("<lumped>", np.array([1e-5, np.inf, 0.0])), ("$fem$", np.array([1e-12, 1e-9, 1e-8]))],
        "shape": [("<lumped>", np.array([1e-9, np.inf, 0.0])), ("$fem$", np.array([1e-20, np.nan, 1e-12]))],
        "tolerance": 1e-3,
    },
    "check torques": {
        "speed": SPEED, "tolerance": 1e-3,
        "lines": [("<lumped>", np.full(len(SPEED), 1e-4)), ("$fem$", np.full(len(SPEED), np.nan))],
    },
    "periodic": {
        "first_speed": SPEED, "speed": SPEED, "lines": [("order 2", BUMP + 1, BUMP), ("order 4", None, BUMP / 9)],
        "unit": "N m", "none": BAD, "coarse": SPEED < 350.0, "grows": (SPEED > 800.0) & (SPEED < 1000.0),
        "unstable": ((800.0, 1000.0),), "rated": 1500.0,
    },
    "stability": {
        "speed": SPEED, "growth": np.where(BAD, np.nan, BUMP - 50), "rated": 1500.0,
        "unstable": [(840.0, 960.0, "principal of <mode> 1 & $x$")],
    },
    "stability map": {
        "speed": SPEED, "value": np.array([5.0, 10.0, 15.0]), "quantity": "joint angle, deg", "rated": 1500.0,
        "growth": np.where(BAD[:, None], np.nan, np.outer(BUMP, [0.5, 1.0, 1.5]) - 50),
    },
    "whirl": {
        "speed": SPEED, "frequency": np.column_stack([40 + SPEED / 100, 40 - SPEED / 100]), "rated": 1500.0,
        "direction": np.tile([1.0, -1.0], (61, 1)), "unstable": np.column_stack([BAD, BAD]),
        "orders": [(30.0, "order 1 <a>"), (60.0, "order 2")],
        "crossings": [(1500.0, 55.0, True), (2000.0, 60.0, False)],
    },
    "bending": {
        "speed": [SPEED, SPEED], "orders": ["order 0", "order 2"], "rated": 1500.0, "crossings": [900.0],
        "panels": [("displacement, <mm>", [BUMP, BUMP / 2]), ("bearing force, N", [BUMP, BUMP])],
        "near": [BAD, BAD], "singular": [BAD, SPEED < 320.0],
    },
    "over time": {
        "time": SPEED, "quantity": "torque, kN m", "lines": [("<coupling> $x$", -BUMP, BUMP), ("disc", BUMP, BUMP)],
    },
    "orders": {"x": SPEED, "quantity": "time, s", "unit": "N m", "lines": [("order 2 of <a> & $x$", BUMP)]},
    "waterfall": {
        "x": SPEED, "quantity": "speed of <a> & $x$, rpm", "unit": "N m", "order": np.arange(4) / 8.0,
        "amplitude": np.outer(BUMP, [1.0, 0.0, 1e-9, 2.0]), "reference": "<a> & $x$",
    },
    "study": {
        "curves": [
            ("lumped <a>", "lumped", 0, SPEED, 0.9 * SPEED, 1.1 * SPEED, BUMP / 1e4),
            ("Bathe", "integration", 6, SPEED, 0.9 * SPEED, 1.1 * SPEED, BUMP / 1e5),
        ],
        "tolerance": 1e-3, "bound": 1e-13, "best": (300.0, 1e-3),
    },
    "twisted shaft": {
        "x": np.array([0.0, 0, 1, 1]), "radius": np.array([0.0, 0.2, 0.1, 0]), "place": np.zeros((4, 2)),
        "turn": np.array([0.0, 0, 0.5, 0.5]), "angle": np.array([0.0, 0, 1, 1]), "strip": np.array([0, 1, 2]),
        "body": np.zeros(3, dtype=np.int64), "labels": [((0.5, 0.0, 0.0), 0.3, "1 <shaft> & $x$")],
        "ties": [((0.0, 0.0, 0.0), (0.0, 0.0, -1.0))],
    },
}  # fmt: skip


def drawn(plot: str, **changes: Any) -> str:
    """The SVG of a plot."""
    return svg(Figure(f"figure-{plot}", "caption", plot, {**VALUES[plot], **changes}))


def test_every_plot_is_tried() -> None:
    assert set(VALUES) == set(PLOTS)


@pytest.mark.parametrize("plot", PLOTS)
def test_a_figure_is_well_formed_and_the_same_every_time(plot: str) -> None:
    text = drawn(plot)
    assert ET.fromstring(text).tag.endswith("svg")
    assert text == drawn(plot)


def test_labels_stand_as_text_with_the_names_escaped() -> None:
    assert "1 &lt;motor&gt; &amp; $x$" in drawn("sketch")
    assert "a &amp; b" in drawn("steady")


@pytest.mark.parametrize("label", ["弹性联轴器", "⚓ 𓀀"])
def test_names_in_signs_that_no_font_here_has_stand_as_text_without_a_warning(label: str) -> None:
    points = [{"x": 0.0, "row": 0.0, "size": 0.5, "label": label, "kind": "motor"}]
    text = drawn("sketch", points=points)
    assert f">{label}</text>" in text
    assert "sans-serif" in text


@pytest.mark.parametrize("plot", ["torque", "stress", "gear", "frequency"])
def test_what_is_not_reliable_is_hatched_and_only_then(plot: str) -> None:
    assert "no reliable answer here" in drawn(plot)
    assert "no reliable answer here" not in drawn(plot, bad=np.zeros(61, dtype=bool))


def test_a_peak_far_above_the_rest_takes_a_logarithmic_axis() -> None:
    steep = 1e4 * BUMP**2
    assert ">10000<" in drawn("frequency", lines=[("a", steep)], bad=np.zeros(61, dtype=bool)) or ">1e+06<" in drawn(
        "frequency", lines=[("a", steep)], bad=np.zeros(61, dtype=bool)
    )


def test_figures_of_other_names_share_no_clip_path() -> None:
    import re

    first, second = (svg(Figure(name, "", "torque", VALUES["torque"])) for name in ("one", "two"))
    ids = [set(re.findall(r'<clipPath id="([^"]+)"', text)) for text in (first, second)]
    assert ids[0]
    assert not ids[0] & ids[1]
