"""The page of Liu et al. (2023): an unmanned boat's shafting with universal joints."""

from collections.abc import Iterator
from functools import cache

import numpy as np

from benchmarks.papers import liu_equations as paper
from benchmarks.papers import space
from benchmarks.papers.drawing import Panel, curves
from benchmarks.papers.scenes import joints
from benchmarks.papers.writing import Misprint, Page, Picture, apart, bound, compared, stated
from torsion.analyses.joints.joint_lines import Joints
from torsion.kernels.joints import cross, line

NAME = "liu_2023"
SPEED, TORQUE = 60.0, 800.0  # rad/s, N m
ANGLES, PHASES = (3, 5, 8), (0, 60, 120)  # degrees
TURN = np.linspace(0.0, 2.0 * np.pi, 721)
LABELS = [f"r = {angle}°" for angle in ANGLES]
UNEVEN = (
    0.6,
    30,
    120,
)  # rad, degrees, degrees: joint angle and phases at which the two readings of (10) part


@cache
def at(degrees: int) -> Joints:
    """The model file with both joints at an angle."""
    return joints(NAME, ("angle: 8 deg", f"angle: {degrees} deg"))


def page() -> Page:
    """Everything the page says."""
    return Page(
        name=NAME,
        title="Liu et al. 2023: unmanned boat shafting with universal joints",
        reference="Liu et al., *Ship Science and Technology* 45(2), 2023, from page 80.",
        what="The paper derives angle, speed and acceleration downstream of one cross joint and of two, and the "
        "couples that bend the two shafts of a joint. It then sets up six inertias and two bending supports and "
        "computes spectra of a boat's line.",
        notation="`r` joint angle, `a` driving angle, `b` driven angle, `phi` fork angles, `T1` driving torque, `M1`, "
        "`M2` couples on driving and driven shaft. N: `a` counts from the normal of the shafts' plane; P: from the "
        "plane. N and P are 90° apart.",
        numbers=tuple(_numbers()),
        checks=_checks(),
        pictures=(_speed(), _phases(), _couples()),
        misprints=(*_kinematic_misprints(), *_other_misprints()),
        missing=(
            (
                "Figures 6 and 7 point by point: the given data determine their curves, but the values plotted in the "
                "paper are not available to compare with, and which curve it shows in which of the two is our reading."
            ),
            (
                "Table 1 and the data behind figures 9 and 10 (inertias, stiffnesses, supports) are missing: the lines "
                "at 616.7 and 449.67 Hz cannot be computed."
            ),
            "(14) as printed cannot be integrated, see the table.",
        ),
    )


def _numbers() -> Iterator[tuple[str, ...]]:
    yield stated("driving speed, printed as 3600 rad/min", SPEED, "rad/s", "60 rad/s")
    least, greatest = cross.transfer(np.array([0.0, np.pi / 2.0]), np.radians(8.0), "N").ratio
    yield compared(
        "fig. 4, r = 8°: largest less mean speed", "0.6", SPEED * (greatest - 1.0), "rad/s"
    )
    yield compared(
        "fig. 4, r = 8°: mean less smallest speed", "0.6", SPEED * (1.0 - least), "rad/s"
    )
    for angle in ANGLES:
        first = at(angle).joints[0]
        speeds = SPEED * first.speed_ratio
        yield stated(f"fig. 4, r = {angle}°: smallest and largest speed", _range(speeds), "rad/s")
        yield stated(
            f"fig. 4, r = {angle}°: largest acceleration", SPEED**2 * first.steepest, "rad/s²"
        )
    yield stated(
        "phases 0°, 60°, 120° of one joint, r = 8°: smallest and largest speed, all three",
        _of_phases(),
        "rad/s",
    )
    yield stated(
        "phi2 − phi1 = 90°, r = 8°: index of fluctuation",
        f"{_index(90):.0e} or less",
        "",
        "0 (constant)",
    )
    yield stated(
        "phi2 − phi1 = 0°, r = 8°: index of fluctuation (the worst)", _index(0), "", "not said"
    )
    for angle in ANGLES:
        driving, driven = at(angle).joints[0].couples
        carried = TORQUE * at(angle).joints[0].torque_ratio
        size = f"{np.abs(driving.yoke).max():.9f}, {np.abs(driven.yoke).max():.9f}"
        yield stated(f"fig. 7, r = {angle}°: largest M1, M2", size, "N m")
        yield stated(f"fig. 7, r = {angle}°: smallest and largest T2", _range(carried), "N m")


def _range(values: np.ndarray) -> str:
    return f"{values.min():.10f} .. {values.max():.10f}"


def _of_phases() -> str:
    """The range, after making sure that it is one."""
    every = {
        _range(SPEED * cross.transfer(TURN + np.radians(phase), np.radians(8.0)).ratio)
        for phase in PHASES
    }
    if len(every) != 1:
        raise ArithmeticError(f"the phase of one joint changes its range: {every}")
    return every.pop()


def _index(apart_by: float) -> float:
    """Index of fluctuation of the two joints at 8 degrees; 1e-15 where it is below."""
    angle = np.radians(8.0)
    found = float(
        line.resultant(line.line_of([angle, angle], 0.0, [0.0, np.radians(apart_by - 90.0)])).index
    )
    return max(found, 1e-15)


def _checks() -> str:
    """How far the program stands from the joint in space."""
    angle = np.radians(8.0)
    body, ours = space.cross(TURN, angle), cross.transfer(TURN, angle, "N")
    bent = cross.couples(TURN, angle, TORQUE, convention="N")
    return (
        "Ours was compared with a joint of two pins in space, whose speeds and moments follow from three linear "
        f"equations: speed within {bound(ours.ratio, body.ratio, '1e-14')}, acceleration within "
        f"{bound(ours.curvature, body.curvature, '1e-12')}, torque within "
        f"{bound(bent.driven_torque, TORQUE * body.driven_torque, '1e-14')} and couples within "
        f"{bound(bent.driven.yoke, TORQUE * body.driven_couple, '1e-13')} of their largest value at 721 angles of a "
        "revolution. The model file gives the same numbers as the joint formulas."
    )


def _speed() -> Picture:
    first = [at(angle).joints[0] for angle in ANGLES]
    degrees = np.degrees(at(8).angle)
    speeds = [(label, SPEED * one.speed_ratio) for label, one in zip(LABELS, first, strict=True)]
    gains = [(label, SPEED**2 * one.acceleration) for label, one in zip(LABELS, first, strict=True)]
    panels = [Panel("driven speed, rad/s", speeds), Panel("acceleration, rad/s²", gains)]
    svg = curves(
        "liu_2023_fig_4", degrees, "driving angle a from the plane of the shafts, degrees", panels
    )
    return Picture(
        "liu_2023_fig_4",
        "Figure 4: speed and acceleration after one joint driven at 60 rad/s.",
        svg,
    )


def _phases() -> Picture:
    angle, degrees = np.radians(8.0), np.degrees(TURN)
    single = [
        (f"{phase}°", SPEED * cross.transfer(TURN + np.radians(phase), angle).ratio)
        for phase in PHASES
    ]
    pair = []
    for phase in PHASES:
        both = line.line_of([angle, angle], 0.0, [0.0, np.radians(phase - 90.0)])
        pair.append((f"{phase}°", SPEED * line.motion(TURN, both).ratio[-1]))
    panels = [Panel("behind one joint, rad/s", single), Panel("behind two joints, rad/s", pair)]
    svg = curves(
        "liu_2023_fig_6", degrees, "driving angle a from the plane of the shafts, degrees", panels
    )
    words = (
        "Figure 6: phases of 0°, 60° and 120° at r = 8°, above phi1 of one joint, below phi2 − phi1 of two joints. "
        "One joint's phase moves the curve and leaves its height; two joints' difference sets the height."
    )
    return Picture("liu_2023_fig_6", words, svg)


def _couples() -> Picture:
    every = [cross.couples(TURN, np.radians(angle), TORQUE, convention="N") for angle in ANGLES]
    named = list(zip(LABELS, every, strict=True))
    panels = [
        Panel("M1, N m", [(label, -one.driving.yoke) for label, one in named]),
        Panel("M2, N m", [(label, one.driven.yoke) for label, one in named]),
        Panel("T2, N m", [(label, one.driven_torque) for label, one in named]),
    ]
    along = "driving angle a from the normal of the shafts' plane, degrees"
    svg = curves("liu_2023_fig_7", np.degrees(TURN), along, panels, height=1.6)
    words = "Figure 7: couples in the yokes and driven torque for T1 = 800 N m (T2 by the corrected (13c))."
    return Picture("liu_2023_fig_7", words, svg)


def _kinematic_misprints() -> tuple[Misprint, ...]:
    r = np.radians(8.0)
    body = space.cross(TURN, r)
    turned, wrong = (
        np.exp(1j * paper.angle_right(r, TURN)),
        np.exp(1j * paper.angle_printed(r, TURN)),
    )
    ratio, gain = paper.ratio_printed(r, TURN), paper.acceleration_right(r, TURN, SPEED, 5.0)
    truth = body.curvature * SPEED**2 + 5.0 * body.ratio
    off = np.degrees(np.abs(np.angle(wrong / turned)).max())
    return (
        Misprint(
            "(3)",
            "`tan b = tan a/cos r`, said to follow from (2)",
            "(2) gives (4), `tan b = cos r tan a`; (3) is the same joint counted in P",
            f"pins in space, r = 8°: (4) within {bound(turned, np.exp(1j * body.driven_angle), '1e-14')} rad, (3) up "
            f"to {off:.2g}° away",
        ),
        Misprint(
            "(5)",
            "`b' = cos r/(1 − sin²r cos²a) a'` as derivative of (4)",
            "`b' = cos r/(1 − sin²r sin²a) a'`; the printed form belongs to (3), P",
            f"velocities in space: right form within {bound(paper.ratio_right(r, TURN), body.ratio, '1e-14')}, printed "
            f"form {apart(ratio, body.ratio)} away: smallest and largest change places",
        ),
        Misprint(
            "(6)",
            "`b'' = −sin²r cos r sin 2a/(1 − sin²r cos²a)² a'² + cos r/(1 − sin²r cos²a) a''`",
            "`b'' = +sin²r cos r sin 2a/(1 − sin²r sin²a)² a'² + cos r/(1 − sin²r sin²a) a''`",
            f"complex-step derivative of the velocities in space, a'' = 5 rad/s²: right form within "
            f"{bound(gain, truth, '1e-12')}, printed form "
            f"{apart(paper.acceleration_printed(r, TURN, SPEED, 5.0), truth)} away (its sign)",
        ),
        _one_joints_phase(),
        _two_joints_phase(),
    )


def _one_joints_phase() -> Misprint:
    return Misprint(
        "text with (7), (8)",
        "the size of the fluctuation depends on the phase angle",
        "not of one joint: its phase only shifts the curve; of two joints it does",
        "extremes at 0°, 60° and 120° equal in every printed digit of the row above",
    )


def _two_joints_phase() -> Misprint:
    r, first, second = UNEVEN[0], np.radians(UNEVEN[1]), np.radians(UNEVEN[2])
    own = paper.two_joints(r, TURN, first, second, counted_from_zero=False)
    away = paper.two_joints(r, TURN, first, second, counted_from_zero=True)
    truth = space.line_ratio(TURN, (r, r), (0.0, 0.0), (first, second - first - np.pi / 2.0))
    return Misprint(
        "(10)",
        "`b` reads as if it were 0 at `a = 0`",
        "`b + phi1` is the driven fork's angle from its own geometric zero",
        f"r = {r} rad, phi1 = {UNEVEN[1]}°, phi2 = {UNEVEN[2]}°: the line in space is constant, own zero within "
        f"{bound(own, truth, '1e-14')}; zero at a = 0 gives {away.min():.3f} .. {away.max():.3f}",
    )


def _other_misprints() -> tuple[Misprint, ...]:
    r, inner = np.radians(8.0), TURN[1:360]
    body = space.cross(TURN, r)
    pair = paper.pins(r, TURN, paper.angle_right(r, TURN))
    lean = np.abs(pair[1] @ np.array([0.0, np.cos(r), np.sin(r)])).max()
    square = np.abs(pair[1] @ np.array([0.0, np.cos(r), -np.sin(r)])).max()
    right = paper.driven_torque_right(r, TURN, TORQUE)
    bent = paper.driven_couple_right(r, TURN, TORQUE)
    same = bound(
        paper.driven_couple_printed(r, inner, TORQUE),
        paper.driven_couple_right(r, inner, TORQUE),
        "1e-12",
    )
    return (
        Misprint(
            "(1) with (12)",
            "(1) makes the driven shaft (0, cos r, −sin r), (12) takes (0, cos r, +sin r)",
            "one sign: for (12) the middle component of Ob in (1) changes sign; (2) is the same",
            f"Ob of (1) is square to the first axis (product {_small(square)}) and not to the second ({lean:.2g})",
        ),
        Misprint(
            "(13b)",
            "`M2 = −T1 sin²a sin r/sin b`, 0/0 at `a = 0`",
            "`M2 = −T1 tan r sin a √(1 − sin²r sin²a)`",
            f"statics in space within {bound(bent, TORQUE * body.driven_couple, '1e-13')}; equal to the printed form "
            f"within {same} where that is defined",
        ),
        Misprint(
            "(13c)",
            "`T2 = T1 (1 − sin²r cos²a)/cos r`",
            "`T2 = T1 (1 − sin²r sin²a)/cos r`",
            f"statics in space within {bound(right, TORQUE * body.driven_torque, '1e-14')}; printed form "
            f"{apart(paper.driven_torque_printed(r, TURN, TORQUE), right)} away, and against the paper's own text (T2 "
            "largest where M2 is smallest, at a = 0)",
        ),
        Misprint(
            "(14), torsion",
            "three shafts of two inertias each, with G2 to G5 as free torques: eight equations, twelve unknowns",
            "each joint adds `theta3 = f1(theta2)` and `G3 = G2/i1(theta2)`, likewise 4 and 5: four free angles",
            "count of unknowns; with both conditions the joint's power is zero and two rigid inertias keep their "
            "energy (test: 50 rad/s falls to 43.8576131631566 rad/s over a quarter revolution at 25°)",
        ),
        Misprint(
            "(14), supports",
            "C1 in the rows of y and z; F_y, F_z undefined",
            "C4, as the text defines; force = secondary couple/span",
            "dimensions; not computed, for lack of data",
        ),
        Misprint("fig. 9", "a rotational speed in mm", "rad/s", "dimensions"),
    )


def _small(value: float) -> str:
    return "0" if value < 1e-15 else f"{value:.1e}"
