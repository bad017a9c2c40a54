"""The torque in the air gap of an electrical machine under a fault, that is cleared and may close again."""

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.analyses.motion.events.event_kind import Kind, Lack, Length, Point
from torsion.arrays import FloatArray
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.kernels.motion.torque_history import Piece

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
