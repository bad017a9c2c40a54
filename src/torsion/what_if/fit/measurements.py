"""What was measured, as curves of amplitudes: torsiograms as they are, signals over time by their orders."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.response.harmonic_components import excited_orders
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path
from torsion.results import RPM, listed
from torsion.study import Study
from torsion.tables import Columns, pairs
from torsion.train import name_fault
from torsion.what_if.fit.fit_settings import FIT, FitSettings, Measured

if TYPE_CHECKING:
    from torsion.kernels.order_tracking import Tracked

MOST_ROWS = 2_000_000  # of a signal
GAP = 4.0  # times the usual distance of samples, from which some are missing
SEEN = 10.0  # deviations of what was tracked that an amplitude stands out by: of weaker ones its logarithm is biased
LEAST_CYCLES = 3.0  # of an order in a window; of fewer the mean rotation takes a part
APART = 1.0  # cycles by which two orders differ over a window; nearer ones cannot be kept apart
TIME_AND_SPEED = Columns(
    ("time", "speed"),
    ("s", "rad/s"),
    "time [s], speed [rpm]",
    "0.5, 1200",
    "a finite speed at a finite time",
    most=MOST_ROWS,
)
PULSES = Columns(("time",), ("s",), "time [s]", "0.00213", "a finite time", most=MOST_ROWS)


@dataclass(frozen=True)
class Curve:
    """Amplitudes of one order over speed, as they were measured."""

    at: str
    order: Fraction  # per revolution of the reference
    quantity: str  # angle, speed or torque
    within: float
    speed: FloatArray  # (points,) rad/s of the reference
    amplitude: ComplexArray  # (points,) in SI
    has_phase: bool
    origin: str  # what of the file it is
    error: FloatArray  # (points,) over the amplitude: standard deviation of what was tracked; 0 of a torsiogram
    # Windows of a signal outside the speeds, or in which the order does not stand out.
    unused: int = 0

    def of_response(
        self, system: System, speed: FloatArray, angle: ComplexArray, torque: ComplexArray
    ) -> ComplexArray:
        """Return the amplitudes (speeds,) in SI, from the angles (speeds, stations) and torques (speeds, spans)."""
        if self.quantity == "torque":
            parts = (system.train.parts[span.part].name for span in system.spans)
            return torque[:, list(parts).index(self.at)]
        stations = [station.name for station in system.stations]
        own_angle = angle[:, stations.index(self.at)]
        is_speed = self.quantity == "speed"
        return np.asarray(1j * float(self.order) * speed * own_angle) if is_speed else own_angle

    @property
    def deviation(self) -> FloatArray:
        """(points,) of the logarithm of an amplitude, and of a phase in rad."""
        return np.hypot(self.within, self.error)


def curves(study: Study, measured: tuple[Measured, ...]) -> tuple[Curve, ...]:
    """Return all amplitudes over speed, of torsiograms and of signals."""
    curves_found = list[Curve]()
    for position, measurement in enumerate(measured):
        if measurement.signal is not None:
            curves_found += _of_signal(study, measurement, (*FIT, "measured", position))
        elif rows := measurement.torsiogram:
            amplitude = np.array([measurement.amplitude(row) for row in rows])
            curve = Curve(
                measurement.at or "",
                measurement.order or Fraction(1),
                measurement.quantity or "",
                measurement.within,
                np.array([row.speed for row in rows]),
                amplitude * np.exp(1j * np.array([row.phase or 0.0 for row in rows])),
                rows[0].phase is not None,
                f"torsiogram {position + 1} of `measured`",
                np.zeros(len(rows)),
            )
            curves_found.append(curve)
    return tuple(curves_found)


def _of_signal(study: Study, measurement: Measured, path: Path) -> Iterator[Curve]:
    """A curve for each order, of the windows within the speed range in which it stands out."""
    ratio = next(
        float(station.ratio) for station in study.train.stations if station.name == measurement.at
    )
    tracked = _tracked(study, measurement, path, ratio)
    speeds, reference = study.operation.speeds, tracked.speed / ratio
    inside = np.ones(len(reference), dtype=bool)
    if speeds is not None:
        inside = (reference >= speeds.first) & (reference <= speeds.last)
    if not inside.any():
        slowest, fastest = (end * 30.0 / np.pi for end in (reference.min(), reference.max()))
        message = f"the signal runs from {slowest:.6g} to {fastest:.6g} rpm, outside the speeds of `operation`"
        raise InputError([Fault((*path, "signal"), message, "widen `operation.speeds`")])
    for k, order in enumerate(measurement.orders):
        angle, error = tracked.angle[:, k], tracked.error[:, k]
        used = np.flatnonzero(inside & (np.abs(angle) >= SEEN * error))
        if not used.size:
            message = f"order {order} does not exceed the noise in any of {np.count_nonzero(inside)} windows"
            hint = "longer windows (`revolutions`), or leave it out; are `pulses` right?"
            raise InputError([Fault((*path, "orders"), message, hint)])
        used = used[np.argsort(reference[used], kind="stable")]
        yield Curve(
            measurement.at or "",
            order,
            "angle",
            measurement.within,
            reference[used],
            angle[used],
            False,
            measurement.signal or "",
            error[used] / np.abs(angle[used]),
            len(reference) - len(used),
        )


def _tracked(study: Study, measurement: Measured, path: Path, ratio: float) -> "Tracked":
    """Orders of a signal; raises InputError located at its name."""
    from torsion.kernels.order_tracking import of_pulses, of_speeds, uneven

    shaft_orders = np.array([float(order) for order in measurement.orders]) / ratio
    signal_path = (*path, "signal")
    file = FilePath(study.file).parent / (measurement.signal or "")
    try:
        values = np.array(pairs(file, PULSES if measurement.pulses else TIME_AND_SPEED)).T
    except ValueError as error:
        raise InputError([Fault(signal_path, *error.args)]) from None
    time = values[0]
    if measurement.pulses is None and (values[1] <= 0.0).any():
        hint = "cut the signal to where the shaft turns, in its positive sense"
        raise InputError([Fault(signal_path, "the speed is not above 0 throughout", hint)])
    if measurement.pulses and (wrong := uneven(time)) is not None:
        message = f"at {time[wrong]:.6g} s pulses are missing, or there is one too many"
        hint = "even marks, each once a revolution: mend the file"
        raise InputError([Fault(signal_path, message, hint)])
    steps = np.diff(time)
    gap = int(steps.argmax())
    if measurement.pulses is None and steps[gap] > GAP * np.median(steps):
        message = f"after {time[gap]:.6g} s samples are missing, for {steps[gap]:.3g} s"
        raise InputError([Fault(signal_path, message, "a signal without gaps: cut it there")])
    _refuse_orders(measurement, shaft_orders, path)
    highest: float | None = measurement.pulses  # samples of a revolution
    if highest is None:
        fastest = np.maximum(values[1, 1:], values[1, :-1])
        highest = float((2.0 * np.pi / (steps * fastest)).min())
    if (shaft_orders >= highest / 2.0).any():
        worst = measurement.orders[int(np.argmax(shaft_orders))]
        needed = f"needs more than {2.0 * shaft_orders.max():.6g} samples a revolution"
        message = f"order {worst} {needed}, and there are {highest:.6g}"
        raise InputError([Fault((*path, "orders"), message, "leave it out")])
    try:
        tracked = (
            of_pulses(time, measurement.pulses, shaft_orders, measurement.revolutions)
            if measurement.pulses
            else of_speeds(time, values[1], shaft_orders, measurement.revolutions)
        )
    except ValueError as error:
        hint = "more samples, or a longer window: `revolutions`"
        raise InputError([Fault(signal_path, str(error), hint)]) from None
    if not tracked.speed.size:
        message = f"the signal is shorter than a window of {measurement.revolutions} revolutions"
        raise InputError([Fault(signal_path, message, "a lower `revolutions`")])
    return tracked


def _refuse_orders(measurement: Measured, shaft_orders: FloatArray, path: Path) -> None:
    """Orders that a window is too short for; own: (orders,) per revolution of the shaft."""
    ascending = np.argsort(shaft_orders)
    lowest, gaps = float(shaft_orders.min()), np.diff(shaft_orders[ascending])
    slow = lowest * measurement.revolutions < LEAST_CYCLES
    close = bool((gaps * measurement.revolutions < APART).any())
    if not slow and not close:
        return
    cycles, needed = (lowest, LEAST_CYCLES) if slow else (float(gaps.min()), APART)
    words = f"order {measurement.orders[ascending[0]]} has"
    if not slow:
        first, second = (measurement.orders[k] for k in ascending[gaps.argmin() :][:2])
        words = f"orders {first} and {second} differ by"
    message = f"{words} {cycles * measurement.revolutions:.3g} cycles in a window of {measurement.revolutions} revolutions"
    hint = f"{needed:g} are needed: `revolutions: {math.ceil(needed / cycles)}`"
    raise InputError([Fault((*path, "orders"), message, hint)])


ROUNDING = 1e-9  # relative, of a speed in two units


def fit_faults(study: Study) -> list[Fault]:
    """Measurements that the train, its excitation or its speeds do not have."""
    settings = study.analyses["fit"]
    if not isinstance(settings, FitSettings):
        return []
    faults: list[Fault] = []
    count, has_signal = 0, False
    for position, measurement in enumerate(settings.measured):
        path = (*FIT, "measured", position)
        count += measurement.frequency is not None
        for row in measurement.torsiogram or ():
            count += 1 if row.phase is None else 2
        of_measurement = list(_measurement_faults(study, measurement, path))
        if measurement.signal is not None:
            has_signal = True
            if not of_measurement:
                try:
                    tuple(_of_signal(study, measurement, path))
                except InputError as error:
                    faults += error.faults
        faults += of_measurement
    if len(settings.vary) > count and not has_signal:
        values = f"{count} value{'s were' if count != 1 else ' was'} measured"
        message = f"{len(settings.vary)} parameters vary, and {values}"
        hint = "vary fewer, or give more measurements"
        faults.append(Fault((*FIT, "vary"), message, hint, at_key=True))
    return faults


def _measurement_faults(study: Study, measurement: Measured, path: Path) -> Iterator[Fault]:
    """Yield what the train, its excitation or its speeds lack for a measurement over speed."""
    if measurement.frequency is not None:
        return
    speeds, train = study.operation.speeds, study.train
    if speeds is None:
        message = "a measurement over speed needs the speeds at which the train runs"
        yield Fault(path, message, "`operation: {speeds: {from: 300 rpm, to: 1800 rpm}}`")
        return
    excited = excited_orders(train)
    steps: list[tuple[Fraction | None, Path]] = [
        (order, ("orders", k)) for k, order in enumerate(measurement.orders)
    ]
    hint = f"there are {', '.join(map(str, excited))}, per revolution of the reference"
    for order, step in (*steps, (measurement.order, ("order",))):
        if order is not None and order not in excited:
            words = hint if excited else "nothing excites by order"
            yield Fault((*path, *step), f"no excitation has order {order}", words)
    for row_number, row in enumerate(measurement.torsiogram or ()):
        if not speeds.first * (1 - ROUNDING) <= row.speed <= speeds.last * (1 + ROUNDING):
            ends = " to ".join(f"{end * RPM:.6g}" for end in (speeds.first, speeds.last))
            words = f"{row.speed * RPM:.6g} rpm lies outside the speeds {ends} rpm"
            row_path = (*path, "torsiogram", row_number, "speed")
            yield Fault(row_path, words, "widen `operation.speeds`")
            break

    # A torque is that of an elastic component, all else that of a point.
    components = {part.name: (part.kind, part.is_point) for part in train.parts}
    name, at_path = measurement.at or "", (*path, "at")
    is_torque = measurement.quantity == "torque"
    if is_torque:
        names = [
            part.name
            for part in train.parts
            if not part.is_point and part.kind in ("coupling", "shaft")
        ]
        words = f"'{name}' is neither a coupling nor a shaft, and carries no torque"
        hint = f"one of {', '.join(names)}" if names else "the train has none"
    else:
        names = [
            station.name
            for station in train.stations
            if not station.is_ground and station.ratio > 0
        ]
        words = f"'{name}' is not one point that turns"
        hint = f"one of the points {listed(names)}"
    if name not in names:
        fault = name_fault(name, at_path, components, point=not is_torque)
        yield fault or Fault(at_path, words, hint)
