"""The stiffness and the damping of a coupling as a maker's table gives them: over frequency, or over mean torque."""

import math
from itertools import pairwise
from typing import Any, Literal

from pydantic import ValidationInfo, field_validator

from torsion import fields
from torsion.components.losses import Magnifier, Psi, given_damping, loss_factor
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.kernels.stiffness_table import StiffnessTable

OVER = {"frequency": Quantity("Hz", above=0), "mean torque": Quantity("N*m", at_least=0)}
EXAMPLE = "at: [5 Hz, 10 Hz, 20 Hz], stiffness: [20e3, 24e3, 30e3], loss_factor: [0.12, 0.14, 0.16]"


class CouplingTable(Declared):
    """Dynamic stiffness and damping by a table; stiffness and loss factor are linear between its points."""

    over: Literal["frequency", "mean torque"] = required("what the table is over")
    at: tuple[Any, ...] = required("rising frequencies, or mean torques of the coupling (their size)")
    stiffness: tuple[fields.Stiffness, ...] = required(
        "dynamic stiffness at each; over mean torque the tangent of the static curve"
    )
    loss_factor: tuple[fields.LossFactor, ...] | None = given("loss factor eta at each")
    psi: tuple[Psi, ...] | None = given("relative damping at each; eta = psi/(2 pi)")
    magnifier: tuple[Magnifier, ...] | None = given("dynamic magnifier at each; eta = 1/M")
    viscous: tuple[fields.Damping, ...] | None = given("viscous damping at each")
    beyond: Literal["refuse", "hold"] = given(
        "what holds beyond the ends of the table: nothing is computed there, or their values hold", "refuse"
    )

    @field_validator("at", mode="plain", json_schema_input_type=tuple[float | str, ...])
    @classmethod
    def _points(cls, value: Any, info: ValidationInfo) -> tuple[float, ...]:
        """Hz or N m, by what the table is over."""
        quantity = OVER.get(info.data.get("over", ""), OVER["frequency"])
        if not isinstance(value, list | tuple):
            raise refuse("`at` is a list of the points of the table", EXAMPLE)
        points = tuple(quantity.read(one) for one in value)
        if len(points) < 2 or any(before >= after for before, after in pairwise(points)):
            raise refuse("`at` needs two points or more, rising", EXAMPLE)
        return points

    def refuse_clashes(self) -> None:
        lost = given_damping(self)
        for key, values in (("stiffness", self.stiffness), lost or ("stiffness", self.stiffness)):
            if len(values) != len(self.at):
                message = f"`{key}` has {len(values)} values, `at` has {len(self.at)} points"
                raise refuse(message, "one value for each point", key)

    def lowered(self, scale: float) -> StiffnessTable:
        """In SI at the coupling's own speed; scale: as of `Arrival`, by which stiffness and damping are divided."""
        key, values = given_damping(self) or ("", (0.0,) * len(self.at))
        eta = tuple(loss_factor((key, value)) for value in values)
        viscous = tuple(value / scale if key == "viscous" else 0.0 for value in values)
        own = 2.0 * math.pi if self.over == "frequency" else 1.0 / math.sqrt(scale)
        stiffness = tuple(value / scale for value in self.stiffness)
        points = tuple(point * own for point in self.at)
        return StiffnessTable(self.over, points, stiffness, eta, viscous, self.beyond == "hold")
