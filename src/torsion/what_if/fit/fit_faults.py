"""Measurements of a fit that the train, its excitation or its speeds do not have, and files that cannot be read."""

from fractions import Fraction

from torsion.analyses.response.harmonic_components import excited_orders
from torsion.errors import Fault, Path
from torsion.results import RPM, listed
from torsion.study import Study
from torsion.train import name_fault
from torsion.what_if.fit.fit_settings import FIT, FitSettings, Measured
from torsion.what_if.fit.measurements import signal_faults

ROUNDING = 1e-9  # relative, of a speed in two units


def fit_faults(study: Study) -> list[Fault]:
    """Measurements that the train, its excitation or its speeds do not have."""
    settings = study.analyses["fit"]
    if not isinstance(settings, FitSettings):
        return []
    faults: list[Fault] = []
    for position, measurement in enumerate(settings.measured):
        faults += _measurement_faults(study, measurement, (*FIT, "measured", position))
    frequencies = [
        measurement for measurement in settings.measured if measurement.frequency is not None
    ]
    points = sum(
        len(measurement.torsiogram or ())
        * (2 if measurement.torsiogram and measurement.torsiogram[0].phase is not None else 1)
        for measurement in settings.measured
    )
    count = len(frequencies) + points
    if len(settings.vary) > count and not any(
        measurement.signal for measurement in settings.measured
    ):
        message = f"{len(settings.vary)} parameters vary, and {count} value{'s were' if count != 1 else ' was'} measured"
        faults.append(
            Fault((*FIT, "vary"), message, "vary fewer, or give more measurements", at_key=True)
        )
    return faults


def _measurement_faults(study: Study, measurement: Measured, path: Path) -> list[Fault]:
    if measurement.frequency is not None:
        return []
    speeds, faults = study.operation.speeds, list[Fault]()
    if speeds is None:
        hint = "`operation: {speeds: {from: 300 rpm, to: 1800 rpm}}`"
        return [
            Fault(path, "a measurement over speed needs the speeds at which the train runs", hint)
        ]
    excited = excited_orders(study.train)
    steps: list[tuple[Fraction, Path]] = [
        (order, ("orders", k)) for k, order in enumerate(measurement.orders)
    ]
    steps += [(measurement.order, ("order",))] if measurement.order is not None else []
    hint = f"there are {', '.join(map(str, excited))}, per revolution of the reference"
    for order, step in steps:
        if order not in excited:
            faults.append(
                Fault(
                    (*path, *step),
                    f"no excitation has order {order}",
                    hint if excited else "nothing excites by order",
                )
            )
    for row_number, row in enumerate(measurement.torsiogram or ()):
        if not speeds.first * (1 - ROUNDING) <= row.speed <= speeds.last * (1 + ROUNDING):
            ends = " to ".join(f"{end * RPM:.6g}" for end in (speeds.first, speeds.last))
            words = f"{row.speed * RPM:.6g} rpm lies outside the speeds {ends} rpm"
            faults.append(
                Fault((*path, "torsiogram", row_number, "speed"), words, "widen `operation.speeds`")
            )
            break
    faults += _place_faults(study, measurement, (*path, "at"))
    if measurement.signal is not None and not faults:
        faults += signal_faults(study, measurement, path)
    return faults


def _place_faults(study: Study, measurement: Measured, path: Path) -> list[Fault]:
    """A torque is that of an elastic component, all else that of a point."""
    components = {part.name: (part.kind, part.is_point) for part in study.train.parts}
    name = measurement.at or ""
    if measurement.quantity == "torque":
        if (fault := name_fault(name, path, components, point=False)) is not None:
            return [fault]
        if not torque_spans(study, name):
            elastic = [part.name for part in study.train.parts if torque_spans(study, part.name)]
            hint = f"one of {', '.join(elastic)}" if elastic else "the train has none"
            return [
                Fault(
                    path, f"'{name}' is neither a coupling nor a shaft, and carries no torque", hint
                )
            ]
        return []
    names = [
        station.name
        for station in study.train.stations
        if not station.is_ground and station.ratio > 0
    ]
    if name in names:
        return []
    hint = f"one of the points {listed(names)}"
    return [
        name_fault(name, path, components)
        or Fault(path, f"'{name}' is not one point that turns", hint)
    ]


def torque_spans(study: Study, name: str) -> bool:
    """Whether a component is elastic, so that a torque can be measured of it."""
    return not study.train.part(name).is_point and study.train.part(name).kind in (
        "coupling",
        "shaft",
    )
