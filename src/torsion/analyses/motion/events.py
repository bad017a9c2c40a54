"""What happens to a train in time: torques at its points, each lowered to ramps and exponentials of time."""

import cmath
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BeforeValidator, create_model, model_validator

from torsion import fields
from torsion.analyses.motion.event_kind import Kind, Lack, Length, Point, Time, settings_in_words
from torsion.analyses.motion.following_events import Load, SpeedProgram, Start
from torsion.analyses.motion.milling_ice import Ice
from torsion.analyses.motion.short_circuit import ShortCircuit
from torsion.analyses.motion.torque_file import torque_rows
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.kernels.motion import torque_laws
from torsion.kernels.motion.collocation import Law
from torsion.kernels.motion.torque_history import Piece

Share = Annotated[float, Quantity("1", above=0, at_most=1)]
SignedTorque = Annotated[float, Quantity("N*m")]


def _read_rows(value: Any) -> tuple[tuple[float, float], ...]:
    """[[time, torque], ...] in s and N m, the times rising."""
    time, torque = Quantity("s", at_least=0), Quantity("N*m")
    if not isinstance(value, list | tuple):
        raise refuse("the rows of a table over time are a list", "[[0 s, 0 N*m], [0.5 s, 100 N*m]]")
    rows = []
    for row in value:
        if not isinstance(row, list | tuple) or len(row) != 2:
            raise refuse(
                "a row of a table over time is [time, torque]", "for example [0.5 s, 120 N*m]"
            )
        rows.append((time.read(row[0]), torque.read(row[1])))
    if len(rows) < 2 or any(a[0] >= b[0] for a, b in pairwise(rows)):
        raise refuse("a table over time needs two rows or more with rising times")
    return tuple(rows)


Rows = Annotated[
    tuple[tuple[float, float], ...],
    BeforeValidator(_read_rows, json_schema_input_type=tuple[tuple[float | str, float | str], ...]),
]


class Lasting(Kind):
    """What lasts a while, or to the end of the motion."""

    length: Length | None = given(
        "how long it lasts, of `stop` without the ramp (default: to the end)"
    )
    until: Length | None = given("the same as `length`: it counts from the begin of the event")

    @model_validator(mode="after")
    def _given_once(self) -> Self:
        if self.length is not None and self.until is not None:
            raise refuse("`until` and `length` have the same meaning", "keep `length`", "until")
        return self

    @property
    def lasts(self) -> float:
        """s, infinite to the end of the motion."""
        given_length = self.length if self.until is None else self.until
        return math.inf if given_length is None else given_length


class Step(Lasting):
    """A torque that begins at once and stays."""

    key, meaning = "step", "{torque, length}: a torque that begins at once"

    torque: SignedTorque = required("torque; negative brakes")

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        yield Piece(begin, begin + self.lasts, self.torque)


class Table(Kind):
    """A torque by a table over time, linear between its rows and nothing outside."""

    key, meaning = (
        "table",
        "{rows: [[s, N*m], ...]} or {file: torque.csv}: a torque by a table over time",
    )

    rows: Rows | None = given("[[time, torque], ...], times from the begin of the event")
    file: str | None = given(
        "a file of two columns, time and torque, with their units in its first line"
    )

    def refuse_clashes(self) -> None:
        if (self.rows is None) == (self.file is None):
            raise refuse("a table over time has `rows` or a `file`", "give one of them")

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        rows = self.rows if self.file is None else torque_rows(at.folder / self.file)
        yield from ramps([(begin + time, torque) for time, torque in rows or ()])

    def corners(self, at: Point) -> tuple[float, ...]:
        rows = self.rows if self.file is None else torque_rows(at.folder / self.file)
        return tuple(time for time, _ in rows or ())

    def lacks(self, at: Point) -> Lack:
        try:
            torque_rows(at.folder / self.file) if self.file is not None else None
        except ValueError as error:
            return str(error.args[0]), str(error.args[-1])
        return None


class Pulse(Kind):
    """A single pulse."""

    key, meaning = "pulse", "{torque, length, shape}: half-sine, rectangle or triangle"

    torque: SignedTorque = required("its greatest torque")
    length: Length = required("how long it lasts")
    shape: Literal["half-sine", "rectangle", "triangle"] = given("its shape", "half-sine")

    def corners(self, at: Point) -> tuple[float, ...]:
        return (0.0, self.length / 2.0, self.length)

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        end = begin + self.length
        if self.shape == "triangle":
            yield from ramps([(begin, 0.0), (begin + self.length / 2.0, self.torque), (end, 0.0)])
        elif self.shape == "rectangle":
            yield Piece(begin, end, self.torque)
        else:
            yield Piece(begin, end, -1j * self.torque, rate=1j * math.pi / self.length)


class Sine(Lasting):
    """A torque that oscillates: torque * exp(-t / decay) * sin(2 pi frequency t + phase)."""

    key, meaning = (
        "sine",
        "{torque, frequency or order, decay, phase, length}: an oscillating torque",
    )

    torque: SignedTorque = required("amplitude (half range)")
    frequency: fields.Frequency | None = given("its frequency")
    order: fields.Exact | None = given(
        "cycles per revolution of the point's own shaft: at its speed before the events. If a torque or joint "
        "follows the motion (an order, a cylinder, a start, a load): by its angle"
    )
    decay: Length | None = given("time in which it falls to 1/e (default: it does not)")
    phase: fields.Angle = given("phase at its begin", 0.0)

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if (self.frequency is None) == (self.order is None):
            raise refuse("a sine has a `frequency` or an `order`", "give one of them")
        return self

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        w = (
            2.0 * math.pi * self.frequency
            if self.frequency is not None
            else float(self.order or 0) * at.speed
        )
        rate = complex(0.0 if self.decay is None else -1.0 / self.decay, w)
        yield Piece(
            begin, begin + self.lasts, -1j * self.torque * cmath.exp(1j * self.phase), rate=rate
        )

    def lacks(self, at: Point) -> Lack:
        if self.order is not None and not (at.speed or at.turns):
            return (
                "an order has no frequency in a train that stands still",
                "give `frequency`, or an `initial` speed",
            )
        return None

    @property
    def by_angle(self) -> bool:
        return self.order is not None

    def laws(self, begin: float, at: Point) -> Iterator[Law]:
        if self.order is not None:
            rate, phase = (
                0.0 if self.decay is None else -1.0 / self.decay,
                self.phase - math.pi / 2.0,
            )
            size, window = (
                torque_laws.constant(self.torque),
                torque_laws.Window(begin, begin + self.lasts),
            )
            yield torque_laws.Wave(0, size, float(self.order), phase, rate, window, from_begin=True)


class Stop(Lasting):
    """The mean torque of the point ends: a motor that trips, a load that is shed, a cylinder bank that misfires."""

    key, meaning = "stop", "{share, ramp, length}: the point's mean torque ends"

    share: Share = given("of the mean torque that ends", 1.0)
    ramp: Time = given("time in which it falls", 0.0)

    def corners(self, at: Point) -> tuple[float, ...]:
        return (0.0, self.ramp) if self.ramp else ()

    def taken(self, late: float) -> float:
        """The share that has ended so late (s) after its begin."""
        if not 0.0 <= late < self.ramp + self.lasts:
            return 0.0
        return self.share * (min(late / self.ramp, 1.0) if self.ramp else 1.0)

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        low, end = self.share * at.mean, begin + self.ramp + self.lasts
        if self.ramp:
            yield Piece(begin, begin + self.ramp, 0.0, -low / self.ramp)
        yield Piece(begin + self.ramp, end, -low)

    def lacks(self, at: Point) -> Lack:
        hint = "name a motor or a load of a steady train"
        return None if at.mean else (f"no mean torque acts at '{at.name}'", hint)


class Clutch(Kind):
    """A clutch closes or opens: its capacity over time from here on."""

    key, meaning = (
        "clutch",
        "{torque, close or open}: a coupling with `capacity` closes or opens; `at` is its name",
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
            raise refuse(
                "a clutch has one of `torque`, `close` and `open`", "for example `close: 0.5 s`"
            )
        if self.torque is not None and any(torque < 0.0 for _, torque in self.torque):
            raise refuse(
                "the capacity of a clutch is not negative", "torques of 0 N*m and more", "torque"
            )

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        """No torque by itself."""
        yield from ()

    def lacks(self, at: Point) -> Lack:
        return (
            None
            if at.is_clutch
            else (f"'{at.name}' is no clutch", "name a coupling with `capacity`")
        )

    def rows(self, begin: float, capacity: float) -> tuple[tuple[float, float], ...]:
        """((s, N m), ...) its capacity, linear between rows and constant after the last."""
        if self.torque is not None:
            return tuple((begin + time, torque) for time, torque in self.torque)
        late = (self.open if self.close is None else self.close) or 0.0
        first, last = (capacity, 0.0) if self.close is None else (0.0, capacity)
        return ((begin, first), (begin + late, last)) if late else ((begin, last),)

    def corners(self, at: Point) -> tuple[float, ...]:
        if self.torque is not None:
            return tuple(time for time, _ in self.torque)
        late = self.open or self.close
        return (0.0, late) if late else ()

    @property
    def begins_open(self) -> bool:
        """The clutch has no capacity before it."""
        return self.open is None


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

    def refuse_clashes(self) -> None:
        kinds = [kind.key for kind in KINDS if getattr(self, _field(kind)) is not None]
        if len(kinds) != 1:
            words = ", ".join(kind.key for kind in KINDS)
            raise refuse(
                f"an event is of one kind, and {' and '.join(kinds) or 'none'} is given",
                f"one of {words}",
            )

    @model_validator(mode="after")
    def _lasts_from_its_begin(self) -> Self:
        until = getattr(self.body, "until", None)
        if until is not None and until < self.time:
            message = (
                f"`until` counts from the begin of the event, and {until:g} s is before its `time`"
            )
            raise refuse(message, f"`length: {until:g} s` for so long", _field(type(self.body)))
        return self

    @property
    def body(self) -> Kind:
        """What happens."""
        return next(body for kind in KINDS if isinstance(body := getattr(self, _field(kind)), Kind))

    @property
    def words(self) -> str:
        """Its settings, those that are not left at their defaults."""
        return settings_in_words(self.body)

    def pieces(self, at: Point) -> tuple[Piece, ...]:
        """What of its torque is known by time, N m at own speed, positive in the sense of rotation."""
        return () if at.turns and self.body.by_angle else tuple(self.body.pieces(self.time, at))


def _field(kind: type[Kind]) -> str:
    return kind.key.replace("-", "_")


if TYPE_CHECKING:
    Event = _Event
else:
    _FIELDS = {_field(kind): (kind | None, given(kind.meaning, alias=kind.key)) for kind in KINDS}
    Event = create_model("Event", __base__=_Event, __doc__=_Event.__doc__, **_FIELDS)
