"""Torques that follow the speed of their point: starts of motors, loads, and a speed that is prescribed."""

import cmath
import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from torsion import fields
from torsion.analyses.motion.event_kind import Kind, Lack, Length, Point
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.fields import WrittenRows as SpeedTable
from torsion.kernels.motion import torque_laws
from torsion.kernels.motion.collocation import Law
from torsion.kernels.motion.dry_friction import DryFriction
from torsion.kernels.motion.torque_history import Piece
from torsion.model.harmonic_torques import read_table
from torsion.sources import note

WORST = "worst"
SAME_SPEED = 1e-9  # relative, or rad/s
PullOut = Annotated[float, Quantity("1", above=0, below=1)]


def _read_rows(value: Any) -> Any:
    if not isinstance(value, list | tuple):
        raise refuse("a table over speed is a list", "[[0 rpm, 900 N*m], [1500 rpm, 0 N*m]]")
    rows = read_table(value)
    if rows[0][0] != 0.0:
        raise refuse(
            "a table over speed for a transient response begins at 0 rpm",
            "add its row [0 rpm, ...]",
        )
    return rows


def _read_law(value: Any) -> Any:
    if isinstance(value, str):
        if value not in ("propeller", "constant"):
            raise refuse(
                f"unknown load law '{value}'",
                "propeller, constant, or a table [[speed, torque], ...]",
            )
        return value
    rows = _read_rows(value)
    if any(torque < 0.0 for _, torque in rows):
        raise refuse(
            "a load brakes: its torques are 0 N*m or more", "what drives is a `start`, or a `step`"
        )
    return rows


def _read_program(value: Any) -> tuple[tuple[float, float], ...]:
    time, speed = Quantity("s", at_least=0), Quantity("rad/s", at_least=0)
    if not isinstance(value, list | tuple) or not all(
        isinstance(row, list | tuple) and len(row) == 2 for row in value
    ):
        raise refuse(
            "a program of speed is a list of [time, speed]", "[[0 s, 0 rpm], [2 s, 1500 rpm]]"
        )
    rows = tuple((time.read(row[0]), speed.read(row[1])) for row in value)
    if len(rows) < 2 or any(a[0] >= b[0] for a, b in pairwise(rows)):
        raise refuse("a program of speed needs two rows or more with rising times")
    return rows


Program = Annotated[
    tuple[tuple[float, float], ...],
    BeforeValidator(_read_program, json_schema_input_type=SpeedTable),
]
Rows = Annotated[
    tuple[tuple[float, float], ...], BeforeValidator(_read_rows, json_schema_input_type=SpeedTable)
]


def _read_phase(value: Any) -> Any:
    return value if value == WORST else Quantity("rad").read(value)


Phase = Annotated[Any, BeforeValidator(_read_phase, json_schema_input_type=float | str)]


class Pulsation(Declared):
    """What a direct start adds: torque e^(-t/decay) sin(line t + phase)."""

    torque: fields.Torque = required("its first amplitude: 1 to 5 times the rated torque")
    decay: Length = required("time in which it falls to 1/e: 0.05 to 0.3 s")
    phase: fields.Angle = given("phase of its sine as it begins", 0.0)


class Start(Kind):
    """A motor that is switched on: it takes the place of the point's mean torque, by the speed of its shaft."""

    key, drives = "start", True
    meaning = "{torque or pull_out, slip, synchronous; pulsation, slip_pulsation, line, off}: a motor is switched on"

    torque: Rows | None = given(
        "[[speed, torque], ...] from 0 rpm on; its last piece is extrapolated"
    )
    pull_out: fields.Torque | None = given(
        "breakdown torque of an induction motor, in place of a table (Kloss)"
    )
    slip: PullOut | None = given("slip at which it pulls out")
    synchronous: fields.Speed | None = given("synchronous speed")
    pulsation: Pulsation | None = given("{torque, decay} at line frequency")
    slip_pulsation: Rows | None = given(
        "[[speed, amplitude], ...] of a synchronous motor that starts: it pulsates at twice the slip frequency"
    )
    phase: Phase = given(
        "initial phase of the cosine of `slip_pulsation`; worst: several phases are computed, and the maximum "
        "torques are judged",
        "worst",
    )
    line: fields.Frequency = given("line frequency", 50.0)
    off: Length | None = given("time after which it is switched off (default: never)")

    @model_validator(mode="after")
    def _curve(self) -> Self:
        kloss = (self.pull_out, self.slip, self.synchronous)
        if self.torque is None and None in kloss:
            raise refuse(
                "a start needs its torque over speed",
                "`torque: [[speed, torque], ...]`, or `pull_out`, `slip` and `synchronous`",
            )
        if self.torque is not None and (self.pull_out is not None or self.slip is not None):
            raise refuse(
                "`torque` and `pull_out` with `slip` exclude each other",
                "keep one of them",
                "torque",
            )
        if self.slip_pulsation is not None and self.synchronous is None:
            raise refuse(
                "`slip_pulsation` needs `synchronous`, the synchronous speed", key="slip_pulsation"
            )
        if self.slip_pulsation is None and "phase" in self.model_fields_set:
            raise refuse(
                "`phase` is that of `slip_pulsation`",
                "`pulsation: {phase: ...}` has its own",
                "phase",
            )
        return self

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        if self.pulsation is not None:
            rate = complex(-1.0 / self.pulsation.decay, 2.0 * math.pi * self.line)
            level = -1j * self.pulsation.torque * cmath.exp(1j * self.pulsation.phase)
            yield Piece(begin, self._window(begin).end, level, rate=rate)

    def laws(self, begin: float, at: Point) -> Iterator[Law]:
        window = self._window(begin)
        if self.torque is not None:
            yield torque_laws.BySpeed(0, torque_laws.table(self.torque), window)
        else:
            note("Kloss1916")
            yield torque_laws.InductionMotor(
                0, self.pull_out or 0.0, self.slip or 1.0, self.synchronous or 1.0, window
            )
        if self.slip_pulsation is not None:
            twice = 4.0 * math.pi * self.line
            turned = -twice / (self.synchronous or 1.0)
            size, phase = (
                torque_laws.table(self.slip_pulsation),
                0.0 if self.phase == WORST else self.phase,
            )
            yield torque_laws.Wave(0, size, turned, phase, 1j * twice, window, from_begin=True)

    @property
    def has_worst_phase(self) -> bool:
        """Its phase is left open."""
        return self.slip_pulsation is not None and self.phase == WORST

    def _window(self, begin: float) -> torque_laws.Window:
        return torque_laws.Window(begin, math.inf if self.off is None else begin + self.off)


class Load(Kind):
    """What brakes a point, in place of its mean torque, by the speed of its shaft; alike in both senses of rotation."""

    key, drives = "load", True
    meaning = "{law, torque, speed, off}: what brakes the point, by its speed; its slope is the damping there"

    law: Annotated[
        Any,
        BeforeValidator(
            _read_law, json_schema_input_type=Literal["propeller", "constant"] | SpeedTable
        ),
    ] = required(
        "propeller (T ~ n**2), constant (holds at rest), or [[speed, torque], ...] from 0 rpm on"
    )
    torque: fields.Torque | None = given("torque of the law at `speed` (default: the rated torque)")
    speed: fields.Speed | None = given(
        "speed of the point at that torque (default: its rated speed)"
    )
    off: Length | None = given("time after which it ends (default: never)")

    @model_validator(mode="after")
    def _no_more_than_its_law(self) -> Self:
        if not isinstance(self.law, str) and (self.torque is not None or self.speed is not None):
            raise refuse(
                "a table contains torque and speed", "leave `torque` and `speed` out", "law"
            )
        return self

    def is_beyond(self, law: Law, regime: int, late: float) -> bool:
        """In a regime of one of its laws its point outruns its table; late: s since its begin."""
        if isinstance(self.law, str) or not isinstance(law, torque_laws.BySpeed):
            return False
        return 0.0 <= late < (self.off or math.inf) and regime in (0, len(law.parts.edges))

    @property
    def damps(self) -> bool:
        """Its torque changes with the speed."""
        return (
            self.law == "propeller"
            if isinstance(self.law, str)
            else len({torque for _, torque in self.law}) > 1
        )

    def acts_throughout(self, begin: float, duration: float) -> bool:
        """It acts over the whole motion."""
        return begin == 0.0 and (self.off is None or self.off >= duration)

    def laws(self, begin: float, at: Point) -> Iterator[Law]:
        window = torque_laws.Window(begin, math.inf if self.off is None else begin + self.off)
        torque, speed = self.torque or at.rated, self.speed or at.rated_speed or 1.0
        if self.law == "propeller":
            yield torque_laws.BySpeed(0, torque_laws.quadratic(-torque, speed), window)
            return
        rows = [(0.0, torque), (speed, torque)] if self.law == "constant" else self.law
        still = rows[0][1]
        if still:
            yield DryFriction((0,), (still,), rows[-1][0], (window,))
        if self.law != "constant":
            line = torque_laws.marked(
                [(turning, still - value) for turning, value in rows], SAME_SPEED
            )
            yield torque_laws.BySpeed(
                0, torque_laws.table(torque_laws.mirrored(line, sign=-1.0)), window
            )

    def lacks(self, at: Point) -> Lack:
        size = isinstance(self.law, str) and self.torque is None and not at.rated
        if not size and (self.law != "propeller" or self.speed or at.rated_speed):
            return None
        return (
            "the load has no size",
            "give `torque` and `speed` of the load, or `operation: {rated: {speed, power}}`",
        )


class SpeedProgram(Kind):
    """A speed that a fixed point is made to run at."""

    key, meaning = "speed", "{program: [[s, rpm], ...]}: the speed of a fixed point is prescribed"

    program: Program = required(
        "[[time, speed], ...] from the begin of the event, straight between; then the last"
    )

    def rates(self, begin: float) -> list[tuple[float, float, float]]:
        """Begin and end (s) and rate (rad/s2) of every line of it."""
        return [
            (begin + a[0], begin + b[0], (b[1] - a[1]) / (b[0] - a[0]))
            for a, b in pairwise(self.program)
        ]

    def lacks(self, at: Point) -> Lack:
        if math.isclose(self.program[0][1], at.speed, rel_tol=SAME_SPEED, abs_tol=SAME_SPEED):
            return None
        begins, runs = (f"{one * 30.0 / math.pi:.6g} rpm" for one in (self.program[0][1], at.speed))
        return (
            f"the program begins at {begins}, and '{at.name}' runs at {runs}",
            "begin with that, or give `initial`",
        )
