"""Natural frequencies of variants that differ in numbers alone, all at once, from a train in columns."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.analyses.discretisation import highest_excited
from torsion.analyses.undamped_modes import chord_spans, modes, undamped_tree
from torsion.arrays import FloatArray, IntArray
from torsion.assembly import (
    SHARE_OF_ERROR,
    as_divided,
    excess,
    is_refined,
    of_train,
    segments_along,
)
from torsion.assembly.segments import bar_segments, phase
from torsion.assembly.system import System
from torsion.columns import NotInColumns, plain
from torsion.errors import SolveError
from torsion.findings import Work
from torsion.study import Variation
from torsion.train import Train
from torsion.what_if.variants.chunks import Answers, solved

Numbers = NDArray[Any]  # float, or complex with the step of a slope


def numbers_of_system(
    system: System, train: Train, variants: int, dtype: type[Any] = float
) -> tuple[Numbers, Numbers]:
    """Return the numbers of a train in columns, its shafts in as many pieces as in the system of its layout.

    Inertia kg m2 (stations, variants); flexibility rad/(N m), damper N m s/rad and loss factor (3, spans, variants).
    Raises NotInColumns if the train has a shaft that the system does not have in these pieces.
    """
    inertia = np.zeros((len(system.stations), variants), dtype=dtype)
    elastic = np.zeros((3, len(system.spans), variants), dtype=dtype)
    for lump in train.inertias:
        inertia[lump.station] += plain(lump.inertia)
    for span, element in enumerate((*train.springs, *train.constraints)):
        for row, name in enumerate(("flexibility", "viscous", "loss_factor")):
            elastic[row, span] = plain(getattr(element, name, 0.0))
    for bar in train.bars:
        is_piece = (system.span_part == bar.part) & (system.flexibility > 0.0)
        spans = np.flatnonzero(is_piece)
        if len(spans) != system.segments.get(bar.name):
            raise NotInColumns(f"the system has not the pieces of {bar.name}")
        flexibility, lumps = bar_segments(bar, len(spans))
        elastic[0, spans] = flexibility.reshape(len(spans), -1)
        elastic[2, spans] = plain(bar.loss_factor)
        stations = np.append(system.driving[spans], system.driven[spans[-1]])
        inertia[stations] += lumps.reshape(len(stations), -1)
    return inertia, elastic


ROUNDS = 3  # with the segments that lumped shafts have for the last mode of a variant
ONE_SEGMENT = 4.0 * SHARE_OF_ERROR  # relative, over segments: as far may one segment move a mode
FEW = 16  # variants with the same segments: fewer are sooner solved separately


def frequencies(
    work: Work, variation: Variation, values: FloatArray, count: int, *, least: int = 1
) -> Answers:
    """Return the `count` lowest frequencies of variants (variants, figures): all at once if possible.

    Variants of another layout, and all if there are fewer than `least`, are solved separately.
    """
    answers = Answers(np.full((count, len(values)), np.nan))
    if len(values) >= least and count and "system" in work.results:
        try:
            train = variation.in_columns(values)
            system = of_train(work.system, variation.base.train)
            highest = highest_excited(work.study, work.system, work.ruled)
            answers.frequency[:] = certified(system, train, len(values), count, highest)
        except (NotInColumns, SolveError):
            pass  # variants of several layouts are solved separately

    left = np.flatnonzero(np.isnan(answers.frequency).any(axis=0))
    if not count or left.size == len(values):
        left, answers.method = np.arange(len(values)), "every variant solved separately"
    else:
        separate = f"; {left.size} variant{'s' * (left.size > 1)} solved separately" * (
            left.size > 0
        )
        answers.method = f"frequencies of all variants at once, each certified by counts{separate}"
    alone = solved(work, variation, values[left], count, judged=False)
    answers.frequency[:, left] = alone.frequency
    answers.faults = {int(left[variant]): why for variant, why in alone.faults.items()}
    return answers


def certified(
    system: System, train: Train, variants: int, count: int, highest: float = 0.0
) -> FloatArray:
    """Return frequencies (count, variants) Hz of a train in columns by the kernels of many trains.

    system: of one of the variants. Lumped shafts are divided as for every variant alone, for its last mode and for
    `highest` (Hz); NaN for variants of which few have these segments, or that are near a change of them. Raises
    NotInColumns, and SolveError as the kernels do.
    """
    if system.tables:
        raise NotInColumns("a stiffness follows a table")
    base = modes(system, count).system
    if base.bars is not None:
        raise NotInColumns("distributed shafts are solved variant by variant")
    hertz_found = np.full((count, variants), np.nan)
    refined = tuple(bar for bar in train.bars if is_refined(bar))
    travels = [phase(bar, 1.0) for bar in refined]
    travel = np.array([plain(turned) + np.zeros(variants) for turned in travels])
    multiples = np.array([excess(bar) for bar in refined], dtype=float).reshape(-1, 1)
    waiting = {tuple(base.segments[bar.name] for bar in refined): np.arange(variants)}

    for _ in range(ROUNDS):
        left = dict[tuple[int, ...], list[IntArray]]()
        for numbers, places in waiting.items():
            names = (bar.name for bar in refined)
            segments = {**base.segments, **dict(zip(names, numbers, strict=True))}
            divided = as_divided(replace(base, segments=segments), base.train)
            hertz = _as_divided(divided, train, variants, count, places)
            if not refined:
                return hertz

            # A variant alone may have one segment more or less where its last mode is near a change of them.
            near = 1.0 + np.array([-1.0, 0.0, 1.0])[:, None] * ONE_SEGMENT / min(numbers)
            top = np.maximum(highest, hertz[-1] * near)
            needed = segments_along(travel[:, None, places] * top, multiples[..., None]).astype(
                np.int64
            )
            is_right = (needed[:, 1] == np.array(numbers)[:, None]).all(axis=0)
            is_sure = is_right & (needed[:, 0] == needed[:, 2]).all(axis=0)
            hertz_found[:, places[is_sure]] = hertz[:, is_sure]
            for segments_needed in {*map(tuple, needed[:, 1, ~is_right].T.tolist())}:
                is_same = (needed[:, 1] == np.array(segments_needed)[:, None]).all(axis=0)
                left.setdefault(segments_needed, []).append(places[is_same])
        enough = min(FEW, variants // 2)
        groups = {numbers: np.concatenate(lists) for numbers, lists in left.items()}
        waiting = {
            numbers: members for numbers, members in groups.items() if len(members) >= enough
        }
    return hertz_found


def _as_divided(
    system: System, train: Train, variants: int, count: int, places: IntArray
) -> FloatArray:
    """Return frequencies (count, places) Hz with the shafts in the pieces of the system; NaN if counts fail."""
    tree, chords, condensed = undamped_tree(system), chord_spans(system), system.condensed
    numbers, elastic = numbers_of_system(system, train, variants)

    # Of the stations of the tree, at one speed as in `System.condensed`; the inertia of a fixed station is 0.
    of_spans = elastic[0][:, places] / system.span_ratio[:, None] ** 2
    flexibility, inertia = np.zeros((2, condensed.tree.size, len(places)))
    kept = condensed.span >= 0
    flexibility[condensed.span[kept]] = of_spans[kept]
    flexibility[tree.parent < 0] = 0.0
    inertia[condensed.node] = numbers[:, places] * system.speed_ratio[:, None] ** 2
    inertia[condensed.tree.held] = 0.0
    try:
        if len(chords):
            from torsion.kernels.modes.variant_networks import network_modes

            ends = condensed.node[system.driving[chords]], condensed.node[system.driven[chords]]
            modes_found = network_modes(tree, flexibility, inertia, count, ends, of_spans[chords])
        else:
            from torsion.kernels.modes.variant_modes import variant_modes

            modes_found = variant_modes(tree, flexibility, inertia, count)
    except (SolveError, ValueError):  # a variant has too few modes, or needs shorter pieces
        return np.full((count, flexibility.shape[1]), np.nan)
    return modes_found.frequency / (2.0 * np.pi)
