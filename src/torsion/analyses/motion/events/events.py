"""What happens to a train in time: torques at its points, each lowered to ramps and exponentials of time."""

import cmath
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import create_model, model_validator

from torsion import fields
from torsion.analyses.motion.events.event_kind import (
    Kind,
    Lack,
    Length,
    Pairs,
    Point,
    Time,
    rows_over_time,
)
from torsion.analyses.motion.events.machine_events import Load, ShortCircuit, SpeedProgram, Start
from torsion.analyses.motion.events.milling_ice import Ice
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.kernels.motion.loaded_modes import Piece

Share = Annotated[float, Quantity("1", above=0, at_most=1)]
SignedTorque = Annotated[float, Quantity("N*m")]
Rows = Annotated[
    Pairs, rows_over_time(Quantity("N*m"), "a table over time", "[[0 s, 0 N*m], [0.5 s, 100 N*m]]")
]


class Lasting(Kind):
    """What lasts a while, or to the end of the motion."""

    length: Length | None = given(
        "how long it lasts, of `stop` without the ramp (default: to the end)"
    )
    until: Length | None = given("the same as `length`: it counts from the begin of the event")

    def refuse_clashes(self) -> None:
        if self.length is not None and self.until is not None:
            raise refuse("`until` and `length` have the same meaning", "keep `length`", "until")

    @property
    def lasts(self) -> float:
        """s, infinite to the end of the motion."""
        return self.length or self.until or math.inf

    def changes(self, point: Point) -> list[float]:
        return [0.0] if math.isinf(self.lasts) else [0.0, self.lasts]


class Step(Lasting):
    """A torque that begins at once and stays."""

    key, meaning = "step", "{torque, length}: a torque that begins at once"

    torque: SignedTorque = required("torque; negative brakes")

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        yield Piece(begin, begin + self.lasts, self.torque)


class Table(Kind):
    """A torque by a table over time, linear between its rows and nothing outside."""

    key = "table"
    meaning = "{rows: [[s, N*m], ...]} or {file: torque.csv}: a torque by a table over time"

    rows: Rows | None = given("[[time, torque], ...], times from the begin of the event")
    file: str | None = given(
        "a file of two columns, time and torque, with their units in its first line"
    )

    def refuse_clashes(self) -> None:
        if (self.rows is None) == (self.file is None):
            raise refuse("a table over time has `rows` or a `file`", "give one of them")

    def rows_read(self, point: Point) -> Pairs:
        """(s, N m) of every row; raises ValueError as `pairs` does."""
        if self.file is None:
            return self.rows or ()
        from torsion.tables import Columns, pairs

        columns = Columns(
            ("time", "torque"),
            ("s", "N*m"),
            "time [s], torque [N*m]",
            "0.5, 120",
            "a finite torque at a finite time from 0 on",
            0.0,
        )
        rows = pairs(point.folder / self.file, columns)
        return tuple((time, torque) for time, torque in rows)

    def changes(self, point: Point) -> list[float]:
        return [time for time, _ in self.rows_read(point)]

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        return ramps([(begin + time, torque) for time, torque in self.rows_read(point)])

    def lacks(self, point: Point) -> Lack:
        try:
            self.rows_read(point)
        except ValueError as error:
            return str(error.args[0]), str(error.args[-1])
        return None


class Pulse(Kind):
    """A single pulse."""

    key, meaning = "pulse", "{torque, length, shape}: half-sine, rectangle or triangle"

    torque: SignedTorque = required("its greatest torque")
    length: Length = required("how long it lasts")
    shape: Literal["half-sine", "rectangle", "triangle"] = given("its shape", "half-sine")

    def changes(self, point: Point) -> list[float]:
        return [0.0, self.length / 2.0, self.length]

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        end = begin + self.length
        if self.shape == "triangle":
            yield from ramps([(begin, 0.0), (begin + self.length / 2.0, self.torque), (end, 0.0)])
        elif self.shape == "rectangle":
            yield Piece(begin, end, self.torque)
        else:
            yield Piece(begin, end, -1j * self.torque, rate=1j * math.pi / self.length)


class Sine(Lasting):
    """A torque that oscillates: torque * exp(-t / decay) * sin(2 pi frequency t + phase)."""

    key = "sine"
    meaning = "{torque, frequency or order, decay, phase, length}: an oscillating torque"

    torque: SignedTorque = required("amplitude (half range)")
    frequency: fields.Frequency | None = given("its frequency")
    order: fields.Exact | None = given(
        "cycles per revolution of the point's own shaft: at its speed before the events. If a torque or joint "
        "follows the motion (an order, a cylinder, a start, a load): by its angle"
    )
    decay: Length | None = given("time in which it falls to 1/e (default: it does not)")
    phase: fields.Angle = given("phase at its begin", 0.0)

    def refuse_clashes(self) -> None:
        super().refuse_clashes()
        if (self.frequency is None) == (self.order is None):
            raise refuse("a sine has a `frequency` or an `order`", "give one of them")

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        w = float(self.order or 0) * point.speed
        if self.frequency is not None:
            w = 2.0 * math.pi * self.frequency
        level = -1j * self.torque * cmath.exp(1j * self.phase)
        rate = complex(-1.0 / (self.decay or math.inf), w)
        yield Piece(begin, begin + self.lasts, level, rate=rate)

    def lacks(self, point: Point) -> Lack:
        if self.order is None or point.speed or point.turns:
            return None
        hint = "give `frequency`, or an `initial` speed"
        return "an order has no frequency in a train that stands still", hint

    def laws(self, begin: float, point: Point) -> "Iterator[Law]":
        from torsion.kernels.motion import torque_laws

        if self.order is not None:
            size, order = torque_laws.constant(self.torque), float(self.order)
            window = torque_laws.Window(begin, begin + self.lasts)
            phase, rate = self.phase - math.pi / 2.0, -1.0 / (self.decay or math.inf)
            yield torque_laws.Wave(0, size, order, phase, rate, window, from_begin=True)


class Stop(Lasting):
    """The mean torque of the point ends: a motor that trips, a load that is shed, a cylinder bank that misfires."""

    key, meaning = "stop", "{share, ramp, length}: the point's mean torque ends"

    share: Share = given("of the mean torque that ends", 1.0)
    ramp: Time = given("time in which it falls", 0.0)

    def taken(self, late: float) -> float:
        """The share that has ended so late (s) after its begin."""
        if not 0.0 <= late < self.ramp + self.lasts:
            return 0.0
        return self.share * (min(late / self.ramp, 1.0) if self.ramp else 1.0)

    def changes(self, point: Point) -> list[float]:
        late = super().changes(point)
        return [0.0, *(self.ramp + time for time in late)] if self.ramp else late

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        low, full = self.share * point.mean, begin + self.ramp
        if self.ramp:
            yield Piece(begin, full, 0.0, -low / self.ramp)
        yield Piece(full, full + self.lasts, -low)

    def lacks(self, point: Point) -> Lack:
        hint = "name a motor or a load of a steady train"
        return None if point.mean else (f"no mean torque acts at '{point.name}'", hint)


class Clutch(Kind):
    """A clutch closes or opens: its capacity over time from the begin on."""

    key = "clutch"
    meaning = (
        "{torque, close or open}: a coupling with `capacity` closes or opens; `at` is its name"
    )

    torque: Rows | None = given(
        "[[time, torque], ...]: its capacity, which stays as it is after the last row"
    )
    close: Time | None = given(
        "time in which its capacity rises from zero to the capacity of the coupling"
    )
    open: Time | None = given("time in which it falls from the capacity of the coupling to zero")

    def refuse_clashes(self) -> None:
        if [self.torque, self.close, self.open].count(None) != 2:
            hint = "for example `close: 0.5 s`"
            raise refuse("a clutch has one of `torque`, `close` and `open`", hint)
        if self.torque is not None and any(torque < 0.0 for _, torque in self.torque):
            message = "the capacity of a clutch is not negative"
            raise refuse(message, "torques of 0 N*m and more", "torque")

    def lacks(self, point: Point) -> Lack:
        hint = "name a coupling with `capacity`"
        return None if point.is_clutch else (f"'{point.name}' is no clutch", hint)

    def changes(self, point: Point) -> list[float]:
        return [time for time, _ in self.rows(0.0, 0.0)]

    def rows(self, begin: float, capacity: float) -> tuple[tuple[float, float], ...]:
        """((s, N m), ...) its capacity, linear between rows and constant after the last."""
        if self.torque is not None:
            return tuple((begin + time, torque) for time, torque in self.torque)
        late = (self.open if self.close is None else self.close) or 0.0
        first, last = (capacity, 0.0) if self.close is None else (0.0, capacity)
        return ((begin, first), (begin + late, last)) if late else ((begin, last),)


def ramps(rows: Sequence[tuple[float, float]]) -> Iterator[Piece]:
    """Straight lines between (s, N m)."""
    for (begin, level), (end, later) in pairwise(rows):
        if level or later:
            yield Piece(begin, end, level, (later - level) / (end - begin))


KINDS: tuple[type[Kind], ...] = (
    Step,
    Table,
    Pulse,
    Sine,
    ShortCircuit,
    Ice,
    Stop,
    Clutch,
    Start,
    Load,
    SpeedProgram,
)
UNBUILT = {
    "misfire": "`misfire` of the engine acts over the whole motion; `stop: {share: 17 %}` takes a share of a mean "
    "torque away"
}


class _Event(Declared):
    """One event at a point; several add."""

    at: str = required("name of the point (of a clutch: the coupling) at which it happens")
    time: Time = given("time of its begin", 0.0)

    @model_validator(mode="before")
    @classmethod
    def _is_built(cls, data: Any) -> Any:
        for key, hint in UNBUILT.items():
            if isinstance(data, dict) and key in data:
                raise refuse(f"`{key}` is part of the format but not built yet", hint, key)
        return data

    @property
    def _bodies(self) -> list[Kind]:
        """Of all kinds that are given."""
        bodies = (getattr(self, kind.field()) for kind in KINDS)
        return [body for body in bodies if isinstance(body, Kind)]

    def refuse_clashes(self) -> None:
        kinds = [body.key for body in self._bodies]
        if len(kinds) != 1:
            message = f"an event is of one kind, and {' and '.join(kinds) or 'none'} is given"
            raise refuse(message, f"one of {', '.join(kind.key for kind in KINDS)}")
        until = getattr(self.body, "until", None)
        if until is not None and until < self.time:
            message = (
                f"`until` counts from the begin of the event, and {until:g} s is before its `time`"
            )
            raise refuse(message, f"`length: {until:g} s` for so long", self.body.field())

    @property
    def body(self) -> Kind:
        """The settings of the one kind that is given."""
        return self._bodies[0]

    @property
    def by_angle(self) -> bool:
        """It follows the angle of its point, where the speed changes."""
        return isinstance(self.body, Ice) or getattr(self.body, "order", None) is not None

    def pieces(self, point: Point) -> tuple[Piece, ...]:
        """What of its torque is known by time, N m at own speed, positive in the sense of rotation."""
        if point.turns and self.by_angle:
            return ()
        return tuple(self.body.pieces(self.time, point))


if TYPE_CHECKING:
    from torsion.kernels.motion.collocation import Law

    Event = _Event
else:
    _FIELDS = {kind.field(): (kind | None, given(kind.meaning, alias=kind.key)) for kind in KINDS}
    Event = create_model("Event", __base__=_Event, __doc__=_Event.__doc__, **_FIELDS)
