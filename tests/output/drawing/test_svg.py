"""Figures are SVG, the same every time, with every line, limit and range that they were given in them."""

import itertools
import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from tests.for_all import for_all
from tests.output.drawing.kinds import BAD, BUMP, KINDS, SPEED, frequency, torque
from tests.output.drawn import named

from torsion.output.drawing.frame import WIDTH
from torsion.output.drawing.pens import COLOURS, DASHES, stroke
from torsion.output.drawing.svg import description, svg
from torsion.output.drawing.words import GROWTH, SIZE, plain, width
from torsion.output.figures.curves import orders
from torsion.output.figures.figure import Axis, Figure, Line, Marks, Panel

SVG = "{http://www.w3.org/2000/svg}"


def parsed(figure: Figure) -> ET.Element:
    return ET.fromstring(svg(figure))


def texts(figure: Figure) -> list[str]:
    return [
        "".join(one.itertext()).replace("\u200b", "") for one in parsed(figure).iter(f"{SVG}text")
    ]


@for_all("kind", KINDS)
def test_a_figure_is_well_formed_and_the_same_every_time(kind: str) -> None:
    text = svg(KINDS[kind])
    assert ET.fromstring(text).tag == f"{SVG}svg"
    assert text == svg(KINDS[kind])
    assert not re.search(r"\b(nan|inf)\b", text)


@for_all("kind", KINDS)
def test_nothing_is_fetched_and_no_name_is_an_id(kind: str) -> None:
    root = parsed(KINDS[kind])
    for one in root.iter():
        for key, value in one.attrib.items():
            if key.endswith(("href", "src")):
                assert value.startswith("data:image/png;base64,")
            assert "url(" not in value
            assert key not in ("id", "style")
        assert one.tag.removeprefix(SVG) in {
            "svg",
            "desc",
            "title",
            "g",
            "path",
            "rect",
            "text",
            "tspan",
            "image",
        }


@for_all("kind", KINDS)
def test_a_figure_has_a_title_and_a_description_for_those_who_cannot_see_it(kind: str) -> None:
    root = parsed(KINDS[kind])
    assert root.get("role") == "img"
    assert root.get("aria-label") == plain(KINDS[kind].caption)
    said = root.find(f"{SVG}desc").text or ""
    for panel in KINDS[kind].plots:
        assert plain(panel.y.title) in said
        assert all(
            plain(name) in said for name, line in named(panel).items() if np.isfinite(line.y).any()
        )


@for_all("kind", KINDS)
def test_every_line_stands_in_its_plot_and_every_name_once_in_the_key(kind: str) -> None:
    root, figure = parsed(KINDS[kind]), KINDS[kind]
    drawn = [one.get("data-name") for one in root.iter(f"{SVG}g") if one.get("class") == "line"]
    assert drawn == [plain(line.name) for panel in figure.plots for line in panel.lines]
    keys = next((one for one in root.iter(f"{SVG}g") if one.get("class") == "key"), None)
    said = (
        []
        if keys is None
        else ["".join(one.itertext()).replace("\u200b", "") for one in keys.iter(f"{SVG}text")]
    )
    for panel in figure.plots:
        for one in (
            *panel.lines,
            *panel.levels,
            *panel.bands,
            *(m for m in panel.marks if m.x.size),
        ):
            if one.name:
                assert (
                    sum(word.split(":")[0] == plain(one.name).split(":")[0] for word in said) == 1
                ), one.name


@for_all("kind", KINDS)
def test_words_lie_on_the_sheet_and_do_not_overlap(kind: str) -> None:
    """Level words of one group; those of a plot keep clear with letters a quarter larger, too."""
    root = parsed(KINDS[kind])
    for group in root.iter(f"{SVG}g"):
        growth = {"words": GROWTH, "axis": 1.0}.get(group.get("class"))
        boxes = []
        for one in group.findall(f"{SVG}text") if growth else ():
            wide = width("".join(one.itertext()).replace("\u200b", "")) * growth
            x, y, high = float(one.get("x")), float(one.get("y")) - 3.7, SIZE * growth
            left = x - {"middle": wide / 2, "end": wide}.get(one.get("text-anchor"), 0.0)
            if one.get("transform") is None:
                boxes.append((left, y - high / 2, left + wide, y + high / 2))
        for one, other in itertools.combinations(boxes, 2):
            assert (
                one[0] >= other[2]
                or other[0] >= one[2]
                or one[1] >= other[3] - 1
                or other[1] >= one[3] - 1
            )
    box = [float(one) for one in root.get("viewBox").split()]
    for one in root.iter(f"{SVG}g"):
        if one.get("class") == "axis":
            assert all(0 <= float(word.get("x")) <= WIDTH for word in one.iter(f"{SVG}text"))
            assert all(0 <= float(word.get("y")) <= box[3] for word in one.iter(f"{SVG}text"))


def test_names_stand_as_text_with_their_signs_escaped() -> None:
    assert "1 &lt;motor&gt; &amp; $x$" in svg(KINDS["sketch"])
    assert "\x08" not in svg(Figure("a", "bell \x08", ()))


@pytest.mark.parametrize("name", ["弹性联轴器", "⚓ 𓀀"])
def test_names_in_signs_that_no_font_here_has_stand_as_text(name: str) -> None:
    assert name in texts(torque(lines=[(name, BUMP)]))
    assert "sans-serif" in svg(torque())


@pytest.mark.parametrize("kind", ["torque", "stress", "gear", "frequency"])
def test_what_is_not_reliable_is_hatched_and_has_no_curve(kind: str) -> None:
    assert "no reliable answer here" in texts(KINDS[kind])
    sound = {"torque": torque, "frequency": frequency}.get(kind)
    if sound is not None:
        assert "no reliable answer here" not in texts(sound(bad=np.zeros(61, dtype=bool)))
    for line in KINDS[kind].lines.values():
        if "limit" not in line.name and "mean" not in line.name:
            assert np.isnan(line.y[BAD]).all()


def test_a_peak_far_above_the_rest_takes_a_logarithmic_axis() -> None:
    steep = frequency(lines=[("a", 1e4 * BUMP**2)], bad=np.zeros(61, dtype=bool))
    assert steep.plots[0].y.is_log
    assert {"1000", "10⁶"} & set(texts(steep))
    assert not frequency(lines=[("a", BUMP + 20)]).plots[0].y.is_log


def test_lines_differ_in_dashes_as_well_as_in_colour() -> None:
    pens = [stroke(k) for k in range(len(COLOURS) * len(DASHES))]
    assert len({(pen.colour, pen.dash) for pen in pens}) == 42
    for one, other in itertools.pairwise(pens):
        assert one.colour != other.colour
        assert one.dash != other.dash


def test_the_order_with_the_largest_torque_is_heavier_and_orders_bear_their_numbers() -> None:
    lines = torque(lines=[("order 1", BUMP / 3), ("order 4", BUMP)]).lines
    assert lines["order 4"].weight > lines["order 1"].weight == 1.0
    assert {"1", "4"} <= set(texts(torque(lines=[("order 1", BUMP / 3), ("order 4", BUMP)])))


def test_a_small_stress_has_a_plot_of_its_own_and_a_large_one_not() -> None:
    small, large = KINDS["small stress"], KINDS["stress"]
    assert len(large.plots) == 1
    both, alone = small.plots
    assert list(named(both)) == ["total stress", "limit τ_{C}, continuous"]
    assert list(named(alone)) == ["total stress", "order 2"]
    assert both.x == alone.x


def test_a_limit_off_the_scale_is_named_with_its_value() -> None:
    far = torque(limits=[("permitted", 5000.0)])
    assert "permitted: 5000 N m, not on this scale" in texts(far)
    assert "permitted" in texts(torque(limits=[("permitted", 300.0)]))


def test_crossings_lie_on_the_lines_of_their_orders_and_modes() -> None:
    """Orders 1 and 3 meet 2 Hz at 120 and 40 rpm and 5 Hz at 100 rpm: px are linear in both."""
    from tests.output.drawing.curves_by_hand import campbell

    found = [(120.0, 2.0, True, "a"), (40.0, 2.0, True, "b"), (100.0, 5.0, True, "c")]
    figure = campbell(
        "c",
        "",
        frequencies=[2.0, 5.0],
        orders=[(1.0, "one"), (3.0, "three")],
        crossings=found,
        speeds=(30.0, 150.0),
        rated=None,
    )
    root = parsed(figure)
    plot = next(one for one in root.iter(f"{SVG}svg") if one.get("class") == "plot")
    high, wide = (float(plot.get("viewBox").split()[k]) for k in (3, 2))
    right, top = figure.plots[0].x.high, figure.plots[0].y.high
    marks = {}
    for one in root.iter(f"{SVG}g"):
        title, drawn = one.find(f"{SVG}title"), one.find(f"{SVG}path")
        if title is not None and drawn is not None:
            marks[title.text] = [
                float(v) for v in re.match(r"M(\S+) (-?\d+)", drawn.get("d")).groups()
            ]
    for rpm, hertz, _, word in found:
        np.testing.assert_allclose(
            marks[word], [rpm / right * wide, high - hertz / top * high], atol=1.0
        )
    lines = {
        one.get("data-name"): one.find(f"{SVG}path").get("d")
        for one in root.iter(f"{SVG}g")
        if one.get("class") == "line"
    }
    for name, order in (("one", 1), ("three", 3)):
        x0, y0, across, down = (float(v) for v in re.findall(r"-?\d+", lines[name]))
        assert (x0, y0) == (0.0, high)
        np.testing.assert_allclose(
            -down / across, order * right / 60.0 / top * high / wide, rtol=2e-3
        )


def test_numbers_stand_below_the_last_of_plots_that_share_an_axis() -> None:
    x = Axis("time", "s", 0.0, 7.0)
    line = Line("a", np.array([0.0, 7.0]), np.array([0.0, 1.0]))
    shared = Figure("a", "", (Panel(x, Axis("p"), (line,)), Panel(x, Axis("q"), (line,))))
    assert texts(shared).count("time, s") == 1
    own = Figure("a", "", (Panel(x, Axis("p"), (line,)), Panel(Axis("angle"), Axis("q"), (line,))))
    assert {"time, s", "angle"} <= set(texts(own))


def test_the_description_says_the_largest_value_and_its_place() -> None:
    assert "order 1: largest 100 N m at 900.0 rpm." in description(
        torque(bad=np.zeros(61, dtype=bool))
    )


def test_subscripts_are_lowered_and_leave_no_braces() -> None:
    assert "T<tspan" in svg(torque())
    assert "_{" not in svg(torque())


def test_speeds_of_all_figures_are_one_axis() -> None:
    """By its words the figures of a page know that they share it."""
    for kind in ("torque", "stress", "gear", "stability", "whirl", "campbell"):
        assert KINDS[kind].plots[0].x.title == "speed of the reference component, rpm"
    assert SPEED[0] == KINDS["torque"].plots[0].x.low


def test_a_figure_of_very_many_points_is_as_small_as_its_px_and_keeps_its_peak() -> None:
    x = np.linspace(0.0, 100.0, 100_000)
    y = np.sin(40.0 * x) * np.random.default_rng(1).uniform(size=x.size)
    line = Line("a", x, y, 0, symbol="dot", base=0.0 * y)
    panel = Panel(Axis("x", "s"), Axis("y", "N m"), (line,), marks=(Marks("b", x, y, "cross"),))
    drawn = svg(Figure("f", "c", (panel,)))
    assert len(drawn) < 1_000_000
    few = svg(Figure("f", "c", (replace(panel, marks=(), lines=(replace(line, symbol=None),)),)))
    assert len(few) < 60_000


def test_of_more_than_eight_orders_seven_have_a_line_and_the_envelope_is_the_largest_of_the_others() -> (
    None
):
    x = np.linspace(0.0, 1.0, 50)
    sizes = [5.0, 1.0, 9.0, 3.0, 0.0, 8.0, 7.0, 6.0, 4.0, 2.0]
    lines = [(f"order {k}", size * (1.0 + x**k)) for k, size in enumerate(sizes)]
    found = orders(x, lines, np.zeros(50, dtype=bool))
    assert [line.name for line in found] == [
        *(f"order {k}" for k in (0, 2, 3, 5, 6, 7, 8)),
        "envelope of the other 2",
    ]
    np.testing.assert_array_equal(found[-1].y, np.maximum(lines[1][1], lines[9][1]))
    assert len(orders(x, lines[:9], np.zeros(50, dtype=bool))) == 8
    assert max(found, key=lambda line: line.weight).name == "order 2"
