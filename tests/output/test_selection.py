"""What is chosen of many values: the largest that is known, the strongest curves, and the names of what they are of."""

import math

import numpy as np
import pytest

import torsion
from torsion.analyses import Analysis
from torsion.arrays import FloatArray
from torsion.output.blocks import Heading, Table
from torsion.output.chapters.declared_results import chapter
from torsion.output.numbers import Scale
from torsion.output.reported_values import barred
from torsion.output.stored.scene import (
    Selection,
    damps,
    elements,
    strongest,
    torques,
)
from torsion.results import Quantity, reported, result
from torsion.rules.verdict_line import BarredRange, Check, Checks

TRAIN = """
name: x
train:
- disc: {name: a, inertia: 1}
- coupling: {name: lossy, stiffness: 100, loss_factor: 0.1}
- disc: {name: b, inertia: 1}
- coupling: {name: viscous, stiffness: 100, viscous: 0.5}
- disc: {name: c, inertia: 1}
- coupling: {name: elastic, stiffness: 100}
- disc: {name: d, inertia: 1}
"""


@reported
class Heights:
    """A result of one number and one array by mode."""

    count: int = result("", (), "how many")
    height: FloatArray = result("m", ("mode",), "of every mode")


def test_torques_have_the_unit_of_the_largest() -> None:
    assert torques([np.array([3.0]), np.array([4500.0, math.nan])]) == Scale("kN m", 1e-3)
    assert torques([np.array([3.0])]).unit == "N m"


def test_the_strongest_curves_stand_in_their_own_order() -> None:
    values = np.array([[1.0, 9.0, 0.0, 4.0, math.nan], [2.0, 3.0, 0.0, 8.0, 5.0]])
    assert strongest(values, 2) == [1, 3]
    assert strongest(values, 3) == [1, 3, 4]
    assert strongest(values, 9) == [0, 1, 3, 4]
    assert strongest(np.array([[0.1, 0.3, 0.2]]), 2) == [1, 2]
    assert strongest(np.array([[math.nan, 0.3, 0.2]]), 2) == [1, 2]


def test_a_lossy_or_a_viscous_coupling_damps() -> None:
    system = torsion.assemble(torsion.parse(TRAIN).train)
    assert [(one.name, damps(system, one)) for one in elements(system)] == [
        ("lossy", True),
        ("viscous", True),
        ("elastic", False),
    ]


def test_the_largest_of_an_element_is_that_of_all_its_segments() -> None:
    shaft = "shaft: {name: s, length: 1 m, diameter: 50 mm, segments: 3}"
    text = f"name: x\ntrain: [disc: {{inertia: 1}}, {shaft}, disc: {{inertia: 1}}]\n"
    system = torsion.assemble(torsion.parse(text).train)
    (element,) = elements(system)
    assert len(element.spans) == 3
    assert element.largest(np.array([[1.0, 7.0, 2.0], [5.0, 4.0, 3.0]])).tolist() == [7.0, 5.0]
    assert element.largest(np.arange(24.0).reshape(2, 4, 3)[:, :, ::-1]).tolist() == [
        [2, 5, 8, 11],
        [14, 17, 20, 23],
    ]


SEGMENTS = """
name: x
train:
- disc: {name: a, inertia: 1}
- shaft: {name: tube, length: 1 m, diameter: 50 mm, segments: 3}
- disc: {name: b, inertia: 1}
- coupling: {name: soft, stiffness: 100}
- disc: {name: c, inertia: 1}
"""  # the coupling is span 0, the segments are spans 1 to 3 and have stations 3 and 4 between them


def test_what_is_listed_of_a_shaft_in_segments_are_its_ends_and_its_name() -> None:
    chosen = Selection(torsion.assemble(torsion.parse(SEGMENTS).train))
    assert [(one.name, list(one.spans)) for one in chosen.elements] == [
        ("tube", [1, 2, 3]),
        ("soft", [0]),
    ]
    assert [chosen.positions(axis) for axis in ("element", "named station", "end span")] == [
        ["tube", "soft"],
        [0, 1, 2],
        [0, 1, 3],
    ]


@pytest.mark.parametrize(
    ("axes", "printed", "wanted"),
    [
        (("mode", "span"), ("mode", "element"), [[9.0, 2.0], [7.0, 1.0]]),
        (("mode", "span"), ("element", "mode"), [[9.0, 7.0], [2.0, 1.0]]),
        (("mode", "span"), ("mode", "end span"), [[2.0, 5.0, 6.0], [1.0, 7.0, 4.0]]),
        (("mode", "span"), ("span", "mode"), [[2.0, 1.0], [5.0, 7.0], [9.0, 3.0], [6.0, 4.0]]),
    ],
)
def test_values_over_spans_are_reduced_to_elements_or_their_ends(axes, printed, wanted) -> None:
    chosen = Selection(torsion.assemble(torsion.parse(SEGMENTS).train))
    values = np.array([[2.0, 5.0, 9.0, 6.0], [1.0, 7.0, 3.0, 4.0]])
    assert chosen.reduced(values, Quantity("", axes, "", printed=printed), axes).tolist() == wanted


def test_values_over_stations_are_reduced_to_those_that_are_named() -> None:
    chosen = Selection(torsion.assemble(torsion.parse(SEGMENTS).train))
    values = np.array([[1.0, 2.0, 3.0, 4.0, 5.0]])
    for printed, wanted in (
        ("named station", [1.0, 2.0, 3.0]),
        ("station", [1.0, 2.0, 3.0, 4.0, 5.0]),
    ):
        quantity = Quantity("", ("speed", "station"), "", printed=("speed", printed))
        assert chosen.reduced(values, quantity, quantity.axes).tolist() == [wanted]
        assert chosen.reduced(values[0], quantity, ("station",)).tolist() == wanted


def test_points_that_are_rigidly_joined_have_no_element_between_them_but_a_rigid_mesh_is_one() -> (
    None
):
    text = """
name: x
train:
- gear: {name: mesh, teeth: [20, 40], inertia: [1, 2]}
- disc: {name: a, inertia: 1}
- disc: {name: b, inertia: 1}
- coupling: {name: stiff, stiffness: 2}
- disc: {name: c, inertia: 1}
"""
    system = torsion.assemble(torsion.parse(text).train)
    made = elements(system)
    assert [(one.name, one.kind, one.part, one.ratio) for one in made] == [
        ("mesh", "gear", 0, 1.0),
        ("stiff", "coupling", 3, 0.5),
    ]
    assert [list(one.spans) for one in made] == [
        [index]
        for name in ("mesh", "stiff")
        for index, span in enumerate(system.spans)
        if span.name == name
    ]


def test_places_of_an_axis_without_names_count_from_one() -> None:
    found = torsion.run(torsion.parse(TRAIN)).having(heights=Heights(2, np.array([3.0, 4.0])))
    blocks = chapter(Analysis("heights", "x", results={"heights": "x:Heights"}), found)
    assert blocks[0] == Heading("Heights")
    single, by_mode = (block for block in blocks if isinstance(block, Table))
    assert single.rows == (("count", "2", "", "how many"),)
    assert by_mode.rows == (("1", "3.0000"), ("2", "4.0000"))
    assert [column.title for column in by_mode.columns] == ["mode", "height_m"]


@pytest.mark.parametrize("number", [1, 2])
def test_the_number_of_a_mode_heads_its_share(number: int) -> None:
    from torsion.output.chapters import chapters

    tables = [
        block for block in chapters(torsion.run(torsion.parse(TRAIN))) if isinstance(block, Table)
    ]
    shares = next(one for one in tables if "Shares of the kinetic" in one.caption)
    assert shares.columns[number].title == f"Mode {number}"


def test_barred_ranges_stand_once_in_rising_order() -> None:
    ranges = [
        BarredRange(lower, upper, 0.0, "tail")
        for lower, upper in ((20.0, 30.0), (10.0, 25.0), (10.0, 15.0))
    ]
    line = Check("r", "c", "tail", "x", 1.0, 1.0, "", "pass", "setting", barred=tuple(ranges))
    found = torsion.run(torsion.parse(TRAIN)).having(checks=Checks((line, line)))
    assert [(one.lower, one.upper) for one in barred(found)] == [
        (10.0, 15.0),
        (10.0, 25.0),
        (20.0, 30.0),
    ]
