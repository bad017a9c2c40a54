"""The page of Ma, Yu and Han (2011): a drive shaft with double cross universal joints."""

from collections.abc import Iterator
from functools import cache

import numpy as np

from benchmarks.papers import ma_equations as paper
from benchmarks.papers import space
from benchmarks.papers.drawing import Panel, curves
from benchmarks.papers.scenes import joints
from benchmarks.papers.writing import Misprint, Page, Picture, bound, compared, stated
from torsion.analyses.joints.joint_lines import Joints, LineFound
from torsion.kernels.joints import line

NAME = "ma_2011"
SPEED = 60.0  # degrees a second
DIGITS = 13  # printed: beyond them roundings of one machine would show
FIRST, SECOND, PLANE = np.radians([15.0, 20.0, 10.0])
PHASES = (10, 55, 100)  # degrees
TURN = np.linspace(0.0, 2.0 * np.pi, 721)
ALONG = "driving angle x1 from the plane of the first joint, degrees"


@cache
def at(degrees: int) -> Joints:
    """The model file with the second joint at a phase."""
    return joints(NAME, ("phase: 55 deg", f"phase: {degrees} deg"))


def output(degrees: int) -> LineFound:
    """The whole line of the model file at a phase."""
    return at(degrees).lines[0]


def page() -> Page:
    """Everything the page says."""
    return Page(
        name=NAME,
        title="Ma, Yu, Han 2011: output speed of a drive shaft with double cross universal joints",
        reference="Ma, Yu, Han, *Angular output velocity of a drive shaft with double cross universal joints*, Int. J. "
        "Plant Engineering and Management 16(2), 2011, from page 119.",
        what="The paper follows the angle and the speed through two cross joints whose planes and yokes may be turned "
        "against each other, and defines an index of fluctuation. In two examples it computes the output speed and "
        "searches the phase that makes the index smallest.",
        notation="`alpha`, `beta` angles of the joints, `gamma` from the first plane to the second, `phi` from the "
        "driven yoke of the first joint to the driving yoke of the second, `x1` driving angle, `psi = phi − gamma`. "
        "Data: 15°, 20°, 10°, driving speed 60 deg/s.",
        numbers=tuple(_numbers()),
        checks=_checks(),
        pictures=(_middle(), _indices(), _extreme()),
        misprints=_misprints(),
        missing=(
            (
                "The points that the paper plots are not available: figures 3, 5 and 6 are drawn from the data, "
                "without a comparison, and the assignment of curves is our reading."
            ),
            (
                "The equations are restored from each other and from the examples, (3) as `x2 = x1 + dx + 90° + phi − "
                "gamma`, and compared with lines in space; their print is not compared letter by letter."
            ),
        ),
    )


def _numbers() -> Iterator[tuple[str, ...]]:
    best, worst, middle = (output(degrees) for degrees in (10, 100, 55))
    optimum = output(55).optimum
    if optimum is None:
        raise ValueError("the model file requests no best phase")
    yield compared("best phase", "10", float(np.degrees(optimum.best[0])), "°", DIGITS)
    yield compared("phi = 10°: index of fluctuation", "0.055", best.index, "", DIGITS)
    yield compared(
        "phi = 10°: largest speed", "61.68", SPEED * best.greatest.speed_ratio, "deg/s", DIGITS
    )
    yield compared(
        "phi = 10°: smallest speed", "58.37", SPEED * best.least.speed_ratio, "deg/s", DIGITS
    )
    yield compared(
        "phi = 100°: largest speed", "66.10", SPEED * worst.greatest.speed_ratio, "deg/s", DIGITS
    )
    yield compared(
        "phi = 100°: smallest speed", "64.64", SPEED * worst.least.speed_ratio, "deg/s", DIGITS
    )
    yield stated("phi = 100°: index of fluctuation", worst.index, "", "curve only", DIGITS)
    yield stated(
        "phi = 55°: largest speed",
        SPEED * middle.greatest.speed_ratio,
        "deg/s",
        "curve only",
        DIGITS,
    )
    yield stated(
        "phi = 55°: at the driving angle",
        float(np.degrees(middle.greatest.at)),
        "°",
        "curve only",
        DIGITS,
    )
    yield stated(
        "phi = 55°: smallest speed", SPEED * middle.least.speed_ratio, "deg/s", "curve only", DIGITS
    )
    yield stated("phi = 55°: index of fluctuation", middle.index, "", "curve only", DIGITS)
    yield stated("index if the best phase is 1° off", optimum.sensitivity[0], "", "not said")
    yield stated(
        "one joint that does the same, phi = 10°",
        float(np.degrees(best.resultant)),
        "°",
        "not said",
    )


def _checks() -> str:
    limits = []
    for degrees in PHASES:
        truth = space.line_ratio(TURN, (FIRST, SECOND), (0.0, PLANE), (0.0, np.radians(degrees)))
        ours = line.motion(
            TURN, line.line_of([FIRST, SECOND], [0.0, PLANE], [0.0, np.radians(degrees)])
        ).ratio[-1]
        limits += [bound(ours, truth, "1e-14")]
        bound(paper.output(FIRST, SECOND, np.radians(degrees), PLANE, TURN), truth, "1e-14")
        bound(
            output(degrees).index,
            paper.closed_index(FIRST, SECOND, np.radians(degrees) - PLANE),
            "1e-12",
        )
    return (
        f"Ours and (1) to (5) agree with two joints placed in space within {limits[0]} of the speed at 721 angles of a "
        "revolution, for all three phases. The index needs no search: with `p = ln sec alpha`, `q = ln sec beta` it is "
        "`2 sinh R`, `cosh R = cosh p cosh q − sinh p sinh q cos 2psi`, smallest at `psi = 0`, there "
        f"`|cos alpha/cos beta − cos beta/cos alpha|` = {abs(_left()):.13g}; the product of disk maps, which the "
        "program uses, agrees within 1e-12."
    )


def _left() -> float:
    ratio = np.cos(FIRST) / np.cos(SECOND)
    return float(ratio - 1.0 / ratio)


def _over(degrees: int) -> tuple[np.ndarray, np.ndarray]:
    """Driving angle in degrees and output speed in deg/s."""
    found = at(degrees)
    return np.degrees(found.angle), SPEED * found.joints[-1].speed_ratio


def _middle() -> Picture:
    x, last = _over(55)
    first = SPEED * at(55).joints[0].speed_ratio
    peak = output(55).greatest
    mark = (
        float(np.degrees(peak.at)),
        SPEED * peak.speed_ratio,
        f"{SPEED * peak.speed_ratio:.4f} deg/s at {np.degrees(peak.at):.4f}°",
    )
    lines = [("intermediate shaft", first), ("output shaft", last)]
    svg = curves("ma_2011_fig_3", x, ALONG, [Panel("speed, deg/s", lines, [mark])], height=2.8)
    return Picture(
        "ma_2011_fig_3", "Figure 3: speeds of intermediate and output shaft, phi = 55°.", svg
    )


def _indices() -> Picture:
    phases = np.linspace(-90.0, 180.0, 541)
    values = paper.closed_index(FIRST, SECOND, np.radians(phases) - PLANE)
    marks = [
        (degrees, output(degrees).index, f"{output(degrees).index:.4f} at {degrees}°")
        for degrees in PHASES
    ]
    panel = Panel("index of fluctuation", [("closed form", values)], marks)
    svg = curves("ma_2011_fig_5", phases, "phase phi, degrees", [panel], height=2.8)
    return Picture(
        "ma_2011_fig_5",
        "Figure 5: index of fluctuation over the phase; minimum at phi = gamma = 10°.",
        svg,
    )


def _extreme() -> Picture:
    (x, best), (_, worst) = _over(10), _over(100)
    lines = [("phi = 10° (best)", best), ("phi = 100° (worst)", worst)]
    svg = curves("ma_2011_fig_6", x, ALONG, [Panel("output speed, deg/s", lines)], height=2.8)
    return Picture(
        "ma_2011_fig_6", "Figure 6: output speed at the best and at the worst phase.", svg
    )


def _misprints() -> tuple[Misprint, ...]:
    body = SPEED * space.line_ratio(TURN, (FIRST, SECOND), (0.0, PLANE), (0.0, np.radians(100.0)))
    closed = SPEED * np.cos(FIRST) * np.cos(SECOND)
    equal = paper.index(paper.output(FIRST, FIRST, np.radians(10.0), PLANE, TURN))
    turned = np.degrees(2.0 * np.pi) * output(10).greatest.speed_ratio
    flat = paper.index(space.line_ratio(TURN, (FIRST, SECOND), (0.0, 0.0), (0.0, np.radians(10.0))))
    across = np.degrees(_between_outer_planes())
    return (
        Misprint(
            "5.2, phi = 100°",
            "least speed 64.64",
            "54.46, exactly `60 cos 15° cos 20°` = 54.4604022714221 deg/s",
            f"minimum of the line in space within {bound(body.min(), closed, '1e-14')} of it at x1 = 90°; 64.64 is "
            "above the driving speed, which a minimum cannot be",
        ),
        Misprint(
            "text after (2)",
            "beta's plane is that of intermediate and input shaft",
            "of intermediate and **output** shaft",
            "lines in space: with it gamma = 10° puts the best phase at 10°; the other reading leaves one plane only "
            f"(angle between the planes as defined: {across:.3g}°)",
        ),
        Misprint(
            "3.2, first sentence",
            "input and output shaft in the same plane",
            "**not** in the same plane: gamma ≠ 0",
            f"(13) has gamma in it; with gamma = 0 the phase of 10° gives index {flat:.4f} in space, not "
            f"{output(10).index:.4f}",
        ),
        Misprint(
            "5.1",
            "60 r/min (60 deg/s)",
            "60 deg/s = 10 r/min",
            f"60 r/min is 360 deg/s and would give a largest speed of {turned:.2f} deg/s, not 61.68",
        ),
        Misprint(
            "5.2",
            "alpha = beta = 15°",
            "alpha = 15°, beta = 20°",
            f"two equal joints at the best phase run evenly (index {_zero(equal)}); 0.055, 61.68 and 58.37 need 20°",
        ),
    )


def _between_outer_planes() -> float:
    """Angle between the plane of the first two shafts and that of the last two, about the intermediate shaft, rad."""
    middle = space.rotated(space.AXIS, space.NORMAL, FIRST)
    last = space.rotated(middle, space.rotated(space.NORMAL, middle, PLANE), SECOND)
    normals = np.cross(space.AXIS, middle), np.cross(middle, last)
    return float(np.arctan2(np.cross(*normals) @ middle, normals[0] @ normals[1]))


def _zero(value: float) -> str:
    if value > 1e-14:
        raise ArithmeticError(f"{value} is not zero")
    return "below 1e-14"
