"""The lumped calculation of the pump train in its own steps: matrices, complex amplitudes, time, section torques.

All equations of the article are missing in the available copy; (1) to (18) are restored from its text.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class Chain:
    """(1): discs in a row; all figures of one speed."""

    inertia: Array  # (discs,) kg m^2
    ground: Array  # (discs,) N m s/rad to ground
    stiffness: Array  # (discs - 1,) N m/rad
    viscous: Array  # (discs - 1,) N m s/rad
    moment: ComplexArray  # (discs,) N m: (6), (7)

    def matrices(self) -> tuple[Array, Array, Array]:
        """(2) to (4): [J] diagonal, [C] = diagonal + band, [K] band."""
        return (
            np.diag(self.inertia),
            np.diag(self.ground) + band(self.viscous),
            band(self.stiffness),
        )


def band(values: Array) -> Array:
    """Matrix of links between neighbours, (discs, discs)."""
    twist = np.diff(np.eye(values.size + 1), axis=0)
    result: Array = twist.T @ (values[:, None] * twist)
    return result


def complex_steps(chain: Chain, w: float) -> ComplexArray:
    """(8) to (11): [R*] A* = M*, [R*] = [K] - w^2 [J] + i w [C]."""
    inertia, damping, stiffness = chain.matrices()
    return np.linalg.solve(stiffness - w * w * inertia + 1j * w * damping, chain.moment)


def real_steps(chain: Chain, w: float) -> ComplexArray:
    """(12) to (15): the same as twice as many real equations, [[Rc, -Rs], [Rs, Rc]] {Ac; Ai} = {Mc; Mi}."""
    inertia, damping, stiffness = chain.matrices()
    cosine, sine = stiffness - w * w * inertia, w * damping
    whole = np.block([[cosine, -sine], [sine, cosine]])
    answer = np.linalg.solve(whole, np.concatenate((chain.moment.real, chain.moment.imag)))
    size = chain.inertia.size
    return answer[:size] + 1j * answer[size:]


def in_time(amplitude: ComplexArray, w: float, time: Array) -> tuple[Array, Array, Array]:
    """(16) and its two derivatives, (discs, times): angle A_c cos wt - A_i sin wt."""
    turning = amplitude[:, None] * np.exp(1j * w * time)
    return turning.real, (1j * w * turning).real, (-w * w * turning).real


def imbalance(chain: Chain, amplitude: ComplexArray, w: float, time: Array) -> float:
    """What (1) lacks when (16) is put into it, relative to the largest term of each disc."""
    inertia, damping, stiffness = chain.matrices()
    angle, speed, gain = in_time(amplitude, w, time)
    acting = (chain.moment[:, None] * np.exp(1j * w * time)).real
    terms = (
        np.abs(inertia) @ np.abs(gain)
        + np.abs(damping) @ np.abs(speed)
        + np.abs(stiffness) @ np.abs(angle)
    )
    lack = inertia @ gain + damping @ speed + stiffness @ angle - acting
    return float((np.abs(lack).max(axis=1) / terms.max(axis=1)).max())


def section_printed(chain: Chain, amplitude: ComplexArray) -> Array:
    """(18): K |A*_k - A*_(k+1)|, the elastic share alone, N m."""
    return chain.stiffness * np.abs(np.diff(amplitude))


def section_right(chain: Chain, amplitude: ComplexArray, w: float) -> Array:
    """The whole torque of a section, |(K + i w C)(A*_k - A*_(k+1))|, N m."""
    return np.abs((chain.stiffness + 1j * w * chain.viscous) * np.diff(amplitude))


def central_differences(chain: Chain, shape: Array, step: float, count: int = 200) -> float:
    """Growth of the undamped chain by explicit central differences, started at rest in a mode's shape (discs,)."""
    before, now, largest = shape, shape, np.abs(shape).max()
    matrix = band(chain.stiffness) / chain.inertia[:, None]
    for _ in range(count):
        before, now = now, 2.0 * now - before - step * step * (matrix @ now)
        largest = max(largest, np.abs(now).max())
    return float(largest / np.abs(shape).max())
