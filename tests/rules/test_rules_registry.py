"""Laws that hold for every rule of the registry."""

from dataclasses import FrozenInstanceError, is_dataclass
from importlib import import_module
from pkgutil import walk_packages

import numpy as np
import pytest
from tests.for_all import for_all

from torsion import rules
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.fields import Declared
from torsion.rules import RULES, lacking, needed, not_judged, rule, settings, verdicts
from torsion.rules.verdict_line import Rule, RuleSettings

SHRUNK = {
    "length": 0.03,
    "diameter": 0.15,
    "end": "last",
    "fit": "shrink",
    "pressure": 60e6,
    "friction": 0.15,
}
PARTS = [
    ("motor", {"inertia": 1.0, "ripple": [{"order": 2, "torque": 5.0}]}),
    (
        "coupling",
        {
            "name": "rubber",
            "stiffness": 2e4,
            "psi": 1.0,
            "vibratory_torque": 50.0,
            "max_torque": 90.0,
        },
    ),
    ("gear", {"name": "gearbox", "ratio": 2}),
    ("shaft", {"name": "crank", "length": 0.1, "diameter": 0.1, "role": "crank", "hub": SHRUNK}),
    ("disc", {"name": "wheel", "inertia": 1.0}),
    (
        "shaft",
        {
            "name": "seat",
            "length": 0.2,
            "diameter": 0.08,
            "step": {"fillet": 0.004},
            "endurance": 100e6,
        },
    ),
    ("shaft", {"name": "line", "length": 1.0, "diameter": 0.1, "role": "intermediate"}),
    ("joint", {"angle": "2 deg"}),
    ("propeller", {"name": "screw", "inertia": 2.0, "blades": 4}),
]
ICE = {"at": "screw", "ice": {"torque": 1.0, "case": 1}}
SIZES = {
    "pin": 0.2,
    "journal": 0.2,
    "pin_fillet": 0.012,
    "journal_fillet": 0.012,
    "web_thickness": 0.07,
}
THROW = {**SIZES, "web_width": 0.26, "radius": 0.14, "bending": 40e6, "shear": 5e6, "strokes": 4}
NEEDED = {
    "nvh": {"at": "wheel", "acceleration": 300.0},
    "engine-maker": {"crank_stress": "40 MPa"},
    "iacs-m53": THROW,
}
IN_ICE = {"transient": TransientSettings.model_validate({"duration": "10 s", "events": [ICE]})}


def stated(name):
    """Settings of a rule, of which some have limits that only the file knows."""
    return settings(name).model_validate(NEEDED.get(name, {}))


@for_all("name", RULES)
def test_every_rule_has_settings_with_defaults(name) -> None:
    assert rule(name).name == name
    assert issubclass(settings(name), Declared)
    assert settings(name)() == settings(name).model_validate({})
    assert settings(name).model_json_schema()["type"] == "object"


@for_all("name", RULES)
def test_every_rule_needs_analyses_and_finds_nothing_missing_in_a_whole_file(study, name) -> None:
    scene = study(PARTS, [(name, stated(name))], analyses=IN_ICE)
    assert needed(scene) <= {"modes", "steady", "response", "joints", "transient"}
    assert lacking(scene) == []
    assert all(len(line) == 2 for line in not_judged(scene))


@for_all("name", RULES)
def test_every_check_of_a_rule_carries_its_name(study, evidence, name) -> None:
    scene = study(PARTS, [(name, stated(name))], analyses=IN_ICE)
    found = verdicts(
        evidence(scene, np.array([500.0, 1000.0]), half={}, mean={"line": 1.0, "gearbox": 1.0})
    )
    assert found
    assert {check.rule for check in found} == {name}


def test_a_word_that_is_no_rule_is_a_key_error() -> None:
    with pytest.raises(KeyError):
        rule("iacs-m86")


def test_rules_are_judged_in_the_order_of_the_file(study, evidence) -> None:
    scene = study(PARTS, [(name, stated(name)) for name in reversed(RULES)], analyses=IN_ICE)
    found = verdicts(
        evidence(scene, np.array([500.0, 1000.0]), half={}, mean={"line": 1.0, "gearbox": 1.0})
    )
    assert list(dict.fromkeys(check.rule for check in found)) == list(reversed(RULES))


def test_a_rule_that_says_nothing_needs_and_finds_nothing() -> None:
    rule = Rule(RuleSettings())
    assert (rule.needs, rule.faults(None), rule.left_out(None), rule.speeds(None)) == (
        (),
        [],
        (),
        (),
    )
    assert rule.speeds_between(None).size == 0
    assert (rule.judge(None), rule.demanded_rows(None)) == ((), ())


def test_data_of_the_rules_cannot_be_changed() -> None:
    modules = [
        import_module(found.name) for found in walk_packages(rules.__path__, "torsion.rules.")
    ]
    data = {kind for module in modules for kind in vars(module).values() if isinstance(kind, type)}
    own = [
        kind for kind in data if is_dataclass(kind) and kind.__module__.startswith("torsion.rules.")
    ]
    assert {"Curve", "Clause", "Detail", "ClassedShaft", "Barring", "Tube"} <= {
        kind.__name__ for kind in own
    }
    for kind in own:
        with pytest.raises(FrozenInstanceError):
            object.__new__(kind).other = 1
