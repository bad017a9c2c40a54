"""How well angles and torques satisfy the equations of a tree: each equation relative to the terms in it."""

from typing import Any

import numpy as np

from torsion.kernels.outward import Answer, Equations
from torsion.kernels.sweeps import Layout, Row
from torsion.kernels.tree import FloatArray


def equilibrium_residual(plan: Layout, given: Equations, answer: Answer) -> FloatArray:
    """Worst relative residual, (columns,), over every station that is not held and every span.

    Computed from the answer alone, so that it also sees what the sweeps could not know. An equation whose terms are
    all zero is satisfied.
    """
    angle, torque = answer.angle, answer.torque
    worst = np.zeros(np.shape(angle[0]))
    torque_size = [np.abs(row) for row in torque]
    angle_size = [np.abs(row) for row in angle]
    for station in range(plan.size):
        if not plan.held[station]:
            turned = given.own[station] * angle[station]
            error = turned - torque[station]
            error -= given.force[station]
            scale = np.abs(turned)
            scale += torque_size[station]
            scale += np.abs(given.force[station])
            for child in plan.children[station]:
                error += torque[child]
                scale += torque_size[child]
            _note(worst, error, scale)
        parent = plan.parent[station]
        if parent >= 0:
            wound: Any = given.compliance[station] * torque[station]
            scale = np.abs(wound)
            scale += angle_size[station]
            scale += angle_size[parent]
            wound += angle[station]
            wound -= angle[parent]
            if given.twist is not None:
                wound -= given.twist[station]
                scale += np.abs(given.twist[station])
            _note(worst, wound, scale)
    return worst


def _note(worst: FloatArray, error: Row, scale: Row) -> None:
    size = np.abs(error)
    size /= scale
    np.fmax(worst, size, out=worst)
