"""Torques that follow the speed of their point: starts of motors, loads, and a speed that is prescribed."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from torsion import fields
from torsion.components.harmonic_torques import Table as SpeedTable
from torsion.components.harmonic_torques import read_table
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.kernels.transient import torque_laws
from torsion.kernels.transient.collocation import Law
from torsion.kernels.transient.torque_history import Piece

Length = Annotated[float, Quantity("s", above=0, usual=(None, 1e5))]
PullOut = Annotated[float, Quantity("1", above=0, below=1)]


@dataclass(frozen=True)
class RatedPoint:
    """Rated torque and speed of a point, at its own shaft; 0 where the file gives none."""

    torque: float = 0.0  # N m
    speed: float = 0.0  # rad/s


def _read_rows(value: Any) -> Any:
    if not isinstance(value, list | tuple):
        raise refuse("a table over speed is a list", "[[0 rpm, 900 N*m], [1500 rpm, 0 N*m]]")
    rows = read_table(value)
    if rows[0][0] != 0.0:
        raise refuse("a table over speed for a motion over time begins at 0 rpm", "add its row [0 rpm, ...]")
    return rows


def _read_law(value: Any) -> Any:
    if isinstance(value, str):
        if value not in ("propeller", "constant"):
            raise refuse(f"'{value}' is no law of load", "propeller, constant, or a table [[speed, torque], ...]")
        return value
    return _read_rows(value)


def _read_program(value: Any) -> tuple[tuple[float, float], ...]:
    time, speed = Quantity("s", at_least=0), Quantity("rad/s", at_least=0)
    if not isinstance(value, list | tuple) or not all(isinstance(row, list | tuple) and len(row) == 2 for row in value):
        raise refuse("a program of speed is a list of [time, speed]", "[[0 s, 0 rpm], [2 s, 1500 rpm]]")
    rows = tuple((time.read(row[0]), speed.read(row[1])) for row in value)
    if len(rows) < 2 or any(a[0] >= b[0] for a, b in pairwise(rows)):
        raise refuse("a program of speed needs two rows or more with rising times")
    return rows


Program = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_read_program, json_schema_input_type=SpeedTable)]
Rows = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_read_rows, json_schema_input_type=SpeedTable)]


class Pulsation(Declared):
    """What a direct start adds: torque e^(-t/decay) sin(line t)."""

    torque: fields.Torque = required("its first amplitude: 1 to 5 times the rated torque")
    decay: Length = required("time in which it falls to 1/e: 0.05 to 0.3 s")


class Start(Declared):
    """A motor that is switched on: it takes the place of the point's mean torque, by the speed of its shaft."""

    torque: Rows | None = given("[[speed, torque], ...] from 0 rpm on; its last line goes on beyond it")
    pull_out: fields.Torque | None = given("greatest torque of an induction motor, in place of a table (Kloss)")
    slip: PullOut | None = given("slip at which it pulls out")
    synchronous: fields.Speed | None = given("synchronous speed")
    pulsation: Pulsation | None = given("{torque, decay} at line frequency")
    slip_pulsation: Rows | None = given(
        "[[speed, amplitude], ...] of a synchronous motor that starts: it pulsates at twice the slip frequency"
    )
    line: fields.Frequency = given("line frequency", 50.0)
    off: Length | None = given("time after which it is switched off (default: never)")

    @model_validator(mode="after")
    def _curve(self) -> Self:
        kloss = (self.pull_out, self.slip, self.synchronous)
        if self.torque is None and None in kloss:
            raise refuse("a start needs its torque over speed", "`torque: [[speed, torque], ...]`, or `pull_out`, "
                         "`slip` and `synchronous`")  # fmt: skip
        if self.torque is not None and (self.pull_out is not None or self.slip is not None):
            raise refuse("`torque` and `pull_out` with `slip` exclude each other", "keep one of them", "torque")
        if self.slip_pulsation is not None and self.synchronous is None:
            raise refuse("`slip_pulsation` needs `synchronous`, the synchronous speed", key="slip_pulsation")
        return self

    def pieces(self, begin: float, mean: float) -> Iterator[Piece]:
        """What is known of it by time alone; `mean` is the torque that it replaces."""
        if mean:
            yield Piece(begin, math.inf, -mean)
        if self.pulsation is not None:
            rate = complex(-1.0 / self.pulsation.decay, 2.0 * math.pi * self.line)
            yield Piece(begin, self._window(begin).end, -1j * self.pulsation.torque, rate=rate)

    def laws(self, begin: float, rated: RatedPoint) -> Iterator[Law]:
        """What follows the motion."""
        window = self._window(begin)
        if self.torque is not None:
            yield torque_laws.BySpeed(0, torque_laws.table(self.torque), window)
        else:
            yield torque_laws.InductionMotor(0, self.pull_out or 0.0, self.slip or 1.0, self.synchronous or 1.0, window)
        if self.slip_pulsation is not None:
            twice = 4.0 * math.pi * self.line
            turned = -twice / (self.synchronous or 1.0)
            yield torque_laws.Wave(
                0, torque_laws.table(self.slip_pulsation), turned, 0.0, 1j * twice, window, from_begin=True
            )

    def _window(self, begin: float) -> torque_laws.Window:
        return torque_laws.Window(begin, math.inf if self.off is None else begin + self.off)


class Load(Declared):
    """What brakes a point, in place of its mean torque, by the speed of its shaft; alike in both senses of rotation."""

    law: Annotated[
        Any, BeforeValidator(_read_law, json_schema_input_type=Literal["propeller", "constant"] | SpeedTable)
    ] = required("propeller (T ~ n**2), constant (holds at rest), or [[speed, torque], ...] from 0 rpm on")
    torque: fields.Torque | None = given("torque of the law at `speed` (default: the rated torque)")
    speed: fields.Speed | None = given("speed of the point at that torque (default: its rated speed)")
    off: Length | None = given("time after which it ends (default: never)")

    @model_validator(mode="after")
    def _no_more_than_its_law(self) -> Self:
        if not isinstance(self.law, str) and (self.torque is not None or self.speed is not None):
            raise refuse("a table says torque and speed itself", "leave `torque` and `speed` out", "law")
        return self

    @property
    def ends(self) -> float:
        """rad/s, where its table ends; infinite for a law."""
        return math.inf if isinstance(self.law, str) else float(self.law[-1][0])

    def pieces(self, begin: float, mean: float) -> Iterator[Piece]:
        """What it replaces."""
        if mean:
            yield Piece(begin, math.inf, -mean)

    def laws(self, begin: float, rated: RatedPoint) -> Iterator[Law]:
        """What follows the motion."""
        window = torque_laws.Window(begin, math.inf if self.off is None else begin + self.off)
        torque, speed = self.torque or rated.torque, self.speed or rated.speed or 1.0
        if self.law == "propeller":
            yield torque_laws.BySpeed(0, torque_laws.quadratic(-torque, speed), window)
            return
        rows = [(0.0, torque), (speed, torque)] if self.law == "constant" else self.law
        still = rows[0][1]
        if still:
            yield torque_laws.DryFriction(0, still, rows[-1][0], window)
        if self.law != "constant":
            line = [(at, still - value) for at, value in rows]
            yield torque_laws.BySpeed(0, torque_laws.table(torque_laws.mirrored(line, sign=-1.0)), window)

    def lacks(self, rated: RatedPoint) -> bool:
        """The law has no size."""
        needs = self.law == "propeller", isinstance(self.law, str)
        return (needs[1] and not (self.torque or rated.torque)) or (needs[0] and not (self.speed or rated.speed))


class SpeedProgram(Declared):
    """A speed that a fixed point is made to run at."""

    program: Program = required("[[time, speed], ...] from the begin of the event, straight between; then the last")

    def rates(self, begin: float) -> list[tuple[float, float, float]]:
        """Begin and end (s) and rate (rad/s2) of every line of it."""
        return [(begin + a[0], begin + b[0], (b[1] - a[1]) / (b[0] - a[0])) for a, b in pairwise(self.program)]
