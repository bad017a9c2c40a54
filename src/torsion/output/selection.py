"""What every output shows of a train: elastic elements, stations, spans, and values over them reduced to that."""

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.elements import Element, by_part, damps, elements, pieces
from torsion.assembly.system import System
from torsion.output.numbers import Scale, scale
from torsion.results import Quantity

__all__ = [
    "Element",
    "by_part",
    "damps",
    "elements",
]  # names of the floor below that outputs read here
NO_VALUE = "no reliable value"  # of the largest amplitude of a range where one is not known: it may be the largest
WITHIN = {"station": ("station", "named station"), "span": ("span", "end span", "element")}


class Selection:
    """Reduces the axes of declared arrays to what is reported.

    A `station` or `span` axis keeps every station or span. A `named station` is one that the train names, an `end span`
    the first or last of an element, where its end torques stand, and of an `element` the span with the largest value is
    reported.
    """

    def __init__(self, system: System) -> None:
        self.system = system

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """The elastic elements as people name them."""
        return elements(self.system)

    @cached_property
    def named_stations(self) -> list[int]:
        """Positions of the stations that the train names."""
        return list(range(len(self.system.train.stations)))

    @cached_property
    def end_spans(self) -> list[int]:
        """Positions of the first and the last span of every element, of a shaft of sections of each."""
        return sorted(
            {span for piece in pieces(self.system) for span in (piece.spans[0], piece.spans[-1])}
        )

    def positions(self, axis: str) -> list[Any]:
        """Return what a reduced axis runs over: positions among the stations or spans reported, or names of elements."""
        if axis == "element":
            return [element.name for element in self.elements]
        return self.named_stations if axis == "named station" else self.end_spans

    def reduced(self, values: Any, quantity: Quantity, axes: tuple[str, ...]) -> Any:
        """Return the values with the axes that are printed, in their order; `axes` are those of the values."""
        array = np.asarray(values)
        kept = [
            next(
                shown_axis
                for shown_axis in quantity.printed
                if shown_axis in WITHIN.get(axis, (axis,))
            )
            for axis in axes
        ]
        for position, axis in enumerate(axes):
            if axis in WITHIN:
                array = self._along(array, position, axis, kept[position])
        return array.transpose([kept.index(shown) for shown in quantity.printed if shown in kept])

    def _along(self, array: Any, position: int, axis: str, shown: str) -> Any:
        """Return the values with one axis, of stations or spans, reduced to what is shown of it."""
        if shown == "element":
            largest = [
                array.take(list(element.spans), axis=position).max(axis=position)
                for element in self.elements
            ]
            return np.stack(largest, axis=position) if largest else array.take([], axis=position)
        if shown in ("named station", "end span"):
            return array.take(
                self.named_stations if axis == "station" else self.end_spans, axis=position
            )
        return array


def highest(values: FloatArray) -> float:
    """Return the largest of the values that are known; 0 where there is none."""
    return float(np.nanmax(np.append(values, 0.0)))


def torques(curves: Iterable[FloatArray]) -> Scale:
    """Return the unit that suits the largest torque of some curves."""
    return scale("N m", [highest(values) for values in curves])


def strongest(values: FloatArray, count: int) -> list[int]:
    """Return the columns of (places, curves) with the largest values, in their order; those of nothing are left out."""
    size = np.nanmax(np.where(np.isfinite(values), values, 0.0), axis=0, initial=0.0)
    return sorted(k for k in np.argsort(-size, kind="stable")[:count].tolist() if size[k] > 0)
