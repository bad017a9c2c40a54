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

import numpy as np

from torsion.analyses.modes.mode_nodes import TINY
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import taken_at
from torsion.model.shaft_details import STEP

MOST_TIMES_FIRST = (
    1e3  # an amplitude larger than so many times the first: then the largest of a table is 1
)


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
        """rad2/s2: omega^2."""
        return (2.0 * math.pi * self.frequency) ** 2

    @property
    def without_rounding(self) -> list[list[float]]:
        """Angle, inertia torque, torque in and out, and twist of every row, 0 where they may be rounding.

        A heavy station may hardly move and yet carry a torque: an angle and its torque are 0 together, likewise a
        torque and its twist.
        """
        station = np.array([self.angle, self.inertia_torque])
        link = np.array([self.torque_in, self.torque_out, self.twist])
        angle, torque = np.abs(self.angle).max(), np.abs(link[:2]).max()
        largest = np.array([[angle], [max(torque, np.abs(self.inertia_torque).max())]])
        station[:, (np.abs(station) < TINY * largest).all(axis=0)] = 0.0
        link[:, (np.abs(link) < TINY * np.array([[torque], [torque], [angle]])).all(axis=0)] = 0.0
        rows: list[list[float]] = np.transpose([*station, *link]).tolist()
        return rows

    @property
    def residual(self) -> float:
        """N m: the largest torque at any station that moves which nothing balances."""
        left = self.torque_out + np.where(self.is_chord, 0.0, self.inertia_torque)
        total = np.zeros(int(self.station.max(initial=0)) + 1)
        np.add.at(total, self.station, left)
        inner = self.before >= 0
        np.add.at(total, self.station[self.before[inner]], -self.torque_in[inner])
        total[self.station[np.isinf(self.inertia)]] = 0.0
        return float(np.abs(total).max())

    @property
    def relative_residual(self) -> float:
        """The same by the largest torque in the table; 0 where there is none."""
        largest = float(np.max(np.abs([self.torque_in, self.torque_out])))
        return self.residual / largest if largest else 0.0


def holzer(system: System, modes: Modes, mode: int) -> HolzerTable:
    """The table of one mode (counted from 0)."""
    system = taken_at(system, 2.0 * math.pi * float(modes.frequency[mode]))
    rows = list(_rows(system))
    station = np.array([row[0] for row in rows], dtype=np.int64)
    before = np.array([row[1] for row in rows], dtype=np.int64)
    links, is_chord = tuple(row[2] for row in rows), np.array([row[3] for row in rows], dtype=bool)
    angle = modes.shape[station, mode] / system.speed_ratio[station]
    angle[system.held[station]] = 0.0
    torque, square = (
        modes.torque[:, mode] * system.span_ratio,
        (2.0 * math.pi * float(modes.frequency[mode])) ** 2,
    )
    at_ends, flexibility, transfer = (
        np.zeros((len(rows), 2)),
        np.zeros(len(rows)),
        np.full((len(rows), 2, 2), np.nan),
    )
    chains = _chains(system, square)
    for row, link in enumerate(links):
        if link is None:
            continue
        ends, turned = torque[list(link.spans)], link.driven != station[row]
        flexibility[row] = chains.flexibility[link.spans[0] : link.spans[1] + 1].sum()
        matrix = chains.product(link)
        if matrix is not None:
            transfer[row] = matrix[::-1, ::-1].T if turned else matrix
            if not chains.has_driven_end(link):
                ends[1] = matrix[1] @ (angle[row if turned else before[row]], ends[0])
        at_ends[row] = -ends[::-1] if turned else ends
    scale = _scale(angle)
    inertia = (system.lumped_inertia * system.speed_ratio**2)[station]
    moved = np.where(np.isinf(inertia), 0.0, inertia) * square * angle
    is_spring = np.isnan(
        transfer[:, 0, 0]
    )  # its twist may be far smaller than the angles of its ends
    twist = np.where(
        is_spring, flexibility * at_ends[:, 0], np.where(before >= 0, angle[before], angle) - angle
    )
    return HolzerTable(
        float(modes.frequency[mode]),
        station,
        before,
        links,
        is_chord,
        inertia,
        angle / scale,
        moved / scale,
        at_ends[:, 0] / scale,
        at_ends[:, 1] / scale,
        flexibility,
        twist / scale,
        transfer,
    )


def _scale(angle: FloatArray) -> float:
    """The angle that is 1 in the table: the first, or the largest where the first is next to nothing beside it."""
    largest, first = float(angle[np.argmax(np.abs(angle))]), float(angle[0])
    if abs(first) > abs(largest) / MOST_TIMES_FIRST:
        return first
    return math.copysign(largest, first) if abs(first) > TINY * abs(largest) else largest


def _links(system: System) -> list[Link]:
    """Springs, meshes, joints and whole shafts; not those of no stiffness, which carry no torque of a mode."""
    bars = {bar.part: bar for bar in system.train.bars}
    found, shafts = list[Link](), dict[int, list[int]]()
    for position, span in enumerate(system.own_spans):
        if span.part in bars and not span.name.endswith(STEP):
            shafts.setdefault(span.part, []).append(position)
        elif np.isfinite(system.flexibility[position]):
            found.append(Link(span.name, span.driving, span.driven, (position, position)))
    first = len(system.own_spans)
    for row in system.rows:
        shafts[row.bar.part] = [first, first + row.number - 1]
        first += row.number
    for part, spans in shafts.items():
        found.append(
            Link(bars[part].name, bars[part].driving, bars[part].driven, (spans[0], spans[-1]))
        )
    return found


def _rows(system: System) -> Iterator[tuple[int, int, Link | None, bool]]:
    """Station, row before, link, and whether it closes a loop; each branch to its end before the next."""
    links = sorted(_links(system), key=lambda link: _closes(system, link))
    near: dict[int, list[Link]] = {}
    for link in links:
        near.setdefault(link.driving, []).append(link)
        near.setdefault(link.driven, []).append(link)
    row_of, used = dict[int, int](), set[Link | None]()
    for start in sorted(near) or [0]:
        stack: list[tuple[int, int, Link | None]] = [(start, -1, None)]
        while stack:
            here, before, leading = stack.pop()
            if here in row_of:
                continue
            row_of[here] = len(row_of)
            used.add(leading)
            yield here, before, leading, False
            for one in reversed(near.get(here, [])):
                stack.append(
                    (one.driven if one.driving == here else one.driving, row_of[here], one)
                )
    for chord in links:
        if chord not in used:
            yield chord.driven, row_of[chord.driving], chord, True


def _closes(system: System, link: Link) -> bool:
    """The link is one of the file's `links`."""
    return system.train.parts[int(system.span_part[link.spans[0]])].path[:1] == ("links",)


@dataclass(frozen=True)
class _Chains:
    """The spans of a system at one frequency, each a flexibility between two inertias, all referred."""

    system: System
    square: float  # rad2/s2
    flexibility: FloatArray  # (spans,) rad/(N m) at rest
    pi: FloatArray  # (3, spans of the whole system) flexibility and end inertias at the frequency, driving and driven
    inertia: FloatArray  # (stations of the whole system,) kg m2, lumped

    def product(self, link: Link) -> FloatArray | None:
        """[[A, -H], [B, D]] of a link from its driving to its driven end; None where no inertia lies between them."""
        whole, (first, last) = self.system.whole, self._whole(link)
        h, driving, driven = self.pi[:, first : last + 1]
        inside = np.append(self.inertia[whole.driven[first:last]], 0.0)
        if not (driving.any() or driven.any() or inside.any()):
            return None
        w2 = self.square
        matrix = np.empty((len(h), 2, 2))
        matrix[:, 0, 0], matrix[:, 0, 1] = 1.0 - h * w2 * driving, -h
        matrix[:, 1, 0] = w2 * (driving + driven - h * w2 * driving * driven)
        matrix[:, 1, 1] = 1.0 - h * w2 * driven
        matrix[:, 1] += (w2 * inside)[:, None] * matrix[:, 0]
        while len(matrix) > 1:
            if len(matrix) % 2:
                matrix = np.concatenate([matrix, np.eye(2)[None]])
            matrix = matrix[1::2] @ matrix[::2]
        return np.asarray(matrix[0])

    def has_driven_end(self, link: Link) -> bool:
        """The last of its spans reports the torque at the driven end of the shaft."""
        return not self.pi[1:, self._whole(link)[1]].any()

    def _whole(self, link: Link) -> tuple[int, int]:
        """First and last span in the system of all segments."""
        groups = self.system.groups
        if groups is None:
            return link.spans
        return int(groups.spans[link.spans[0]]), int(groups.last_span[link.spans[1]])


def _chains(system: System, square: float) -> _Chains:
    """The spans at a squared frequency (rad2/s2)."""
    whole = system.whole
    ratio2 = whole.span_ratio**2
    pi = np.zeros((3, len(whole.flexibility)))
    pi[0] = whole.flexibility / ratio2
    if whole.bars is not None:
        own = whole.bars.span
        laws = whole.bars.laws(
            np.arange(len(own)), whole.span_ratio[own], np.zeros(len(own), dtype=bool)
        )
        pi[:, own] = [values[:, 0] for values in laws.at(np.array([square]))]
    inertia = whole.lumped_inertia * whole.speed_ratio**2
    return _Chains(system, square, system.flexibility / system.span_ratio**2, pi, inertia)
