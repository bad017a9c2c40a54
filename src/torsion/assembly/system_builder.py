"""Stations and spans while a system is put together; what is the same in every model of the shafts."""

from dataclasses import dataclass, field
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.spans import Row, Span
from torsion.assembly.system import Discretisation, System
from torsion.errors import Fault, InputError, SolveError
from torsion.primitives import Bar, Station
from torsion.train import Train

if TYPE_CHECKING:
    from torsion.assembly.distributed_spans import BarSpans

MOST_STATIONS = 20_000


@dataclass
class Collected:
    """The stations of a train, its springs and its constraints; then its shafts, one after another."""

    train: Train
    stations: list[Station]
    inertia: list[float]  # kg m2 at own speed
    spans: list[Span] = field(default_factory=list)
    elastic: list[tuple[float, float, float]] = field(
        default_factory=list
    )  # rad/(N m), N m s/rad, loss factor
    rows: list[Row] = field(default_factory=list)  # behind all stations and spans
    inner_inertia: list[FloatArray] = field(
        default_factory=list
    )  # of each row: (segments - 1,) kg m2
    row_flexibility: list[FloatArray] = field(
        default_factory=list
    )  # of each row: (segments,) rad/(N m)

    @classmethod
    def of(cls, train: Train) -> "Collected":
        """Everything of a train but its shafts."""
        collected = cls(train, list(train.stations), [0.0] * len(train.stations))
        for lump in train.inertias:
            collected.inertia[lump.station] += lump.inertia
        for spring in train.springs:
            span = Span(spring.name, spring.part, spring.driving, spring.driven)
            collected.add(span, spring.flexibility, spring.viscous, spring.loss_factor)
        for mesh in train.constraints:
            collected.add(
                Span(mesh.name, mesh.part, mesh.driving, mesh.driven, mesh.ratio, mesh.error),
                mesh.flexibility,
            )
        return collected

    def add(
        self, span: Span, flexibility: float, viscous: float = 0.0, loss_factor: float = 0.0
    ) -> None:
        self.spans.append(span)
        self.elastic.append((flexibility, viscous, loss_factor))

    def one_by_one(self, row: Row, flexibility: FloatArray, lumps: FloatArray) -> None:
        """Add the stations between the pieces of a shaft, its inertia lumped at their ends, and its spans."""
        self.stations += row.inner_stations
        self.inertia += [0.0] * (row.number - 1)
        for end, lump in zip(row.stations.tolist(), lumps.tolist(), strict=True):
            self.inertia[end] += lump
        for k, segment_flexibility in enumerate(flexibility.tolist()):
            self.add(row.span(k), segment_flexibility, 0.0, row.bar.loss_factor)

    def row(self, bar: Bar, flexibility: FloatArray, lumps: FloatArray) -> None:
        """Add a whole shaft in segments; no station or span of another kind may be added after it."""
        inside = len(self.stations) + sum(map(len, self.inner_inertia))
        self.rows.append(Row(bar, len(flexibility), inside, self.stations[bar.driving]))
        self.inertia[bar.driving] += float(lumps[0])
        self.inertia[bar.driven] += float(lumps[-1])
        self.inner_inertia.append(lumps[1:-1])
        self.row_flexibility.append(flexibility)

    def _refuse(self, number: int, segments: dict[str, int]) -> None:
        """Raise InputError where the file states so many stations, SolveError where the program divides shafts."""
        message = f"the train has {number} stations; at most {MOST_STATIONS} are computed"
        finest = max(self.train.bars, key=lambda bar: segments[bar.name], default=None)
        if finest is None or finest.segments is not None:
            path = () if finest is None else (*self.train.parts[finest.part].path, "segments")
            raise InputError([Fault(path, message, "give fewer segments, or `model: exact`")])
        raise SolveError(f"{message}; request fewer modes, a lower frequency, or `model: exact`")

    def system(
        self,
        model: str,
        segments: dict[str, int],
        requested: Discretisation,
        resolved_to: float,
        bars: "BarSpans | None" = None,
    ) -> System:
        """Return the system of all that was collected; resolved_to: Hz.

        Raises SolveError for distributed shafts in a train with closed loops, and for more than MOST_STATIONS stations
        of shafts that the program divides; InputError for as many that the file states.
        """
        rows = self.rows
        number = len(self.stations) + sum(map(len, self.inner_inertia))
        if number > MOST_STATIONS:
            self._refuse(number, segments)
        flexibility, viscous, loss_factor = np.array(self.elastic, dtype=float).reshape(-1, 3).T
        loss = [np.full(row.number, row.bar.loss_factor) for row in rows]
        system = System(
            self.train,
            model,
            tuple(chain(self.stations, *(row.inner_stations for row in rows))),
            tuple(chain(self.spans, *(row.spans for row in rows))),
            np.concatenate([self.inertia, *self.inner_inertia]),
            np.concatenate([flexibility, *self.row_flexibility]),
            np.concatenate([viscous, *map(np.zeros_like, loss)]),
            np.concatenate([loss_factor, *loss]),
            self.train.dampers,
            segments,
            bars,
            tuple(rows),
            requested,
            resolved_to,
            tables={
                span: spring.table
                for span, spring in enumerate(self.train.springs)
                if spring.table is not None
            },
        )
        if bars is not None and system.condensed.extra.size:
            why = "no closed loops, and no train that rigid spans hold at several points"
            raise SolveError(f"the model {model} takes {why}; use the lumped model")
        return system
