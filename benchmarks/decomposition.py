"""All elastic modes by one decomposition of the factor of a tree or a chain, without a certificate.

The frequencies are as accurate as those of `tree_modes`, the shapes in the norm (Drmac and Veselic 2008).
"""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.modes.loops import jacobi_svd
from torsion.kernels.trees.tree import Tree


def chain_frequencies(inertia: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Elastic natural frequencies (stations - 1,) rad/s, ascending, of a free chain, kg m2 and N m/rad."""
    factor = np.zeros((len(inertia), len(inertia)))  # bidiagonal: what LAPACK then does is exact
    np.fill_diagonal(factor, np.append(np.sqrt(stiffness / inertia[:-1]), 0.0))
    np.fill_diagonal(factor[:, 1:], -np.sqrt(stiffness / inertia[1:]))
    return np.linalg.svd(factor, compute_uv=False)[-2::-1].copy()


@dataclass(frozen=True)
class PlainModes:
    """Elastic modes in ascending order, scaled to a generalised inertia of 1 kg m2."""

    frequency: FloatArray  # (m,) rad/s
    angle: FloatArray  # (stations, m) rad
    torque: FloatArray  # (stations, m) N m, on station i: (angle[parent] - angle[i]) / flexibility; 0 at the root


def plain_modes(tree: Tree) -> PlainModes:
    """All elastic modes of a tree of one root in which every station moves, has inertia and an elastic span.

    With G = J^-1/2 B' k^1/2 = U s V': frequencies s, angles J^-1/2 U, torques k^1/2 s V, no difference of angles.
    """
    stiffness, station = 1.0 / tree.flexibility[1:], np.arange(1, tree.size)
    factor = np.zeros((tree.size, tree.size - 1))
    factor[tree.parent[1:], station - 1] = np.sqrt(stiffness)
    factor[station, station - 1] = -np.sqrt(stiffness)
    left, values, right = jacobi_svd(factor / np.sqrt(tree.inertia)[:, None], "UV")
    angle = left[:, ::-1] / np.sqrt(tree.inertia)[:, None]
    torque = np.zeros((tree.size, len(values)))
    torque[1:] = np.sqrt(stiffness)[:, None] * right[:, ::-1] * values[::-1]
    return PlainModes(values[::-1], angle, torque)
