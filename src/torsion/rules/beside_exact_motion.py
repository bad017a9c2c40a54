"""What verdicts make of a response by harmonic balance: never less than the exact motion at its peaks beside it."""

from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Balanced, Response, Synthesis
from torsion.analyses.transient.nonlinear_peaks import NonlinearPeak, NonlinearPeaks
from torsion.arrays import FloatArray, IntArray
from torsion.findings import Results

COMPUTED = "computed_synthesis"  # name of that which the exact motion is compared with, where another stands for it
SAMPLED = 1e-3  # share by which the extremes of a sampled motion may be off: no smaller surplus counts


def on_the_safe_side(evidence: Results) -> Results:
    """With a synthesis that is nowhere less than the exact motion; infinite at a peak that has none.

    At a peak the exact motion exceeds the half range, or the largest magnitude, of a span by a factor: it is taken that
    much larger at all speeds.
    """
    found, response, total = evidence.get(NonlinearPeaks), evidence.get(Response), evidence.get(Synthesis)
    if response is None or total is None or response.balanced is None:
        return evidence
    factors = _factors(evidence, np.arange(total.half_range.shape[1]))
    half_range, peak = total.half_range * factors[0], total.peak * factors[1]
    for at in _unknown(response, response.balanced, found):
        half_range[at], peak[at] = np.inf, np.inf
    safe = replace(total, half_range=half_range, peak=peak)
    return evidence.having(**{"synthesis": safe, COMPUTED: evidence.results.get(COMPUTED, total)})


def surplus(evidence: Results, spans: IntArray) -> tuple[float, float]:
    """The largest factors of half range and of largest magnitude in some spans; 1 where no exact motion is larger."""
    of_half_range, of_peak = (float(one.max(initial=1.0)) for one in _factors(evidence, spans))
    return of_half_range, of_peak


def words(evidence: Results, spans: IntArray, speed: float) -> str:
    """What a reader of a value in some spans must know of nonlinear couplings; empty for nothing."""
    response, found = evidence.get(Response), evidence.get(NonlinearPeaks)
    if response is None or response.balanced is None or not spans.size:
        return ""
    notes = [f"the play of '{name}' opens" for name in _opening(found)]
    if speed in response.speed[list(_unknown(response, response.balanced, found))]:
        notes.append("harmonic balance alone, no exact motion settles beside it: compute the motion over time")
    elif max(factors := surplus(evidence, spans)) > 1.0:
        half_range, peak = factors
        notes.append(
            f"as the exact motion at a peak: half range {half_range:.3g} times, greatest torque {peak:.3g} times"
        )
    return "; ".join(notes)


def _opening(found: NonlinearPeaks | None) -> list[str]:
    """Couplings whose play opens at some speed."""
    return list(dict.fromkeys(one.coupling for one in found.each if one.opens_from is not None)) if found else []


def _factors(evidence: Results, spans: IntArray) -> tuple[FloatArray, FloatArray]:
    """(spans,) each, by which the exact motion exceeds half range and largest magnitude at most, 1 at least."""
    found, response = evidence.get(NonlinearPeaks), evidence.get(Response)
    total: Synthesis | None = evidence.results.get(COMPUTED, evidence.get(Synthesis))
    factors = np.ones((2, len(spans)))
    if found is None or total is None or response is None:
        return factors[0], factors[1]
    for one in found.each:
        at = int(np.argmin(np.abs(response.speed - one.speed)))
        exact = np.array([one.half_ranges[spans], one.greatests[spans]])
        known = np.array([total.half_range[at, spans], total.peak[at, spans]])
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = np.fmax(factors, np.where(np.isfinite(known) & (known > 0.0), exact / known, 1.0))
    factors = np.where(factors > 1.0 + SAMPLED, factors, 1.0)
    return factors[0], factors[1]


def _unknown(response: Response, balanced: Balanced, found: NonlinearPeaks | None) -> list[int]:
    """Speeds, by number, at which a coupling leaves its linear range and no exact motion is known."""
    if found is None:
        return []
    known: dict[int, NonlinearPeak] = {one.span: one for one in found.each}
    numbers = []
    for number, span in enumerate(balanced.spans):
        beyond = balanced.amplitude[:, number] > balanced.first[:, number]
        if span not in known:
            numbers += np.flatnonzero(beyond).tolist()
        elif known[span].exact is None:
            at = int(np.argmin(np.abs(response.speed - known[span].speed)))
            numbers += [at] if beyond[at] else []
    return numbers
