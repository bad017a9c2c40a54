"""Forced response of many trains of one layout side by side: at frequencies of each, and the peak of every torque.

The columns of one sweep are trains times frequencies. A peak is looked for on a grid that knows the resonances of each
train, a parabola through 1/|T|^2 says where it stands (that is nearly one about a resonance), and there it is solved;
the same with every other point left out says how far the grid decides.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.sturm import count_below
from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import (
    Status,
    TreeResponse,
    complex_compliance,
    status,
    tree_response,
)
from torsion.kernels.variant_modes import variant_modes

ABOUT = np.array(
    [0.0, 0.2, 0.5, 1.0, 2.0, 4.0]
)  # to either side of a resonance, times damping ratio and frequency
EVEN = 17  # points over the whole band
COLUMNS = 2**13  # trains times points solved at once
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

    def part(self, part: slice) -> "Trains":
        """Some of the trains."""
        return self._with(lambda own: own[:, part])

    def _with(self, changed: Callable[[FloatArray], FloatArray]) -> "Trains":
        """The same with other columns of what has columns."""
        given = (own for own in vars(self).values() if isinstance(own, np.ndarray))
        return Trains(self.tree, *(changed(own) if own.ndim > 1 else own for own in given))

    def response(self, w: FloatArray, force: NDArray[Any], *, check: bool = True) -> TreeResponse:
        """The response at circular frequencies `w` (trains, points) rad/s; columns are trains, and points in each.

        force: (stations,) N m, or (stations, columns).
        """
        one, flat = self._with(lambda own: np.repeat(own, w.shape[1], axis=1)), w.ravel()
        hc = complex_compliance(one.flexibility, one.viscous, one.loss_factor, flat)
        tree = replace(self.tree, flexibility=one.flexibility, inertia=one.inertia)
        return tree_response(
            tree, flat, force, ground_damping=one.ground_damping, compliance=hc, check=check
        )

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
            own if own.ndim == 1 else own.max(axis=1)
            for own in (self.viscous, self.loss_factor, self.ground_damping)
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
            own if own.ndim == 1 else own.mean(axis=1)
            for own in (self.viscous, self.loss_factor, self.ground_damping)
        )
        w, torque, angle = known.frequency[:count], known.torque[:, :count], known.angle[:, :count]
        twist = middle.flexibility[:, None] * torque
        lost = (twist * torque).T @ loss / w**2 + (
            (twist**2).T @ viscous + (angle**2).T @ ground
        ) / w
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
    inside = (centre.min(axis=1) * (1.0 - reach) < high) & (
        centre.max(axis=1) * (1.0 + reach) > low
    )
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


@dataclass(frozen=True)
class VariantPeaks:
    """The largest magnitude of every span's torque over a band of frequencies."""

    torque: FloatArray  # (spans, trains) N m; infinite where a response in the band is not ok
    frequency: FloatArray  # (spans, trains) rad/s at which it stands
    error: FloatArray  # (spans, trains) relative: what half of the points, and the parabola, would have said otherwise;
    # infinite where damping moves resonances away from the points
    ok: BoolArray  # (trains,) the response at every peak is ok


def variant_peaks(trains: Trains, force: FloatArray, band: tuple[float, float]) -> VariantPeaks:
    """Peaks of every span's torque within a `band` (lowest, highest) rad/s under `force` (stations,) N m.

    >>> two = Tree(np.array([-1, 0]), np.zeros(2), np.zeros(2), np.zeros(2, dtype=bool))
    >>> k, none = np.array([1e4, 2e4]), np.zeros(2)
    >>> trains = Trains(two, np.stack([0 * k, 1 / k]), np.ones((2, 2)), none, np.array([0, 0.1]), none)
    >>> variant_peaks(trains, np.array([0.0, 1.0]), (1.0, 400.0)).torque[1].round(6)  # sqrt(1 + eta^2)/(2 eta)
    array([5.024938, 5.024938])
    """
    size, count = trains.inertia.shape
    centre, ratio = trains.resonances(band[1])
    torque, where, error = np.empty((3, size, count))
    ok = np.empty(count, dtype=np.bool_)
    points = 2 * (EVEN + len(ratio) * (2 * len(ABOUT) - 1)) - 1
    width = max(1, COLUMNS // points)
    for begin in range(0, count, width):
        part = slice(begin, min(begin + width, count))
        some, w = (
            trains.part(part),
            resonance_grid(centre[:, part], ratio, np.linspace(*band, EVEN)),
        )
        found = np.abs(some.response(w, force, check=False).torque).reshape(size, len(w), -1)
        coarse, _, _ = vertex(w[:, ::2], found[:, :, ::2])
        fine, place, _ = vertex(w, found)
        there = some.response(place.T, force)
        own = np.abs(there.torque).reshape(size, len(w), size)[np.arange(size), :, np.arange(size)]
        worst = status(there.amplification, there.residual).reshape(len(w), size).max(axis=1)
        torque[:, part], where[:, part] = np.fmax(own, found.max(axis=2)), place
        with np.errstate(invalid="ignore", divide="ignore"):
            gap = np.abs(np.stack([fine, coarse]) / torque[:, part] - 1.0).max(axis=0)
        error[:, part] = np.where(
            torque[:, part] > 0.0, np.inf if some.displaces(band[1]) else gap, 0.0
        )
        ok[part] = worst == Status.OK
        torque[:, part.start + np.flatnonzero(~ok[part])] = np.inf
    return VariantPeaks(torque, where, error, ok)
