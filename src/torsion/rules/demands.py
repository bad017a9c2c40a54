"""What a rule demands of a file, speeds and states of the train: rows NOT JUDGED and restrictions where they lack."""

import math
from collections.abc import Container, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from torsion import fields
from torsion.analyses.power_balance import SAME_SPEED
from torsion.arrays import FloatArray
from torsion.fields import required
from torsion.results import listed
from torsion.rules import of_study
from torsion.rules.verdict_line import Check, Reach, Standing, restricted
from torsion.study import Range, SpeedRange, Study

if TYPE_CHECKING:
    from torsion.model.engine.record import EngineRecord
    from torsion.model.parts import Part

BARRED_BELOW = 0.8  # speed ratio below which barred ranges lie: who begins there, or above, looked at none of them
START = 0.2  # speed ratio: a judgement from there on has the start of the train (ours, the texts begin at 0): by the
# propeller law excitations are 4 % of the rated ones there, and UR M68 permits twice the stress
LAST_ORDER = {4: 12, 2: 15}  # of the crankshaft, up to which UR M53 has the synthesis; by strokes
MOST_ORDERS = 6  # stated one by one
FIRING, MISFIRE = "normal firing", "misfire"
ZERO_PITCH, STIFFNESS = "zero pitch", "other stiffness"


class SpeedsAbove(SpeedRange):
    """The speeds that rules demand above those of an operation."""

    begin: fields.Speed = required("lowest speed of the operation")


def with_reach(
    check: Check,
    study: Study,
    scope: float = 1.0,
    speed: FloatArray | None = None,
    use: Range | None = None,
    subject: str = "Vibration",
    *,
    begin: float = 1.0,
) -> Iterator[Check]:
    """Yield the check, and a row NOT JUDGED for either end at which its rule demands speeds that were not computed.

    The speeds of the operation, and those (speeds,) rad/s that were looked at, hold the rated speed; up to a share
    `scope` of it `demanded_study` computes. A case with speeds of its own has all or is not judged there. A statement
    of the file that the train does not run there makes a pass one with restrictions: `operation.highest`, a setting
    `use` of the rule, and of a rule up to the rated speed also speeds of its own of a case. So do speeds that begin
    above the share `begin` of the rated speed; that share is START for limits that hold while the train starts, which
    are not judged if the speeds begin where no barred range may lie.
    """
    rated, speeds, cut = study.operation.rated, study.operation.speeds, ""
    # Speeds of the operation that a setting of the rule leaves out.
    ends = [] if speeds is None else [speeds.first, speeds.last]
    ends += [] if rated is None else [rated.speed]
    if use is not None and ends:
        has_first = use.first <= min(ends) * (1 + SAME_SPEED)
        if not (has_first and use.last >= max(ends) * (1 - SAME_SPEED)):
            cut = f"judged in continuous use only, {in_rpm(use.first)} to {in_rpm(use.last)}"
    if rated is None or speeds is None:
        yield restricted(check, cut)
        return

    demanded, limited = demanded_speed(study, scope)
    is_own = study.case is not None and study.case.has_own_speeds
    computed = [speeds.first, speeds.last, *([] if speed is None else speed.tolist())]
    first, last, lacking = min(computed), max(computed), dict[str, Reach]()
    if isinstance(speeds, SpeedsAbove):
        first = speeds.begin

    # Above.
    reach = Reach(first, last, demanded)
    needed = demanded if is_own else min(demanded, rated.speed)
    if coverage(last, rated.speed, needed / rated.speed):
        if is_own and scope <= 1.0:
            check = restricted(check, reach_words(reach, rated.speed), reach=reach)
        else:
            lacking["above"] = reach
    elif use is not None and coverage(use.last, rated.speed):
        reach = Reach(use.first, use.last, rated.speed)
        check = restricted(check, reach_words(reach, rated.speed), reach=reach)
    check = restricted(check, limited, cut)

    # Below.
    from_start = Reach(first, last, 0.0)
    if first > begin * rated.speed * (1 + SAME_SPEED):
        has_rated = first <= rated.speed * (1 + SAME_SPEED)
        above_barred = first >= BARRED_BELOW * rated.speed * (1 - SAME_SPEED)
        lacks_barred = begin < BARRED_BELOW and above_barred
        is_stated = is_own and (has_rated or scope <= 1.0)
        if is_stated or (has_rated and not lacks_barred):
            check = restricted(check, reach_words(from_start, rated.speed))
        else:
            lacking["below"] = from_start
    yield check
    for side, reach in lacking.items():
        words, what = reach_words(reach, rated.speed), f"{subject} {side} the computed speeds"
        row = unjudged(check.rule, "speeds", check.where, what, words, check.standing)
        yield replace(row, reach=reach)


def demanded_speed(study: Study, scope: float) -> tuple[float, str]:
    """Return rad/s up to which a rule demands, and in words what of the file keeps it below `scope` of the rated speed.

    A train that can run above that share is judged up to its `highest` speed.
    """
    operation = study.operation
    demanded = scope * (0.0 if operation.rated is None else operation.rated.speed)
    highest = operation.highest
    if highest is None or highest >= demanded * (1 - SAME_SPEED):
        return max(demanded, highest or 0.0), ""
    keeper = operation.by or "a limit that the file states"
    if operation.by and not keeper.startswith("the "):
        keeper = f"the {keeper}"
    return highest, f"speed limited to {in_rpm(highest)} by {keeper}"


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
    ends = {rule.name: demanded_speed(study, rule.scope)[0] for rule in of_study(study)}
    short = {name: end for name, end in ends.items() if coverage(speeds.last, end)}
    if not short:
        return None
    step, end = (speeds.last - speeds.first) / (speeds.steps - 1), max(short.values())
    steps = max(2, math.ceil((end - rated.speed) / step) + 1)
    above = SpeedsAbove.model_construct(
        first=rated.speed, last=end, steps=steps, begin=speeds.first
    )
    operation = study.operation.model_copy(update={"speeds": above})
    rules = tuple((name, settings) for name, settings in study.rules if name in short)
    return replace(study, operation=operation, rules=rules, variations={}, cases={})


def distinct(checks: Iterable[Check]) -> tuple[Check, ...]:
    """Return the checks without the rows that several checks of a component have in common."""
    return tuple(
        {
            (check.rule, check.clause, check.where, check.what, check.verdict): check
            for check in checks
        }.values()
    )


def reach_words(reach: Reach, rated: float) -> str:
    """Return which speeds were judged, where the rule demands more; empty where it does not."""
    if reach.demanded < reach.first:
        share = f"{reach.first / rated:.3g} of the rated speed"
        return f"judged from {in_rpm(reach.first)} only, {share}"
    return coverage(reach.last, rated, reach.demanded / rated)


def coverage(last: float, rated: float, needed: float = 1.0) -> str:
    """Return that the speeds (rad/s) end below a share `needed` of the rated speed; empty where they do not."""
    if last >= needed * rated * (1 - SAME_SPEED):
        return ""
    return f"judged up to {in_rpm(last)} only, {last / rated:.3g} of the rated speed"


def in_rpm(speed: float) -> str:
    """Return a speed (rad/s) in words, per minute."""
    return f"{speed * 30.0 / math.pi:.5g} rpm"


def unjudged(
    rule: str,
    clause: str,
    where: str,
    what: str,
    note: str,
    standing: Standing = "rule text",
    unit: str = "",
) -> Check:
    """Return the row of a demand that could not be judged."""
    nan = math.nan
    return Check(rule, clause, where, what, nan, nan, unit, "not judged", standing, note=note)


def restriction(
    rule: str, clause: str, where: str, what: str, words: str, standing: Standing = "rule text"
) -> Check:
    """Return the row of a condition under which all checks of a rule stand, without a value or a limit."""
    row = unjudged(rule, clause, where, what, words, standing)
    return replace(row, verdict="restricted", restrictions=(words,))


def engines_of(study: Study) -> "list[EngineRecord]":
    """Return the engines of a train, in its order."""
    return [part.engine for part in study.train.parts if part.engine is not None]


def misfire_row(rule: str, study: Study, source: str) -> Iterator[Check]:
    """Yield a row for each engine that no case lets misfire, else for the first crankshaft; nothing of other trains."""
    names = unfailing_engines(rule, study)
    if not engines_of(study):
        shafts = ((part.name, part.shaft) for part in study.train.parts)
        names = [name for name, shaft in shafts if shaft is not None and shaft.role == "crank"][:1]
    for name in names:
        note = f"{source} demands it: `misfire: worst` of the engine, or a case with a cylinder that does not fire"
        yield unjudged(rule, MISFIRE, name, "Misfiring of one cylinder", note)


def unfailing_engines(rule: str, study: Study) -> list[str]:
    """Return the engines of which neither the study nor a case that the rule judges has a misfire."""
    names = (part.name for part in study.train.parts if part.engine is not None)
    misfiring = study.engines_with("motored")
    return [
        name for name in names if name not in misfiring and not study.covers(MISFIRE, rule, name)
    ]


def is_varied(study: Study, rule: str, part: "Part", what: str, tolerance: float) -> bool:
    """Return whether cases that the rule judges have a figure of a component at both ends of its tolerance.

    Without a tolerance any other value counts.
    """
    ends = ("lower", "upper") if tolerance else ("other",)
    return all(study.covers(f"{end} {what}", rule, part.name) for end in ends)


def lacking_orders(strokes: int, excited: Container[Fraction], where: str = "") -> str:
    """Return in words the orders of a crankshaft that UR M53 has in its synthesis and nothing excites; empty for none."""
    step = Fraction(2, strokes)  # an order a cycle of the engine
    orders = (step * k for k in range(1, int(LAST_ORDER[strokes] / step) + 1))
    lacking = [str(order) for order in orders if order not in excited]
    return f"orders {listed(lacking, most=MOST_ORDERS)}{where} do not excite" if lacking else ""


def order_rows(rule: str, study: Study, standing: Standing = "rule text") -> Iterator[Check]:
    """Yield a restriction for each engine whose gas excites by fewer orders than UR M53 has in its synthesis."""
    for part in study.train.parts:
        if part.engine is None:
            continue
        strokes, excited = 2 * part.engine.revolutions, part.engine.gas_orders
        if words := lacking_orders(strokes, excited, f" of {part.name}"):
            yield restriction(rule, "orders", part.name, "Orders of the synthesis", words, standing)


def unknown_gears(rule: str, study: Study, standing: Standing) -> Iterator[Check]:
    """Yield a row for each gear whose mesh is to be compared with a rated torque that the file does not give."""
    if study.operation.rated is None or not study.has_mean_torque:
        note = "the torque at the rated speed is not known: write `power` of `operation.rated`"
        for _, part in study.train.of_kind("gear"):
            yield unjudged(rule, "gears", part.name, "Vibratory torque in the mesh", note, standing)


def unjudged_variants(study: Study) -> Iterator[Check]:
    """Yield what no rule of the file judges: every cylinder firing, variants of a sweep, figures within tolerances."""
    if not study.rules:
        return
    failing = study.engines_with("motored", "cut out")
    for rule in of_study(study) if failing else ():
        if "response" in rule.needs and not study.covers(FIRING, rule.name):
            note = "only states in which a cylinder does not fire: state them as cases of the file that fires"
            row = unjudged(
                rule.name, FIRING, failing[0], "All cylinders firing", note, "by definition"
            )
            yield row
    first, sweep, judged = study.rules[0][0], study.analyses.get("sweep"), None
    if sweep is not None:
        from torsion.what_if.sweep.sweep_settings import SweepSettings

        judged = sweep if isinstance(sweep, SweepSettings) and sweep.judges(study) else None
        if judged is None:
            words = "variants of the sweep not judged: write `results: [checks]` of the sweep"
            about = first, "variants", "sweep", "Variants of the sweep"
            yield restriction(*about, words, "by definition")
    for what, subject, hint in (
        ("stiffness", "tolerances of", "write `cases: {from: tolerances}`"),
        ("inertia", "tolerances of the inertia of", "a sweep, or cases at both ends"),
    ):
        names = list[str]()
        for part in study.train.parts:
            width = part.stiffness_tolerance if part.kind == "coupling" else 0.0
            width = (part.inertia_tolerance or 0.0) if what == "inertia" else width
            # A sweep that names no figures varies all within their tolerances.
            is_swept = judged and (not judged.vary or f"{part.name}.{what}" in judged.vary)
            in_cases = (is_varied(study, rule, part, what, width) for rule, _ in study.rules)
            if width and not is_swept and not all(in_cases):
                names.append(part.name)
        if names:
            words = f"{subject} {', '.join(map(repr, names))} not judged: {hint}"
            about = first, "tolerances", names[0], f"{what.capitalize()} within the tolerances"
            yield restriction(*about, words, "by definition")
