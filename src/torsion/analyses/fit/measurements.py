"""What was measured, as curves of amplitudes: torsiograms as they are, signals over time by their orders."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.fit.fit_settings import FIT, UNITS, Measured
from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import Fault, InputError, Path
from torsion.study import Study
from torsion.two_columns import Columns, pairs

if TYPE_CHECKING:
    from torsion.kernels.order_tracking import Tracked

TIME_AND_SPEED = Columns(
    ("time", "speed"), ("s", "rad/s"), "time [s], speed [rpm]", "0.5, 1200", "a finite speed at a finite time"
)
PULSES = Columns(("time",), ("s",), "time [s]", "0.00213", "a finite time")


@dataclass(frozen=True)
class Curve:
    """Measured amplitudes of one order."""

    at: str
    order: Fraction  # per revolution of the reference
    quantity: str  # angle, speed or torque
    within: float
    speed: FloatArray  # (points,) rad/s of the reference
    amplitude: ComplexArray  # (points,) in SI
    has_phase: bool
    origin: str  # what of the file it is


def curves(study: Study, measured: tuple[Measured, ...]) -> tuple[tuple[Curve, ...], dict[str, int]]:
    """All amplitudes over speed; of every signal, how many of its windows lie outside the speed range."""
    found, unused = list[Curve](), dict[str, int]()
    for place, one in enumerate(measured):
        path = (*FIT, "measured", place)
        if one.torsiogram is not None:
            found.append(_of_torsiogram(study, one, path))
        elif one.signal is not None:
            each, outside = _of_signal(study, one, path)
            found += each
            unused[one.signal] = outside
    return tuple(found), unused


def _of_torsiogram(study: Study, one: Measured, path: Path) -> Curve:
    rows = one.torsiogram or ()
    amplitude = np.array([one.amplitude(row) for row in rows])
    phases = [row.phase for row in rows]
    phase = np.array([0.0 if value is None else value for value in phases])
    return Curve(
        one.at or "", one.order or Fraction(1), one.quantity or "", one.within, np.array([row.speed for row in rows]),
        amplitude * np.exp(1j * phase), phases[0] is not None, f"torsiogram {int(path[-1]) + 1} of `measured`",
    )  # fmt: skip


def _of_signal(study: Study, one: Measured, path: Path) -> tuple[Iterator[Curve], int]:
    """A curve for each order, and the number of windows outside the speed range."""
    ratio = next(float(station.ratio) for station in study.train.stations if station.name == one.at)
    tracked = _tracked(study, one, path, ratio)
    speeds, reference = study.operation.speeds, tracked.speed / ratio
    inside = np.ones(len(reference), dtype=bool)
    if speeds is not None:
        inside = (reference >= speeds.first) & (reference <= speeds.last)
    if not inside.any():
        least, most = (end * 30.0 / np.pi for end in (reference.min(), reference.max()))
        message = f"the signal runs from {least:.6g} to {most:.6g} rpm, outside the speeds of `operation`"
        raise InputError([Fault((*path, "signal"), message, "widen `operation.speeds`")])
    used = np.flatnonzero(inside)
    order = used[np.argsort(reference[used], kind="stable")]
    made = (
        Curve(one.at or "", exact, "angle", one.within, reference[order], tracked.angle[order, k], False,
              one.signal or "")
        for k, exact in enumerate(one.orders)
    )  # fmt: skip
    return made, int(len(reference) - len(used))


def signal_faults(study: Study, one: Measured, path: Path) -> tuple[Fault, ...]:
    """What is wrong with a signal, where its file is read."""
    try:
        _of_signal(study, one, path)
    except InputError as error:
        return error.faults
    return ()


def _tracked(study: Study, one: Measured, path: Path, ratio: float) -> "Tracked":
    """Orders of a signal; raises InputError located at its name."""
    from torsion.kernels.order_tracking import of_pulses, of_speeds, uneven

    own, place = np.array([float(order) for order in one.orders]) / ratio, (*path, "signal")
    file = FilePath(study.file).parent / (one.signal or "")
    try:
        values = np.array(pairs(file, PULSES if one.pulses else TIME_AND_SPEED)).T
    except ValueError as error:
        raise InputError([Fault(place, *error.args)]) from None
    time = values[0]
    if one.pulses is None and (values[1] <= 0.0).any():
        hint = "cut the signal to where the shaft turns, in its positive sense"
        raise InputError([Fault(place, "the speed is not above 0 throughout", hint)])
    if one.pulses and (wrong := uneven(time)) is not None:
        message = f"at {time[wrong]:.6g} s pulses are missing, or there is one too many"
        raise InputError([Fault(place, message, "even marks, each once a revolution: mend the file")])
    highest = one.pulses or _samples(time, values[1])
    if (own >= highest / 2.0).any():
        worst = one.orders[int(np.argmax(own))]
        needed = f"order {worst} needs more than {2.0 * own.max():.6g} samples a revolution"
        message = f"{needed}, and there are {highest:.6g}"
        raise InputError([Fault((*path, "orders"), message, "leave it out")])
    try:
        found = (
            of_pulses(time, one.pulses, own, one.revolutions) if one.pulses
            else of_speeds(time, values[1], own, one.revolutions)
        )  # fmt: skip
    except ValueError as error:
        raise InputError([Fault(place, str(error), "more samples, or a longer window: `revolutions`")]) from None
    if not found.speed.size:
        message = f"the signal is shorter than a window of {one.revolutions} revolutions"
        raise InputError([Fault(place, message, "a lower `revolutions`")])
    return found


def _samples(time: np.ndarray, speed: np.ndarray) -> float:
    """Fewest samples in a revolution."""
    return float((2.0 * np.pi / (np.diff(time) * np.maximum(speed[1:], speed[:-1]))).min())


def unit(curve: Curve) -> str:
    """Of its amplitudes."""
    return UNITS[curve.quantity]
