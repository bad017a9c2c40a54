"""What the model of a train keeps from passing: a clutch that slips and is taken as stuck, elements that are too long."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.assembly import ROUNDING as OF_PHASE
from torsion.assembly.segments import LARGEST_PHASE_OF_TORQUES, phase
from torsion.assembly.system import System
from torsion.findings import Results
from torsion.rules.verdict_line import Check, Rule, restricted

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


def conditioned(
    checks: Iterable[tuple[Rule[Any], Check]], evidence: Results
) -> Iterator[tuple[Rule[Any], Check]]:
    """Yield checks with their rules; none passes where clutches slip, nor plainly where elements are too long."""
    slips = slipping(evidence)
    for rule, check in checks:
        if "response" in rule.needs:
            check = with_pieces(check, evidence.system)  # noqa: PLW2901
        is_met = check.has_limit and check.verdict in ("pass", "restricted")
        if slips and rule.has_clutches_stuck and is_met:
            words = (slips, *check.restrictions)
            check = replace(check, verdict="not judged", restrictions=words)  # noqa: PLW2901
        yield rule, check


def with_pieces(check: Check, system: System) -> Check:
    """Return a check of a response, restricted if the pieces of its shaft are longer than torques need."""
    longest = max(
        (
            phase(bar, system.requested.excited) / system.segments[bar.name]
            for bar in system.train.bars
            if system.bars is not None and system.train.parts[bar.part].name == check.where
        ),
        default=0.0,
    )
    if check.unit == "mm" or longest <= LARGEST_PHASE_OF_TORQUES * (1.0 + OF_PHASE):
        return check
    more = (
        f"up to {100.0 / math.cos(longest / 2.0) - 100.0:.3g} % more" if longest < 3.0 else "more"
    )
    return restricted(check, f"at the ends of its elements; {more} between them")
