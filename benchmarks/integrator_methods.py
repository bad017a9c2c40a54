"""The step-by-step methods of the textbooks for M u'' + C u' + K u = f, each as one linear map of a step.

A method is a function of the matrices and the step h that gives what advances displacement, speed and acceleration
(n, columns) under the torques at both ends of the step. They are compared with the exact motion, and `quality`
says what they do to an undamped oscillator: period, amplitude, stability. Sources:
Newmark (1959); Wilson (1973), theta 1.4; Hilber, Hughes and Taylor (1977), alpha -0.1; Chung and Hulbert (1993), radius
0.8; Bathe and Baig (2005), halves; Houbolt (1950); Zhong (1994), 2**20 parts of a step.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from torsion.arrays import FloatArray

Matrix = FloatArray
State = tuple[Matrix, Matrix, Matrix]
Step = Callable[
    [Matrix, Matrix, Matrix, Matrix, Matrix], State
]  # u, v, a, torques at the begin and at the end
Method = Callable[[Matrix, Matrix, Matrix, float], Step]


def alpha_method(mass: float, force: float, beta: float, gamma: float) -> Method:
    """Newmark's formulas, inertia and the other torques taken at shares `mass` and `force` before the end of a step."""

    def method(M: Matrix, C: Matrix, K: Matrix, h: float) -> Step:
        lu = lu_factor((1 - mass) * M + (1 - force) * (gamma * h * C + beta * h * h * K))

        def step(u: Matrix, v: Matrix, a: Matrix, before: Matrix, after: Matrix) -> State:
            u1, v1 = u + h * v + h * h * (0.5 - beta) * a, v + h * (1 - gamma) * a
            acting = (1 - force) * (after - C @ v1 - K @ u1) + force * (before - C @ v - K @ u)
            a1 = lu_solve(lu, acting - mass * (M @ a))
            return u1 + beta * h * h * a1, v1 + gamma * h * a1, a1

        return step

    return method


def central_differences(M: Matrix, C: Matrix, K: Matrix, h: float) -> Step:
    """As velocity Verlet; the damping torque with the speed at the end."""
    lu = lu_factor(M + h / 2 * C)

    def step(u: Matrix, v: Matrix, a: Matrix, before: Matrix, after: Matrix) -> State:
        u1 = u + h * v + h * h / 2 * a
        a1 = lu_solve(lu, after - K @ u1 - C @ (v + h / 2 * a))
        return u1, v + h / 2 * (a + a1), a1

    return step


def wilson(M: Matrix, C: Matrix, K: Matrix, h: float, theta: float = 1.4) -> Step:
    """Linear acceleration over theta h, of which the step takes h."""
    t = theta * h
    lu = lu_factor(M + t / 2 * C + t * t / 6 * K)

    def step(u: Matrix, v: Matrix, a: Matrix, before: Matrix, after: Matrix) -> State:
        acting = before + theta * (after - before)
        late = lu_solve(lu, acting - C @ (v + t / 2 * a) - K @ (u + t * v + t * t / 3 * a))
        a1 = a + (late - a) / theta
        return u + h * v + h * h / 6 * (2 * a + a1), v + h / 2 * (a + a1), a1

    return step


def bathe(M: Matrix, C: Matrix, K: Matrix, h: float) -> Step:
    """Half a step of the trapezoidal rule, then a three-point backward difference: two solutions a step."""
    first, second = (lu_factor(m / h**2 * M + c / h * C + K) for m, c in ((16, 4), (9, 3)))

    def step(u: Matrix, v: Matrix, a: Matrix, before: Matrix, after: Matrix) -> State:
        inertia, damping = 16 / h**2 * u + 8 / h * v + a, 4 / h * u + v
        half = lu_solve(first, (before + after) / 2 + M @ inertia + C @ damping)
        there = 4 / h * (half - u) - v
        inertia = 12 / h**2 * half - 3 / h**2 * u + 4 / h * there - v / h
        u1 = lu_solve(second, after + M @ inertia + C @ (4 / h * half - u / h))
        v1 = (u - 4 * half + 3 * u1) / h
        return u1, v1, (v - 4 * there + 3 * v1) / h

    return step


def houbolt(M: Matrix, C: Matrix, K: Matrix, h: float) -> Step:
    """Cubic through four displacements: those of three steps stand in the place of u, v and a."""
    lu = lu_factor(2 / h**2 * M + 11 / (6 * h) * C + K)

    def step(u: Matrix, v: Matrix, a: Matrix, before: Matrix, after: Matrix) -> State:
        acting = after + M @ (5 * u - 4 * v + a) / h**2 + C @ (3 * u - 1.5 * v + a / 3) / h
        return lu_solve(lu, acting), u, v

    return step


def runge_kutta(M: Matrix, C: Matrix, K: Matrix, h: float) -> Step:
    """Of fourth order."""
    lu = lu_factor(M)

    def rate(u: Matrix, v: Matrix, torque: Matrix) -> tuple[Matrix, Matrix]:
        return v, lu_solve(lu, torque - C @ v - K @ u)

    def step(u: Matrix, v: Matrix, a: Matrix, before: Matrix, after: Matrix) -> State:
        middle = (before + after) / 2
        k1, l1 = rate(u, v, before)
        k2, l2 = rate(u + h / 2 * k1, v + h / 2 * l1, middle)
        k3, l3 = rate(u + h / 2 * k2, v + h / 2 * l2, middle)
        k4, l4 = rate(u + h * k3, v + h * l3, after)
        return u + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), v + h / 6 * (l1 + 2 * l2 + 2 * l3 + l4), a

    return step


def precise_integration(M: Matrix, C: Matrix, K: Matrix, h: float, doublings: int = 20) -> Step:
    """exp(A h) less 1 by doublings of a Taylor series over h / 2**20; the torque is linear in the step."""
    n, lu = len(M), lu_factor(M)
    one = np.eye(n)
    A = np.zeros((4 * n, 4 * n))  # u, v, torque, its slope
    A[:n, n : 2 * n], A[2 * n : 3 * n, 3 * n :] = one, one
    A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n], A[n : 2 * n, 2 * n : 3 * n] = (
        -lu_solve(lu, X) for X in (K, C, -one)
    )
    part = A * (h / 2**doublings)
    grown = part + part @ part / 2 + part @ part @ part / 6 + part @ part @ part @ part / 24
    with np.errstate(all="ignore"):
        for _ in range(doublings):
            grown = 2 * grown + grown @ grown
    grown = grown + np.eye(4 * n)

    def step(u: Matrix, v: Matrix, a: Matrix, before: Matrix, after: Matrix) -> State:
        found = grown[: 2 * n] @ np.concatenate([u, v, before, (after - before) / h])
        return found[:n], found[n:], a

    return step


METHODS: dict[str, Method] = {  # by their titles in the report
    "central differences": central_differences,
    "Newmark 1/4, 1/2": alpha_method(0.0, 0.0, 0.25, 0.5),
    "linear acceleration": alpha_method(0.0, 0.0, 1.0 / 6.0, 0.5),
    "Wilson": wilson,
    "HHT": alpha_method(0.0, 0.1, 1.1**2 / 4.0, 0.6),
    "generalised alpha": alpha_method(1.0 / 3.0, 4.0 / 9.0, (10.0 / 9.0) ** 2 / 4.0, 11.0 / 18.0),
    "Bathe": bathe,
    "Houbolt": houbolt,
    "Runge-Kutta 4": runge_kutta,
    "precise integration": precise_integration,
}


@dataclass(frozen=True)
class Marching:
    """A method for one train and one step: state' = matrix state + torques at both ends."""

    matrix: Matrix  # (3 n, 3 n)
    torque: tuple[Matrix, Matrix]  # (3 n, n) of the torques at the begin, and at the end

    def histories(self, before: Matrix, after: Matrix, start: FloatArray | None = None) -> Matrix:
        """(steps + 1, 3 n) states under torques (steps, n) at both ends of every step; from rest, or from `start`."""
        push = before @ self.torque[0].T + after @ self.torque[1].T
        state = np.zeros(len(self.matrix)) if start is None else start
        found = np.empty((len(push) + 1, len(self.matrix)))
        found[0] = state
        with np.errstate(all="ignore"):
            for place, one in enumerate(push, start=1):
                state = self.matrix @ state + one
                found[place] = state
        return found


def marching(method: Method, M: Matrix, C: Matrix, K: Matrix, h: float) -> Marching:
    """The map of a step, column by column of what enters it."""
    n = len(M)
    step, each = method(M, C, K, h), np.eye(5 * n)
    columns = np.concatenate(step(*(each[k * n : (k + 1) * n] for k in range(5))))
    return Marching(columns[:, : 3 * n], (columns[:, 3 * n : 4 * n], columns[:, 4 * n :]))


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
