"""The vibratory torque in one component over the speed."""

from dataclasses import dataclass
from fractions import Fraction
from pkgutil import resolve_name
from typing import Any

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.results import RPM, TO_DATAFRAME, one_line

OrderLike = int | float | str | Fraction


@dataclass(frozen=True, repr=False)
class SpanTorque:
    """Complex torque amplitudes in a component; NaN where the response has no reliable value."""

    name: str
    orders: tuple[
        Fraction | None, ...
    ]  # per revolution of the reference; None of a fixed frequency
    speed: FloatArray  # (speeds,) rad/s of the reference
    torque: ComplexArray  # (speeds, orders) N m

    @property
    def speed_rpm(self) -> FloatArray:
        """(speeds,) rpm of the reference."""
        return self.speed * RPM

    @property
    def complex_Nm(self) -> ComplexArray:  # noqa: N802
        """(speeds, orders) N m, complex amplitude."""
        return self.torque

    @property
    def abs_Nm(self) -> FloatArray:  # noqa: N802
        """(speeds,) N m: the largest amplitude of any one order. The total of all orders is `synthesis`."""
        return np.asarray(np.abs(self.torque).max(axis=1))

    def max(self) -> float:
        """Return the largest amplitude in N m; NaN if a speed has no reliable value."""
        return float(self.abs_Nm.max())

    @property
    def at_max_rpm(self) -> float:
        """Reference speed of the largest amplitude, or of the first one without a reliable value."""
        return float(self.speed_rpm[self.abs_Nm.argmax()])

    def to_dataframe(self) -> Any:
        """Return a pandas.DataFrame with one row for each speed and order; raises ImportError without pandas."""
        return resolve_name(TO_DATAFRAME)(self)

    def __repr__(self) -> str:
        orders = ", ".join(
            "fixed frequency" if order is None else str(order) for order in self.orders
        )
        peak = f"{self.max():.4g}" if np.isfinite(self.max()) else "no reliable value"
        return one_line(
            f"Torque of {self.name} [N m]: {peak} at {self.at_max_rpm:.5g} rpm; order {orders}"
        )


def spans_by_name(system: System) -> dict[str, list[int]]:
    """Return the spans of every component by its name, and every segment by its own."""
    spans: dict[str, list[int]] = {}
    for position, span in enumerate(system.spans):
        part = system.train.parts[span.part]
        for name in {part.whole, part.name, span.name}:
            spans.setdefault(name, []).append(position)
    return spans
