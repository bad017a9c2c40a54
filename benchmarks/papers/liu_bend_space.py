"""The same train as six bodies with two constraint torques each joint has in space: nothing is eliminated by hand.

Ratios and their slopes come from the pins of `space.cross`, joint torques are unknowns next to the six accelerations.
"""

import numpy as np

from benchmarks.papers import space
from benchmarks.papers.liu_bend_model import Array, Boat, Turning


def balance(boat: Boat, moving: Turning) -> tuple[Array, Array, Array]:
    """Accelerations (6,), driving-side torques (2,) and driven-side torques (2,) at the angles and speeds of `moving`.

    Ten equations: six of moments, two of the joints' angles differentiated twice, two of their power.
    """
    joints = [
        space.cross(moving.angle[1], boat.angle),
        space.cross(moving.angle[3] + np.pi / 2.0, boat.angle),
    ]
    w, x = np.array(moving.speed), np.array(moving.angle)
    torque = np.array(boat.stiffness) * (x[[0, 2, 4]] - x[[1, 3, 5]])
    torque += np.array(boat.damping) * (w[[0, 2, 4]] - w[[1, 3, 5]])
    matrix, right = np.zeros((10, 10)), np.zeros(10)
    matrix[range(6), range(6)] = boat.inertia
    right[[0, 2, 4]] -= torque
    right[[1, 3, 5]] += torque
    right[0] += boat.torque
    right[5] -= boat.torque * w[5] * abs(w[5]) / boat.speed**2
    for k, joint in enumerate(joints):
        driving, driven = 2 * k + 1, 2 * k + 2
        matrix[driving, 6 + k], matrix[driven, 8 + k] = 1.0, -1.0
        matrix[6 + k, driven], matrix[6 + k, driving] = 1.0, -float(joint.ratio)
        right[6 + k] = float(joint.curvature) * w[driving] ** 2
        matrix[8 + k, 8 + k], matrix[8 + k, 6 + k] = 1.0, -float(joint.driven_torque)
    found = np.linalg.solve(matrix, right)
    return found[:6], found[6:8], found[8:]


def couples(boat: Boat, moving: Turning, driving: Array) -> Array:
    """(4,) couple about y and z on the driving shaft of the first, the driven shaft of the second joint, N m."""
    out = []
    for k, turned in enumerate((moving.angle[1], moving.angle[3] + np.pi / 2.0)):
        c, s = np.cos(boat.angle), np.sin(boat.angle)
        behind = np.array([0.0, c, s])
        pin = space.rotated(space.NORMAL, space.AXIS, turned)
        other = np.cross(behind, pin)
        moment = np.cross(pin, other)
        moment = moment * driving[k] / (moment @ space.AXIS)
        shaft = space.AXIS if k == 0 else behind
        on_it = -moment if k == 0 else moment
        out += [on_it @ space.NORMAL, on_it @ np.cross(shaft, space.NORMAL)]
    return np.array(out)
