"""What verdicts make of a response by harmonic balance: never less than the exact motions beside it."""

from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Balanced, Response, Synthesis
from torsion.analyses.response.balanced_couplings import balanced_spans
from torsion.analyses.transient.nonlinear_peaks import NonlinearPeak, NonlinearPeaks
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.findings import Results

COMPUTED = "computed_synthesis"  # name of that which the exact motion is compared with, where another stands for it
UNPROVEN = (
    "a play or stage leaves its linear range at {speed}: harmonic balance does not bound what follows, so this never "
    "passes; compute the motion over time there"
)
ROUNDING = 1e-9  # of a torque
NEAR = 0.8  # of the linear range
SAMPLED = 1e-3  # share by which the extremes of a sampled motion may be off: no smaller surplus counts


def on_the_safe_side(evidence: Results) -> Results:
    """With a synthesis that is nowhere less than the exact motion; infinite where one is needed and none is known."""
    found, response, total = evidence.get(NonlinearPeaks), evidence.get(Response), evidence.get(Synthesis)
    if response is None or total is None or response.balanced is None:
        return evidence
    of_half_range, of_peak = surplus(evidence)
    half_range, peak = total.half_range * of_half_range, total.peak * of_peak
    for at in _unknown(response, response.balanced, found):
        half_range[at], peak[at] = np.inf, np.inf
    safe = replace(total, half_range=half_range, peak=peak)
    return evidence.having(**{"synthesis": safe, COMPUTED: evidence.results.get(COMPUTED, total)})


def surplus(evidence: Results) -> tuple[FloatArray, FloatArray]:
    """(speeds, spans) each, by which exact motions exceed half range and largest magnitude, 1 at least.

    Between two speeds that are compared it is the larger of both, beyond them that of the nearest, and 1 at a speed at
    which every coupling is linear.
    """
    found, response = evidence.get(NonlinearPeaks), evidence.need(Response)
    total: Synthesis = evidence.results.get(COMPUTED, evidence.need(Synthesis))
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


def words(evidence: Results, spans: IntArray, speed: float) -> str:
    """What a reader of a value in some spans must know of nonlinear couplings; empty for nothing."""
    response, found = evidence.get(Response), evidence.get(NonlinearPeaks)
    if response is None or response.balanced is None or not spans.size:
        return ""
    notes, at = [f"the play of '{name}' opens" for name in _opening(found)], int(np.argmin(abs(response.speed - speed)))
    half_range, peak = (float(one[at, spans].max()) for one in surplus(evidence))
    if at in _unknown(response, response.balanced, found):
        notes.append("harmonic balance alone, no exact motion settles beside it: compute the motion over time")
    elif max(half_range, peak) > 1.0:
        notes.append(
            f"as the exact motion near it, half range {half_range:.3g} times, greatest torque {peak:.3g} times"
        )
    return "; ".join(notes)


def unproven(evidence: Results) -> BoolArray:
    """(speeds,) a play or a stage leaves its linear range under all harmonic components together.

    There neither harmonic balance nor exact motions at some speeds bound the vibration, and no verdict passes. A play
    without a mean torque is never in its linear range. Where several components excite, harmonic balance sees no second
    motion that may coexist near the end of that range: NEAR of it counts as its end.
    """
    response, system = evidence.need(Response), evidence.system
    total: Synthesis = evidence.results.get(COMPUTED, evidence.need(Synthesis))
    found, near = np.zeros(len(response.speed), dtype=bool), NEAR if len(response.lines) > 1 else 1.0
    if response.balanced is None:
        return found
    couplings = balanced_spans(system)
    for number, span in enumerate(response.balanced.spans):
        coupling, first = couplings[span], response.balanced.first[:, number]
        if not (coupling.half or coupling.stages):
            continue
        mean, whole = np.abs(response.mean[:, span]), 2.0 * total.half_range[:, span]
        above = total.peak[:, span] - mean
        most = np.where(whole >= total.peak[:, span] + mean, whole, np.maximum(above, whole - above))
        secant = coupling.secant(0.5 * np.maximum(first, np.finfo(float).tiny), mean)
        bound = np.abs(secant.share / system.flexibility[span] + secant.extra.real) * first
        found |= (most * (1.0 + ROUNDING) >= near * bound) | (response.balanced.amplitude[:, number] > first)
    return found


def _opening(found: NonlinearPeaks | None) -> list[str]:
    """Couplings whose play opens at some speed."""
    return list(dict.fromkeys(one.coupling for one in found.each if one.opens_from is not None)) if found else []


def _is_linear(balanced: Balanced) -> BoolArray:
    """(speeds,) every coupling stays linear."""
    return np.asarray((balanced.amplitude <= balanced.first).all(axis=1))


def _unknown(response: Response, balanced: Balanced, found: NonlinearPeaks | None) -> list[int]:
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
        numbers += [at for at in map(int, np.flatnonzero(np.isin(response.speed, unsettled))) if beyond[at]]
    return numbers
