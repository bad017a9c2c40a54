"""Where the torques of one train are compared in every model: couplings, gear meshes, both ends of every shaft."""

from collections.abc import Iterable
from dataclasses import dataclass
from operator import itemgetter

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.primitives import Bar

_End = tuple[int, str, int, int, float, float, float]  # number of the component, and a row of `Ends`
DRIVEN = ", driven end"


@dataclass(frozen=True)
class Ends:
    """Sections of a system in the order of its components, the same in every model.

    The torque of a lumped segment is that of its middle; at the end of the shaft it is the torque of the first (last)
    segment and what the half segment's inertia at that end takes.
    """

    name: tuple[str, ...]
    span: IntArray  # (ends,)
    station: IntArray  # (ends,) of the half segment's inertia
    lump: FloatArray  # (ends,) kg m2: that inertia, negative at a driving end; 0 where there is none
    loss_factor: FloatArray  # (ends,) of the elastic span there
    delay: FloatArray  # (ends,) s: viscous damping of that span / its stiffness

    def torque(self, w: FloatArray, angle: ComplexArray, torque: ComplexArray) -> ComplexArray:
        """(frequencies, ends) N m from angles (frequencies, stations) and torques (frequencies, spans), at own speed.

        w: (frequencies,) rad/s.
        """
        own = (w * w)[:, None] * self.lump * angle[:, self.station]
        return np.asarray(torque[:, self.span] + own)


def elastic_ends(system: System) -> Ends:
    """Every elastic span between two components, and both ends of every shaft; a massless one has one torque."""
    links = (k for k in range(_links(system)) if 0 < system.flexibility[k] < np.inf)
    return _ends(system, links, (end for bar in system.train.bars for end in _of_shaft(system, bar)))


def driving_ends(system: System) -> Ends:
    """One end a shaft, coupling, gear mesh, joint or link; none where points join rigidly."""
    parts, spans, is_rigid = system.train.parts, system.spans, system.flexibility == 0
    links = (k for k in range(_links(system)) if not parts[spans[k].part].is_point or not is_rigid[k])
    return _ends(system, links, (_of_shaft(system, bar)[0] for bar in system.train.bars))


def _links(system: System) -> int:
    """Number of the spans that are no shafts; they are the first."""
    return len(system.train.springs) + len(system.train.constraints)


def _ends(system: System, links: Iterable[int], shafts: Iterable[_End]) -> Ends:
    """Both sorts of ends in the order of the components."""
    found = list(shafts)
    for k in links:
        span, delay = system.spans[k], float(system.viscous[k] * system.flexibility[k])
        found.append((span.part, span.name, k, span.driving, 0.0, float(system.loss_factor[k]), delay))
    _, names, *columns = zip(*sorted(found, key=itemgetter(0)), strict=True) if found else ((),) * 7
    places = [np.array(column, dtype=np.int64) for column in columns[:2]]
    return Ends(names, places[0], places[1], *(np.array(column, dtype=np.float64) for column in columns[2:]))


def _of_shaft(system: System, bar: Bar) -> list[_End]:
    """A shaft's driving end, and its driven end unless it has no inertia and so one torque all along."""
    own = [k for k, span in enumerate(system.spans) if span.part == bar.part]
    first = next(k for k in own if system.spans[k].driving == bar.driving)
    half = (0.0, 0.0)
    if system.bars is None and bar.density > 0:
        lumps = bar_segments(bar, system.segments[bar.name])[1]
        half = float(lumps[0]), float(lumps[-1])
    driving = (bar.part, bar.name, first, bar.driving, -half[0], bar.loss_factor, 0.0)
    if bar.density == 0:
        return [driving]
    last = next(k for k in reversed(own) if system.spans[k].driven == bar.driven)
    return [driving, (bar.part, f"{bar.name}{DRIVEN}", last, bar.driven, half[1], bar.loss_factor, 0.0)]
