"""Verdicts of `mil-std-167`, `engine-maker` and `nvh` on vibrations made by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.synthesis import half_range
from torsion.model.parts import ShaftRecord
from torsion.rules import lacking, not_judged, rule, settings, verdicts
from torsion.rules.class_rules.shaft_limits import nominal_stress, with_role

RPM = math.pi / 30.0
W_P = math.pi / 16 * 0.1**3  # m3, of a solid shaft of 100 mm
EXCITES = ("motor", {"name": "engine", "inertia": 3.0, "ripple": [{"order": 4, "torque": 10.0}]})
LOAD = ("disc", {"name": "load", "inertia": 2.0})


def line(role="crank"):
    body = {"name": "line", "length": 1.0, "diameter": 0.1, "role": role, "segments": 1}
    return [EXCITES, ("shaft", body), LOAD]


def stress(values):
    return np.asarray(values, dtype=float) * 1e6 * W_P


def judged(study, evidence, name, parts, rpm, given, half, mean=None):
    scene = study(parts, [(name, settings(name).model_validate(given))])
    assert lacking(scene) == []
    found = verdicts(evidence(scene, np.asarray(rpm, dtype=float), half=half, mean=mean))
    return {(check.where, check.clause): check for check in found}


def test_type_iii_limits_stress_by_the_strength_over_25_and_1_75_times_that_below(
    study, evidence
) -> None:
    """Steel of 600 N/mm2: 24 N/mm2 in the operating range and 42 below it."""
    given = {"continuous": {"from": "600 rpm", "to": "1000 rpm"}}
    for below, within, verdicts_ in (
        (41.9, 23.9, ("pass", "pass")),
        (42.1, 24.1, ("not kept", "not kept")),
    ):
        half = {"line": stress([below, within, 0.0])}
        found = judged(
            study, evidence, "mil-std-167", line("propeller"), [500.0, 600.0, 1100.0], given, half
        )
        assert (found["line", "S_v below"].limit, found["line", "S_v"].limit) == pytest.approx(
            (42.0, 24.0), rel=1e-13
        )
        assert (found["line", "S_v below"].verdict, found["line", "S_v"].verdict) == verdicts_
        assert found["line", "S_v"].basis.edition == "MIL-STD-167 type III"


def test_type_iii_judges_speeds_above_the_range_as_within(study, evidence) -> None:
    given = {"continuous": {"from": "600 rpm", "to": "1000 rpm"}}
    half = {"line": stress([0.0, 0.0, 30.0])}
    found = judged(study, evidence, "mil-std-167", line(), [500.0, 800.0, 1100.0], given, half)
    assert found["line", "S_v"].verdict == "not kept"


def test_type_iii_limits_gears_by_the_smaller_of_both_shares(study, evidence) -> None:
    """Mean 100 and 400 N m: 75 N m at the first speed, 25 % of 400 N m = 100 N m at the second."""
    parts = [EXCITES, ("gear", {"name": "box", "ratio": 2}), LOAD]
    for half, speed, limit, verdict in (
        ([74.0, 0.0], 500, 75.0, "pass"),
        ([76.0, 0.0], 500, 75.0, "not kept"),
        ([0.0, 99.0], 1000, 100.0, "pass"),
        ([0.0, 101.0], 1000, 100.0, "not kept"),
    ):
        mean = {"box": [100.0, 400.0]}
        check = judged(study, evidence, "mil-std-167", parts, [500, 1000], {}, {"box": half}, mean)[
            "box", "gears"
        ]
        assert (check.verdict, check.limit) == (verdict, pytest.approx(limit, rel=1e-12))
        assert check.speed == pytest.approx(speed * RPM)


def test_type_iii_names_what_it_cannot_judge(study) -> None:
    parts = [*line(None)[:2], ("gear", {"name": "box", "ratio": 2}), LOAD]
    given = settings("mil-std-167")()
    scene = study(parts, [("mil-std-167", given)], rated=None)
    assert "mil-std-167 for line" in dict(not_judged(scene))
    (row,) = rule("mil-std-167", given).demanded_rows(scene)
    assert (row.where, row.clause, row.verdict) == ("box", "gears", "not judged")
    nothing = study(
        [EXCITES, ("coupling", {"stiffness": 1e4}), LOAD],
        [("mil-std-167", settings("mil-std-167")())],
    )
    assert "nothing to judge" in lacking(nothing)[0].message


def test_the_limit_of_the_maker_of_the_engine_is_the_makers(study, evidence) -> None:
    for value, verdict in ((39.9, "restricted"), (40.1, "fail")):
        given = {"crank_stress": "40 MPa", "continuous": {"from": "400 rpm", "to": "1000 rpm"}}
        half = {"line": stress([90.0, value])}
        check = judged(study, evidence, "engine-maker", line(), [300, 900], given, half)[
            "line", "tau_N"
        ]
        assert (check.verdict, check.standing, check.limit) == (
            verdict,
            "maker",
            pytest.approx(40.0),
        )
        assert check.value == pytest.approx(value, rel=1e-12)


def test_an_engine_without_limit_or_crankshaft_is_a_fault(study) -> None:
    messages = [
        fault.message
        for fault in lacking(study(line("thrust"), [("engine-maker", settings("engine-maker")())]))
    ]
    assert any("crank_stress" in message for message in messages)
    assert any("no crankshaft" in message for message in messages)


def test_a_crank_span_without_a_bar_is_judged_by_its_journal(study, evidence) -> None:
    """A spring whose record has a journal of 120 mm with a bore of 30 mm."""
    scene = study([EXCITES, ("coupling", {"name": "span", "stiffness": 1e6}), LOAD])
    record = ShaftRecord("steel", "crank", (), (), journal=(0.12, 0.03))
    parts = tuple(
        part.with_records(record) if part.name == "span" else part for part in scene.train.parts
    )
    scene = replace(scene, train=replace(scene.train, parts=parts))
    assert [part.name for _, part, _ in with_role(scene.train, "crank")] == ["span"]
    seen = evidence(scene, [500.0], half={"span": 1000.0})
    spans, tau = nominal_stress(seen.system, 1, seen.need(Response).torque[:, 0].real)
    assert spans.tolist() == [0]
    assert tau == pytest.approx(
        [16 * 1000.0 * 0.12 / (math.pi * (0.12**4 - 0.03**4)) * 1e-6], rel=1e-13
    )
    for name in ("kr", "ccs", "nk", "mil-std-167"):
        named = replace(scene, rules=((name, settings(name)()),))
        assert lacking(named) == []
        assert any(
            check.where == "span"
            for check in verdicts(evidence(named, [500.0], half={"span": 1000.0}))
        )


def shaken(study, evidence, given, angle, rpm=(600.0, 900.0)):
    """Evidence with an angle (rad) of order 4 at the load."""
    scene = study(line(), [("nvh", settings("nvh").model_validate({"at": "load", **given}))])
    assert lacking(scene) == []
    seen = evidence(scene, np.array(rpm), half={"line": 1.0})
    response = seen.need(Response)
    found = np.zeros_like(response.angle)
    found[:, 0, 1] = angle
    return {
        check.clause: check
        for check in verdicts(seen.having(response=replace(response, angle=found)))
    }


def test_angular_acceleration_is_the_squared_circular_frequency_times_the_angle(
    study, evidence
) -> None:
    """Order 4 at 900 rpm is 60 Hz: 1e-3 rad make (120 pi)^2 1e-3 rad/s2, and 120 pi 1e-3 rad/s of speed."""
    most = (120 * math.pi) ** 2 * 1e-3
    for limit, verdict in ((most * (1 + 1e-9), "pass"), (most * (1 - 1e-9), "fail")):
        check = shaken(study, evidence, {"acceleration": limit, "order": 4}, 1e-3j)["acceleration"]
        assert (check.verdict, check.standing) == (verdict, "setting")
        assert check.value == pytest.approx(most, rel=1e-12)
        assert (check.order, check.speed) == (4, pytest.approx(900 * RPM))
    check = shaken(study, evidence, {"fluctuation": "4 rpm"}, 1e-3)["fluctuation"]
    assert (check.value, check.limit) == pytest.approx(
        (120 * math.pi * 1e-3 * 30 / math.pi, 4.0), rel=1e-12
    )
    assert check.verdict == "pass"


def test_half_range_of_two_orders_is_that_of_their_sum_in_time(study, evidence) -> None:
    seen = evidence(study(line()), [600.0], half={})
    response = seen.need(Response)
    one = response.lines[0]
    both = replace(
        response,
        lines=(replace(one, order=one.order / 4), replace(one, order=one.order / 2)),
        status=np.zeros((1, 2), dtype=np.uint8),
    )
    phasors = np.array([[1.0 + 0.5j, -0.3 + 2.0j]])
    time = np.linspace(0, 2 * math.pi, 2_000_001)
    wave = np.real(phasors[0, 0] * np.exp(1j * time) + phasors[0, 1] * np.exp(2j * time))
    assert half_range(both, phasors) == pytest.approx([(wave.max() - wave.min()) / 2], rel=1e-10)
    lost = replace(both, status=np.array([[0, 1]], dtype=np.uint8))
    assert np.isinf(half_range(lost, phasors)).all()


@pytest.mark.parametrize(
    ("given", "place", "word"),
    [
        ({}, ("rules", 0), "`at`"),
        ({"at": "load"}, ("rules", 0), "no limit"),
        ({"at": "lode", "acceleration": 300.0}, ("rules", 0, "nvh", "at"), "no component"),
        (
            {"at": "load", "acceleration": 300.0, "order": 3},
            ("rules", 0, "nvh", "order"),
            "nothing excites",
        ),
    ],
)
def test_limits_and_places_that_are_missing_are_told(study, given, place, word) -> None:
    found = lacking(study(line(), [("nvh", settings("nvh").model_validate(given))]))
    assert any(fault.path == place and word in fault.message for fault in found)
