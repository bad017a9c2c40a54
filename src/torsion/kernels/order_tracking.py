"""Orders of a measured rotation: complex amplitudes of the angle, window by window, fitted in the domain of the angle.

Over a window the mean rotation is a polynomial of time and every order an exponential of the angle of that mean
rotation, so that a run-up smears nothing. All of it is one weighted least-squares problem of the samples as they are;
no sample is interpolated.
"""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray

DEGREE = 5  # of the mean angle over a window
ROUNDS = 12  # of placing the samples by the angle of the mean rotation
SETTLED = 1e-11  # rad, of that angle
LOST = 1.6  # of the interval that `NEAR` on either side say: a lost pulse makes 2, one too many two of some 1/2
NEAR = 3
BESIDE = np.array(
    [-6.0, -5.0, -4.0, -3.0, -2.0, 2.0, 3.0, 4.0, 5.0, 6.0]
)  # cycles over a window from a fitted order
FREE = 2.0  # cycles from these to other half orders
LEAST_SAMPLES = 4  # of a window for each unknown of an order


@dataclass(frozen=True)
class Tracked:
    """Orders of every window."""

    speed: FloatArray  # (windows,) rad/s, mean rotation in the middle of the window
    angle: ComplexArray  # (windows, orders) rad, amplitude over the angle of the mean rotation; of speeds any phase
    error: FloatArray  # (windows, orders) rad, standard deviation of each part, by what is left beside it
    # within half an order; 0 of windows that are too short for that, below 8 revolutions


def uneven(time: FloatArray) -> int | None:
    """The first pulse behind an interval unlike those around it, as where one is lost; None where there is none.

    An interval is compared with the geometric mean of the medians on both sides, which follows a run-up; near an end
    with what two medians beside it say at a constant acceleration, from rest too.

    >>> uneven(np.array([0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 7.0, 8.0, 9.0]))
    5
    >>> uneven(np.array([0.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]))
    1
    """
    intervals = np.diff(time)
    if intervals.size < 2 * NEAR + 1:
        return None
    side = np.median(np.lib.stride_tricks.sliding_window_view(intervals, NEAR), axis=1)
    share = np.ones(intervals.size)
    share[NEAR:-NEAR] = intervals[NEAR:-NEAR] / np.sqrt(side[: -NEAR - 1] * side[NEAR + 1 :])
    for interval, medians, ratio in (
        (intervals, side, share),
        (intervals[::-1], side[::-1], share[::-1]),
    ):
        for k in range(min(NEAR, medians.size - NEAR - 1)):
            near, far = (
                medians[[k + 1, k + 1 + NEAR]] ** -2.0
            )  # squares of speeds, which rise evenly with the angle
            square = near - (far - near) * (NEAR + 1) / (2.0 * NEAR)
            ratio[k] = interval[k] * np.sqrt(square) if square > 0.0 else 1.0

    # One at an end only where all between are alike.
    wrong = np.flatnonzero((share > LOST) | (share < 1.0 / LOST))
    inside = wrong[(wrong >= NEAR) & (wrong < share.size - NEAR)]
    first = inside if inside.size else wrong
    return int(first[0]) + 1 if first.size else None


def of_pulses(time: FloatArray, pulses: int, orders: FloatArray, revolutions: int) -> Tracked:
    """Of the times (pulses,) s at which a disc of so many even marks a revolution passes a probe.

    orders: (orders,) per revolution of that shaft, below half the number of marks. Raises ValueError where a window has
    too few samples.

    >>> angle = 2 * np.pi * np.arange(60 * 12) / 60  # of the marks, at 100 rad/s with 0.01 rad of order 2
    >>> time = angle / 100
    >>> for _ in range(30):
    ...     time = (angle - 0.01 * np.cos(2 * 100 * time)) / 100
    >>> abs(of_pulses(time, 60, np.array([2.0]), 6).angle).ravel().round(9)
    array([0.01, 0.01])
    """
    angle: FloatArray = 2.0 * np.pi / pulses * np.arange(len(time), dtype=float)
    return _tracked(time, angle, angle, orders, revolutions)


def of_speeds(time: FloatArray, speed: FloatArray, orders: FloatArray, revolutions: int) -> Tracked:
    """Of samples (samples,) rad/s of the speed at times (samples,) s; raises ValueError as `of_pulses` does."""
    steps = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time)
    return _tracked(
        time, np.concatenate([[0.0], np.cumsum(steps)]), speed, orders, revolutions, derived=True
    )


def _tracked(
    time: FloatArray,
    angle: FloatArray,
    values: FloatArray,
    orders: FloatArray,
    revolutions: int,
    *,
    derived: bool = False,
) -> Tracked:
    # Every whole window of so many revolutions.
    turned = (angle - angle[0]) / (2.0 * np.pi * revolutions) * (1.0 + 1e-12)
    number, windows = np.floor(turned).astype(int), []
    for window in range(int(turned[-1] * len(turned) / (len(turned) - 1))):
        part = np.flatnonzero(number == window)
        if part.size < DEGREE + 1 + 2 * LEAST_SAMPLES * len(orders):
            message = f"{part.size} samples of {revolutions} revolutions are too few for {len(orders)} orders"
            raise ValueError(message)
        windows.append(_window(time[part], values[part], orders, revolutions, derived))
    speed, angle, error = (np.array([window[k] for window in windows]) for k in range(3))
    shape = -1, len(orders)
    return Tracked(speed, angle.astype(np.complex128).reshape(shape), error.reshape(shape))


def _window(
    time: FloatArray, values: FloatArray, orders: FloatArray, revolutions: int, derived: bool
) -> tuple[float, ComplexArray, FloatArray]:
    """Mean speed in the middle, and of every order (orders,) its amplitude and the error of that.

    Unknowns are the coefficients of the mean angle and both parts of every order. Of speeds the derivative of the model
    is fitted. The angle of the mean rotation, over which the orders run, is that of the fit before.
    """
    middle, half = 0.5 * (time[0] + time[-1]), 0.5 * (time[-1] - time[0])
    u = (time - middle) / half
    share = np.gradient(u)  # of the window, so that sums of samples that lie unevenly are integrals
    weight = np.cos(0.5 * np.pi * u * len(u) / (len(u) + 1.0)) * np.sqrt(
        share
    )  # its square is Hann's window
    near = BESIDE[np.abs(BESIDE) + FREE <= 0.5 * revolutions] / revolutions
    nearby = np.abs(orders[:, None] + near).ravel()
    powers = np.polynomial.polynomial.polyvander(u, DEGREE)
    slopes = np.zeros_like(powers)
    slopes[:, 1:] = powers[:, :-1] * np.arange(1, DEGREE + 1) / half
    rows = slopes[:, 1:] if derived else powers
    smooth = _weighted_least_squares(rows, values, weight)
    mean = np.concatenate([[0.0], smooth]) if derived else smooth
    for _ in range(ROUNDS):
        turned, before = powers @ mean, mean
        carrier = np.exp(1j * turned[:, None] * np.append(orders, nearby))
        if derived:
            carrier = carrier * (1j * np.append(orders, nearby) * (slopes @ mean)[:, None])
        carrier, neighbours = carrier[:, : len(orders)], carrier[:, len(orders) :]
        model = np.hstack([rows, carrier.real, -carrier.imag])
        solution = _weighted_least_squares(model, values, weight)
        mean = np.concatenate([[0.0], solution[:DEGREE]]) if derived else solution[: DEGREE + 1]
        if np.abs(powers @ (mean - before)).max() < SETTLED:
            break
    parts, square = solution[rows.shape[1] :], weight**2
    left = square * (values - model @ solution)
    size = 2.0 * np.abs(left @ neighbours.conj()) / (square @ np.abs(neighbours) ** 2)
    error = np.sqrt(
        np.square(size).reshape(len(orders), -1).sum(axis=1) / (2.0 * max(1, len(near)))
    )
    return float(mean[1] / half), parts[: len(orders)] + 1j * parts[len(orders) :], error


def _weighted_least_squares(rows: FloatArray, values: FloatArray, weight: FloatArray) -> FloatArray:
    """Weighted least squares, the columns scaled alike."""
    size = np.sqrt(np.square(rows).sum(axis=0))
    solution, *_ = np.linalg.lstsq(rows / size * weight[:, None], values * weight, rcond=None)
    return np.asarray(solution / size)
