"""What manufacturers state of an elastic element: damping, tables over frequency or torque, warming, and limits."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, ValidationInfo, field_validator

from torsion import fields
from torsion.arrays import FloatArray
from torsion.fields import (
    Declared,
    LossFactor,
    Power,
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
    together,
)

if TYPE_CHECKING:
    from torsion.kernels.stiffness_laws import SpringLaw, StiffnessTable, Warming

HYSTERESES = ("loss_factor", "psi", "magnifier")
DAMPINGS = ("viscous", *HYSTERESES)
ETA = Quantity("1", at_least=0, usual="loss factor")
PSI_VALUE = Quantity("1", at_least=0, usual="psi")
MAGNIFIER_VALUE = Quantity("1", above=0, usual="magnifier")
Psi = Annotated[float, PSI_VALUE]
Magnifier = Annotated[float, MAGNIFIER_VALUE]
PSI = "relative damping: energy lost in a cycle / peak elastic energy; eta = psi/(2 pi)"
MAGNIFIER = "dynamic magnifier M; eta = 1/M"

OVER = {"frequency": Quantity("Hz", above=0)}
OVER |= dict.fromkeys(("mean torque", "vibratory torque"), Quantity("N*m", at_least=0))
POINTS = "at: [5 Hz, 10 Hz, 20 Hz], stiffness: [20e3, 24e3, 30e3], loss_factor: [0.12, 0.14, 0.16]"


def given_damping(component: Any, keys: tuple[str, ...] = DAMPINGS) -> tuple[str, Any] | None:
    """Key and value of the damping that a component gives; None without one. Raises where it gives several.

    Of a table the value is one at each of its points.
    """
    dampings = component.keys_given(*keys)
    if len(dampings) > 1:
        message = f"{' and '.join(dampings)} exclude each other"
        raise refuse(message, "give one kind of damping", dampings[1])
    return (dampings[0], getattr(component, dampings[0])) if dampings else None


def loss_factor(damping: tuple[str, float] | None) -> float:
    """The loss factor eta of a damping by its key and value; 0 where it is viscous or there is none."""
    key, value = damping or ("", 0.0)
    return {
        "loss_factor": value,
        "psi": value / (2.0 * math.pi),
        "magnifier": 1.0 / (value or 1.0),
    }.get(key, 0.0)


class CouplingTable(Declared):
    """Dynamic stiffness and damping by a table; stiffness and loss factor are linear between its points."""

    over: Literal["frequency", "mean torque", "vibratory torque"] = required(
        "what the table is over"
    )
    at: tuple[Any, ...] = required(
        "rising frequencies, or torques of the coupling: magnitude of the mean torque, "
        "or amplitude of the vibratory torque (zero to peak)"
    )
    stiffness: tuple[fields.Stiffness, ...] = required(
        "dynamic stiffness at each; over mean torque the tangent of the static curve"
    )
    loss_factor: tuple[LossFactor, ...] | None = given("loss factor eta at each")
    psi: tuple[Psi, ...] | None = given("relative damping at each; eta = psi/(2 pi)")
    magnifier: tuple[Magnifier, ...] | None = given("dynamic magnifier at each; eta = 1/M")
    viscous: tuple[fields.Damping, ...] | None = given("viscous damping at each")
    beyond: Literal["refuse", "hold"] = given(
        "what holds beyond the ends of the table: nothing is computed there, or their values hold",
        "refuse",
    )

    @field_validator("at", mode="plain", json_schema_input_type=tuple[float | str, ...])
    @classmethod
    def _points(cls, value: Any, info: ValidationInfo) -> tuple[float, ...]:
        """Hz or N m, by what the table is over."""
        quantity = OVER.get(info.data.get("over", ""), OVER["frequency"])
        if not isinstance(value, list | tuple):
            raise refuse("`at` is a list of the points of the table", POINTS)
        points = tuple(map(quantity.read, value))
        if len(points) < 2 or any(before >= after for before, after in pairwise(points)):
            raise refuse("`at` needs two points or more, rising", POINTS)
        return points

    def refuse_clashes(self) -> None:
        lost = given_damping(self)
        for key, values in (("stiffness", self.stiffness), lost or ("stiffness", self.stiffness)):
            if len(values) != len(self.at):
                message = f"`{key}` has {len(values)} values, `at` has {len(self.at)} points"
                raise refuse(message, "one value for each point", key)

    def lowered(self, scale: float) -> "StiffnessTable":
        """In SI at the coupling's own speed; scale: as of `Arrival`, by which stiffness and damping are divided."""
        from torsion.kernels.stiffness_laws import StiffnessTable

        key, values = given_damping(self) or ("", (0.0,) * len(self.at))
        eta = tuple(loss_factor((key, value)) for value in values)
        viscous = tuple(value / scale if key == "viscous" else 0.0 for value in values)
        to_own = 2.0 * math.pi if self.over == "frequency" else 1.0 / math.sqrt(scale)
        stiffness = tuple(value / scale for value in self.stiffness)
        points = tuple(point * to_own for point in self.at)
        return StiffnessTable(self.over, points, stiffness, eta, viscous, self.beyond == "hold")


Relaxation = Annotated[float, Quantity("s", above=0)]
TERM = "terms are [stiffness, relaxation time]: [[6 kN*m/rad, 0.05 s], [9 kN*m/rad, 5 ms]]"


def _pairs(value: Any) -> Any:
    is_list = isinstance(value, list | tuple) and value
    if not is_list or not all(isinstance(term, list | tuple) for term in value):
        raise refuse("this is not a list of Prony terms", TERM)
    if any(len(term) != 2 for term in value):
        raise refuse("a term has a stiffness and a relaxation time", TERM)
    return tuple(map(tuple, value))


class PronySpring(Declared):
    """A static spring and springs beside it that relax: k + sum k_i s tau_i/(1 + s tau_i)."""

    stiffness: fields.Stiffness = required("static stiffness: that at no frequency")
    terms: Annotated[tuple[tuple[fields.Stiffness, Relaxation], ...], BeforeValidator(_pairs)] = (
        required("list of [stiffness, relaxation time] of what stiffens it at higher frequencies")
    )

    def lowered(self, scale: float) -> "SpringLaw":
        """In SI at the coupling's own speed; scale: as of `CouplingTable.lowered`."""
        from torsion.kernels.stiffness_laws import prony

        return prony(self.stiffness / scale, tuple((k / scale, tau) for k, tau in self.terms))


class FractionalSpring(Declared):
    """A static spring and one beside it that follows a power of the frequency: k + k1 (s tau)^exponent."""

    stiffness: fields.Stiffness = required("static stiffness: that at no frequency")
    k1: fields.Stiffness = required("size of what is added, at the circular frequency 1/tau")
    tau: Relaxation = required("time at whose reciprocal that size holds")
    exponent: Annotated[float, Quantity("1", above=0, below=1)] = required(
        "order of the derivative, between 0 and 1"
    )

    def lowered(self, scale: float) -> "SpringLaw":
        """In SI at the coupling's own speed; scale: as of `CouplingTable.lowered`."""
        from torsion.kernels.stiffness_laws import fractional

        return fractional(self.stiffness / scale, self.k1 / scale, self.tau, self.exponent)


TEMPERATURE = Quantity("degC")
Temperature = Annotated[float, TEMPERATURE]
Rise = Annotated[float, Quantity("K", above=0, usual="rise of temperature")]
ROW = "rows are [temperature, value], the temperatures rising: [[30 degC, 1], [100 degC, 0.6]]"
FACTOR = Quantity("1", above=0, usual="factor of a stiffness")
Factors = Annotated[Rows, table_over("temperature", TEMPERATURE, FACTOR, ROW)]
LossFactors = Annotated[Rows, table_over("temperature", TEMPERATURE, ETA, ROW)]
Psis = Annotated[Rows, table_over("temperature", TEMPERATURE, PSI_VALUE, ROW)]
Magnifiers = Annotated[Rows, table_over("temperature", TEMPERATURE, MAGNIFIER_VALUE, ROW)]


class CouplingWarming(Declared):
    """Stiffness and damping over temperature, and the rise of temperature by the heat of the vibration."""

    now: Temperature = required(
        "temperature of the surroundings; all other results are of a coupling as cold as that"
    )
    stiffness: Factors = required("rows [temperature, factor on the stiffness]")
    loss_factor: LossFactors | None = given(
        "rows [temperature, loss factor], in place of the coupling's own"
    )
    psi: Psis | None = given("rows [temperature, relative damping], in place of the coupling's own")
    magnifier: Magnifiers | None = given(
        "rows [temperature, dynamic magnifier], in place of the coupling's own"
    )
    rise: Rise = required("rise of temperature by the heat `at`, in proportion")
    at: Power = required("heat that warms it by `rise`")
    to: Temperature = required("highest permissible temperature")

    def refuse_clashes(self) -> None:
        if self.to <= self.now:
            raise refuse(
                f"{self.to:g} degC is not above the {self.now:g} degC of `now`", "it warms", "to"
            )
        lost = given_damping(self, HYSTERESES)
        for key, rows in (("stiffness", self.stiffness), lost or ("stiffness", self.stiffness)):
            if rows[0][0] > self.now or rows[-1][0] < self.to:
                message = f"the rows run from {rows[0][0]:g} to {rows[-1][0]:g} degC"
                raise refuse(
                    message, f"they must cover {self.now:g} to {self.to:g} degC, `now` to `to`", key
                )

    def lowered(self) -> "tuple[Warming, float, float | None]":
        """The record, the factor on the stiffness now, and the loss factor now (None: the coupling's own)."""
        from torsion.kernels.stiffness_laws import Warming

        key, values = given_damping(self, HYSTERESES) or ("", ())
        of_psi = 2.0 * math.pi if key == "psi" else 1.0
        rows = tuple((t, value / of_psi) for t, value in values)
        temperature = np.array(self.now)
        points, factors = np.array(self.stiffness).T
        first = float(np.interp(temperature, points, factors))
        factor = tuple((t, value / first) for t, value in self.stiffness)
        warming = Warming(self.now, self.to, self.rise / self.at, factor, rows, key == "magnifier")
        return warming, first, float(warming.loss_factor(temperature)) if rows else None


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


class VibratoryTorque(Declared):
    """Permissible vibratory torque."""

    clashes = (
        exclusive("torque", "table", hint=EXAMPLE + ", or only a torque", needed=True),
        excludes("table", "at", "above", hint=TORQUE_ROW),
        *together("at", "above", hint=EXAMPLE),
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

    def times(self, factor: float) -> Self:
        """The same limit with the power multiplied."""
        return self.model_copy(update={"power": factor * self.power})


def _table_or(key: str, kind: type[Declared]) -> BeforeValidator:
    """Take a list for the mapping that has it as its table, and a value for the one that has it under `key`."""

    return BeforeValidator(
        lambda value: (
            value
            if isinstance(value, dict | Declared)
            else {"table" if isinstance(value, list | tuple) else key: value}
        ),
        float | str | WrittenRows | kind,
    )


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
        "heat_in_misfire": misfire,
    }
