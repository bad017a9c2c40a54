"""What happens to a train in time: torques at its points, each lowered to ramps and exponentials of time."""

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from torsion import fields
from torsion.analyses.transient.following_events import Length, Load, SpeedProgram, Start
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.kernels.transient.torque_history import Piece

Time = Annotated[float, Quantity("s", at_least=0, usual=(None, 1e5))]
SignedTorque = Annotated[float, Quantity("N*m")]
ICE_CASES = {  # factor C_q, contact angle in deg by number of blades; FSICR 2017, from memory: to be verified
    1: (0.75, {3: 90.0, 4: 90.0, 5: 72.0, 6: 60.0}), 2: (1.0, {3: 135.0, 4: 135.0, 5: 135.0, 6: 135.0}),
    3: (0.5, {3: 45.0, 4: 45.0, 5: 36.0, 6: 30.0}), 4: (0.5, {3: 45.0, 4: 45.0, 5: 36.0, 6: 30.0}),
}  # fmt: skip
TWO_BLOCKS = 3  # the ice case of two blocks at once


@dataclass(frozen=True)
class Point:
    """Where an event acts, as the train is when it begins."""

    speed: float = 0.0  # rad/s of its own shaft
    mean: float = 0.0  # N m that drives it (positive) or that it absorbs, at that speed
    rated: float = 0.0  # N m, rated torque
    blades: int = 0
    rated_speed: float = 0.0  # rad/s of its own shaft


def _read_rows(value: Any) -> tuple[tuple[float, float], ...]:
    """[[time, torque], ...] in s and N m, the times rising."""
    time, torque = Quantity("s", at_least=0), Quantity("N*m")
    if not isinstance(value, list | tuple):
        raise refuse("the rows of a table over time are a list", "[[0 s, 0 N*m], [0.5 s, 100 N*m]]")
    rows = []
    for row in value:
        if not isinstance(row, list | tuple) or len(row) != 2:
            raise refuse("a row of a table over time is [time, torque]", "for example [0.5 s, 120 N*m]")
        rows.append((time.read(row[0]), torque.read(row[1])))
    if len(rows) < 2 or any(a[0] >= b[0] for a, b in pairwise(rows)):
        raise refuse("a table over time needs two rows or more with rising times")
    return tuple(rows)


Rows = Annotated[
    tuple[tuple[float, float], ...],
    BeforeValidator(_read_rows, json_schema_input_type=tuple[tuple[float | str, float | str], ...]),
]


class Step(Declared):
    """A torque that begins at once and stays."""

    torque: SignedTorque = required("torque; negative brakes")
    until: Length | None = given("how long it lasts (default: to the end)")

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        yield Piece(begin, math.inf if self.until is None else begin + self.until, self.torque)


class Table(Declared):
    """A torque by a table over time, linear between its rows and nothing outside."""

    rows: Rows = required("[[time, torque], ...], times from the begin of the event")

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        yield from ramps([(begin + time, torque) for time, torque in self.rows])


class Pulse(Declared):
    """A single pulse."""

    torque: SignedTorque = required("its greatest torque")
    length: Length = required("how long it lasts")
    shape: Literal["half-sine", "rectangle", "triangle"] = given("its shape", "half-sine")

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        end = begin + self.length
        if self.shape == "triangle":
            yield from ramps([(begin, 0.0), (begin + self.length / 2.0, self.torque), (end, 0.0)])
        elif self.shape == "rectangle":
            yield Piece(begin, end, self.torque)
        else:
            yield Piece(begin, end, -1j * self.torque, rate=1j * math.pi / self.length)


class Sine(Declared):
    """A torque that oscillates: torque * exp(-t / decay) * sin(2 pi frequency t + phase)."""

    torque: SignedTorque = required("amplitude (half range)")
    frequency: fields.Frequency | None = given("its frequency")
    order: fields.Exact | None = given("cycles per revolution of the point's own shaft at its speed before the events")
    decay: Length | None = given("time in which it falls to 1/e (default: it does not)")
    phase: fields.Angle = given("phase at its begin", 0.0)
    until: Length | None = given("how long it lasts (default: to the end)")

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if (self.frequency is None) == (self.order is None):
            raise refuse("a sine has a `frequency` or an `order`", "give one of them")
        return self

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        w = 2.0 * math.pi * self.frequency if self.frequency is not None else float(self.order or 0) * at.speed
        rate = complex(0.0 if self.decay is None else -1.0 / self.decay, w)
        end = math.inf if self.until is None else begin + self.until
        yield Piece(begin, end, -1j * self.torque * cmath.exp(1j * self.phase), rate=rate)


class Coefficients(Declared):
    """Amplitudes of the torque in the air gap, of the rated torque."""

    line: float = required("of the part at line frequency")
    double: float = given("of the part at twice the line frequency, subtracted", 0.0)
    mean: float = given("of the part that decays without oscillating", 0.0)


class ShortCircuit(Declared):
    """T_r (line e^(-t/T_1) sin wt - double e^(-t/T_2) sin 2wt + mean e^(-t/T_2)), added to what acts otherwise."""

    coefficients: Coefficients = required("{line, double, mean}: amplitudes, of the rated torque; the maker's")
    decay: Annotated[tuple[Length, Length], Field()] = required("[T_1, T_2]: times of decay")
    line: fields.Frequency = given("line frequency", 50.0)
    clear: Length | None = given("time after which the fault is cleared (default: never)")
    reclose: Length | None = given("time after which the fault begins anew, for as long")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.reclose is not None and (self.clear is None or self.reclose <= self.clear):
            raise refuse("`reclose` comes after `clear`", "give `clear`, and a later `reclose`", "reclose")
        return self

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        w, c, (first, second) = 2.0 * math.pi * self.line, self.coefficients, self.decay
        for start in [begin] if self.reclose is None else [begin, begin + self.reclose]:
            end = math.inf if self.clear is None else start + self.clear
            yield Piece(start, end, -1j * at.rated * c.line, rate=complex(-1.0 / first, w))
            yield Piece(start, end, 1j * at.rated * c.double, rate=complex(-1.0 / second, 2.0 * w))
            yield Piece(start, end, at.rated * c.mean, rate=-1.0 / second)


class Ice(Declared):
    """Blades that mill ice at the speed before the events: half sines against the rotation, between two ramps."""

    torque: fields.Torque = required("Q_max, the greatest ice torque at the propeller")
    case: Literal[1, 2, 3, 4] | None = given("case of the ice rules: factor, angle and blocks (to be verified)")
    factor: fields.Number = given("C_q, where no case is given", 1.0)
    angle: fields.Angle | None = given("angle of contact alpha_i, where no case is given")
    turns: Annotated[int, Field(ge=2, le=1000)] = given("revolutions of the milling", 6)
    ramp: fields.Angle = given("angle over which the torque rises at the begin, and falls at the end", 1.5 * math.pi)

    @model_validator(mode="after")
    def _case_or_angle(self) -> Self:
        if (self.case is None) == (self.angle is None):
            raise refuse("ice has a `case`, or an `angle` and a `factor`", "give one of them")
        return self

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        factor, angle = self.factor, self.angle or 0.0
        if self.case is not None:
            factor, angles = ICE_CASES[self.case]
            angle = math.radians(angles[min(max(at.blades, 3), 6)])
        blocks = (0.0, math.pi / at.blades) if self.case == TWO_BLOCKS else (0.0,)
        last = 2.0 * math.pi * self.turns
        for hit in range(at.blades * self.turns):
            for block in blocks:
                first = 2.0 * math.pi * hit / at.blades + block
                yield from self._hit(begin, at.speed, (first, min(first + angle, last)), angle, factor)

    def _hit(
        self, begin: float, speed: float, between: tuple[float, float], angle: float, factor: float
    ) -> Iterator[Piece]:
        """One blade, in pieces over which the ramps have one slope."""
        last = 2.0 * math.pi * self.turns
        kinks = [self.ramp, last - self.ramp]
        edges = sorted({*between, *(kink for kink in kinks if between[0] < kink < between[1])})
        for start, end in pairwise(edges):
            level, later = (float(np.interp(x, [0.0, self.ramp, last - self.ramp, last], [0, 1, 1, 0]))
                            for x in (start, end))  # fmt: skip
            wave = 1j * factor * self.torque * cmath.exp(1j * math.pi * (start - between[0]) / angle)
            slope = (later - level) / (end - start) * speed
            times = begin + start / speed, begin + end / speed
            yield Piece(*times, wave * level, wave * slope, 1j * math.pi * speed / angle)


class Stop(Declared):
    """The mean torque of the point ends: a motor that trips, a load that is shed, a cylinder bank that misfires."""

    ramp: Time = given("time in which it falls to nothing", 0.0)

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        if self.ramp:
            yield Piece(begin, begin + self.ramp, 0.0, -at.mean / self.ramp)
        yield Piece(begin + self.ramp, math.inf, -at.mean)


def ramps(rows: Sequence[tuple[float, float]]) -> Iterator[Piece]:
    """Straight lines between (s, N m)."""
    for (begin, level), (end, later) in pairwise(rows):
        if level or later:
            yield Piece(begin, end, level, (later - level) / (end - begin))


KINDS = {
    "step": Step, "table": Table, "pulse": Pulse, "sine": Sine, "short_circuit": ShortCircuit, "ice": Ice, "stop": Stop,
    "start": Start, "load": Load, "speed": SpeedProgram,
}  # fmt: skip


class Event(Declared):
    """One event at a point; several add."""

    at: str = required("name of the point at which it happens")
    time: Time = given("time of its begin", 0.0)
    step: Step | None = given("{torque, until}: a torque that begins at once")
    table: Table | None = given("{rows: [[s, N*m], ...]}: a torque by a table over time")
    pulse: Pulse | None = given("{torque, length, shape}: half-sine, rectangle or triangle")
    sine: Sine | None = given("{torque, frequency or order, decay, phase, until}: an oscillating torque")
    short_circuit: ShortCircuit | None = given(
        "{coefficients, decay, line, clear, reclose}: electrical fault of a machine", alias="short-circuit"
    )
    ice: Ice | None = given("{torque, case or angle and factor, turns, ramp}: a propeller that mills ice")
    stop: Stop | None = given("{ramp}: the point's mean torque ends")
    start: Start | None = given(
        "{torque or pull_out, slip, synchronous; pulsation, slip_pulsation, line, off}: a motor is switched on"
    )
    load: Load | None = given("{law, torque, speed, off}: what brakes the point, by its speed")
    speed: SpeedProgram | None = given("{program: [[s, rpm], ...]}: the speed of a fixed point is prescribed")

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(kinds) != 1:
            words = ", ".join(kind.replace("_", "-") for kind in KINDS)
            raise refuse(f"an event is of one kind, and {len(kinds) or 'none'} is given", f"one of {words}")
        return self

    @property
    def kind(self) -> str:
        """Its key in the file."""
        return next(kind for kind in KINDS if getattr(self, kind) is not None).replace("_", "-")

    @property
    def body(self) -> Any:
        """Its settings."""
        return getattr(self, self.kind.replace("-", "_"))

    def words(self) -> str:
        """Its settings, those that are not left at their defaults, in SI."""
        body = self.body.model_dump(exclude_defaults=True)
        return ", ".join(f"{key} {value}" for key, value in body.items())

    def pieces(self, at: Point) -> tuple[Piece, ...]:
        """What of its torque is known by time alone, N m at own speed, positive in the sense of rotation."""
        if isinstance(self.body, Start | Load):
            return tuple(self.body.pieces(self.time, at.mean))
        return () if isinstance(self.body, SpeedProgram) else tuple(self.body.pieces(self.time, at))
