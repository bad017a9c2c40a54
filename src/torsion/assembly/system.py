"""The system kept in factors: stations, spans and their data, and the tree that the sweeps run over."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.distributed_spans import BarSpans
from torsion.assembly.referred_tree import CondensedTrain, fold
from torsion.assembly.spans import Row, Span
from torsion.primitives import Damper, Station
from torsion.train import Train

if TYPE_CHECKING:
    from torsion.assembly.segment_groups import SegmentGroups
    from torsion.kernels.distributed.span_laws import Shafts


@dataclass(frozen=True)
class Discretisation:
    """What was requested of the shafts: a highest frequency and, of the model `fem`, degree and number of elements."""

    frequency: float = 0.0  # Hz
    degree: int | None = None  # None: what the frequency needs
    elements: int | None = None  # of every shaft; None: what the frequency needs


@dataclass(frozen=True)
class System:
    """A train assembled. Twist of a span = driving angle - driven angle / its ratio; its torque is positive when the
    driving side pushes the driven one, and is reported at the driving station's speed."""

    train: Train
    model: str
    stations: Sequence[Station]
    spans: Sequence[Span]
    inertia: FloatArray  # (stations,) kg m2 at own speed; infinite where fixed; half of each piece of a shaft included
    flexibility: FloatArray  # (spans,) rad/(N m) at the driving station's speed; 0 rigid, inf viscous only
    viscous: FloatArray  # (spans,) N m s/rad
    loss_factor: FloatArray  # (spans,)
    dampers: tuple[Damper, ...]
    segments: dict[str, int]  # of every shaft, by name: segments, elements or pieces
    bars: BarSpans | None = None  # of the models `fem` and `exact`, where a shaft has inertia
    rows: tuple[Row, ...] = ()  # shafts in segments, whose inner stations and spans come last, row by row
    requested: Discretisation = Discretisation()
    resolved_to: float = math.inf  # Hz, up to which the shafts keep the error of their model; see `assemble`
    groups: "SegmentGroups | None" = None  # of a condensed system: the segments that its spans stand for

    @property
    def whole(self) -> "System":
        """The system of all segments, of which this one is condensed; itself where it is not."""
        return self if self.groups is None else self.groups.system

    @property
    def own_stations(self) -> int:
        """How many stations are not between the segments of a row; they come first."""
        return len(self.stations) - sum(row.number - 1 for row in self.rows)

    @property
    def own_spans(self) -> Sequence[Span]:
        """The spans that are no segments of a row; they come first."""
        return self.spans[: len(self.spans) - sum(row.number for row in self.rows)] if self.rows else self.spans

    @cached_property
    def speed_ratio(self) -> FloatArray:
        """(stations,) speed of each station / reference speed."""
        own = [station.ratio for station in self.stations[: self.own_stations]]
        inside = [np.full(row.number - 1, float(row.begin.ratio)) for row in self.rows]
        return np.concatenate([np.array([r.numerator / r.denominator for r in own], dtype=np.float64), *inside])

    @cached_property
    def station_part(self) -> IntArray:
        """(stations,) the component that made each station, as a position in the train's parts."""
        own = [station.part for station in self.stations[: self.own_stations]]
        inside = [np.full(row.number - 1, row.bar.part) for row in self.rows]
        return np.concatenate([np.array(own, dtype=np.int64), *inside])

    @cached_property
    def span_part(self) -> IntArray:
        """(spans,) the component that made each span."""
        return self._over_spans(lambda span: span.part, lambda row: np.full(row.number, row.bar.part))

    @cached_property
    def span_ratio(self) -> FloatArray:
        """(spans,) speed at which each span's torque is reported / reference speed."""
        return self.speed_ratio[self.driving]

    def twist(self, referred: np.ndarray) -> np.ndarray:
        """(spans, columns) twist of every span at its driving station's speed: driving - driven angle / ratio.

        referred: (stations, columns) angles referred to the reference speed.
        """
        return np.asarray((referred[self.driving] - referred[self.driven]) * self.span_ratio[:, None])

    @cached_property
    def driving(self) -> IntArray:
        """(spans,) driving station of each span."""
        return self._over_spans(lambda span: span.driving, lambda row: row.stations[:-1])

    @cached_property
    def driven(self) -> IntArray:
        """(spans,) driven station of each span."""
        return self._over_spans(lambda span: span.driven, lambda row: row.stations[1:])

    @cached_property
    def held(self) -> BoolArray:
        """(stations,) where the station turns at exactly its mean speed."""
        return np.isinf(self.inertia)

    @cached_property
    def condensed(self) -> CondensedTrain:
        """The train referred to one speed, as a tree (and the spans that close loops)."""
        return fold(self)

    @cached_property
    def lumped_inertia(self) -> FloatArray:
        """(stations,) kg m2 at own speed, without that of spans with distributed inertia; infinite where fixed."""
        if self.groups is not None:
            return self.groups.system.inertia[self.groups.stations]
        return self.inertia if self.bars is None else self.bars.lumped

    @cached_property
    def condensed_shafts(self) -> "Shafts | None":
        """The spans with distributed inertia and the segment groups, on the tree; None where there are none."""
        groups, bars, condensed = self.groups, self.bars, self.condensed
        if groups is not None:
            from torsion.kernels.distributed.span_laws import Shafts

            span = np.flatnonzero(groups.last_span > groups.first_span)
            law = groups.chains(span, self.span_ratio[span])
            return Shafts(condensed.span[span], (law.turned(condensed.sign[span] < 0),))
        if bars is None:
            return None
        return bars.laws(condensed.span[bars.span], self.span_ratio[bars.span], condensed.sign[bars.span] < 0)

    @cached_property
    def damps(self) -> bool:
        """Anything in the train takes energy out."""
        return bool(self.dampers) or bool(np.any(self.viscous > 0)) or bool(np.any(self.loss_factor > 0))

    def _over_spans(self, of: Callable[[Span], int], over: Callable[[Row], IntArray]) -> IntArray:
        """(spans,) what is known of every span one by one, and of every row at once."""
        own = np.array([of(span) for span in self.own_spans], dtype=np.int64)
        return np.concatenate([own, *map(over, self.rows)])

    def ground_damping(self, speed: FloatArray, mean_torque: FloatArray) -> FloatArray:
        """(stations, speeds) N m s/rad, at reference speeds (rad/s) and mean torques (stations, speeds) N m applied."""
        damping = np.zeros((len(self.stations), len(speed)))
        for damper in self.dampers:
            own = speed * self.speed_ratio[damper.station]
            row = damper.constant + damper.speed_factor * own
            if damper.torque_factor:
                row = row + damper.torque_factor * np.abs(mean_torque[damper.station]) / own
            damping[damper.station] += row
        return damping
