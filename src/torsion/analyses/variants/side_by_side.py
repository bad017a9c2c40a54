"""Natural frequencies of all variants side by side, each proven."""

from dataclasses import replace

import numpy as np

from torsion.analyses.variants.products import Rows, products
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.kernels.tree import Tree
from torsion.study import Study, Variation


def side_by_side(system: System, variation: Variation, values: FloatArray, count: int) -> FloatArray | None:
    """Frequencies (modes, variants) Hz by the kernel of many trains; None where it does not take them.

    Inertias and flexibilities have to be products of powers of the figures (a stiffness, a length, a diameter), or sums
    in which each has a share (an inertia beside another), which trials show.
    """
    if not count or system.bars is not None or system.tables or system.whole.condensed.extra.size:
        return None
    base = _tree(system)

    def read(study: Study) -> Rows | None:
        tree = _tree(varied(system, study))
        same = np.array_equal(tree.parent, base.parent)
        return np.concatenate([tree.flexibility, tree.moving_inertia])[:, None] if same else None

    found = products(variation, values, read)
    if found is None:
        return None
    from torsion.kernels.variant_modes import variant_modes

    flexibility, inertia = np.split(found.factors(values), 2)
    flexibility *= base.flexibility[:, None]
    inertia *= base.moving_inertia[:, None]
    return variant_modes(base, flexibility, inertia, count).frequency / (2.0 * np.pi)


def varied(system: System, study: Study) -> System:
    """The train of a variant, as finely divided."""
    from torsion.assembly import rediscretised

    return rediscretised(replace(system, train=study.train), system.requested.frequency)


def _tree(system: System) -> Tree:
    from torsion.analyses.undamped_modes import undamped_tree

    return undamped_tree(system.whole)
