"""Response torques of a train in any model, at the sections where models are compared: driving ends of all components.

The torque of a lumped segment is that of its middle. At the driving end of the shaft stands the torque of the first
segment less what the inertia of the half segment there takes.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import pi
from operator import itemgetter

import numpy as np

from torsion.analyses.response.harmonic_components import Line, Sources, excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.study import Study


@dataclass(frozen=True)
class Ends:
    """Sections of a system in the order of its components, the same in every model."""

    name: tuple[str, ...]
    span: IntArray  # (ends,)
    station: IntArray  # (ends,) of the half segment's inertia
    lump: FloatArray  # (ends,) kg m2: that inertia; 0 where there is none


def driving_ends(system: System) -> Ends:
    """Return one end for each shaft, coupling, gear mesh, joint or link; none where points join rigidly."""
    ends = sorted([*_links(system), *_shafts(system)], key=itemgetter(0))
    _, names, spans, stations, lumps = zip(*ends, strict=True) if ends else ((),) * 5
    return Ends(names, np.array(spans, int), np.array(stations, int), np.array(lumps, float))


def _links(system: System) -> Iterator[tuple[int, str, int, int, float]]:
    """Yield component, name, span, station and lump of every span that is no shaft; these are the first."""
    for k in range(len(system.train.springs) + len(system.train.constraints)):
        span = system.spans[k]
        if not system.train.parts[span.part].is_point or system.flexibility[k] != 0:
            yield span.part, span.name, k, span.driving, 0.0


def _shafts(system: System) -> Iterator[tuple[int, str, int, int, float]]:
    """Yield the same of the driving end of every shaft."""
    for bar in system.train.bars:
        spans = (k for k, span in enumerate(system.spans) if span.part == bar.part)
        first = next(k for k in spans if system.spans[k].driving == bar.driving)
        is_lumped = system.bars is None and bar.density > 0
        lump = float(bar_segments(bar, system.segments[bar.name])[1][0]) if is_lumped else 0.0
        yield bar.part, bar.name, first, bar.driving, lump


@dataclass(frozen=True)
class Load:
    """One harmonic at every speed."""

    line: Line
    w: FloatArray  # (speeds,) rad/s
    sources: Sources
    ground: FloatArray  # (stations, speeds) N m s/rad


@dataclass(frozen=True)
class Loaded:
    """A system with what acts on it and where its torques are compared."""

    system: System
    ends: Ends
    loads: tuple[Load, ...]

    @property
    def highest(self) -> float:
        """The highest frequency at which the train is excited, Hz."""
        return max((float(load.w.max()) for load in self.loads), default=0.0) / (2.0 * pi)


@dataclass(frozen=True)
class Torques:
    """The response to one harmonic at all ends."""

    torque: ComplexArray  # (speeds, ends) N m at own speed
    residual: FloatArray  # (speeds,) relative
    status: np.ndarray  # (speeds,) uint8: kernels.tree_response.Status


def loaded(
    system: System, study: Study, speed: FloatArray, orders: tuple[Fraction, ...] | None = None
) -> Loaded:
    """Return the system with the torques and joints that excite it, and its damping, at every speed (speeds,) rad/s.

    orders: None for every order; fixed frequencies always. Raises InputError where a mean torque that an excitation or
    a damping follows is not given.
    """
    mean = steady_if_known(study, system, speed)
    ground = ground_damping(system, speed, mean)
    loads = tuple(
        Load(
            excitation.line,
            excitation.line.circular_frequency(speed),
            sources(system, excitation, speed, mean),
            ground,
        )
        for excitation in excitations(system, orders)
    )
    return Loaded(system, driving_ends(system), loads)


def response_torques(given: Loaded) -> list[Torques]:
    """Return the torques of every harmonic, and how far they can be trusted."""
    ends = given.ends
    torques = list[Torques]()
    for load in given.loads:
        solution = answer(given.system, load.w, load.sources, load.ground)
        half_segment = (load.w**2)[:, None] * ends.lump * solution.angle[:, ends.station]
        at_ends = solution.torque[:, ends.span] - half_segment
        torques.append(Torques(at_ends, solution.residual, solution.status))
    return torques
