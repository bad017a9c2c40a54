"""The exact motion at the peaks of a response with dry friction, beside harmonic balance."""

import math
from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.dry_friction import rubbing_spans
from torsion.analyses.transient.event_driven_curves import EventDrivenCurves
from torsion.analyses.transient.event_driven_train import build
from torsion.analyses.transient.transient_settings import TransientSettings
from torsion.arrays import FloatArray
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Study

SETTLED = 1e-4  # of the amplitude: change from one window to the next
CYCLES = 16  # of the component, in a window
MOST_WINDOWS = 64
SAMPLES = 4096  # of a window
LARGEST_COMMON = 64  # revolutions of a window that orders have in common


@reported
class FrictionPeak:
    """The largest torque amplitude of a coupling with friction, twice."""

    coupling: str = result("", (), "which")
    component: str = result("", (), "harmonic component of the largest amplitude")
    speed: float = result("rad/s", (), "reference speed of it")
    balance: float = result("N*m", (), "amplitude by harmonic balance, as in the response")
    exact: float | None = result("N*m", (), "amplitude of the exact motion, settled; null where it does not settle")
    difference: float | None = result("1", (), "of harmonic balance, of the exact one")


@reported
class FrictionPeaks:
    """Every coupling with friction."""

    each: tuple[FrictionPeak, ...] = result("", (), "every coupling with friction, at its peak", key="")


def run(work: Work) -> None:
    """The peaks of every coupling with friction; nothing without a response."""
    found, rubbing = work.get(Response), rubbing_spans(work.system)
    if found is None or not rubbing:
        return
    with work.log.step("exact motion at the peaks of friction", "harmonic balance takes one component") as step:
        peaks = tuple(_peak(work.study, found, span) for span in rubbing)
        step.method = "from event to event, until it repeats itself"
        step.size = f"{len(peaks)} couplings"
    work.put(friction_peaks=FrictionPeaks(peaks))


def _peak(study: Study, found: Response, span: int) -> FrictionPeak:
    amplitude = np.abs(found.torque[:, :, span])
    at, line = (int(one) for one in np.unravel_index(amplitude.argmax(), amplitude.shape))
    speed, w = float(found.speed[at]), 2.0 * math.pi * float(found.frequency[at, line])
    orders = [one.order for one in found.lines if one.order is not None]
    turns = math.lcm(*(order.denominator for order in orders)) if orders else 1
    window = 2.0 * math.pi / speed * turns if orders and turns <= LARGEST_COMMON else 2.0 * math.pi / w
    window *= max(1, math.ceil(CYCLES * 2.0 * math.pi / (w * window)))
    exact = settled_amplitude(study, found, span, (speed, w), window)
    balance = float(amplitude[at, line])
    name = study.train.parts[int(found.system.span_part[span])].name
    difference = None if exact is None else balance / exact - 1.0
    return FrictionPeak(name, found.lines[line].words, speed, balance, exact, difference)


def settled_amplitude(study: Study, found: Response, span: int, at: tuple[float, float], window: float) -> float | None:
    """N m of the component of a speed and circular frequency (rad/s) over a window (s); None where it does not settle.

    The motion begins with the mean torques, and its windows are compared until one repeats the one before.
    """
    speed, w = at
    windows, before = 8, math.nan
    while windows <= MOST_WINDOWS:
        settings = TransientSettings.model_construct(
            duration=windows * window, initial="steady", events=(), samples=None, modes="all"
        )
        built = build(replace(study, analyses={}), found.system, settings, ("analyses", "response"), speed=speed)
        curves = EventDrivenCurves(built, built.run(settings.duration))
        before, last = (_component(curves, span, w, (windows - back) * window, window) for back in (2, 1))
        if abs(last - before) <= SETTLED * last:
            return last
        windows *= 2
    return None


def _component(curves: EventDrivenCurves, span: int, w: float, begin: float, window: float) -> float:
    time: FloatArray = begin + (np.arange(SAMPLES, dtype=np.float64) + 0.5) * (window / SAMPLES)
    torque = curves.torque(time)[0][span]
    return 2.0 * abs(complex(np.mean(torque * np.exp(-1j * w * time))))
