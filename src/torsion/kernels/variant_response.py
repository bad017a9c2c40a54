"""Where peaks of the response of many trains of one layout are looked for, side by side.

That is a grid that knows the resonances of each train; a parabola through 1/|T|^2 says where a peak stands (that is
nearly one about a resonance). The same with every other point left out says how far the grid decides.
"""

from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.sturm import count_below
from torsion.kernels.tree import Tree
from torsion.kernels.variant_modes import variant_modes

ABOUT = np.array([0.0, 0.2, 0.5, 1.0, 2.0, 4.0])  # to either side of a resonance, times damping ratio and frequency
EVEN = 17  # points over the whole band
LEAST_RATIO = 1e-9  # damping ratio below which points about a resonance would be one


@dataclass(frozen=True)
class Trains:
    """Trains of one layout with their damping; arrays (stations, trains), or (stations,) of a figure all have."""

    tree: Tree  # the layout; which stations are fixed
    flexibility: FloatArray  # (stations, trains) rad/(N m)
    inertia: FloatArray  # (stations, trains) kg m2
    viscous: FloatArray  # N m s/rad beside each span
    loss_factor: FloatArray  # of each span
    ground_damping: FloatArray  # N m s/rad

    @property
    def count(self) -> int:
        """Number of trains."""
        return int(self.inertia.shape[1])

    def _middle(self, highest: float, least: int = 0) -> tuple[Tree, TreeModes, int]:
        """The train of the geometric means, its modes, and how many of them count below `highest` rad/s."""
        middle, softest = (
            replace(self.tree, flexibility=h, inertia=j)
            for h, j in zip(*(_ends(own) for own in (self.flexibility, self.inertia)), strict=True)
        )
        below = int(count_below(softest, np.array([highest]))[0])
        known = tree_modes(middle, max(below, least))
        count = min(len(known.frequency), max(below - known.rigid, least))
        return middle, known, count

    def displaces(self, highest: float) -> bool:
        """The greatest damping moves a resonance below `highest` rad/s by more than half its width.

        A span of tangent t of its loss angle has the flexibility h/(1 + i t), which is smaller by t^2/(1 + t^2); so
        much damping couples, or holds, and the peaks stand elsewhere than at the undamped frequencies.
        """
        middle, known, count = self._middle(highest)
        w, torque, angle = known.frequency[:count], known.torque[:, :count], known.angle[:, :count]
        share = middle.flexibility[:, None] * torque**2 / w**2
        viscous, loss, ground = (
            own if own.ndim == 1 else own.max(axis=1) for own in (self.viscous, self.loss_factor, self.ground_damping)
        )
        tangent = (middle.flexibility * viscous)[:, None] * w + loss[:, None]
        held = angle.T**2 @ ground / w
        softer = share / (1.0 + tangent**2)
        moved, width = (softer * tangent**2).sum(axis=0), (softer * tangent).sum(axis=0)
        return bool(np.any((moved > width + held) & (moved > LEAST_RATIO)) or np.any(held > 1.0))

    def resonances(self, highest: float, least: int = 0) -> tuple[FloatArray, FloatArray]:
        """Frequencies (modes, trains) rad/s of every mode that any train has below `highest`, and ratios (modes,).

        Of so many modes at `least`, as far as there are.
        How many these are, the train of the greatest flexibilities and inertias says, whose modes are the lowest; what
        damps them, the train of the geometric means, to first order by energy.
        """
        middle, known, count = self._middle(highest, least)
        if count <= 0:
            return np.empty((0, self.count)), np.empty(0)
        viscous, loss, ground = (
            own if own.ndim == 1 else own.mean(axis=1) for own in (self.viscous, self.loss_factor, self.ground_damping)
        )
        w, torque, angle = known.frequency[:count], known.torque[:, :count], known.angle[:, :count]
        twist = middle.flexibility[:, None] * torque
        lost = (twist * torque).T @ loss / w**2 + ((twist**2).T @ viscous + (angle**2).T @ ground) / w
        return variant_modes(self.tree, self.flexibility, self.inertia, count).frequency, lost / 2.0


def _ends(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Geometric mean (stations,) over the trains, 0 where all are 0, and the greatest."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.exp(np.log(values).mean(axis=1))), values.max(axis=1)


def resonance_grid(centre: FloatArray, ratio: FloatArray, fixed: FloatArray) -> FloatArray:
    """(trains, points), ascending: `fixed` ones (points,), those about every resonance, and the middles of all these.

    centre: (resonances, trains); ratio: (resonances,) half their relative widths. Resonances that no train has between
    the ends of the fixed points are left out.

    >>> resonance_grid(np.array([[5.0]]), np.array([0.1]), np.array([1.0, 5.0, 9.0]))[0, ::2].round(6).tolist()
    [1.0, 3.0, 4.0, 4.5, 4.75, 4.9, 5.0, 5.0, 5.1, 5.25, 5.5, 6.0, 7.0, 9.0]
    """
    low, high = float(fixed.min()), float(fixed.max())
    reach = ABOUT[-1] * ratio
    inside = (centre.min(axis=1) * (1.0 - reach) < high) & (centre.max(axis=1) * (1.0 + reach) > low)
    about = np.concatenate([-ABOUT[:0:-1], ABOUT])
    shift = 1.0 + np.maximum(ratio[inside], LEAST_RATIO)[:, None] * about
    near = np.clip((centre[inside].T[:, :, None] * shift).reshape(centre.shape[1], -1), low, high)
    points = np.hstack([np.broadcast_to(fixed, (centre.shape[1], len(fixed))), near])
    points.sort(axis=1)
    found = np.empty((len(points), 2 * points.shape[1] - 1))
    found[:, ::2] = points
    found[:, 1::2] = (points[:, 1:] + points[:, :-1]) / 2.0
    return found


def vertex(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
    """Highest value (rows, trains) of `y` (rows, trains, points) at `x` (trains, points), and where; its point.

    By a parabola through 1/y^2 at the greatest value and its neighbours; that value itself where there is none.
    """
    top = y.argmax(axis=2)
    at = np.clip(top[:, :, None] + np.arange(-1, 2), 0, x.shape[1] - 1)
    place = np.take_along_axis(np.broadcast_to(x, y.shape), at, axis=2)
    value = np.take_along_axis(y, at, axis=2)
    with np.errstate(all="ignore"):
        left, right = place[..., 0] - place[..., 1], place[..., 2] - place[..., 1]
        before, here, after = (value[..., k] ** -2 for k in range(3))
        toward, beyond = (before - here) / left, (after - here) / right
        bend = (beyond - toward) / (right - left)
        slope = toward - bend * left
        move = -slope / (2.0 * bend)
        least = here + slope * move / 2.0
        inner = (bend > 0.0) & (move > left) & (move < right) & (least > 0.3 * here)
        found = np.where(inner, least**-0.5, value[..., 1])
    return found, np.where(inner, place[..., 1] + move, place[..., 1]), top
