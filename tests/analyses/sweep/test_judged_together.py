"""Variants judged side by side: the verdicts of every variant solved by itself, shares of limits within their error."""

from types import SimpleNamespace

import numpy as np
import pytest

import torsion
from torsion.analyses.response.synthesis import extremes
from torsion.analyses.sweep import sweep_run
from torsion.analyses.sweep.sweep_results import Sweep
from torsion.analyses.variants import judged_together, one_by_one
from torsion.analyses.variants.one_by_one import Answers
from torsion.analyses.variants.products import products
from torsion.findings import Findings
from torsion.study import Study

DRIVE = """name: drive
operation: {{speeds: {{from: 300 rpm, to: 1500 rpm, steps: 61}}, rated: {{speed: 1500 rpm, power: 100 kW}}{load}}}
train:
  - motor: {{name: motor, inertia: 1.2, ripple: [{{order: 2, torque: 2 %}}, {{order: 1/2, torque: 10 N*m}}]}}
  - coupling: {{name: rubber, stiffness: 20000, {damping}, {limits}}}
  - disc: {{name: disc, inertia: 0.35}}
  - shaft: {{name: tail, length: 0.8, diameter: 0.06, material: light}}
  - gear: {{name: gear, ratio: 2, application_factor: 1.3, mesh_stiffness: 1e8, inertia: [0.1, 0.05]}}
  {more}
  - coupling: {{name: other, stiffness: 300000, psi: 0.1}}
  - propeller: {{name: pump, inertia: 0.95, blades: 4, {pump}
      excitation: [{{blade_order: 1, torque: 5 %}}, {{blade_order: 2, torque: 2 %}}]}}
materials: {{light: {{shear_modulus: 79.3 GPa, density: 0}}}}
analyses: {{modes: {{count: 3}}, response: , sweep: {{vary: {{{vary}}}, samples: 128}}}}
rules: {rules}
"""
USUAL = {
    "load": "",
    "more": "",
    "damping": "psi: 0.8",
    "pump": "",
    "rules": "[coupling-maker, gear-hammer]",
    "limits": "vibratory_torque: 76 N*m, rated_torque: 1 kN*m, max_torque: 700 N*m, heat_limit: 9 W",
    "vary": "rubber.stiffness: {uniform: 15 %}, rubber.psi: {uniform: 20 %}, disc.inertia: {normal: 3 %}, "
    "tail.diameter: {uniform: 5 %}, tail.length: {uniform: 5 %}, other.stiffness: {uniform: 20 %}",
}
TRAINS: dict[str, dict[str, str]] = {
    "usual": {},
    "constant load, viscous": {
        "load": ", load: constant",
        "damping": "viscous: 18 N*m*s/rad",
        "vary": "rubber.viscous: {uniform: 30 %}, rubber.stiffness: {uniform: 15 %}, pump.inertia: {uniform: 10 %}",
    },
    "limits over frequency": {
        "limits": "vibratory_torque: {torque: 160 N*m, at: 10 Hz, above: sqrt}, heat_limit: {table: [[10 Hz, 12 W], "
        "[40 Hz, 9 W]]}",
    },
    "inertias that are sums": {
        "vary": "gear.inertia.1: {uniform: 30 %}, rubber.stiffness: {uniform: 15 %}, disc.inertia: {uniform: 10 %}",
        "more": "- disc: {name: fan, inertia: 0.2}",
    },
    "limits that vary": {
        "vary": "rubber.vibratory_torque: {uniform: 20 %}, rubber.rated_torque: {uniform: 60 %}, "
        "rubber.heat_limit: {uniform: 20 %}, rubber.stiffness: {uniform: 15 %}, gear.application_factor: {normal: 2 %}",
    },
    "continuous use": {
        "rules": "[{coupling-maker: {continuous: {from: 700 rpm, to: 1300 rpm}}}, {gear-hammer: {limit: 0.3}}]",
        "pump": "damping: {model: viscous, value: 3 N*m*s/rad}, ",
    },
    "shafts with inertia, in the segments of each variant, and their stress": {
        "rules": "[iacs-m68, coupling-maker]",
        "limits": "vibratory_torque: 165 N*m",
        "more": "- shaft: {name: line, length: 2, diameter: 0.05, role: propeller, features: propeller keyless}",
        "vary": "rubber.stiffness: {uniform: 15 %}, disc.inertia: {uniform: 20 %}, line.length: {uniform: 20 %}",
    },
    "diameters beside discs, and the stress that they decide": {
        "rules": "[iacs-m68, coupling-maker]",
        "limits": "vibratory_torque: 165 N*m",
        "more": "- shaft: {name: line, length: 2, diameter: 0.05, role: propeller, features: propeller keyless}",
        "vary": "rubber.stiffness: {uniform: 15 %}, line.diameter: {uniform: 10 %}, line.length: {uniform: 10 %}",
    },
    "bored shafts": {
        "rules": "[coupling-maker]",
        "limits": "vibratory_torque: 160 N*m",
        "more": "- shaft: {name: line, length: 2, diameter: 0.06, bore: 0.04, role: intermediate, features: slot}",
        "vary": "rubber.stiffness: {uniform: 15 %}, line.diameter: {uniform: 10 %}, line.bore: {uniform: 10 %}",
    },
    "stress above the limit of continuous use": {
        "rules": "[iacs-m68]",
        "pump": "damping: {model: viscous, value: 3 N*m*s/rad}, ",
        "more": "- shaft: {name: line, length: 1.5, diameter: 0.032, role: intermediate, features: slot, segments: 3}",
        "vary": "rubber.stiffness: {uniform: 30 %}, rubber.psi: {uniform: 30 %}, pump.inertia: {uniform: 20 %}",
    },
}


def drive(**given: str) -> Study:
    return torsion.parse(DRIVE.format(**USUAL | given))


EACH = slice(None, None, 3)  # variants that are solved by themselves as well


def both_ways(study: Study, monkeypatch: pytest.MonkeyPatch) -> tuple[Answers, Answers]:
    """The answers side by side, and of some variants those by themselves."""
    found = list[Answers]()

    def noted(work, variation, values, modes):
        together, how = judged_together.judged_together(work, variation, values, modes)
        found.extend(
            [together, one_by_one.solved(work, variation, values[EACH], modes, judged=True)]
        )
        return together, how

    with monkeypatch.context() as patch:
        patch.setattr(sweep_run, "judged_together", noted)
        assert method(torsion.run(study)).startswith("judged side by side")
    return found[0], found[1]


def method(found: Findings) -> str:
    return next(line.method for line in found.plan.done if line.what == "sweep")


@pytest.mark.parametrize("train", TRAINS)
def test_verdicts_side_by_side_are_those_of_every_variant_by_itself(
    train: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, alone = both_ways(drive(**TRAINS[train]), monkeypatch)
    assert found.checks.keys() == alone.checks.keys()
    assert any(
        0 < fails.sum() < fails.size for _, fails in alone.checks.values()
    )  # else nothing is decided
    for key, (used, fails) in alone.checks.items():
        assert np.array_equal(found.checks[key][1][EACH], fails)
        assert found.checks[key][0][EACH] == pytest.approx(used, rel=1e-3)
    assert found.frequency[:, EACH] == pytest.approx(alone.frequency, rel=1e-13)


def test_the_plan_says_the_largest_difference_that_was_found_and_promises_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The estimated error of a share, which the method once called its accuracy, is none that is known."""
    given = list[tuple[Answers, list[int], Answers]]()

    def noted(tried, alone, places):
        given.append((tried.answers, places, alone))
        return difference(tried, alone, places)

    difference = judged_together.Tried.largest_difference
    with monkeypatch.context() as patch:
        patch.setattr(judged_together.Tried, "largest_difference", noted)
        words = method(torsion.run(drive()))
    ((answers, places, alone),) = given
    exact = max(
        abs(float(answers.checks[key][0][place]) / float(used[k]) - 1.0)
        for key, (used, _) in alone.checks.items()
        for k, place in enumerate(places)
    )
    assert (
        f"For {len(places)} variants, also solved separately, the utilisations differ by at most {exact:.1e}"
        in words
    )
    assert "for the others the difference is unknown" in words
    assert "right to" not in words


def places_left(study: Study, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Variants that are left to be solved by themselves, which is then spared."""
    left, solved = list[int](), one_by_one.solved

    def noted(*given, **more):
        if "known" not in more:
            return solved(*given, **more)
        left.extend(more["places"])
        return more["known"]

    with monkeypatch.context() as patch:
        patch.setattr(judged_together, "solved", noted)
        assert method(torsion.run(study)).startswith("judged side by side")
    return left


def test_a_variant_near_a_limit_is_solved_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """The limit is what one of the variants has."""
    small = {"limits": "vibratory_torque: 76 N*m", "rules": "[coupling-maker]"}
    (check,) = torsion.run(drive(**small)).need(Sweep).checks
    limit = float(np.sort(check.utilisation)[64]) * 76.0
    left = places_left(drive(**small | {"limits": f"vibratory_torque: {limit!r} N*m"}), monkeypatch)
    assert int(np.argsort(check.utilisation)[64]) in left
    assert len(left) < 10


@pytest.fixture
def spared(monkeypatch: pytest.MonkeyPatch) -> None:
    """Variants are not solved one by one."""
    none = lambda work, variation, values, modes, **more: Answers(  # noqa: E731
        np.full((modes, len(values)), np.nan)
    )
    monkeypatch.setattr(sweep_run, "solved", none)


@pytest.mark.usefixtures("spared")
def test_a_resonance_without_damping_is_left_to_be_solved_by_itself() -> None:
    small = {"limits": "vibratory_torque: 76 N*m", "rules": "[coupling-maker]", "damping": "psi: 0"}
    text = DRIVE.format(**USUAL | small | {"vary": "rubber.stiffness: {uniform: 15 %}"}).replace(
        "psi: 0.1", "psi: 0"
    )
    assert "every variant is near a limit" in method(torsion.run(torsion.parse(text)))


@pytest.mark.usefixtures("spared")
def test_variants_that_do_not_say_the_same_by_themselves_are_all_solved_so(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    exact = judged_together.swept

    def wrong(*given):
        train = exact(*given)
        train.enters.power[1] += 0.5
        return train

    monkeypatch.setattr(judged_together, "swept", wrong)
    assert "do not say the same" in method(torsion.run(drive()))


@pytest.mark.usefixtures("spared")
@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"rules": "[coupling-maker, {nvh: {at: motor, fluctuation: 20 rpm}}]"}, "at each speed"),
        ({"vary": "operation.rated.power: {uniform: 5 %}"}, "neither as a power"),
        # couples the discs beside it, so that the train resonates between two undamped frequencies
        (
            {"damping": "viscous: 900 N*m*s/rad", "vary": "rubber.viscous: {lognormal: 60 %}"},
            "moves a resonance",
        ),
    ],
)
def test_what_cannot_be_judged_side_by_side_is_solved_one_by_one(
    given: dict[str, str], why: str
) -> None:
    words = method(torsion.run(drive(**given)))
    assert words.startswith("every variant solved and judged separately")
    assert why in words


def test_figures_enter_rows_as_powers_or_as_a_share_of_a_sum() -> None:
    figure = SimpleNamespace(name="one.key", rows=(), nominal=2.0)
    size = 0.93 * 3**-0.2  # part of the size factor of a shaft
    for read, factor, slope in (
        (lambda x: [[x**2, 3 * x**2], [5.0, 5.0]], [[1.5**2], [1.0]], [[2.0], [0.0]]),
        (
            lambda x: [[x + 1.0, 2 * x + 2.0], [1 / x, 7.0 / x]],
            [[4.0 / 3.0], [1.0 / 1.5]],
            [[0.75], [-1.0]],
        ),
        (
            lambda x: [[0.35 + 0.93 * x**-0.2], [1 / (x**4 - 3)]],
            [[(0.35 + size) / (0.35 + 0.93 * 2**-0.2)], [1 / 6]],
            [[-0.2 * size / (0.35 + size)], [-4 * 81 / 78]],
        ),
        (lambda x: [[x**3 * (1 + 2 * x)]], [[27 * 7 / 40]], [[3 + 6 / 7]]),
        (lambda x: [[x, x**2]], None, None),  # the samples of a row vary as one
        (lambda x: [[x**2 + x**3 + x, 1.0]], None, None),
    ):
        variation = SimpleNamespace(figures=[figure], study=lambda row: row[0])
        found = products(
            variation, np.array([[2.0], [1.9]]), lambda x, read=read: np.array(read(x))
        )
        assert (found is None) == (factor is None)
        assert found is None or found.factors(np.array([[3.0]])) == pytest.approx(
            np.array(factor), rel=1e-14
        )
        assert found is None or found.slopes(np.array([3.0])) == pytest.approx(
            np.array(slope), rel=1e-14
        )


def test_a_figure_that_is_capped_within_its_range_enters_otherwise() -> None:
    """The trials are below the cap, and so is the last variant."""
    variation = SimpleNamespace(
        figures=[SimpleNamespace(name="one.key", rows=(), nominal=2.0)], study=lambda row: row[0]
    )
    for ends, found in (([1.5, 2.3], True), ([1.5, 2.6], False), ([1.5, 1.9], True)):
        values = np.array([*ends, 2.0])[:, None]
        assert (
            products(variation, values, lambda x: np.array([[min(x, 2.5) + 1.0]])) is not None
        ) == found


def test_rows_of_waves_that_do_not_act_are_zero() -> None:
    rng = np.random.default_rng(2)
    phasors = rng.normal(size=(9, 3)) + 1j * rng.normal(size=(9, 3))
    phasors[::2] = 0.0
    highest, lowest = extremes(phasors, np.array([1, 2, 5]))
    assert (highest[::2] == 0.0).all()
    assert (lowest[::2] == 0.0).all()
    other = extremes(phasors[1::2], np.array([1, 2, 5]))
    assert np.array_equal(np.stack([highest, lowest])[:, 1::2], np.stack(other))
