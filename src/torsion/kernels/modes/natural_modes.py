"""Natural frequencies and mode shapes of a tree, each frequency with a proven enclosure."""

import math

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.errors import SolveError
from torsion.kernels.modes.mode_shapes import (
    ShaftModes,
    Shapes,
    TreeModes,
    orthogonalise,
    repeated_groups,
    repeated_shapes,
    shaft_energies,
    shape_sign,
    shapes_at,
)
from torsion.kernels.modes.sturm import brackets, enclose
from torsion.kernels.trees.reduction import (
    Rigidity,
    bends,
    cut,
    rigid_shapes,
    rigidity,
    with_reactions,
)
from torsion.kernels.trees.tree import Tree
from torsion.sources import source

_SETTLED = (
    1e-15  # relative change of a frequency after which its shape is that of the final frequency
)
_STEPS = 6  # more, from a bracket; Rayleigh quotients converge cubically, Newton's steps of shafts less fast
_DENSE = 200  # stations up to which a decomposition finds a start sooner than counts (measured)
_SPREAD = 1e6  # of its values that it leaves right to about 1e-10
_TRUSTED = 0.1  # relative distance from such a start beyond which a step has left its mode
_BEYOND = 1e-2  # of the width of a bracket that a step may leave it by
_FULL_BISECTION = 2.0**-52


@source("WittrickWilliams1971")
def tree_modes(tree: Tree, count: int | None = None) -> TreeModes:
    """The lowest `count` elastic modes of a tree, or all.

    Frequencies closer than 1e-13 (relative) count as repeated: their shapes are one orthogonal set of many. Raises
    SolveError for a frequency that cannot be proven. Flexibilities must be finite, inertias not negative.

    With distributed shafts a mode above 0.95 times the lowest frequency of a shaft with both ends fixed raises SolveError.
    """
    bodies = rigidity(tree.static)
    rigid, wanted = len(bodies.free_roots), bodies.elastic if count is None else count
    if tree.shafts is None or not math.isfinite(tree.shafts.limit):
        wanted = min(wanted, bodies.elastic)

    # Rigid spans between fixed stations carry reactions only: they are put back at the end.
    solved = cut(tree, bodies)
    if wanted == 0:
        frequency = lower = upper = np.empty(0)
        shapes = shapes_at(tree, frequency)
    else:
        frequency, shapes = _polish(solved, *start_frequencies(tree, solved, bodies, wanted))
        frequency, lower, upper, wrong = _enclosed(solved, frequency, rigid, shapes.passed)
        if wrong.any():  # what bisection has corrected has another shape
            shapes = shapes_at(solved, frequency)

        # Repeated frequencies have one set of shapes; those of close ones are made orthogonal.
        groups = repeated_groups(frequency, ~np.isfinite(shapes.passed))
        if groups:
            shapes.put(np.concatenate(groups), repeated_shapes(solved, frequency, groups))
        orthogonalise(solved, frequency, shapes)
        shapes.scale(shape_sign(shapes.angle))
    torque, of_shafts = _torques(tree, bodies, frequency, shapes)
    rigid_angle = rigid_shapes(tree.static, bodies)
    return TreeModes(
        frequency, lower, upper, shapes.angle, torque, rigid, rigid_angle, shafts=of_shafts
    )


def start_frequencies(
    tree: Tree, solved: Tree, bodies: Rigidity, wanted: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Frequencies (wanted,) rad/s to begin with, ascending, and bounds within which steps from them are trusted.

    `solved` is the same train without rigid spans between fixed stations.
    """
    if tree.shafts is None and tree.size <= _DENSE:
        inertia = np.sqrt(tree.moving_inertia)[:, None] * bends(tree, bodies)[3]
        values = np.linalg.svd(inertia, compute_uv=False)[: bodies.elastic]
        if values[-1] * _SPREAD > values[0]:
            start = np.asarray(1.0 / values[:wanted], dtype=float)
            return start, start * (1.0 - _TRUSTED), start * (1.0 + _TRUSTED)
    low, high = brackets(solved, len(bodies.free_roots) + np.arange(wanted))
    room = _BEYOND * (high - low)
    return low + 0.5 * (high - low), low - room, high + room


def _polish(
    tree: Tree, frequency: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, Shapes]:
    """Frequencies (m,) after Rayleigh's steps within `low` and `high`, ascending, and the shapes that go with them."""
    shapes = shapes_at(tree, frequency)
    left, correction = np.arange(len(frequency)), shapes.correction
    for step in range(1 + _STEPS):
        if step:
            again = shapes_at(tree, frequency[left])
            shapes.put(left, again)
            correction = again.correction

        # Rayleigh's quotient gives the change of the square; the root of it without a difference.
        estimate = frequency[left]
        with np.errstate(invalid="ignore", over="ignore"):
            share = correction / (estimate * estimate)
            change = share / (1.0 + np.sqrt(1.0 + share))
            moved = estimate * (1.0 + change)

        # A step out of its bounds has gone to another mode: the enclosure will find that.
        inside = (moved >= low[left]) & (moved <= high[left])
        frequency[left[inside]] = moved[inside]
        left = left[inside & (np.abs(change) >= _SETTLED)]
        if not len(left):
            break
    if (frequency[1:] >= frequency[:-1]).all():
        return frequency, shapes
    order = np.argsort(frequency, kind="stable")
    return frequency[order], Shapes(*(values[..., order] for values in vars(shapes).values()))


def _enclosed(
    tree: Tree, frequency: FloatArray, rigid: int, passed: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Frequencies, bounds `lower` and `upper`, and which frequencies had to be found anew by bisection; all (m,)."""
    lower, upper, proven = enclose(tree, frequency, rigid, passed)
    wrong = ~proven
    if not proven.all():
        frequency = frequency.copy()
        low, high = brackets(tree, np.flatnonzero(wrong) + rigid, tolerance=_FULL_BISECTION)
        frequency[wrong] = low + 0.5 * (high - low)
        frequency.sort()
        lower, upper, proven = enclose(tree, frequency, rigid)
        if not proven.all():
            where = ", ".join(f"{w:.6g}" for w in frequency[~proven])
            remedy = (
                "divide the shafts more finely"
                if tree.shafts is not None
                else "request fewer modes, or `model: exact`"
            )
            raise SolveError(
                f"the natural frequencies near {where} rad/s could not be enclosed; {remedy}"
            )
    return frequency, lower, upper, wrong


def _torques(
    tree: Tree, bodies: Rigidity, frequency: FloatArray, shapes: Shapes
) -> tuple[FloatArray, ShaftModes | None]:
    """Torques (stations, m) at the root ends of the spans, and what distributed shafts add.

    With those of rigid spans between fixed stations; the inertia of a shaft takes its part of them.
    """
    if tree.shafts is None:
        return with_reactions(tree, bodies, shapes.torque), None
    node, square = tree.shafts.node, frequency * frequency
    torque, outer = shapes.torque.copy(), shapes.torque.copy()
    torque[node], outer[node] = shapes.inner, shapes.outer
    of_shafts, elastic_of_shafts = shaft_energies(
        tree, tree.shafts, square, shapes.angle, shapes.torque
    )
    kinetic = np.where(bodies.fixed, 0.0, tree.inertia)[:, None] * shapes.angle**2
    tree.add_ends(kinetic, 0.5 * of_shafts, 0.5 * of_shafts)
    elastic = tree.flexibility[:, None] * shapes.torque**2
    elastic[node] = elastic_of_shafts
    taken, by_shafts = np.zeros_like(torque), (outer - torque)[node]
    tree.add_ends(taken, by_shafts, np.zeros_like(by_shafts))
    outer = with_reactions(tree, bodies, outer, taken)
    springs = np.delete(np.arange(tree.size), node)
    torque[springs] = outer[springs]
    return torque, ShaftModes(outer, kinetic, elastic / square, of_shafts)
