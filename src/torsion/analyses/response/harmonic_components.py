"""What excites the train: the torques of its components and the errors of its joints, by harmonic component.

Orders are exact, so that two sources of one order meet in one line and are added as phasors.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import groupby, zip_longest
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.primitives import Torque
from torsion.results import listed, reported, result
from torsion.train import Train

if TYPE_CHECKING:
    from torsion.analyses.steady import Steady


@reported
class Line:
    """One harmonic: so many cycles per turn of the reference station, or a fixed frequency."""

    order: Fraction | None = result(
        "per revolution of the reference, exact; null for a fixed frequency"
    )
    frequency: float | None = result("Hz", "null for an order", key="fixed_frequency_Hz")
    sources: tuple[str, ...] = result("what excites it")
    own_orders: tuple[Fraction, ...] = result(
        "of each source per revolution of the shaft of the source, exact; none of a fixed frequency",
        default=(),
    )

    @property
    def words(self) -> str:
        """Name of the component without the name of the reference."""
        return self.named()

    def named(self, reference: str = "") -> str:
        """Return the name by its sources: '5 × screw (40/21 of motor)', '2 × motor' at the speed of the reference."""
        if self.order is None:
            return f"{self.frequency:g} Hz ({in_runs(dict.fromkeys(self.sources))})"
        names_of: dict[Fraction, dict[str, None]] = {}
        for name, own_order in zip_longest(self.sources, self.own_orders, fillvalue=self.order):
            names_of.setdefault(Fraction(own_order), {})[str(name)] = None
        sources = [
            f"{_decimal(own_order)} × {in_runs(names)}" for own_order, names in names_of.items()
        ]
        words = listed(sources, most=MOST_SOURCES)
        order = _decimal(self.order)
        if set(names_of) == {self.order}:
            return words
        return f"{words} ({order} of {reference})" if reference else f"{words} (order {order})"

    def circular_frequency(self, speed: FloatArray) -> FloatArray:
        """Return the frequency (speeds,) rad/s at reference speeds (speeds,) rad/s."""
        if self.order is not None:
            return float(self.order) * speed
        return np.full(len(speed), 2.0 * np.pi * (self.frequency or 0.0))


@dataclass(frozen=True, slots=True)
class JointError:
    """One harmonic of a joint's transmission error."""

    span: int
    order: int  # of the driving station's own angle
    amplitude: complex  # rad of the driven angle
    name: str  # of the joint


@dataclass(frozen=True)
class Excitation:
    """A line with all that excites it."""

    line: Line
    torques: tuple[Torque, ...] = ()
    errors: tuple[JointError, ...] = ()

    @property
    def apart(self) -> "dict[int, Excitation]":
        """Parts that are added by their magnitudes, by the engine whose phase is any; -1, first: all with one phase."""
        torques_of: dict[int, list[Torque]] = {-1: []}
        for torque in self.torques:
            law = torque.cylinder
            engine = law.engine if law is not None and law.by_chance else -1
            torques_of.setdefault(engine, []).append(torque)
        if len(torques_of) > 1 and not (self.errors or torques_of[-1]):
            del torques_of[-1]
        return {
            engine: replace(self, torques=tuple(torques), errors=() if engine >= 0 else self.errors)
            for engine, torques in torques_of.items()
        }


@dataclass(frozen=True)
class Sources:
    """Complex amplitudes on the condensed tree, of one component, over speed."""

    force: ComplexArray  # (tree stations, speeds) N m
    twist: ComplexArray | None  # (tree stations, speeds) rad imposed on the span leading to each
    loop_twist: ComplexArray | None = None  # (extra spans, speeds) rad imposed on those in loops

    def at(self, points: IntArray) -> "Sources":
        """Return the sources at some of the speeds."""
        twists = (
            None if twist is None else twist[:, points] for twist in (self.twist, self.loop_twist)
        )
        return Sources(self.force[:, points], *twists)


def _decimal(order: Fraction) -> str:
    """Return 0.5 or 2.625, or the fraction where its decimals do not end soon."""
    text = f"{float(order):g}"
    return text if Fraction(text) == order else str(order)


NUMBERED = re.compile(r"(.*?\D|)(0|[1-9]\d*)")
SHORTEST_RUN = 3  # names that are written as one
MOST_SOURCES = 4  # that are named


def in_runs(names: Iterable[str]) -> str:
    """Return names one after another; those that differ in their number alone as 'cylinder 1–6'.

    >>> in_runs(["cylinder 1", "cylinder 2", "cylinder 3", "joint-1", "joint-2"])
    'cylinder 1–3, joint-1, joint-2'
    """
    numbered = [(NUMBERED.fullmatch(name), name) for name in names]
    words: list[str] = []
    runs = groupby(
        enumerate(numbered),
        lambda row: (row[1][0][1], int(row[1][0][2]) - row[0]) if row[1][0] else row,
    )
    for _, rows in runs:
        run = [(match, name) for _, (match, name) in rows]
        first, last = run[0], run[-1][0]
        if last is not None and len(run) >= SHORTEST_RUN:
            words.append(f"{first[1]}–{last[2]}")
        else:
            words += [name for _, name in run]
    return listed(words, most=MOST_SOURCES)


def excitations(system: System, orders: Iterable[Fraction] | None = None) -> tuple[Excitation, ...]:
    """Return every component, orders first, both ascending; `orders` keeps those orders of the reference alone."""
    by_key: dict[tuple[Fraction | None, float | None], list[Torque | JointError]] = {}
    for torque in system.train.torques:
        if torque.order is not None:
            order = torque.order * system.stations[torque.station].ratio
            by_key.setdefault((order, None), []).append(torque)
        elif torque.frequency is not None:
            by_key.setdefault((None, torque.frequency), []).append(torque)
    for number, span in enumerate(system.own_spans):
        for own_order, size in span.error:
            error = JointError(number, own_order, size, span.name)
            order = own_order * system.stations[span.driving].ratio
            by_key.setdefault((order, None), []).append(error)
    wanted = None if orders is None else {None, *orders}
    ascending = sorted(by_key, key=lambda key: (key[0] is None, key[0] or 0, key[1] or 0))
    return tuple(
        _excitation(by_key[key], *key) for key in ascending if wanted is None or key[0] in wanted
    )


def lines(system: System) -> tuple[Line, ...]:
    """Return every line that excites the train over speed."""
    return tuple(excitation.line for excitation in excitations(system))


def excited_orders(train: Train) -> tuple[Fraction, ...]:
    """Return the orders of the reference station that something excites, ascending."""
    ratio = [station.ratio for station in train.stations]
    orders = {
        torque.order * ratio[torque.station] for torque in train.torques if torque.order is not None
    }
    orders |= {order * ratio[mesh.driving] for mesh in train.constraints for order, _ in mesh.error}
    return tuple(sorted(orders))


def sweeping(system: System) -> Excitation:
    """Return the torques without order and frequency, that act at every frequency of a frequency response."""
    torques = [
        torque
        for torque in system.train.torques
        if torque.order is None and torque.frequency is None
    ]
    return _excitation(torques, None, None)


def _excitation(
    sources: Sequence[Torque | JointError], order: Fraction | None, frequency: float | None
) -> Excitation:
    order_of = {source.name: source.order for source in sources}
    orders = tuple(Fraction(order) for order in order_of.values() if order is not None)
    return Excitation(
        Line(order, frequency, tuple(order_of), orders),
        tuple(source for source in sources if isinstance(source, Torque)),
        tuple(source for source in sources if isinstance(source, JointError)),
    )


def sources(
    system: System, excitation: Excitation, speed: FloatArray, steady: "Steady | None"
) -> Sources:
    """Return complex amplitudes of one line at reference speeds (speeds,) rad/s, which `steady` holds.

    A torque's phase, and that of a mesh's error, counts from reference angle zero. A joint's error counts from its own
    driving angle, static twist included. A force on a station of speed ratio r acts on the condensed tree as r times
    itself.
    """
    condensed = system.condensed
    ratio = system.speed_ratio
    force = np.zeros((condensed.tree.size, len(speed)), dtype=np.complex128)
    twist = np.zeros_like(force)
    loop_twist = np.zeros((len(condensed.extra), len(speed)), dtype=np.complex128)
    for torque in excitation.torques:
        if torque.mesh is None:
            acting = ratio[torque.station] * amplitude(system, torque, speed, steady)
            force[condensed.node[torque.station]] += acting
            continue
        mesh = next(
            position
            for position, span in enumerate(system.own_spans)
            if span.name == torque.mesh[0] and system.train.parts[span.part].kind == "gear"
        )
        slip = torque.mesh[1] * np.exp(1j * torque.phase) / ratio[torque.station]
        if condensed.span[mesh] < 0:
            loop_twist[condensed.extra == mesh] -= slip
        else:
            twist[condensed.span[mesh]] -= condensed.sign[mesh] * slip
    if not excitation.errors:
        imposed = (values if values.any() else None for values in (twist, loop_twist))
        return Sources(force, *imposed)
    # With T_a d(driving) = T_b d(driven) the driving side feels T_b (1 + e'): the part mean torque * e' of it is a
    # torque jump at the driving station, to first order in the error.
    for error in excitation.errors:
        span = system.spans[error.span]
        turned = np.full(len(speed), error.amplitude, dtype=np.complex128)
        if steady is not None:
            turned = turned * np.exp(1j * error.order * steady.twist[span.driving])
            slope = 1j * error.order * turned / float(span.ratio)
            jump = -slope * steady.torque[error.span] * ratio[span.driving]
            force[condensed.node[span.driving]] += jump
        # A joint is rigid, and a rigid span is always one of the tree.
        node = condensed.span[error.span]
        twist[node] += condensed.sign[error.span] * turned / ratio[span.driven]
    return Sources(force, twist, loop_twist)


def amplitude(
    system: System, torque: Torque, speed: FloatArray, steady: "Steady | None"
) -> ComplexArray:
    """Return the complex amplitude (speeds,) N m of a torque at its own station.

    The mean torque of which it may be a share is what is applied at its station, else the largest in its spans.
    """
    own_speed = speed * system.speed_ratio[torque.station]
    if (law := torque.cylinder) is not None:
        return law.amplitude(own_speed, None if steady is None else steady.applied[law.station])
    size = np.full(len(speed), torque.torque)
    if torque.table:
        about = Fault(("excitations",), f"the table of the torque at '{torque.name}'", "")
        from torsion.analyses.power_balance import interpolated

        size = size + interpolated(torque.table, own_speed, about)
    if torque.of_mean:
        if steady is None:
            message = (
                f"the torque at '{torque.name}' is a share of the mean torque, which is not known"
            )
            hint = "give the rated speed and power"
            raise InputError([Fault(("operation", "rated", "power"), message, hint)])
        mean = np.abs(steady.applied[torque.station])
        meets = (system.driving == torque.station) | (system.driven == torque.station)
        if meets.any() and not mean.any():
            # A span's torque is stated at its driving station's speed; across a gear it is not the station's own.
            ratio = system.span_ratio[meets] / system.speed_ratio[torque.station]
            mean = np.abs(steady.torque[meets] * ratio[:, None]).max(axis=0)
        size = size + torque.of_mean * mean
    return np.asarray(size * np.exp(1j * torque.phase))
