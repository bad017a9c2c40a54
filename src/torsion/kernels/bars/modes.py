"""Natural frequencies and mode shapes of a tree with bars, each frequency with an enclosure by counts."""

from dataclasses import dataclass, field

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.bars.repeated import orthogonalise, repeated_shapes
from torsion.kernels.bars.search import brackets, enclose
from torsion.kernels.bars.shapes import BarShapes, bar_elastic, bar_inertia, determined_shapes
from torsion.kernels.bars.spans import Bars
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.clamped import cut, needs_cutting, with_reactions
from torsion.kernels.modes import rigid_shapes, shape_sign
from torsion.kernels.repeated import repeated_groups
from torsion.kernels.tree import BoolArray, FloatArray, Tree

_SETTLED = 1e-14  # relative change of a frequency after which its shape is that of the final one
_STEPS = 6  # Newton's steps; a start that needs more is bisected instead
_BEYOND = 1e-2  # of the width of a bracket that a step may leave it by
_OFF = 5e-2  # relative, that a frequency to start from may be off
_FULL_BISECTION = 2.0**-52


@dataclass(frozen=True)
class BarModes:
    """The lowest elastic modes in ascending order, of generalised inertia 1, and the rigid motions.

    `torque` is what the part inward of a span exerts through it on the part outward: `torque` at the span's inner end,
    `torque_outer` at its outer one, where the bar's own inertia has taken its share. Both are equal for a plain span.
    """

    frequency: FloatArray  # (m,) rad/s
    lower: FloatArray  # (m,) rad/s, no more than the frequency of the given train
    upper: FloatArray  # (m,) rad/s, no less
    angle: FloatArray  # (stations, m) rad; the first of the largest components positive
    torque: FloatArray  # (stations, m) N m at the inner (parent's) end of span i; 0 at a root
    torque_outer: FloatArray  # (stations, m) N m at the outer end, on station i
    rigid: int  # number of rigid motions, known from the graph
    rigid_angle: FloatArray  # (stations, rigid) rad; constant over each free part, generalised inertia 1
    kinetic: FloatArray  # (stations, m) share of the kinetic energy: the station's own and half of each bar at it
    elastic: FloatArray  # (stations, m) share of the elastic energy in span i
    bar_kinetic: FloatArray  # (bars, m) share of the kinetic energy in each bar
    certified: bool = True  # whether `lower` and `upper` are proven, up to the stated rounding of the laws
    loop_torque: FloatArray = field(default_factory=lambda: np.empty((0, 0)))  # (loops, m); there are no loops


def bar_modes(tree: Tree, bars: Bars, count: int) -> BarModes:
    """The lowest `count` elastic modes of a tree whose spans `bars.node` have distributed inertia.

    The flexibility that `tree` gives for these spans is not used. Frequencies closer than 1e-13 (relative) count as
    repeated: their shapes are one orthogonal set of many. Raises SolveError for a mode above 0.95 times the lowest
    frequency of a bar with both ends held, and for a frequency that cannot be proven.
    """
    return modes_of(BarTree(tree, bars), count)


def modes_of(given: BarTree, count: int, *, start: FloatArray | None = None) -> BarModes:
    """`bar_modes` of a tree with its bars, from frequencies (count,) rad/s near the modes, ascending, if known."""
    tree, bars, static, known = given.tree, given.bars, given.static, given.known
    wanted = count if np.isfinite(bars.limit) else min(count, known.elastic)
    rigid_angle = rigid_shapes(static, known)
    cutting = needs_cutting(static, known)
    train = given.solved(cut(tree, known)) if cutting else given
    rigid = len(known.free_roots)
    frequency, shapes = _frequencies(train, rigid, wanted, start)
    frequency, lower, upper, wrong = _prove(train, frequency, rigid, shapes.passed)
    if wrong.any():
        shapes = determined_shapes(train, frequency)
    _complete(train, frequency, shapes)
    torque, outer = shapes.inner, shapes.outer
    if cutting:
        taken = np.zeros_like(torque)
        for part in train.rounds:
            taken[train.parent[part]] += (outer - torque)[bars.node[part]]
        reactions = with_reactions(tree, known, outer, taken)
        outer, torque = reactions, np.where(_is_bar(given)[:, None], torque, reactions)
    energies = _energies(train, frequency, shapes)
    return BarModes(frequency, lower, upper, shapes.angle, torque, outer, rigid, rigid_angle, *energies)


def _is_bar(train: BarTree) -> BoolArray:
    return np.array(train.bar_of) >= 0


def _frequencies(train: BarTree, rigid: int, wanted: int, start: FloatArray | None) -> tuple[FloatArray, BarShapes]:
    """Frequencies (wanted,) after Newton's steps from `start` or from brackets, ascending, and their shapes."""
    if wanted <= 0:
        return np.empty(0), BarShapes(*np.empty((4, train.tree.size, 0)), *np.empty((2, 0)))
    if start is None:
        low, high = brackets(train, rigid + np.arange(wanted))
        frequency = low + 0.5 * (high - low)
    else:
        low, high, frequency = start * (1.0 - _OFF), start * (1.0 + _OFF), start.copy()
    shapes = _polish(train, frequency, low, high)
    if (frequency[1:] >= frequency[:-1]).all():
        return frequency, shapes
    order = np.argsort(frequency, kind="stable")
    return frequency[order], shapes.take(order)


def _polish(train: BarTree, frequency: FloatArray, low: FloatArray, high: FloatArray) -> BarShapes:
    """Newton's steps of each `frequency` (m,) as long as they stay within `low` and `high`, in place; its shapes."""
    room = _BEYOND * (high - low)
    shapes = determined_shapes(train, frequency)
    left, change = np.arange(len(frequency)), _change(frequency, shapes.correction)
    for _ in range(_STEPS):
        moved = frequency[left] * (1.0 + change)
        inside = (moved >= low[left] - room[left]) & (moved <= high[left] + room[left])
        frequency[left[inside]] = moved[inside]
        left = left[inside & (np.abs(change) >= _SETTLED)]
        if not len(left):
            break
        again = determined_shapes(train, frequency[left])
        shapes.put(left, again)
        change = _change(frequency[left], again.correction)
    return shapes


def _change(frequency: FloatArray, correction: FloatArray) -> FloatArray:
    """Relative change (m,) of each frequency for a `correction` (m,) of its square; 0 where there is none."""
    share = correction / (frequency * frequency)
    with np.errstate(invalid="ignore"):
        change: FloatArray = share / (1.0 + np.sqrt(1.0 + share))
    return np.where(np.isfinite(change), change, 0.0)


def _prove(
    train: BarTree, frequency: FloatArray, rigid: int, passed: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Frequencies, bounds `lower` and `upper`, and which frequencies had to be found anew by bisection; all (m,)."""
    lower, upper, proven = enclose(train, frequency, rigid, passed)
    wrong = ~proven
    if not proven.all():
        frequency = frequency.copy()
        low, high = brackets(train, np.flatnonzero(wrong) + rigid, tolerance=_FULL_BISECTION)
        frequency[wrong] = low + 0.5 * (high - low)
        frequency.sort()
        lower, upper, proven = enclose(train, frequency, rigid)
        if not proven.all():
            where = ", ".join(f"{w:.6g}" for w in frequency[~proven])
            raise SolveError(
                f"the natural frequencies near {where} rad/s could not be enclosed; divide the shafts more finely"
            )
    return frequency, lower, upper, wrong


def _complete(train: BarTree, frequency: FloatArray, shapes: BarShapes) -> None:
    """Put in the shapes of repeated frequencies, make those of close ones orthogonal, choose the signs; in place."""
    if not len(frequency):
        return
    groups = repeated_groups(frequency, ~shapes.finite)
    if groups:
        shapes.put(np.concatenate(groups), repeated_shapes(train, frequency, groups))
    orthogonalise(train, frequency, shapes)
    shapes.scale(shape_sign(shapes.angle))


def _energies(train: BarTree, frequency: FloatArray, shapes: BarShapes) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Shares in the kinetic energy (stations, m), the elastic energy (stations, m) and the kinetic one (bars, m)."""
    square = frequency * frequency
    slopes = train.bars.slopes(square)
    of_bars = bar_inertia(train, slopes, shapes.angle, shapes.between)
    kinetic = train.tree.moving_inertia[:, None] * shapes.angle**2
    train.add_ends(kinetic, 0.5 * of_bars, 0.5 * of_bars)
    elastic = train.tree.flexibility[:, None] * shapes.between**2
    elastic[train.bars.node] = bar_elastic(train, slopes, shapes.angle, shapes.between)
    return kinetic, elastic / square, of_bars
