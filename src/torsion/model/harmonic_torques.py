"""Harmonic torques that act at a component: a motor's ripple and the file's own excitations."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import BeforeValidator, ConfigDict, Field, field_validator

from torsion import fields
from torsion.errors import Path
from torsion.fields import (
    Amount,
    Declared,
    Exclusive,
    Quantity,
    Rows,
    Sized,
    WrittenRows,
    exclusive,
    given,
    read_rows,
    refuse,
    required,
)
from torsion.primitives import Torque

SPEED, TORQUE = Quantity("rad/s", at_least=0), Quantity("N*m")
TABLE_ROW = "rows are [speed, torque], the speeds rising: [[1000 rpm, 120 N*m], [1500 rpm, 90 N*m]]"
AMOUNTS = ("torque", "transmission_error")  # of an excitation; one of them
ALONG = Quantity("m", above=0, usual="error of a gear")


def _read_error(value: Any) -> Any:
    """(unit, amplitude): a length, or text with a unit of angle as an angle."""
    if isinstance(value, tuple):
        return value
    angle = isinstance(value, str) and value.strip().endswith(("rad", "deg"))
    return ("rad", Quantity("rad", above=0).read(value)) if angle else ("m", ALONG.read(value))


TransmissionError = Annotated[Any, BeforeValidator(_read_error, json_schema_input_type=float | str)]


class Harmonic(Declared):
    """A torque by order of the component's own speed, or at a fixed frequency."""

    clashes: ClassVar[tuple[Exclusive, ...]] = (exclusive("order", "frequency"),)

    order: fields.Exact | None = given("cycles per revolution of the component's own shaft")
    frequency: fields.Frequency | None = given("a fixed frequency, in place of `order`")
    phase: fields.Angle = given("phase at angle zero, or at time zero for a fixed frequency", 0.0)
    if TYPE_CHECKING:
        torque: Any

    def primitive(self, name: str, station: int, path: Path, source: str | None) -> Torque:
        """The torque at a station; `path` is where the file states it, `source` where its figures come from."""
        amount = self.torque if isinstance(self.torque, Amount) else Amount()
        table = () if isinstance(self.torque, Amount) else self.torque
        size = amount.torque, amount.of_mean, table
        return Torque(name, station, self.order, self.frequency, *size, self.phase, path, source)


class Ripple(Harmonic):
    """One harmonic component of a motor's torque ripple."""

    torque: fields.TorqueAmount = required("amplitude (zero to peak): N m, or % of the mean torque")

    def refuse_clashes(self) -> None:
        if self.order is None and self.frequency is None:
            raise refuse("a ripple needs `order` or `frequency`", "for example `order: 6`")


class Excitation(Harmonic, Sized):
    """A torque of the file's list `excitations`, or what excites at the teeth of a gear."""

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": [key]} for key in AMOUNTS]})
    clashes = (*Harmonic.clashes, exclusive(*AMOUNTS))

    at: str = required(
        "name of the component on which it acts: a point, or a gear whose mesh excites"
    )
    torque: fields.TorqueAmount | Rows | None = given(
        "amplitude (zero to peak): N m, {of_mean: %}, or a table [[speed, torque], ...] over the speed of the "
        "component's own shaft (not of the reference). At a gear: torque k e of the blocked mesh, at the driving "
        "gear"
    )
    transmission_error: TransmissionError | None = given(
        "at a gear, in place of `torque`: amplitude e (zero to peak) along the line of action in the transverse "
        "plane, or as an angle of the driving gear. At a planetary stage: mesh of its sun (fixed sun: of its ring)"
    )
    base_radius: Annotated[float, Quantity("m", above=0, usual="size of a gear")] | None = given(
        "of the driving gear (of a planetary stage: of its sun or ring), for an error along the line of action "
        "(default: from `module` or `pitch_diameter` of the gear)"
    )
    harmonic: Annotated[int, Field(ge=1, le=100)] = given(
        "at a gear: multiple of its tooth meshings per revolution of the driving gear, where `order` is not given",
        1,
    )
    note: str | None = given("free text")
    source: str | None = given("where the figure comes from")

    @field_validator(
        "torque", mode="plain", json_schema_input_type=fields.TorqueAmount | WrittenRows
    )
    @classmethod
    def _table(cls, value: object) -> object:
        return read_table(value) if isinstance(value, list | tuple) else fields.read_amount(value)

    def refuse_clashes(self) -> None:
        if self.torque is None and self.transmission_error is None:
            raise refuse("`torque` is missing", "at a gear `torque` or `transmission_error`")
        if self.base_radius is not None and self.transmission_error is None:
            raise refuse(
                "`base_radius` belongs to a `transmission_error`", "leave it out", "base_radius"
            )


def read_table(rows: Any) -> Rows:
    """Read [[speed, torque], ...] in rad/s and N m, the speeds rising; raises the fault that the user sees."""
    return read_rows(rows, (SPEED, TORQUE), "speed", TABLE_ROW)
