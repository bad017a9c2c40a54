"""Response torques at the driving ends of all components, and how far a model is from the exact one in them."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.excitation import Excitation, Line, excitations, sources
from torsion.analyses.response.over_speed import asked_orders
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.assembly.shafts import bar_segments
from torsion.assembly.system import System
from torsion.errors import InputError
from torsion.kernels.response import Status
from torsion.kernels.tree import ComplexArray, FloatArray
from torsion.study import Study


@dataclass(frozen=True)
class End:
    """The driving end of a component: its span, and the inertia that a lumped shaft has before its first span."""

    name: str
    span: int
    station: int
    lump: float  # kg m2


@dataclass(frozen=True)
class Torques:
    """Complex amplitudes at driving ends, referred to the reference speed."""

    ends: tuple[End, ...]
    lines: tuple[Line, ...]
    torque: ComplexArray  # (speeds, lines, ends) N m
    sound: np.ndarray  # (speeds, lines) bool: the answer can be trusted


@dataclass(frozen=True)
class TorquesCompared:
    """How far a model is from the exact one: in the norm of the largest torque of any end, at each speed and line."""

    error: FloatArray  # (speeds,) relative, the largest of all lines; NaN where neither model can be trusted
    largest: float  # of all; NaN where there is none
    speed: int  # position of the speed at which it stands
    line: Line | None
    component: str
    left_out: int  # speeds and lines at which a model has no answer that can be trusted


def operating_speeds(study: Study, system: System) -> tuple[FloatArray | None, str]:
    """The speeds asked for (speeds,) rad/s, or None and why no torques can be compared."""
    found = _asked(study, system)
    if not found:
        return None, "nothing excites the train at an order or a fixed frequency"
    if study.operation.speeds is None:
        return None, "`operation` says no speeds"
    ends = np.array([study.operation.speeds.first, study.operation.speeds.last])
    try:
        mean = steady_if_known(study, system, ends)
        ground_damping(system, ends, mean)
        for one in found:
            sources(system, one, ends, mean)
    except InputError as error:
        return None, "; ".join(fault.message for fault in error.faults)
    return study.operation.speeds.values(), ""


def frequencies(study: Study, system: System, speed: FloatArray) -> FloatArray:
    """(speeds, lines) Hz of everything that excites at the speeds (speeds,) rad/s."""
    return np.stack([_hertz(one.line, speed) for one in _asked(study, system)], axis=1)


def end_torques(study: Study, system: System, speed: FloatArray) -> Torques:
    """The torques at the driving ends of all components over `speed` (speeds,) rad/s."""
    mean = steady_if_known(study, system, speed)
    ground, ends, found = ground_damping(system, speed, mean), driving_ends(system), _asked(study, system)
    span, station = [end.span for end in ends], [end.station for end in ends]
    lump = np.array([end.lump for end in ends])
    torque = np.empty((len(speed), len(found), len(ends)), dtype=np.complex128)
    sound = np.empty(torque.shape[:2], dtype=bool)
    for k, one in enumerate(found):
        w = 2.0 * math.pi * _hertz(one.line, speed)
        solved = answer(system, w, sources(system, one, speed, mean), ground)
        torque[:, k] = solved.torque[:, span] - (w * w)[:, None] * lump * solved.angle[:, station]
        sound[:, k] = solved.status == Status.OK
    return Torques(ends, tuple(one.line for one in found), torque * system.span_ratio[span], sound)


def driving_ends(system: System) -> tuple[End, ...]:
    """One end a shaft, coupling, gear mesh, joint or link in the order of the train; none where points join rigidly."""
    bars, parts, found = {bar.part: bar for bar in system.train.bars}, system.train.parts, list[tuple[int, End]]()
    for k, span in enumerate(system.spans):
        bar = bars.get(span.part)
        if bar is None:
            if not parts[span.part].is_point or system.flexibility[k] != 0:
                found.append((span.part, End(span.name, k, span.driving, 0.0)))
        elif span.driving == bar.driving:
            lump = bar_segments(bar, system.segments[bar.name])[1][0] if system.model == "lumped" else 0.0
            found.append((span.part, End(bar.name, k, span.driving, float(lump))))
    return tuple(end for _, end in sorted(found, key=lambda pair: pair[0]))


def compared_torques(one: Torques, exact: Torques) -> TorquesCompared:
    """The relative difference at every speed and line, where both answers can be trusted."""
    size = np.abs(exact.torque).max(axis=2, initial=0.0)
    difference = np.abs(one.torque - exact.torque)
    sound = one.sound & exact.sound & (size > 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.where(sound, difference.max(axis=2, initial=0.0) / size, np.nan)
    left_out = int(np.count_nonzero(~(one.sound & exact.sound)))
    over_lines = np.fmax.reduce(error, axis=1)
    if not sound.any():
        return TorquesCompared(over_lines, math.nan, 0, None, "", left_out)
    speed, line = (int(place) for place in np.unravel_index(np.nanargmax(error), error.shape))
    end = exact.ends[int(np.argmax(difference[speed, line]))]
    return TorquesCompared(over_lines, float(error[speed, line]), speed, exact.lines[line], end.name, left_out)


def _asked(study: Study, system: System) -> tuple[Excitation, ...]:
    """Every line, or those of the orders that the settings of `response` name."""
    return excitations(system, asked_orders(study))


def _hertz(line: Line, speed: FloatArray) -> FloatArray:
    """(speeds,) Hz."""
    if line.order is not None:
        return float(line.order) * speed / (2.0 * math.pi)
    return np.full(len(speed), line.frequency or 0.0)
