"""States of the train that a rule demands, as rows NOT JUDGED where neither the file nor a case of it has them."""

import math
from collections.abc import Iterator

from torsion.analyses.sweep.sweep_settings import SweepSettings
from torsion.rules.verdict_line import Check, Standing
from torsion.study import Study

MISFIRE, ZERO_PITCH, STIFFNESS = "misfire", "zero pitch", "other stiffness"


def unjudged(rule: str, clause: str, where: str, what: str, note: str, standing: Standing = "rule text") -> Check:
    """Return the row of a demand that could not be judged."""
    return Check(rule, clause, where, what, math.nan, math.nan, "", "not judged", standing, note=note)


def misfire_row(rule: str, study: Study, source: str, standing: Standing = "rule text") -> Iterator[Check]:
    """Yield the row about one cylinder that does not fire; nothing of a train without an engine."""
    engines = [part for part in study.train.parts if part.engine is not None]
    cranks = [part for part in study.train.parts if part.shaft is not None and part.shaft.role == "crank"]
    if not (engines or cranks) or study.covers(MISFIRE, rule):
        return
    records = [part.engine for part in engines if part.engine is not None]
    if any(one.tries_all or any(cylinder.state != "firing" for cylinder in one.cylinders) for one in records):
        return
    note = f"{source} demands it: `misfire: worst` of the engine, or a case with a cylinder that does not fire"
    yield unjudged(rule, MISFIRE, (engines or cranks)[0].name, "Misfiring of one cylinder", note, standing)


def zero_pitch_rows(rule: str, study: Study, source: str, standing: Standing = "rule text") -> Iterator[Check]:
    """Yield a row for each propeller: NOT JUDGED of a controllable pitch, a restriction if the pitch is not stated.

    A `propeller` of a train without a shaft of that role may be any load.
    """
    drives_ship = any(part.shaft is not None and part.shaft.role == "propeller" for part in study.train.parts)
    for part in study.train.parts:
        if part.kind != "propeller" or part.propeller is None or part.propeller.pitch == "fixed":
            continue
        if study.covers(ZERO_PITCH, rule):
            continue
        if part.propeller.pitch == "controllable":
            note = f"{source} demands it: a case with another `operation.load`"
            yield unjudged(rule, ZERO_PITCH, part.name, "Zero pitch", note, standing)
        elif drives_ship:
            words = f"fixed pitch of '{part.name}' assumed: the file does not state `pitch`"
            yield Check(
                rule, ZERO_PITCH, part.name, "Zero pitch", math.nan, math.nan, "", "restricted", standing,
                note=words, restrictions=(words,),
            )  # fmt: skip


def unjudged_variants(study: Study) -> Iterator[Check]:
    """Yield a restriction if no rule of the file judges the variants of a sweep, or stiffnesses within tolerances."""
    if not study.rules:
        return
    sweep = study.analyses.get("sweep")
    judged = sweep if isinstance(sweep, SweepSettings) and sweep.judges(study) else None
    if sweep is not None and judged is None:
        words = "variants of the sweep not judged: write `results: [checks]` of the sweep"
        yield _restriction(study.rules[0][0], "variants", "sweep", "Variants of the sweep", words)
    has_corners = study.varies_tolerances or any(STIFFNESS in case.states for case in study.case_states)
    names = [part.name for part in study.train.parts if part.kind == "coupling" and part.stiffness_tolerance]
    if judged is not None:  # one that names no figures varies all within their tolerances
        names = [name for name in names if judged.vary and f"{name}.stiffness" not in judged.vary]
    if names and study.has_tolerances and not has_corners:
        words = f"tolerances of {', '.join(map(repr, names))} not judged: write `cases: {{from: tolerances}}`"
        yield _restriction(study.rules[0][0], "tolerances", names[0], "Stiffness within the tolerances", words)


def _restriction(rule: str, clause: str, where: str, what: str, words: str) -> Check:
    return Check(
        rule, clause, where, what, math.nan, math.nan, "", "restricted", "by definition", note=words,
        restrictions=(words,),
    )  # fmt: skip


def stiffness_row(rule: str, study: Study, standing: Standing) -> Iterator[Check]:
    """Yield the row about couplings at another stiffness than the nominal one; nothing without rated couplings."""
    rated = [part.name for part in study.train.parts if part.kind == "coupling" and part.ratings is not None]
    is_corner = study.case is not None and study.case.is_corner
    if rated and not (is_corner or study.covers(STIFFNESS, rule)):
        note = "cold, warm, soft and stiff couplings: cases with another stiffness, or `cases: {from: tolerances}`"
        yield unjudged(rule, STIFFNESS, rated[0], "Other stiffness of the couplings", note, standing)
