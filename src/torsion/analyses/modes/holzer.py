"""The Holzer table of a mode, taken from the mode itself: station by station, all referred to the reference speed.

A row follows from a row above it. Of a spring: twist = flexibility * torque, the same torque at either end. Of a shaft
with inertia between its ends, with (theta, T) at the end of the row above and (theta', T') at that of its own row:

    theta' = A theta - H T,   T' = B theta + D T,   A D + B H = 1

The torque that leaves a station toward the leaves is what reaches it plus its omega^2 J theta. Nothing is summed up
along the train, as Holzer's own recurrence does, so no error grows along it.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce

import numpy as np

from torsion.analyses.modes.mode_nodes import TINY
from torsion.analyses.undamped_modes import HolzerMode, HolzerRow, Modes
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.primitives import STEP

MOST_TABLES, MOST_ROWS = 12, 600  # of modes that are declared, and their rows
MOST_TIMES_FIRST = 1e3  # an amplitude larger than so many times the first is 1 in its place


@dataclass(frozen=True)
class Link:
    """What joins two stations that the train names: a spring, mesh or joint, or a whole shaft."""

    name: str
    driving: int
    driven: int
    spans: tuple[int, int]  # first and last position in the system, from driving to driven


@dataclass(frozen=True)
class HolzerTable:
    """One mode, row by row from a first station; links that close loops have the last rows.

    A row is a station and the link that leads to it from the row `before`.
    """

    frequency: float  # Hz
    station: IntArray  # (rows,) position in the system
    before: IntArray  # (rows,) row from which the link leads here, -1 at a start
    links: tuple[Link | None, ...]  # (rows,) None at a start
    is_chord: BoolArray  # (rows,) the link closes a loop: its station has a row of its own
    inertia: FloatArray  # (rows,) kg m2, referred, without what shafts of `transfer` carry; infinite where fixed
    angle: (
        FloatArray  # (rows,) rad; the first row is 1, or the largest where the first hardly moves
    )
    inertia_torque: FloatArray  # (rows,) N m: omega^2 J angle
    torque_in: FloatArray  # (rows,) N m at the end of the link toward the row before, positive toward this row
    torque_out: FloatArray  # (rows,) N m at its other end
    flexibility: FloatArray  # (rows,) rad/(N m) of the link at rest
    twist: FloatArray  # (rows,) rad
    transfer: FloatArray  # (rows, 2, 2) [[A, -H], [B, D]] of a shaft with inertia between its ends; else NaN

    @property
    def square(self) -> float:
        """Squared circular frequency omega^2, rad2/s2."""
        return (2.0 * math.pi * self.frequency) ** 2

    def rows(self, system: System) -> Iterator[HolzerRow]:
        """Yield the rows as people read them, 0 in place of what may be rounding.

        A heavy station may hardly move and yet carry a torque: an angle and its torque are 0 together, likewise a
        torque and its twist.
        """
        station = np.array([self.angle, self.inertia_torque])
        ends = np.array([self.torque_in, self.torque_out, self.twist])
        angle = np.abs(self.angle).max()
        torque = np.abs(ends[:2]).max()
        largest = np.array([[angle], [max(torque, np.abs(self.inertia_torque).max())]])
        station[:, (np.abs(station) < TINY * largest).all(axis=0)] = 0.0
        ends[:, (np.abs(ends) < TINY * np.array([[torque], [torque], [angle]])).all(axis=0)] = 0.0

        for row, link in enumerate(self.links):
            is_chord = bool(self.is_chord[row])
            inertia = float(self.inertia[row])
            name = system.stations[int(self.station[row])].name
            into, out, twist = ends[:, row].tolist()
            of_link: tuple[int | None, str | None, float | None] = None, None, None
            torques: tuple[float | None, ...] = None, None, None
            constants: tuple[float | None, ...] = None, None, None, None
            if link is not None:
                (a, h), (b, d) = self.transfer[row].tolist()
                has_inertia = math.isfinite(a)
                flexibility = None if has_inertia else float(self.flexibility[row])
                of_link = int(self.before[row]) + 1, link.name, into
                torques = flexibility, twist, out
                constants = (a, -h, b, d) if has_inertia else constants
            yield HolzerRow(
                row + 1,
                f"{name}, closing a loop" if is_chord else name,
                None if is_chord else inertia,
                float(station[0, row]),
                None if is_chord or math.isinf(inertia) else float(station[1, row]),
                *of_link,
                *torques,
                *constants,
            )

    @property
    def residual(self) -> float:
        """Largest torque (N m) at any station that moves which nothing balances."""
        left = self.torque_out + np.where(self.is_chord, 0.0, self.inertia_torque)
        total = np.zeros(int(self.station.max(initial=0)) + 1)
        np.add.at(total, self.station, left)
        inner = self.before >= 0
        np.add.at(total, self.station[self.before[inner]], -self.torque_in[inner])
        total[self.station[np.isinf(self.inertia)]] = 0.0
        return float(np.abs(total).max())

    @property
    def relative_residual(self) -> float:
        """The residual / the largest torque in the table; 0 where there is none."""
        largest = float(np.max(np.abs([self.torque_in, self.torque_out])))
        return self.residual / largest if largest else 0.0


def holzer_modes(modes: Modes) -> tuple[HolzerMode, ...]:
    """Return the tables of the lowest modes, row by row."""
    count = min(MOST_TABLES, max(1, MOST_ROWS // len(modes.system.train.stations)))
    lowest = range(min(count, modes.frequency.size))
    tables = (holzer(modes.system, modes, mode) for mode in lowest)
    return tuple(
        HolzerMode(mode, table.relative_residual, tuple(table.rows(modes.system)))
        for mode, table in enumerate(tables, 1)
    )


def holzer(system: System, modes: Modes, mode: int) -> HolzerTable:
    """Return the table of one mode (counted from 0)."""
    w = 2.0 * math.pi * float(modes.frequency[mode])
    if system.tables:
        from torsion.assembly.tabled_spans import taken_at

        system = taken_at(system, w)
    square = w**2
    rows = list(_rows(system))
    station, before = np.array([row[:2] for row in rows], dtype=np.int64).T
    angle = modes.shape[station, mode] / system.speed_ratio[station]
    angle[system.held[station]] = 0.0
    torque = modes.torque[:, mode] * system.span_ratio
    at_rest = system.flexibility / system.span_ratio**2
    ends = np.zeros((len(rows), 2))
    flexibility = np.zeros(len(rows))
    transfer = np.full((len(rows), 2, 2), np.nan)
    # Every span is a flexibility between two inertias.
    inertia = system.lumped_inertia * system.speed_ratio**2
    pi = np.zeros((3, len(at_rest)))
    pi[0] = at_rest
    if (bars := system.bars) is not None:
        number = np.arange(len(bars.span))
        ratio = system.span_ratio[bars.span]
        laws = bars.laws(number, ratio, np.zeros(len(number), dtype=bool))
        pi[:, bars.span] = [values[:, 0] for values in laws.at(np.array([square]))]
    for row, (_, _, link, _) in enumerate(rows):
        if link is None:
            continue
        first, last = link.spans
        torques = torque[[first, last]]
        is_turned = link.driven != station[row]
        flexibility[row] = at_rest[first : last + 1].sum()
        matrix = _transfer(pi[:, first : last + 1], inertia[system.driven[first:last]], square)
        if matrix is not None:
            transfer[row] = matrix[::-1, ::-1].T if is_turned else matrix
            # Without inertia at the driven end the last span reports the torque there.
            if pi[1:, last].any():
                driving = row if is_turned else before[row]
                torques[1] = matrix[1] @ (angle[driving], torques[0])
        ends[row] = -torques[::-1] if is_turned else torques

    inertia = inertia[station]
    inertia_torque = np.where(np.isinf(inertia), 0.0, inertia) * square * angle
    # The twist of a spring may be far smaller than the angles of its ends.
    between = np.where(before >= 0, angle[before], angle) - angle
    twist = np.where(np.isnan(transfer[:, 0, 0]), flexibility * ends[:, 0], between)
    # The angle that is 1 in the table: the first, or the largest where the first is tiny compared with it.
    scale = float(angle[0])
    largest = float(angle[np.argmax(np.abs(angle))])
    if not abs(scale) > abs(largest) / MOST_TIMES_FIRST:
        scale = math.copysign(largest, scale) if abs(scale) > TINY * abs(largest) else largest
    return HolzerTable(
        frequency=float(modes.frequency[mode]),
        station=station,
        before=before,
        links=tuple(row[2] for row in rows),
        is_chord=np.array([row[3] for row in rows], dtype=bool),
        inertia=inertia,
        angle=angle / scale,
        inertia_torque=inertia_torque / scale,
        torque_in=ends[:, 0] / scale,
        torque_out=ends[:, 1] / scale,
        flexibility=flexibility,
        twist=twist / scale,
        transfer=transfer,
    )


def _rows(system: System) -> Iterator[tuple[int, int, Link | None, bool]]:
    """Yield station, row before, link, and whether it closes a loop; each branch to its end before the next.

    Links are springs, meshes, joints and whole shafts; not those of no stiffness, which carry no torque of a mode.
    """
    bars = {bar.part: bar for bar in system.train.bars}
    links = list[Link]()
    shafts = dict[int, list[int]]()
    for position, span in enumerate(system.own_spans):
        if span.part in bars and not span.name.endswith(STEP):
            shafts.setdefault(span.part, []).append(position)
        elif np.isfinite(system.flexibility[position]):
            links.append(Link(span.name, span.driving, span.driven, (position, position)))
    first = len(system.own_spans)
    for row in system.rows:
        shafts[row.bar.part] = [first, first + row.number - 1]
        first += row.number
    for part, spans in shafts.items():
        bar = bars[part]
        links.append(Link(bar.name, bar.driving, bar.driven, (spans[0], spans[-1])))

    # Last the `links` of the file, which close loops.
    paths = [part.path[:1] for part in system.train.parts]
    links.sort(key=lambda link: paths[int(system.span_part[link.spans[0]])] == ("links",))
    neighbours: dict[int, list[tuple[int, Link]]] = {}
    for link in links:
        neighbours.setdefault(link.driving, []).append((link.driven, link))
        neighbours.setdefault(link.driven, []).append((link.driving, link))
    row_of = dict[int, int]()
    used = set[Link | None]()
    for start in sorted(neighbours) or [0]:
        stack: list[tuple[int, int, Link | None]] = [(start, -1, None)]
        while stack:
            station, before, leading = stack.pop()
            if station in row_of:
                continue
            row_of[station] = len(row_of)
            used.add(leading)
            yield station, before, leading, False
            for neighbour, link in reversed(neighbours.get(station, [])):
                stack.append((neighbour, row_of[station], link))
    for chord in links:
        if chord not in used:
            yield chord.driven, row_of[chord.driving], chord, True


def _transfer(pi: FloatArray, between: FloatArray, square: float) -> FloatArray | None:
    """Return [[A, -H], [B, D]] of spans in a row, from the driving to the driven end; None without inertia between.

    pi: (3, spans) flexibility and the inertias at both ends of each, referred; between: (spans - 1,) kg m2 where they
    meet; square: squared circular frequency (rad2/s2).
    """
    h, driving, driven = pi
    inside = np.append(between, 0.0)
    if not (driving.any() or driven.any() or inside.any()):
        return None
    matrices = np.empty((len(h), 2, 2))
    matrices[:, 0, 0] = 1.0 - h * square * driving
    matrices[:, 0, 1] = -h
    matrices[:, 1, 0] = square * (driving + driven - h * square * driving * driven)
    matrices[:, 1, 1] = 1.0 - h * square * driven
    matrices[:, 1] += (square * inside)[:, None] * matrices[:, 0]
    return reduce(lambda total, matrix: matrix @ total, matrices)
