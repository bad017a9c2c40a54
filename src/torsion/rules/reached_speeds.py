"""Speeds that a rule demands and that were computed: its rows NOT JUDGED, and its restrictions, where they differ."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from torsion.analyses.speed_tables import SAME_SPEED
from torsion.arrays import FloatArray
from torsion.rules import of_study
from torsion.rules.demanded_states import unjudged
from torsion.rules.verdict_line import Check, Reach
from torsion.study import Range, SpeedRange, Study

BEGINS = "judged from"  # a speed above the rated one


def with_reach(
    check: Check, study: Study, scope: float = 1.0, speed: FloatArray | None = None, use: Range | None = None,
    subject: str = "Vibration",
) -> Iterator[Check]:  # fmt: skip
    """Yield the check, and a row NOT JUDGED where its rule demands speeds that were not computed.

    The speeds of the operation, and those (speeds,) rad/s that were looked at, hold the rated speed; up to a share
    `scope` of it `demanded_study` computes. A case with speeds of its own has all or is not judged there. A statement
    of the file that the train does not run there makes a pass one with restrictions: `operation.highest`, a setting
    `use` of the rule, and of a rule up to the rated speed also speeds of its own of a case.
    """
    rated, speeds = study.operation.rated, study.operation.speeds
    if rated is None or speeds is None:
        yield check
        return
    demanded, limited = demanded_speed(study, scope)
    is_own = study.case is not None and study.case.has_own_speeds
    needed = demanded if is_own else min(demanded, rated.speed)
    ends = [speeds.first, speeds.last, *([] if speed is None else speed.tolist())]
    is_whole = min(ends) <= rated.speed * (1 + SAME_SPEED) and not coverage(max(ends), needed)
    if is_whole and not limited and use is not None and coverage(use.last, rated.speed):
        reach = Reach(use.first, use.last, rated.speed)
        words = reach_words(reach, rated.speed)
        yield restricted(check, words, reach) if check.verdict in ("pass", "restricted") else check
    elif is_whole:
        yield restricted(check, limited) if limited and check.verdict in ("pass", "restricted") else check
    else:
        reach = Reach(min(ends), max(ends), demanded)
        words = reach_words(reach, rated.speed)
        if is_own and scope <= 1.0:
            yield restricted(check, words, reach) if check.verdict in ("pass", "restricted") else check
        else:
            yield check
            end = "below" if words.startswith(BEGINS) else "above"
            what = f"{subject} {end} the computed speeds"
            yield replace(unjudged(check.rule, "speeds", check.where, what, words, check.standing), reach=reach)


def demanded_speed(study: Study, scope: float) -> tuple[float, str]:
    """rad/s up to which a rule demands, and in words what of the file keeps it below `scope` of the rated speed."""
    operation = study.operation
    whole = scope * (0.0 if operation.rated is None else operation.rated.speed)
    if operation.highest is None or operation.highest >= whole * (1 - SAME_SPEED):
        return whole, ""
    return operation.highest, f"speed limited to {in_rpm(operation.highest)} by {_keeper(operation.by)}"


def demanded_study(study: Study) -> Study | None:
    """Return the study of the speeds that rules demand above those of the operation; None where there are none.

    Of a file whose speeds hold the rated one: from there to the last speed of its rules, with their settings. A case
    with speeds of its own is meant for no others.
    """
    rated, speeds = study.operation.rated, study.operation.speeds
    if rated is None or speeds is None or (study.case is not None and study.case.has_own_speeds):
        return None
    if speeds.first > rated.speed * (1 + SAME_SPEED) or coverage(speeds.last, rated.speed):
        return None
    ends = {
        name: demanded_speed(study, getattr(rule, "scope", 1.0))[0]
        for (name, _), (rule, _) in zip(study.rules, of_study(study), strict=True)
    }
    short = {name: end for name, end in ends.items() if coverage(speeds.last, end)}
    if not short:
        return None
    step = (speeds.last - speeds.first) / (speeds.steps - 1)
    end = max(short.values())
    above = SpeedRange.model_construct(
        first=rated.speed, last=end, steps=max(2, math.ceil((end - rated.speed) / step) + 1)
    )
    operation = study.operation.model_copy(update={"speeds": above})
    rules = tuple((name, settings) for name, settings in study.rules if name in short)
    return replace(study, operation=operation, rules=rules, variations={}, cases={})


def _keeper(by: str | None) -> str:
    return "a limit that the file states" if by is None else by if by.startswith("the ") else f"the {by}"


def restricted(check: Check, words: str, reach: Reach | None = None) -> Check:
    """Return a check that is met as one that is met with a restriction, in words."""
    return replace(check, verdict="restricted", restrictions=(*check.restrictions, words), reach=reach or check.reach)


def distinct(checks: Iterable[Check]) -> tuple[Check, ...]:
    """Return the checks without the rows that several checks of a component have in common."""
    return tuple({(one.rule, one.clause, one.where, one.what, one.verdict): one for one in checks}.values())


def reach_words(reach: Reach | None, rated: float) -> str:
    """Which speeds were judged, where the rule demands more; empty where it does not."""
    if reach is None:
        return ""
    if reach.first > rated * (1 + SAME_SPEED):
        return f"{BEGINS} {in_rpm(reach.first)} only, {reach.first / rated:.3g} of the rated speed"
    return coverage(reach.last, rated, reach.demanded / rated)


def coverage(last: float, rated: float, needed: float = 1.0) -> str:
    """That the speeds end below a share of the rated speed up to which is judged; empty where they do not; rad/s."""
    if last >= needed * rated * (1 - SAME_SPEED):
        return ""
    return f"judged up to {in_rpm(last)} only, {last / rated:.3g} of the rated speed"


def in_rpm(speed: float) -> str:
    """A speed in words, per minute."""
    return f"{speed * 30.0 / math.pi:.5g} rpm"
