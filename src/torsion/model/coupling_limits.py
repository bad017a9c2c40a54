"""Limits of a coupling's maker: vibratory torque and heat over frequency, and heat while a cylinder misfires."""

from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator

from torsion import fields
from torsion.arrays import FloatArray
from torsion.fields import (
    Declared,
    Quantity,
    Rows,
    WrittenRows,
    excludes,
    exclusive,
    given,
    or_value,
    refuse,
    required,
    table_over,
)

TORQUE_ROW = (
    "rows are [frequency, torque], the frequencies rising: [[5 Hz, 15 kN*m], [20 Hz, 9 kN*m]]"
)
POWER_ROW = "rows are [frequency, power], the frequencies rising: [[5 Hz, 600 W], [20 Hz, 450 W]]"
EXAMPLE = "{torque: 15 kN*m, at: 10 Hz, above: sqrt}"
MISFIRE = "permissible power loss while a cylinder does not fire, in place of `heat_limit`: a power, or {power, for: 30 min}"
OF_TORQUE, OF_POWER = 2, 1  # power of a limit whose inverse is linear between two rows
FREQUENCY = Quantity("Hz", at_least=0)


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

    rows: Rows  # Hz, limit
    power: int

    def times(self, factor: float) -> "OverFrequency":
        """The same law with the limit multiplied."""
        return replace(self, rows=tuple((row, factor * limit) for row, limit in self.rows))

    def at(self, frequency: FloatArray) -> FloatArray:
        """Return the limit at frequencies in Hz, an array of their shape."""
        rows, limits = np.array(self.rows).T
        limit = np.interp(frequency, rows, limits**-self.power) ** (-1.0 / self.power)
        limit = np.where((frequency < rows[0]) | (frequency > rows[-1]), limits.min(), limit)
        if self.power == OF_TORQUE:
            limit = limit * np.sqrt(rows[-1] / np.maximum(frequency, rows[-1]))
        return np.asarray(limit)


@dataclass(frozen=True)
class HeatInMisfire:
    """Permissible power loss while a cylinder does not fire."""

    power: float  # W
    time: float | None = None  # s, for how long; None: without an end

    def times(self, factor: float) -> "HeatInMisfire":
        """The same limit with the power multiplied."""
        return replace(self, power=factor * self.power)


class VibratoryTorque(Declared):
    """Permissible vibratory torque."""

    clashes = (
        exclusive("torque", "table", hint=EXAMPLE + ", or only a torque", needed=True),
        excludes("table", "at", "above", hint=TORQUE_ROW),
    )

    torque: fields.Rating | None = given("amplitude (zero to peak); with `at` up to that frequency")
    at: fields.Frequency | None = given("frequency above which it falls")
    above: Literal["sqrt"] | None = given(
        "how it falls above `at`: sqrt, with the root of at/f, a constant heat"
    )
    table: (
        Annotated[Rows, table_over("frequency", FREQUENCY, Quantity("N*m", above=0), TORQUE_ROW)]
        | None
    ) = given(
        "rows [frequency, torque] in place of `torque`; beyond the rows the minimum torque applies, above them it "
        "falls with the root of the frequency"
    )

    def refuse_clashes(self) -> None:
        if (self.at is None) != (self.above is None):
            lacks = "above" if self.above is None else "at"
            raise refuse(f"`{lacks}` is missing", EXAMPLE)

    def lowered(self) -> tuple[float | None, OverFrequency | None]:
        """Return the torque (N m) that holds at every frequency, or the law over frequency."""
        rows = self.table
        if rows is None and self.at is not None:
            rows = ((self.at, self.torque or 0.0),)
        return (self.torque, None) if rows is None else (None, OverFrequency(rows, OF_TORQUE))


class HeatLimit(Declared):
    """Permissible power loss."""

    clashes = (exclusive("power", "table", hint=POWER_ROW, needed=True),)

    power: fields.Power | None = given("at every frequency")
    table: (
        Annotated[Rows, table_over("frequency", FREQUENCY, Quantity("W", above=0), POWER_ROW)]
        | None
    ) = given(
        "rows [frequency, power] in place of `power`; beyond the rows the minimum power applies"
    )


class MisfireHeat(Declared):
    """Permissible power loss while a cylinder does not fire."""

    power: fields.Power = required("of the maker")
    time: Annotated[float, Quantity("s", above=0)] | None = given(
        "for how long (default: without an end)", alias="for"
    )


def _table_or(key: str, kind: type[Declared]) -> BeforeValidator:
    """Take a list for the mapping that has it as its table, and a value for the one that has it under `key`."""

    def read(value: Any) -> Any:
        if isinstance(value, dict | Declared):
            return value
        return {"table" if isinstance(value, list | tuple) else key: value}

    return BeforeValidator(read, float | str | WrittenRows | kind)


VibratoryLimit = Annotated[VibratoryTorque, _table_or("torque", VibratoryTorque)]
PowerLimit = Annotated[HeatLimit, _table_or("power", HeatLimit)]
MisfireLimit = Annotated[MisfireHeat, or_value(MisfireHeat, "power")]


def heat_ratings(limit: HeatLimit | None, misfire: MisfireHeat | None) -> dict[str, Any]:
    """The fields of `CouplingRatings` about heat; raises where a cylinder that misfires leaves less heat."""
    power, table = (None, None) if limit is None else (limit.power, limit.table)
    lowest = power if table is None else min(row[1] for row in table)
    if misfire is not None and lowest is not None and misfire.power < lowest:
        message = f"{misfire.power:g} W in misfire is below the {lowest:g} W of `heat_limit`"
        raise refuse(
            message, "a limit of continuous operation holds in misfire too", "heat_limit_misfire"
        )
    return {
        "heat_limit": power,
        "heat_over_frequency": None if table is None else OverFrequency(table, OF_POWER),
        "heat_in_misfire": None if misfire is None else HeatInMisfire(misfire.power, misfire.time),
    }
