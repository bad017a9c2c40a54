"""What is read out was computed, and the nearest critical speed is sought among all of the same shaft and kind."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.output.browser.opened import Opened, number
from tests.output.browser.test_cursor import CRITICAL, RPM, criticals, digits

from torsion.output.drawing.page_data import MOST_POINTS

BEYOND = """
name: a critical speed beyond the axis
operation: {speeds: {from: 300 rpm, to: 1800 rpm, steps: 61}, rated: {speed: 1700 rpm, power: 10 kW}}
train:
  - motor: {inertia: 1.0, ripple: [{order: 1, torque: 5 %}]}
  - coupling: {name: c, stiffness: 33 kN*m/rad, psi: 0.2}
  - propeller: {inertia: 1.0, blades: 4, excitation: [{blade_order: 2, torque: 1 %}]}
"""
LONG = """
name: long lines
operation: {speeds: {from: 300 rpm, to: 1800 rpm, steps: 3001}, rated: {speed: 1700 rpm, power: 10 kW}}
train:
  - motor: {inertia: 1.0, ripple: [{order: 1, torque: 5 %}, {order: 3, torque: 5 %}]}
  - coupling: {name: a, stiffness: 20 kN*m/rad, psi: 0.02}
  - disc: {inertia: 0.3}
  - coupling: {name: b, stiffness: 60 kN*m/rad, psi: 0.02}
  - propeller: {inertia: 1.0}
"""
NAME = "x" * 180
WIDE = f"""
name: a long name
operation: {{speeds: {{from: 300 rpm, to: 600 rpm, steps: 31}}, rated: {{speed: 600 rpm, power: 400 kW}}}}
train:
  - motor: {{inertia: 50}}
  - coupling: {{name: {NAME}, stiffness: 105 kN*m/rad, psi: 1, rated_torque: 7 kN*m,
      vibratory_torque: 1 kN*m, source: {NAME}}}
  - disc: {{name: d {NAME}, inertia: 1}}
  - coupling: {{name: c, stiffness: 107 kN*m/rad, psi: 1, rated_torque: 7 kN*m, vibratory_torque: 1 kN*m}}
  - propeller: {{inertia: 30, blades: 4, damping: 500, excitation: [{{blade_order: 1, torque: 1 %}}]}}
rules: [coupling-maker]
"""


@pytest.fixture
def opens_text(opens: Callable[..., Opened], tmp_path: Path) -> Callable[..., Opened]:
    """Opens the page of a scene from its text."""

    def opened(text: str, **context: Any) -> Opened:
        (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
        return opens(str(tmp_path / "scene"), **context)

    return opened


def named(page: Opened, figure: str) -> tuple[float, str, int]:
    match = CRITICAL.search(page.near(figure))
    assert match is not None, page.near(figure)
    return number(match[1]), match[2], int(match[3])


def nearest(page: Opened, speed: float) -> float:
    return min(
        (one["speed_rad_per_s"] * RPM for one in criticals(page.report)),
        key=lambda x: abs(x - speed),
    )


def test_a_critical_speed_beyond_the_axis_may_be_the_nearest(
    opens_text: Callable[..., Opened],
) -> None:
    page = opens_text(BEYOND)
    page.press("torque-1-0", "End")
    found, order, mode = named(page, "torque-1-0")
    assert (found, order, mode) == (digits(nearest(page, 1800.0)), "1", 1)
    assert found > 1800.0


@pytest.mark.parametrize("scene", ["wind_gearbox", "keyed_shaft"])
def test_the_nearest_is_sought_among_all_of_the_results(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    name = next(name for name in page.report.figures if name.startswith("torque-"))
    for key in ("Home", "End"):
        page.press(name, key)
        speed = page.now(name)
        assert named(page, name)[0] == digits(nearest(page, speed))


def test_of_long_lines_every_value_is_one_that_was_computed(
    opens_text: Callable[..., Opened],
) -> None:
    page = opens_text(LONG)
    figures = {
        name: one
        for name, one in page.report.figures.items()
        if name.startswith(("torque-", "steady"))
    }
    source, *_ = figures
    assert len(figures) > 1
    (left, high), (right, _) = (page.spot(source, share) for share in (0.003, 0.997))
    for across in np.linspace(left, right, 40):
        page.page.mouse.move(float(across), high)
        for name, figure in figures.items():
            assert max(line.x.size for line in figure.lines.values()) > MOST_POINTS
            x = next(iter(figure.lines.values())).x
            at = page.now(name)
            k = int(np.argmin(np.abs(x - at)))
            assert at == pytest.approx(x[k], rel=1e-9)
            speed, found = page.read(name)
            assert speed == digits(at)
            assert found == {words: digits(line.y[k]) for words, line in figure.lines.items()}, (
                name,
                at,
            )


def test_figures_of_bending_name_the_critical_speeds_of_their_shaft(
    opens: Callable[..., Opened],
) -> None:
    page = opens("cardan_bearings")
    known = {name: one.criticals for name, one in page.report.figures.items()}
    shafts = {
        one["name"]: one["critical_speeds"] for one in page.report.results["lateral"]["shafts"]
    }
    bending = [name for name in known if name.startswith(("whirl-", "bending-"))]
    assert bending
    for name in bending:
        page.press(name, "End")
        caption, near = page.report.figures[name].caption, page.near(name)
        (shaft,) = [one for one in shafts if one in caption]
        speed = page.now(name)
        own = [one["speed_rad_per_s"] * RPM for one in shafts[shaft]]
        if not own:
            assert near == ""
            continue
        best = min(own, key=lambda x: abs(x - speed))
        assert near.startswith(
            f"nearest critical speed of bending of {shaft} {digits(best):g} rpm"
        ), name
    for name in known:
        if name.startswith("tilting-"):
            page.press(name, "End")
            assert page.near(name) == ""


def test_p_in_a_diagram_of_whirl_goes_from_mark_to_mark(opens: Callable[..., Opened]) -> None:
    page, name = opens("tilting_tail"), "whirl-1"
    (panel,) = page.report.figures[name].plots
    x = sorted(x for marks in panel.marks if marks.words for x in marks.x.tolist())
    assert x
    for speed in (*x, x[0]):
        page.press(name, "p")
        assert number(page.near(name).partition(" rpm")[0].rpartition(" ")[2]) == digits(speed)


def test_an_order_that_is_switched_off_governs_nothing(usv: Opened) -> None:
    usv.press("campbell", "p")
    _, order, _ = named(usv, "campbell")
    usv.key("campbell", f"order {order}").click()
    left = [one["speed_rad_per_s"] * RPM for one in criticals(usv.report) if one["order"] != order]
    x = [x for marks in usv.report.figures["campbell"].plots[0].marks for x in marks.x.tolist()]
    wanted = sorted(one for one in left if min(abs(np.array(x) - one)) < 1e-6)
    usv.press("campbell", "Home")
    for speed in (*wanted, wanted[0]):
        usv.press("campbell", "p")
        assert usv.read("campbell")[0] == digits(speed)
        assert named(usv, "campbell")[1] != order
    usv.key("campbell", f"order {order}").click()


def test_the_buttons_of_tables_are_seen_whole(opens: Callable[..., Opened]) -> None:
    page = opens("usv", viewport={"width": 1200, "height": 900})
    cut = page.page.evaluate("""() => [...document.querySelectorAll('caption button')].filter((one) =>
        one.getBoundingClientRect().top < one.closest('.table').getBoundingClientRect().top)
        .map((one) => one.ariaLabel)""")
    assert cut == []


def test_a_long_name_does_not_widen_the_page(opens_text: Callable[..., Opened]) -> None:
    page = opens_text(WIDE)
    assert page.page.evaluate("document.documentElement.scrollWidth") <= 900
