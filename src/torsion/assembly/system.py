"""The system kept in factors: stations, spans and their data, and the tree that the sweeps run over."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from torsion.assembly.folding import Folded, fold
from torsion.kernels.sections import polar_area_moment
from torsion.kernels.tree import BoolArray, FloatArray, IntArray
from torsion.primitives import Bar, Damper, Station
from torsion.train import Train

if TYPE_CHECKING:
    from torsion.kernels.bars import Bars


@dataclass(frozen=True, slots=True)
class Span:
    """An elastic or rigid piece between two stations, or a mesh or joint."""

    name: str
    part: int
    driving: int
    driven: int
    ratio: Fraction = Fraction(1)  # speed of the driven / speed of the driving station
    error: tuple[tuple[int, complex], ...] = ()  # of the driven angle, over the driving station's angle


@dataclass(frozen=True)
class Piece:
    """A stretch of a shaft: the one of the given position among so many of equal length."""

    bar: Bar
    position: int
    number: int

    @property
    def length(self) -> float:
        """m."""
        return self.bar.length / self.number

    def polar_area_moment(self, x: FloatArray) -> FloatArray:
        """I_p in m4 at `x`, from 0 at the driving to 1 at the driven end of the piece."""
        at = (self.position + x) / self.number
        outer, bore = self.bar.outer, self.bar.bore
        return polar_area_moment(outer[0] + (outer[1] - outer[0]) * at, bore[0] + (bore[1] - bore[0]) * at)


@dataclass(frozen=True)
class BarSpans:
    """The spans with distributed inertia, of the models `fem` and `exact`; pieces of uniform shafts come first.

    Such a span has two torques. The one told is that at its driving station; the one at the driven end of the whole
    shaft is that of the massless rigid span `<shaft>, driven end`.
    """

    span: IntArray  # (bars,) position of the span
    lumped: FloatArray  # (stations,) kg m2 at own speed, without the inertia of the bars
    ends: IntArray  # (bars, 2) stations at which half the inertia of each bar is told: driving and driven
    pieces: tuple[Piece, ...]  # (bars,)
    stiffness: FloatArray | None = None  # (bars, degree + 1, degree + 1) N m/rad of a finite element, own speed
    inertia: FloatArray | None = None  # (bars, degree + 1, degree + 1) kg m2; first the driving, then the driven end
    degree: int = 0  # of the finite elements; 0 for the exact model
    error: float = 0.0  # estimated, relative, of a shaft's highest frequency asked for


@dataclass(frozen=True)
class System:
    """A train assembled. Twist of a span = driving angle - driven angle / its ratio; its torque is positive when the
    driving side pushes the driven one, and is told at the driving station's speed."""

    train: Train
    model: str
    stations: tuple[Station, ...]
    spans: tuple[Span, ...]
    inertia: FloatArray  # (stations,) kg m2 at own speed; infinite where held; half of each piece of a shaft included
    flexibility: FloatArray  # (spans,) rad/(N m) at the driving station's speed; 0 rigid, inf viscous only
    viscous: FloatArray  # (spans,) N m s/rad
    loss_factor: FloatArray  # (spans,)
    dampers: tuple[Damper, ...]
    segments: dict[str, int]  # of every bar, by name: segments, elements or pieces
    bars: BarSpans | None = None  # of the models `fem` and `exact`, where a shaft has inertia

    @cached_property
    def speed_ratio(self) -> FloatArray:
        """(stations,) speed of each station / reference speed."""
        ratios = [station.ratio for station in self.stations]
        return np.array([ratio.numerator / ratio.denominator for ratio in ratios])

    @cached_property
    def span_ratio(self) -> FloatArray:
        """(spans,) speed at which each span's torque is told / reference speed."""
        return self.speed_ratio[self.driving]

    @cached_property
    def driving(self) -> IntArray:
        """(spans,) driving station of each span."""
        return np.array([span.driving for span in self.spans], dtype=np.int64)

    @cached_property
    def driven(self) -> IntArray:
        """(spans,) driven station of each span."""
        return np.array([span.driven for span in self.spans], dtype=np.int64)

    @cached_property
    def held(self) -> BoolArray:
        """(stations,) where the station turns at exactly its mean speed."""
        return np.isinf(self.inertia)

    @cached_property
    def folded(self) -> Folded:
        """The train referred to one speed, as a tree (and the spans that close loops)."""
        return fold(self)

    @cached_property
    def lumped_inertia(self) -> FloatArray:
        """(stations,) kg m2 at own speed, without that of spans with distributed inertia; infinite where held."""
        return self.inertia if self.bars is None else self.bars.lumped

    @cached_property
    def folded_bars(self) -> "Bars | None":
        """The spans with distributed inertia, on the tree; None in the lumped model."""
        if self.bars is None:
            return None
        from torsion.assembly.bar_laws import folded_bars

        span, folded = self.bars.span, self.folded
        return folded_bars(self.bars, folded.span[span], self.span_ratio[span], folded.sign[span] < 0)

    @cached_property
    def damps(self) -> bool:
        """Anything in the train takes energy out."""
        return bool(self.dampers) or bool(np.any(self.viscous > 0)) or bool(np.any(self.loss_factor > 0))

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
