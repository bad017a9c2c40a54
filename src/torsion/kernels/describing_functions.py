"""Mean and fundamental of the torque of a piecewise linear coupling that a cosine twists about a mean.

A spring that begins at a twist b carries k max(u - b, 0). Of u = u0 + A cos(phi) the ramp max(u - b, 0) is above zero
while |phi| < theta, cos(theta) = -(u0 - b)/A; its mean is A (sin - theta cos)/pi, its fundamental A share,
share = (theta - sin cos)/pi (T115a). Damping that acts in contact has the same share of its own fundamental.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.bracketed_search import find_root
from torsion.sources import source

SMALL = 1.0  # rad, below which sin(theta) - theta cos(theta) is a series; ten terms err by 21/23! = 8e-22
SERIES = [(-1.0) ** (n + 1) * 2 * n / math.factorial(2 * n + 1) for n in range(1, 11)]
BEYOND_ROUNDING = 1.0 + 1e-12  # times a bound that may be the solution itself
OPEN = 1e-12  # share of its stiffness that stands for a spring without contact: any smaller changes nothing


def ramp(offset: FloatArray, amplitude: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the mean of max(offset + A cos, 0), its fundamental / A, and the share of time above zero; amplitude > 0.

    >>> [float(one.round(15)) for one in ramp(np.array(0.0), np.array(2.0))]
    [0.636619772367581, 0.5, 0.5]
    """
    below, above = (
        np.clip((amplitude + side * offset) / amplitude, 0.0, 2.0) for side in (1.0, -1.0)
    )
    moment, share, time = _above_zero(below, above)
    always_above = above == 0.0
    mean = np.where(always_above, offset, amplitude * moment)
    return mean, np.where(always_above, 1.0, share), np.where(always_above, 1.0, time)


def _above_zero(below: FloatArray, above: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(sin - theta cos)/pi, (theta - sin cos)/pi and theta/pi of 1 - cos(theta) = `below` and 1 + cos(theta)."""
    theta, sine = 2.0 * np.arctan2(np.sqrt(below), np.sqrt(above)), np.sqrt(below * above)
    cosine, square = (above - below) / 2.0, np.minimum(theta, SMALL) ** 2
    moment, small = sine - theta * cosine, theta < SMALL
    if small.any():
        moment = np.where(small, theta * square * polyval(square, SERIES), moment)
    return moment / math.pi, (theta * sine**2 - cosine * moment) / math.pi, theta / math.pi


@source("Caughey1960")
def slider(
    amplitude: FloatArray, torque: float, stiffness: float, half: float = 0.0
) -> ComplexArray:
    """Return (amplitudes,) N m/rad of a spring in series with a slider, behind a play of `half` rad to either side.

    Half a cycle from the largest twist on is torque - k (min(d, e1) - min(d, e2) + min(d, e3)), d = A (1 - cos(phi)).

    >>> slider(np.array([1e-3]), 5.0, 5e4).round(3).tolist()
    [(2602.201+5729.578j)]
    """
    slips = amplitude > half + torque / stiffness
    moved = np.where(slips, amplitude, half + torque / stiffness)
    give = torque / stiffness
    ends = ((give, 1.0), (give + 2.0 * half, -1.0), (2.0 * give + 2.0 * half, 1.0))
    stored = sum(sign * _above_zero(end / moved, 2.0 - end / moved)[1] for end, sign in ends)
    lost = 4.0 * give / (math.pi * moved) * (moved - half - give) / moved
    touches = 2.0 * ramp(np.full(len(amplitude), -half), amplitude)[1] if half else 1.0
    return np.where(slips, stiffness * (stored + 1j * lost), stiffness * touches)


@dataclass(frozen=True)
class Slider:
    """A spring in series with a slider, behind a play that slipping carries along."""

    torque: float  # N m
    stiffness: float  # N m/rad
    half: float = 0.0  # rad


@dataclass(frozen=True)
class Secant:
    """What a coupling is at the fundamental: a share of its own spring and damper, and a stiffness beside it."""

    share: FloatArray  # (columns,)
    extra: ComplexArray  # (columns,) N m/rad

    @property
    def is_linear(self) -> bool:
        """Nothing but its own spring and damper."""
        return bool((self.share == 1.0).all() and not self.extra.any())


@dataclass(frozen=True)
class PiecewiseCoupling:
    """Own spring beyond half its play, further springs beyond a twist to either side, sliders about the mean twist."""

    stiffness: float  # N m/rad, > 0
    half: float = 0.0  # rad
    stages: tuple[tuple[float, float], ...] = ()  # rad, N m/rad
    sliders: tuple[Slider, ...] = ()

    @property
    def springs(self) -> tuple[tuple[float, float], ...]:
        """Begin (rad) and stiffness (N m/rad), the own first."""
        return (self.half, self.stiffness), *self.stages

    @property
    def scale(self) -> float:
        """rad, the largest twist at which something begins."""
        return max(
            *(begin for begin, _ in self.springs),
            *(dry.half + dry.torque / dry.stiffness for dry in self.sliders),
            0.0,
        )

    @property
    def stuck(self) -> float:
        """N m/rad of the sliders beside the own spring at a very small amplitude."""
        return sum(dry.stiffness for dry in self.sliders if not dry.half)

    @property
    def lasting(self) -> float:
        """N m/rad beside the own spring at a very large amplitude."""
        return sum(stiffness for _, stiffness in self.stages)

    @property
    def offset(self) -> float:
        """N m by which the fundamental differs at most from that of `lasting`, whatever the amplitude."""
        springs = 2.0 * sum(begin * stiffness for begin, stiffness in self.springs)
        return springs + 2.0 * sum(dry.torque for dry in self.sliders)

    def static(self, mean: FloatArray) -> FloatArray:
        """Return (columns,) rad under mean torques (columns,) N m >= 0 alone; 0 under none."""
        return self.bias(np.full(len(mean), 1e-30), mean)

    def first(self, mean: FloatArray) -> FloatArray:
        """Return (columns,) rad, the smallest amplitude at which the coupling ceases to be linear about its mean twist."""
        mean_twist = self.static(mean)
        slips = [dry.half or dry.torque / dry.stiffness for dry in self.sliders]
        first = np.full(len(mean_twist), min(slips, default=np.inf))
        for begin, _ in self.springs:
            if begin:
                first = np.minimum(first, np.abs(begin - mean_twist))
        return first

    def bias(self, amplitude: FloatArray, mean: FloatArray) -> FloatArray:
        """Return (columns,) rad, the mean twist at which the mean torque (columns,) N m >= 0 is carried; 0 for none."""
        total = sum(stiffness for _, stiffness in self.springs)
        if not (self.half or self.stages):
            return mean / total
        # No spring carries more than without its begin, nor less than while it is in contact all the time.
        lost = sum(begin * stiffness for begin, stiffness in self.springs)
        loaded = np.flatnonzero(mean > 0.0)
        torque, amplitudes = mean[loaded], amplitude[loaded]

        def excess(mean_twist: FloatArray) -> FloatArray:
            carried = -torque
            for begin, stiffness in self.springs:
                turned = mean_twist
                if begin:
                    above, below = _both_sides(mean_twist, begin, amplitudes)[0]
                    turned = above - below
                carried = carried + stiffness * turned
            return carried

        twist = np.zeros(len(mean))
        twist[loaded] = find_root(
            excess,
            torque / total / BEYOND_ROUNDING,
            (torque + lost) / total * BEYOND_ROUNDING,
        )
        return twist

    def secant(self, amplitude: FloatArray, mean: FloatArray) -> Secant:
        """Return the secant of amplitudes (columns,) rad > 0 and mean torques (columns,) N m >= 0."""
        mean_twist = self.bias(amplitude, mean)
        share = np.ones(len(amplitude))
        if self.half:
            share = np.maximum(_both_sides(mean_twist, self.half, amplitude)[1].sum(axis=0), OPEN)
        extra = np.zeros(len(amplitude), dtype=complex)
        for begin, stiffness in self.stages:
            extra += stiffness * _both_sides(mean_twist, begin, amplitude)[1].sum(axis=0)
        for dry in self.sliders:
            extra += slider(amplitude, dry.torque, dry.stiffness, dry.half)
        return Secant(share, extra)


def _both_sides(
    mean_twist: FloatArray, begin: float, amplitude: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """As `ramp`, (2, columns) each, of a spring that begins at a twist to either side."""
    return ramp(np.array([mean_twist - begin, -mean_twist - begin]), amplitude)
