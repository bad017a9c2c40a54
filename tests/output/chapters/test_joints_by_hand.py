"""Every cell, curve and word of the chapter on joints, of joints whose results are written here by hand."""

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from tests.output.drawn import named, plot, titles

import torsion
from torsion.analyses.joints.joint_lines import (
    CoupleFound,
    Extreme,
    JointFound,
    Joints,
    LineFound,
    OptimumFound,
)
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import component_loads
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Points, Table
from torsion.output.chapters import joint_motion
from torsion.output.chapters.joint_motion import alone, chapter, summary
from torsion.output.numbers import NONE, number
from torsion.rules.verdict_line import Checks

DEG, RPM = math.pi / 180.0, 30.0 / math.pi
ANGLE = np.radians([0.0, 100.0, 250.0, 360.0])
WAVE = np.array([1.0, -0.5, 0.25, 2.0])
ROUNDING = 1e-12  # rad: an amplitude or an index up to it is none


def couple(shaft: str, **changed: object) -> CoupleFound:
    made = CoupleFound(
        shaft, 300 * WAVE, 400 * WAVE, None, (3000.0, 4000.0), (600 + 800j, 1500j), 2, 7654.0
    )
    return replace(made, **changed)


def joint(name: str, **changed: object) -> JointFound:
    made = JointFound(
        name,
        0,
        "cross",
        20 * DEG,
        7 * DEG,
        30 * DEG,
        400 * DEG,
        Fraction(5, 2),
        2,
        cmath.rect(0.03, 50 * DEG),
        0.1246,
        30.0,
        5000.0,
        0.02 * WAVE,
        1 + 0.1 * WAVE,
        0.17 * WAVE,
        1 - 0.1 * WAVE,
        (),
        0.1734,
    )
    return replace(made, **changed)


def line(*joints: int, **changed: object) -> LineFound:
    made = LineFound(
        joints,
        25 * DEG,
        35 * DEG,
        24 * DEG,
        0.2345,
        Extreme(1.1234567, 40 * DEG),
        Extreme(0.8765432, 130 * DEG),
    )
    return replace(made, **changed)


def optimum(**changed: object) -> OptimumFound:
    over = np.radians([-170.0, 0.0, 45.0, 190.0])
    made = OptimumFound(
        "phase",
        ("outer",),
        (30 * DEG,),
        (300 * DEG,),
        0.25,
        0.05,
        (0.0625,),
        over,
        np.array([0.4, 0.2, 0.3, 0.1]),
    )
    return replace(made, **changed)


FIRST = joint(
    "inner", couples=(couple("driving", bearing=4321.0), couple("driven", order=0, yoke=500 * WAVE))
)
TRIPOD = joint(
    "pot",
    kind="tripod",
    angle=10 * DEG,
    plane=11 * DEG,
    phase=-50 * DEG,
    yoke=-200 * DEG,
    order=3,
    ratio=Fraction(1),
    amplitude=1e-3 + 0j,
    unevenness=1e-13,
    speed=None,
    torque=40.0,
    force=77.0,
    couples=(couple("driving", order=3),),
)
STRAIGHT = joint("straight", angle=0.0, amplitude=0j, steepest=1e-13, speed=10.0)
EVEN = joint("cv", kind="cv", order=0, amplitude=0j)
JOINTS = Joints(
    ANGLE,
    (FIRST, STRAIGHT, TRIPOD, EVEN),
    (line(0, 1), line(2, 3, index=1e-13, resultant=1e-7, optimum=optimum())),
    ("said",),
)


def together(joints: tuple[JointFound, ...], lines: tuple[LineFound, ...] = ()) -> Joints:
    return Joints(ANGLE, joints, lines, ())


def rows(made: Table) -> list[tuple[str, ...]]:
    return list(made.rows)


def blocks(bare: Findings, joints: Joints) -> list[Block]:
    return list(alone(bare.having(joints=joints)))


def figures(found: Sequence[Block]) -> dict[str, Figure]:
    return {block.name: block for block in found if isinstance(block, Figure)}


def table_called(bare: Findings, joints: Joints, caption: str) -> list[Table]:
    tables = (block for block in blocks(bare, joints) if isinstance(block, Table))
    return [made for made in tables if made.caption.startswith(caption)]


def test_geometry_and_each_joint_alone(bare: Findings) -> None:
    degrees, small = 0.03 / DEG, 1e-3 / DEG
    (made,) = table_called(bare, JOINTS, "Single joints")
    assert rows(made) == [
        ("inner", "cross", "20", "7", "30", "40", "5", f"{degrees:.4f}", "50", "12.460"),
        ("straight", "cross", "0", "7", "30", "40", "5", "0", NONE, "12.460"),
        ("pot", "tripod", "10", "11", "−50", "160", "3", f"{small:.6f}", "0", "0"),
        ("cv", "cv", "20", "7", "30", "40", NONE, "0", NONE, "12.460"),
    ]


def test_lines_of_joints_as_one() -> None:
    assert rows(joint_motion.lines(JOINTS)) == [
        (
            "inner, straight",
            "25.000",
            "24.000",
            "35",
            "1.123457",
            "40",
            "0.8765432",
            "130",
            "23.450",
        ),
        ("pot, cv", "0", "24.000", NONE, "1.123457", NONE, "0.8765432", NONE, "0"),
    ]
    one = together((FIRST,), (line(0, index=ROUNDING, resultant=1e-6, classical=1.0000001e-6),))
    assert rows(joint_motion.lines(one))[0][1:4] == ("0", "5.7296·10⁻⁵", NONE)


def test_motion_at_speed(bare: Findings) -> None:
    (made,) = table_called(bare, JOINTS, "Speed and acceleration")
    assert rows(made) == [
        (
            "inner",
            "286.479",
            f"{300 * RPM * 0.12:.3f}",
            f"{30 * RPM * 0.95:.3f}",
            f"{900 * 0.1734:.2f}",
            f"{30 * RPM * 20:.1f}",
        ),
        ("straight", "95.493", f"{10 * RPM * 1.2:.3f}", f"{10 * RPM * 0.95:.4f}", "0", "0"),
        (
            "cv",
            "286.479",
            f"{300 * RPM * 0.12:.3f}",
            f"{30 * RPM * 0.95:.3f}",
            f"{900 * 0.1734:.2f}",
            f"{30 * RPM * 20:.1f}",
        ),
    ]
    assert table_called(bare, together((TRIPOD,), (line(0),)), "Speed and acceleration") == []
    (made,) = table_called(
        bare, together((joint("a", steepest=ROUNDING),), (line(0),)), "Speed and acceleration"
    )
    assert rows(made)[0][4] == "0"


def test_couples_in_kilonewton_metres_with_bearings_and_force() -> None:
    made = joint_motion.couples(JOINTS)
    assert rows(made) == [
        ("inner", "driving", "5.0000", "5.0000", "2", "1.0000", "1.5000", "7.6540", "4321.0", NONE),
        ("inner", "driven", "5.0000", "5.0000", NONE, "1.0000", "1.5000", "7.6540", NONE, NONE),
        ("pot", "driving", "0.040000", "5.0000", "3", "1.0000", "1.5000", "7.6540", NONE, "77.000"),
    ]
    assert [(column.title, column.unit) for column in made.columns][-6:] == [
        ("Order", ""),
        ("Amplitude, normal", "kN m"),
        ("Amplitude, in plane", "kN m"),
        ("Maximum", "kN m"),
        ("Bearings", "N"),
        ("Force across", "N"),
    ]
    assert made.columns[2].unit == "kN m"
    assert made.short == "Secondary couples, kN m"


def test_couples_without_bearings_and_force() -> None:
    """Torques of less than 1 kN m beside couples of more; neither column of newtons."""
    small = joint("a", torque=-900.0, couples=(couple("driven"),))
    made = joint_motion.couples(together((small, EVEN)))
    assert rows(made) == [("a", "driven", "−900.00", "5000.0", "2", "1000.0", "1500.0", "7654.0")]
    assert [made.columns[2].unit, made.columns[3].unit] == ["N m", "N m"]


@pytest.mark.parametrize(
    ("changed", "cells", "gain"),
    [
        ({}, ("30", "300", "6.2500"), "decreases from 25.000 % to 5.0000 %, by 80 %."),
        (
            {"index_before": 0.3, "index_best": 0.1},
            ("30", "300", "6.2500"),
            "decreases from 30.000 % to 10.000 %, by 66.67 %.",
        ),
        (
            {"best": (-20 * DEG,), "index_best": 1e-13},
            ("30", "−20", "6.2500"),
            "from 25.000 % to 0 %, by 100 %.",
        ),
        (
            {"best": (1e-13,), "sensitivity": (ROUNDING,), "index_before": ROUNDING},
            ("30", "0", "0"),
            "The line already rotates uniformly",
        ),
    ],
)
def test_the_best_choice_and_its_gain(changed: dict, cells: tuple[str, ...], gain: str) -> None:
    found = line(2, 3, optimum=optimum(**changed))
    made, said = joint_motion.optimum(JOINTS, found)
    assert isinstance(made, Table)
    assert isinstance(said, Paragraph)
    assert rows(made) == [("outer", *cells)]
    assert (made.caption, made.short) == (
        "Optimum phase of pot, cv",
        "Optimum phase of pot, cv, deg",
    )
    assert gain in said.text
    assert said.brief
    assert f"Optimum phase: outer {cells[1]} deg." in list(joint_motion.in_short(JOINTS, found))[1]


def test_a_choice_for_other_joints_than_are_named_is_refused() -> None:
    mixed = line(2, 3, optimum=optimum(names=("outer", "inner")))
    for reads in (joint_motion.optimum, joint_motion.in_short):
        with pytest.raises((ValueError, IndexError), match=r"shorter|out of bounds"):
            list(reads(JOINTS, mixed))


def test_a_line_in_words() -> None:
    def said(**changed: object) -> str:
        (sentence,) = joint_motion.in_short(JOINTS, line(0, 1, **changed))
        return sentence

    uneven = "The line of inner, straight rotates its last shaft with a degree of non-uniformity of"
    assert said() == f"{uneven} 23.450 %; its cross joints act as one joint of 25.000 deg."
    assert said(resultant=1e-7) == f"{uneven} 23.450 %."
    assert (
        said(resultant=1e-5)
        == f"{uneven} 23.450 %; its cross joints act as one joint of 0.00057296 deg."
    )
    assert said(index=1e-13) == "The line of inner, straight rotates its last shaft uniformly."
    assert said(index=ROUNDING) == "The line of inner, straight rotates its last shaft uniformly."


def test_curves_over_the_angle_as_columns(bare: Findings) -> None:
    known = dict(joint_motion.columns(bare.having(joints=JOINTS)))
    wanted = {
        "angle of first shaft [deg]": [0.0, 100.0, 250.0, 360.0],
        "inner error [deg]": 0.02 * WAVE / DEG,
        "inner speed ratio [1]": 1 + 0.1 * WAVE,
        "inner speed [rpm]": (1 + 0.1 * WAVE) * 30 * RPM,
        "inner acceleration [rad/s²]": 0.17 * WAVE * 900,
        "inner torque ratio [1]": 1 - 0.1 * WAVE,
        "inner couple on driving shaft about normal [N m]": 300 * WAVE,
        "inner couple on driven shaft in plane [N m]": 400 * WAVE,
        "inner couple on driven shaft in turning yoke [N m]": 500 * WAVE,
        "pot acceleration / speed² [1/rad]": 0.17 * WAVE,
    }
    for title, values in wanted.items():
        np.testing.assert_allclose(known[title], values, rtol=1e-14, err_msg=title)
    assert "pot speed [rpm]" not in known
    assert "inner couple on driving shaft in turning yoke [N m]" not in known


def test_blocks_of_the_chapter_in_their_order(bare: Findings) -> None:
    """On the terminal of a whole report the lines alone, of the joints alone every table; paragraphs on neither."""
    made = blocks(bare, JOINTS)
    heads = [(block.text, block.level) for block in made if isinstance(block, Heading)]
    assert heads == [
        ("Universal joints", 1),
        ("Joints together", 2),
        ("Secondary couples", 2),
        ("Optimum angles", 2),
        ("Not computed for the joints", 2),
    ]
    assert list(figures(made)) == [
        "joint-motion-1",
        "joint-motion-2",
        "joint-couples-1",
        "joint-couples-3",
    ]
    assert made[-1] == Points(("said",), brief=True)
    assert all(block.short for block in made if isinstance(block, Table))
    whole = list(chapter(bare.having(joints=JOINTS)))
    shown = [block.short for block in whole if isinstance(block, Table) and block.short]
    assert shown == [joint_motion.LINES]
    assert not any(block.brief for block in whole if isinstance(block, Paragraph | Points))
    assert [type(block) for block in whole] == [type(block) for block in made]


def test_what_is_not_known_has_no_heading(bare: Findings) -> None:
    made = blocks(bare, together((TRIPOD, replace(STRAIGHT, couples=())), (line(0, 1),)))
    assert "Secondary couples" in [block.text for block in made if isinstance(block, Heading)]
    made = blocks(bare, together((STRAIGHT,), (line(0),)))
    assert [block.text for block in made if isinstance(block, Heading)] == [
        "Universal joints",
        "Joints together",
    ]
    assert blocks(bare, together(())) == []
    still = joint("a", couples=(couple("driving", order=0), couple("driven", order=0)))
    assert "joint-couples-1" not in figures(blocks(bare, together((still,), (line(0),))))


def test_motion_with_and_without_a_speed(bare: Findings) -> None:
    made = figures(blocks(bare, JOINTS))
    moving, still = (made[f"joint-motion-{k}"] for k in (1, 2))
    line = moving.lines["downstream of inner"]
    np.testing.assert_allclose(line.x, [0.0, 100.0, 250.0, 360.0], rtol=1e-14)
    curves = (0.02 * WAVE / DEG, 1 + 0.1 * WAVE, 0.17 * WAVE, 1 - 0.1 * WAVE)
    axes = ["angle error, deg", "speed ratio", "acceleration / speed², 1/rad"]
    for figure in (moving, still):
        assert titles(figure) == [*axes, "torque downstream / upstream"]
        for values, panel in zip(curves, figure.plots, strict=True):
            for drawn in panel.lines:
                np.testing.assert_allclose(drawn.y, values, rtol=1e-14)
    assert [line.name for line in moving.plots[0].lines] == [
        "downstream of inner",
        "downstream of straight",
    ]
    assert plot(moving).x.title == "angle of the shaft upstream of inner, deg"
    assert (
        still.caption
        == "Motion downstream of pot, cv over the angle of the first shaft, which rotates uniformly"
    )


def test_couples_are_drawn_over_the_first_shaft_of_their_line(bare: Findings) -> None:
    made = figures(blocks(bare, JOINTS))
    inner, pot = (made[f"joint-couples-{k}"] for k in (1, 3))
    assert plot(inner).x.title == "angle of the shaft upstream of inner, deg"
    assert plot(pot).x.title == "angle of the shaft upstream of pot, deg"
    assert titles(inner) == ["on the driving shaft, kN m", "on the driven shaft, kN m"]
    driving, driven = inner.plots
    sizes = {
        "about the normal": 0.3,
        "in the plane": 0.4,
        "resultant": 0.5,
        "in the turning yoke": 0.5,
    }
    for name, line in named(driven).items():
        wanted = sizes[name] * (np.abs(WAVE) if name == "resultant" else WAVE)
        np.testing.assert_allclose(line.y, wanted, rtol=1e-14)
    assert list(named(driving)) == list(sizes)[:3]


def test_the_summary_has_the_verdict_where_a_rule_judges(bare: Findings, train: Findings) -> None:
    head, said = summary(bare.having(joints=JOINTS, checks=Checks(())))
    assert head == Heading("Summary")
    assert isinstance(said, Points)
    assert [sentence.split(" rotates")[0] for sentence in said.items[:2]] == [
        "The line of inner, straight",
        "The line of pot, cv",
    ]
    assert said.items[2].startswith("Optimum phase")
    judged = list(summary(train.having(joints=JOINTS)))
    assert train.need(Checks).lines
    assert any(isinstance(block, Paragraph) and block.kind != "plain" for block in judged)


GEARED = """
name: a joint behind a gear
operation: {speeds: {from: 10 rad/s, to: 40 rad/s, steps: 13}, rated: {speed: 30 rad/s, power: 2 kW}}
train:
- motor: {name: m, inertia: 1}
- gear: {name: g, ratio: 2/5, inertia: [0.1, 0.1], mesh_stiffness: 1e6}
- coupling: {name: tube, stiffness: 5 kN*m/rad, loss_factor: 0.1}
- disc: {name: sleeve, inertia: 0.3}
- joint: {name: hooke, angle: 30 deg, inertia: [0.02, 0.02]}
- coupling: {name: c, stiffness: 3 kN*m/rad, loss_factor: 0.2}
- disc: {name: flange, inertia: 0.2}
- coupling: {name: d, stiffness: 6 kN*m/rad, loss_factor: 0.1}
- propeller: {name: screw, inertia: 2, blades: 3, excitation: [{blade_order: 1, torque: 5 %}]}
analyses: {response: {method: first-order}, joints: {steps: 36}}
"""


def test_response_to_the_order_of_a_joint() -> None:
    """Its torque is that of its own span and of order 2 of its shaft, with the error of the model there."""
    found = torsion.run(torsion.parse(GEARED))
    response = found.need(Response)
    place = [one.order for one in response.lines].index(Fraction(5))
    span = [one.name for one in found.system.spans].index("hooke")
    size = np.abs(response.torque[:, place, span])
    at = int(size.argmax())
    error = np.full_like(response.joint_error, 0.5)
    error[at, place] = 0.0951
    found = found.having(response=replace(response, joint_error=error))
    found = found.having(component_loads=component_loads(found))
    made = next(
        block
        for block in chapter(found)
        if isinstance(block, Table) and "the order of each joint" in block.caption
    )
    assert len(response.lines) > 1
    assert made.rows == (
        (
            "hooke",
            "5",
            number(size[at]),
            number(response.speed[at] * RPM),
            "9.5",
        ),
    )
    heads = [block.text for block in chapter(found) if isinstance(block, Heading)]
    assert heads[-1] == "Excitation of the train"
    assert [block.level for block in chapter(found) if isinstance(block, Heading)][-1] == 2


@pytest.mark.parametrize("changed", [{"order": 0}, {"amplitude": 0j}])
def test_a_joint_that_does_not_excite_has_no_response(changed: dict) -> None:
    found = torsion.run(torsion.parse(GEARED))
    (own,) = found.need(Joints).joints
    quiet = found.having(joints=replace(found.need(Joints), joints=(replace(own, **changed),)))
    for one in (quiet, found.having(component_loads=None)):
        assert "Excitation of the train" not in [
            block.text for block in chapter(one) if isinstance(block, Heading)
        ]
