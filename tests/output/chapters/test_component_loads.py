"""Stress of the shafts, torque in the meshes and heat of the couplings, of torques over five speeds written by hand."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.output.drawn import bands, levels, plot, unit

import torsion
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.analyses.response.component_loads import component_loads as component_loads_of
from torsion.analyses.steady import Steady
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table
from torsion.output.chapters.response import component_loads
from torsion.output.numbers import number
from torsion.output.stored.scene import NO_VALUE
from torsion.rules.class_rules.m68 import judging
from torsion.rules.class_rules.shaft_limits import limits_of
from torsion.rules.verdict_line import BarredRange, Check, Checks

RPM = 30.0 / math.pi
SPEED = np.array([10.0, 20.0, 30.0, 40.0, 50.0])  # rad/s; rated are 45
RISE = np.array([0.2, 0.4, 0.5, 0.9, 1.0])
TRAIN = """
name: all that bears loads
operation: {at: m, speeds: {from: 10 rad/s, to: 50 rad/s, steps: 5}, rated: {speed: 45 rad/s, power: 5 kW}}
materials: {alloy: {shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa}}
train:
- motor: {name: m, inertia: 1, ripple: [{order: 2, torque: 2 %}]}
- coupling: {name: bare, stiffness: 20 kN*m/rad}
- coupling: {name: soft, stiffness: 20 kN*m/rad, loss_factor: 0.3}
- disc: {name: d, inertia: 0.4}
- coupling:
    {name: limited, stiffness: 3e4, rated_torque: 345, vibratory_torque: 67, max_torque: 890, heat_limit: 12 W}
- shaft: {name: mid, length: 0.8 m, diameter: 60 mm, segments: 2, role: intermediate, material: alloy}
- gear: {name: stage, ratio: 5/2, inertia: [0.05, 0.2], branches: [{ratio: 3, inertia: 0.1}]}
- shaft: {name: plain, length: 0.5 m, diameter: 50 mm, segments: 2, material: alloy}
- propeller: {name: screw, inertia: 3, blades: 4, excitation: [{blade_order: 1, torque: 6 %}]}
"""
M68 = "rules: [iacs-m68]\n"


def spans(findings: Findings, name: str) -> list[int]:
    return [
        k for k, span in enumerate(findings.system.spans) if span.name.partition(" [")[0] == name
    ]


def written(
    text: str,
    half: Mapping[str, Any],
    mean: Mapping[str, Any] | None = None,
    bad: Sequence[int] = (),
) -> Findings:
    """The train with half ranges (N m) at five speeds by names of spans, each segment of a shaft with a tenth more."""
    found = torsion.run(torsion.parse(text))
    response, number_of = found.need(Response), len(found.system.spans)
    size, steady = np.zeros((5, number_of)), np.zeros((5, number_of))
    for name, values in half.items():
        for more, k in enumerate(spans(found, name)):
            size[:, k] = np.multiply(values, 1.0 + 0.1 * more)
    for name, values in (mean or {}).items():
        steady[:, spans(found, name)] = np.reshape(values, (5, 1))
    lines = response.lines[:1]
    status = np.full((5, 1), Status.OK)
    status[list(bad)] = Status.SINGULAR
    response = replace(
        response,
        speed=SPEED,
        requested=np.ones(5, dtype=bool),
        lines=lines,
        mean=steady,
        frequency=np.full((5, 1), 3.0),
        angle=np.ones((5, 1, len(found.system.stations))),
        torque=size[:, None, :] * (0.6 + 0.8j),
        status=status,
    )
    return with_loads(
        found,
        response=response,
        synthesis=Synthesis(size, 1.7 * size, 0.3 * size, 2 * size, found.need(Synthesis).turns),
        mean=replace(found.need(Steady), speed=SPEED, torque=-steady.T)
        if mean is not None
        else None,
    )


def with_loads(findings: Findings, **changed: Any) -> Findings:
    """Other results, and the loads that follow from them."""
    found = findings.having(**changed)
    return found.having(component_loads=component_loads_of(found))


def table(blocks: Iterable[Block]) -> Table:
    return next(block for block in blocks if isinstance(block, Table))


def figures(blocks: Iterable[Block]) -> dict[str, Figure]:
    return {block.caption: block for block in blocks if isinstance(block, Figure)}


def texts(blocks: Iterable[Block]) -> list[str]:
    return [block.text for block in blocks if isinstance(block, Paragraph)]


def modulus(diameter: float) -> float:
    return math.pi / 16.0 * diameter**3


SHAFTS = {"mid": 2000 * RISE, "plain": 900 * RISE[::-1]}
STRESS = {
    "mid": 2.2e-3 * RISE / modulus(0.06),
    "plain": 0.99e-3 * RISE[::-1] / modulus(0.05),
}  # N/mm2


def test_stress_of_shafts_is_torque_over_the_modulus_of_their_section() -> None:
    blocks = list(component_loads.shafts(written(TRAIN, SHAFTS)))
    made = table(blocks)
    assert made.rows == (
        ("mid", "intermediate", number(STRESS["mid"][4]), "477.46"),
        ("plain", "–", number(STRESS["plain"][0]), "95.493"),
    )
    assert "M68" not in texts(blocks)[0]
    assert isinstance(blocks[0], Heading)
    drawn = figures(blocks)
    for name, position in (("mid", 5), ("plain", 7)):
        figure = drawn[f"Vibratory shear stress of {name}"]
        assert figure.name == f"stress-{position}"
        line = figure.lines["total stress"]
        np.testing.assert_allclose(line.y, STRESS[name], rtol=1e-13)
        np.testing.assert_allclose(line.x, SPEED * RPM, rtol=1e-13)
        (order,) = (
            one for one in figure.lines.values() if one.name.startswith("order")
        )  # the only one, of that size
        np.testing.assert_allclose(order.y, STRESS[name], rtol=1e-13)
        assert levels(figure) == {"rated speed": [pytest.approx(45.0 * RPM)]}
        assert plot(figure).bands == ()
        assert not any("limit" in name for name in figure.lines)


def test_limits_of_the_rule_stand_beside_the_stress_where_they_hold() -> None:
    """tau_C up to 1.05 of the rated speed, tau_T up to 0.8; a shaft without a role has neither."""
    found = written(TRAIN + M68, SHAFTS)
    own = BarredRange(11.0, 13.0, 12.0, "mid"), BarredRange(21.0, 24.0, 22.0, "other")
    line = Check("iacs-m68", "c", "mid", "stress", 1.0, 2.0, "N/mm2", "pass", "setting", barred=own)
    blocks = list(component_loads.shafts(found.having(checks=Checks((line,)))))
    _, continuous, transient, stress = limits_of(found, judging(found, "mid")[1])
    np.testing.assert_allclose(stress, STRESS["mid"], rtol=1e-13)
    assert table(blocks).rows[0] == ("mid", "intermediate", number(stress[4]), "477.46")
    assert "IACS UR M68" in texts(blocks)[0]
    drawn = figures(blocks)["Vibratory shear stress of mid"]
    np.testing.assert_array_equal(drawn.lines["limit τ_{C}, continuous"].y, continuous)
    np.testing.assert_array_equal(drawn.lines["limit τ_{T}, passing rapidly"].y, transient)
    assert bands(drawn, "barred") == [pytest.approx((11.0 * RPM, 13.0 * RPM))]
    unknown = table(component_loads.shafts(written(TRAIN + M68, SHAFTS, bad=[1]))).rows
    assert {row[2:4] for row in unknown} == {(NO_VALUE, "–")}


def test_three_shafts_have_a_figure() -> None:
    """The three with the highest stress, in the order of the train."""
    shafts = "".join(
        f"- shaft: {{name: part {k:02}, length: 0.5 m, diameter: 50 mm, segments: 1, material: alloy}}\n"
        for k in range(13)
    )
    head, tail = TRAIN[: TRAIN.index("- coupling")], TRAIN[TRAIN.index("- propeller") :]
    half = {f"part {k:02}": (20.0 + (5 * k) % 13) * RISE for k in range(13)}
    blocks = list(component_loads.shafts(written(head + shafts + tail, half)))
    highest = sorted(sorted(half, key=lambda name: -half[name].max())[:3])
    assert [
        caption.removeprefix("Vibratory shear stress of ") for caption in figures(blocks)
    ] == highest
    assert texts(blocks)[-1].endswith(
        "The figures show the 3 shafts with the highest stress of 13 shafts."
    )
    assert "figures" not in texts(list(component_loads.shafts(written(TRAIN, SHAFTS))))[0]


MESHES = {
    "stage": [1100.0, 2000.0, 3000.0, 2000.0, 500.0],
    "stage wheel 2": [30.0, 0.0, 20.0, 50.0, 40.0],
}
MEANS = {
    "stage": [2000.0, -1000.0, 2000.0, 1900.0, 1000.0],
    "stage wheel 2": [-10.0, 0.0, 10.0, 0.0, 5.0],
}


def test_torque_in_the_meshes_against_the_mean_torque() -> None:
    blocks = list(component_loads.gears(written(TRAIN, MESHES, MEANS)))
    made = table(blocks)
    names = [row[0] for row in made.rows]
    assert made.rows == (
        (
            names[0],
            "3.0000",
            "286.48",
            "2.0000",
            "2.000",
            "190.99",
            "yes",
            "190.99",
            "381.97",
        ),
        (names[1], "0.050000", "381.97", "0", "∞", "–", "yes", "95.493", "477.46"),
    )
    assert names[0] == "stage"
    assert made.marks == ("fail", "fail")
    units = ["", "kN m", "rpm", "kN m", "", "rpm", "", "rpm", "rpm"]
    assert [column.unit for column in made.columns] == units
    assert texts(blocks) == []


@pytest.mark.parametrize(
    ("values", "mean", "cells", "mark"),
    [
        ([5.0, 4.0, 6.0, 9.0, 2.0], [10.0] * 5, ("0.9000", "381.97", "no"), ""),
        ([5.0, 4.0, 6.0, 9.0, 2.0], [9.0] * 5, ("1.000", "381.97", "no"), ""),
        (
            [5.0, 4.0, 6.0, 9.0, 2.0],
            [1.0] * 5,
            ("9.000", "381.97", "yes, everywhere", "95.493", "477.46"),
            "fail",
        ),
        ([0.0] * 5, [0.0] * 5, ("0", "95.493", "no"), ""),
        (
            [5.0, 4.0, 6.0, 9.0, 2.0],
            [10.0, 10.0, 5.0, 10.0, 10.0],
            ("1.200", "286.48", "yes", "286.48", "286.48"),
            "fail",
        ),
    ],
)
def test_where_the_tooth_load_reverses(values: list, mean: list, cells: tuple, mark: str) -> None:
    made = table(component_loads.gears(written(TRAIN, {"stage": values}, {"stage": mean})))
    assert made.rows[0][4:] == cells
    assert made.marks[0] == mark


def test_mesh_without_a_mean_torque_or_without_a_value() -> None:
    blocks = list(component_loads.gears(written(TRAIN, MESHES)))
    assert [row[3:] for row in table(blocks).rows] == [("not known",)] * 2
    assert texts(blocks)[0].startswith("The input has no mean torque.")
    assert not any("mean torque" in figure.lines for figure in figures(blocks).values())
    blocks = list(component_loads.gears(written(TRAIN, MESHES, MEANS, bad=[4])))
    assert {row[1:] for row in table(blocks).rows} == {(NO_VALUE, "–", "not known")}


def test_curves_of_a_mesh_have_the_limit_of_its_check() -> None:
    found = written(TRAIN, {"stage": 800 * RISE}, {"stage": 3000 * RISE})
    lines = [
        Check(
            rule,
            "c",
            where,
            "w",
            1.0,
            limit,
            unit,
            "pass",
            "setting",
            barred=(BarredRange(11.0, 13.0, 12.0, "x"),),
        )
        for rule, where, limit, unit in (
            ("gear-hammer", "stage wheel 2", 1.0, "N m"),
            ("coupling-maker", "stage", 2.0, "N m"),
            ("gear-hammer", "stage", 3.0, "rad"),
            ("gear-hammer", "stage", math.nan, "N m"),
            ("gear-hammer", "stage", 1234.0, "N m"),
        )
    ]
    drawn = figures(component_loads.gears(found.having(checks=Checks(tuple(lines)))))[
        "Vibratory and mean torque in stage"
    ]
    stage = spans(found, "stage")[0]
    assert drawn.name == f"gear-{found.system.spans[stage].part}-{stage}"
    assert unit(drawn) == "kN m"
    np.testing.assert_allclose(drawn.lines["total vibratory torque"].y, 0.8 * RISE)
    np.testing.assert_allclose(drawn.lines["mean torque"].y, 3.0 * RISE)
    np.testing.assert_allclose(drawn.lines["mean torque"].x, SPEED * RPM)
    assert bands(drawn, "barred") == [pytest.approx((11.0 * RPM, 13.0 * RPM))]
    assert levels(drawn) == {
        "limit of the vibratory torque": [pytest.approx(1.234)],
        "rated speed": [pytest.approx(45.0 * RPM)],
    }
    bare = figures(component_loads.gears(found.having(checks=Checks(()))))[
        "Vibratory and mean torque in stage"
    ]
    assert list(levels(bare)) == ["rated speed"]


def test_torque_and_heat_of_couplings() -> None:
    """Of those that damp or have limits; heat eta k omega |T|^2 / (2 k^2 (1 + eta^2))."""
    half = {"bare": 5.0 * RISE, "soft": 1800 * RISE[::-1], "limited": 600 * RISE}
    mean = {"soft": [1000.0, 2000.0, 3000.0, 2500.0, 1500.0], "limited": [111.0] * 5}
    found = written(TRAIN, half, mean)
    heat = 2 * math.pi * 3.0 * 0.3 * 1800.0**2 / (2 * 20e3 * (1 + 0.3**2))
    blocks = list(component_loads.couplings(found))
    assert table(blocks).rows == (
        (
            "soft",
            "1800.0",
            "95.493",
            "–",
            "3000.0",
            "–",
            "3060.0",
            "–",
            number(heat),
            "95.493",
            "–",
        ),
        (
            "limited",
            "600.00",
            "477.46",
            "67.000",
            "111.00",
            "345.00",
            "1020.0",
            "890.00",
            "0",
            "95.493",
            "12.000",
        ),
    )
    assert isinstance(blocks[0], Heading)
    alone = table(component_loads.couplings(with_loads(found, mean=None))).rows
    assert [len(row) for row in alone] == [10, 10]
    rows = table(
        component_loads.couplings(written(TRAIN, {"soft": 800 * RISE}, mean={}, bad=[2]))
    ).rows
    assert [(row[1], row[2], row[6], row[8], row[9]) for row in rows] == [
        (NO_VALUE, "–", NO_VALUE, NO_VALUE, "–")
    ] * 2


def test_the_bound_of_a_shaft_is_that_of_its_segment_with_the_largest_torque_at_that_speed() -> (
    None
):
    """The first segment leads at the lowest speed, the second at the highest, where the total is largest."""
    found = written(TRAIN, {"mid": 100.0 * RISE}, {"mid": 50.0 * np.ones(5)})
    first, second = spans(found, "mid")
    half = found.need(Synthesis).half_range.copy()
    half[0, [first, second]] = 90.0, 20.0
    total = replace(found.need(Synthesis), half_range=half)
    loads = with_loads(found, synthesis=total).need(ComponentLoads)
    (mid,) = (load for load in loads.elements if load.component == "mid")
    assert (mid.torque, mid.speed) == (pytest.approx(110.0), 50.0)
    assert (mid.rms, mid.bound) == (pytest.approx(0.3 * 110.0), pytest.approx(2.0 * 110.0))


@pytest.mark.parametrize(("share", "is_moving"), [(0.5, False), (2.0, True)])
def test_an_angle_below_the_rounding_of_the_largest_at_one_speed_is_none(
    share: float, is_moving: bool
) -> None:
    """The screw turns at 2/5 of the motor's speed: 0.4e-12 of the motor's angle may be rounding there."""
    found = written(TRAIN, {"mid": 100.0 * RISE}, {"mid": 50.0 * np.ones(5)})
    names = [station.name for station in found.study.train.stations]
    angle = np.zeros((5, 1, len(found.system.stations)))
    angle[:, 0, names.index("m")] = 1.0
    angle[:, 0, names.index("screw")] = share * 1e-12 * 2.0 / 5.0
    loads = with_loads(found, response=replace(found.need(Response), angle=angle))
    (screw,) = (load for load in loads.need(ComponentLoads).stations if load.station == "screw")
    assert (screw.angle > 0.0) == is_moving


def test_a_joint_behind_a_gear_is_loaded_at_twice_the_speed_of_its_own_shaft() -> None:
    """At half the speed of the motor its order is 1 of the motor's, and its torque that of the only line there is."""
    text = """
name: x
operation: {speeds: {from: 10 rad/s, to: 20 rad/s, steps: 2}}
train:
- motor: {inertia: 1}
- coupling: {stiffness: 1e4, viscous: 9}
- gear: {teeth: [20, 40]}
- joint: {name: cross, angle: 10 deg, inertia: [0.1, 0.1]}
- disc: {inertia: 2}
analyses: {response: }
"""
    found = torsion.run(torsion.parse(text))
    (load,) = found.need(ComponentLoads).joints
    response = found.need(Response)
    assert (load.joint, load.order, load.speed) == ("cross", 1, 20.0)
    assert load.torque == pytest.approx(np.abs(response.torque[:, 0, spans(found, "cross")]).max())


def test_nothing_without_a_response_or_without_such_components() -> None:
    text = TRAIN[TRAIN.index("materials") :].replace(", ripple: [{order: 2, torque: 2 %}]", "")
    still = torsion.run(
        torsion.parse(
            "name: x\n" + text.replace(", excitation: [{blade_order: 1, torque: 6 %}]", "")
        )
    )
    plain = torsion.run(
        torsion.parse("""
name: x
operation: {speeds: {from: 5 rad/s, to: 15 rad/s, steps: 3}}
train: [disc: {inertia: 2}, coupling: {stiffness: 500}, disc: {name: far, inertia: 3}]
excitations: [{at: far, order: 1, torque: 1}]
""")
    )
    for chapter in (component_loads.shafts, component_loads.gears, component_loads.couplings):
        assert list(chapter(still)) == list(chapter(plain)) == []
