"""The harmonics at which response torques are compared, and the two-sided elimination at them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi

import numpy as np

from torsion.analyses.compare.torque_ends import Ends, elastic_ends
from torsion.analyses.response.harmonic_components import Line, Sources, excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.study import Study


@dataclass(frozen=True)
class Harmonics:
    """Some of the harmonics of a study, at some speeds, and where their torques are compared."""

    study: Study
    speed: FloatArray  # (speeds,) rad/s of the reference station
    orders: tuple[Fraction, ...] | None = None  # None: every order; fixed frequencies always
    keys: tuple[tuple[Fraction | None, float | None], ...] | None = None  # order and frequency of those that are kept
    ends: Callable[[System], Ends] = elastic_ends


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
    """The answer to one harmonic at all ends."""

    torque: ComplexArray  # (speeds, ends) N m at own speed
    residual: FloatArray  # (speeds,) relative
    status: np.ndarray  # (speeds,) uint8: kernels.tree_response.Status


def loaded(system: System, harmonics: Harmonics) -> Loaded:
    """The system with the torques and joints that excite it, and its damping, at every speed.

    Raises InputError where a mean torque that an excitation or a damping follows is not given.
    """
    speed, loads = harmonics.speed, list[Load]()
    mean = steady_if_known(harmonics.study, system, speed)
    ground = ground_damping(system, speed, mean)
    for one in excitations(system, harmonics.orders):
        line = one.line
        if harmonics.keys is None or (line.order, line.frequency) in harmonics.keys:
            loads.append(Load(line, line.circular_frequency(speed), sources(system, one, speed, mean), ground))
    return Loaded(system, harmonics.ends(system), tuple(loads))


def elimination(given: Loaded) -> list[Torques]:
    """The torques of every harmonic by two-sided elimination, and how far they can be trusted."""
    found = ((load, answer(given.system, load.w, load.sources, load.ground)) for load in given.loads)
    return [Torques(given.ends.torque(load.w, one.angle, one.torque), one.residual, one.status) for load, one in found]


def eliminated(given: Loaded) -> list[ComplexArray]:
    """Torques (speeds, ends) N m of every harmonic by two-sided elimination."""
    return [one.torque for one in elimination(given)]


def statically(given: Loaded, low: float) -> list[ComplexArray]:
    """Torques (speeds, spans) N m of the undamped train when its torques change slowly: at `low` rad/s.

    A free train then accelerates as a whole, and its spans carry what this takes.
    """
    system = given.system
    none = np.zeros(len(system.spans))
    still = replace(system, viscous=none, loss_factor=none, dampers=())
    return [
        answer(still, np.full(len(load.w), low), load.sources, np.zeros_like(load.ground)).torque
        for load in given.loads
    ]
