"""The exact motion at the peaks of a response whose couplings have play, friction or stages."""

import math
from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.transient.event_driven_curves import EventDrivenCurves
from torsion.analyses.transient.event_driven_train import build
from torsion.analyses.transient.nonlinear_couplings import couplings
from torsion.analyses.transient.transient_settings import TransientSettings
from torsion.arrays import FloatArray
from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Study

SETTLED = 1e-4  # of the amplitude: change from one window to the next
CYCLES = 16  # of the component, in a window
MOST_WINDOWS = 64
SAMPLES = 4096  # of a window
LARGEST_COMMON = 64  # revolutions of a window that orders have in common


@reported
class NonlinearPeak:
    """The largest torque amplitude of a nonlinear coupling, twice."""

    coupling: str = result("", (), "which")
    component: str = result("", (), "harmonic component of the largest amplitude")
    speed: float = result("rad/s", (), "reference speed of it")
    response: float = result("N*m", (), "amplitude in the response: play closed, friction by harmonic balance")
    exact: float | None = result("N*m", (), "amplitude of the exact motion, settled; null where it does not settle")
    difference: float | None = result("1", (), "of the response from the exact motion, of the latter")


@reported
class NonlinearPeaks:
    """Every coupling with play, friction or stages."""

    each: tuple[NonlinearPeak, ...] = result("", (), "every coupling with play, friction or stages", key="")


def run(work: Work) -> None:
    """The peaks of every such coupling; nothing without a response, or where the train has no such motion."""
    found, title = work.get(Response), "exact motion at the peaks of nonlinear couplings"
    if found is None:
        return
    try:
        with work.log.step(title, "the response takes them as linear") as step:
            every = couplings(work.study.train, found.system)
            peaks = tuple(_peak(work.study, found, one.span) for one in every if one.record.capacity is None)
            step.method = "from event to event, until it repeats itself"
            step.size = f"{len(peaks)} couplings"
        work.put(nonlinear_peaks=NonlinearPeaks(peaks))
    except (InputError, SolveError) as error:
        work.log.without(title, str(error))


def _peak(study: Study, found: Response, span: int) -> NonlinearPeak:
    amplitude = np.abs(found.torque[:, :, span])
    at, line = (int(one) for one in np.unravel_index(amplitude.argmax(), amplitude.shape))
    speed, w = float(found.speed[at]), 2.0 * math.pi * float(found.frequency[at, line])
    orders = [one.order for one in found.lines if one.order is not None]
    turns = math.lcm(*(order.denominator for order in orders)) if orders else 1
    window = 2.0 * math.pi / speed * turns if orders and turns <= LARGEST_COMMON else 2.0 * math.pi / w
    window *= max(1, math.ceil(CYCLES * 2.0 * math.pi / (w * window)))
    exact = settled_amplitude(study, found, span, (speed, w), window)
    linear = float(amplitude[at, line])
    name = study.train.parts[int(found.system.span_part[span])].name
    difference = linear / exact - 1.0 if exact else None
    return NonlinearPeak(name, found.lines[line].words, speed, linear, exact, difference)


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
        curves = EventDrivenCurves(built, *built.run(settings.duration))
        before, last = (_component(curves, span, w, (windows - back) * window, window) for back in (2, 1))
        if abs(last - before) <= SETTLED * last:
            return last
        windows *= 2
    return None


def _component(curves: EventDrivenCurves, span: int, w: float, begin: float, window: float) -> float:
    time: FloatArray = begin + (np.arange(SAMPLES, dtype=np.float64) + 0.5) * (window / SAMPLES)
    torque = curves.torque(time)[0][span]
    return 2.0 * abs(complex(np.mean(torque * np.exp(-1j * w * time))))
