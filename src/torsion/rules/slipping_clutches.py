"""No verdict passes on a train whose clutch slips: all but motion over time takes clutches as stuck."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.findings import Results
from torsion.rules.verdict_line import Check

ROUNDING = 1e-9  # of a torque


def slipping(evidence: Results) -> str:
    """Return which clutches slip at the speeds computed, by mean torque and vibration of the stuck clutch; empty for none."""
    steady, response = evidence.get(Steady), evidence.get(Response)
    synthesis = evidence.get(Synthesis)

    def words() -> Iterator[str]:
        for number, part in enumerate(evidence.study.train.parts):
            if part.nonlinear is None or part.nonlinear.capacity is None:
                continue
            capacity, spans = (
                part.nonlinear.capacity,
                np.flatnonzero(evidence.system.span_part == number),
            )
            speed = torque = np.empty(0)
            if steady is not None:
                speed, torque = steady.speed, np.abs(steady.torque[spans]).max(axis=0)
            if response is not None and synthesis is not None:
                speed = np.append(speed, response.speed)
                torque = np.append(torque, synthesis.peak[:, spans].max(axis=1))
            torque = np.nan_to_num(
                torque, nan=0.0, posinf=np.inf
            )  # which the rules themselves never pass
            if torque.size and torque.max() >= capacity * (1.0 - ROUNDING):
                rpm = speed[torque.argmax()] * 30.0 / np.pi
                carried = f"{torque.max():.5g} N m at {rpm:.5g} rpm, capacity {capacity:.5g} N m"
                yield f"the clutch '{part.name}' is taken as stuck and slips: {carried}"

    return "; ".join(words())


def unjudged_if(slips: str, check: Check) -> Check:
    """Return a check that is met as not judged where clutches slip; another check as it is."""
    if not check.has_limit or check.verdict not in ("pass", "restricted"):
        return check
    return replace(check, verdict="not judged", restrictions=(slips, *check.restrictions))
