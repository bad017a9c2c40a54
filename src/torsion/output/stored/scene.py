"""What stands at the head of the results: the scene, and the stations and spans that arrays run over."""

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.elements import Element, by_part, damps, elements, pieces
from torsion.assembly.system import System
from torsion.results import Quantity, derived, reported, result
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.output.numbers import Scale


@reported
class Scene:
    """What was read, and how the train is run."""

    name: str = result("name of the scene")
    case: str | None = result("which case of the file it is, or null")
    description: str = result("its description")
    file: str = result("the file it was read from")
    sha256: str | None = result(
        "SHA-256 of the file's text and those of its tables behind it, or null"
    )
    tables: tuple[str, ...] = result("CSV files that the file names, in that order")
    model: str = result("lumped, fem or exact")
    reference: str = result(
        "component whose speed is the speed axis, per whose revolution orders count"
    )
    speed_range: tuple[float, float] | None = result("rad/s", "[from, to], or null")
    rated_speed: float | None = result("rad/s", "rated speed, or null")
    rated_power: float | None = result("W", "rated power, or null")
    rules: tuple[str, ...] = result("rules that the file names")
    document: dict[str, str] = result("texts of its front matter, by the keys of the file")


@reported
class StationRow:
    """A point of the train."""

    name: str = result("name of a point of the train")
    component: str = result("component that made it")
    kind: str = result("kind of that component")
    speed_ratio: Fraction = result("its speed / reference speed, exact")
    sense: int = result("1 turns as the reference does, -1 the other way")
    is_ground: bool = result("the fixed end of a spring to ground")
    is_held: bool = result("turns at exactly its mean speed")
    inertia: float = result(
        "kg*m**2", "with the share of its shafts; null where fixed", key="inertia_kg_m2"
    )


@reported
class Harmonic:
    """One harmonic component of an imposed angle."""

    order: int = result("per revolution of the driving station")
    amplitude: complex = result("rad", "complex amplitude of that order")


@reported
class SpanRow:
    """An elastic or rigid piece between two stations."""

    name: str = result("name of an elastic or rigid piece")
    component: str = result("component that made it")
    kind: str = result("kind of that component")
    driving_station: int = result("position in `stations`")
    driven_station: int = result("position in `stations`")
    ratio: Fraction = result("speed of the driven / speed of the driving station, exact")
    flexibility: float = result(
        "rad/(N*m)",
        "0 is rigid, null is damping without stiffness; of a table over frequency at its first point",
    )
    loss_factor: float = result("1", "eta of k (1 + i eta)")
    viscous: float = result("N*m*s/rad", "viscous damping")
    error: tuple[Harmonic, ...] = result(
        "imposed on the driven angle, over the driving station's angle"
    )

    @derived("N*m/rad", "1/flexibility; null where the piece is rigid")
    def stiffness(self) -> float:
        """Of the whole piece."""
        return 1.0 / self.flexibility if self.flexibility else float("inf")


def scene(study: Study) -> Scene:
    """Return the head of the results of a study."""
    speeds, rated = study.operation.speeds, study.operation.rated
    return Scene(
        name=study.name,
        case=None if study.case is None else study.case.name,
        description=study.description,
        file=study.shown_file,
        sha256=checksum(study),
        tables=tuple(name for name, _ in study.tables),
        model=study.model,
        reference=study.reference,
        speed_range=None if speeds is None else (speeds.first, speeds.last),
        rated_speed=None if rated is None else rated.speed,
        rated_power=None if rated is None else rated.power,
        rules=tuple(name for name, _ in study.rules),
        document={} if study.document is None else study.document.model_dump(exclude_none=True),
    )


def curve_files(study: Study) -> list[str]:
    """Return the files of pressures and of measured signals, as the scene names them."""
    records = (
        record
        for part in study.train.parts
        for record in (part.engine, part.compressor)
        if record is not None
    )
    pressures = [name for record in records for name in record.files]
    measured = getattr(study.analyses.get("fit"), "measured", ())
    signals = [signal.signal for signal in measured if signal.signal]
    return list(dict.fromkeys(pressures + signals))


def checksum(study: Study) -> str | None:
    """Return the SHA-256 of the input as read, in UTF-8: the scene, then its tables; None without a text.

    `cat scene.yaml line.csv | sha256sum` gives it.
    """
    texts = (study.text, *(text for _, text in study.tables))
    return hashlib.sha256("".join(texts).encode("utf-8")).hexdigest() if study.text else None


def station_rows(system: System) -> tuple[StationRow, ...]:
    """Return every station."""
    parts = system.train.parts
    return tuple(
        StationRow(
            name=station.name,
            component=parts[station.part].name,
            kind=parts[station.part].kind,
            speed_ratio=station.ratio,
            sense=station.sense,
            is_ground=station.is_ground,
            is_held=bool(system.held[index]),
            inertia=float(system.inertia[index]),
        )
        for index, station in enumerate(system.stations)
    )


def span_rows(system: System) -> tuple[SpanRow, ...]:
    """Return every span."""
    parts = system.train.parts
    return tuple(
        SpanRow(
            name=span.name,
            component=parts[span.part].name,
            kind=parts[span.part].kind,
            driving_station=span.driving,
            driven_station=span.driven,
            ratio=span.ratio,
            flexibility=float(system.flexibility[index]),
            loss_factor=float(system.loss_factor[index]),
            viscous=float(system.viscous[index]),
            error=tuple(Harmonic(order, value) for order, value in span.error),
        )
        for index, span in enumerate(system.spans)
    )


__all__ = [
    "Element",
    "by_part",
    "damps",
    "elements",
]  # names of the floor below that outputs read here
NO_VALUE = "no reliable value"  # of the largest amplitude of a range where one is not known: it may be the largest
WITHIN = {"station": ("station", "named station"), "span": ("span", "end span", "element")}


@dataclass(frozen=True, eq=False)
class Selection:
    """Reduces the axes of declared arrays to what is reported.

    A `station` or `span` axis keeps every station or span. A `named station` is one that the train names, an `end span`
    the first or last of an element, where its end torques stand, and of an `element` the span with the largest value is
    reported.
    """

    system: System

    @cached_property
    def elements(self) -> tuple[Element, ...]:
        """The elastic elements as people name them."""
        return elements(self.system)

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
        is_station = axis == "named station"
        return [*range(len(self.system.train.stations))] if is_station else self.end_spans

    def reduced(self, values: Any, quantity: Quantity, axes: tuple[str, ...]) -> Any:
        """Return the values with the axes that are printed, in their order; `axes` are those of the values.

        What is no array with axes stays as it is.
        """
        if not isinstance(values, np.ndarray) or not values.ndim:
            return values
        array, kept = values, list[str]()
        for position, axis in enumerate(axes):
            shown = next(name for name in quantity.printed if name in WITHIN.get(axis, (axis,)))
            kept.append(shown)
            if shown == "element":
                largest = [
                    array.take(list(element.spans), axis=position).max(axis=position)
                    for element in self.elements
                ]
                array = np.stack(largest, position) if largest else array.take([], axis=position)
            elif shown in ("named station", "end span"):
                array = array.take(self.positions(shown), axis=position)
        return array.transpose([kept.index(shown) for shown in quantity.printed if shown in kept])


def highest(values: FloatArray) -> float:
    """Return the largest of the values that are known; 0 where there is none."""
    return float(np.nanmax(np.append(values, 0.0)))


def torques(curves: Iterable[FloatArray]) -> "Scale":
    """Return the unit that suits the largest torque of some curves."""
    from torsion.output.numbers import scale

    return scale("N m", [highest(values) for values in curves])


def strongest(values: FloatArray, count: int) -> list[int]:
    """Return the columns of (places, curves) with the largest values, in their order; those of nothing are left out."""
    size = np.nanmax(np.where(np.isfinite(values), values, 0.0), axis=0, initial=0.0)
    return sorted(k for k in np.argsort(-size, kind="stable")[:count].tolist() if size[k] > 0)
