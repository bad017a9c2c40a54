"""The synthesis of a response by harmonic balance, raised to the exact motions beside it.

Harmonic balance knows one harmonic of the torque of a coupling with play, friction or stages; the exact motion has all.
"""

from dataclasses import replace

import numpy as np

from torsion.analyses.motion.nonlinear_peaks import NonlinearPeak, NonlinearPeaks, exact_peaks
from torsion.analyses.response.amplitudes import Balanced, Response, Synthesis
from torsion.arrays import BoolArray, FloatArray
from torsion.findings import Results, Work

SAMPLED = (
    1e-3  # share by which the extremes of a sampled motion may be off: no smaller surplus counts
)


def run(work: Work) -> None:
    """The peaks of every nonlinear coupling, and the synthesis raised to them; nothing without a response of them."""
    response, computed = work.get(Response), work.get(Synthesis)
    if response is None or computed is None or response.balanced is None:
        return
    work.put(
        nonlinear_peaks=NonlinearPeaks(exact_peaks(work, response, response.balanced), computed)
    )
    work.put(synthesis=raised_synthesis(work))


def raised_synthesis(evidence: Results) -> Synthesis:
    """The synthesis, nowhere less than the exact motion; infinite where one is needed and none is known."""
    peaks, response, total = (
        evidence.get(NonlinearPeaks),
        evidence.need(Response),
        computed_synthesis(evidence),
    )
    if response.balanced is None:
        return total
    of_half_range, of_peak = surplus(evidence)
    half_range, peak = total.half_range * of_half_range, total.peak * of_peak
    for speed in unknown_speeds(response, response.balanced, peaks):
        half_range[speed], peak[speed] = np.inf, np.inf
    return replace(
        total, half_range=half_range, peak=peak, bound=np.maximum(total.bound, half_range)
    )


def computed_synthesis(evidence: Results) -> Synthesis:
    """The synthesis of the response alone."""
    peaks = evidence.get(NonlinearPeaks)
    return evidence.need(Synthesis) if peaks is None or peaks.computed is None else peaks.computed


def surplus(evidence: Results) -> tuple[FloatArray, FloatArray]:
    """(speeds, spans) each, by which exact motions exceed half range and largest magnitude, 1 at least.

    Between two speeds that are compared it is the larger of both, beyond them that of the nearest, and 1 at a speed at
    which every coupling is linear.
    """
    found, response = evidence.get(NonlinearPeaks), evidence.need(Response)
    total = computed_synthesis(evidence)
    factors = np.ones((2, *total.half_range.shape))
    if found is None or not found.each or response.balanced is None:
        return factors[0], factors[1]
    each = sorted(found.each, key=lambda one: one.speed)
    at = np.array([int(np.argmin(np.abs(response.speed - one.speed))) for one in each])
    exact = np.array([[one.half_ranges for one in each], [one.greatests for one in each]])
    known = np.array([total.half_range[at], total.peak[at]])
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(np.isfinite(known) & (known > 0.0), exact / known, 1.0)
    own = np.where(own > 1.0 + SAMPLED, own, 1.0)
    speed = response.speed[at]
    before = np.clip(np.searchsorted(speed, response.speed, "right") - 1, 0, len(speed) - 1)
    after = np.clip(np.searchsorted(speed, response.speed, "left"), 0, len(speed) - 1)
    factors = np.maximum(own[:, before], own[:, after])
    for number in range(len(speed)):  # several couplings may be compared at one speed
        here = response.speed == speed[number]
        factors[:, here] = np.maximum(factors[:, here], own[:, [number]])
    factors[:, _is_linear(response.balanced)] = 1.0
    return factors[0], factors[1]


def _is_linear(balanced: Balanced) -> BoolArray:
    """(speeds,) every coupling stays linear."""
    return np.asarray((balanced.amplitude <= balanced.first).all(axis=1))


def unknown_speeds(
    response: Response, balanced: Balanced, found: NonlinearPeaks | None
) -> list[int]:
    """Speeds, by number, at which a coupling leaves its linear range and no exact motion is known."""
    if found is None:
        return []
    known: dict[int, list[NonlinearPeak]] = {}
    for one in found.each:
        known.setdefault(one.span, []).append(one)
    numbers = list[int]()
    for number, span in enumerate(balanced.spans):
        beyond = balanced.amplitude[:, number] > balanced.first[:, number]
        if span not in known:
            numbers += np.flatnonzero(beyond).tolist()
        unsettled = [one.speed for one in known.get(span, []) if one.exact is None]
        numbers += [
            at for at in map(int, np.flatnonzero(np.isin(response.speed, unsettled))) if beyond[at]
        ]
    return numbers
