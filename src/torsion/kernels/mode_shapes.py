"""Shapes of the modes next to given frequencies, by the stiffness that both sides of every span show.

For s = w^2 and angles x that solve D(s) x = 0, -x' (dD/ds) x is the generalised inertia, distributed inertia included:
a shaft has t^2 dh/ds + a^2 d(s Ji)/ds + b^2 d(s Jo)/ds of it, with its end angles a and b and the torque t = (a - b)/h
in its flexibility; its elastic energy is, twice, t^2 d(s h)/ds + s^2 (a^2 dJi/ds + b^2 dJo/ds).
"""

from dataclasses import dataclass, field

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.distributed.span_laws import Slopes
from torsion.kernels.elimination import eliminate_undamped, spread
from torsion.kernels.tree import Tree
from torsion.sources import source

_LARGEST_BLOCK = 2**20  # stations times columns of shapes at once; 8 MB an array (measured)
_LEAST_COLUMNS = 64  # at once, however many stations
_NUDGES = (2.0**-51, -(2.0**-51), 2.0**-50)  # relative changes of a frequency that do not matter
# Relative; components that near count as equal when the sign of a shape is chosen.
_EQUAL_SIZE = 1e-6
# Of the torque in a shaft; a smaller one at its end is a difference of equal terms.
_ROUNDING_OF_ENDS = 8e-15
_OF_STATIONS, _OF_MODES = ("angle", "torque", "inner", "outer"), ("correction", "passed")


@dataclass(frozen=True)
class Shapes:
    """Shapes of generalised inertia 1 of the modes next to given frequencies."""

    angle: FloatArray  # (stations, m) rad
    torque: FloatArray  # (stations, m) N m, in the flexibility of each span as it acts on the side of the leaves
    inner: FloatArray  # (shafts, m) N m, at the root end of each distributed shaft
    outer: FloatArray  # (shafts, m) N m, at its other end
    correction: FloatArray  # (m,) of w^2 by Rayleigh's quotient
    passed: FloatArray  # (m,) sum over the spans of |torque| |angle at the parent|, N m

    @classmethod
    def empty(cls, tree: Tree, columns: int) -> "Shapes":
        """Shapes yet to be put in."""
        angle, torque = np.empty((2, tree.size, columns))
        return cls(
            angle, torque, *np.empty((2, len(tree.shaft_parent), columns)), *np.empty((2, columns))
        )

    @classmethod
    def of_springs(cls, angle: FloatArray, torque: FloatArray) -> "Shapes":
        """Given shapes (stations, m) of a tree without distributed shafts."""
        columns = angle.shape[1]
        return cls(angle, torque, *np.empty((2, 0, columns)), *np.zeros((2, columns)))

    @property
    def finite(self) -> BoolArray:
        """Whether each shape (m,) is finite throughout; the sum over its spans shows it."""
        return np.isfinite(self.passed)

    def put(self, columns: IntArray | slice, shapes: "Shapes") -> None:
        """Write `shapes` over those in `columns`."""
        for name in (*_OF_STATIONS, *_OF_MODES):
            getattr(self, name)[..., columns] = getattr(shapes, name)

    def take(self, columns: IntArray) -> "Shapes":
        return Shapes(*(getattr(self, name)[..., columns] for name in (*_OF_STATIONS, *_OF_MODES)))

    def scale(self, factor: FloatArray) -> None:
        """Multiply each shape by its `factor` (m,), in place."""
        for values in (self.angle, self.torque, self.inner, self.outer):
            if len(values):
                np.multiply(values, factor, out=values)

    def correct(self, columns: slice, share: FloatArray) -> None:
        """Take `share` (columns, columns) of the shapes in `columns` from one another, in place."""
        for name in _OF_STATIONS:
            values = getattr(self, name)
            values[:, columns] -= values[:, columns] @ share


@dataclass(frozen=True)
class ShaftModes:
    """What distributed shafts add to modes."""

    torque_outer: FloatArray  # (stations, m) N m on station i at the outer end of its span; a spring's `torque`
    kinetic: FloatArray  # (stations, m) share of the kinetic energy: the station's own and half of each shaft at it
    elastic: FloatArray  # (stations, m) share of the elastic energy in span i
    shaft_kinetic: FloatArray  # (shafts, m) share of the kinetic energy in each shaft


@dataclass(frozen=True)
class TreeModes:
    """Elastic modes of a tree in ascending order, of generalised inertia 1, and its rigid motions."""

    frequency: FloatArray  # (m,) rad/s
    lower: FloatArray  # (m,) rad/s, proven to be no more than the frequency of the given train
    upper: FloatArray  # (m,) rad/s, proven to be no less
    angle: FloatArray  # (stations, m) rad; the first of the largest components positive
    torque: FloatArray  # (stations, m) N m, at the root end of span i as it acts on the side of the leaves; 0 at a root
    rigid: int  # number of rigid motions, known from the graph
    # (stations, rigid) rad; constant over each free part, generalised inertia 1.
    rigid_angle: FloatArray
    certified: bool = True  # whether `lower` and `upper` are proven, up to the stated rounding of the laws of shafts
    loop_torque: FloatArray = field(
        default_factory=lambda: np.empty((0, 0))
    )  # (loops, m) N m, on the second station
    shafts: ShaftModes | None = None


def shapes_at(tree: Tree, frequency: FloatArray) -> Shapes:
    """The shapes at `frequency` (m,) rad/s; one that is not finite, a node on a station exactly, is found beside.

    A column comes out not finite where the frequency is a repeated one to the last digit: its shape is not determined
    by one station.
    """
    shapes = _in_blocks(tree, frequency)
    for nudge in _NUDGES:
        finite = shapes.finite
        if finite.all():
            break
        left = np.flatnonzero(~finite)
        shapes.put(left, _in_blocks(tree, frequency[left] * (1.0 + nudge)))
    return shapes


def _in_blocks(tree: Tree, frequency: FloatArray) -> Shapes:
    """`free_shapes`, in blocks of columns, so that memory stays bounded."""
    block = max(_LEAST_COLUMNS, _LARGEST_BLOCK // tree.size)
    if len(frequency) <= block:
        return free_shapes(tree, frequency)
    shapes = Shapes.empty(tree, len(frequency))
    for begin in range(0, len(frequency), block):
        part = slice(begin, begin + block)
        shapes.put(part, free_shapes(tree, frequency[part]))
    return shapes


@source("ParlettDhillon1997")
def free_shapes(tree: Tree, w: FloatArray) -> Shapes:
    """The shape at each frequency `w` (m,) rad/s, from the station where the residual |Z| / J is least."""
    with np.errstate(all="ignore"):
        sides = eliminate_undamped(tree, w)
        residual = np.abs(sides.whole) / tree.static.inertia_columns
        residual[np.isnan(residual)] = np.inf  # without inertia
        start, column = residual.argmin(axis=0), np.arange(len(w))
        angle, torque = spread(sides, start)
        passed = np.abs(torque * angle[tree.parent]).sum(axis=0)
        mass = (tree.inertia_columns * (angle * angle)).sum(axis=0)
        inner, outer = end_torques(tree, w * w, angle, torque)
        if tree.shafts is not None:
            mass = mass + shaft_inertia(tree, tree.shafts.slopes(w * w), angle, torque).sum(axis=0)
        correction = sides.whole[start, column] / mass
        passed /= np.where(mass < np.inf, mass, np.nan)
        shapes = Shapes(angle, torque, inner, outer, correction, passed)
        shapes.scale(1.0 / np.sqrt(mass))
    return shapes


def end_torques(
    tree: Tree, square: FloatArray, angle: FloatArray, torque: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return torques (shafts, m) N m at the inner and the outer end of each shaft at `square` (m,) of the frequencies.

    From the torque in its flexibility and the inertia at both of its ends; what is less than the rounding of both is 0,
    as at a free end.
    """
    if tree.shafts is None:
        return torque[:0], torque[:0]
    middle, (_, inner, outer) = torque[tree.shafts.node], tree.shafts.at(square)
    ends = []
    for inertia, turned in ((-inner, angle[tree.shaft_parent]), (outer, angle[tree.shafts.node])):
        end = middle + square * inertia * turned
        ends.append(np.where(np.abs(end) <= _ROUNDING_OF_ENDS * np.abs(middle), 0.0, end))
    return ends[0], ends[1]


def shaft_inertia(tree: Tree, slopes: Slopes, angle: FloatArray, torque: FloatArray) -> FloatArray:
    """Share (shafts, m) of each shaft in the generalised inertia; kg m2 rad2, twice its kinetic energy over s."""
    a, b, t = _of_shafts(tree, angle, torque)
    inner = (slopes.inner + slopes.square * slopes.inner_slope) * (a * a)
    outer = (slopes.outer + slopes.square * slopes.outer_slope) * (b * b)
    return slopes.flexibility_slope * (t * t) + inner + outer


def shaft_elastic(tree: Tree, slopes: Slopes, angle: FloatArray, torque: FloatArray) -> FloatArray:
    """Twice the elastic energy (shafts, m) of each shaft in shapes, N m."""
    square, (a, b, t) = slopes.square, _of_shafts(tree, angle, torque)
    ends = slopes.inner_slope * (a * a) + slopes.outer_slope * (b * b)
    twist = slopes.flexibility + square * slopes.flexibility_slope
    return twist * (t * t) + square * square * ends


def _of_shafts(
    tree: Tree, angle: FloatArray, torque: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angles (shafts, m) at the inner and the outer end, and the torques between them."""
    node = tree.springs[:0] if tree.shafts is None else tree.shafts.node
    return angle[tree.shaft_parent], angle[node], torque[node]


def shape_sign(angle: FloatArray) -> FloatArray:
    """Sign (m,) of the first angle in each shape (stations, m) that is, to rounding, as large as any."""
    size = np.abs(angle)
    first = np.argmax(size >= (1.0 - _EQUAL_SIZE) * size.max(axis=0), axis=0)
    sign: FloatArray = np.sign(angle[first, np.arange(angle.shape[1])])
    return sign
