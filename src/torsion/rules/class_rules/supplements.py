"""Verdicts where a coupling by table over vibratory torque has several solutions: the worst of each check stands."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from torsion.analyses.motion.derived.nonlinear_peaks import NonlinearPeaks
from torsion.analyses.motion.derived.raised_synthesis import (
    computed_synthesis,
    surplus,
    unknown_speeds,
)
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.balanced_couplings import balanced_spans
from torsion.analyses.response.synthesis import synthesis
from torsion.arrays import BoolArray, IntArray
from torsion.findings import Results
from torsion.rules.verdict_line import Check, worst_checks

LARGEST = "largest"
Judge = Callable[[Results], tuple[Check, ...]]  # by all rules of the study


def worst_of_solutions(evidence: Results, judge: Judge) -> tuple[Check, ...]:
    """Return the checks of the largest solution, each replaced by that of another solution where it is worse."""
    checks = judge(evidence)
    response = evidence.get(Response)
    if response is None or not response.others:
        return checks
    cases = {LARGEST: checks}
    for number, solution in enumerate(response.others, 2):
        with_solution = evidence.having(response=solution, synthesis=synthesis(solution))
        cases[f"at solution {number} of the vibratory torque, the largest first"] = judge(
            with_solution
        )
    return tuple(
        check
        if words == LARGEST
        else replace(check, note="; ".join(filter(None, (words, check.note))))
        for words, check in worst_checks(cases).values()
    )


UNPROVEN = (
    "a backlash or stage leaves its linear range at {speed}: harmonic balance does not bound what follows, so this "
    "never passes; compute the transient response there"
)
ROUNDING = 1e-9  # of a torque
NEAR = 0.8  # of the linear range


def words(evidence: Results, spans: IntArray, speed: float) -> str:
    """What a reader of a value in some spans must know of nonlinear couplings; empty for nothing."""
    response, peaks = evidence.get(Response), evidence.get(NonlinearPeaks)
    if response is None or response.balanced is None or not spans.size:
        return ""
    opening = [] if peaks is None else [p.coupling for p in peaks.each if p.opens_from is not None]
    notes = [f"the play of '{name}' opens" for name in dict.fromkeys(opening)]
    index = int(np.argmin(abs(response.speed - speed)))
    half_range, peak = (float(factor[index, spans].max()) for factor in surplus(evidence))
    if index in unknown_speeds(response, response.balanced, peaks):
        notes.append(
            "harmonic balance only, no exact motion settles near it: compute the transient response"
        )
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
    total, balanced = computed_synthesis(evidence), response.balanced
    is_unproven = np.zeros(len(response.speed), dtype=bool)
    near = NEAR if len(response.lines) > 1 else 1.0
    if balanced is None:
        return is_unproven
    for number, span in enumerate(balanced.spans):
        coupling, first = balanced_spans(system)[span], balanced.first[:, number]
        if not (coupling.half or coupling.stages):
            continue
        mean, peak_to_peak = np.abs(response.mean[:, span]), 2.0 * total.half_range[:, span]
        peak = total.peak[:, span]
        larger = np.maximum(peak - mean, peak_to_peak - (peak - mean))
        most = np.where(peak_to_peak >= peak + mean, peak_to_peak, larger)
        secant = coupling.secant(0.5 * np.maximum(first, np.finfo(float).tiny), mean)
        bound = np.abs(secant.share / system.flexibility[span] + secant.extra.real) * first
        is_beyond = most * (1.0 + ROUNDING) >= near * bound
        is_unproven |= is_beyond | (balanced.amplitude[:, number] > first)
    return is_unproven
