"""Free shapes of a tree with bars next to given frequencies, their generalised inertia and the energies in them.

For s = w^2 and angles x that solve D(s) x = 0, -x' (dD/ds) x is the generalised inertia, distributed inertia included:
a bar has t^2 dh/ds + a^2 d(s Ji)/ds + b^2 d(s Jo)/ds of it, with its end angles a and b and the torque t = (a - b)/h in
its flexibility; its elastic energy is, twice, t^2 d(s h)/ds + s^2 (a^2 dJi/ds + b^2 dJo/ds).
"""

from dataclasses import dataclass

import numpy as np

from torsion.kernels.bars.law import Slopes
from torsion.kernels.bars.passes import BarPasses, bar_passes, spread
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.tree import BoolArray, FloatArray, IntArray

_LARGEST_BLOCK = 2**19  # stations times columns of shapes at once
_LEAST_COLUMNS = 64
_NUDGES = (2.0**-51, -(2.0**-51), 2.0**-50)  # relative changes of a frequency that do not matter
_NAMES = ("angle", "inner", "outer", "between")


@dataclass(frozen=True)
class BarShapes:
    """Shapes of generalised inertia 1, (stations, m) each; torques are those exerted on the outer side, 0 at a root."""

    angle: FloatArray  # rad
    inner: FloatArray  # N m, torque at the inner end of each span
    outer: FloatArray  # N m, at its outer end
    between: FloatArray  # N m, in its flexibility
    correction: FloatArray  # (m,) of w^2
    passed: FloatArray  # (m,) sum over the spans of |torque between| |angle at the parent|, N m

    @property
    def finite(self) -> BoolArray:
        """Whether each shape (m,) is finite throughout."""
        return np.isfinite(self.passed) & np.isfinite(self.correction)

    def put(self, columns: IntArray | slice, shapes: "BarShapes") -> None:
        """Write `shapes` over those in `columns`."""
        for name in _NAMES:
            getattr(self, name)[:, columns] = getattr(shapes, name)
        self.correction[columns], self.passed[columns] = shapes.correction, shapes.passed

    def take(self, columns: IntArray) -> "BarShapes":
        """The shapes in `columns`."""
        angle, inner, outer, between = (getattr(self, name)[:, columns] for name in _NAMES)
        return BarShapes(angle, inner, outer, between, self.correction[columns], self.passed[columns])

    def scale(self, factor: FloatArray) -> None:
        """Multiply each shape by its `factor` (m,), in place."""
        for name in _NAMES:
            values = getattr(self, name)
            values *= factor


def determined_shapes(train: BarTree, frequency: FloatArray, *, ends: bool = True) -> BarShapes:
    """The shapes at `frequency` (m,) rad/s; one that is not finite, a node on a station exactly, is found beside.

    Without `ends`, the torques at both ends of the bars are those in their flexibilities.
    """
    shapes = _all_shapes(train, frequency, ends)
    for nudge in _NUDGES:
        finite = shapes.finite
        if finite.all():
            break
        left = np.flatnonzero(~finite)
        shapes.put(left, _all_shapes(train, frequency[left] * (1.0 + nudge), ends))
    return shapes


def _all_shapes(train: BarTree, frequency: FloatArray, ends: bool) -> BarShapes:
    block = max(_LEAST_COLUMNS, _LARGEST_BLOCK // train.tree.size)
    if len(frequency) <= block:
        return _shapes(train, frequency, ends)
    whole = BarShapes(*np.empty((4, train.tree.size, len(frequency))), *np.empty((2, len(frequency))))
    for begin in range(0, len(frequency), block):
        part = slice(begin, begin + block)
        whole.put(part, _shapes(train, frequency[part], ends))
    return whole


def _shapes(train: BarTree, frequency: FloatArray, ends: bool) -> BarShapes:
    """The shape at each frequency, from the station where the residual |Z| / J is least."""
    passes = bar_passes(train, frequency)
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        start = _least_residual(train, passes)
        angle, inward = spread(train, passes.transmitted_inward, passes.transmitted_outward, start)
        from_inside = inward != 0.0
        at_parent = angle[train.tree.parent]
        between = np.where(from_inside, -passes.back * angle, passes.through * at_parent)
        between[train.tree.roots] = 0.0
        mass = generalised_inertia(train, train.bars.slopes(frequency * frequency), angle, between)
        inner, outer = _end_torques(train, passes, angle, from_inside, between) if ends else (between, between)
        correction = passes.total[start, np.arange(len(start))] / mass
        np.multiply(at_parent, between, at_parent)
        passed = np.abs(at_parent, at_parent).sum(axis=0) / np.where(mass < np.inf, mass, np.nan)
        scale = 1.0 / np.sqrt(mass)
        angle, inner, outer, between = (values * scale for values in (angle, inner, outer, between))
        return BarShapes(angle, inner, outer, between, correction, passed)


def _end_torques(
    train: BarTree, passes: BarPasses, angle: FloatArray, from_inside: BoolArray, between: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Torques (stations, m) N m at the inner and the outer end of each span: a stiffness times an angle."""
    bars = train.bars.node
    a, b, inside, middle = angle[train.parent], angle[bars], from_inside[bars], between[bars]
    near, far = passes.inward[bars], passes.outward[bars]
    inner, outer = between.copy(), between.copy()
    inner[bars] = np.where(np.isinf(near), middle, np.where(inside, -near, passes.passed[bars]) * a)
    outer[bars] = np.where(np.isinf(far), middle, np.where(inside, -passes.returned[bars], far) * b)
    return inner, outer


def _least_residual(train: BarTree, passes: BarPasses) -> IntArray:
    body = np.where(train.tree.held, 0.0, train.static.inertia)
    residual = np.abs(passes.total)
    residual /= body[:, None]
    undetermined = np.isnan(residual)
    if undetermined.any():
        residual[undetermined] = np.inf
    least: IntArray = residual.argmin(axis=0)
    return least


def bar_inertia(train: BarTree, slopes: Slopes, angle: FloatArray, between: FloatArray) -> FloatArray:
    """Share (bars, m) of each bar in the generalised inertia of shapes; kg m2 rad2, twice its kinetic energy over s."""
    square = slopes.square
    a, b, t = angle[train.parent], angle[train.bars.node], between[train.bars.node]
    inner = (slopes.inner + square * slopes.inner_slope) * (a * a)
    outer = (slopes.outer + square * slopes.outer_slope) * (b * b)
    share: FloatArray = slopes.flexibility_slope * (t * t) + inner + outer
    return share


def bar_elastic(train: BarTree, slopes: Slopes, angle: FloatArray, between: FloatArray) -> FloatArray:
    """Twice the elastic energy (bars, m) of each bar in shapes, N m."""
    square = slopes.square
    a, b, t = angle[train.parent], angle[train.bars.node], between[train.bars.node]
    ends = slopes.inner_slope * (a * a) + slopes.outer_slope * (b * b)
    share: FloatArray = (slopes.flexibility + square * slopes.flexibility_slope) * (t * t) + square * square * ends
    return share


def generalised_inertia(train: BarTree, slopes: Slopes, angle: FloatArray, between: FloatArray) -> FloatArray:
    """Of each shape (m,), distributed inertia included."""
    mass: FloatArray = train.tree.moving_inertia @ (angle * angle)
    whole: FloatArray = mass + bar_inertia(train, slopes, angle, between).sum(axis=0)
    return whole
