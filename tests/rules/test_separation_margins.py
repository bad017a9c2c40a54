"""Natural frequencies away from every possible excitation, against two discs whose frequency is set by hand."""

import math

import numpy as np
import pytest

from torsion.rules import lacking, not_judged, rule, settings, verdicts

J = 2.0
SPEEDS = {"from": "1000 rpm", "to": "1200 rpm"}


def discs(frequency, order=2):
    """Two equal discs of which the one elastic mode has so many Hz."""
    stiffness = J / 2 * (2 * math.pi * frequency) ** 2
    ripple = [{"order": order, "torque": 10.0}]
    return [("motor", {"name": "motor", "inertia": J, "ripple": ripple}), ("coupling", {"stiffness": stiffness}),
            ("disc", {"inertia": J})]  # fmt: skip


@pytest.fixture
def judged(study, evidence):
    def run(name, frequency, order=2, **given):
        scene = study(
            discs(frequency, order), [(name, settings(name).model_validate(given))], speeds=SPEEDS, rated=None
        )
        assert lacking(scene) == []
        found = verdicts(evidence(scene, np.array([1000.0, 1200.0]), half={}))
        return {check.order or check.where: check for check in found}

    return run


@pytest.mark.parametrize("name", ["api-610", "api-617", "api-684"])
@pytest.mark.parametrize("order", [1, 2, 7])
def test_ten_percent_of_every_order_on_both_sides(judged, name, order) -> None:
    low, high = 1000 / 60 * order, 1200 / 60 * order
    for frequency, verdict in (
        (low * 0.9 * (1 - 1e-6), "pass"), (low * 0.9 * (1 + 1e-6), "not kept"), (low, "not kept"), (high, "not kept"),
        (high * 1.1 * (1 - 1e-6), "not kept"), (high * 1.1 * (1 + 1e-6), "pass"),
    ):  # fmt: skip
        check = judged(name, frequency, order)[order]
        assert check.verdict == verdict
        assert check.limit == 0.1
        assert check.at_least
        assert check.speed == pytest.approx(2 * math.pi * frequency / order, rel=1e-9)
        apart = max((low - frequency) / low, (frequency - high) / high, 0.0)
        assert check.value == pytest.approx(apart, rel=1e-6, abs=1e-9)
        assert ("stress analysis" in check.note) == (verdict != "pass")


def test_shaft_speeds_count_whether_they_excite_or_not(judged) -> None:
    assert set(judged("api-617", 500.0, 7)) == {1, 2, 7}
    assert set(judged("api-618", 500.0, 12)) == {*range(1, 11), 12}


def test_api_618_has_five_percent_above_the_first_multiple(judged) -> None:
    found = judged("api-618", 1200 / 60 * 3 * 1.06, 3)
    assert (found[3].limit, found[3].verdict) == (0.05, "pass")
    assert found[1].limit == 0.1
    assert judged("api-618", 1200 / 60 * 3 * 1.04, 3)[3].verdict == "not kept"


def test_line_frequency_counts_once_and_twice(judged) -> None:
    for frequency, kept in ((45.0 * (1 - 1e-6), True), (46.0, False), (54.0, False), (55.0 * (1 + 1e-6), True)):
        found = judged("api-617", frequency, line_frequency=50.0)
        assert found["50 Hz (1 x line frequency)"].verdict == ("pass" if kept else "not kept")
    assert judged("api-617", 95.0, line_frequency="50 Hz")["100 Hz (2 x line frequency)"].verdict == "not kept"


def test_the_operating_range_of_the_file_counts(judged) -> None:
    given = {"continuous": {"from": "1150 rpm", "to": "1200 rpm"}}
    assert judged("api-617", 17.0, **given)[1].verdict == "pass"
    assert judged("api-617", 17.0)[1].verdict == "not kept"


def test_gears_make_shafts_of_other_speeds(study, evidence) -> None:
    parts = [*discs(500.0), ("gear", {"ratio": 4}), ("disc", {"inertia": 1.0})]
    scene = study(parts, [("api-617", settings("api-617")())], speeds=SPEEDS)
    found = verdicts(evidence(scene, np.array([1000.0, 1200.0]), half={}))
    assert {str(check.order) for check in found} == {"1/4", "1/2", "1", "2"}


def test_modes_that_were_not_computed_never_pass(study, evidence) -> None:
    """Eight discs, of whose modes six are computed by default: an order beyond the sixth is not known to be apart."""
    parts = [("motor", {"name": "m", "inertia": 1.0, "ripple": [{"order": 50, "torque": 1.0}]})]
    for _ in range(8):
        parts += [("coupling", {"stiffness": 1e6}), ("disc", {"inertia": 1.0})]
    scene = study(parts, [("api-617", settings("api-617")())], speeds=SPEEDS)
    whole = evidence(scene, np.array([1000.0, 1200.0]), half={})
    modes = whole.results["modes"]
    assert modes.frequency.size == 8
    from torsion.analyses.undamped_modes import modes as lowest

    few = whole.having(modes=lowest(whole.system, 6))
    check = {check.order: check for check in verdicts(few)}[50]
    assert check.value > 0.1
    assert check.verdict == "not kept"
    assert "`count`" in check.note


def test_what_is_not_judged_and_what_lacks(study) -> None:
    plain = settings("api-610")()
    scene = study(discs(100.0), [("api-610", plain)], speeds=None, rated=None)
    assert [fault.path for fault in lacking(scene)] == [("operation", "speeds")]
    assert "api-610: line frequency" in dict(not_judged(scene))
    assert rule("api-610").standard.edition.startswith("API 610")
