"""The page of Zhu and Wang: combination resonance of a misaligned shaft driven by a universal joint."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np

from benchmarks.papers import zhu_wang_equations as paper
from benchmarks.papers import zhu_wang_space as space
from benchmarks.papers.drawing import Panel, curves
from benchmarks.papers.writing import Page, Picture, bound, compared, stated
from benchmarks.papers.zhu_wang_faults import faults
from benchmarks.papers.zhu_wang_motion import DENSITY, RADIUS, SHAFT, body, exact, linear, shaft
from benchmarks.papers.zhu_wang_theory import (
    SMALL_ANGLE,
    exact_rate,
    hill_growth,
    natural_frequencies,
    response,
    undamped,
)
from torsion.analyses.lateral.misaligned_shaft import EXACT, MisalignedShaft, Model, growth
from torsion.analyses.lateral.tilt_stability import TiltRange, zones

NAME = "zhu_wang"
SPEEDS = (25.9, 26.2)  # rad/s of the paper's curves
LAST = 20.0  # s of the curves
POINTS = 1500
RANGE = (3.0, 40.0)  # rad/s
NO_CIRCULATION = Model(paper.without_circulation)
SAID = {
    (25.9, True): "unstable",
    (25.9, False): "unstable",
    (26.2, True): "stable",
    (26.2, False): "unstable",
}


def page() -> Page:
    """Everything the page says."""
    return Page(
        name=NAME,
        title="Zhu and Wang: combination resonance of a misaligned shaft driven by a universal joint",
        reference="Zhu and Wang, on the combination resonance of a misaligned shaft driven by a universal joint "
        "(journal, year and pages are not recorded in the available copy).",
        what="A rigid shaft is carried by a universal joint and lies in an elastic bearing at its other end. The "
        "couple that the joint puts on it follows the shaft's own two angles, so that its stiffness varies at twice "
        "the speed. The paper linearises, expands by multiple scales to the first order, and computes one example at "
        "two speeds, with and without damping.",
        notation="`phi` misalignment, `theta` driving angle, `alpha`, `beta` angles of the shaft, `T0` torque, `J0` "
        "transverse inertia about the joint, `kappa` polar/transverse inertia, `l` distance of the bearing, `Kx`, "
        "`Ky`, `C` its stiffness and damping, `w10`, `w20` frequencies of the shaft at rest, `E0`, `E1`, `E2` parts of "
        "the matrix in sin 2theta, cos 2theta and the constant one. Example: phi 5°, T0 0.3 N m, l 0.46 m, Kx 7.74, "
        "Ky 23.22 N/m, C 1e-3 N s/m; J0 and kappa as printed, 4.597e-3 kg m² and 3.96e-5.",
        numbers=(*_data(), *_growth(), *_boundaries(), *_curves()),
        checks=_checks(),
        pictures=(_figures(damped=True), _figures(damped=False), _growth_over_speed(), _response()),
        misprints=faults(),
        missing=(
            (
                "Figures 4 to 7 point by point: the paper's curves are not available. That 4 and 5 are the damped, 6 "
                "and 7 the undamped cases is our reading; notes on the paper name figure 5 alone, 26.2 rad/s damped."
            ),
            (
                "T0, Kx, Ky and l are not recorded in the available copy: they were found from w10, w20, Gamma, C11 "
                "and J0 of the example. The radius 2.4 mm and the density 7830 kg/m³ were chosen so that 1.5 R²/l² is "
                "the recorded 4.083e-5 and J0 comes out as printed: the rows of J0 and kappa are no independent check. "
                "The form of (22) given above was found from its recorded half width; all other printed forms are "
                "quoted from notes on the paper."
            ),
        ),
        computed_by="`torsion.analyses.lateral.tilt_stability`",
        tested_by="test_zhu_wang.py",
    )


def _data() -> Iterator[tuple[str, ...]]:
    low, high = np.sqrt(np.sort(SHAFT.square))
    middle = np.sqrt((low**2 + high**2) / 2.0)
    mass = DENSITY * np.pi * RADIUS**2 * SHAFT.length
    yield compared("J0 = m l²/3", "0.004597", mass * SHAFT.length**2 / 3.0, "kg m²", 5)
    yield compared("kappa = 1.5 R²/l²", "0.0000396", 1.5 * (RADIUS / SHAFT.length) ** 2, "", 5)
    yield compared("w20", "18.876", low, "rad/s")
    yield stated("w20², printed as 3.563e3", low**2, "rad²/s²", "3563 rad²/s²")
    yield stated("w10", high, "rad/s", "not recorded")
    yield compared(
        "Gamma = T0/(2 J0 W0²), W0² = (w10² + w20²)/2",
        "0.04580",
        SHAFT.torque / SHAFT.inertia / (2.0 * middle**2),
        "",
        6,
    )
    yield compared("C11 = C l²/(J0 W0)", "0.00172", SHAFT.decay[0] / middle, "", 6)


def _growth() -> Iterator[tuple[str, ...]]:
    for model, words in ((EXACT, "(7) corrected"), (SMALL_ANGLE, "(8), signs of (7)")):
        for damped in (True, False):
            rates = growth(shaft(damped=damped), np.array(SPEEDS), model).rate
            for speed, rate in zip(SPEEDS, rates, strict=True):
                said = SAID[speed, damped]
                verdict = "agrees" if (rate > 0.0) == (said == "unstable") else "**does not agree**"
                what = f"growth at {speed} rad/s, C = {1e-3 if damped else 0:g}, {words}"
                yield what, said, f"{rate:+.8f} 1/s", verdict


def _models() -> dict[str, tuple[MisalignedShaft, Model]]:
    return {
        "(7) corrected": (SHAFT, EXACT),
        "(7) corrected, driven speed uneven": (SHAFT, Model(is_even=False)),
        "(8), signs of (7)": (SHAFT, SMALL_ANGLE),
        "(7) as printed but sec for csc": (SHAFT, Model(paper.frozen)),
        "(8) without E2, the paper's mechanism": (SHAFT, NO_CIRCULATION),
        "(8) without E2, C = 0, kappa = 0": (replace(undamped(SHAFT), polar=0.0), NO_CIRCULATION),
    }


@cache
def zone(name: str) -> TiltRange:
    """The sum zone by one of the models."""
    one, model = _models()[name]
    (found,) = zones(one, 25.0, 26.6, model, 60)
    return found


@cache
def every_zone() -> tuple[TiltRange, ...]:
    """All unstable ranges of the corrected (7) with damping."""
    return zones(SHAFT, *RANGE)


def _boundaries() -> Iterator[tuple[str, ...]]:
    for name in _models():
        one = zone(name)
        yield stated(f"sum zone, {name}", f"{one.first:.9f} .. {one.last:.9f}", "rad/s", "–")
    first = paper.averaged(SHAFT)
    width, wrong = paper.half_width_right(SHAFT), paper.half_width_printed(SHAFT)
    yield stated("sum zone, first order, C = 0, (20)", _around(first.middle, width), "rad/s", "–")
    yield stated("sum zone, (22) as printed", _around(first.middle, wrong), "rad/s", "–")
    low, up = first.boundaries()
    yield stated("sum zone, second order, C = 1e-3", f"{low:.6f} .. {up:.6f}", "rad/s", "–")
    for one in every_zone():
        if not one.kind.startswith("sum"):
            said = "never unstable" if one.kind.startswith("difference") else "not mentioned"
            words = f"{one.first:.9f} .. {one.last:.9f}"
            yield stated(
                f"{one.kind}, (7) corrected, largest growth {one.growth:.8f} 1/s",
                words,
                "rad/s",
                said,
            )


def _around(middle: float, half: float) -> str:
    return f"{middle - half:.9f} .. {middle + half:.9f}"


def _curves() -> Iterator[tuple[str, ...]]:
    for speed in SPEEDS:
        for damped in (True, False):
            _, angles = linear(shaft(damped=damped), speed, int(LAST * speed / np.pi))
            what = f"alpha, largest from {LAST - 1:g} to {LAST:g} s, {speed} rad/s, C = {1e-3 if damped else 0:g}, linear"
            number = angles.shape[1] // int(LAST)
            yield stated(what, np.abs(angles[0, -number:]).max(), "rad", digits=2)
    _, angles = linear(SHAFT, 26.2, int(300.0 * 26.2 / np.pi))
    yield stated(
        "the same at 26.2 rad/s, C = 1e-3, after 300 s",
        np.abs(angles[0, -600:]).max(),
        "rad",
        "stable",
        2,
    )
    for damped in (True, False):
        what = f"alpha, largest within {LAST:g} s, 25.9 rad/s, C = {1e-3 if damped else 0:g}, exact equations"
        yield stated(what, np.abs(exact(25.9, damped, LAST, POINTS)[1][0]).max(), "rad", digits=2)


def _checks() -> str:
    """How far the ways of computing stand apart."""
    from scipy.integrate import solve_ivp

    at = np.linspace(*RANGE, 8)
    pairs = [(one, model) for one in (SHAFT, undamped(SHAFT)) for model in (EXACT, SMALL_ANGLE)]
    found = np.concatenate([growth(one, at, model).rate for one, model in pairs])
    other = np.concatenate([hill_growth(one, at, model) for one, model in pairs])
    times = np.linspace(0.0, 0.5, 21)
    angles = space.angles(body(SHAFT, 25.9), times)

    run = solve_ivp(
        exact_rate,
        (0.0, 0.5),
        np.zeros(4),
        "DOP853",
        t_eval=times,
        rtol=1e-9,
        atol=1e-12,
        args=(SHAFT, 25.9),
    )
    return (
        f"Growth by the monodromy matrix (collocation of order 13) and by Hill's matrix differ by at most "
        f"{bound(found, other, '1e-10')} of the largest at 8 speeds from 3 to 40 rad/s, with and without damping, "
        "for both matrices. The exact equations in two angles were compared with the shaft as a body in space, its "
        "direction and angular momentum in fixed axes and the couple square to both pins: "
        f"{bound(run.y[:2], angles, '1e-7')} of the largest angle. The corrected (7) is the derivative of that "
        "couple; the tests also compare it with integration in time and statics."
    )


def _figures(*, damped: bool) -> Picture:
    """Two speeds below each other."""
    numbers = (4, 5) if damped else (6, 7)
    name = f"zhu_wang_fig_{numbers[0]}_{numbers[1]}"
    panels, times = [], np.linspace(0.0, LAST, POINTS)
    fast = exact(25.9, damped, LAST, POINTS)[1]
    long, slow = linear(shaft(damped=damped), 26.2, int(LAST * 26.2 / np.pi) + 1)
    slow_at = np.interp(times, long, slow[0])
    panels = [
        Panel("alpha, rad, at 25.9 rad/s", [("alpha", fast[0])]),
        Panel("alpha, rad, at 26.2 rad/s", [("alpha", slow_at)]),
    ]
    svg = curves(name, times, "time, s", panels)
    words = (
        f"Figures {numbers[0]} and {numbers[1]}: motion from rest with C = {'1e-3 N s/m' if damped else '0'}. At 25.9 "
        "rad/s it grows until the exact equations, drawn here, hold it at some 0.3 rad (the linear ones leave every "
        "bound). "
    )
    words += (
        "At 26.2 rad/s it looks steady for 20 s, as the paper says; its growth of 0.017 1/s shows later, see above."
        if damped
        else "At 26.2 rad/s it grows slowly."
    )
    return Picture(name, words, svg)


def _growth_over_speed() -> Picture:
    at = np.linspace(*RANGE, 371)
    lines = [
        ("(7) corrected", growth(SHAFT, at).rate),
        ("(8) without E2", growth(SHAFT, at, NO_CIRCULATION).rate),
    ]
    marks = [(one.at, one.growth, one.kind) for one in every_zone()]
    svg = curves(
        "zhu_wang_growth", at, "speed, rad/s", [Panel("growth, 1/s", lines, marks)], height=2.6
    )
    words = (
        "Growth with C = 1e-3 N s/m. The constant part E2, which the first order drops, widens the sum zone and makes "
        "the difference zone."
    )
    return Picture("zhu_wang_growth", words, svg)


def _response() -> Picture:
    at = np.linspace(*RANGE, 371)
    found = response(SHAFT, at)
    size = np.abs(found.angle[:, :, 1])
    size[np.array(found.status) != "ok"] = np.nan
    panels = [
        Panel(
            "log10 amplitude, rad",
            [("alpha", np.log10(size[:, 0])), ("beta", np.log10(size[:, 1]))],
        )
    ]
    svg = curves("zhu_wang_response", at, "speed, rad/s", panels, height=2.6)
    halves = natural_frequencies(SHAFT).frequency[0] / 2.0
    words = (
        "Periodic answer of the linear equations to the couple at order 2, C = 1e-3 N s/m; no line where it is "
        "unstable and never reached. Its peaks, beyond what linear equations may say (some 0.1 rad), are at "
        f"half the frequencies, {halves[0]:.4f} and {halves[1]:.4f} rad/s."
    )
    return Picture("zhu_wang_response", words, svg)
