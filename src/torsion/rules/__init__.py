"""Rules: one a file, imported when a scene asks for it."""

from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

from torsion.fields import Declared

if TYPE_CHECKING:
    from torsion.errors import Fault
    from torsion.kernels.tree import FloatArray
    from torsion.rules.check import Check
    from torsion.rules.evidence import Evidence
    from torsion.study import Study

RULES = {
    "iacs-m68": "torsion.rules.m68:Asked",
    "coupling-maker": "torsion.rules.coupling:Asked",
    "gear-hammer": "torsion.rules.gear:Asked",
    "universal-joints": "torsion.rules.universal_joints:Asked",
}


class Rule(Protocol):
    """What the module of a rule offers."""

    def needs(self, asked: Declared) -> tuple[str, ...]:
        """The analyses that it reads."""

    def faults(self, study: "Study", asked: Declared) -> list["Fault"]:
        """What the file lacks."""

    def left_out(self, study: "Study", asked: Declared) -> tuple[tuple[str, str], ...]:
        """What it does not judge, and why."""

    def check(self, evidence: "Evidence", asked: Declared) -> tuple["Check", ...]:
        """Its verdicts."""


class VibrationRule(Rule, Protocol):
    """What the module of a rule offers that reads the response over speed."""

    def speeds(self, study: "Study", asked: Declared) -> tuple[float, ...]:
        """Speeds (rad/s of the reference station) that must be computed, where they lie in the range."""

    def speeds_between(self, evidence: "Evidence", asked: Declared) -> "FloatArray":
        """(speeds,) rad/s between those computed at which it may find more."""


def rule(name: str) -> Rule:
    """The module of a rule; raises KeyError for a word that is no rule."""
    return cast(Rule, import_module(RULES[name].split(":")[0]))


def settings(name: str) -> type[Declared]:
    """The class of a rule's settings; raises KeyError for a word that is no rule."""
    module, word = RULES[name].split(":")
    return cast(type[Declared], getattr(import_module(module), word))


def needed(study: "Study") -> frozenset[str]:
    """The analyses that the study's rules read."""
    return frozenset(what for name, asked in study.rules for what in rule(name).needs(asked))


def lacking(study: "Study") -> list["Fault"]:
    """What the file lacks for its rules."""
    return [fault for name, asked in study.rules for fault in rule(name).faults(study, asked)]


def not_judged(study: "Study") -> tuple[tuple[str, str], ...]:
    """What the study's rules do not judge, and why."""
    return tuple(line for name, asked in study.rules for line in rule(name).left_out(study, asked))


def verdicts(evidence: "Evidence") -> tuple["Check", ...]:
    """The checks of every rule that the study asks for, in its order."""
    return tuple(line for name, asked in evidence.study.rules for line in rule(name).check(evidence, asked))
