"""The paper's shaft as `torsion` takes it, and its motion from rest: linear by step matrices, exact in space."""

from dataclasses import replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from benchmarks.papers import zhu_wang_space as space
from benchmarks.papers.zhu_wang_theory import response, undamped
from torsion.analyses.lateral.misaligned_shaft import EXACT, MisalignedShaft, coefficients
from torsion.kernels.periodic.monodromy import radau, step_matrices

Array = NDArray[np.float64]
SHAFT = MisalignedShaft(
    inertia=4.597e-3,
    polar=3.96e-5,
    length=0.46,
    stiffness=(7.74, 23.22),
    damping=(1e-3, 1e-3),
    torque=0.3,
    tilt=np.radians(5.0),
)
RADIUS, DENSITY = 2.4e-3, 7830.0  # m, kg/m3
CURVE = 1e-6  # relative tolerance of a curve to look at
PARTS = 12  # points of half a revolution in the table


def shaft(*, damped: bool) -> MisalignedShaft:
    """With C = 1e-3 N s/m or without."""
    return SHAFT if damped else undamped(SHAFT)


def linear(one: MisalignedShaft, speed: float, half_turns: int) -> tuple[Array, Array]:
    """Times, s, and angles (2, times), rad, from rest by (7) corrected: periodic answer plus free motion."""
    rule = radau()
    steps = []
    for part in range(PARTS):
        damping, stiffness = coefficients(
            one, np.pi * (part + rule.node) / PARTS, np.array([speed]), EXACT
        )
        eye = np.broadcast_to(np.eye(2), stiffness[0].shape)
        steps.append(step_matrices(eye, damping[0], stiffness[0], np.pi / (speed * PARTS), rule))
    times = np.pi / (speed * PARTS) * np.arange(half_turns * PARTS + 1)
    found = response(one, np.array([speed]))
    turning = np.exp(1j * speed * np.outer(found.order, times))
    angle = np.real(found.angle[0] @ turning)
    rate = np.real(1j * speed * (found.angle[0] * found.order) @ turning)
    free = np.empty((4, times.size))
    free[:, 0] = -np.concatenate([angle[:, 0], rate[:, 0]])
    for k in range(times.size - 1):
        free[:, k + 1] = steps[k % PARTS] @ free[:, k]
    return times, angle + free[:2]


def body(one: MisalignedShaft, speed: float) -> space.Body:
    """The same shaft in space."""
    return space.Body(
        one.inertia,
        one.polar * one.inertia,
        one.length,
        one.stiffness,
        one.damping,
        one.torque,
        one.tilt,
        speed,
    )


@cache
def exact(speed: float, damped: bool, last: float, points: int) -> tuple[Array, Array]:
    """Times and angles (2, times) from rest without any linearisation."""
    times = np.linspace(0.0, last, points)
    return times, space.angles(body(shaft(damped=damped), speed), times, CURVE)


def longer(one: MisalignedShaft, factor: float) -> MisalignedShaft:
    """A rod of the same section, `factor` as long: its inertia grows with the third power."""
    return replace(
        one,
        length=factor * one.length,
        inertia=factor**3 * one.inertia,
        polar=one.polar / factor**2,
    )
