"""Natural frequencies and mode shapes of a tree, each frequency with a proven enclosure."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.banded import banded_values
from torsion.kernels.centre import hung_from_the_middle
from torsion.kernels.clamped import cut, needs_cutting, with_reactions
from torsion.kernels.enclosure import bisect, enclose, expected_width
from torsion.kernels.factors import start_frequencies
from torsion.kernels.long_chain.modes import long_chain_modes
from torsion.kernels.reduction import Rigidity, reduce_tree, rigidity
from torsion.kernels.repeated import orthogonalise, repeated_groups, repeated_shapes
from torsion.kernels.shapes import FreeShapes, free_shapes
from torsion.kernels.tree import BoolArray, FloatArray, Tree

_SETTLED = 1e-14  # relative change of a frequency after which its shape is that of the final frequency
_LARGEST_BLOCK = 2**20  # stations times columns of shapes at once; 8 MB an array (measured)
_LEAST_COLUMNS = 64  # at once, however many stations
_STEPS = 4  # Rayleigh quotients converge cubically; a start that needs more is bisected instead
_TRUSTED = 0.1  # a relative change beyond which a Rayleigh step is taken to have left its mode
_START_BISECTION = 1e-5  # relative; near enough for Rayleigh steps
_STATIONS_FOR_COUNTS = 300  # from which the few lowest modes of a branched tree are sooner found by counts (measured)
_STATIONS_FOR_BAND = 1500  # up to which all frequencies of a narrow tree are sooner found than the lowest by counts
_FEW = 0.05  # of all modes
_FULL_BISECTION = 2.0**-52
_LONG = 2000  # stations in a row from which few modes are faster found one by one (measured)
_STATIONS_A_MODE = 64  # at least, for that to be the faster (measured)
_NUDGES = (2.0**-51, -(2.0**-51), 2.0**-50)  # relative changes of a frequency that do not matter
_EQUAL_SIZE = 1e-6  # relative; components that near count as equal when the sign of a shape is chosen


@dataclass(frozen=True)
class TreeModes:
    """Elastic modes of a tree in ascending order, mass-normalised, and its rigid motions."""

    frequency: FloatArray  # (m,) rad/s
    lower: FloatArray  # (m,) rad/s, proven to be no more than the frequency of the given train
    upper: FloatArray  # (m,) rad/s, proven to be no less
    angle: FloatArray  # (stations, m) rad; x'Jx = 1, the first of the largest components positive
    torque: FloatArray  # (stations, m) N m, on station i: (angle[parent] - angle[i]) / flexibility; 0 at a root
    rigid: int  # number of rigid motions, known from the graph
    rigid_angle: FloatArray  # (stations, rigid) rad; constant over each free part, x'Jx = 1
    certified: bool = True  # whether `lower` and `upper` are proven
    loop_torque: FloatArray = field(default_factory=lambda: np.empty((0, 0)))  # (loops, m) N m, on the second station


def tree_modes(
    tree: Tree, count: int | None = None, *, progress: Callable[[int, int], None] | None = None
) -> TreeModes:
    """The lowest `count` elastic modes of a tree, or all.

    Few modes of a long row of stations are found one by one, and `progress` is told how many of how many are done.
    Frequencies closer than 1e-13 (relative) count as repeated: their shapes are one orthogonal set of many. Raises
    SolveError for a frequency that cannot be proven. Flexibilities must be finite, inertias not negative.
    """
    if count is not None and tree.size >= _LONG and 0 < count * _STATIONS_A_MODE <= tree.size:
        long = _of_long_chain(tree, count, progress)
        if long is not None:
            return long
    known = rigidity(tree)
    wanted = known.elastic if count is None else min(count, known.elastic)
    rigid_angle = rigid_shapes(tree, known)
    solved = cut(tree, known) if needs_cutting(tree, known) else tree
    if wanted == 0:
        none, empty = np.empty((tree.size, 0)), np.empty(0)
        return TreeModes(empty, empty, empty, none, none, len(known.free_roots), rigid_angle)
    hung = hung_from_the_middle(solved)
    swept = hung.tree
    frequency, shapes = _polish(swept, _start(tree, swept, known, wanted))
    frequency, lower, upper, wrong = _prove(swept, frequency, len(known.free_roots), shapes.passed)
    if wrong.any():
        shapes = _determined_shapes(swept, frequency)
    angle, torque = hung.angles(shapes.angle), hung.torques(shapes.torque)
    _complete(solved, frequency, ~shapes.finite, angle, torque)
    if solved is not tree:
        torque = with_reactions(tree, known, torque)
    return TreeModes(frequency, lower, upper, angle, torque, len(known.free_roots), rigid_angle)


def _of_long_chain(tree: Tree, count: int, progress: Callable[[int, int], None] | None) -> TreeModes | None:
    """The modes by the passes of one chain; None where the tree is none, or is better solved as any tree."""
    found = long_chain_modes(tree, count, progress=progress)
    if found is None:
        return None
    sign = shape_sign(found.angle)
    np.multiply(found.angle, sign, out=found.angle)
    np.multiply(found.torque, sign, out=found.torque)
    rigid = found.rigid_angle
    return TreeModes(found.frequency, found.lower, found.upper, found.angle, found.torque, rigid.shape[1], rigid)


def rigid_shapes(tree: Tree, known: Rigidity) -> FloatArray:
    """Angles (stations, rigid motions) rad, constant over each free part and mass-normalised."""
    if tree.is_plain:
        return np.full((tree.size, 1), 1.0 / math.sqrt(tree.inertia.sum()))
    part = known.component[:, None] == known.free_roots
    scaled: FloatArray = part / np.sqrt(tree.moving_inertia @ part)
    return scaled


def _start(tree: Tree, swept: Tree, known: Rigidity, wanted: int) -> FloatArray:
    """Frequencies (wanted,) rad/s to begin with, ascending; `swept` is the same train numbered for sweeps."""
    is_few = not tree.is_chain and tree.size > _STATIONS_FOR_COUNTS and wanted <= _FEW * known.elastic
    train = reduce_tree(tree, known)
    if is_few:
        start = banded_values(train) if tree.size <= _STATIONS_FOR_BAND else None
    else:
        start = start_frequencies(train, known.elastic)
    if start is None or not np.all(start > 0.0):
        modes = len(known.free_roots) + np.arange(wanted)
        return bisect(swept, modes, tolerance=_START_BISECTION)
    return start[:wanted]


def _polish(tree: Tree, frequency: FloatArray) -> tuple[FloatArray, FreeShapes]:
    """Frequencies (m,) after Rayleigh steps, ascending, and the shapes that go with them."""
    shapes = _determined_shapes(tree, frequency)
    change = _relative_change(frequency, shapes.correction)
    frequency = frequency * (1.0 + change)
    for _ in range(_STEPS - 1):
        unsettled = np.abs(change) >= _SETTLED
        if not unsettled.any():
            break
        left = np.flatnonzero(unsettled)
        again = _determined_shapes(tree, frequency[left])
        shapes.put(left, again)
        change = np.zeros(len(frequency))
        change[left] = _relative_change(frequency[left], again.correction)
        frequency *= 1.0 + change
    if (frequency[1:] >= frequency[:-1]).all():
        return frequency, shapes
    order = np.argsort(frequency, kind="stable")
    return frequency[order], shapes.take(order)


def _relative_change(frequency: FloatArray, correction: FloatArray) -> FloatArray:
    """Relative change (m,) of each frequency for a `correction` (m,) of its square; 0 where that leads elsewhere."""
    share = correction / (frequency * frequency)
    with np.errstate(invalid="ignore", over="ignore"):
        change: FloatArray = share / (1.0 + np.sqrt(1.0 + share))
    near = np.abs(change) < _TRUSTED
    if not near.all():
        change[~near] = 0.0
    return change


def _determined_shapes(tree: Tree, frequency: FloatArray) -> FreeShapes:
    """The shapes at `frequency` (m,); one that is not finite, as a node falls on a station exactly, is found beside."""
    shapes = _all_shapes(tree, frequency)
    for nudge in _NUDGES:
        finite = shapes.finite
        if finite.all():
            break
        left = np.flatnonzero(~finite)
        shapes.put(left, _all_shapes(tree, frequency[left] * (1.0 + nudge)))
    return shapes


def _all_shapes(tree: Tree, frequency: FloatArray) -> FreeShapes:
    """`free_shapes`, in blocks of columns, so that memory stays bounded."""
    block = max(_LEAST_COLUMNS, _LARGEST_BLOCK // tree.size)
    if len(frequency) <= block:
        return free_shapes(tree, frequency)
    whole = FreeShapes.empty(tree.size, len(frequency))
    for begin in range(0, len(frequency), block):
        part = slice(begin, begin + block)
        whole.put(part, free_shapes(tree, frequency[part]))
    return whole


def _prove(
    tree: Tree, frequency: FloatArray, rigid: int, passed: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Frequencies, bounds `lower` and `upper`, and which frequencies had to be found anew by bisection; all (m,)."""
    lower, upper, proven = enclose(tree, frequency, rigid, expected_width(tree, frequency, passed))
    wrong = ~proven
    if not proven.all():
        frequency = frequency.copy()
        frequency[wrong] = bisect(tree, np.flatnonzero(wrong) + rigid, tolerance=_FULL_BISECTION)
        frequency.sort()
        lower, upper, proven = enclose(tree, frequency, rigid)
        if not proven.all():
            where = ", ".join(f"{w:.6g}" for w in frequency[~proven])
            raise SolveError(f"the natural frequencies near {where} rad/s could not be enclosed; scale the train")
    return frequency, lower, upper, wrong


def _complete(
    tree: Tree, frequency: FloatArray, undetermined: BoolArray, angle: FloatArray, torque: FloatArray
) -> None:
    """Put the shapes of repeated frequencies in, make those of close ones orthogonal, and choose the signs."""
    groups = repeated_groups(frequency, undetermined)
    if groups:
        columns = np.concatenate(groups)
        angle[:, columns], torque[:, columns] = repeated_shapes(tree, frequency, groups)
    orthogonalise(tree, frequency, angle, torque)
    sign = shape_sign(angle)
    angle *= sign
    torque *= sign


def shape_sign(angle: FloatArray) -> FloatArray:
    """Sign (m,) of the first angle in each shape (stations, m) that is, to rounding, as large as any."""
    size = np.abs(angle)
    first = np.argmax(size >= (1.0 - _EQUAL_SIZE) * size.max(axis=0), axis=0)
    sign: FloatArray = np.sign(angle[first, np.arange(angle.shape[1])])
    return sign
