"""Step: the response over speed with its synthesis, at the speeds and of the orders that the rules need."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.asked import no_response, rules_need
from torsion.assembly.system import System
from torsion.plan import Log
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.damped import DampedModes
    from torsion.analyses.modes import Modes
    from torsion.analyses.response.amplitudes import Response, Synthesis
    from torsion.analyses.steady import Steady

Progress = Callable[[str, float], None]  # (what, share done 0..1)
MOST_ROUNDS = 4  # of looking for higher shares of the limits between the speeds


@dataclass(frozen=True)
class Known:
    """What was computed before."""

    modes: "Modes | None"
    damped: "DampedModes | None"
    steady: "Steady | None"


def over_speed(
    study: Study, system: System, known: Known, log: Log, progress: Progress
) -> "tuple[Response | None, Synthesis | None]":
    """Both, of a train that something excites at speeds that are given."""
    excites = any(t.order is not None or t.frequency is not None for t in study.train.torques)
    excites = excites or any(mesh.error for mesh in study.train.constraints)
    why = no_response(study, system, excites)
    if why:
        log.without("response over speed", why)
        return None, None
    ruled = rules_need(study, "response")
    found = _found(study, system, known, log, progress, ruled=ruled)
    total = _synthesis(system, found, log)
    return _judged(study, system, known, (found, total), log) if ruled else (found, total)


def _found(study: Study, system: System, known: Known, log: Log, progress: Progress, *, ruled: bool) -> "Response":
    """The response at the speeds asked, around resonances and, for rules, at the bounds of their limits."""
    from torsion.analyses.response.over_speed import asked_orders, response
    from torsion.rules.speeds import judged_speeds

    with log.step("response over speed", "asked" if "response" in study.analyses else "something excites") as step:
        also = judged_speeds(study) if ruled else None
        found = response(
            study, system, modes=known.modes, damped=known.damped, also=also, all_orders=ruled, progress=progress
        )
        step.method = "two-sided elimination, every order apart"
        step.size = f"{len(found.lines)} lines at {found.speed.size} speeds ({int(found.asked.sum())} asked)"
        if ruled and asked_orders(study) is not None:
            step.size += "; all orders, not only those of `orders`: the rules judge them together"
        if found.remark:
            step.size += f"; {found.remark}"
    for line in found.left_out:
        log.without(f"order {line.order} of the response ({', '.join(line.sources)})", "`orders` does not name it")
    return found


def _synthesis(system: System, found: "Response", log: Log) -> "Synthesis":
    lines = "the orders asked for" if found.left_out else "all orders"
    with log.step("synthesis", f"rules and readers judge {lines} together") as step:
        total = _in_blocks(system, found)
        step.method = "sum over the common cycle, true to phase"
        step.size = f"cycle of {total.turns} turns" if total.turns else "no common cycle: bound by magnitudes"
    return total


def _in_blocks(system: System, found: "Response") -> "Synthesis":
    """The synthesis, of large trains some speeds at a time, so that what it needs on the way stays small."""
    from torsion.analyses.response.amplitudes import part_of
    from torsion.analyses.response.size import SMALL_BLOCK, blocks
    from torsion.analyses.response.synthesis import synthesis

    parts = list(blocks(len(found.speed), system, SMALL_BLOCK))
    if len(parts) == 1:
        return synthesis(system, found)
    none = synthesis(system, part_of(found, slice(0, 0)))
    rows: dict[str, Any] = {
        key: np.empty_like(found.mean) for key, value in vars(none).items() if isinstance(value, np.ndarray)
    }
    for part in parts:
        one = synthesis(system, part_of(found, part))
        for key, all_rows in rows.items():
            all_rows[part] = getattr(one, key)
    return replace(none, **rows)


def _judged(
    study: Study, system: System, known: Known, both: "tuple[Response, Synthesis]", log: Log
) -> "tuple[Response, Synthesis]":
    """With the speeds between at which a rule finds more than at the ones beside them."""
    from torsion.analyses.response.amplitudes import joined
    from torsion.analyses.response.over_speed import response_at
    from torsion.analyses.response.synthesis import synthesis
    from torsion.rules.evidence import Evidence
    from torsion.rules.speeds import speeds_between

    before = both[0].speed.size
    with log.step("speeds between", "no worst value of a rule lies between two speeds") as step:
        for _ in range(MOST_ROUNDS):
            more = speeds_between(Evidence(study, system, known.modes, known.steady, *both))
            if not more.size:
                break
            there = response_at(study, system, both[0], more)
            both = joined(both, (there, synthesis(system, there)))
        step.method = "parabolas through the shares of the limits; ends of barred ranges"
        step.size = f"{both[0].speed.size - before} speeds"
    return both
