"""Speeds of continuous use: the whole speed range unless the settings of a rule narrow it."""

from typing import Self

import numpy as np
from pydantic import model_validator

from torsion import fields
from torsion.analyses.steady import SAME_SPEED
from torsion.arrays import BoolArray, FloatArray
from torsion.errors import Fault
from torsion.fields import Declared, refuse, required
from torsion.rules.evidence import in_rpm, rule_path
from torsion.study import Study


class Continuous(Declared):
    """Speeds of the component `operation.at` at which the train is run for long."""

    first: fields.Speed = required("lowest speed", alias="from")
    last: fields.Speed = required("highest speed", alias="to")

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if self.first >= self.last:
            raise refuse("`from` is not below `to`", "a range runs from the lower to the higher value", "to")
        return self


def within(use: Continuous | None, speed: FloatArray) -> BoolArray:
    """(speeds,) which speeds are of continuous use."""
    if use is None:
        return np.ones(len(speed), dtype=bool)
    return (speed >= use.first * (1 - SAME_SPEED)) & (speed <= use.last * (1 + SAME_SPEED))


def ends(use: Continuous | None) -> tuple[float, ...]:
    """rad/s: both ends of continuous use; none where it is the whole range."""
    return () if use is None else (use.first, use.last)


def continuous_words(use: Continuous | None) -> str:
    """Which speeds were judged; empty for the whole range."""
    return "" if use is None else f"in continuous use, {in_rpm(use.first)} to {in_rpm(use.last)}"


def continuous_faults(study: Study, asked: Declared, rule: str, use: Continuous | None) -> list[Fault]:
    """A range of continuous use that was not wholly computed cannot be judged."""
    speeds = study.operation.speeds
    if use is None or speeds is None:
        return []
    if speeds.first * (1 - SAME_SPEED) <= use.first and use.last <= speeds.last * (1 + SAME_SPEED):
        return []
    path = (*rule_path(study, asked), rule, "continuous")
    computed = f"{in_rpm(speeds.first)} to {in_rpm(speeds.last)}"
    return [Fault(path, "the speeds of continuous use leave operation.speeds", f"computed: {computed}")]
