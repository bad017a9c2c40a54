"""Stations and spans while a system is put together; what is the same in every model of the shafts."""

from dataclasses import dataclass, field

import numpy as np

from torsion.assembly.system import BarSpans, Span, System
from torsion.kernels.tree import FloatArray
from torsion.primitives import Bar, Station
from torsion.train import Train


@dataclass
class Collected:
    """The stations of a train, its springs and its constraints; then the pieces of its shafts, one after another."""

    train: Train
    stations: list[Station]
    inertia: list[float]  # kg m2 at own speed
    spans: list[Span] = field(default_factory=list)
    flexibility: list[float] = field(default_factory=list)  # rad/(N m)
    viscous: list[float] = field(default_factory=list)  # N m s/rad
    loss_factor: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, train: Train) -> "Collected":
        """Everything of a train but its shafts."""
        found = cls(train, list(train.stations), [0.0] * len(train.stations))
        for lump in train.inertias:
            found.inertia[lump.station] += lump.inertia
        for spring in train.springs:
            span = Span(spring.name, spring.part, spring.driving, spring.driven)
            found.add(span, spring.flexibility, spring.viscous, spring.loss_factor)
        for mesh in train.constraints:
            found.add(Span(mesh.name, mesh.part, mesh.driving, mesh.driven, mesh.ratio, mesh.error), mesh.flexibility)
        return found

    def add(self, span: Span, flexibility: float, viscous: float = 0.0, loss_factor: float = 0.0) -> int:
        """Add a span; its position."""
        self.spans.append(span)
        self.flexibility.append(flexibility)
        self.viscous.append(viscous)
        self.loss_factor.append(loss_factor)
        return len(self.spans) - 1

    def station(self, bar: Bar, name: str) -> int:
        """A new station of a shaft."""
        first = self.stations[bar.driving]
        self.stations.append(Station(name, bar.part, first.ratio, first.sense))
        self.inertia.append(0.0)
        return len(self.stations) - 1

    def inside(self, bar: Bar, number: int) -> list[int]:
        """The driving station of a shaft of so many pieces, and new ones between its pieces."""
        return [bar.driving, *(self.station(bar, f"{bar.name} {k}/{number}") for k in range(1, number))]

    def pieces(self, bar: Bar, ends: list[int], flexibility: FloatArray, lumps: FloatArray) -> list[int]:
        """Add a span between every two `ends` and the `lumps` of inertia at them; the positions of the spans."""
        number = len(flexibility)
        names = [bar.name if number == 1 else f"{bar.name} [{piece + 1}]" for piece in range(number)]
        found = [
            self.add(Span(name, bar.part, ends[k], ends[k + 1]), float(flexibility[k]), 0.0, bar.loss_factor)
            for k, name in enumerate(names)
        ]
        for end, lump in zip(ends, lumps.tolist(), strict=True):
            self.inertia[end] += lump
        return found

    def system(self, model: str, segments: dict[str, int], bars: BarSpans | None = None) -> System:
        """The system of all that was collected."""
        return System(
            self.train, model, tuple(self.stations), tuple(self.spans), np.array(self.inertia),
            np.array(self.flexibility), np.array(self.viscous), np.array(self.loss_factor), self.train.dampers,
            segments, bars,
        )  # fmt: skip
