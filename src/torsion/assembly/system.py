"""The system kept in factors: stations, spans and their data, and the tree that the sweeps run over."""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from torsion.assembly.folding import Folded, fold
from torsion.kernels.tree import BoolArray, FloatArray, IntArray
from torsion.primitives import Damper, Station
from torsion.train import Train


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
class System:
    """A train assembled. Twist of a span = driving angle - driven angle / its ratio; its torque is positive when the
    driving side pushes the driven one, and is told at the driving station's speed."""

    train: Train
    model: str
    stations: tuple[Station, ...]
    spans: tuple[Span, ...]
    inertia: FloatArray  # (stations,) kg m2 at own speed; infinite where held
    flexibility: FloatArray  # (spans,) rad/(N m) at the driving station's speed; 0 rigid, inf viscous only
    viscous: FloatArray  # (spans,) N m s/rad
    loss_factor: FloatArray  # (spans,)
    dampers: tuple[Damper, ...]
    segments: dict[str, int]  # of every bar, by name

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
