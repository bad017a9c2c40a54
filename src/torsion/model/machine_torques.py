"""Torques of machines: harmonic ones, and laws of the mean torque of loads and drives over their own speed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, ConfigDict, Field, field_validator

from torsion import fields
from torsion.arrays import FloatArray
from torsion.errors import Path
from torsion.fields import (
    Amount,
    Clash,
    Declared,
    Quantity,
    Rows,
    Sized,
    WrittenRows,
    exclusive,
    given,
    needs,
    read_rows,
    refuse,
    required,
    shown,
)
from torsion.primitives import Torque
from torsion.sources import source

SPEED, TORQUE = Quantity("rad/s", at_least=0), Quantity("N*m")
TABLE_ROW = "rows are [speed, torque], the speeds rising: [[1000 rpm, 120 N*m], [1500 rpm, 90 N*m]]"


def read_table(rows: Any) -> Rows:
    """Read [[speed, torque], ...] in rad/s and N m, the speeds rising; raises the fault that the user sees."""
    return read_rows(rows, (SPEED, TORQUE), "speed", TABLE_ROW)


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

    clashes: ClassVar[tuple[Clash, ...]] = (exclusive("order", "frequency"),)

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

    clashes = (
        exclusive(
            "order", "frequency", hint="a ripple has one, for example `order: 6`", needed=True
        ),
    )

    torque: fields.TorqueAmount = required("amplitude (zero to peak): N m, or % of the mean torque")


class Excitation(Harmonic, Sized):
    """A torque of the file's list `excitations`, or what excites at the teeth of a gear."""

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": [key]} for key in AMOUNTS]})
    clashes = (
        *Harmonic.clashes,
        exclusive(*AMOUNTS, hint="keep one of them; only a gear has an error", needed=True),
        needs("base_radius", "transmission_error", hint="leave it out"),
    )

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


LawWord = Literal["quadratic", "propeller", "linear", "constant", "constant-power"]
EXPONENTS: dict[str, float] = {
    "quadratic": 2.0,
    "propeller": 2.0,
    "linear": 1.0,
    "constant": 0.0,
    "constant-power": -1.0,
}
POSSIBLE = "propeller or quadratic, linear, constant, constant-power, {exponent: 1.8}, a table [[speed, torque], ...]"
SAME_SPEED = 1e-9  # relative: a speed that is a knot of a table but for the rounding of its unit
Exponent = Annotated[float, Quantity("1", usual="exponent of a load")]
AtRest = Annotated[float, Quantity("1", at_least=0, at_most=1, usual="tolerance")]


class PowerLaw(Declared):
    """T = T_r (a + (1 - a) (n/n_r)^e)."""

    exponent: Exponent = required(
        "e of T ~ n**e: 2 quadratic, 1 linear, 0 constant, -1 constant power"
    )
    at_rest: AtRest = given(
        "a, torque at rest / torque at the rated speed: static head, friction", 0.0
    )

    def refuse_clashes(self) -> None:
        if self.at_rest and self.exponent <= 0:
            raise refuse(
                "a torque at rest needs a torque that rises with speed", "exponent: 2", "at_rest"
            )


@dataclass(frozen=True)
class LoadLaw:
    """The mean torque of a load over speed: a power of the speed, or a table of the torque itself.

    >>> LoadLaw(2.0).torque(np.array([50.0]), 100.0, 400.0).tolist()
    [100.0]
    """

    exponent: float = 2.0
    at_rest: float = 0.0  # torque at rest / rated torque
    table: Rows = ()  # rad/s, N m, in place of both

    def torque(self, speed: FloatArray, rated_speed: float, rated_torque: float) -> FloatArray:
        """Return the torque (speeds,) N m of a law without a table that is `rated_torque` at `rated_speed`."""
        share = self.at_rest + (1.0 - self.at_rest) * (speed / rated_speed) ** self.exponent
        return np.asarray(rated_torque * share)

    def slope(self, speed: FloatArray, rated_speed: float, rated_torque: float) -> FloatArray:
        """Return dT/dω (speeds,) N m s/rad; of a table that of the segment, at its knots the smaller one.

        >>> LoadLaw(2.0).slope(np.array([50.0]), 100.0, 400.0).tolist()
        [4.0]
        """
        if self.table:
            return segment_slopes(self.table, speed)
        rise = self.exponent * (1.0 - self.at_rest) * (speed / rated_speed) ** (self.exponent - 1.0)
        return np.asarray(rated_torque / rated_speed * rise)

    @property
    def words(self) -> str:
        """The law in words, for tables."""
        if self.table:
            return "table over speed"
        names = {exponent: word for word, exponent in EXPONENTS.items() if word != "propeller"}
        word = names.get(self.exponent, f"T ~ n^{self.exponent:g}").replace("-", " ")
        return f"{word}, {100 * self.at_rest:g} % at rest" if self.at_rest else word


def segment_slopes(table: Rows, speed: FloatArray) -> FloatArray:
    """Return dT/dω (speeds,) N m s/rad of a table [[rad/s, N m], ...]; the smaller one at a knot, the last beyond."""
    rows = np.array(table)
    slopes = np.diff(rows[:, 1]) / np.diff(rows[:, 0])
    below, above = (
        np.searchsorted(rows[1:-1, 0], speed * (1.0 + step)) for step in (-SAME_SPEED, SAME_SPEED)
    )
    return np.asarray(np.minimum(slopes[below], slopes[above]))


def read_load(value: Any) -> LoadLaw:
    """Read a word, {exponent, at_rest} or a table into a law; raises the located fault that the user sees."""
    if isinstance(value, LoadLaw):
        return value
    if isinstance(value, str):
        if value not in EXPONENTS:
            raise refuse(f"unknown load law {shown(value)}", POSSIBLE)
        return LoadLaw(EXPONENTS[value])
    if isinstance(value, Mapping | PowerLaw):
        law = value if isinstance(value, PowerLaw) else PowerLaw.model_validate(value)
        return LoadLaw(law.exponent, law.at_rest)
    return LoadLaw(table=read_table(value if isinstance(value, list | tuple) else [value]))


Load = Annotated[Any, BeforeValidator(read_load, LawWord | PowerLaw | WrittenRows)]


KLOSS = "`{slip: 1 %, pull_out: 3200 N*m, at_slip: 8 %}`"
LAWS = ("slip", "droop", "law", "torque")
EXAMPLES = "for example `drive: {slip: 1 %}`, `{droop: 4 %}`, `{law: speed}` or `{torque: [[0, 0], [1500 rpm, 1200]]}`"
Time = Annotated[float, Quantity("s", above=0)]
Share = Annotated[float, Quantity("1", above=0, below=1)]


class DriveLaw(Declared):
    """The mean torque of a machine that drives over its own speed, by one of four laws.

    With a pull-out torque T_k at the slip s_k that of a slip s is Kloss's, 2 T_k/(s/s_k + s_k/s).

    >>> round(DriveLaw(slip="1 %").slope_at_rated(1273.2395447351628, 157.07963267948966), 9)
    802.463774447
    """

    slip: Share | None = given("rated slip of an asynchronous machine, of its synchronous speed")
    pull_out: fields.PositiveTorque | None = given(
        "pull-out torque, with which the slope at `slip` is that of Kloss in place of a straight line"
    )
    at_slip: Share | None = given("slip at the pull-out torque")
    droop: Share | None = given(
        "fall of the speed from no load to the rated torque, of the rated speed"
    )
    law: Literal["speed", "torque"] | None = given(
        "speed: a controller holds the mean speed; torque: it is constant"
    )
    torque: Annotated[Rows, BeforeValidator(read_table, WrittenRows)] | None = given(
        "the torque itself over own speed, [[speed, torque], ...]"
    )
    lag: Time | None = given(
        "time constant with which the slope acts in vibration too (default: it does not)"
    )

    clashes = (
        exclusive(*LAWS, hint=EXAMPLES, needed=True),
        needs("pull_out", "at_slip", "slip", hint=KLOSS),
        needs("at_slip", "pull_out", hint=KLOSS),
    )

    def refuse_clashes(self) -> None:
        if self.lag is None:
            return
        if self.slip is None and self.droop is None:
            message = "`lag` without a slope that is constant"
            raise refuse(message, "give `slip` or `droop`", "lag")
        if self.at_slip is not None and (self.slip or 0.0) >= self.at_slip:
            message = "`lag` beyond the pull-out torque, where the slope damps no more"
            raise refuse(message, "leave `lag` out", "lag")

    @source("Kloss1916")
    def rated_torque(self) -> float | None:
        """Return the torque (N m) that Kloss's law has at the rated slip; None of any other law."""
        if self.slip is None or self.pull_out is None or self.at_slip is None:
            return None
        return 2.0 * self.pull_out / (self.slip / self.at_slip + self.at_slip / self.slip)

    def slope_at_rated(self, torque: float, speed: float) -> float:
        """Return -dT/dω (N m s/rad) of `slip` or `droop`, from rated torque (N m) and speed (rad/s); else 0."""
        if self.slip is not None and self.pull_out is not None and self.at_slip is not None:
            slip, at_slip = self.slip, self.at_slip
            over_slip = (
                2.0 * self.pull_out * at_slip * (at_slip**2 - slip**2) / (at_slip**2 + slip**2) ** 2
            )
            return over_slip * (1.0 - slip) / speed
        if self.slip is not None:
            return torque * (1.0 - self.slip) / (self.slip * speed)
        return 0.0 if self.droop is None else torque / (self.droop * speed)

    def slopes(self, speed: FloatArray, rated_torque: float, rated_speed: float) -> FloatArray:
        """Return -dT/dω (speeds,) N m s/rad at own speeds (rad/s); of a table the smaller one at its knots."""
        if self.torque is not None:
            # The smaller slope at a knot is that of the negative torque.
            return segment_slopes(tuple((row, -torque) for row, torque in self.torque), speed)
        return 0.0 * speed + self.slope_at_rated(rated_torque, rated_speed)

    @property
    def words(self) -> str:
        """The law in words, for tables."""
        if self.slip is not None or self.droop is not None:
            name, share = ("slip", self.slip) if self.slip is not None else ("droop", self.droop)
            lag = "" if self.lag is None else f", lag {self.lag:g} s"
            pull_out = "" if self.pull_out is None else f", pull-out torque {self.pull_out:g} N m"
            return f"{name} {100.0 * (share or 0.0):g} %{pull_out}{lag}"
        if self.torque is not None:
            return "torque by a table over speed"
        return "speed kept by a controller" if self.law == "speed" else "constant torque"
