"""Natural frequencies of many variants side by side, each proven, and of others one by one."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from torsion.analyses.discretisation import highest_excited
from torsion.arrays import FloatArray, IntArray
from torsion.assembly import as_divided, of_train
from torsion.assembly.lumped import SHARE_OF_ERROR, excess, is_refined, segments_along
from torsion.assembly.shafts import phase
from torsion.assembly.system import System
from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.kernels.tree import Tree
from torsion.study import Study, Variation
from torsion.what_if.variants.one_by_one import Answers, reason, solved
from torsion.what_if.variants.products import Rows, products

ATTEMPTS = (
    3  # at the segments that lumped shafts have by themselves, for the last mode of a variant
)
BESIDE = (
    4.0 * SHARE_OF_ERROR
)  # relative, over segments: how far one segment of a shaft may move the last mode
FEW = 16  # variants with the same segments: fewer are sooner solved by themselves


def frequencies(
    work: Work, variation: Variation, values: FloatArray, count: int, *, least: int = 1
) -> Answers:
    """Of variants (variants, figures) the lowest frequencies alone: side by side where that is possible.

    least: variants of a group for which that is tried.
    """
    found, left = together(work, variation, values, count, least=least)
    if not left.size:
        found.method = "frequencies of all variants side by side, each certified by counts"
    elif left.size < len(values):
        rest = (
            "1 variant solved by itself"
            if left.size == 1
            else f"{left.size} variants solved by themselves"
        )
        found.method = f"frequencies side by side, each certified by counts; {rest}"
    else:
        found.method = "every variant solved by itself"
    return solved(work, variation, values, count, judged=False, known=found, places=left.tolist())


def together(
    work: Work, variation: Variation, values: FloatArray, count: int, *, least: int = 1
) -> tuple[Answers, IntArray]:
    """Frequencies of the groups of variants (variants, figures) that are side by side, and the places of all others.

    Rows of lists that differ in numbers alone are one group; where these do not enter as they should, every combination
    of rows is one. Such a one that is at fault leaves its variants without an answer.
    """
    found, left = Answers.unknown(count, len(values)), np.arange(len(values))
    if not count or "system" not in work.results:
        return found, left
    highest = highest_excited(work.study, work.system, work.ruled)
    listed = [place for place, one in enumerate(variation.figures) if one.rows]
    for apart in ([], listed) if listed else ([],):
        done = list[IntArray]()
        for group in variation.groups(values[left], apart) if left.size else ():
            places = left[group.places]
            if len(places) < least or not group.values.shape[1]:
                continue
            try:
                study = group.variation.study([one.nominal for one in group.variation.figures])
                system = of_train(work.system, study.train)
            except (InputError, SolveError) as error:
                if apart:
                    found.faults.update(dict.fromkeys(places.tolist(), reason(error)))
                    done.append(places)
                continue
            own = side_by_side(system, group.variation, group.values, count, highest)
            if own is not None:
                known = np.isfinite(own).all(axis=0)
                found.frequency[:, places[known]] = own[:, known]
                done.append(places[known])
        left = np.setdiff1d(left, np.concatenate([np.empty(0, dtype=np.intp), *done]))
    return found, left


def side_by_side(
    system: System, variation: Variation, values: FloatArray, count: int, highest: float = 0.0
) -> FloatArray | None:
    """Frequencies (modes, variants) Hz by the kernels of many trains; None where they do not take them.

    Inertias and flexibilities have to be products of powers of the figures (a stiffness, a length, a diameter), or sums
    in which each has a share (an inertia beside another), which trials show. Lumped shafts are divided as for every
    variant by itself, for its last mode and for `highest` (Hz); NaN where few have these segments, or none surely.
    """
    if not count or system.tables or (system.bars is not None and system.bars.degree):
        return None
    if system.bars is not None:  # pieces of the shafts as short as the counts of these modes need
        from torsion.analyses.undamped_modes import modes

        system = modes(system, count).system
        system = replace(
            system, requested=replace(system.requested, frequency=0.0)
        )  # of variants: as it is divided
        answer = _divided_alike(system, (), variation, values, count)
        return None if answer is None else answer[0]
    found, bars = (
        np.full((count, len(values)), np.nan),
        tuple(filter(is_refined, system.train.bars)),
    )
    names, more = tuple(bar.name for bar in bars), np.array([excess(bar) for bar in bars])[:, None]
    waiting = {tuple(system.segments[name] for name in names): np.arange(len(values))}
    for attempt in range(ATTEMPTS):
        left: dict[tuple[int, ...], list[IntArray]] = {}
        for numbers, places in waiting.items():
            own = replace(
                system, segments={**system.segments, **dict(zip(names, numbers, strict=True))}
            )
            answer = _divided_alike(
                as_divided(own, system.train), names, variation, values[places], count
            )
            if answer is None:
                if not attempt:
                    return None
                continue
            near = BESIDE / min(
                numbers, default=1
            )  # by itself a variant may have one segment more or less there
            low, needed, high = (
                segments_along(answer[1] * np.maximum(highest, answer[0][-1] * share), more).astype(
                    np.int64
                )
                for share in (1.0 - near, 1.0, 1.0 + near)
            )
            is_right = (needed == np.array(numbers, dtype=np.int64)[:, None]).all(axis=0)
            is_sure = is_right & (low == high).all(axis=0)
            found[:, places[is_sure]] = answer[0][:, is_sure]
            for other in {*map(tuple, needed[:, ~is_right].T.tolist())}:
                same = (needed == np.array(other)[:, None]).all(axis=0)
                left.setdefault(other, []).append(places[same])
        joined = {numbers: np.concatenate(each) for numbers, each in left.items()}
        waiting = {
            numbers: each
            for numbers, each in joined.items()
            if len(each) >= min(FEW, len(values) // 2)
        }
    return found


def _divided_alike(
    system: System, refined: Collection[str], variation: Variation, values: FloatArray, count: int
) -> tuple[FloatArray, FloatArray] | None:
    """Frequencies (modes, variants) Hz with shafts in as many pieces as those of the system; None as above.

    Also the phase (refined shafts, variants) along each of these for 1 Hz.
    """
    base, (at, own_chord), figures = _tree(system), _chords(system), _figures(_tree(system))

    def read(study: Study) -> Rows | None:
        own = as_divided(system, study.train)
        if len(own_chord) and len(own.spans) == len(
            system.spans
        ):  # the stiffest spans of a variant may be others
            own = replace(
                own, in_tree=~np.isin(np.arange(len(system.spans)), system.condensed.extra)
            )
        (ends, chord), tree = _chords(own), _tree(own)
        same = np.array_equal(tree.parent, base.parent) and np.array_equal(ends, at)
        along = [phase(bar, 1.0) for bar in own.train.bars if bar.name in refined]
        rows = np.concatenate(
            [tree.flexibility, tree.moving_inertia, chord, _figures(tree), along]
        )[:, None]
        return rows if same and len(rows) == len(whole) else None

    along = np.array([phase(bar, 1.0) for bar in system.train.bars if bar.name in refined])
    whole = np.concatenate([base.flexibility, base.moving_inertia, own_chord, figures, along])
    found = products(variation, values, read)
    if found is None:
        return None
    edges = np.cumsum([base.size, base.size, len(own_chord), len(figures)])
    flexibility, inertia, chord, factors, phases = np.split(found.factors(values), edges)
    flexibility *= base.flexibility[:, None]
    inertia *= base.moving_inertia[:, None]
    try:
        if len(chord) or len(figures):
            from torsion.kernels.variant_networks import network_modes

            chord *= own_chord[:, None]
            many = network_modes(base, flexibility, inertia, count, (at[0], at[1]), chord, factors)
        else:
            from torsion.kernels.variant_modes import variant_modes

            many = variant_modes(base, flexibility, inertia, count)
    except (
        SolveError,
        ValueError,
    ):  # a variant that needs shorter pieces of its shafts, or has too few modes in these
        return None
    return many.frequency / (2.0 * np.pi), phases * along[:, None]


def _tree(system: System) -> Tree:
    from torsion.analyses.undamped_modes import undamped_tree

    return undamped_tree(system.whole)


def _figures(tree: Tree) -> FloatArray:
    """All numbers of the laws of distributed shafts."""
    laws = [] if tree.shafts is None else tree.shafts.laws
    return np.concatenate([np.empty(0), *(law.figures for law in laws)])


def _chords(system: System) -> tuple[IntArray, FloatArray]:
    """Stations of the tree (2, chords) at the ends of the spans that close loops, and their flexibility (chords,)."""
    from torsion.analyses.undamped_modes import chord_spans

    whole = system.whole
    chords, node = chord_spans(whole), whole.condensed.node
    flexibility = (whole.flexibility / whole.span_ratio**2)[chords]
    return np.stack([node[whole.driving[chords]], node[whole.driven[chords]]]), flexibility
