"""Rule `ice`: greatest torques in ice against yield and ratings; ratings of makers by how rare a motion is."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import torsion
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.rules import standing_verdicts, verdicts
from torsion.rules.verdict_line import Check, Checks

SCENE = """name: x
materials: {{tough: {{shear_modulus: 79.3 GPa, density: 7850, yield_strength: {strength}}}}}
operation: {{rated: {{speed: 720 rpm, power: 1.5 MW}}}}
train:
- motor: {{inertia: 1500}}
- coupling: {{name: rubber, stiffness: 250e3, loss_factor: 0.15, {rubber}}}
- gear: {{name: bevel, teeth: [13, 47], inertia: [2.1, 38], {bevel}}}
- shaft: {{name: line, length: 1.6 m, diameter: 260 mm, segments: 1, material: tough}}
- shaft: {{name: plain, length: 0.1 m, diameter: 300 mm, segments: 1}}
- propeller: {{name: screw, inertia: 525, blades: 4}}
analyses: {{transient: [{motions}]}}
rules: [{rule}]
"""
GIVEN = {
    "strength": "355 MPa",
    "rubber": "max_torque: 60e3",
    "bevel": "max_torque: 75e3",
    "rule": "ice",
}


def motion(case: str = "case: 1", torque: float = 100e3, name: str = "hit", more: str = "") -> str:
    ice = f"{{at: screw, time: 0.1 s, ice: {{torque: {torque!r}, {case}, turns: 2}}}}"
    return f"{{name: {name}, duration: 0.8 s, {more} events: [{ice}]}}"


def scene(motions: str = motion(), **changed: str) -> str:
    return SCENE.format(**{**GIVEN, "motions": motions, **changed})


@cache
def run(text: str) -> Findings:
    """Solved once for each text."""
    return torsion.run(torsion.parse(text))


def ice_checks(found: Findings) -> dict[str, Check]:
    lines = found.need(Checks).lines
    return {
        check.where: check
        for check in lines
        if check.rule == "ice" and check.verdict != "not judged"
    }


def open_rows(found: Findings) -> dict[tuple[str, str], str]:
    """Notes of the rows NOT JUDGED by clause and component."""
    lines = found.need(Checks).lines
    return {
        (check.clause, check.where): check.note for check in lines if check.verdict == "not judged"
    }


@pytest.fixture(scope="module")
def solved() -> Findings:
    """Ice of 100 kN m in case 1."""
    return run(scene())


def test_a_shaft_is_judged_by_the_shear_stress_at_its_greatest_torque(solved: Findings) -> None:
    check, (one,) = ice_checks(solved)["line"], solved.need(Transients).each
    line = [k for k, span in enumerate(solved.system.spans) if span.name.startswith("line")]
    torque = max(np.abs(one.torque[line]).max(), 0.0)
    assert check.value == pytest.approx(
        torque / (math.pi * 0.26**3 / 16.0) * 1e-6, rel=1e-3
    )  # between samples: more
    assert check.value >= torque / (math.pi * 0.26**3 / 16.0) * 1e-6
    assert check.limit == pytest.approx(355.0 / math.sqrt(3.0) / 1.3, rel=1e-14)
    assert (check.clause, check.unit, check.verdict) == ("0.577 R_e/1.3", "N/mm2", "pass")
    assert check.standing == "to be verified"


def test_couplings_and_gears_are_judged_by_their_greatest_torque(solved: Findings) -> None:
    found, (one,) = ice_checks(solved), solved.need(Transients).each
    assert list(found) == ["rubber", "bevel", "line"]
    assert [found[name].limit for name in ("rubber", "bevel")] == [60e3, 75e3]
    for name, place in (("rubber", 0), ("bevel", 1)):
        assert found[name].value == pytest.approx(np.abs(one.torque[place]).max(), rel=1e-3)
    assert (found["rubber"].clause, found["bevel"].clause) == ("T_Kmax", "T_max")
    assert {check.verdict for check in found.values()} == {"pass"}


def test_twice_the_ice_torque_is_not_kept() -> None:
    """A rating of a maker fails; the yield of a shaft is to be verified, as the factor of its rule is."""
    once, twice = (
        run(scene(motion(torque=torque), strength="145 MPa")) for torque in (100e3, 200e3)
    )
    assert {check.verdict for check in ice_checks(once).values()} == {"pass"}
    found = {where: (check.verdict, check.standing) for where, check in ice_checks(twice).items()}
    assert found.pop("line") == ("not kept", "to be verified")
    assert found == {"rubber": ("fail", "maker"), "bevel": ("fail", "maker")}
    assert (once.failed, twice.failed) == (False, True)


def test_the_worst_of_the_motions_decides_and_is_named() -> None:
    cases = [motion(f"case: {case}", name=f"of {case}") for case in (1, 4)]
    together = ice_checks(run(scene(", ".join(cases))))
    apart = [ice_checks(run(scene(one))) for one in cases]
    for name, check in together.items():
        assert check.value == max(one[name].value for one in apart)
        assert check.note.startswith("worst in case 1 (of 1); cases 2, 3 at screw not judged")


def test_a_rating_is_compared_once_with_the_motions_in_ice() -> None:
    """By the rule `ice` at their worst; a range of torque, and motions without ice, by the rule on any motion."""
    step = "{name: no ice, duration: 0.1 s, events: [{at: motor-1, step: {torque: 10}}]}"
    lines = (
        run(scene(f"{motion()}, {step}", rubber="max_torque: 60e3, max_torque_range: 50e3"))
        .need(Checks)
        .lines
    )
    found = sorted(
        (check.rule, check.where, check.clause)
        for check in lines
        if check.where in ("rubber", "bevel")
    )
    assert found == [
        ("ice", "bevel", "T_max"),
        ("ice", "rubber", "T_Kmax"),
        ("transient", "bevel", "T_max, no ice"),
        ("transient", "rubber", "T_Kmax, no ice"),
        ("transient", "rubber", "dT_max, hit"),
        ("transient", "rubber", "dT_max, no ice"),
    ]
    bare = run(scene(f"{motion()}, {step}").replace("rules: [ice]\n", "")).need(Checks).lines
    assert ("rubber", "T_Kmax, hit") in [(check.where, check.clause) for check in bare]


def test_what_is_not_judged_is_said(solved: Findings) -> None:
    left_out = dict(solved.plan.left_out)
    rows = open_rows(solved)
    assert rows["cases", "screw"] == "no motion has cases 2, 3, 4"
    assert rows["yield", "plain"] == "not judged: give `yield_strength` of its material"
    assert solved.exit_status == 1
    assert "ice for fatigue and for failure of a blade" in left_out
    less = dict(run(scene(rubber="max_torque_range: 9e9", bevel="")).plan.left_out)
    assert less["ice for rubber"] == less["ice for bevel"] == "not judged: give `max_torque`"
    every = ", ".join(motion(f"case: {case}", name=f"of {case}") for case in (1, 2, 3, 4))
    assert ("cases", "screw") not in open_rows(run(scene(every)))


def test_contact_of_the_file_is_judged_and_no_case_is_counted() -> None:
    check = ice_checks(run(scene(motion("angle: 60 deg, factor: 0.5"))))["line"]
    assert check.note.startswith(
        "worst in contact over 60 deg (hit); cases 1, 2, 3, 4 at screw not judged"
    )


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_the_safety_factor_is_a_setting(factor: float) -> None:
    check = ice_checks(run(scene(rule=f"ice: {{factor: {factor}}}")))["line"]
    assert check.limit == pytest.approx(355.0 / math.sqrt(3.0) / factor, rel=1e-14)
    assert check.clause == f"0.577 R_e/{factor:g}"


def changed(found: Findings, **values: object) -> dict[str, Check]:
    """The checks where something of the motion is another."""
    (one,) = found.need(Transients).each
    having = found.having(transient=Transients((replace(one, **values),)))
    return {check.where: check for check in verdicts(having) if check.verdict != "not judged"}


def test_a_motion_that_is_not_ok_never_passes(solved: Findings) -> None:
    found = changed(solved, residual=1.0)
    assert {check.verdict for check in found.values()} == {"fail"}
    assert all("such a motion is never a pass" in check.note for check in found.values())


def test_a_stress_that_is_not_known_never_passes(solved: Findings) -> None:
    for stress in (None, np.full(len(solved.system.spans), np.nan)):
        line = changed(solved, stress=stress)["line"]
        assert (line.verdict, line.value) == ("fail", math.inf)
        assert line.note.startswith("no value is known")


def test_a_motion_without_an_answer_never_passes(solved: Findings) -> None:
    lines = verdicts(solved.having(transient=Transients(())))
    found = {check.where: check for check in lines if check.verdict != "not judged"}
    assert {check.verdict for check in found.values()} == {"fail"}
    assert "case 1 (hit): no answer; such a motion is never a pass" in found["line"].note


def test_a_motion_that_ends_before_the_ice_never_passes() -> None:
    """Two revolutions at 720 x 13/47 rpm last 0.6026 s."""
    short, enough = (
        ice_checks(run(scene(motion().replace("0.8 s", f"{end} s")))) for end in (0.69, 0.705)
    )
    assert {check.verdict for check in short.values()} == {"fail"}
    assert "ends before the 2 revolutions in ice do: give a longer `duration`" in short["line"].note
    assert {check.verdict for check in enough.values()} == {"pass"}


def test_a_train_that_starts_is_judged_by_the_angle_that_it_turns_from_the_ice_on() -> None:
    start = "{at: motor-1, start: {pull_out: 300e3, slip: 20 %, synchronous: 750 rpm}}"
    for begin, duration, verdict in ((0.1, 0.8, "fail"), (0.1, 2.0, "pass"), (1.0, 1.3, "fail")):
        body = motion(torque=10.0, more="initial: rest,").replace("0.8 s", f"{duration} s")
        body = body.replace("events: [", f"events: [{start}, ").replace("0.1 s", f"{begin} s")
        found = run(scene(body))
        (one,) = found.need(Transients).each
        screw = found.study.train["screw"].stations[0]
        late = one.time >= begin
        turned = abs(np.trapezoid(one.speed[screw, late], one.time[late])) / (2.0 * math.pi)
        assert (turned > 2.0) == (verdict == "pass")
        assert ice_checks(found)["line"].verdict == verdict


def test_the_remark_says_where_the_first_blade_order_meets_a_mode(solved: Findings) -> None:
    """By mode 1: f / (4 x 13/47) revolutions a second of the motor, within 0.8 to 1.2 of 720 rpm."""
    (first, *_) = solved.results["modes"].frequency
    speed = 60.0 * first / (4.0 * 13.0 / 47.0)
    assert 576.0 < speed < 864.0
    words = f"between 576 rpm and 864 rpm the first blade order of screw meets a mode at {speed:.5g} rpm"
    assert words in ice_checks(solved)["line"].note
    assert words in open_rows(solved)["resonance", "screw"]
    over_speed = scene().replace(
        "operation: {", "operation: {speeds: {from: 500 rpm, to: 800 rpm}, "
    )
    words = "between 400 rpm and 960 rpm the first blade order"
    assert words in ice_checks(run(over_speed))["line"].note
    soft = ice_checks(run(scene().replace("250e3", "50e3")))["line"].note
    assert "between 576 rpm and 864 rpm the first blade order of screw meets no mode" in soft


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (
            scene("{name: x, duration: 1 s, events: [{at: screw, step: {torque: 1}}]}"),
            12,
            "no transient response has",
        ),
        (
            scene(rubber="rated_torque: 1e3", bevel="").replace(", yield_strength: 355 MPa", ""),
            12,
            "no shaft has a yield strength, and no coupling or gear a maximum torque",
        ),
        (scene().replace(", power: 1.5 MW", ""), 3, "the torque of the drive is not known"),
        (
            scene(motion(more="initial: {speed: 720 rpm},")),
            11,
            "the torque of the drive is not known",
        ),
        (  # one of two motions begins with the mean torques
            scene(
                f"{motion()}, {motion(name='start', more='initial: rest,')}".replace(
                    "rest, events: [",
                    "rest, events: [{at: motor-1, start: {torque: [[0 rpm, 1], [900 rpm, 1]]}}, ",
                )
            ).replace(", power: 1.5 MW", ""),
            3,
            "the torque of the drive is not known",
        ),
        (scene(rule="ice: {factor: 0.9}"), 12, "at least 1"),
    ],
)
def test_what_the_file_lacks_for_the_rule_is_said_at_its_place(
    text: str, line: int, words: str
) -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(text)
    assert words in str(refused.value)
    assert refused.value.faults[0].line == line


TWO = "max_torque: 60e3, max_torque_rare: 90e3, max_torque_range: 50e3"
FAULT = "{at: motor-1, short-circuit: {coefficients: {line: 1}, decay: [0.1, 0.1]}}"
STEP = "{at: motor-1, step: {torque: 10}}"


def clauses(found: Findings) -> dict[str, float]:
    return {
        check.clause: check.limit for check in found.need(Checks).lines if check.where == "rubber"
    }


@pytest.mark.parametrize(
    ("events", "more", "is_rare"),
    [
        (FAULT, "", True),
        (f"{FAULT}, {STEP}", "", False),
        (STEP, "", False),
        (STEP, "duty: rare,", True),
        (FAULT, "duty: normal,", False),
    ],
)
def test_how_rare_a_motion_is_chooses_the_rating(events: str, more: str, is_rare: bool) -> None:
    text = scene(
        f"{{name: m, duration: 0.1 s, {more} events: [{events}]}}", rubber=TWO, rule="gear-hammer"
    )
    found = run(text.replace("rules: [gear-hammer]\n", ""))
    assert found.need(Transients).each[0].is_rare == is_rare
    assert clauses(found) == ({"T_Kmax2": 90e3} if is_rare else {"T_Kmax1": 60e3, "dT_max": 50e3})


def test_a_twist_that_is_released_is_no_rare_motion() -> None:
    body = "{name: m, duration: 0.1 s, initial: {torque: {rubber: 10}}}"
    assert clauses(run(scene(body, rubber=TWO).replace("rules: [ice]\n", ""))) == {
        "T_Kmax1": 60e3,
        "dT_max": 50e3,
    }


@pytest.mark.parametrize("duty", ["normal", "rare"])
def test_one_rating_holds_for_every_motion(duty: str) -> None:
    body = f"{{name: m, duration: 0.1 s, duty: {duty}, events: [{STEP}]}}"
    assert clauses(run(scene(body).replace("rules: [ice]\n", ""))) == {"T_Kmax": 60e3}


def standing(found: Findings, one: TransientMotion) -> dict[str, Check]:
    having = found.having(transient=Transients((one,)))
    return {check.clause: check for check in standing_verdicts(having) if check.where == "rubber"}


def test_each_rating_is_compared_with_its_torque() -> None:
    """60 kN m normal, 90 kN m rare, a range of 50 kN m: greatest and least by hand, modes not sampled added."""
    body = f"{{name: m, duration: 0.1 s, events: [{STEP}]}}"
    found = run(scene(body, rubber=TWO).replace("rules: [ice]\n", ""))
    (one,) = found.need(Transients).each
    spans = len(found.system.spans)

    def checks(high: float, low: float, *, lacking: float = 0.0, **more: object) -> dict[str, str]:
        ends = {
            "greatest": np.full(spans, high),
            "least": np.full(spans, low),
            "unresolved": np.full(spans, lacking),
        }
        return {
            key: check.verdict
            for key, check in standing(found, replace(one, **ends, **more)).items()
        }

    assert checks(60e3, 10e3) == {"T_Kmax1": "pass", "dT_max": "pass"}
    assert checks(60.001e3, 10.001e3) == {"T_Kmax1": "fail", "dT_max": "pass"}
    assert checks(40e3, -10.001e3) == {"T_Kmax1": "pass", "dT_max": "fail"}
    assert checks(10e3, -60.001e3) == {"T_Kmax1": "fail", "dT_max": "fail"}
    assert checks(39e3, -10e3, lacking=0.6e3) == {"T_Kmax1": "pass", "dT_max": "fail"}
    assert checks(60e3, 10e3, residual=1.0) == {"T_Kmax1": "fail", "dT_max": "fail"}
    assert checks(90e3, -80e3, is_rare=True) == {"T_Kmax2": "pass"}
    assert checks(90.001e3, 0.0, is_rare=True) == {"T_Kmax2": "fail"}
    assert checks(1e3, 0.0, is_rare=True, residual=1.0) == {"T_Kmax2": "fail"}


def test_ice_is_normal_operation_even_where_its_motion_is_called_rare() -> None:
    check = ice_checks(run(scene(motion(more="duty: rare,"), rubber=TWO)))["rubber"]
    assert (check.clause, check.limit) == ("T_Kmax1", 60e3)


@pytest.mark.parametrize(
    ("rubber", "words"),
    [
        ("max_torque_rare: 90e3", "`max_torque_rare` needs `max_torque`"),
        (
            "max_torque: 60e3, max_torque_rare: 59e3",
            "59000 N m is below the 60000 N m of `max_torque`",
        ),
    ],
)
def test_ratings_that_do_not_go_together_are_refused(rubber: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(scene(rubber=rubber))
    assert words in str(refused.value)
    assert refused.value.faults[0].line == 6


def test_equal_ratings_are_read() -> None:
    torsion.parse(scene(rubber="max_torque: 60e3, max_torque_rare: 60e3"))


def test_a_yield_strength_above_the_tensile_strength_is_refused() -> None:
    with pytest.raises(InputError, match="the yield strength is above the tensile strength"):
        torsion.parse(scene().replace("355 MPa", "355 MPa, tensile_strength: 300 MPa"))
    torsion.parse(scene().replace("355 MPa", "355 MPa, tensile_strength: 355 MPa"))


@pytest.mark.parametrize(("damage", "verdict"), [(1.0 - 1e-12, "pass"), (1.0, "fail")])
def test_a_life_that_is_used_up_fails(solved: Findings, damage: float, verdict: str) -> None:
    (one,) = solved.need(Transients).each
    spent = replace(one, damage=np.full(len(solved.system.spans), damage))
    checks = standing_verdicts(solved.having(transient=Transients((spent,))))
    assert {check.verdict for check in checks if check.clause == "D"} == {verdict}
