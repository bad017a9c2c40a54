"""The harmonics at which the response of one train is compared, and the two-sided elimination at them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi

import numpy as np

from torsion.analyses.response.excitation import Line, Sources, excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.study.probes import Probes, probes
from torsion.assembly.system import System
from torsion.kernels.tree import ComplexArray, FloatArray
from torsion.study import Study

Key = tuple[Fraction | None, float | None]  # order, frequency
LINES = 3  # that are compared: those with the largest torques
NEGLIGIBLE = 1e-9  # of the largest torque of a line: torques that stay below are rounding and are not compared


@dataclass(frozen=True)
class Harmonics:
    """Some of the lines of a study, at some speeds."""

    study: Study
    speed: FloatArray  # (speeds,) rad/s of the reference station
    keys: tuple[Key, ...] | None = None  # None: every line


@dataclass(frozen=True)
class Load:
    """One line at every speed."""

    line: Line
    w: FloatArray  # (speeds,) rad/s
    sources: Sources
    ground: FloatArray  # (stations, speeds) N m s/rad


@dataclass(frozen=True)
class Loaded:
    """A system with what acts on it and where its torques are compared."""

    system: System
    probes: Probes
    loads: tuple[Load, ...]


def loaded(system: System, harmonics: Harmonics) -> Loaded:
    """The system with the torques and joints that excite it, and its damping, at every speed."""
    speed = harmonics.speed
    mean = steady_if_known(harmonics.study, system, speed)
    ground = ground_damping(system, speed, mean)
    loads = []
    for one in excitations(system):
        line = one.line
        if harmonics.keys is None or (line.order, line.frequency) in harmonics.keys:
            w = np.full(len(speed), 2.0 * pi * (line.frequency or 0.0))
            w = w if line.order is None else float(line.order) * speed
            loads.append(Load(line, w, sources(system, one, speed, mean), ground))
    return Loaded(system, probes(system), tuple(loads))


def eliminated(given: Loaded) -> list[ComplexArray]:
    """Torques (frequencies, probes) N m of every line by two-sided elimination."""
    found = [answer(given.system, load.w, load.sources, load.ground) for load in given.loads]
    return [given.probes.torque(load.w, one.angle, one.torque) for load, one in zip(given.loads, found, strict=True)]


def statically(given: Loaded, low: float) -> list[ComplexArray]:
    """Torques (frequencies, spans) N m of the undamped train when its torques change slowly: at `low` rad/s.

    A free train then accelerates as a whole, and its spans carry what this takes.
    """
    system = given.system
    none = np.zeros(len(system.spans))
    still = replace(system, viscous=none, loss_factor=none, dampers=())
    slow = [np.full(len(load.w), low) for load in given.loads]
    return [
        answer(still, w, load.sources, np.zeros_like(load.ground)).torque
        for w, load in zip(slow, given.loads, strict=True)
    ]


def errors(reference: Sequence[ComplexArray], found: Sequence[ComplexArray]) -> tuple[float, ...]:
    """Of every line the largest error of a torque, relative to that torque's largest amplitude over the speeds.

    NaN in what was found makes it infinite.
    """
    return tuple(_error(there, here) for there, here in zip(reference, found, strict=True))


def _error(reference: ComplexArray, found: ComplexArray) -> float:
    peak = np.abs(reference).max(axis=0)
    told = (peak > NEGLIGIBLE * peak.max()) & (peak > 0.0)
    if not told.any():
        return 0.0
    if not np.isfinite(found[:, told]).all():
        return float("inf")
    return float((np.abs(found - reference)[:, told].max(axis=0) / peak[told]).max())
