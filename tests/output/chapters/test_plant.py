"""The sketch of the plant and the list of its components, against the file and the places of the stations."""

import math

import pytest

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters import plant
from torsion.output.chapters.plant import chapter
from torsion.output.figures.figure import Disc, Link
from torsion.output.station_layout import layout

TEXT = """
name: all that a sketch shows
operation: {at: big, rated: {speed: 300 rpm}}
train:
- disc: {name: big, inertia: 100, source: maker}
- coupling: {name: soft, stiffness: 1e4}
- disc: {name: mid, inertia: 10, note: weighed}
- shaft: {name: cone, length: 1 m, diameter: [80 mm, 100 mm], bore: [20 mm, 30 mm], segments: 2}
- gear:
    name: stage
    teeth: [20, 30]
    inertia: [1, 3]
    branches: [{teeth: 25, inertia: 0.05, train: [disc: {name: pump, inertia: 0}]}]
- damper: {name: dmp, housing: 0.4, ring: 31.622776601683795, damping: 30, stiffness: 1e4}
- branch:
    train:
    - gear: {name: lift, ratio: 2, inertia: [0.1, 0.2]}
    - coupling: {name: side, stiffness: 1e5}
    - damper: {name: weak, housing: 1, ring: 0.01, damping: 3}
- branch: {train: [shaft: {name: stub, length: 1 m, diameter: 50 mm, segments: 1}, disc: {name: pto, inertia: 0.5}]}
- joint: {name: hooke, angle: 5.1264 deg}
- disc: {name: brake, inertia: 2, stiffness: 1e3}
- disc: {name: tail, inertia: 4}
- coupling: {name: wall spring, stiffness: 1e5}
- disc: {name: wall, held: true}
links: [{between: [pto, tail], coupling: {name: bypass, stiffness: 1e3}}]
"""
FEW = """
name: x
train:
- disc: {name: a, inertia: 2}
- disc: {name: b, inertia: 2}
- coupling: {name: c, stiffness: 5}
- disc: {name: d, inertia: 1}
"""


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def sketch(findings: Findings) -> tuple[dict[str, Disc], tuple[Link, ...]]:
    """Points by the name of their component, and links."""
    drawn = plant.sketch(findings)
    parts = [part.name for part in findings.study.train.parts]
    return {parts[int(disc.label.split()[0]) - 1]: disc for disc in drawn.discs}, drawn.links


def places(findings: Findings) -> dict[str, tuple[float, float]]:
    """x and row of the stations by name."""
    place = layout(findings.system)
    return {
        station.name: (float(x), float(row))
        for station, x, row in zip(findings.system.stations, place.x, place.row, strict=True)
    }


def test_components_with_their_rated_speeds_sources_and_notes(found: Findings) -> None:
    head, said, made = chapter(found)
    assert isinstance(made, Table)
    assert isinstance(said, Paragraph)
    assert head == Heading("The plant")
    assert said.text.startswith("Speed ratio: speed / speed of big;")
    rows = {row[0]: row for row in made.rows}
    assert rows["big"] == ("big", "disc", "1", "300", "maker", "–")
    assert rows["mid"] == ("mid", "disc", "1", "300", "–", "weighed")
    assert rows["pump"][2:4] == ("4/5", "240")
    assert rows["brake"][2:4] == ("2/3", "200")
    *_, made = chapter(torsion.run(torsion.parse(FEW)))
    assert isinstance(made, Table)
    assert made.rows[0] == ("a", "disc", "1")


def test_heights_of_discs_are_by_the_logarithm_of_their_inertia(found: Findings) -> None:
    """Of three decades below the largest; the housing and the stations of shafts have more than their own inertia."""
    points, _ = sketch(found)
    own = dict(
        zip(
            (station.name for station in found.system.stations),
            found.system.inertia.tolist(),
            strict=True,
        )
    )
    for name in ("big", "mid", "pto", "brake", "tail", "weak"):
        assert points[name].size == pytest.approx((math.log10(own[name]) + 1.0) / 3.0, abs=1e-12), (
            name
        )
    assert points["dmp"].ring == pytest.approx(2.5 / 3.0, rel=1e-12)
    assert points["weak"].ring == 0.1
    assert points["wall"].size == points["pump"].size == 0.0
    assert {name: point.ring for name, point in points.items() if point.ring} == {
        "dmp": pytest.approx(2.5 / 3.0),
        "weak": 0.1,
    }
    assert [name for name, point in points.items() if point.is_held] == ["wall"]
    assert [name for name, point in points.items() if point.is_grounded] == ["brake"]
    place = places(found)
    assert {name: (point.x, point.row) for name, point in points.items()} == {
        name: place[name] for name in points
    }
    assert {point.kind for point in points.values()} == {"disc", "damper"}


@pytest.mark.parametrize(
    ("inertias", "sizes"),
    [
        ((2.0, 2.0), (0.5, 0.5)),
        ((2.0, 0.5), (1.0, 0.0)),
        ((1e3, 20.0), (1.0, 0.0)),
        ((1e4, 100.0), (1.0, 0.0)),
        ((0.1, 0.01), (1.0, 0.0)),
        ((0.0, 0.0), (0.0, 0.0)),
    ],
)
def test_sizes_of_two_discs(inertias: tuple[float, float], sizes: tuple[float, float]) -> None:
    text = "name: x\ntrain: [disc: {{name: a, inertia: {}}}, coupling: {{stiffness: 5}}, disc: {{name: b, inertia: {}}}]"
    points, _ = sketch(torsion.run(torsion.parse(text.format(*inertias))))
    assert tuple(point.size for point in points.values()) == pytest.approx(sizes, abs=1e-15)


def test_links_between_their_stations(found: Findings) -> None:
    """Ties lead down to the row of a branch and up to a link beside the train; a gear crosses rows by itself."""
    _, links = sketch(found)
    place, name = (
        places(found),
        {str(k): part.name for k, part in enumerate(found.study.train.parts, 1)},
    )
    drawn = {name.get(one.label.split()[0], ""): one for one in links if one.label}
    assert {one: drawn[one].kind for one in drawn} == {
        "soft": "coupling",
        "cone": "shaft",
        "stage": "gear",
        "lift": "gear",
        "side": "coupling",
        "stub": "shaft",
        "hooke": "joint",
        "wall spring": "coupling",
        "bypass": "coupling",
    }
    ends = {
        "soft": ("big", "mid"),
        "cone": ("mid", "cone end"),
        "stage": ("cone end", "dmp"),
        "lift": ("dmp", "lift end"),
        "side": ("lift end", "weak"),
        "hooke": ("dmp", "brake"),
        "wall spring": ("tail", "wall"),
    }
    assert {one: (drawn[one].start, drawn[one].end) for one in ends} == {
        one: (place[first], place[last]) for one, (first, last) in ends.items()
    }
    (x, row), (last, level) = place["dmp"], place["pto"]
    assert row != level
    assert (drawn["stub"].start, drawn["stub"].end) == ((x, level), (last, level))
    from_side, to_tail = place["pto"], place["tail"]
    above = max(from_side[1], to_tail[1]) + 0.5
    assert (drawn["bypass"].start, drawn["bypass"].end) == (
        (from_side[0], above),
        (to_tail[0], above),
    )
    ties = [(one.start, one.end) for one in links if one.kind == "tie"]
    assert ties == [
        (place["dmp"], (x, level)),
        (from_side, (from_side[0], above)),
        (to_tail, (to_tail[0], above)),
    ]
    rigid = [(one.start, one.end) for one in links if one.kind == "rigid"]
    assert rigid == [(place["brake"], place["tail"])]
    assert drawn["hooke"].label.endswith(" (5.13°)")
    (wheel,) = [one for one in links if one.kind == "gear" and not one.label]
    assert (wheel.start, wheel.end) == (place["cone end"], place["pump"])
    assert (wheel.ratio, drawn["stage"].ratio, drawn["lift"].ratio) == pytest.approx(
        (0.8, 2 / 3, 0.5)
    )
    assert drawn["cone"].bore == pytest.approx(0.25)
    assert drawn["cone"].taper == pytest.approx((0.8, 1.0))
    assert (drawn["stub"].bore, drawn["stub"].taper) == (0.0, (1.0, 1.0))


def test_a_sketch_of_few_components_bears_their_names() -> None:
    points, links = sketch(torsion.run(torsion.parse(FEW)))
    assert [point.label for point in points.values()] == ["1 a", "2 b", "4 d"]
    assert [link.label for link in links] == ["", "3 c"]
