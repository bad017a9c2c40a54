"""The page of Chang and Li: tripod universal joints with single and twin radial bearings."""

from collections.abc import Iterator
from functools import cache

import numpy as np

from benchmarks.papers import tripod_equations as paper
from benchmarks.papers import tripod_first_order as first_order
from benchmarks.papers.drawing import Panel, curves
from benchmarks.papers.scenes import joints
from benchmarks.papers.tripod_space import Tripod
from benchmarks.papers.tripod_space import tripod as in_space
from benchmarks.papers.writing import Misprint, Page, Picture, apart, bound, stated
from torsion.kernels.joints import tripod

NAME = "chang_li_tripod"
TORQUE, RADIUS, ARM = 200.0, 0.03, 0.6  # N m, m, m
SHARE = RADIUS / ARM
ANGLES = (10, 20, 30, 40)  # degrees
TURN = np.linspace(0.0, 2.0 * np.pi, 721)
FEW = TURN[:361:30]  # half a revolution in steps of 15 degrees: the joint repeats after 120
SMALL = 1e-4  # radius/arm at which the first order is all that counts


def page() -> Page:
    """Everything the page says."""
    return Page(
        name=NAME,
        title="Chang, Li: tripod universal joint with single and twin radial bearings",
        reference="Chang, Li, article on the tripod universal joint with single and twin radial bearings (journal, "
        "year and pages are not recorded in the available copy).",
        what="The paper finds the motion of the spider of a tripod joint and the couples that a driving torque puts on "
        "both shafts. It compares a single radial bearing, whose couple varies three times a revolution, with twin "
        "bearings, whose couple stands still.",
        notation="`g` joint angle, `phi` driving angle from the normal of the shafts' plane, `lambda` radius of the "
        "three lines, `L` arm to the pivot, `Ti`, `To` driving and driven torque, `U1`, `V1` couple on the driving "
        "shaft about the normal and in the plane, `M1` its size, `V2` on the driven shaft, `i` speed ratio. Data: "
        "200 N m, 30 mm, 600 mm.",
        numbers=tuple(_numbers()),
        checks=_checks(),
        pictures=(_turn(), _angles()),
        misprints=_misprints(),
        missing=(
            (
                "The values of the curves in figures 5 and 6 are not available: both are drawn from the data, without "
                "a comparison, and which curve it shows in which of the two is our reading."
            ),
            (
                "(9) is known to be wrong in the available copy, its exact print is not; it is taken with the sign "
                "that (10) has."
            ),
            "Friction and the sliding of the bearings are not in the paper's model, nor in ours.",
        ),
    )


@cache
def bodies(degrees: int, share: float = SHARE) -> tuple[Tripod, ...]:
    """The joint in space at FEW driving angles."""
    return tuple(in_space(float(x), float(np.radians(degrees)), share) for x in FEW)


def couple(degrees: float) -> np.ndarray:
    """M1 over the turn to first order, N m."""
    return first_order.first_order_statics(TURN, np.radians(degrees), RADIUS, ARM, TORQUE).couple


def _numbers() -> Iterator[tuple[str, ...]]:
    for angle in ANGLES:
        first = couple(angle)
        exact = tripod.exact_statics(TURN, np.radians(angle), RADIUS, ARM, TORQUE)
        size = exact.couple
        pushed = np.hypot(*exact.force)
        steady = tripod.constant_velocity_couple(np.radians(angle), TORQUE)
        yield stated(
            f"{angle}°, single: M1, corrected equations",
            f"{first.min():.10f} .. {first.max():.10f}",
            "N m",
        )
        yield stated(
            f"{angle}°, single: M1, exact mechanism",
            f"{size.min():.6f} .. {size.max():.6f}",
            "N m",
            "–",
        )
        yield stated(
            f"{angle}°, single: lateral force, exact mechanism",
            f"up to {pushed.max():.4g}",
            "N",
            "not said",
        )
        yield stated(f"{angle}°, twin: M1", f"{steady:.10f}", "N m")

    yield stated(
        "40°: third harmonic of the error, (1)",
        tripod.error_size(g := np.radians(40.0), RADIUS, ARM),
        "rad",
    )
    yield stated("40°: third harmonic of the error, exact mechanism", _third(float(g)), "rad", "–")


def _third(g: float) -> float:
    """Amplitude of cos 3 phi in the exact error, rad."""
    error = tripod.exact_motion(TURN[:-1], g, RADIUS, ARM).error
    return float(2.0 * np.mean(error * np.cos(3.0 * TURN[:-1])))


def _checks() -> str:
    limits = []
    for angle in ANGLES:
        ours = tripod.exact_statics(FEW, np.radians(angle), RADIUS, ARM, 1.0)
        truth = np.array(
            [[one.driven_torque, one.inplane, one.driven_inplane] for one in bodies(angle)]
        ).T
        limits.append(
            bound((ours.torque, ours.driving_inplane, ours.driven_inplane), truth, "1e-12")
        )
    scene = joints(NAME).joints[0].couples[0]
    exact = tripod.exact_statics(joints(NAME).angle, np.radians(40.0), RADIUS, ARM, TORQUE)
    near = bound(scene.largest, exact.couple.max(), "1e-3")
    return (
        "The exact mechanism was compared with three arms that meet three lines in space, found by a general solver, "
        f"with three contact forces and the pivot's moment in balance: torques and couples within {limits[0]} over a "
        "half revolution at every angle. The corrected equations are its first order in lambda/L: their largest M1 is "
        f"{_short(10)} (10°) to {_short(40)} (40°) away from it. The model file's couple at 40° is that of the exact "
        f"mechanism within {near}."
    )


def _short(degrees: int) -> str:
    """Relative distance of the first order's largest couple from the exact one."""
    exact = tripod.exact_statics(TURN, np.radians(degrees), RADIUS, ARM, TORQUE).couple
    return f"{abs(couple(degrees).max() / exact.max() - 1.0):.1e}"


def _turn() -> Picture:
    panels = [
        Panel(
            f"M1 at {angle}°, N m",
            [
                ("single", couple(angle)),
                ("twin", tripod.constant_velocity_couple(np.radians(angle), TORQUE)),
            ],
        )
        for angle in ANGLES
    ]
    svg = curves(
        "chang_li_tripod_fig_5",
        np.degrees(TURN),
        "driving angle phi, degrees",
        panels[::-1],
        height=1.35,
    )
    words = "Figure 5: couple on the driving shaft over a revolution at joint angles of 10° to 40°."
    return Picture("chang_li_tripod_fig_5", words, svg)


def _angles() -> Picture:
    degrees = np.linspace(0.0, 40.0, 161)
    sizes = np.array([couple(angle) for angle in degrees])
    lines = [
        ("single, greatest", sizes.max(axis=1)),
        ("single, least", sizes.min(axis=1)),
        ("twin", tripod.constant_velocity_couple(np.radians(degrees), TORQUE)),
    ]
    svg = curves(
        "chang_li_tripod_fig_6",
        degrees,
        "joint angle g, degrees",
        [Panel("M1, N m", lines)],
        height=3,
    )
    words = "Figure 6: couple over the joint angle; the twin bearing's is `Ti tan(g/2)`, a straight line but for 4 %."
    return Picture("chang_li_tripod_fig_6", words, svg)


def _limit(name: str, form: object) -> str:
    """Distance of a form from the joint in space as lambda/L goes to zero, in units of what varies."""
    values = np.array([getattr(one, name) for one in bodies(40, SMALL)])
    swing = float(np.ptp(values))
    return f"{np.abs(np.asarray(form) - values).max() / swing:.1g}"


def _misprints() -> tuple[Misprint, ...]:
    g = float(np.radians(40.0))
    torque, inplane = (
        np.array([getattr(one, name) for one in bodies(40)])
        for name in ("driven_torque", "inplane")
    )
    wrong, printed = paper.driven_torque_printed(g, FEW, SHARE), paper.couple_printed(g, FEW, SHARE)
    right, corrected = paper.driven_torque_right(g, FEW, SHARE), paper.couple_right(g, FEW, SHARE)
    level = np.tan(g / 2.0)
    about = np.array([one.normal for one in bodies(40)])
    normal = first_order.first_order_statics(FEW, g, RADIUS, ARM, 1.0).driving_normal
    twin, turned = paper.twin_right(g), paper.twin_printed(g)
    small = paper.couple_right(g, FEW, SMALL), paper.couple_printed(g, FEW, SMALL)
    return (
        Misprint(
            "(9)",
            "`To/Ti = −2L/(2L + 3 lambda tan²(g/2) tan g sin 3phi)`",
            "`To/Ti = −2L/(2L − 3 lambda tan²(g/2) tan g sin 3phi)` = −1/i",
            f"three contact forces in space, 40°: printed {apart(wrong, -torque)} away, right form within "
            f"{bound(right, -torque, '2e-4')}",
        ),
        Misprint(
            "(10)",
            "V1 over `2L sin g tan g + 3 lambda tan²(g/2) tan²g sin g sin 3phi`",
            "V1 over `2L sin g tan g − 3 lambda tan²(g/2) tan²g sin g sin 3phi`; V1 = Ti (1/i − cos g)/sin g",
            f"the same, 40°: printed {apart(printed, inplane)} away, right form within "
            f"{bound(corrected, inplane, '1e-3')}; as lambda/L falls to {SMALL:.0e} the right form's error falls to "
            f"{_limit('inplane', small[0])} of what varies, the printed form's stays at {_limit('inplane', small[1])}",
        ),
        Misprint("(13)", "the denominator of (10)", "the same change of sign", "follows from (10)"),
        Misprint(
            "(14)",
            "`V1 = (−Ti − Ti cos g)/sin g`, `V2 = Ti sin g + (Ti + Ti cos g) cos g/sin g`",
            "`V1 = (Ti − Ti cos g)/sin g`, `V2 = Ti sin g + (−Ti + Ti cos g) cos g/sin g`; both are `Ti tan(g/2)`",
            f"moment of a joint of constant velocity lies in the plane that bisects its shafts: right form within "
            f"{bound(twin, (level, level), '1e-14')}; printed {turned[0] / level:+.3g} and {turned[1] / level:+.3g} "
            "times that at 40°",
        ),
        Misprint(
            "text with (5)",
            "rotation about OoZo; only U1 works",
            "rotation about OoXo; the denominators 1 + dF/dphi are dropped, so (5) is of first order",
            f"reading of the derivation; U1 of the joint in space at 40° within {bound(normal, about, '3e-2')} of (5)",
        ),
        Misprint(
            "throughout",
            "`tan² gamma 2`, `tan`",
            "`tan²(gamma/2)`, `tan gamma`",
            "dimensions and (1)",
        ),
        Misprint(
            "text",
            "the couples are a pure torque",
            "a single bearing also pushes the shafts sideways, about V1/L",
            "sum of the three contact forces in space, rows above; zero of the twin bearing",
        ),
    )
