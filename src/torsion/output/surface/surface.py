"""The train as a surface: points, cells and, for every mode, the angle of every point and the torque in every cell."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.surface.axes import Axis

TWIST = 0.5  # rad: the largest angle of a mode as it is drawn
HALF_A_WAVE = 3.0  # rad between two stations; pi would leave the angle between them open


@dataclass(frozen=True)
class Rings:
    """All rings of all bodies, and the strips between every two of one body."""

    x: FloatArray  # (rings,) m along the axis
    radius: FloatArray  # (rings,) m
    place: FloatArray  # (rings, 2) m, y and z of the axis
    sense: FloatArray  # (rings,) 1 or -1: turns about x, or the other way, when its angle is positive
    between: IntArray  # (rings, 2) stations between whose angles a ring's lies
    share: FloatArray  # (rings,) of the way
    delay: FloatArray  # (rings,) s
    strip: IntArray  # (strips,) first ring of each strip; the next one is its second
    part: IntArray  # (strips,) component
    body: IntArray  # (strips,)
    span: IntArray  # (strips,) whose torque it carries; -1: none
    modulus: FloatArray  # (strips,) m3
    to_scale: BoolArray  # (strips,) its diameters are those of the file


@dataclass(frozen=True)
class Surface:
    """The surface at rest."""

    points: FloatArray  # (points, 3) m
    tangent: FloatArray  # (points, 3) m: the displacement for an angle of 1 rad about x
    ring: IntArray  # (points,)
    quads: IntArray  # (quads, 4) points, their normal out of the body
    triangles: IntArray  # (triangles, 3)
    strip: IntArray  # (quads + triangles,)


def shapes(findings: Findings) -> Modes:
    """The modes to be drawn; raises InputError where there are none."""
    modes = findings.get(Modes)
    if modes is not None and modes.frequency.size:
        return modes
    why = dict(findings.plan.left_out).get("natural frequencies", "the train has no elastic mode")
    path = ("analyses",) if findings.study.analyses else ("train",)
    hint = "name `modes` in `analyses`" if modes is None and findings.study.analyses else ""
    raise InputError([Fault(path, f"there is no mode shape to draw: {why}", hint)])


def rings(system: System, placed: list[Axis]) -> Rings:
    """The rings of the bodies on their axes."""
    every = [(body, axis.place) for axis in placed for body in axis.bodies]
    number = np.array([body.x.size for body, _ in every])
    first = np.cumsum(number) - number
    between = np.concatenate([body.between for body, _ in every])
    sense = np.array([station.sense for station in system.stations], dtype=float)
    strips = number - 1
    return Rings(
        np.concatenate([body.x for body, _ in every]), np.concatenate([body.radius for body, _ in every]),
        np.repeat([place for _, place in every], number, axis=0), sense[between[:, 0]], between,
        np.concatenate([body.share for body, _ in every]), np.repeat([body.delay for body, _ in every], number),
        np.concatenate([start + np.arange(count) for start, count in zip(first, strips, strict=True)]),
        np.repeat([body.part for body, _ in every], strips), np.repeat(np.arange(len(every)), strips),
        np.concatenate([body.span for body, _ in every]), np.concatenate([body.modulus for body, _ in every]),
        np.repeat([body.to_scale for body, _ in every], strips),
    )  # fmt: skip


def surface(found: Rings, around: int) -> Surface:
    """The surface with `around` points on every ring; a ring of no radius is one point."""
    count = np.where(found.radius > 0, around, 1)
    start = np.cumsum(count) - count
    ring = np.repeat(np.arange(count.size), count)
    turn = 2.0 * math.pi / around * (np.arange(ring.size) - start[ring])
    across = found.radius[ring, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    points = np.column_stack([found.x[ring], found.place[ring] + across])
    tangent = np.column_stack([np.zeros(ring.size), -across[:, 1], across[:, 0]])
    here, there = found.strip, found.strip + 1
    is_tip, is_end = count[here] == 1, count[there] == 1
    is_round = ~is_tip & ~is_end
    step = np.arange(around)
    beside = (step + 1) % around
    a, b = start[here[is_round], None], start[there[is_round], None]
    quads = np.stack([a + step, a + beside, b + beside, b + step], axis=2).reshape(-1, 4)
    tip, behind = start[here[is_tip], None] + 0 * step, start[there[is_tip], None]
    opening = np.stack([tip, behind + beside, behind + step], axis=2).reshape(-1, 3)
    end, before = start[there[is_end], None] + 0 * step, start[here[is_end], None]
    closing = np.stack([end, before + step, before + beside], axis=2).reshape(-1, 3)
    strips = [np.repeat(np.flatnonzero(which), around) for which in (is_round, is_tip, is_end)]
    return Surface(points, tangent, ring, quads, np.concatenate([opening, closing]), np.concatenate(strips))


def angles(found: Rings, modes: Modes, mode: int) -> FloatArray:
    """(rings,) rad at own speed, in own sense.

    Between two stations: sin(mu (1 - s)) / sin mu of the one and sin(mu s) / sin mu of the other, with mu the phase
    between them: linear where no part of the shaft oscillates by itself, and where half a wave leaves it open.
    """
    shape = modes.shape[:, mode]
    phase = 2.0 * math.pi * float(modes.frequency[mode]) * found.delay
    phase = np.where(phase < HALF_A_WAVE, phase, 0.0) / math.pi
    inner, outer = (share * np.sinc(phase * share) / np.sinc(phase) for share in (1.0 - found.share, found.share))
    return np.asarray(inner * shape[found.between[:, 0]] + outer * shape[found.between[:, 1]])


def turned(found: Rings, angle: FloatArray) -> FloatArray:
    """(rings,) rad about x as drawn: the largest angle of the mode is TWIST."""
    return np.asarray(found.sense * angle * (TWIST / np.abs(angle).max()))


def torques(found: Rings, modes: Modes, mode: int) -> FloatArray:
    """(strips,) N m at own speed; not a number where no torque goes through."""
    torque = np.append(modes.torque[:, mode], np.nan)
    return np.asarray(torque[found.span])
