"""The numbers of a train in columns on the tree of a system: the rows that kernels of many trains take."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.analyses.undamped_modes import chord_spans
from torsion.arrays import IntArray
from torsion.assembly.shafts import GAUSS, is_uniform
from torsion.assembly.system import System
from torsion.columns import NotInColumns, plain
from torsion.kernels.round_sections import polar_area_moment
from torsion.primitives import Bar
from torsion.train import Train

Numbers = NDArray[Any]  # float, or complex with the step of a slope


@dataclass(frozen=True)
class TrainRows:
    """A column for each variant, referred to one speed as in `System.condensed`."""

    flexibility: Numbers  # (tree stations, variants) rad/(N m)
    inertia: Numbers  # (tree stations, variants) kg m2; 0 where fixed
    viscous: Numbers  # (tree stations, variants) N m s/rad
    loss_factor: Numbers  # (tree stations, variants)
    closing: (
        Numbers  # (3, extra, variants) flexibility, viscous, loss factor of spans that close loops
    )

    @property
    def rows(self) -> Numbers:
        """(rows, variants) all of them, one below the other."""
        on_tree = (self.flexibility, self.inertia, self.viscous, self.loss_factor)
        return np.concatenate([*on_tree, *self.closing])


def rows_on_tree(
    system: System, train: Train, variants: int, dtype: type[Any] = float
) -> TrainRows:
    """Return the rows of a train in columns, its shafts in as many pieces as in the system of its layout.

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
        spans = bar_spans(system, bar)
        flexibility, lumps = _segments(bar, len(spans))
        elastic[0, spans] = flexibility.reshape(len(spans), -1)
        elastic[2, spans] = plain(bar.loss_factor)
        if system.bars is None:
            stations = np.append(system.driving[spans], system.driven[spans[-1]])
            inertia[stations] += lumps.reshape(len(stations), -1)

    condensed, ratio2 = system.condensed, system.span_ratio[:, None] ** 2
    with np.errstate(invalid="ignore"):  # an infinite flexibility has no complex step
        elastic *= np.array([1.0 / ratio2, ratio2, np.ones_like(ratio2)])
    on_tree = np.zeros((3, condensed.tree.size, variants), dtype=dtype)
    kept = condensed.span >= 0
    on_tree[:, condensed.span[kept]] = elastic[:, kept]
    moving = np.zeros((condensed.tree.size, variants), dtype=dtype)
    with np.errstate(invalid="ignore"):
        moving[condensed.node] = inertia * system.speed_ratio[:, None] ** 2
    moving[condensed.tree.held] = 0.0
    return TrainRows(on_tree[0], moving, on_tree[1], on_tree[2], elastic[:, condensed.extra])


def chord_rows(system: System, rows: TrainRows) -> tuple[tuple[IntArray, IntArray], Numbers]:
    """Return the stations of the tree at both ends of the chords with a stiffness, and their flexibility."""
    chords, node = chord_spans(system), system.condensed.node
    ends = node[system.driving[chords]], node[system.driven[chords]]
    return ends, rows.closing[0][np.isin(system.condensed.extra, chords)]


def bar_spans(system: System, bar: Bar) -> IntArray:
    """Return the spans of a shaft in pieces; raises NotInColumns if the system has others."""
    spans = np.flatnonzero((system.span_part == bar.part) & (system.flexibility > 0.0))
    if len(spans) != system.segments.get(bar.name):
        raise NotInColumns(f"the system has not the pieces of {bar.name}")
    return spans


def _segments(bar: Bar, number: int) -> tuple[Numbers, Numbers]:
    """Return flexibility (segments, variants) and lumped inertia (segments + 1, variants), as `bar_segments`."""
    length, modulus, density = map(plain, (bar.length, bar.shear_modulus, bar.density))
    (outer, outer_end), (bore, bore_end) = map(plain, bar.outer), map(plain, bar.bore)
    if is_uniform(bar):
        area = polar_area_moment(outer, bore)
        means = [(1.0 / area, area)] * number
    else:
        points, weight = GAUSS
        means = []
        for segment in range(number):
            along = ((segment + (points + 1.0) / 2.0) / number)[:, None]
            area = polar_area_moment(
                outer + (outer_end - outer) * along, bore + (bore_end - bore) * along
            )
            means.append((weight @ (1.0 / area) / 2.0, weight @ area / 2.0))
    flexible, heavy = (np.array(mean).reshape(number, -1) for mean in zip(*means, strict=True))
    flexible, half = (
        flexible * (length / number / modulus),
        heavy * (density * length / number / 2.0),
    )
    none = np.zeros_like(half[:1])
    return flexible, np.concatenate([half, none]) + np.concatenate([none, half])
