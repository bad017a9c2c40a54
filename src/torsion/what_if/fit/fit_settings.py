"""What the file says of a fit: which figures may move, how far, and what was measured."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.errors import Path, Refusal
from torsion.fields import Declared, excludes, exclusive, given, needs, refuse, required
from torsion.what_if.variants.laws import Choice, Law, Width

FIT: Path = ("analyses", "fit")
UNITS = {"angle": "rad", "speed": "rad/s", "torque": "N*m"}  # of an amplitude, by what was measured
Within = Annotated[
    float, fields.Quantity("1", above=0, below=1, usual="deviation of a measurement")
]
Phase = Annotated[float, fields.Quantity("rad")]


class Reading(Declared):
    """One speed of a torsiogram with its amplitude and phase."""

    speed: fields.Speed = required("of the component `at` of `operation`")
    amplitude: Any = required(
        "amplitude (zero to peak) of one order: deg or rad, rpm or rad/s, N*m"
    )
    phase: Phase | None = given("of a cosine over the angle of the component `at` of `operation`")


def _rows(value: Any) -> Any:
    if isinstance(value, str):
        raise refuse(f"the torsiogram {fields.shown(value)} was not read", "the name of a CSV file")
    return value


Rows = Annotated[
    tuple[Reading, ...],
    BeforeValidator(_rows, str | tuple[Reading, ...]),
    Field(min_length=1),
]
OF_SIGNAL = "orders", "pulses", "revolutions"  # keys that no other measurement has


class Measured(Declared):
    """A measured frequency, torsiogram or signal with its standard deviation."""

    clashes = (
        exclusive("frequency", "torsiogram", "signal", hint="one measurement", needed=True),
        excludes("frequency", "at", "order", "quantity", *OF_SIGNAL),
        excludes("torsiogram", "mode", *OF_SIGNAL),
        excludes("signal", "mode", "order", "quantity"),
        needs("torsiogram", "at", "order", "quantity", hint="where and what was measured"),
        needs("signal", "at", "orders", hint="where it was measured, and the orders to fit"),
    )

    frequency: fields.Frequency | None = given("a measured natural frequency")
    mode: Annotated[int, Field(ge=1)] | None = given(
        "its number, from 1 (default: modes rise with the frequencies, each in its band if possible)"
    )
    torsiogram: Rows | None = given(
        "CSV file of one order over speed: columns `speed`, `amplitude`, `phase`"
    )
    signal: str | None = given(
        "file of a signal over time: two columns, time and speed; or one, the times of pulses, with `pulses`"
    )
    at: str | None = given("place of the measurement: a point, or for a torque a coupling or shaft")
    order: fields.Exact | None = given("per revolution of the component `at` of `operation`")
    orders: Annotated[tuple[fields.Exact, ...], fields.OneOrMany] = given(
        "orders of a signal that are fitted", ()
    )
    quantity: Literal["angle", "speed", "torque"] | None = given("what a torsiogram is of")
    pulses: Annotated[int, Field(ge=2)] | None = given(
        "per revolution of the shaft at which they were taken"
    )
    revolutions: Annotated[int, Field(ge=2, le=10_000)] = given(
        "of that shaft in a window of a signal", 16
    )
    within: Within = required("standard deviation of the measurement: 0.5 %")

    def refuse_clashes(self) -> None:
        """Orders each once, and rows that are those of one torsiogram."""
        if len(set(self.orders)) < len(self.orders):
            raise refuse("an order is named twice", "each order once", "orders")
        rows = self.torsiogram or ()
        for row_number, row in enumerate(rows):
            try:
                self.amplitude(row)
            except Refusal as fault:
                key = ("torsiogram", row_number, "amplitude")
                raise refuse(f"{self.quantity}: {fault.message}", fault.hint, key) from None
            if (row.phase is None) != (rows[0].phase is None):
                message = "some rows have a phase and some have none"
                raise refuse(message, "all of them, or none", ("torsiogram", row_number))
        for row_number, (before, row) in enumerate(pairwise(rows), start=1):
            if row.speed <= before.speed:
                hint = "a row for each speed, the lowest first"
                raise refuse("the speed does not rise", hint, ("torsiogram", row_number, "speed"))

    def amplitude(self, row: Reading) -> float:
        """In SI of its quantity; raises what `refuse` makes where it is none."""
        return fields.Quantity(UNITS[self.quantity or "angle"], above=0).read(row.amplitude)


class FitSettings(Declared):
    """What the file states of `fit`: parameters that vary, and measurements."""

    vary: Annotated[dict[str, Width], Field(min_length=1)] = required(
        "figures by `component.key`, each with its standard deviation (of the logarithm) as known beforehand: 20 %"
    )
    measured: Annotated[tuple[Measured, ...], Field(min_length=1)] = required(
        "what was measured, each a mapping"
    )

    def refuse_clashes(self) -> None:
        """A mode is measured once, and modes rise."""
        measured: dict[int, tuple[int, float]] = {}  # position and frequency by the mode
        for position, measurement in enumerate(self.measured):
            if (mode := measurement.mode) in measured:
                key = ("measured", position, "mode")
                raise refuse(f"mode {mode} is measured twice", "one frequency a mode", key)
            if mode is not None:
                measured[mode] = position, measurement.frequency or 0.0
        for (lower, (_, low)), (mode, (position, high)) in pairwise(sorted(measured.items())):
            if high < low:
                message = f"mode {mode} is measured at {high:.6g} Hz, below mode {lower}"
                hint = "modes are numbered as their frequencies rise: exchange the numbers"
                key = ("measured", position, "mode")
                raise refuse(f"{message} at {low:.6g} Hz", hint, key)

    @property
    def varied(self) -> tuple[str, Mapping[str, Choice]]:
        """The key that names the figures, and what is known of each beforehand."""
        return "vary", {name: Law(lognormal=deviation) for name, deviation in self.vary.items()}
