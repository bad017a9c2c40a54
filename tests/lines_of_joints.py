"""Lines of joints for tests: from their angles, and how each turns, joint by joint."""

import numpy as np
from numpy.typing import ArrayLike

from torsion.kernels.joints.cross import Transfer, behind, transfer
from torsion.kernels.joints.line import Line


def line_of(angle: ArrayLike, plane: ArrayLike = 0.0, phase: ArrayLike = 0.0) -> Line:
    """Return a line from angles, planes and phases, rad, broadcast against each other to shape (..., joints)."""
    given = (
        np.asarray(angle, dtype=float),
        np.asarray(plane, dtype=float),
        np.asarray(phase, dtype=float),
    )
    angles, planes, phases = (np.array(values) for values in np.broadcast_arrays(*given))
    if np.any(planes[..., 0] != 0.0):
        raise ValueError("the first joint of a line defines the plane; its own `plane` must be 0")
    return Line(angles, planes, phases)


def motion(driving: ArrayLike, line: Line) -> Transfer:
    """Return what one line does to its driving angle up to behind each joint; arrays of shape (joints, *driving.shape)."""
    turned = np.asarray(driving, dtype=float)
    transfers = [Transfer(np.zeros_like(turned), np.ones_like(turned), np.zeros_like(turned))]
    for angle, offset in zip(line.angle, np.cumsum(line.offset), strict=True):
        transfers.append(
            behind(transfers[-1], transfer(turned + (transfers[-1].error + offset), angle))
        )
    return Transfer(
        *np.stack([(part.error, part.ratio, part.curvature) for part in transfers[1:]], axis=1)
    )
