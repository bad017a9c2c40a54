"""Loss factors as viscous dampers, for motions that need not repeat themselves.

A loss factor is a matter of whole harmonics. What stands for it must damp every mode of the straight train as it does,
yet act on the twist of the springs alone: then a train that turns rigidly through its joints loses nothing, the
equations know no time but the train's own angle, and the free turning solves their variation exactly.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from torsion.analyses.motion.layout import Dampers, Layout
from torsion.analyses.motion.modes import Basis
from torsion.arrays import FloatArray

NOTHING = 1e-13  # of the largest damper: what is smaller is rounding of the modes


def viscous(whole: Layout, shapes: Basis) -> Layout:
    """The same with dampers for its loss factors: torque t = Q c Qᵀ (rate of twist), Q = k B φ/w², c = `shapes.loss`.

    Qᵀ takes from the twists B y of the springs the share of each shape φ, since φᵀ K φ = w². Of a reduced basis only
    the shapes that it has are damped.
    """
    if not whole.hysteretic.any():
        return whole
    elastic = np.flatnonzero(shapes.frequency > 0)
    shape = np.zeros((len(whole.root), len(elastic)))
    shape[: whole.free] = shapes.shape[:, elastic]
    twist = shape[whole.coordinate[whole.driving]] - shape[whole.coordinate[whole.driven]]
    value, vector = eigh(shapes.loss[np.ix_(elastic, elastic)])
    acts = value > NOTHING * value[-1]
    onto = (whole.stiffness[:, None] * twist / shapes.frequency[elastic] ** 2) @ (
        vector[:, acts] * np.sqrt(value[acts])
    )
    length = np.linalg.norm(onto, axis=0)
    return replace(whole, hysteretic=np.zeros_like(whole.hysteretic), dampers=Dampers(onto / length, length**2))


def at_bodies(whole: Layout) -> FloatArray:
    """(dampers, bodies): twist of each damper = sum over the bodies times their angles."""
    out = np.zeros((whole.bodies, whole.dampers.onto.shape[1]))
    np.add.at(out, whole.driving, whole.dampers.onto)
    np.subtract.at(out, whole.driven, whole.dampers.onto)
    return out.T


def at_coordinates(whole: Layout, slope: FloatArray) -> FloatArray:
    """(dampers, free, times): twist of each damper over the free coordinates.

    slope: (bodies, times), that of each body over its coordinate.
    """
    out = np.zeros((len(whole.root), whole.dampers.onto.shape[1], slope.shape[1]))
    np.add.at(out, whole.coordinate, at_bodies(whole).T[:, :, None] * slope[:, None])
    return out[: whole.free].transpose(1, 0, 2)
