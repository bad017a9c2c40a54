"""What machines do to a train in time: starts, loads and speeds that are prescribed, and short circuits."""

import cmath
import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.analyses.motion.events.event_kind import (
    Kind,
    Lack,
    Length,
    Pairs,
    Point,
    rows_over_time,
)
from torsion.arrays import FloatArray
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.fields import WrittenRows as SpeedTable
from torsion.kernels.motion.loaded_modes import Piece
from torsion.model.machine_torques import read_table
from torsion.sources import note

if TYPE_CHECKING:
    from torsion.kernels.motion.collocation import Law

WORST = "worst"
SAME_SPEED = 1e-9  # relative, or rad/s
PullOut = Annotated[float, Quantity("1", above=0, below=1)]


def _read_rows(value: Any) -> Any:
    if not isinstance(value, list | tuple):
        raise refuse("a table over speed is a list", "[[0 rpm, 900 N*m], [1500 rpm, 0 N*m]]")
    rows = read_table(value)
    if rows[0][0] != 0.0:
        message = "a table over speed for a transient response begins at 0 rpm"
        raise refuse(message, "add its row [0 rpm, ...]")
    return rows


def _read_law(value: Any) -> Any:
    if value in ("propeller", "constant"):
        return value
    if isinstance(value, str):
        hint = "propeller, constant, or a table [[speed, torque], ...]"
        raise refuse(f"unknown load law '{value}'", hint)
    rows = _read_rows(value)
    if any(torque < 0.0 for _, torque in rows):
        hint = "what drives is a `start`, or a `step`"
        raise refuse("a load brakes: its torques are 0 N*m or more", hint)
    return rows


def _read_phase(value: Any) -> Any:
    return value if value == WORST else Quantity("rad").read(value)


Program = Annotated[
    Pairs,
    rows_over_time(
        Quantity("rad/s", at_least=0), "a program of speed", "[[0 s, 0 rpm], [2 s, 1500 rpm]]"
    ),
]
Rows = Annotated[Pairs, BeforeValidator(_read_rows, json_schema_input_type=SpeedTable)]
LoadLaw = Literal["propeller", "constant"] | SpeedTable
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

    def refuse_clashes(self) -> None:
        if self.torque is None and None in (self.pull_out, self.slip, self.synchronous):
            hint = "`torque: [[speed, torque], ...]`, or `pull_out`, `slip` and `synchronous`"
            raise refuse("a start needs its torque over speed", hint)
        if self.torque is not None and (self.pull_out is not None or self.slip is not None):
            message = "`torque` and `pull_out` with `slip` exclude each other"
            raise refuse(message, "keep one of them", "torque")
        if self.slip_pulsation is not None and self.synchronous is None:
            message = "`slip_pulsation` needs `synchronous`, the synchronous speed"
            raise refuse(message, key="slip_pulsation")
        if self.slip_pulsation is None and "phase" in self.model_fields_set:
            hint = "`pulsation: {phase: ...}` has its own"
            raise refuse("`phase` is that of `slip_pulsation`", hint, "phase")

    @property
    def leaves_open(self) -> bool:
        return self.slip_pulsation is not None and self.phase == WORST

    def changes(self, point: Point) -> list[float]:
        return [0.0] if self.off is None else [0.0, self.off]

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        if self.pulsation is not None:
            rate = complex(-1.0 / self.pulsation.decay, 2.0 * math.pi * self.line)
            level = -1j * self.pulsation.torque * cmath.exp(1j * self.pulsation.phase)
            yield Piece(begin, begin + (self.off or math.inf), level, rate=rate)

    def laws(self, begin: float, point: Point) -> "Iterator[Law]":
        from torsion.kernels.motion import torque_laws

        window = torque_laws.Window(begin, begin + (self.off or math.inf))
        synchronous = self.synchronous or 1.0
        if self.torque is not None:
            yield torque_laws.BySpeed(0, torque_laws.table(self.torque), window)
        else:
            note("Kloss1916")
            pull_out, slip = self.pull_out or 0.0, self.slip or 1.0
            yield torque_laws.InductionMotor(0, pull_out, slip, synchronous, window)
        if self.slip_pulsation is not None:
            twice = 4.0 * math.pi * self.line
            size = torque_laws.table(self.slip_pulsation)
            phase = 0.0 if self.phase == WORST else self.phase
            order = -twice / synchronous
            yield torque_laws.Wave(0, size, order, phase, 1j * twice, window, from_begin=True)


class Load(Kind):
    """What brakes a point, in place of its mean torque, by the speed of its shaft; alike in both senses of rotation."""

    key, drives = "load", True
    meaning = "{law, torque, speed, off}: what brakes the point, by its speed; its slope is the damping there"

    law: Annotated[Any, BeforeValidator(_read_law, json_schema_input_type=LoadLaw)] = required(
        "propeller (T ~ n**2), constant (holds at rest), or [[speed, torque], ...] from 0 rpm on"
    )
    torque: fields.Torque | None = given("torque of the law at `speed` (default: the rated torque)")
    speed: fields.Speed | None = given(
        "speed of the point at that torque (default: its rated speed)"
    )
    off: Length | None = given("time after which it ends (default: never)")

    def refuse_clashes(self) -> None:
        if not isinstance(self.law, str) and (self.torque is not None or self.speed is not None):
            hint = "leave `torque` and `speed` out"
            raise refuse("a table contains torque and speed", hint, "law")

    @property
    def damps(self) -> bool:
        if isinstance(self.law, str):
            return self.law == "propeller"
        return len({torque for _, torque in self.law}) > 1

    def changes(self, point: Point) -> list[float]:
        return [0.0] if self.off is None else [0.0, self.off]

    def laws(self, begin: float, point: Point) -> "Iterator[Law]":
        from torsion.kernels.motion import torque_laws

        window = torque_laws.Window(begin, begin + (self.off or math.inf))
        torque, speed = self.torque or point.rated, self.speed or point.rated_speed or 1.0
        if self.law == "propeller":
            yield torque_laws.BySpeed(0, torque_laws.quadratic(-torque, speed), window)
            return
        rows = [(0.0, torque), (speed, torque)] if self.law == "constant" else self.law
        still = rows[0][1]
        if still:
            yield torque_laws.DryFriction(0, (still,), rows[-1][0], (window,))
        if self.law != "constant":
            moving = [(turning, still - value) for turning, value in rows]
            line = torque_laws.mirrored(torque_laws.marked(moving, SAME_SPEED), sign=-1.0)
            yield torque_laws.BySpeed(0, torque_laws.table(line), window)

    def lacks(self, point: Point) -> Lack:
        has_size = not isinstance(self.law, str) or self.torque is not None or point.rated
        if has_size and (self.law != "propeller" or self.speed or point.rated_speed):
            return None
        hint = "give `torque` and `speed` of the load, or `operation: {rated: {speed, power}}`"
        return "the load has no size", hint


class SpeedProgram(Kind):
    """A speed that a fixed point is made to run at."""

    key, meaning = "speed", "{program: [[s, rpm], ...]}: the speed of a fixed point is prescribed"

    program: Program = required(
        "[[time, speed], ...] from the begin of the event, straight between; then the last"
    )

    def changes(self, point: Point) -> list[float]:
        return [time for time, _ in self.program]

    def rates(self, begin: float) -> list[tuple[float, float, float]]:
        """Begin and end (s) and rate (rad/s2) of every line of it."""
        return [
            (begin + time, begin + end, (later - speed) / (end - time))
            for (time, speed), (end, later) in pairwise(self.program)
        ]

    def lacks(self, point: Point) -> Lack:
        first = self.program[0][1]
        if math.isclose(first, point.speed, rel_tol=SAME_SPEED, abs_tol=SAME_SPEED):
            return None
        begins, runs = (f"{speed * 30.0 / math.pi:.6g} rpm" for speed in (first, point.speed))
        message = f"the program begins at {begins}, and '{point.name}' runs at {runs}"
        return message, "begin with that, or give `initial`"


Coefficient = Annotated[float, Quantity("1", usual="coefficient of a short circuit")]
Sense = Literal["both", "brakes", "drives"]
PER_PERIOD = 10  # steps of a scanned time of reclosing, of the fastest mode that the fault excites
HIGHEST = 3.0  # of the line frequency: faster modes than that the fault hardly excites
FINER = 5  # parts of a step beside the worst times
ELECTRICAL = ("generator", "motor")  # kinds of components with an air gap


def _read_reclose(value: Any) -> Any:
    """(shortest, longest) s; a single time twice."""
    time = Quantity("s", above=0)
    if not isinstance(value, list | tuple):
        return (time.read(value),) * 2
    if len(value) != 2:
        raise refuse("a range of times is [shortest, longest]", "for example [0.2 s, 0.6 s]")
    shortest, longest = (time.read(end) for end in value)
    if shortest > longest:
        message = "a range of times runs from the shorter to the longer"
        raise refuse(message, f"[{longest:g} s, {shortest:g} s]")
    return shortest, longest


Written = float | str | tuple[float | str, float | str]
Reclose = Annotated[
    tuple[float, float], BeforeValidator(_read_reclose, json_schema_input_type=Written)
]


class Coefficients(Declared):
    """Amplitudes of the torque in the air gap, of the rated torque."""

    line: Coefficient = required("of the part at line frequency")
    double: Coefficient = given("of the part at twice the line frequency, subtracted", 0.0)
    mean: Coefficient = given("of the part that decays without oscillating", 0.0)


class ShortCircuit(Kind):
    """-T_r (line e^(-t/T_1) sin wt - double e^(-t/T_2) sin 2wt + mean e^(-t/T_2)), added to what acts otherwise."""

    key = "short-circuit"
    meaning = "{coefficients, decay, sense, load, phases, line, clear, reclose}: short circuit of an electrical machine"

    phases: Literal[2, 3] | None = given(
        "2 or 3: checks the coefficients, for 3 have no part at twice the frequency"
    )
    coefficients: Coefficients = required(
        "{line, double, mean}: amplitudes, of the rated torque; the maker's"
    )
    decay: Annotated[tuple[Length, Length], Field()] = required("[T_1, T_2]: times of decay")
    sense: Sense = given(
        "brakes: -T_r (line e^(-t/T_1) sin wt - double e^(-t/T_2) sin 2wt + mean e^(-t/T_2)) is added in the "
        "machine's sense of rotation, as for a real generator or motor. T_r is the rated torque of the machine. "
        "drives: the same with +. both: both are computed and the worse is judged, because the angle of the short "
        "circuit and the sign of the coefficients are rarely known",
        "both",
    )
    load: Literal["stays", "falls"] = given(
        "stays: the mean torque of the machine also acts during the short circuit; falls: it is zero during the "
        "short circuit",
        "stays",
    )
    line: fields.Frequency = given("line frequency", 50.0)
    clear: Length | None = given("time after which the short circuit is cleared (default: never)")
    reclose: Reclose | None = given(
        "time after which the short circuit begins again, for the same duration, before the end of the transient "
        "response. [shortest, longest]: the worst time of this range is judged. The steps are a tenth of the period "
        "of the highest natural frequency up to three times the line frequency, finer near the three worst times"
    )

    def refuse_clashes(self) -> None:
        if self.reclose is not None and (self.clear is None or self.reclose[0] <= self.clear):
            hint = "give `clear`, and a later `reclose`"
            raise refuse("`reclose` comes after `clear`", hint, "reclose")
        if self.phases is not None and (self.phases == 2) != (self.coefficients.double != 0.0):
            message = f"the coefficients do not belong to a short circuit of {self.phases} phases"
            hint = "`double` is only for a short circuit of 2 phases"
            raise refuse(message, hint, "coefficients")

    @property
    def leaves_open(self) -> bool:
        return True

    def changes(self, point: Point) -> list[float]:
        begins = [0.0] if self.reclose is None else [0.0, self.reclose[1]]
        lasts = [0.0] if self.clear is None else [0.0, self.clear]
        return [begin + late for begin in begins for late in lasts]

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        w, (first, second) = 2.0 * math.pi * self.line, self.decay
        rated = point.rated if self.sense == "drives" else -point.rated
        parts = (
            (-1j * self.coefficients.line, complex(-1.0 / first, w)),
            (1j * self.coefficients.double, complex(-1.0 / second, 2.0 * w)),
            (self.coefficients.mean, -1.0 / second),
        )
        for start in [begin] if self.reclose is None else [begin, begin + self.reclose[0]]:
            end = math.inf if self.clear is None else start + self.clear
            for coefficient, rate in parts:
                yield Piece(start, end, rated * coefficient, rate=rate)
            if self.load == "falls":
                yield Piece(start, end, -point.mean)

    def lacks(self, point: Point) -> Lack:
        if not point.rated:
            return "a short circuit needs the rated torque", "give `operation: rated` with a power"
        if self.load == "falls" and not point.mean:
            message = f"no mean torque acts at '{point.name}', that could fall"
            return message, "`load: stays`, or begin `steady`"
        return None

    def variants(self, frequency: FloatArray) -> "tuple[ShortCircuit, ...]":
        """Faults of one sense and one time of reclosing each; frequency: (modes,) Hz, natural ones of the train."""
        senses = ("brakes", "drives") if self.sense == "both" else (self.sense,)
        scanned = [] if self.reclose is None else self._times(frequency)[::FINER]
        times: list[tuple[float, float] | None] = [(time, time) for time in scanned]
        changes = [
            {"sense": sense, "reclose": time} for sense in senses for time in times or [None]
        ]
        return tuple(self.model_copy(update=change) for change in changes)

    def variants_beside(self, time: float, frequency: FloatArray) -> "tuple[ShortCircuit, ...]":
        """Faults that close again at the finer times between that before and that after a time (s) of `variants`."""
        times = self._times(frequency)
        number = times.index(time)
        finer = [*times[max(number - FINER + 1, 0) : number], *times[number + 1 : number + FINER]]
        return tuple(self.model_copy(update={"reclose": (time, time)}) for time in finer)

    def _times(self, frequency: FloatArray) -> list[float]:
        """Times of reclosing (s), FINER to a step of the scan, with both ends of the range."""
        assert self.reclose is not None
        shortest, longest = self.reclose
        excited = frequency[(frequency > self.line) & (frequency <= HIGHEST * self.line)]
        steps = math.ceil(PER_PERIOD * (longest - shortest) * float(excited.max(initial=self.line)))
        return list(np.linspace(shortest, longest, FINER * steps + 1).tolist())
