"""Laws of load: the mean torque of what absorbs power, over its own speed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator

from torsion.arrays import FloatArray
from torsion.fields import Declared, Quantity, Rows, WrittenRows, given, refuse, required, shown
from torsion.model.harmonic_torques import read_table

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
    def has_slope(self) -> bool:
        """Its torque changes with the speed."""
        return len({torque for _, torque in self.table}) > 1 if self.table else self.exponent != 0

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
