"""The response over speed that a study requests, with its synthesis, at the speeds that verdicts of rules stand on."""

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.discretisation import no_response
from torsion.analyses.response.amplitudes import Response, Synthesis, joined
from torsion.analyses.response.over_speed import requested_orders, response, response_at
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Work

MOST_ROUNDS = 4  # of looking for higher shares of the limits between the speeds


def run(work: Work) -> None:
    """Response and synthesis of a train that something excites, at speeds that are given."""
    why = no_response(work.study, work.system, work.ruled)
    if why:
        work.log.without("response over speed", why)
        return
    found = _found(work)
    lines = "the orders requested" if found.left_out else "all orders"
    with work.log.step("synthesis", f"rules and readers judge {lines} together") as step:
        total = synthesis(found)
        step.method = "sum over the common cycle, true to phase"
        step.size = f"cycle of {total.turns} turns" if total.turns else "no common cycle: bound by magnitudes"
    if "response" in work.ruled:
        found, total = _judged(work, found, total)
    work.put(response=found, synthesis=total)


def _found(work: Work) -> Response:
    """The response at the speeds requested, around resonances and, for rules, at the bounds of their limits."""
    study, log, ruled = work.study, work.log, "response" in work.ruled
    with log.step("response over speed", "requested" if "response" in study.analyses else "something excites") as step:
        also = work.rules.judged_speeds(study) if ruled else np.empty(0)
        found = response(
            study, work.system, modes=work.get(Modes), damped=work.get(DampedModes), also=also, all_orders=ruled,
            progress=work.progress,
        )  # fmt: skip
        step.method = "two-sided elimination, every order apart"
        step.size = f"{len(found.lines)} lines at {found.speed.size} speeds ({int(found.requested.sum())} requested)"
        if ruled and requested_orders(study) is not None:
            step.size += "; all orders, not only those of `orders`: the rules judge them together"
        if found.remark:
            step.size += f"; {found.remark}"
    for line in found.left_out:
        log.without(f"order {line.order} of the response ({', '.join(line.sources)})", "`orders` does not name it")
    return found


def _judged(work: Work, found: Response, total: Synthesis) -> tuple[Response, Synthesis]:
    """With the speeds between at which a rule finds more than at the ones beside them."""
    both, before = (found, total), found.speed.size
    with work.log.step("speeds between", "no worst value of a rule lies between two speeds") as step:
        for _ in range(MOST_ROUNDS):
            seen = work.having(response=both[0], synthesis=both[1])
            more = work.rules.speeds_between(seen)
            if not more.size:
                break
            there = response_at(work.study, work.system, both[0], more)
            both = joined(both, (there, synthesis(there)))
        step.method = "parabolas through the shares of the limits; ends of barred ranges"
        step.size = f"{both[0].speed.size - before} speeds"
    return both
