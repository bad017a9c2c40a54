"""A motor start of ten discs, error against run time: `python -m benchmarks.motor_start` writes reports/motor_start.md.

Exponential collocation next to the integrators of scipy, which work on the same certified modes in well-scaled
coordinates (speeds, and frequencies times places) and, where they are implicit, with the exact Jacobian.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.page_file import Report
from torsion.arrays import FloatArray
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.motion import torque_laws as laws
from torsion.kernels.motion.collocation import Scheme, march
from torsion.kernels.motion.loaded_modes import LoadedModes, ModalTrain, Piece
from torsion.kernels.motion.march import March
from torsion.kernels.trees.tree import Tree

DURATION, PATIENCE = 2.0, 60.0  # s of the motion; s after which a run is given up
SYNCHRONOUS, PULL_OUT, SLIP, LOAD, LINE = 50.0 * math.pi, 900.0, 0.2, 300.0, 100.0 * math.pi
PULSATION, DECAY, RATIO = 600.0, 0.15, 0.01  # N m, s, damping ratio of every mode
WHAT = f"""\
Ten discs in a free chain from rest: a motor after Kloss ({PULL_OUT:g} N m at slip {SLIP:g}, 1500 rpm) with a decaying
pulsation of 50 Hz at the first, a pump ({LOAD:g} N m at 1500 rpm, n²) at the last, {DURATION:g} s. Error: of the
torques of all springs at the end, of the largest of them. Time: of one core."""


@dataclass(frozen=True)
class Case:
    """A train by its modes, and what is known of its end."""

    name: str
    w: FloatArray  # (modes,) rad/s
    ends: FloatArray  # (2, rigid motion + modes)
    torque: FloatArray  # (springs, modes)


def cases() -> Iterator[Case]:
    """The benign train, and one of masses and stiffnesses over eight and six decades."""
    choose = np.random.default_rng(5)
    yield _case("benign", choose.uniform(0.5, 2.0, 10), choose.uniform(2e4, 1e5, 9))
    choose = np.random.default_rng(5)
    inertia = np.concatenate([[5.0], 10.0 ** choose.uniform(-6.0, 0.0, 8), [7.0]])
    yield _case("stiff", inertia, 10.0 ** choose.uniform(4.0, 12.0, 9))


def _case(name: str, inertia: FloatArray, stiffness: FloatArray) -> Case:
    number = len(inertia)
    flexibility = np.concatenate([[0.0], 1.0 / stiffness])
    found = tree_modes(
        Tree(np.arange(-1, number - 1), flexibility, inertia, np.zeros(number, dtype=bool)), None
    )
    scale = 1.0 / np.sqrt((inertia[:, None] * found.angle**2).sum(axis=0))
    shape = np.concatenate(
        [np.full((number, 1), 1.0 / math.sqrt(inertia.sum())), found.angle * scale], axis=1
    )
    return Case(name, found.frequency, shape[[0, -1]], found.torque[1:] * scale)


def collocation(case: Case, tolerance: float) -> FloatArray:
    """(springs,) N m at the end."""
    size = len(case.w) + 1
    train = ModalTrain(case.w, np.full(len(case.w), RATIO), np.zeros((size, size)))
    pulsation = Piece(0.0, math.inf, -1j * PULSATION, rate=complex(-1.0 / DECAY, LINE))
    loaded = LoadedModes(train, [(pulsation,)], case.ends[:1].T, case.ends)
    motor = laws.InductionMotor(0, PULL_OUT, SLIP, SYNCHRONOUS)
    pump = laws.BySpeed(1, laws.quadratic(-LOAD, SYNCHRONOUS))
    scheme = Scheme(DURATION, tolerance, 1e-3, DURATION / 8.0, np.ones(2))
    taken = March(loaded, DURATION, np.empty(0), np.zeros(size), np.zeros(size))
    march(taken, [motor, pump], scheme)
    moved = taken.finished(DURATION).at(np.array([DURATION]))
    return np.asarray(case.torque @ moved.position[1:, 0])


class GivenUp(Exception):
    """A run that takes too long."""


def integrated(case: Case, method: str, tolerance: float) -> FloatArray:
    """(springs,) N m at the end, by scipy."""
    number, start = len(case.w), process_time()
    every = np.concatenate([[0.0], case.w])

    def rates(t: float, x: FloatArray) -> FloatArray:
        if process_time() - start > PATIENCE:
            raise GivenUp
        v = x[number:]
        motor, pump = case.ends @ v
        s = 1.0 - motor / SYNCHRONOUS
        acting = 2.0 * PULL_OUT * SLIP * s / (s * s + SLIP**2) + PULSATION * math.exp(
            -t / DECAY
        ) * math.sin(LINE * t)
        force = case.ends[0] * acting - case.ends[1] * LOAD * pump * abs(pump) / SYNCHRONOUS**2
        elastic = np.concatenate([[0.0], case.w * x[:number]])
        return np.concatenate([case.w * v[1:], force - 2.0 * RATIO * every * v - elastic])

    def jacobian(t: float, x: FloatArray) -> FloatArray:
        found, mode = np.zeros((2 * number + 1, 2 * number + 1)), np.arange(number)
        motor, pump = case.ends @ x[number:]
        s = 1.0 - motor / SYNCHRONOUS
        slope = -2.0 * PULL_OUT * SLIP * (SLIP**2 - s * s) / (s * s + SLIP**2) ** 2 / SYNCHRONOUS
        found[mode, number + 1 + mode], found[number + 1 + mode, mode] = case.w, -case.w
        found[number:, number:] = slope * np.outer(case.ends[0], case.ends[0]) - np.diag(
            2.0 * RATIO * every
        )
        found[number:, number:] -= (
            2.0 * LOAD * abs(pump) / SYNCHRONOUS**2 * np.outer(case.ends[1], case.ends[1])
        )
        return found

    more: dict[str, Any] = {} if method == "DOP853" else {"jac": jacobian}
    found = solve_ivp(
        rates,
        (0.0, DURATION),
        np.zeros(2 * number + 1),
        method,
        rtol=tolerance,
        atol=1e-2 * tolerance,
        **more,
    )
    if not found.success:
        raise GivenUp
    return np.asarray(case.torque @ (found.y[:number, -1] / case.w))


RUNS: dict[str, list[tuple[str, list[float]]]] = {
    "benign": [
        ("DOP853", [1e-4, 1e-7, 1e-10]),
        ("LSODA", [1e-4, 1e-7, 1e-10]),
        ("Radau", [1e-4, 1e-7, 1e-9]),
    ],
    "stiff": [("DOP853", [1e-4]), ("LSODA", [1e-4, 1e-6]), ("Radau", [1e-4, 1e-7, 1e-9])],
}


def main() -> None:
    """Measures, prints the page and writes it."""
    report = Report(__doc__, "motor_start", calls=3)
    parts = [WHAT]
    for case in cases():
        method, tolerance = ("DOP853", 3e-14) if case.name == "benign" else ("Radau", 1e-11)
        exact = integrated(case, method, tolerance)
        lines = [
            f"## {case.name}: modes from {case.w[0]:.3g} to {case.w[-1]:.3g} rad/s",
            f"Reference: {method} at {tolerance:g}.",
            "",
            "| method | tolerance | error | time, s |",
            "|---|---|---|---|",
        ]
        for tolerance in (1e-4, 1e-6, 1e-8):
            lines.append(
                _line("**collocation**", case, tolerance, collocation, exact, report.chosen.calls)
            )
        for name, tolerances in RUNS[case.name]:
            for tolerance in tolerances:
                by = lambda case, tolerance, name=name: integrated(case, name, tolerance)  # noqa: E731
                lines.append(_line(name, case, tolerance, by, exact, 1))
        parts.append("\n".join(lines))
    report.publish("A motor start: error against run time", parts)


def _line(
    name: str,
    case: Case,
    tolerance: float,
    solve: Callable[[Case, float], FloatArray],
    exact: FloatArray,
    calls: int,
) -> str:
    times, found = list[float](), exact
    for _ in range(calls):
        start = process_time()
        try:
            found = solve(case, tolerance)
        except GivenUp:
            return f"| {name} | {tolerance:g} | not done | more than {PATIENCE:g} |"
        times.append(process_time() - start)
    error = float(np.abs(found - exact).max() / np.abs(exact).max())
    return f"| {name} | {tolerance:g} | {error:.1e} | {min(times):.2f} |"


if __name__ == "__main__":
    main()
