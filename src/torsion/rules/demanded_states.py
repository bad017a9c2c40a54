"""States of the train that a rule demands, as rows NOT JUDGED where neither the file nor a case of it has them."""

import math
from collections.abc import Container, Iterator
from dataclasses import replace
from fractions import Fraction

from torsion.results import listed
from torsion.rules.verdict_line import Check, Standing
from torsion.study import Study

LAST_ORDER = {4: 12, 2: 15}  # of the crankshaft, up to which UR M53 has the synthesis; by strokes
MOST_ORDERS = 6  # stated one by one
MISFIRE, ZERO_PITCH, STIFFNESS = "misfire", "zero pitch", "other stiffness"


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


def misfire_row(rule: str, study: Study, source: str) -> Iterator[Check]:
    """Yield the row about one cylinder that does not fire; nothing of a train without an engine."""
    engines, cranks = list[str](), list[str]()
    for part in study.train.parts:
        if part.engine is not None:
            engines.append(part.name)
            is_motored = any(cylinder.state == "motored" for cylinder in part.engine.cylinders)
            if part.engine.tries_all or is_motored:
                return
        if part.shaft is not None and part.shaft.role == "crank":
            cranks.append(part.name)
    if not (engines or cranks) or study.covers(MISFIRE, rule):
        return
    note = f"{source} demands it: `misfire: worst` of the engine, or a case with a cylinder that does not fire"
    where = (engines or cranks)[0]
    yield unjudged(rule, MISFIRE, where, "Misfiring of one cylinder", note)


def lacking_orders(strokes: int, excited: Container[Fraction]) -> list[Fraction]:
    """Return the orders of a crankshaft that UR M53 has in its synthesis and that nothing excites, ascending."""
    step = Fraction(2, strokes)  # an order a cycle of the engine
    orders = (step * k for k in range(1, int(LAST_ORDER[strokes] / step) + 1))
    return [order for order in orders if order not in excited]


def orders_words(lacking: list[Fraction], where: str = "") -> str:
    """Return the orders that do not excite, the first of them, in words."""
    return f"orders {listed(map(str, lacking), most=MOST_ORDERS)}{where} do not excite"


def order_rows(rule: str, study: Study, standing: Standing = "rule text") -> Iterator[Check]:
    """Yield a restriction for each engine whose gas excites by fewer orders than UR M53 has in its synthesis."""
    for part in study.train.parts:
        if part.engine is None:
            continue
        if lacking := lacking_orders(2 * part.engine.revolutions, part.engine.gas_orders):
            words = orders_words(lacking, f" of {part.name}")
            yield restriction(rule, "orders", part.name, "Orders of the synthesis", words, standing)


def unknown_gears(rule: str, study: Study, standing: Standing) -> Iterator[Check]:
    """Yield a row for each gear whose mesh is to be compared with a rated torque that the file does not give."""
    if study.operation.rated is None or not study.has_mean_torque:
        note = "the torque at the rated speed is not known: write `power` of `operation.rated`"
        for _, part in study.train.of_kind("gear"):
            yield unjudged(rule, "gears", part.name, "Vibratory torque in the mesh", note, standing)


def zero_pitch_rows(rule: str, study: Study, source: str) -> Iterator[Check]:
    """Yield a row for each propeller: NOT JUDGED of a controllable pitch, a restriction if the pitch is not stated.

    A `propeller` of a train without a shaft of that role may be any load.
    """
    drives_ship = any(
        part.shaft is not None and part.shaft.role == "propeller" for part in study.train.parts
    )
    for part in study.train.parts:
        if part.kind != "propeller" or part.propeller is None or part.propeller.pitch == "fixed":
            continue
        if study.covers(ZERO_PITCH, rule):
            continue
        if part.propeller.pitch == "controllable":
            note = f"{source} demands it: a case with another `operation.load`"
            yield unjudged(rule, ZERO_PITCH, part.name, "Zero pitch", note)
        elif drives_ship:
            words = f"fixed pitch of '{part.name}' assumed: the file does not state `pitch`"
            yield restriction(rule, ZERO_PITCH, part.name, "Zero pitch", words)


def unjudged_variants(study: Study) -> Iterator[Check]:
    """Yield a restriction if no rule of the file judges the variants of a sweep, or stiffnesses within tolerances."""
    if not study.rules:
        return
    sweep = study.analyses.get("sweep")
    judged = None
    if sweep is not None:
        from torsion.what_if.sweep.sweep_settings import SweepSettings

        judged = sweep if isinstance(sweep, SweepSettings) and sweep.judges(study) else None
    if sweep is not None and judged is None:
        words = "variants of the sweep not judged: write `results: [checks]` of the sweep"
        first = study.rules[0][0]
        what = "Variants of the sweep"
        yield restriction(first, "variants", "sweep", what, words, "by definition")
    has_corners = study.varies_tolerances or any(
        STIFFNESS in case.states for case in study.case_states
    )
    names = [
        part.name
        for part in study.train.parts
        if part.kind == "coupling" and part.stiffness_tolerance
    ]
    if judged is not None:  # one that names no figures varies all within their tolerances
        names = [name for name in names if judged.vary and f"{name}.stiffness" not in judged.vary]
    if names and study.has_tolerances and not has_corners:
        words = f"tolerances of {', '.join(map(repr, names))} not judged: write `cases: {{from: tolerances}}`"
        first, what = study.rules[0][0], "Stiffness within the tolerances"
        yield restriction(first, "tolerances", names[0], what, words, "by definition")


def stiffness_row(rule: str, study: Study, standing: Standing) -> Iterator[Check]:
    """Yield the row about couplings at another stiffness than the nominal one; nothing without rated couplings."""
    rated = [
        part.name
        for part in study.train.parts
        if part.kind == "coupling" and part.ratings is not None
    ]
    is_corner = study.case is not None and study.case.is_corner
    if rated and not (is_corner or study.covers(STIFFNESS, rule)):
        note = "cold, warm, soft and stiff couplings: cases with another stiffness, or `cases: {from: tolerances}`"
        yield unjudged(
            rule, STIFFNESS, rated[0], "Other stiffness of the couplings", note, standing
        )
