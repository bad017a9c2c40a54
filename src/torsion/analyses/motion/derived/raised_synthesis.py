"""The synthesis of a response by harmonic balance, raised to the exact motions beside it.

Harmonic balance knows one harmonic of the torque of a coupling with play, friction or stages; the exact motion has all.
"""

from dataclasses import replace

import numpy as np

from torsion.analyses.motion.derived.nonlinear_peaks import NonlinearPeaks, exact_peaks
from torsion.analyses.response.amplitudes import Balanced, Response, Synthesis
from torsion.arrays import FloatArray
from torsion.findings import Results, Work

# share by which the extremes of a sampled motion may be off: no smaller surplus counts
SAMPLED = 1e-3


def run(work: Work) -> None:
    """The peaks of every nonlinear coupling, and the synthesis raised to them; nothing without a response of them."""
    response, computed = work.get(Response), work.get(Synthesis)
    if response is None or computed is None or response.balanced is None:
        return
    peaks = exact_peaks(work, response, response.balanced)
    work.put(nonlinear_peaks=NonlinearPeaks(peaks, computed))
    work.put(synthesis=raised_synthesis(work))


def raised_synthesis(evidence: Results) -> Synthesis:
    """The synthesis, nowhere less than the exact motion; infinite where one is needed and none is known."""
    response, total = evidence.need(Response), computed_synthesis(evidence)
    if response.balanced is None:
        return total
    of_half_range, of_peak = surplus(evidence)
    half_range, peak = total.half_range * of_half_range, total.peak * of_peak
    speeds = unknown_speeds(response, response.balanced, evidence.get(NonlinearPeaks))
    half_range[speeds], peak[speeds] = np.inf, np.inf
    bound = np.maximum(total.bound, half_range)
    return replace(total, half_range=half_range, peak=peak, bound=bound)


def computed_synthesis(evidence: Results) -> Synthesis:
    """The synthesis of the response alone."""
    peaks = evidence.get(NonlinearPeaks)
    return evidence.need(Synthesis) if peaks is None or peaks.computed is None else peaks.computed


def surplus(evidence: Results) -> tuple[FloatArray, FloatArray]:
    """(speeds, spans) each, by which exact motions exceed half range and largest magnitude, 1 at least.

    Between two speeds that are compared it is the larger of both, beyond them that of the nearest, and 1 at a speed at
    which every coupling is linear.
    """
    peaks, response = evidence.get(NonlinearPeaks), evidence.need(Response)
    total, balanced = computed_synthesis(evidence), response.balanced
    if peaks is None or not peaks.each or balanced is None:
        return np.ones_like(total.half_range), np.ones_like(total.half_range)
    compared = sorted(peaks.each, key=lambda peak: peak.speed)
    index = np.array([int(np.argmin(np.abs(response.speed - peak.speed))) for peak in compared])
    exact = np.array(
        [[getattr(peak, name) for peak in compared] for name in ("half_ranges", "greatests")]
    )
    computed = np.array([total.half_range[index], total.peak[index]])
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(np.isfinite(computed) & (computed > 0.0), exact / computed, 1.0)
    ratio = np.where(ratio > 1.0 + SAMPLED, ratio, 1.0)
    speed = response.speed[index]
    before = np.clip(np.searchsorted(speed, response.speed, "right") - 1, 0, len(speed) - 1)
    after = np.clip(np.searchsorted(speed, response.speed, "left"), 0, len(speed) - 1)
    factors = np.maximum(ratio[:, before], ratio[:, after])
    for number in range(len(speed)):  # several couplings may be compared at one speed
        is_compared = response.speed == speed[number]
        factors[:, is_compared] = np.maximum(factors[:, is_compared], ratio[:, [number]])
    factors[:, (balanced.amplitude <= balanced.first).all(axis=1)] = 1.0
    return factors[0], factors[1]


def unknown_speeds(
    response: Response, balanced: Balanced, peaks: NonlinearPeaks | None
) -> list[int]:
    """Speeds, by number, at which a coupling leaves its linear range and no exact motion is known."""
    if peaks is None:
        return []
    numbers = list[int]()
    for number, span in enumerate(balanced.spans):
        is_unknown = balanced.amplitude[:, number] > balanced.first[:, number]
        of_span = [peak for peak in peaks.each if peak.span == span]
        if of_span:
            unsettled = [peak.speed for peak in of_span if peak.exact is None]
            is_unknown &= np.isin(response.speed, unsettled)
        numbers += np.flatnonzero(is_unknown).tolist()
    return numbers
