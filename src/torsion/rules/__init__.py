"""Rules: one a file, imported when a scene names it."""

from collections.abc import Iterator
from importlib import import_module
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from torsion.errors import Fault
    from torsion.findings import Results
    from torsion.rules.verdict_line import Check, Rule, RuleSettings
    from torsion.study import Study

RULES = {  # name in the file: class, and what it is made with
    "iacs-m68": "torsion.rules.m68:M68",
    "iacs-m53": "torsion.rules.m53:M53",
    "kr": "torsion.rules.societies:SocietyRule:kr",
    "lr": "torsion.rules.societies:SocietyRule:lr",
    "dnv": "torsion.rules.societies:SocietyRule:dnv",
    "abs": "torsion.rules.societies:SocietyRule:abs",
    "bv": "torsion.rules.societies:SocietyRule:bv",
    "ccs": "torsion.rules.societies:SocietyRule:ccs",
    "nk": "torsion.rules.societies:SocietyRule:nk",
    "rina": "torsion.rules.societies:SocietyRule:rina",
    "api-610": "torsion.rules.separation_margins:SeparationMargins:api-610",
    "api-617": "torsion.rules.separation_margins:SeparationMargins:api-617",
    "api-618": "torsion.rules.separation_margins:SeparationMargins:api-618",
    "api-684": "torsion.rules.separation_margins:SeparationMargins:api-684",
    "mil-std-167": "torsion.rules.mil_std_167:MilStd167",
    "engine-maker": "torsion.rules.engine_maker:EngineMaker",
    "nvh": "torsion.rules.noise_limits:NoiseLimits",
    "coupling-maker": "torsion.rules.coupling_maker:CouplingMaker",
    "gear-hammer": "torsion.rules.gear_hammer:GearHammer",
    "fillets": "torsion.rules.fillet_endurance:FilletEndurance",
    "shrink-fits": "torsion.rules.shrink_fits:ShrinkFits",
    "ice": "torsion.rules.ice_peaks:IcePeaks",
    "universal-joints": "torsion.rules.universal_joints:UniversalJoints",
}
STANDING = {  # result that a rule judges which needs no name in the file: class
    "response": "torsion.rules.stable_vibration:StableVibration",
    "stability": "torsion.rules.stable_motion:StableMotion",
    "lateral": "torsion.rules.stable_motion:StableBending",
    "transient": "torsion.rules.greatest_torque:GreatestTorque",
}


def rule(name: str) -> "Rule":
    """A rule by its name in the file; raises KeyError for a word that is no rule."""
    return _made(RULES[name])


def _made(place: str) -> "Rule":
    module, kind, *which = place.split(":")
    found: Rule = getattr(import_module(module), kind)(*which)
    return found


def settings(name: str) -> type["RuleSettings"]:
    """The class of a rule's settings; raises KeyError for a word that is no rule."""
    return rule(name).settings


def of_study(study: "Study") -> "Iterator[tuple[Rule, RuleSettings]]":
    """The rules that the study names, with their settings, in its order."""
    return ((rule(name), cast("RuleSettings", given)) for name, given in study.rules)


def needed(study: "Study") -> frozenset[str]:
    """The analyses that the study's rules read."""
    return frozenset(what for one, _ in of_study(study) for what in one.needs)


def lacking(study: "Study") -> list["Fault"]:
    """What the file lacks for its rules."""
    return [fault for one, given in of_study(study) for fault in one.faults(study, given)]


def not_judged(study: "Study") -> tuple[tuple[str, str], ...]:
    """What the study's rules do not judge, and why."""
    found = tuple(line for one, given in of_study(study) for line in one.left_out(study, given))
    limited = [
        part.name
        for part in study.train.parts
        if part.ratings is not None and part.ratings.limit_anything
    ]
    if study.rules and limited and "coupling-maker" not in dict(study.rules):
        found += (
            ("limits of " + ", ".join(limited), "the file does not name the rule `coupling-maker`"),
        )
    return found


def verdicts(evidence: "Results") -> tuple["Check", ...]:
    """The checks of every rule that the study names, in its order."""
    if evidence.study.train.has_tables_over("vibratory torque"):
        from torsion.rules.other_solutions import worst_of_solutions

        return worst_of_solutions(evidence, _judged)
    return _judged(evidence)


def standing_verdicts(evidence: "Results") -> tuple["Check", ...]:
    """The checks of the rules that hold wherever there is something for them to judge."""
    judged = [
        _made(place) for name, place in STANDING.items() if evidence.results.get(name) is not None
    ]
    return tuple(check for judging in judged for check in _checks(judging, evidence, None))


def _judged(evidence: "Results") -> tuple["Check", ...]:
    return tuple(
        check
        for judging, given in of_study(evidence.study)
        for check in _checks(judging, evidence, given)
    )


def _checks(
    judging: "Rule", evidence: "Results", given: "RuleSettings | None"
) -> "Iterator[Check]":
    """The checks of one rule, each with the basis of its limit."""
    from torsion.rules.verdict_line import with_basis

    verified = None if given is None else given.verified
    for check in judging.check(evidence, given):
        yield with_basis(check, judging.edition_of(check, evidence.study), verified)
