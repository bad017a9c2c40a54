"""Misprints and wrong conclusions of Zhu and Wang, each with the calculation that shows it."""

from dataclasses import replace

import numpy as np

from benchmarks.papers import zhu_wang_equations as paper
from benchmarks.papers.writing import Misprint, apart, bound
from benchmarks.papers.zhu_wang_motion import RADIUS, SHAFT
from benchmarks.papers.zhu_wang_theory import SMALL_ANGLE, moment, small_angle, undamped
from torsion.analyses.lateral.misaligned_shaft import (
    EXACT,
    MisalignedShaft,
    Model,
    growth,
    linearised,
    monodromies,
    small_angle_part,
)
from torsion.analyses.lateral.tilt_stability import TiltRange, zones

TURN = np.linspace(0.0, np.pi, 91)
SPEEDS = np.array([25.9, 26.2])
STILL = undamped(SHAFT)
TILT = SHAFT.tilt


def faults() -> tuple[Misprint, ...]:
    """Equations first, conclusions after them."""
    return (*_matrix(), *_small_angle(), *_criteria(), *_figures(), *_conclusions())


def derivative(couple: object, step: float = 1e-3) -> np.ndarray:
    """(angles, 2, 2) minus the derivative of a couple at rest, by central differences of two steps."""

    def once(size: float) -> np.ndarray:
        ends = [
            couple(TURN, TILT, size * a, size * b)[..., :2]  # type: ignore[operator]
            for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))
        ]
        return np.stack((ends[1] - ends[0], ends[3] - ends[2]), axis=-1) / (2.0 * size)

    result: np.ndarray = (4.0 * once(step) - once(2.0 * step)) / 3.0
    return result


def growing_phase(shaft: MisalignedShaft, which: int) -> float:
    """Phase, rad, of the growing motion of one angle at its own frequency by E0 alone; 0: cosine, pi/2: sine."""
    model = Model(lambda turned, tilt: small_angle_part(turned, sine=1.0, cosine=0.0, constant=0.0))
    speed = float(np.sqrt(shaft.square[which]))
    value, vector = np.linalg.eig(monodromies(shaft, np.array([speed]), model)[0])
    motion = np.real(vector[:, np.abs(value).argmax()])
    return float(np.arctan2(abs(motion[2 + which]) / speed, abs(motion[which])))


def _matrix() -> tuple[Misprint, ...]:
    truth = derivative(moment)
    right, kept = linearised(TURN, TILT), paper.frozen(TURN, TILT)
    rates = growth(SHAFT, SPEEDS, Model(paper.printed)).rate
    sec = growth(SHAFT, SPEEDS, Model(paper.frozen)).rate
    return (
        Misprint(
            "(7)",
            "`csc phi` in the entries next to the diagonal",
            "`sec phi`: csc has no limit for phi → 0",
            f"as printed the growth at both speeds would be {rates[0]:.2f} and {rates[1]:.2f} 1/s, against all curves",
        ),
        Misprint(
            "(7), even with sec",
            "entry 11 `−sin 2theta`; entry 21 `−(cos 2phi/cos phi)(1 − cos 2theta)`",
            "times T0/(2 J0): `[[−sec²phi sin 2theta, (sec phi/2)((1 + cos 2phi) + (3 − cos 2phi) cos 2theta)], "
            "[−cos phi (1 − cos 2theta), sin 2theta]]`",
            f"derivative of the exact couple: right form within {bound(right, truth, '1e-9')}; the printed one is the "
            f"derivative with e_n·K0 kept at cos phi, within "
            f"{bound(kept, derivative(paper.frozen_couple), '1e-9')}, and {apart(kept, truth)} away; growth at 26.2 "
            f"rad/s {sec[1]:.8f} 1/s in place of 0.01699056",
        ),
    )


def _small_angle() -> tuple[Misprint, ...]:
    limit = bound(small_angle(TURN), linearised(TURN, 1e-7), "1e-13")
    turned = growth(SHAFT, SPEEDS, Model(paper.turned_sign)).rate
    right = growth(SHAFT, SPEEDS, SMALL_ANGLE).rate
    low, high = growing_phase(STILL, 1), growing_phase(STILL, 0)
    return (
        Misprint(
            "(8), (11), (12), sign",
            "E0, E1, E2 opposite to (7)",
            "on the right side `E0 = diag(1, −1)`, `E1 = −[[0, 1], [1, 0]]`, `E2 = [[0, −1], [1, 0]]`",
            f"limit phi → 0 of the corrected (7) within {limit}; the growth hardly shows it: {apart(turned, right)} "
            "away at both speeds, by the gyroscopic term alone",
        ),
        Misprint(
            "(8), (11), (12), damping",
            "off-diagonal terms of C symmetric; C_x with alpha; factor W0²",
            "gyroscopic terms are skew, `+kappa psi'`, `−kappa psi'`; the bearing's C_y (and Ky) resists alpha; "
            "factor W0. E0 is not printed at all",
            "Euler's equations of the spinning shaft (energy is kept without damping) and the bearing's lever; "
            "dimensions",
        ),
        Misprint(
            "(13), (14)",
            "sign of the term in `exp j(2w − w10)`, `exp j(2w − w20)`",
            "the opposite sign: E0 = diag(1, −1) makes alpha grow as a sine of w10 t, beta as a cosine of w20 t",
            f"monodromy with E0 alone at w10 and w20: phases {np.degrees(high):.0f}° and {np.degrees(low):.0f}°, "
            "first order 90° and 0°; no effect on the sum type",
        ),
    )


def _criteria() -> tuple[Misprint, ...]:
    own, longer = (
        _sum_zone(replace(STILL, polar=0.0, length=factor * STILL.length)) for factor in (1.0, 1.1)
    )
    (width, wrong) = (half(SHAFT) for half in (paper.half_width_right, paper.half_width_printed))
    middle = paper.averaged(SHAFT).middle
    ratio = (longer.last - longer.first) / (own.last - own.first)
    return (
        Misprint(
            "(21), (22)",
            "the root of (20) is dropped: T0/(4 l² √(Kx Ky)), a pure number",
            "half width in speed `T0/(8 l √J0 (Kx Ky)^¼)` rad/s; the detuning is twice that",
            "dimensions; without E2, damping and gyroscopic term the zone's half width is "
            f"{(own.last - own.first) / 2:.6f}, right form {width:.6f}, printed {wrong:.6f} rad/s; by that "
            f"{middle - wrong:.4f} .. {middle + wrong:.4f}, and 25.9 would be stable",
        ),
        Misprint(
            "condition of resonance",
            "`w = (w_i ± w_j)/2`, i ≠ j, as the only ones",
            "E0 is diagonal: also `w = w10` and `w = w20`, growth T0/(8 J0 w_i) without damping",
            f"growth at w20 by E0 alone {_simple(1):.6f} 1/s, formula "
            f"{SHAFT.torque / SHAFT.inertia / (8.0 * np.sqrt(SHAFT.square[1])):.6f}; both zones stand in the table above",
        ),
        Misprint(
            "conclusion 3, abstract",
            "they contradict each other and (21) on a longer shaft and a stiffer bearing",
            "at given J0 the zone shrinks as 1/l and 1/(Kx Ky)^¼; of a rod, whose J0 grows as l³, as l^(−5/2)",
            f"1.1 l at the same J0: width {ratio:.4f} times (1/1.1 = {1 / 1.1:.4f})",
        ),
    )


def _sum_zone(one: MisalignedShaft) -> TiltRange:
    """The sum zone as the first order sees it."""
    middle = paper.averaged(one).middle
    (found,) = zones(one, 0.98 * middle, 1.02 * middle, Model(paper.without_circulation), 40)
    return found


def _simple(which: int) -> float:
    model = Model(lambda turned, tilt: small_angle_part(turned, sine=1.0, cosine=0.0, constant=0.0))
    one = replace(STILL, polar=0.0)
    return float(growth(one, np.array([np.sqrt(one.square[which])]), model).rate[0])


def _figures() -> tuple[Misprint, ...]:
    return (
        Misprint(
            "example",
            "`w20² = 3.563e3`",
            "3.563e2",
            "w20 = 18.875 rad/s is printed next to it as 18.876",
        ),
        Misprint(
            "example",
            "`kappa = 3.96e-5`",
            f"1.5 R²/l² = {1.5 * (RADIUS / SHAFT.length) ** 2:.4g}; 3 % apart. All numbers here take it as printed",
            "J0 = m l²/3 of the same rod agrees as printed",
        ),
        Misprint("example", "unit of C", "N s/m", "C11 = 0.00172 follows with C = 1e-3 N s/m"),
    )


def _conclusions() -> tuple[Misprint, ...]:
    rate = growth(SHAFT, SPEEDS).rate
    without = growth(STILL, SPEEDS, Model(paper.without_circulation)).rate
    free = growth(STILL, np.array([4.0, 10.0, 15.0, 24.0, 28.0])).rate
    found = paper.averaged(STILL).growth(SPEEDS)
    linear = growth(STILL, SPEEDS, SMALL_ANGLE).rate
    (most,) = growth(SHAFT, np.array([6.908795]), EXACT).rate[:1]
    none = growth(SHAFT, np.array([6.908795]), Model(paper.without_circulation)).rate[0]
    return (
        Misprint(
            "stability at 26.2 rad/s, C = 1e-3",
            "stable",
            f"unstable: growth {rate[1]:+.8f} 1/s, e-fold in {1 / rate[1]:.0f} s; figure 5 ends too early to show it",
            "monodromy and Hill's matrix; integration over 300 s",
        ),
        Misprint(
            "stability at 26.2 rad/s, C = 0",
            "unstable, by criterion (20)",
            "unstable, but (20) says stable: the growth comes from the constant part E2, which is circulatory and "
            "which the first order drops",
            f"without E2 the growth at 26.2 is {0.0 if without[1] < 1e-9 else without[1]:g}; second order "
            f"`s² = G²(1 − j eta)² − sigma²/4`, eta = T0/(J0 (w10² − w20²)), gives {found[0]:.4f} and "
            f"{found[1]:.4f} 1/s where Floquet's theory gives {linear[0]:.4f} and {linear[1]:.4f}",
        ),
        Misprint(
            "boundaries without damping",
            "the zone of (20) is bounded",
            "with E2 and without damping there is none: every speed is unstable",
            f"growth at 4, 10, 15, 24 and 28 rad/s: {', '.join(f'{one:.1e}' for one in free)} 1/s",
        ),
        Misprint(
            "conclusion 2",
            "the difference type is never unstable",
            "unstable from 6.624738108 to 7.183318193 rad/s, by E2 again",
            f"growth {most:.8f} 1/s at 6.908795 rad/s; without E2 {none:.4f} 1/s, which is the bearing's decay",
        ),
    )
