"""Limits of a coupling's maker: vibratory torque and heat over frequency, and heat while a cylinder misfires."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator

from torsion import fields
from torsion.arrays import FloatArray
from torsion.fields import Declared, Quantity, given, refuse

TORQUE_ROW = (
    "rows are [frequency, torque], the frequencies rising: [[5 Hz, 15 kN*m], [20 Hz, 9 kN*m]]"
)
POWER_ROW = "rows are [frequency, power], the frequencies rising: [[5 Hz, 600 W], [20 Hz, 450 W]]"
MISFIRE = "permissible power loss while a cylinder does not fire, in place of `heat_limit`: a power, or {power, for: 30 min}"
OF_TORQUE, OF_POWER = 2, 1  # power of a limit whose inverse is linear between two rows


@dataclass(frozen=True)
class OverFrequency:
    """A limit over frequency: between two rows limit**-power is linear, which never lies above a straight line.

    With a torque's power 2 that is a constant heat between rows of a constant heat. Beyond the rows stands the least
    limit of all; above the last it falls with the root of the frequency too, where it is one of a torque.

    >>> law = OverFrequency(((10.0, 15e3),), OF_TORQUE)
    >>> law.at(np.array([5.0, 10.0, 40.0]))
    array([15000., 15000.,  7500.])
    >>> OverFrequency(((10.0, 600.0), (20.0, 300.0)), OF_POWER).at(np.array([5.0, 15.0, 40.0]))
    array([300., 400., 300.])
    """

    rows: tuple[tuple[float, float], ...]  # Hz, limit
    power: int

    def times(self, factor: float) -> "OverFrequency":
        """The same with the limit multiplied."""
        return replace(self, rows=tuple((at, factor * limit) for at, limit in self.rows))

    def at(self, frequency: FloatArray) -> FloatArray:
        """The limit at frequencies in Hz, of their shape."""
        given, limit = np.array(self.rows).T
        found = np.interp(frequency, given, limit**-self.power) ** (-1.0 / self.power)
        found = np.where((frequency < given[0]) | (frequency > given[-1]), limit.min(), found)
        falls = (
            np.sqrt(given[-1] / np.maximum(frequency, given[-1]))
            if self.power == OF_TORQUE
            else 1.0
        )
        return np.asarray(found * falls)


@dataclass(frozen=True)
class HeatInMisfire:
    """Permissible power loss while a cylinder does not fire."""

    power: float  # W
    time: float | None = None  # s, for how long; None: without an end

    def times(self, factor: float) -> "HeatInMisfire":
        """The same with the power multiplied."""
        return replace(self, power=factor * self.power)


def _rows(quantity: Quantity, hint: str) -> BeforeValidator:
    def read(value: Any) -> Any:
        if not isinstance(value, list | tuple) or not all(
            isinstance(row, list | tuple) and len(row) == 2 for row in value
        ):
            raise refuse("this is not a table over frequency", hint)
        rows = tuple(
            (Quantity("Hz", at_least=0).read(row[0]), quantity.read(row[1])) for row in value
        )
        if len(rows) < 2 or any(before[0] >= after[0] for before, after in pairwise(rows)):
            raise refuse("a table over frequency needs two rows or more, rising", hint)
        return rows

    return BeforeValidator(read, tuple[tuple[float | str, float | str], ...])


Rows = tuple[tuple[float, float], ...]


class VibratoryTorque(Declared):
    """Permissible vibratory torque."""

    torque: fields.Rating | None = given("amplitude (zero to peak); with `at` up to that frequency")
    at: fields.Frequency | None = given("frequency above which it falls")
    above: Literal["sqrt"] | None = given(
        "how it falls above `at`: sqrt, with the root of at/f, a constant heat"
    )
    table: Annotated[Rows, _rows(Quantity("N*m", above=0), TORQUE_ROW)] | None = given(
        "rows [frequency, torque] in place of `torque`; beyond the rows the minimum torque applies, above them it "
        "falls with the root of the frequency"
    )

    def refuse_clashes(self) -> None:
        beside = [key for key in ("torque", "at", "above") if getattr(self, key) is not None]
        if (self.table is None) == (self.torque is None):
            words = (
                "`torque` and `table` exclude each other"
                if self.table
                else "`torque` or `table` is missing"
            )
            raise refuse(
                words, "{torque: 15 kN*m, at: 10 Hz, above: sqrt}, or only a torque", *beside[:1]
            )
        if self.table is not None and beside:
            raise refuse(f"`table` and `{beside[0]}` exclude each other", TORQUE_ROW, beside[0])
        if (self.at is None) != (self.above is None):
            lacks = "above" if self.above is None else "at"
            raise refuse(f"`{lacks}` is missing", "{torque: 15 kN*m, at: 10 Hz, above: sqrt}")

    def lowered(self) -> tuple[float | None, OverFrequency | None]:
        """The torque, or what it is over frequency."""
        if self.table is not None:
            return None, OverFrequency(self.table, OF_TORQUE)
        return (
            (self.torque, None)
            if self.at is None
            else (None, OverFrequency(((self.at, self.torque or 0.0),), OF_TORQUE))
        )


class HeatLimit(Declared):
    """Permissible power loss."""

    power: fields.Power | None = given("at every frequency")
    table: Annotated[Rows, _rows(Quantity("W", above=0), POWER_ROW)] | None = given(
        "rows [frequency, power] in place of `power`; beyond the rows the minimum power applies"
    )

    def refuse_clashes(self) -> None:
        if (self.table is None) == (self.power is None):
            words = (
                "`power` and `table` exclude each other"
                if self.table
                else "`power` or `table` is missing"
            )
            raise refuse(words, POWER_ROW, *(["table"] if self.table else []))


class MisfireHeat(Declared):
    """Permissible power loss while a cylinder does not fire."""

    power: fields.Power = fields.required("of the maker")
    time: Annotated[float, Quantity("s", above=0)] | None = given(
        "for how long (default: without an end)", alias="for"
    )

    def lowered(self) -> HeatInMisfire:
        """As a record."""
        return HeatInMisfire(self.power, self.time)


def _plain(key: str, kind: type[Declared], *, by_table: bool = True) -> BeforeValidator:
    """A value alone, or of a list the table, in place of the mapping that has it."""

    def read(value: Any) -> Any:
        if isinstance(value, dict | kind):
            return value
        return {"table" if by_table and isinstance(value, list | tuple) else key: value}

    rows = tuple[tuple[float | str, float | str], ...]
    return BeforeValidator(read, float | str | rows | kind if by_table else float | str | kind)


VibratoryLimit = Annotated[VibratoryTorque, _plain("torque", VibratoryTorque)]
PowerLimit = Annotated[HeatLimit, _plain("power", HeatLimit)]
MisfireLimit = Annotated[MisfireHeat, _plain("power", MisfireHeat, by_table=False)]


def heat_ratings(limit: HeatLimit | None, misfire: MisfireHeat | None) -> dict[str, Any]:
    """The fields of `CouplingRatings` about heat; raises where a cylinder that misfires leaves less heat."""
    power, table = (None, None) if limit is None else (limit.power, limit.table)
    least = power if table is None else min(row[1] for row in table)
    if misfire is not None and least is not None and misfire.power < least:
        message = f"{misfire.power:g} W in misfire is below the {least:g} W of `heat_limit`"
        raise refuse(
            message, "a limit of continuous operation holds in misfire too", "heat_limit_misfire"
        )
    return {
        "heat_limit": power,
        "heat_over_frequency": None if table is None else OverFrequency(table, OF_POWER),
        "heat_in_misfire": None if misfire is None else misfire.lowered(),
    }
