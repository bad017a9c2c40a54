"""Harmonic torques that act at a component: a motor's ripple and the file's own excitations."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

from pydantic import field_validator

from torsion import fields
from torsion.errors import Path
from torsion.fields import Amount, Declared, Sized, given, refuse, required
from torsion.primitives import Torque

Table = tuple[tuple[float | str, float | str], ...]  # [[speed, torque], ...] as written in the file


class Harmonic(Declared):
    """A torque by order of the component's own speed, or at a fixed frequency."""

    order: fields.Exact | None = given("cycles per revolution of the component's own shaft")
    frequency: fields.Frequency | None = given("a fixed frequency, in place of `order`")
    phase: fields.Angle = given("phase at angle zero, or at time zero for a fixed frequency", 0.0)
    if TYPE_CHECKING:
        torque: Any

    def refuse_clashes(self) -> None:
        if self.order is not None and self.frequency is not None:
            raise refuse("`order` and `frequency` exclude each other", "keep one of them", "frequency")

    def primitive(self, name: str, station: int, path: Path, source: str | None) -> Torque:
        """The torque at a station; `path` is where the file states it, `source` where its figures come from."""
        amount = self.torque if isinstance(self.torque, Amount) else Amount()
        table = () if isinstance(self.torque, Amount) else self.torque
        size = amount.torque, amount.of_mean, table
        return Torque(name, station, self.order, self.frequency, *size, self.phase, path, source)


class Ripple(Harmonic):
    """One harmonic component of a motor's torque ripple."""

    torque: fields.TorqueAmount = required("amplitude (half range): N m, or % of the mean torque")

    def refuse_clashes(self) -> None:
        super().refuse_clashes()
        if self.order is None and self.frequency is None:
            raise refuse("a ripple needs `order` or `frequency`", "for example `order: 6`")


class Excitation(Harmonic, Sized):
    """A torque of the file's list `excitations`."""

    at: str = required("name of the component on which it acts")
    torque: fields.TorqueAmount | tuple[tuple[float, float], ...] = required(
        "amplitude (half range): N m, {of_mean: %}, or a table [[speed, torque], ...] over the speed of the "
        "component's own shaft, not that of the reference"
    )
    note: str | None = given("free text")
    source: str | None = given("where the figure comes from")

    @field_validator("torque", mode="plain", json_schema_input_type=fields.TorqueAmount | Table)
    @classmethod
    def _table(cls, value: object) -> object:
        return read_table(value) if isinstance(value, list | tuple) else fields.read_amount(value)


def read_table(rows: list[object] | tuple[object, ...]) -> tuple[tuple[float, float], ...]:
    """A table [[speed, torque], ...] in rad/s and N m, the speeds rising; raises the fault the user sees."""
    speed, torque = fields.Quantity("rad/s", at_least=0), fields.Quantity("N*m")
    table = []
    for row in rows:
        if not isinstance(row, list | tuple) or len(row) != 2:
            raise refuse("a row of a table over speed is [speed, torque]", "for example [1500 rpm, 120 N*m]")
        table.append((speed.read(row[0]), torque.read(row[1])))
    if len(table) < 2 or any(a[0] >= b[0] for a, b in pairwise(table)):
        raise refuse("a table over speed needs two rows or more with rising speeds")
    return tuple(table)
