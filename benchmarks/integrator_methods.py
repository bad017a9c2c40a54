"""What the step-by-step methods of the textbooks do to an undamped oscillator: period, amplitude, stability."""

from dataclasses import dataclass

import numpy as np

from torsion.kernels.transient import integrator_methods as known
from torsion.kernels.transient.integrator_methods import (
    Method,
    marching,
    precise_integration,
    runge_kutta,
)

METHODS: dict[str, Method] = {title: known.METHODS[name] for name, title in known.TITLES.items()}


@dataclass(frozen=True)
class Quality:
    """Of an undamped oscillator of period T at one step."""

    elongation: float  # of the period, relative
    decay: float  # of the amplitude in a period, relative
    radius: float  # of the amplification matrix


def quality(method: Method, ratio: float) -> Quality:
    """At h/T = ratio, from the eigenvalues of the amplification matrix; NaN where it does not oscillate."""
    one, w = np.ones((1, 1)), 2.0 * np.pi
    matrix = marching(method, one, 0.0 * one, w * w * one, ratio).matrix
    size = (
        2 if method in (runge_kutta, precise_integration) else 3
    )  # without an acceleration that only stays
    values = np.linalg.eigvals(matrix[:size, :size])
    moving = values[np.abs(values.imag) > 1e-12]
    if not moving.size:
        return Quality(np.nan, np.nan, float(np.abs(values).max()))
    main = moving[np.argmin(np.abs(np.abs(np.angle(moving)) - w * ratio))]
    turn = abs(np.angle(main))
    with np.errstate(over="ignore"):
        decay = 1.0 - abs(main) ** (2.0 * np.pi / turn)
    return Quality(w * ratio / turn - 1.0, float(decay), float(np.abs(values).max()))


def stable_to(method: Method) -> float:
    """h/T up to which no oscillation grows; infinite where none does at any step."""
    if quality(method, 1e3).radius <= 1.0 + 1e-6:
        return np.inf
    low, high = 1e-3, 10.0
    for _ in range(60):
        middle = (low * high) ** 0.5
        low, high = (
            (middle, high) if quality(method, middle).radius <= 1.0 + 1e-6 else (low, middle)
        )
    return low
