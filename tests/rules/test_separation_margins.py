"""Natural frequencies away from every possible excitation: vectors, and two discs whose frequency is set by hand."""

import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion.rules import lacking, not_judged, rule, settings, verdicts
from torsion.rules.separation_margins import STANDARDS, list_excitations
from torsion.rules.verdict_line import Checks

J = 2.0
SPEEDS = {"from": "1000 rpm", "to": "1200 rpm"}
VECTORS = {
    vector["id"]: vector
    for vector in json.loads((Path(__file__).parent / "margin_oracles.json").read_text())["vectors"]
    if vector["id"].startswith("api-")
}


def discs(frequency, order=2):
    """Two equal discs of which the one elastic mode has so many Hz."""
    stiffness = J / 2 * (2 * math.pi * frequency) ** 2
    ripple = [{"order": order, "torque": 10.0}]
    return [
        ("motor", {"name": "motor", "inertia": J, "ripple": ripple}),
        ("coupling", {"stiffness": stiffness}),
        ("disc", {"inertia": J}),
    ]


@pytest.fixture
def judged(study, evidence):
    def run(name, frequency, order=2, **given):
        given = {"line_frequency": "none", **given}
        scene = study(
            discs(frequency, order),
            [(name, settings(name).model_validate(given))],
            speeds=SPEEDS,
            rated=None,
        )
        assert lacking(scene) == []
        checks = verdicts(evidence(scene, np.array([1000.0, 1200.0]), half={}))
        assert {(check.where, check.clause) for check in checks} == {("train", "separation")}
        return {
            check.order or check.what.removeprefix("Separation from "): check for check in checks
        }

    return run


@pytest.mark.parametrize("name", sorted(VECTORS.keys() - {"api-reach"}))
def test_margins_are_those_of_the_vectors(study, evidence, name) -> None:
    vector = VECTORS[name]
    given, expected = vector["input"], vector["expected"]
    parts = [("motor", {"inertia": 1.0}), ("coupling", {"stiffness": 1e4})]
    for ratio in given["ratios"][1:]:
        parts += [
            ("gear", {"ratio": 1 / Fraction(str(ratio)), "inertia": [0.1, 0.1]}),
            ("coupling", {"stiffness": 1e4}),
        ]
    stated = None if name == "api-without-line" else "none"
    if "line_Hz" in given:
        stated = {"nominal": f"{given['line_Hz']} Hz", "tolerance": given.get("line_band", 0.0)}
    requested = settings(vector["rule"]).model_validate({"line_frequency": stated})
    ends = dict(zip(("from", "to"), (f"{speed} rpm" for speed in given["range_rpm"]), strict=True))
    if ends["from"] == ends["to"]:  # a range has two ends
        ends["to"] = f"{given['range_rpm'][0] * (1 + 1e-12)!r} rpm"
    scene = study(
        [*parts, ("disc", {"inertia": 1.0})], [(vector["rule"], requested)], speeds=ends, rated=None
    )
    assembled = evidence(scene, given["range_rpm"], half={})
    modes = replace(assembled.results["modes"], frequency=np.array(given["modes_Hz"]))
    results = assembled.having(modes=modes)

    checks = {check.what.removeprefix("Separation from "): check for check in verdicts(results)}
    excitations = {
        one.name: one for one in list_excitations(results, requested, STANDARDS[vector["rule"]])
    }
    for row in expected["rows"]:
        words = re.sub(r"speed of shaft 1", "motor-1 speed", row["excitation"])
        words = re.sub(r"speed of shaft 2", "coupling-2 speed", words)
        words = words if words in checks else words.replace("coupling-2", "disc-1")
        check, excitation = checks.pop(words), excitations[words]
        assert check.value == pytest.approx(row["margin"], rel=1e-6, abs=1e-9)
        assert check.limit == row["required"]
        assert (check.verdict == "pass") == row["kept"]
        mode, hertz = re.match(r"mode (\d+), (\S+) Hz", check.note).groups()
        assert given["modes_Hz"][int(mode) - 1] == pytest.approx(float(hertz), rel=1e-4)
        assert (excitation.lowest, excitation.highest) == pytest.approx(
            (row["from_Hz"], row["to_Hz"]), rel=1e-6
        )
        assert excitation.reach == pytest.approx(row["needs modes up to_Hz"], rel=1e-6)
    left = [
        (check.what, check.verdict) for check in checks.values() if check.has_limit
    ]  # a ratio without teeth
    assert left == [("Separation from 1 x line frequency", "not judged")] * (
        name == "api-without-line"
    )


@pytest.mark.parametrize("name", ["api-610", "api-617", "api-684"])
@pytest.mark.parametrize("order", [1, 2, 7])
def test_ten_percent_of_every_order_on_both_sides(judged, name, order) -> None:
    low, high = 1000 / 60 * order, 1200 / 60 * order
    for frequency, verdict in (
        (low * 0.9 * (1 - 1e-6), "pass"),
        (low * 0.9 * (1 + 1e-6), "not kept"),
        (low, "not kept"),
        (high, "not kept"),
        (high * 1.1 * (1 - 1e-6), "not kept"),
        (high * 1.1 * (1 + 1e-6), "pass"),
    ):
        check = judged(name, frequency, order)[order]
        assert check.verdict == verdict
        assert check.what == f"Separation from {order} x motor speed"
        assert check.limit == 0.1
        assert check.at_least
        assert check.speed == pytest.approx(2 * math.pi * frequency / order, rel=1e-9)
        apart = max((low - frequency) / low, (frequency - high) / high, 0.0)
        assert check.value == pytest.approx(apart, rel=1e-6, abs=1e-9)
        assert ("stress analysis" in check.note) == (verdict != "pass")


def test_a_margin_at_its_limit_is_kept(judged) -> None:
    assert judged("api-617", 1000 / 60 * 0.9)[1].verdict == "pass"
    assert judged("api-617", 1200 / 60 * 1.1)[1].verdict == "pass"


def test_shaft_speeds_count_whether_they_excite_or_not(judged) -> None:
    assert set(judged("api-617", 500.0, 7)) == {1, 2, 7}
    assert set(judged("api-618", 500.0, 12)) == {*range(1, 11), 12}


def test_api_618_has_five_percent_above_the_first_multiple(judged) -> None:
    checks = judged("api-618", 1200 / 60 * 3 * 1.06, 3)
    assert (checks[3].limit, checks[3].verdict) == (0.05, "pass")
    assert checks[1].limit == 0.1
    assert judged("api-618", 1200 / 60 * 3 * 1.04, 3)[3].verdict == "not kept"


def test_line_frequency_counts_once_and_twice(judged) -> None:
    for frequency, kept in (
        (45.0 * (1 - 1e-6), True),
        (46.0, False),
        (54.0, False),
        (55.0 * (1 + 1e-6), True),
    ):
        checks = judged("api-617", frequency, line_frequency=50.0)
        assert checks["1 x line frequency"].verdict == ("pass" if kept else "not kept")
    assert (
        judged("api-617", 95.0, line_frequency="50 Hz")["2 x line frequency"].verdict == "not kept"
    )


ELECTRIC = {
    "motor: {inertia: 1}": True,
    "disc: {inertia: 1}": False,
}


@pytest.mark.parametrize(("machine", "is_electric"), ELECTRIC.items())
@pytest.mark.parametrize("role", ["", ", role: generator"])
def test_an_electric_machine_wants_a_line_frequency_or_none(machine, is_electric, role) -> None:
    text = f"""name: x
operation: {{speeds: {{from: 1000 rpm, to: 1200 rpm}}}}
train:
- {machine}
- shaft: {{length: 0.1, diameter: 100 mm{role}}}
- disc: {{inertia: 1}}
rules: [api-617RULE]
"""

    def run(words):
        findings = torsion.run(torsion.parse(text.replace("RULE", words)))
        return {check.verdict for check in findings.need(Checks).lines}, findings.exit_status

    assert run("") == (({"pass", "not judged"}, 1) if is_electric or role else ({"pass"}, 0))
    for words in (": {line_frequency: none}", ": {line_frequency: 60 Hz}"):
        assert run(words) == ({"pass"}, 0)


def test_the_operating_range_of_the_file_counts(judged) -> None:
    given = {"continuous": {"from": "1150 rpm", "to": "1200 rpm"}}
    assert judged("api-617", 17.0, **given)[1].verdict == "restricted"
    assert judged("api-617", 17.0)[1].verdict == "not kept"


def test_gears_make_shafts_of_other_speeds(study, evidence) -> None:
    parts = [*discs(500.0), ("gear", {"ratio": 4}), ("disc", {"inertia": 1.0})]
    scene = study(parts, [("api-617", settings("api-617")(line_frequency="none"))], speeds=SPEEDS)
    checks = verdicts(evidence(scene, np.array([1000.0, 1200.0]), half={}))
    assert {str(check.order): check.what for check in checks if check.has_limit} == {
        "1/4": "Separation from 1 x disc-2 speed",
        "1/2": "Separation from 2 x disc-2 speed",
        "1": "Separation from 1 x motor speed",
        "2": "Separation from 2 x motor speed",
    }


def test_the_speed_of_a_shaft_wants_its_ten_percent_though_it_is_three_times_another(
    study, evidence
) -> None:
    """API 618 has 5 % for multiples; the shaft between two gears has the name of what stands on it, not of a gear."""
    line = [
        *discs(500.0),
        ("gear", {"name": "up", "ratio": "1/3"}),
        ("coupling", {"name": "between", "stiffness": 1e6}),
        ("gear", {"name": "down", "ratio": 5}),
        ("disc", {"name": "slow", "inertia": 1.0}),
    ]
    scene = study(line, [("api-618", settings("api-618")(line_frequency="none"))], speeds=SPEEDS)
    checks = verdicts(evidence(scene, np.array([1000.0, 1200.0]), half={}))
    rows = {check.order: (check.what, check.limit) for check in checks if check.has_limit}
    assert rows[Fraction(3)] == ("Separation from 1 x between speed", 0.1)
    assert rows[Fraction(3, 5)] == ("Separation from 1 x slow speed", 0.1)
    assert rows[Fraction(6)] == ("Separation from 2 x between speed", 0.05)
    assert rows[Fraction(9, 5)] == ("Separation from 3 x slow speed", 0.05)


def test_teeth_and_blades_that_the_file_knows_are_judged(study, evidence) -> None:
    parts = [
        ("motor", {"inertia": 1.0}),
        ("gear", {"name": "pair", "teeth": [21, 63]}),
        ("coupling", {"stiffness": 1e4}),
        ("propeller", {"name": "screw", "inertia": 2.0, "blades": 5}),
    ]
    scene = study(parts, [("api-617", settings("api-617")(line_frequency="none"))], speeds=SPEEDS)
    checks = {
        check.what: check
        for check in verdicts(evidence(scene, np.array([1000.0, 1200.0]), half={}))
    }
    assert checks["Separation from gear mesh of pair"].order == 21
    assert checks["Separation from blade passing of screw"].order == Fraction(5, 3)
    assert not any("pair" in what or "screw" in what for what, _ in not_judged(scene))
    bare = study(
        [
            parts[0],
            ("gear", {"name": "pair", "ratio": 3}),
            parts[2],
            ("propeller", {"name": "screw", "inertia": 2.0}),
        ],
        scene.rules,
        speeds=SPEEDS,
    )
    rows = verdicts(evidence(bare, np.array([1000.0, 1200.0]), half={}))
    assert {(row.where, row.what) for row in rows if row.restrictions} == {
        ("pair", "Separation from gear mesh"),
        ("screw", "Separation from blade passing"),
    }


@pytest.mark.parametrize("sense", [-1, 1])
def test_a_mesh_behind_a_gear_counts_by_the_speed_of_its_own_shaft(study, evidence, sense) -> None:
    """30 teeth at 2/3 of 1000 to 1200 rpm are 333.3 to 400 Hz, whichever way the shaft turns."""
    parts = [
        ("motor", {"inertia": 1.0}),
        ("gear", {"ratio": "3/2", "sense": sense}),
        ("coupling", {"stiffness": 1e4}),
        ("gear", {"name": "second", "teeth": [30, 90]}),
        ("disc", {"inertia": 1.0}),
    ]
    scene = study(parts, [("api-617", settings("api-617")(line_frequency="none"))], speeds=SPEEDS)
    results = evidence(scene, np.array([1000.0, 1200.0]), half={})
    modes = replace(results.results["modes"], frequency=np.array([420.0, 1e4]))
    checks = {check.what: check for check in verdicts(results.having(modes=modes))}
    mesh = checks["Separation from gear mesh of second"]
    assert (mesh.order, mesh.verdict) == (20, "not kept")
    assert mesh.value == pytest.approx(0.05, rel=1e-9)
    assert mesh.speed == pytest.approx(2 * math.pi * 420.0 / 20, rel=1e-9)


def chain(count, inertia, highest):
    """Equal discs on equal springs, free: modes 2 sqrt(k/J) sin(k pi/2n), of which the highest has so many Hz."""
    root = 2 * math.pi * highest / (2 * math.sin((count - 1) * math.pi / (2 * count)))
    spring = ("coupling", {"stiffness": inertia * root**2})
    return [("disc", {"inertia": inertia}), *[spring, ("disc", {"inertia": inertia})] * (count - 1)]


@pytest.mark.parametrize(
    ("away", "verdict"), [(0.06, "not kept"), (0.1 - 1e-6, "not kept"), (0.1 + 1e-6, "pass")]
)
def test_modes_are_judged_up_to_the_margin_above_the_highest_excitation(
    study, evidence, away, verdict
) -> None:
    """Two modes are requested, and the third lies above twice the speed of 1500 rpm, 50 Hz."""
    requested = {"modes": torsion.analyses.undamped_modes.ModesSettings(count=2)}
    speeds = {"from": "1499.99999 rpm", "to": "1500 rpm"}
    parts = chain(4, 2.0, 50.0 * (1 + away))
    scene = study(
        parts, [("api-617", settings("api-617")())], speeds=speeds, analyses=requested, rated=None
    )
    results = evidence(scene, np.array([1500.0]), half={})
    results = results.having(modes=torsion.analyses.undamped_modes.modes(results.system, 2))
    check = {check.order: check for check in verdicts(results)}[2]
    assert (check.value, check.verdict) == (pytest.approx(away, rel=1e-6), verdict)
    assert check.note.startswith("mode 3")


@pytest.mark.parametrize("count", [1, 2, 6])
def test_all_modes_that_there_are_suffice(count) -> None:
    text = f"""name: x
operation: {{speeds: {{from: 1000 rpm, to: 1200 rpm}}}}
train:
- disc: {{inertia: 1}}
- coupling: {{stiffness: 1000}}
- disc: {{inertia: 1}}
analyses: {{modes: {{count: {count}}}}}
rules: [api-684]
"""
    findings = torsion.run(torsion.parse(text))
    assert {check.verdict for check in findings.need(Checks).lines} == {"pass"}
    assert findings.exit_status == 0


def test_modes_that_cannot_be_computed_are_not_judged() -> None:
    """A table ends at 30 Hz, and 44 Hz are judged."""
    text = """name: x
operation: {speeds: {from: 1000 rpm, to: 1200 rpm}}
train:
- disc: {inertia: 1}
- coupling: {table: {over: frequency, at: [1 Hz, END Hz], stiffness: [1000, 1000]}}
- disc: {inertia: 1}
rules: [api-617]
"""
    (first, second) = torsion.run(torsion.parse(text.replace("END", "30"))).need(Checks).lines
    assert (first.verdict, second.verdict) == ("pass", "not judged")
    assert "modes are known up to 30 Hz and are needed up to 44 Hz" in second.note
    findings = torsion.run(torsion.parse(text.replace("END", "44.0001")))
    assert {check.verdict for check in findings.need(Checks).lines} == {"pass"}


def test_names_of_checks_hold_no_number_of_a_sweep() -> None:
    """Every figure of the train varies, and the checks of all variants are those of the file."""
    text = """name: x
operation: {speeds: {from: 1000 rpm, to: 1200 rpm}}
train:
- motor: {name: m, inertia: 1}
- coupling: {name: soft, stiffness: 1000}
- gear: {name: pair, teeth: [20, 60]}
- disc: {name: d, inertia: 2}
rules: [api-684: {line_frequency: 50 Hz}]
analyses: {sweep: {vary: {soft.stiffness: {uniform: 30 %}, d.inertia: {uniform: 30 %}}, samples: 128}}
"""
    findings = torsion.run(torsion.parse(text))
    names = [check.what for check in findings.need(Checks).lines]
    assert sorted(one.what for one in findings.results["sweep"].checks) == sorted(names)
    assert sorted(names) == [
        "Separation from 1 x d speed",
        "Separation from 1 x line frequency",
        "Separation from 1 x m speed",
        "Separation from 2 x d speed",
        "Separation from 2 x line frequency",
        "Separation from 2 x m speed",
        "Separation from gear mesh of pair",
    ]


def test_what_is_not_judged_and_what_lacks(study) -> None:
    plain = settings("api-610")()
    scene = study(discs(100.0), [("api-610", plain)], speeds=None, rated=None)
    assert [fault.path for fault in lacking(scene)] == [("operation", "speeds")]
    assert "api-610: vane passing, harmonics of converters" in dict(not_judged(scene))
    assert rule("api-610").standard.edition.startswith("API 610")
