"""Modes of the train with its joints straight: the basis in which its stability is computed and its zones are named."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag, eigh

from torsion.analyses.stability.mechanism import Dampers, Layout, gathered
from torsion.arrays import FloatArray
from torsion.errors import SolveError

SAME = 1e-6  # of the largest: static shapes that are others combined
NOTHING = 1e-13  # of the largest damper: what is smaller is rounding of the modes


@dataclass(frozen=True)
class Basis:
    """Undamped modes of the free coordinates with a speed ratio of 1 in every joint, by ascending frequency.

    A reduced basis holds more: static shapes about the joints, and coordinates without inertia as they are.
    """

    frequency: (
        FloatArray  # (shapes,) rad/s; 0 of a rigid motion, NaN of a coordinate without inertia
    )
    shape: FloatArray  # (coordinates, shapes), generalised inertia 1
    inertia: FloatArray  # (coordinates,) kg m2
    loss: FloatArray  # (shapes, shapes) 1/s: viscous damping that loses in and between modes what loss factors lose
    modes: int  # how many of the shapes, the first ones, are modes

    @property
    def rigid(self) -> int:
        """How many rigid motions come first."""
        return int(np.count_nonzero(self.frequency == 0.0))

    @property
    def highest(self) -> float:
        """rad/s of the highest mode; 0 where all are rigid."""
        return float(self.frequency[: self.modes].max(initial=0.0))

    def share(self, motion: FloatArray) -> FloatArray:
        """Return (shapes, ...) of each shape in a motion (coordinates, ...)."""
        shares = np.tensordot(self.shape.T * self.inertia, motion, 1)
        light = np.isnan(self.frequency)
        if light.any():
            shares[light] = (motion - np.tensordot(self.shape, shares, 1))[self.inertia == 0]
        return shares


def reduced(layout: Layout, shapes: Basis, count: int) -> Basis:
    """Return the lowest `count` modes with what the joints excite of the others statically.

    What a joint's varying ratio adds to the equations of the straight train acts at its coordinate and at those that
    its springs lead to. The deflection of the modes left out under forces there is taken along.
    """
    light = np.flatnonzero(shapes.inertia == 0)
    frequency, choice = shapes.frequency, np.eye(len(shapes.frequency))
    if count < len(frequency):
        bodies = [step.outer for step in layout.steps]
        near = np.isin(layout.driving, bodies) | np.isin(layout.driven, bodies)
        touched = layout.coordinate[
            np.concatenate([bodies, layout.driving[near], layout.driven[near]]).astype(int)
        ]
        touched = np.unique(touched[touched < layout.free])
        square = frequency[count:] ** 2
        onto = (shapes.shape[touched, count:] / square).T
        left, size, _ = np.linalg.svd(onto / np.linalg.norm(onto, axis=0), full_matrices=False)
        left = left[:, size > SAME * size[0]]
        static_square, turned = eigh(left.T @ (square[:, None] * left))
        choice = block_diag(np.eye(count), left @ turned)
        frequency = np.concatenate([frequency[:count], np.sqrt(static_square)])

    # The coordinates without inertia as they are: turning joints let them move by themselves.
    return Basis(
        np.append(frequency, np.full(len(light), np.nan)),
        np.column_stack([shapes.shape @ choice, np.eye(len(shapes.inertia))[:, light]]),
        shapes.inertia,
        np.pad(choice.T @ shapes.loss @ choice, (0, len(light))),
        min(count, shapes.modes),
    )


def basis(layout: Layout) -> Basis:
    """Return all modes of finite frequency; coordinates without inertia follow the others statically."""
    mass = gathered(layout, layout.inertia)
    twists = _twists(layout)
    stiffness, lossy = (
        twists.T @ (part[:, None] * twists) for part in (layout.stiffness, layout.hysteretic)
    )
    heavy = np.flatnonzero(mass > 0)
    light = np.flatnonzero(mass == 0)
    if not heavy.size:
        raise SolveError("no component has an inertia; nothing can vibrate")
    follow = np.zeros((layout.free, len(heavy)))
    follow[heavy, np.arange(len(heavy))] = 1.0
    if light.size:
        pull = stiffness[np.ix_(light, heavy)]
        follow[light] = -np.linalg.lstsq(stiffness[np.ix_(light, light)], pull, rcond=None)[0]
    root = np.sqrt(mass[heavy])
    square, vector = eigh((follow.T @ stiffness @ follow) / np.outer(root, root))
    frequency = np.sqrt(np.maximum(square, 0.0))
    frequency[: len(layout.floating)] = 0.0
    shape = follow @ (vector / root[:, None])
    slow = np.sqrt(np.divide(1.0, frequency, out=np.zeros_like(frequency), where=frequency > 0))
    loss = slow[:, None] * (shape.T @ lossy @ shape) * slow
    return Basis(frequency, shape, mass, loss, len(frequency))


def _twists(layout: Layout) -> FloatArray:
    """(springs, free) twist of each spring of the straight train over the free coordinates."""
    coordinates = np.arange(layout.free)
    driving, driven = layout.coordinate[layout.driving], layout.coordinate[layout.driven]
    twist = 1.0 * (driving[:, None] == coordinates) - (driven[:, None] == coordinates)
    return np.asarray(twist)


def viscous(layout: Layout, shapes: Basis) -> Layout:
    """Return the same with dampers for its loss factors: torque t = Q c Qᵀ (rate of twist), Q = k B φ/w², c = `shapes.loss`.

    Qᵀ takes from the twists B y of the springs the share of each shape φ, since φᵀ K φ = w². Of a reduced basis only
    the shapes that it has are damped.
    """
    if not layout.hysteretic.any():
        return layout
    elastic = np.flatnonzero(shapes.frequency > 0)
    twist = _twists(layout) @ shapes.shape[:, elastic]
    value, vector = eigh(shapes.loss[np.ix_(elastic, elastic)])
    acts = value > NOTHING * value[-1]
    share = vector[:, acts] * np.sqrt(value[acts])
    onto = (layout.stiffness[:, None] * twist / shapes.frequency[elastic] ** 2) @ share
    length = np.linalg.norm(onto, axis=0)
    return replace(
        layout,
        hysteretic=np.zeros_like(layout.hysteretic),
        dampers=Dampers(onto / length, length**2),
    )


def at_coordinates(layout: Layout, slope: FloatArray) -> FloatArray:
    """Return (times, dampers, free): twist of each damper over the free coordinates.

    slope: (bodies, times), that of each body over its coordinate.
    """
    return gathered(layout, layout.damper_twist.T[:, :, None] * slope[:, None]).transpose(2, 1, 0)
