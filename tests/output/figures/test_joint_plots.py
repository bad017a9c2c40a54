"""Figures of joints: what is level stays level, sectors fill what they show."""

import re
import xml.etree.ElementTree as ET

import numpy as np

from torsion.output.figures.joint_curves import joint_index, joint_turn
from torsion.output.figures.style import page

TURN = np.linspace(0.0, 360.0, 361)
WAVE = np.sin(np.radians(2 * TURN))


def ticks(svg: str) -> list[float]:
    """Numbers at the axes."""
    texts = [element.text or "" for element in ET.fromstring(svg).iter() if element.tag.endswith("text")]
    return [float(text.replace("−", "-")) for text in texts if re.fullmatch(r"[−\d.]+", text)]


def turn(*values: np.ndarray, size: float = 1.0, angle: np.ndarray = TURN) -> str:
    lines = [(f"line {k}", one) for k, one in enumerate(values)]
    return page("f", joint_turn, angle=angle, panels=[("y, N m", size, lines)], quantity="angle, deg")


def test_rounding_is_drawn_as_a_level_line() -> None:
    assert max(ticks(turn(1e-15 * WAVE))) == 360.0
    assert "e" not in "".join(re.findall(r">([^<>]*)</text>", turn(1e-15 * WAVE))).replace("line", "").replace(
        "angle, deg", ""
    )


def test_nothing_at_all_is_drawn_as_a_level_line() -> None:
    """The torque in a joint that carries none; the plotter warns of a range without width, and warnings are errors."""
    assert max(ticks(turn(0.0 * WAVE, size=0.0))) == 360.0


def test_a_small_wave_is_drawn_at_its_own_size() -> None:
    heights = [value for value in ticks(turn(1e-3 * WAVE)) if value != 0.0 and abs(value) < 1.0]
    assert heights
    assert max(heights) <= 2e-3


def test_angles_are_marked_in_whole_steps_over_one_turn_and_over_many() -> None:
    assert {0.0, 30.0, 90.0, 360.0} <= set(ticks(turn(WAVE)))
    many = np.linspace(0.0, 7200.0, 721)
    marks = {value for value in ticks(turn(np.sin(many), angle=many)) if value >= 360.0}
    assert {720.0, 7200.0} <= marks
    assert len(marks) <= 13


def test_every_line_is_in_the_legend_once_and_in_every_panel() -> None:
    panels = [("a", 1.0, [("one", WAVE), ("two", 2 * WAVE)]), ("b", 1.0, [("one", WAVE)])]
    svg = page("f", joint_turn, angle=TURN, panels=panels, quantity="angle, deg")
    assert svg.count(">one<") == svg.count(">two<") == 1


def test_a_full_range_goes_around_and_a_part_fills_its_sector() -> None:
    def drawn(last: float) -> str:
        values = np.linspace(0.0, last, 91)
        return page(
            "f", joint_index, values=values, index=1 + values, quantity="phase, deg", present=(10.0, 11.0),
            best=(0.0, 1.0),
        )  # fmt: skip

    assert ">270°<" in drawn(360.0)
    assert ">270°<" not in drawn(90.0)
    for text in (drawn(360.0), drawn(90.0)):
        assert "present: 10°, 11 %" in text
        assert "best: 0°, 1 %" in text
