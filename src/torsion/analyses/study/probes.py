"""Where the torques of one train are compared in every model: couplings, gear meshes, both ends of every shaft."""

from dataclasses import dataclass

import numpy as np

from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.kernels.tree import ComplexArray, FloatArray, IntArray
from torsion.primitives import Bar, Constraint, Spring

_Probe = tuple[str, int, int, float, float, float]  # a row of `Probes`


@dataclass(frozen=True)
class Probes:
    """Sections of a system in an order that is the same in every model; torque at the driving station's speed.

    The torque of a lumped segment is that of its middle; at the end of the shaft it is the torque of the first (last)
    segment and what the half segment's inertia at that end takes.
    """

    name: tuple[str, ...]
    span: IntArray  # (probes,)
    station: IntArray  # (probes,) at which the half segment's inertia swings
    lump: FloatArray  # (probes,) kg m2: that inertia, negative at a driving end; 0 where there is none
    loss_factor: FloatArray  # (probes,) of the elastic span there
    delay: FloatArray  # (probes,) s: viscous damping of that span / its stiffness

    def torque(self, w: FloatArray, angle: ComplexArray, torque: ComplexArray) -> ComplexArray:
        """(frequencies, probes) N m from angles (frequencies, stations) and torques (frequencies, spans)."""
        own = (w * w)[:, None] * self.lump * angle[:, self.station]
        return np.asarray(torque[:, self.span] + own)


def probes(system: System) -> Probes:
    """The sections of a system: every elastic span between two components, and both ends of every shaft."""
    train, found = system.train, list[_Probe]()
    links: tuple[Spring | Constraint, ...] = (*train.springs, *train.constraints)
    for span, link in enumerate(links):
        if 0 < link.flexibility < np.inf:
            delay = float(system.viscous[span]) * link.flexibility
            found.append((link.name, span, link.driving, 0.0, float(system.loss_factor[span]), delay))
    for bar in train.bars:
        found += [(*end, bar.loss_factor, 0.0) for end in _ends(system, bar)]
    names, spans, stations, *values = zip(*found, strict=True) if found else ((),) * 6
    places = np.array(spans, dtype=np.int64), np.array(stations, dtype=np.int64)
    return Probes(tuple(names), *places, *(np.array(column, dtype=np.float64) for column in values))


def _ends(system: System, bar: Bar) -> list[tuple[str, int, int, float]]:
    """A shaft's two ends; a massless one has one torque all along."""
    own = [k for k, span in enumerate(system.spans) if span.part == bar.part]
    first = next(k for k in own if system.spans[k].driving == bar.driving)
    if bar.density == 0:
        return [(bar.name, first, bar.driving, 0.0)]
    last = next(k for k in reversed(own) if system.spans[k].driven == bar.driven)
    half = (0.0, 0.0)
    if system.bars is None:
        lumps = bar_segments(bar, system.segments[bar.name])[1]
        half = float(lumps[0]), float(lumps[-1])
    return [
        (f"{bar.name}, driving end", first, bar.driving, -half[0]),
        (f"{bar.name}, driven end", last, bar.driven, half[1]),
    ]
