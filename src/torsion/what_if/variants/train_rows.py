"""The numbers of a train in columns, at the stations and spans of a system and on its tree."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.analyses.undamped_modes import chord_spans
from torsion.arrays import FloatArray
from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.columns import NotInColumns, plain
from torsion.train import Train

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


def rows_on_tree(
    system: System, train: Train, variants: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return flexibility and inertia (tree stations, variants) of a train in columns, and flexibility of chords.

    At one speed, as in `System.condensed`; the inertia of a fixed station is 0. The chords are those of `chord_spans`.
    """
    inertia, elastic = numbers_of_system(system, train, variants)
    condensed, flexibility = system.condensed, elastic[0] / system.span_ratio[:, None] ** 2
    on_tree, moving = np.zeros((2, condensed.tree.size, variants))
    kept = condensed.span >= 0
    on_tree[condensed.span[kept]] = flexibility[kept]
    moving[condensed.node] = inertia * system.speed_ratio[:, None] ** 2
    moving[condensed.tree.held] = 0.0
    return on_tree, moving, flexibility[chord_spans(system)]
