"""What excites the train: the torques of its components and the errors of its joints, collected line by line.

Orders are exact, so that two sources of one order meet in one line and are added as phasors.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import zip_longest

import numpy as np

from torsion.analyses.speed_tables import interpolated
from torsion.analyses.steady import Steady
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.primitives import Torque
from torsion.results import listed, reported, result
from torsion.train import Train


@reported
class Line:
    """One harmonic: so many cycles per turn of the reference station, or a fixed frequency."""

    order: Fraction | None = result(
        "", (), "per revolution of the reference, exact; null for a fixed frequency"
    )
    frequency: float | None = result("Hz", (), "null for an order", key="fixed_frequency_Hz")
    sources: tuple[str, ...] = result("", (), "what excites it")
    own_orders: tuple[Fraction, ...] = result(
        "",
        (),
        "of each source per revolution of the shaft of the source, exact; none of a fixed frequency",
        default=(),
    )

    @property
    def words(self) -> str:
        """As `named`, without the name of the reference."""
        return self.named()

    def named(self, reference: str = "") -> str:
        """By its sources: '5 × screw (40/21 of motor)', '2 × motor' where the source turns as the reference does."""
        if self.order is None:
            return f"{self.frequency:g} Hz ({in_runs(dict.fromkeys(self.sources))})"
        of: dict[Fraction, dict[str, None]] = {}
        for name, own in zip_longest(self.sources, self.own_orders, fillvalue=self.order):
            of.setdefault(Fraction(own), {})[str(name)] = None
        words = listed(
            [f"{_decimal(own)} × {in_runs(names)}" for own, names in of.items()], most=MOST_SOURCES
        )
        order = _decimal(self.order)
        if set(of) == {self.order}:
            return words
        return f"{words} ({order} of {reference})" if reference else f"{words} (order {order})"

    def circular_frequency(self, speed: FloatArray) -> FloatArray:
        """(speeds,) rad/s at reference speeds (speeds,) rad/s."""
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
    def apart(self) -> "list[Excitation]":
        """What is added by its magnitude alone: engines whose phase is any; all else together, first."""
        of: dict[int, list[Torque]] = {-1: []}
        for torque in self.torques:
            of.setdefault(_by_chance(torque), []).append(torque)
        rest = [replace(self, torques=tuple(of.pop(-1)))]
        found = rest if self.errors or rest[0].torques else []
        return (
            found + [replace(self, torques=tuple(each), errors=()) for each in of.values()] or rest
        )

    @property
    def by_chance(self) -> frozenset[int]:
        """Engines that take part and whose phase is any; -1 stands for all else."""
        return frozenset([*map(_by_chance, self.torques), *(-1 for _ in self.errors)])


def _by_chance(torque: Torque) -> int:
    """The engine whose torque it is, where its phase is any, else -1."""
    law = torque.cylinder
    return law.engine if law is not None and law.by_chance else -1


@dataclass(frozen=True)
class Sources:
    """Complex amplitudes on the condensed tree, of one component, over speed."""

    force: ComplexArray  # (tree stations, speeds) N m
    twist: (
        ComplexArray | None
    )  # (tree stations, speeds) rad imposed on the span leading to each; None where on none
    loop_twist: ComplexArray | None = (
        None  # (extra spans, speeds) rad imposed on those that close loops
    )

    def at(self, points: IntArray) -> "Sources":
        """The same at some of the speeds."""
        twists = (None if one is None else one[:, points] for one in (self.twist, self.loop_twist))
        return Sources(self.force[:, points], *twists)

    @staticmethod
    def side_by_side(each: "Sequence[Sources]") -> "Sources":
        """Those of several components one behind the other."""
        found: list[ComplexArray | None] = []
        for every in (
            [one.force for one in each],
            [one.twist for one in each],
            [one.loop_twist for one in each],
        ):
            rows = {len(one) for one in every if one is not None}
            widths = [one.force.shape[1] for one in each]
            filled = [
                np.zeros((*rows, w)) if one is None else one
                for one, w in zip(every, widths, strict=True)
            ]
            found.append(np.hstack(filled) if rows else None)
        force, *twists = found
        return Sources(np.asarray(force), *twists)


def _decimal(order: Fraction) -> str:
    """0.5 or 2.625, or the fraction where its decimals do not end soon."""
    text = f"{float(order):g}"
    return text if Fraction(text) == order else str(order)


SHORTEST_RUN = 3  # names that are said as one
MOST_SOURCES = 4  # that are named


def in_runs(names: Iterable[str]) -> str:
    """Names one after another; those that differ in their number alone as 'cylinder 1–6'.

    >>> in_runs(["cylinder 1", "cylinder 2", "cylinder 3", "joint-1", "joint-2"])
    'cylinder 1–3, joint-1, joint-2'
    """
    runs: list[tuple[str, list[int]]] = []
    for name in names:
        stem = name.rstrip("0123456789")
        number = int(name[len(stem) :] or -1)
        last = runs[-1] if runs else ("", [-1])
        if (
            number > 0
            and last[0] == stem
            and last[1][-1] == number - 1
            and str(number) == name[len(stem) :]
        ):
            last[1].append(number)
        else:
            runs.append((stem, [number]) if str(number) == name[len(stem) :] else (name, [-1]))
    words: list[str] = []
    for stem, run in runs:
        if len(run) >= SHORTEST_RUN:
            words.append(f"{stem}{run[0]}–{run[-1]}")
        else:
            words += [f"{stem}{end if end >= 0 else ''}" for end in run]
    return listed(words, most=MOST_SOURCES)


def excitations(system: System, orders: Iterable[Fraction] | None = None) -> tuple[Excitation, ...]:
    """Every component, orders first, both ascending; `orders` keeps those orders of the reference alone."""
    found: dict[tuple[Fraction | None, float | None], list[Torque | JointError]] = {}
    for torque in system.train.torques:
        if torque.order is not None:
            found.setdefault(
                (torque.order * system.stations[torque.station].ratio, None), []
            ).append(torque)
        elif torque.frequency is not None:
            found.setdefault((None, torque.frequency), []).append(torque)
    for number, span in enumerate(system.own_spans):
        for order, amplitude in span.error:
            error = JointError(number, order, amplitude, span.name)
            found.setdefault((order * system.stations[span.driving].ratio, None), []).append(error)
    wanted = None if orders is None else {None, *orders}
    ascending = sorted(found, key=lambda key: (key[0] is None, key[0] or 0, key[1] or 0))
    return tuple(
        _excitation(found[key], *key) for key in ascending if wanted is None or key[0] in wanted
    )


def lines(system: System) -> tuple[Line, ...]:
    """Every line that excites the train over speed."""
    return tuple(excitation.line for excitation in excitations(system))


def excited_orders(train: Train) -> tuple[Fraction, ...]:
    """The orders of the reference station that something excites, ascending."""
    ratio = [station.ratio for station in train.stations]
    found = {
        torque.order * ratio[torque.station] for torque in train.torques if torque.order is not None
    }
    found |= {order * ratio[mesh.driving] for mesh in train.constraints for order, _ in mesh.error}
    return tuple(sorted(found))


def sweeping(system: System) -> Excitation:
    """The torques without order and frequency, that act at every frequency of a frequency response."""
    anywhere = [t for t in system.train.torques if t.order is None and t.frequency is None]
    return _excitation(anywhere, None, None)


def _excitation(
    found: Sequence[Torque | JointError], order: Fraction | None, frequency: float | None
) -> Excitation:
    torques = tuple(one for one in found if isinstance(one, Torque))
    errors = tuple(one for one in found if isinstance(one, JointError))
    own = {one.name: one.order for one in found}
    orders = tuple(Fraction(one) for one in own.values() if one is not None)
    return Excitation(Line(order, frequency, tuple(own), orders), torques, errors)


def sources(
    system: System, excitation: Excitation, speed: FloatArray, steady: Steady | None
) -> Sources:
    """Complex amplitudes of one line at reference speeds (speeds,) rad/s; `steady` holds the same speeds.

    A torque's phase, and that of a mesh's error, counts from reference angle zero. A joint's error counts from its own
    driving angle, static twist included. A force on a station of speed ratio r acts on the condensed tree as r times
    itself.
    """
    condensed = system.condensed
    force = np.zeros((condensed.tree.size, len(speed)), dtype=np.complex128)
    twist, loop_twist = (
        np.zeros_like(force),
        np.zeros((len(condensed.extra), len(speed)), dtype=np.complex128),
    )
    for torque in excitation.torques:
        ratio = system.speed_ratio[torque.station]
        if torque.mesh is None:
            force[condensed.node[torque.station]] += ratio * amplitude(
                system, torque, speed, steady
            )
            continue
        mesh, slip = (
            mesh_span(system, torque.mesh[0]),
            torque.mesh[1] * np.exp(1j * torque.phase) / ratio,
        )
        if condensed.span[mesh] < 0:
            loop_twist[condensed.extra == mesh] -= slip
        else:
            twist[condensed.span[mesh]] -= condensed.sign[mesh] * slip
    if not excitation.errors:
        return Sources(
            force, *(imposed if imposed.any() else None for imposed in (twist, loop_twist))
        )
    for error in excitation.errors:
        span = system.spans[error.span]
        turned = joint_error(system, error, speed, steady)
        # a joint is rigid, and a rigid span is always one of the tree
        twist[condensed.span[error.span]] += (
            condensed.sign[error.span] * turned / system.speed_ratio[span.driven]
        )
        if steady is not None:
            slope = 1j * error.order * turned / float(span.ratio)
            jump = -slope * steady.torque[error.span] * system.speed_ratio[span.driving]
            force[condensed.node[span.driving]] += jump
    return Sources(force, twist, loop_twist)


def mesh_span(system: System, name: str) -> int:
    """The span of the mesh of that name."""
    return next(
        k
        for k, span in enumerate(system.own_spans)
        if span.name == name and system.train.parts[span.part].kind == "gear"
    )


def joint_error(
    system: System, error: JointError, speed: FloatArray, steady: Steady | None
) -> ComplexArray:
    """(speeds,) rad of the driven angle, as a phasor over the reference angle.

    With T_a d(driving) = T_b d(driven) the driving side feels T_b (1 + e'): the part mean torque * e' of it is the
    torque jump that `sources` adds at the driving station (first order in the error).
    """
    base = np.full(len(speed), error.amplitude, dtype=np.complex128)
    if steady is None:
        return base
    return np.asarray(
        base * np.exp(1j * error.order * steady.twist[system.spans[error.span].driving])
    )


def amplitude(
    system: System, torque: Torque, speed: FloatArray, steady: Steady | None
) -> ComplexArray:
    """(speeds,) complex N m at the torque's own station."""
    own = speed * system.speed_ratio[torque.station]
    if torque.cylinder is not None:
        return torque.cylinder.amplitude(
            own, None if steady is None else steady.applied[torque.cylinder.station]
        )
    size = np.full(len(speed), torque.torque)
    if torque.table:
        about = Fault(("excitations",), f"the table of the torque at '{torque.name}'", "")
        size = size + interpolated(torque.table, own, about)
    if torque.of_mean:
        size = size + torque.of_mean * _mean_there(system, torque, steady)
    return np.asarray(size * np.exp(1j * torque.phase))


def _mean_there(system: System, torque: Torque, steady: Steady | None) -> FloatArray:
    """(speeds,) N m: the mean torque applied at the torque's station, else the largest in its spans."""
    if steady is None:
        message = f"the torque at '{torque.name}' is a share of the mean torque, which is not known"
        raise InputError(
            [Fault(("operation", "rated", "power"), message, "give the rated speed and power")]
        )
    applied = np.abs(steady.applied[torque.station])
    if applied.any():
        return np.asarray(applied)
    here = (system.driving == torque.station) | (system.driven == torque.station)
    if not here.any():
        return np.zeros(applied.shape)
    # a span's torque is stated at its driving station's speed; across a gear it is not the station's own
    own = (
        steady.torque[here]
        * (system.span_ratio[here] / system.speed_ratio[torque.station])[:, None]
    )
    return np.asarray(np.abs(own).max(axis=0))
