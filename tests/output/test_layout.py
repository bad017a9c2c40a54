"""Places of the sketch: a link is drawn as long as its kind says, a branch on a free row beside what carries it."""

from collections.abc import Sequence

import numpy as np
import pytest

import torsion
from torsion.analyses.response.component_loads import local_maxima
from torsion.findings import Findings
from torsion.output.station_layout import label, layout
from torsion.output.stored.scene import elements

SHAFT, COUPLING, GEAR, JOINT, RIGID, ASIDE = 1.6, 1.0, 0.45, 0.8, 0.5, 0.5
SPRING = "coupling: {stiffness: 1e3}"
ROD = "shaft: {name: rod, length: 1 m, diameter: 100 mm, segments: 4}"
MATERIALS = """
materials:
  light: {shear_modulus: 80 GPa, density: 0.5 kg/m**3, unusual: true}
  none: {shear_modulus: 80 GPa, density: 0}
"""


def disc(name: str, more: str = "") -> str:
    return f"disc: {{name: {name}, inertia: 1{more}}}"


def line(*names: str) -> list[str]:
    """Couplings in a row, each with a disc at its end."""
    return [one for name in names for one in (SPRING, disc(name))]


def listed(train: Sequence[str]) -> str:
    return "[" + ", ".join(f"{{{one}}}" for one in train) + "]"


def branch(*train: str) -> str:
    return f"branch: {{train: {listed(train)}}}"


def gear(*train: str) -> str:
    """A gear with a train on a second wheel."""
    return f"gear: {{teeth: [20, 40], inertia: [1, 1], branches: [{{teeth: [20, 30], train: {listed(train)}}}]}}"


def places(
    *train: str, materials: str = "", model: str = "lumped"
) -> dict[str, tuple[float, float]]:
    """Place and row of every station, by name."""
    read = torsion.parse(f"name: x\n{materials}\ntrain: {listed(train)}\n").train
    system = torsion.assemble(read, model, frequency=3000.0)
    found = layout(system)
    stand = zip(found.x.tolist(), found.row.tolist(), strict=True)
    return dict(zip((station.name for station in system.stations), stand, strict=True))


def at(x: float, row: float = 0.0) -> object:
    return pytest.approx((x, row))


def rows(found: dict[str, tuple[float, float]], names: str) -> list[float]:
    return [found[name][1] for name in names]


def test_links_are_as_long_as_their_kind_and_points_in_a_row_a_half_apart() -> None:
    found = places(
        disc("a"),
        SPRING,
        disc("b"),
        ROD,
        disc("c"),
        disc("d"),
        "gear: {teeth: [20, 40], inertia: [1, 1]}",
        disc("e"),
        "joint: {angle: 5 deg}",
        disc("f"),
    )
    stand = np.cumsum([0.0, COUPLING, SHAFT, RIGID, GEAR, JOINT])
    assert {name: found[name] for name in "abcdef"} == {
        name: at(x) for name, x in zip("abcdef", stand, strict=True)
    }


def test_inner_stations_of_a_shaft_stand_evenly_between_its_ends_on_the_row_of_the_driven_one() -> (
    None
):
    found = places(disc("a"), disc("b"), ROD, disc("c"))
    assert [found[f"rod {k}/4"] for k in (1, 2, 3)] == [
        at(RIGID + SHAFT * k / 4.0) for k in (1, 2, 3)
    ]
    found = places(disc("a"), disc("b"), branch(ROD, disc("c")), *line("d"))
    assert [found[f"rod {k}/4"] for k in (1, 2, 3)] == [
        at(RIGID + SHAFT * k / 4.0, 1.0) for k in (1, 2, 3)
    ]
    assert found["c"] == at(RIGID + SHAFT, 1.0)


@pytest.mark.parametrize("model", ["fem", "exact"])
def test_the_end_of_a_shaft_with_inertia_stands_at_its_driven_station(model: str) -> None:
    """In the models of distributed inertia; a shaft without inertia is a spring with nothing between its ends."""
    shafts = [
        f"shaft: {{name: {name}, length: 1 m, diameter: 100 mm, material: {name}}}"
        for name in ("none", "light")
    ]
    found = places(
        disc("a"),
        shafts[0],
        disc("b"),
        branch(shafts[1], disc("c")),
        materials=MATERIALS,
        model=model,
    )
    assert [name for name in found if name.startswith("none")] == []
    assert found["c"] == found["light end"] == at(2.0 * SHAFT, 1.0)
    inner = sorted(
        found[name] for name in found if name.startswith("light") and name != "light end"
    )
    assert inner == [
        at(SHAFT + SHAFT * k / (len(inner) + 1), 1.0) for k in range(1, len(inner) + 1)
    ]
    assert inner


def test_a_branch_stands_below_what_carries_it_the_next_above_and_further_ones_below_all() -> None:
    found = places(*line("a"), *(branch(*line(one)) for one in "bcde"), *line("f", "g"))
    assert rows(found, "abcdefg") == [0, 1, -1, 2, 3, 0, 0]
    start = found["a"][0]
    assert {found[one][0] for one in "bcdef"} == {start + COUPLING}


@pytest.mark.parametrize(
    ("between", "row"), [((*line("x"), *line("y")), 1), ((*line("x"), disc("y")), -1)]
)
def test_a_branch_takes_a_row_again_where_it_begins_more_than_a_half_behind_its_end(
    between, row
) -> None:
    """The first branch ends at 1, the second begins at 2 or at 1.5."""
    found = places(disc("a"), branch(*line("b")), *between, branch(*line("c")), *line("d"))
    assert rows(found, "abcd") == [0, 1, row, 0]


def test_the_longest_component_of_a_row_says_how_far_it_is_filled() -> None:
    """At d the row below is filled to 4 by the branch b, and the one above ends at 1 in the branch e."""
    found = places(
        disc("a"),
        branch(*line("b", "b2", "b3", "b4")),
        branch(*line("e")),
        *line("d"),
        *line("f"),
        branch(*line("c")),
        *line("g"),
    )
    assert rows(found, "abedfcg") == [0, 1, -1, 0, 0, -1, 0]


def test_a_wheel_stands_beside_its_gear_and_its_train_on_a_row_of_its_own() -> None:
    found = places(disc("a"), gear(*line("b")), disc("c"), gear(*line("d")))
    assert found["c"] == at(GEAR)
    assert found["gear-1 wheel 2"] == at(GEAR, 1.0)
    assert found["b"] == at(GEAR + COUPLING, 1.0)
    assert found["gear-2 wheel 2"] == at(2.0 * GEAR, -1.0)
    assert found["d"] == at(2.0 * GEAR + COUPLING, -1.0)


def test_a_disc_on_a_wheel_stands_a_half_behind_the_gear() -> None:
    found = places(disc("a"), gear(disc("b"), *line("c")), disc("d"))
    assert [found[name] for name in "bcd"] == [at(RIGID, 1.0), at(RIGID + COUPLING, 1.0), at(GEAR)]


def test_a_wheel_on_a_branch_stands_beside_the_branch_and_not_across_the_main_line() -> None:
    found = places(disc("a"), branch(*line("b"), gear(*line("c")), *line("e")), *line("d"))
    assert rows(found, "abced") == [0, 1, 2, 1, 0]
    assert found["gear-1 wheel 2"] == at(COUPLING + GEAR, 2.0)


def test_a_branch_of_a_branch_never_stands_on_a_line_that_goes_on() -> None:
    """Both carried at b: the main line, above, has not come so far in the file, but goes on."""
    found = places(
        disc("a"),
        branch(*line("b"), branch(*line("c")), branch(*line("d")), *line("e")),
        *line("f", "g"),
    )
    assert rows(found, "abcdefg") == [0, 1, 2, 3, 1, 0, 0]
    assert len(set(found.values())) == len(found)


def test_what_one_station_alone_carries_hangs_half_a_row_beside_it() -> None:
    found = places(
        disc("a"),
        "damper: {name: d, housing: 1, ring: 2, damping: 3}",
        *line("b"),
        disc("c", ", stiffness: 5"),
        branch(*line("e"), gear()),
        *line("f"),
    )
    x = RIGID + COUPLING + RIGID
    assert found["d"] == at(RIGID)
    assert found["d ring"] == at(RIGID, ASIDE)
    assert found["c"] == at(x)
    assert found["c ground"] == at(x, ASIDE)
    assert found["gear-1 wheel 2"] == at(x + COUPLING, 1.0 + ASIDE)


@pytest.mark.parametrize(("number", "name"), [(14, "3 c"), (15, "3")])
def test_a_picture_of_up_to_fourteen_components_bears_their_names(number: int, name: str) -> None:
    train = torsion.parse(
        f"name: x\ntrain: {listed([disc(one) for one in 'abcdefghijklmno'[:number]])}\n"
    ).train
    assert label(train.parts, 2) == name


def test_the_main_line_runs_to_the_right_and_branches_stand_beside_it(train: Findings) -> None:
    place, stations = layout(train.system), [s.name for s in train.system.stations]
    assert np.isfinite(place.x).all()
    main = [stations.index(name) for name in ("motor-1", "propeller-1")]
    assert place.x[main[0]] < place.x[main[1]]
    assert place.row[main].tolist() == [0, 0]
    pump, generator = (place.row[stations.index(name)] for name in ("pump", "generator"))
    assert pump != 0
    assert generator != 0


def test_no_two_points_stand_on_each_other(train: Findings) -> None:
    place = layout(train.system)
    points = [p.stations[0] for p in train.system.train.parts if p.is_point]
    assert len({(round(float(place.x[s]), 6), float(place.row[s])) for s in points}) == len(points)


def test_segments_of_a_shaft_are_one_element(train: Findings) -> None:
    names = [element.name for element in elements(train.system)]
    assert len(names) == len(set(names))
    spans = [span for element in elements(train.system) for span in element.spans]
    assert sorted(spans) == list(range(len(train.system.spans)))


def test_a_maximum_needs_reliable_neighbours() -> None:
    nan = np.nan
    assert local_maxima(np.array([0.0, 1, 0, 2, nan, 2, 0, 3, 3, 1])) == [1, 7]
