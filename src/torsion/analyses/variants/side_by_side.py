"""Natural frequencies of all variants side by side, each proven."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import InputError, SolveError
from torsion.kernels.tree import Tree
from torsion.study import Variation

TRIALS = (1.07, 0.96)  # factors at which a figure is tried for how it enters the train
POWER = 1e-11  # relative, within which inertias and flexibilities are products of powers of the figures


def side_by_side(system: System, variation: Variation, values: FloatArray, count: int) -> FloatArray | None:
    """Frequencies (modes, variants) Hz by the kernel of many trains; None where it does not take them.

    Inertias and flexibilities have to be products of powers of the figures (a stiffness, a length, a diameter of a
    shaft whose inertia is not summed with another), which trials show.
    """
    nominal = np.array([np.nan if one.rows else one.nominal for one in variation.figures])
    if not count or not np.all(np.isfinite(nominal) & (nominal != 0.0)):
        return None
    if system.bars is not None or system.tables or system.whole.condensed.extra.size:
        return None
    base, factor, powers = _tree(system), values / nominal, []
    for place, own in enumerate(nominal.tolist()):
        tried = [_tried(variation, system, [*nominal[:place], own * one, *nominal[place + 1 :]]) for one in TRIALS]
        power = _powers(base, tried)
        if power is None:
            return None
        powers.append(power)
    flexibility, inertia = (_product(own, [power[k] for power in powers], factor) for k, own in enumerate(_both(base)))
    last = _tried(variation, system, values[-1].tolist())
    if last is None or not all(map(_same, _both(last), (flexibility[:, -1], inertia[:, -1]))):
        return None
    from torsion.kernels.variant_modes import variant_modes

    return variant_modes(base, flexibility, inertia, count).frequency / (2.0 * np.pi)


def _tree(system: System) -> Tree:
    from torsion.analyses.undamped_modes import undamped_tree

    return undamped_tree(system.whole)


def _tried(variation: Variation, system: System, values: Sequence[float]) -> Tree | None:
    """The tree of a variant, as finely divided; None where its layout is another."""
    from torsion.assembly import rediscretised

    try:
        tree = _tree(rediscretised(replace(system, train=variation.study(values).train), system.requested.frequency))
    except (InputError, SolveError):
        return None
    return tree if np.array_equal(tree.parent, _tree(system).parent) else None


def _both(tree: Tree) -> tuple[FloatArray, FloatArray]:
    return tree.flexibility, tree.moving_inertia


def _same(one: FloatArray, other: FloatArray) -> bool:
    return bool(np.allclose(one, other, rtol=POWER, atol=0.0))


def _powers(base: Tree, tried: Sequence[Tree | None]) -> tuple[FloatArray, FloatArray] | None:
    """The power of the figure in every flexibility and inertia; None where it enters otherwise."""
    found = []
    for own, *others in zip(_both(base), *(_both(one) for one in tried if one is not None), strict=True):
        used = (own > 0.0) & np.isfinite(own)
        if len(others) < len(TRIALS) or any(not np.array_equal(used, (one > 0.0) & np.isfinite(one)) for one in others):
            return None
        power = np.zeros(len(own))
        power[used] = np.log(others[0][used] / own[used]) / np.log(TRIALS[0])
        power = np.round(power, 9)
        if any(not _same(own * factor**power, one) for factor, one in zip(TRIALS, others, strict=True)):
            return None
        found.append(power)
    return found[0], found[1]


def _product(own: FloatArray, powers: Sequence[FloatArray], factor: FloatArray) -> FloatArray:
    """(stations, variants)."""
    return np.asarray(own[:, None] * np.exp(np.stack(powers, axis=1) @ np.log(factor.T)))
