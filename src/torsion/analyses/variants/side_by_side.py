"""Natural frequencies of all variants side by side, each proven."""

from dataclasses import replace

import numpy as np

from torsion.analyses.variants.products import Rows, products
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.kernels.tree import Tree
from torsion.study import Study, Variation


def side_by_side(system: System, variation: Variation, values: FloatArray, count: int) -> FloatArray | None:
    """Frequencies (modes, variants) Hz by the kernels of many trains; None where they do not take them.

    Inertias and flexibilities have to be products of powers of the figures (a stiffness, a length, a diameter), or sums
    in which each has a share (an inertia beside another), which trials show.
    """
    if not count or system.bars is not None or system.tables:
        return None
    base, at = _tree(system), _chords(system)[0]

    def read(study: Study) -> Rows | None:
        own = varied(system, study)
        (ends, chord), tree = _chords(own), _tree(own)
        same = np.array_equal(tree.parent, base.parent) and np.array_equal(ends, at)
        return np.concatenate([tree.flexibility, tree.moving_inertia, chord])[:, None] if same else None

    found = products(variation, values, read)
    if found is None:
        return None
    rows = found.factors(values) * np.concatenate([base.flexibility, base.moving_inertia, _chords(system)[1]])[:, None]
    flexibility, inertia, chord = np.split(rows, [base.size, 2 * base.size])
    if len(chord):
        from torsion.kernels.variant_loops import looped_variant_modes

        many = looped_variant_modes(base, flexibility, inertia, (at[0], at[1]), chord, count)
    else:
        from torsion.kernels.variant_modes import variant_modes

        many = variant_modes(base, flexibility, inertia, count)
    return many.frequency / (2.0 * np.pi)


def varied(system: System, study: Study) -> System:
    """The train of a variant, as finely divided."""
    from torsion.assembly import rediscretised

    return rediscretised(replace(system, train=study.train), system.requested.frequency)


def _tree(system: System) -> Tree:
    from torsion.analyses.undamped_modes import undamped_tree

    return undamped_tree(system.whole)


def _chords(system: System) -> tuple[IntArray, FloatArray]:
    """Stations of the tree (2, chords) at the ends of the spans that close loops, and their flexibility (chords,)."""
    from torsion.analyses.undamped_modes import chord_spans

    whole = system.whole
    chords, node = chord_spans(whole), whole.condensed.node
    flexibility = (whole.flexibility / whole.span_ratio**2)[chords]
    return np.stack([node[whole.driving[chords]], node[whole.driven[chords]]]), flexibility
