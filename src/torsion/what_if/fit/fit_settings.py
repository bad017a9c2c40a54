"""What the file says of a fit: which figures may move, how far, and what was measured."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.errors import Path
from torsion.fields import Declared, given, refuse, required
from torsion.what_if.variants.laws import Choice, Law, Width

FIT: Path = ("analyses", "fit")
UNITS = {"angle": "rad", "speed": "rad/s", "torque": "N*m"}  # of an amplitude, by what was measured
SORTS = {  # of a measurement, by the key that only it has: its other keys, and those that it needs
    "frequency": (("mode",), ()),
    "torsiogram": (("at", "order", "quantity"), ("at", "order", "quantity")),
    "signal": (("at", "orders", "pulses", "revolutions"), ("at", "orders")),
}
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


Rows = Annotated[tuple[Reading, ...], BeforeValidator(_rows, str | tuple[Reading, ...])]


class Measured(Declared):
    """A measured frequency, torsiogram or signal with its standard deviation."""

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
        """One sort, with its own keys."""
        declared = type(self).model_fields
        given_keys = [key for key in declared if key in self.model_fields_set - {"within"}]
        sorts = [key for key in SORTS if key in given_keys]
        if len(sorts) != 1:
            message = f"{' and '.join(sorts)} are two measurements"
            message = message if sorts else "nothing is measured"
            raise refuse(message, f"one of {', '.join(SORTS)}", "".join(sorts[1:2]))
        permitted, needed = SORTS[sorts[0]]
        for key in given_keys:
            if key not in (*permitted, sorts[0]):
                hint = f"with it go {', '.join(permitted)}, within"
                raise refuse(f"`{key}` does not go with `{sorts[0]}`", hint, key)
        for key in needed:
            if key not in given_keys:
                raise refuse(f"`{key}` is missing", declared[key].description or "")
        if self.signal is not None and not self.orders:
            hint = "the orders that are fitted, such as [1, 2]"
            raise refuse("`orders` is an empty list", hint, "orders")
        if len(set(self.orders)) < len(self.orders):
            raise refuse("an order is named twice", "each order once", "orders")
        self._refuse_rows()

    def _refuse_rows(self) -> None:
        """Amplitudes of another quantity, speeds that do not rise, and phases of some rows alone."""
        rows = self.torsiogram or ()
        if self.torsiogram == ():
            hint = "speed and amplitude of at least one speed"
            raise refuse("the torsiogram has no rows", hint, "torsiogram")
        for row_number, row in enumerate(rows):
            try:
                self.amplitude(row)
            except ValueError as error:
                context = getattr(error, "context", None) or {}
                key = ("torsiogram", row_number, "amplitude")
                message = f"{self.quantity}: {context['message']}"
                raise refuse(message, context["hint"], key) from None
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

    vary: dict[str, Width] = required(
        "figures by `component.key`, each with its standard deviation (of the logarithm) as known beforehand: 20 %"
    )
    measured: tuple[Measured, ...] = required("what was measured, each a mapping")

    def refuse_clashes(self) -> None:
        """Something varies and something is measured, a mode once."""
        if not self.vary:
            raise refuse("`vary` is empty", "for example {coupling-1.stiffness: 20 %}", "vary")
        if not self.measured:
            hint = "for example {frequency: 20 Hz, within: 1 %}"
            raise refuse("`measured` is empty", hint, "measured")
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
