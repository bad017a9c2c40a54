"""Samples at equal angles as harmonic components of the angle: Hann's window over some revolutions, and its spectrum.

With N samples x at angles a + 2 pi k/M, M to a revolution, and w = 1 - cos(2 pi k/N), the phasor of an order o is
    X(o) = 2/N sum w x exp(-i o angle)   (half of it for the mean, o = 0),
which of A cos(b angle + phase) is A exp(i phase) H(o - b) + A exp(-i phase) H(o + b), turned by the angle at the middle
of the window; H(0) = 1, and H vanishes at all multiples of 1/(revolutions) from the second on (Harris 1978).
"""

from collections.abc import Callable

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.sources import source

ROUNDS = 60  # of Newton's method within brackets, which halve
SETTLED = 1e-13  # of the whole angle


@source("Harris1978")
def hann(count: int) -> FloatArray:
    """(count,) of mean 1.

    >>> hann(4).round(12).tolist()
    [0.0, 1.0, 2.0, 1.0]
    """
    return np.asarray(1.0 - np.cos(2.0 * np.pi * np.arange(count) / count))


def phasors(values: FloatArray, first: FloatArray, revolutions: int, highest: int) -> ComplexArray:
    """(windows, highest + 1) of the orders 0, 1/revolutions, 2/revolutions ..

    values: (windows, samples). first: (windows,) rad, the angle at the begin of each window.
    """
    count = values.shape[1]
    spectrum = np.fft.rfft(values * hann(count), axis=1)[:, : highest + 1] * (2.0 / count)
    spectrum[:, 0] /= 2.0
    return np.asarray(
        spectrum * np.exp(-1j * np.multiply.outer(first, np.arange(highest + 1) / revolutions))
    )


def phasors_of(
    values: FloatArray, first: FloatArray, revolutions: int, orders: FloatArray
) -> ComplexArray:
    """(windows, orders) of any orders above 0."""
    count = values.shape[1]
    angle = 2.0 * np.pi * revolutions * np.arange(count) / count
    turned = np.exp(-1j * np.multiply.outer(angle, orders))
    return np.asarray(
        (values * hann(count))
        @ turned
        * (2.0 / count)
        * np.exp(-1j * np.multiply.outer(first, orders))
    )


def times_at(
    angle: FloatArray,
    time: FloatArray,
    sampled: FloatArray,
    turned: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
) -> tuple[FloatArray, FloatArray]:
    """Times (s) at which a rising angle has values that ascend, and speeds there: both (angles,).

    By Newton's method, halving where it leaves its bracket.

    time, sampled: samples of the angle, which rise. turned: angle and speed at times that ascend.
    """
    left = np.clip(np.searchsorted(sampled, angle, side="right") - 1, 0, len(time) - 2)
    low, high = time[left].copy(), time[left + 1].copy()
    share = (angle - sampled[left]) / (sampled[left + 1] - sampled[left])
    times = low + np.clip(share, 0.0, 1.0) * (high - low)
    near = SETTLED * float(np.abs(sampled).max())
    for _ in range(ROUNDS):
        reached, speed = turned(times)
        late = reached - angle
        if (np.abs(late) <= near).all():
            break
        low, high = np.where(late <= 0.0, times, low), np.where(late >= 0.0, times, high)
        step = np.divide(late, speed, out=np.full(len(late), np.inf), where=speed > 0.0)
        better = times - step
        inside = (better >= low) & (better <= high)
        times = np.maximum.accumulate(np.where(inside, better, (low + high) / 2.0))
    return times, speed
