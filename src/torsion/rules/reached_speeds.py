"""Speeds that a rule demands and that were computed: its rows NOT JUDGED, and its restrictions, where they differ."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

from torsion.analyses.speed_tables import SAME_SPEED
from torsion.arrays import FloatArray
from torsion.rules.verdict_line import Check, Reach
from torsion.study import Range, Study

BEGINS = "judged from"  # a speed above the rated one


def with_reach(
    check: Check, study: Study, scope: float = 1.0, speed: FloatArray | None = None,
    use: Range | None = None, subject: str = "Vibration",
) -> Iterator[Check]:  # fmt: skip
    """Yield the check, and a row NOT JUDGED where its rule demands speeds that were not computed.

    The speeds of the operation, and those (speeds,) rad/s that were looked at, hold the rated speed and all up to a
    share `scope` of it. A statement of the file that the train does not run there makes a pass one with restrictions:
    a setting `use` of the rule, or speeds of its own of a case.
    """
    rated, speeds = study.operation.rated, study.operation.speeds
    if rated is None or speeds is None:
        yield check
        return
    ends = [speeds.first, speeds.last, *([] if speed is None else speed.tolist())]
    has_rated = min(ends) <= rated.speed * (1 + SAME_SPEED) and not coverage(max(ends), rated.speed)
    reach = Reach(min(ends), max(ends), scope * rated.speed)
    if has_rated and use is not None and coverage(use.last, rated.speed):
        reach = Reach(use.first, use.last, rated.speed)
    words = reach_words(reach, rated.speed)
    if not words:
        yield check
    elif has_rated or (study.case is not None and study.case.has_own_speeds):
        yield restricted(check, words, reach) if check.verdict in ("pass", "restricted") else check
    else:
        yield check
        end = "below" if words.startswith(BEGINS) else "above"
        yield Check(
            check.rule, "speeds", check.where, f"{subject} {end} the computed speeds", math.nan, math.nan, "",
            "not judged", check.standing, note=words, reach=reach, parts=check.parts,
        )  # fmt: skip


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
