"""What a file may ask of the stability of a train with joints."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo

from torsion.fields import Declared, Quantity, given, required
from torsion.study import Range, SpeedRange

Method = Literal["hill", "monodromy"]
Over = Literal["angle", "damping", "torque"]


def _read_value(value: Any, info: ValidationInfo) -> float:
    """An angle below 90 degrees with its unit, or a factor; which, `over` says."""
    if info.data.get("over") == "angle":
        return Quantity("rad", at_least=0, below=np.pi / 2.0).read(value)
    return Quantity("1", at_least=0).read(value) if "over" in info.data else 0.0


Value = Annotated[float, BeforeValidator(_read_value, json_schema_input_type=float | str)]


class MapSettings(Range):
    """Settings of `map` in `stability`."""

    over: Over = required("angle (of all cross joints), damping or torque (factors on what the file says)")
    first: Value = required("lowest value: an angle with its unit, or a factor", alias="from")
    last: Value = required("highest value", alias="to")
    steps: Annotated[int, Field(ge=2, le=2000)] = given("number of values", 101)
    modes: Annotated[int, Field(ge=1, le=60)] | None = given("elastic modes kept (default: those that matter)")


class StabilitySettings(Declared):
    """Settings of `stability`."""

    speeds: SpeedRange | None = given("speeds (default: those of the operation)")
    method: Method = given("`monodromy` in steps of time, or `hill`: the eigenvalues of Hill's matrix", "monodromy")
    modes: Annotated[int, Field(ge=1, le=1000)] | None = given(
        "reduce to so many elastic modes (default: all of a train of at most 20 coordinates, else those that matter)"
    )
    map: MapSettings | None = given("growth over speed and one more quantity")
