"""One figure of each kind, with names that are markup elsewhere."""

from types import SimpleNamespace
from typing import Any

import numpy as np
from tests.output.drawing import curves_by_hand

from torsion.output.figures import curves, mode_shape
from torsion.output.figures.figure import Axis, Cells, Disc, Figure, Link, Panel, Sketch

SPEED = np.linspace(300.0, 1800.0, 61)
BUMP = 100.0 / (1.0 + ((SPEED - 900.0) / 60.0) ** 2)
BAD = np.abs(SPEED - 1500.0) < 1.0
RAD_PER_S = np.pi / 30.0
TURN, RAD = np.linspace(0.0, 360.0, 361), np.pi / 180.0
OVER_SPEED: dict[str, Any] = {
    "speed": SPEED,
    "bad": BAD,
    "rated": 1500.0,
    "barred": ((800.0, 1000.0),),
}
SKETCH = Sketch(
    (
        Disc(0.0, 0.0, 0.5, "1 <motor> & $x$", "motor"),
        Disc(3.0, 0.0, 1.0, "2", "damper", ring=0.5, is_grounded=True),
        Disc(3.0, -1.0, 0.0, "3", "disc", is_held=True),
    ),
    tuple(
        Link(kind, (0.0, 0.0), (1.0, 0.0), kind)
        for kind in ("shaft", "coupling", "gear", "joint", "rigid", "tie")
    ),
)
ERRORS = [("<lumped>", np.array([1e-5, np.inf, 0.0])), ("$fem$", np.array([1e-12, 1e-9, 1e-8]))]
PANELS = [
    (
        Axis("angle error", "deg"),
        57.3,
        [("behind <a> & $b$", np.sin(2 * RAD * TURN)), ("behind joint-2", 0 * TURN)],
    ),
    (
        Axis("speed", "rpm"),
        1500.0,
        [("behind <a> & $b$", 1500 + np.cos(2 * RAD * TURN)), ("behind joint-2", TURN)],
    ),
]


def torque(name: str = "torque", **changes: Any) -> Figure:
    """Torque over the speed."""
    values = {
        **OVER_SPEED,
        "lines": [("order 1", BUMP), ("order <2>", BUMP / 3)],
        "synthesis": 1.2 * BUMP,
        "unit": "N m",
        "limits": [("T_{KW}", 80.0)],
    }
    return curves_by_hand.torque(name, "torque in <a> & b", **{**values, **changes})


def frequency(**changes: Any) -> Figure:
    """Torque over the frequency."""
    values = {"frequency": SPEED, "lines": [("<disc>", BUMP)], "bad": BAD, "natural": [900.0]}
    return curves_by_hand.frequency(
        "f", "c", **{**values, **changes}, quantity="torque amplitude", unit="N m"
    )


def waterfall(x: np.ndarray, y: np.ndarray, values: np.ndarray, across: str = "order") -> Figure:
    """A map in logarithms."""
    cells = Cells(x, y, values, "torque amplitude", "N m", float(values.max()), 3.0)
    return Figure("waterfall", "c", (Panel(Axis(across), Axis("time", "s"), cells=cells),))


KINDS: dict[str, Figure] = {
    "sketch": Figure("plant", "the <plant>", (SKETCH,)),
    "mode": mode_shape.mode(
        "mode-1",
        "mode 1",
        x=np.array([0.0, 1, 2, 2]),
        row=np.array([0.0, 0, 0, 1]),
        ends=np.array([[0, 1], [1, 2], [2, 3]]),
        marked=np.ones(4, dtype=bool),
        angle=np.array([1.0, 0, -1, -0.5]),
        torque=np.array([1.0, 0.5, -0.2]),
        ticks=[(0.0, "motor <A>")],
        stations=["motor", "<wheel>", "end", "ring"],
        spans=["shaft", "coupling", "tie"],
    ),
    "campbell": curves_by_hand.campbell(
        "campbell",
        "c",
        frequencies=[10.0, 40.0],
        orders=[(1.0, "order 1"), (2.0, "order 2")],
        crossings=[(600.0, 10.0, True, "order 1 <meets> 1"), (100.0, 10.0, False, "other")],
        speeds=(300.0, 1800.0),
        rated=1500.0,
    ),
    "torque": torque(),
    "stress": curves_by_hand.stress(
        "stress-1",
        "c",
        **OVER_SPEED,
        synthesis=BUMP,
        continuous=BUMP + 1,
        transient=np.full(61, np.nan),
    ),
    "small stress": curves_by_hand.stress(
        "stress-2",
        "c",
        **OVER_SPEED,
        synthesis=BUMP,
        lines=[("order 2", BUMP / 2)],
        continuous=np.full(61, 2000.0),
    ),
    "gear": curves_by_hand.gear(
        "g", "c", **OVER_SPEED, vibratory=BUMP, mean=BUMP * 0 + 50, unit="N m", limit=70.0
    ),
    "frequency": frequency(),
    "joint": curves.joint_turn("j", "c", TURN * RAD, PANELS, "<j>"),
    "stability": curves.stability(
        "stability",
        "c",
        SPEED * RAD_PER_S,
        np.where(BAD, np.nan, BUMP - 50),
        [SimpleNamespace(first=840 * RAD_PER_S, last=960 * RAD_PER_S, name="of <mode> 1 & $x$")],
        1500.0,
    ),
    "stability map": curves.stability_map(
        "c",
        SPEED * RAD_PER_S,
        Axis("joint angle", "deg"),
        np.array([5.0, 10.0, 15.0]),
        np.where(BAD[:, None], np.nan, np.outer(BUMP, [0.5, 1.0, 1.5]) - 50),
        1500.0,
    ),
    "whirl": curves_by_hand.whirl(
        "whirl-1",
        "c",
        speed=SPEED,
        frequency=np.column_stack([40 + SPEED / 100, 40 - SPEED / 100]),
        rated=1500.0,
        direction=np.tile([1.0, -1.0], (61, 1)),
        unstable=np.column_stack([BAD, BAD]),
        orders=[(30.0, "order 1 <a>"), (60.0, "order 2")],
        crossings=[(1500.0, 55.0, True, "x"), (1900.0, 60.0, False, "y")],
    ),
    "bending": curves_by_hand.bending(
        "bending-1",
        "c",
        speed=[SPEED, SPEED],
        orders=["order 0", "order 2"],
        rated=1500.0,
        crossings=[900.0],
        panels=[("displacement", "<mm>", [BUMP, BUMP / 2]), ("bearing force", "N", [BUMP, BUMP])],
        near=[BAD, BAD],
        singular=[BAD, SPEED < 320.0],
    ),
    "over time": curves.over_time(
        "motion 1",
        "c",
        SPEED,
        [("<coupling> $x$", -BUMP), ("disc", BUMP)],
        Axis("torque", "kN m"),
    ),
    "waterfall": waterfall(
        np.arange(1, 4) / 8.0, SPEED, np.outer(BUMP, [0.0, 1e-9, 2.0]), "order of <a> & $x$"
    ),
}
