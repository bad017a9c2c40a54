"""What a file may ask of the stability of a train with joints."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from torsion.fields import Declared, given, refuse, required
from torsion.kernels.tree import FloatArray
from torsion.study import SpeedRange

Method = Literal["hill", "monodromy"]
Over = Literal["angle", "damping", "torque"]


class MapAsked(Declared):
    """Settings of `map` in `stability`."""

    over: Over = required("angle (of all cross joints), damping or torque (factors on what the file says)")
    first: float = required("lowest value: an angle in degrees, or a factor", alias="from")
    last: float = required("highest value", alias="to")
    steps: Annotated[int, Field(ge=2, le=2000)] = given("number of values", 101)
    modes: Annotated[int, Field(ge=1, le=60)] | None = given("elastic modes kept (default: those that matter)")

    @model_validator(mode="after")
    def _rises(self) -> "MapAsked":
        if self.first >= self.last or self.first < 0:
            raise refuse("`from` is not between 0 and `to`", "a range runs from the lower to the higher value", "from")
        if self.over == "angle" and self.last >= 90:
            raise refuse("a joint angle is below 90 degrees", "for example `to: 30`", "to")
        return self

    def values(self) -> FloatArray:
        """(steps,) rad, or factors."""
        values = np.linspace(self.first, self.last, self.steps)
        return np.radians(values) if self.over == "angle" else values


class Asked(Declared):
    """Settings of `stability`."""

    speeds: SpeedRange | None = given("speeds (default: those of the operation)")
    method: Method = given("`monodromy` in steps of time, or `hill`: the eigenvalues of Hill's matrix", "monodromy")
    modes: Annotated[int, Field(ge=1, le=1000)] | None = given(
        "reduce to so many elastic modes (default: none left out)"
    )
    map: MapAsked | None = given("growth over speed and one more quantity")
