"""Rules: one a file, imported when a scene names it."""

from collections.abc import Callable, Iterable, Iterator
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from torsion.errors import Fault
    from torsion.fields import Declared
    from torsion.findings import Results
    from torsion.rules.verdict_line import Check, Rule, RuleSettings
    from torsion.study import Study

RULES = {  # name in the file: class
    "iacs-m68": "torsion.rules.class_rules.m68:M68",
    "iacs-m53": "torsion.rules.class_rules.m53:M53",
    "kr": "torsion.rules.class_rules.societies:EngineSocietyRule",
    "lr": "torsion.rules.class_rules.societies:LloydsRule",
    "dnv": "torsion.rules.class_rules.societies:SocietyRule",
    "abs": "torsion.rules.class_rules.societies:SocietyRule",
    "bv": "torsion.rules.class_rules.societies:SocietyRule",
    "ccs": "torsion.rules.class_rules.societies:SocietyRule",
    "nk": "torsion.rules.class_rules.societies:EngineSocietyRule",
    "rina": "torsion.rules.class_rules.societies:SocietyRule",
    "api-610": "torsion.rules.separation_margins:SeparationMargins",
    "api-617": "torsion.rules.separation_margins:SeparationMargins",
    "api-618": "torsion.rules.separation_margins:SeparationMargins",
    "api-684": "torsion.rules.separation_margins:SeparationMargins",
    "mil-std-167": "torsion.rules.mil_std_167:MilStd167",
    "engine-maker": "torsion.rules.engine_maker:EngineMaker",
    "nvh": "torsion.rules.noise_limits:NoiseLimits",
    "coupling-maker": "torsion.rules.coupling_maker:CouplingMaker",
    "gear-hammer": "torsion.rules.strength.gear_hammer:GearHammer",
    "fillets": "torsion.rules.strength.fillet_endurance:FilletEndurance",
    "shrink-fits": "torsion.rules.strength.shrink_fits:ShrinkFits",
    "ice": "torsion.rules.class_rules.ice_peaks:IcePeaks",
    "universal-joints": "torsion.rules.universal_joints:UniversalJoints",
}
STANDING: dict[str, tuple[str, Callable[["Results"], bool]]] = {
    # Result that a rule judges which needs no name in the file: class, and whether it has anything to judge.
    "response": (
        "torsion.rules.stable_vibration:StableVibration",
        lambda evidence: any(damper.may_drive for damper in evidence.system.dampers),
    ),
    "stability": ("torsion.rules.stable_motion:StableMotion", lambda evidence: True),
    "lateral": ("torsion.rules.stable_motion:StableBending", lambda evidence: True),
    "transient": (
        "torsion.rules.strength.greatest_torque:GreatestTorque",
        lambda evidence: (
            any(part.limits_torque for part in evidence.study.train.parts)
            or any(motion.damage is not None for motion in evidence.results["transient"].each)
        ),
    ),
}


def rule(name: str, settings: "Declared | None" = None) -> "Rule[Any]":
    """Return a rule with its settings of the file, or with their defaults; raises KeyError for a word that is no rule."""
    kind: type[Rule[Any]] = resolve_name(RULES[name])
    return kind(kind.settings_class() if settings is None else settings, name)


def settings(name: str) -> type["RuleSettings"]:
    """Return the class of a rule's settings; raises KeyError for a word that is no rule."""
    kind: type[Rule[Any]] = resolve_name(RULES[name])
    return kind.settings_class


def of_study(study: "Study") -> "Iterator[Rule[Any]]":
    """Yield the rules that the study names, with their settings, in its order."""
    return (rule(name, settings) for name, settings in study.rules)


def needed(study: "Study") -> frozenset[str]:
    """Return the analyses that the study's rules read."""
    return frozenset(analysis for rule in of_study(study) for analysis in rule.needs)


def lacking(study: "Study") -> list["Fault"]:
    """Return what the file lacks for its rules."""
    return [fault for rule in of_study(study) for fault in rule.faults(study)]


def not_judged(study: "Study") -> tuple[tuple[str, str], ...]:
    """Return what the study's rules do not judge, and why."""
    rows = tuple(row for rule in of_study(study) for row in rule.left_out(study))
    limited = [
        part.name
        for part in study.train.parts
        if part.ratings is not None and part.ratings.limit_anything
    ]
    if study.rules and limited and "coupling-maker" not in dict(study.rules):
        why = "the file does not name the rule `coupling-maker`"
        rows += ((f"limits of {', '.join(limited)}", why),)
    return rows


def verdicts(evidence: "Results") -> tuple["Check", ...]:
    """Return the checks of every rule that the study names, in its order."""
    rules = tuple(of_study(evidence.study))
    if evidence.study.train.has_tables_over("vibratory torque"):
        from torsion.rules.class_rules.supplements import worst_of_solutions

        return worst_of_solutions(evidence, lambda solution: _checks(rules, solution))
    return _checks(rules, evidence)


def standing_verdicts(evidence: "Results") -> tuple["Check", ...]:
    """Return the checks of the rules that hold wherever there is something for them to judge."""
    kinds: list[type[Rule[Any]]] = [
        resolve_name(target)
        for name, (target, has_any) in STANDING.items()
        if evidence.results.get(name) is not None and has_any(evidence)
    ]
    return _checks([kind(kind.settings_class()) for kind in kinds], evidence)


def _checks(rules: "Iterable[Rule[Any]]", evidence: "Results") -> tuple["Check", ...]:
    """Return the checks of rules, each with the basis of its limit.

    None passes if a clutch taken as stuck slips, or plainly if torques between ends of long elements are not known.
    """
    from torsion.rules.verdict_line import with_basis

    checks: Iterable[tuple[Rule[Any], Check]] = (
        (rule, check) for rule in rules for check in rule.check(evidence)
    )
    study = evidence.study
    if study.model != "lumped" or any(part.is_clutch for part in study.train.parts):
        from torsion.rules.model_conditions import conditioned

        checks = conditioned(checks, evidence)
    return tuple(
        with_basis(check, rule.edition_of(check, evidence.study), rule.settings.verified)
        for rule, check in checks
    )
