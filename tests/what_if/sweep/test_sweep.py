"""Variants of a file: each as the file with its figures written in; probabilities of closed forms; faults."""

from dataclasses import replace
from math import pi
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.columns import NotInColumns
from torsion.commands import plan
from torsion.errors import InputError, SolveError
from torsion.findings import Plan, Unanswered
from torsion.output.chapters import verdict
from torsion.output.numbers import number
from torsion.rules.verdict_line import Checks
from torsion.study import Study
from torsion.what_if.sweep.sweep_results import Sweep
from torsion.what_if.sweep.sweep_run import _decides
from torsion.what_if.variants import chunks, frequencies
from torsion.what_if.variants.laws import probability

SCENES = Path(__file__).parents[3] / "shafting_specs"
TWO = """name: two discs
train:
  - disc: {inertia: 1.2}
  - coupling: {stiffness: 20000}
  - disc: {inertia: 0.8}
analyses: {modes: {count: 1}, sweep: {%s}}
"""
DRIVE = """name: drive
operation: {speeds: {from: 300 rpm, to: 1500 rpm, steps: 61}, rated: {speed: 1500 rpm, power: 100 kW}}
train:
  - motor: {inertia: 1.2, ripple: [{order: 2, torque: 2 %%}]}
  - coupling: {name: rubber, stiffness: %r, psi: %r, tolerance: 10 %%, vibratory_torque: 76 N*m, rated_torque: 1 kN*m}
  - disc: {inertia: %r}
  - shaft: {name: tail, length: %r, diameter: %r, density: 0}
  - gear: {ratio: 2, mesh_stiffness: 1e8}
  - propeller: {inertia: 0.95, blades: 4, excitation: [{blade_order: 1, torque: 5 %%}]}
materials: {steel-2: {shear_modulus: 79.3 GPa, density: 0}}
analyses: {modes: {count: 3}, response: %s}
rules: [coupling-maker]
"""
BASE = (20000.0, 0.8, 0.35, 0.8, 0.06)
NAMES = ("rubber.stiffness", "rubber.psi", "disc-1.inertia", "tail.length", "tail.diameter")
VARIED = "{" + ", ".join(f"{name}: {{uniform: 10 %}}" for name in NAMES) + "}"


def drive(figures=BASE, sweep: str = "") -> Study:
    text = DRIVE % (*figures, f", sweep: {{{sweep}}}" if sweep else "")
    return torsion.parse(text.replace(", density: 0}\n  - gear", ", material: steel-2}\n  - gear"))


def written(factor: np.ndarray) -> tuple[float, ...]:
    return tuple(own * one for own, one in zip(BASE, factor.tolist(), strict=True))


def refused(*_: object) -> None:
    raise NotInColumns("every variant separately")


def swept(study: Study) -> Sweep:
    return torsion.run(study).need(Sweep)


def test_probability_that_a_frequency_lies_in_a_band_is_that_of_the_closed_form() -> None:
    found = swept(torsion.parse(TWO % "vary: {coupling-1.stiffness: {uniform: +-15 %}}"))
    (frequency,) = found.frequency
    share, low, high = probability((frequency > 33.0) & (frequency < 34.5), "sobol")
    assert low <= 0.319775182595295219 <= high
    assert share == pytest.approx(0.319775182595295219, abs=5e-4)
    assert frequency.min() > 29.9518721757622193
    assert frequency.max() < 34.8388195224164355


def test_frequencies_of_every_variant_are_the_closed_form() -> None:
    vary = "vary: {coupling-1.stiffness: {lognormal: 10 %}, disc-1.inertia: {normal: 4 %}, disc-2.inertia: {normal: 4 %}}"
    found = swept(
        torsion.parse(TWO % f"{vary}, together: [[disc-1.inertia, disc-2.inertia]], samples: 1024")
    )
    k, one, other = found.factor.T
    assert np.array_equal(one, other)
    exact = np.sqrt(20000 * k * (1 / (1.2 * one) + 1 / (0.8 * other))) / (2 * pi)
    assert found.frequency[0] == pytest.approx(exact, rel=1e-14)
    assert found.mean[0] == pytest.approx(exact.mean(), rel=1e-14)
    assert found.high[0] == pytest.approx(np.quantile(exact, 0.975), rel=1e-12)
    assert [figure.together for figure in found.figures] == [1, 2, 2]


def test_variants_side_by_side_are_the_file_with_the_figures_written_in(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    study = drive(sweep=f"vary: {VARIED}, samples: 128, results: [modes]")
    monkeypatch.setattr(chunks, "shared_out", lambda *given: pytest.fail("solved one by one"))
    found = swept(study)
    for variant in (0, 31, 127):
        figures = written(found.factor[variant])
        alone = torsion.run(drive(figures), only=["modes"]).results["modes"].frequency
        assert found.frequency[:, variant] == pytest.approx(alone, rel=1e-13)


def test_variants_that_are_judged_are_those_files_too() -> None:
    found = swept(drive(sweep=f"vary: {VARIED}, samples: 128"))
    fails = np.zeros(128, dtype=bool)
    (check,) = (one for one in found.checks if one.clause == "T_KW")
    for variant in (0, 1, 64, 127):
        figures = written(found.factor[variant])
        alone = torsion.run(drive(figures))
        (line,) = (one for one in alone.need(Checks).lines if one.clause == "T_KW")
        assert check.utilisation[variant] == pytest.approx(
            line.utilisation, rel=2e-4
        )  # as the file misses peaks
        assert check.fails[variant] == line.fails
        fails[variant] = alone.need(Checks).fails
        assert found.any_fails is not None
        assert found.any_fails.fails[variant] == fails[variant]
    assert 0 < check.failing < 128
    assert check.failing == (check.utilisation > 1.0).sum()
    assert check.decides == "rubber.stiffness"
    ranks = [np.argsort(np.argsort(one)) for one in (check.utilisation, found.factor[:, 0])]
    assert check.correlation == pytest.approx(np.corrcoef(ranks)[0, 1], rel=1e-12)


LOOP = TWO.replace("count: 1", "count: 2").replace(
    "analyses:",
    """  - coupling: {stiffness: 30000}
  - disc: {inertia: 0.5}
links: [{between: [disc-1, disc-3], coupling: {name: chord, stiffness: 15 kN*m/rad}}]
analyses:""",
)


@pytest.mark.parametrize(
    ("text", "vary"),
    [
        (LOOP, "chord.stiffness: {uniform: 30 %}, coupling-1.stiffness: {uniform: 20 %}"),
        (
            LOOP,
            "coupling-2.stiffness: {uniform: 50 %}, coupling-1.stiffness: {uniform: 50 %}",
        ),  # either is the stiffer
        (LOOP, "chord.stiffness: {from: 15e-6 MN*m/rad, to: 15e3 MN*m/rad, steps: 128}"),
    ],
)
def test_closed_loops_are_side_by_side(
    text: str, vary: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = torsion.parse(text % f"vary: {{{vary}}}, samples: 128")
    with monkeypatch.context() as patch:
        patch.setattr(chunks, "shared_out", lambda *given: pytest.fail("solved one by one"))
        found = swept(study)
    monkeypatch.setattr(frequencies, "certified", refused)
    alone = swept(study)
    assert (found.factor == alone.factor).all()
    assert found.frequency == pytest.approx(alone.frequency, rel=1e-13)


SHAFTS = """name: two shafts
train:
  - disc: {name: first, inertia: 1.5}
  - shaft: {name: front, length: 0.8 m, diameter: 80 mm}
  - shaft: {name: aft, length: 0.5 m, diameter: 110 mm}
  - disc: {inertia: 4}
analyses: {modes: {count: 4}, sweep: {vary: {VARY}, samples: 128}}
"""


HIGH = """operation: {speeds: {from: 300 rpm, to: 600 rpm, steps: 2}}
excitations: [{at: first, frequency: 9 kHz, torque: 1}]
analyses: {response: , """


@pytest.mark.parametrize(
    ("vary", "analyses"),
    [
        (
            "front.diameter: {uniform: 8 %}, aft.diameter: {uniform: 8 %}, first.inertia: {uniform: 20 %}",
            "analyses: {",
        ),
        ("front.length: {uniform: 10 %}, aft.diameter: {uniform: 8 %}", "analyses: {"),
        ("front.diameter: {uniform: 8 %}", HIGH),
    ],
    ids=["diameters", "length", "excited above its modes"],
)
def test_variants_side_by_side_have_lumped_shafts_divided_as_each_by_itself(
    vary: str, analyses: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The last mode of a variant, the highest excitation and the length of a shaft say in how many segments it is."""
    study, solved, counted = (
        torsion.parse(SHAFTS.replace("analyses: {", analyses).replace("VARY", vary)),
        chunks.shared_out,
        list[int](),
    )
    with monkeypatch.context() as patch:
        patch.setattr(
            chunks,
            "shared_out",
            lambda function, rows: counted.append(len(rows)) or solved(function, rows),
        )
        found = swept(study)
    assert sum(counted) < 64
    monkeypatch.setattr(frequencies, "certified", refused)
    alone = swept(study)
    assert found.frequency == pytest.approx(alone.frequency, rel=1e-13)


def test_variants_that_need_shorter_pieces_of_a_shaft_are_solved_by_themselves() -> None:
    soft = "  - disc: {inertia: 0.001}\n  - coupling: {name: c%d, stiffness: 20}\n"
    names = [f"c{k}.stiffness" for k in range(6)]
    vary = ", ".join(f"{name}: {{from: 10, to: 1e8, steps: 2}}" for name in names)
    found = swept(
        torsion.parse(
            f"name: x\ntrain:\n{''.join(soft % k for k in range(6))}  - disc: {{inertia: 0.001}}\n"
            "  - shaft: {name: long, length: 10 m, diameter: 100 mm}\n  - disc: {inertia: 0.001}\nanalyses: {model: exact, "
            f"modes: {{count: 6}}, sweep: {{vary: {{{vary}}}, together: [[{', '.join(names)}]]}}}}\n"
        )
    )
    wave = np.sqrt(79.3e9 / 7850.0)  # of both ends nearly free: half waves along the shaft
    assert found.frequency[:, 1] == pytest.approx(np.arange(1, 7) * wave / 20.0, rel=0.02)


def test_figures_that_enter_as_a_sum_are_found_side_by_side(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(chunks, "shared_out", lambda *given: pytest.fail("solved one by one"))
    text = TWO.replace("stiffness: 20000", "stiffness: 20000, inertia: [0.1, 0.2]")
    found = swept(
        torsion.parse(text % "vary: {coupling-1.inertia.2: {uniform: 20 %}}, samples: 128")
    )
    exact = np.sqrt(20000 * (1 / 1.3 + 1 / (0.8 + 0.2 * found.factor[:, 0]))) / (2 * pi)
    assert found.frequency[0] == pytest.approx(exact, rel=1e-13)


def test_a_variant_without_an_answer_counts_as_failing(monkeypatch: pytest.MonkeyPatch) -> None:
    study, solve = drive(sweep="vary: {rubber.psi: {from: 0.9, to: 1.2, steps: 4}}"), torsion.run
    made = study.variations["sweep"].study

    def one_in_four(factor: list[float]) -> Study:
        if factor[0] > 1.15:
            raise SolveError("no answer here")
        return made(factor)

    object.__setattr__(study.variations["sweep"], "in_columns", refused)
    object.__setattr__(study.variations["sweep"], "study", one_in_four)
    found = solve(study).need(Sweep)
    assert found.unsolved == (found.factor[:, 0] > 1.15).sum() == 1
    assert found.faults == ("no answer here",)
    assert found.any_fails.failing == 1


def test_an_analysis_without_an_answer_leaves_its_variant_without_one() -> None:
    left = Unanswered("response", "response", "why", "", None, True, False, "")
    findings = SimpleNamespace(plan=Plan((), (), {}, (left,)))
    answers = chunks.Answers.of_findings(findings, 1)
    assert answers.faults == {0: "response: why"}


def findings(lines) -> SimpleNamespace:
    plan, checks = Plan((), (), {}), SimpleNamespace(lines=lines)
    return SimpleNamespace(plan=plan, get=lambda kind: None, results={"checks": checks})


def test_two_checks_of_one_name_of_which_one_has_no_share_keep_the_share_of_the_other() -> None:
    words = {
        "rule": "rule",
        "clause": "clause",
        "where": "where",
        "what": "what",
        "verdict": "pass",
        "fails": False,
        "has_limit": True,
        "standing": "maker",
    }
    half, unknown = (SimpleNamespace(utilisation=share, **words) for share in (0.5, None))
    for one in ((half, unknown), (unknown, half)):
        answers = chunks.Answers.of_findings(findings(one), 0)
        assert answers.checks.popitem()[1][0] == [0.5]


def test_a_variant_that_is_not_judged_is_not_known_to_pass() -> None:
    words = {
        "rule": "rule",
        "clause": "clause",
        "where": "where",
        "what": "what",
        "standing": "",
        "fails": False,
        "has_limit": True,
        "utilisation": 0.5,
    }
    answers = chunks.Answers(np.empty((0, 2)))
    for place, word in enumerate(("pass", "not judged")):
        lines = (SimpleNamespace(verdict=word, **words),)
        answers.take(place, chunks.Answers.of_findings(findings(lines), 0))
    assert answers.checks.popitem()[1][1].tolist() == [False, True]


def test_the_plan_says_how_many_variants_there_are() -> None:
    steps = {title: size for title, size, _ in plan(SCENES / "coupling_map.yaml").steps}
    assert steps["sweep"] == "63 variants (grid) of 2 figures"


def test_variants_have_every_analysis_that_the_checks_of_the_file_read() -> None:
    text = (SCENES / "rubber_by_frequency.yaml").read_text()
    sweep = "analyses: {response: , sweep: {vary: {engine.inertia: {from: 9.9999, to: 10.0001, steps: 3}}}}"
    found = torsion.run(torsion.parse(f"{text}\n{sweep}\n"))
    alone = {check.clause: check.utilisation for check in found.need(Checks).lines}
    swept = {check.clause: check.median for check in found.need(Sweep).checks}
    assert swept == pytest.approx(alone, rel=1e-4)


def test_the_first_page_says_that_variants_fail_where_the_file_passes() -> None:
    found = torsion.run(drive((*BASE[:1], 0.9, *BASE[2:]), sweep=f"vary: {VARIED}, samples: 128"))
    whole, made = found.need(Sweep).any_fails, verdict.box(found)
    assert 0 < whole.failing < 128
    assert (made.sign, found.exit_status) == ("!", 1)
    share, low, high = (
        number(100.0 * one, 3) for one in (whole.probability, whole.lower, whole.upper)
    )
    says = f"{share} % of the variants fail a check (95 % CI {low} to {high} %)"
    assert dict(made.lines)["Sweep"].startswith(says)
    none = replace(
        found.need(Sweep),
        any_fails=replace(whole, failing=0, probability=0.0, lower=0.0, upper=0.0291),
    )
    assert (
        dict(verdict.box(found.having(sweep=none)).lines)["Sweep"]
        == "none of 128 variants fails (95 % CI 0 to 2.91 %)"
    )


def test_tolerances_are_the_default() -> None:
    (figure,) = swept(drive(sweep="samples: 128, results: [modes]")).figures
    assert (figure.name, figure.law) == ("rubber.stiffness", "uniform ±10 %")


@pytest.mark.parametrize(
    ("water", "keys"), [("30 %", ["inertia"]), ("2", ["inertia", "entrained"])]
)
def test_an_inertia_with_a_tolerance_varies_with_its_water(water: str, keys: list[str]) -> None:
    study = torsion.parse(
        "name: x\ntrain:\n  - motor: {inertia: 1, tolerance: 3 %}\n  - coupling: {stiffness: 1e4}\n"
        f"  - propeller: {{inertia: 4, entrained: {water}, tolerance: 8 %}}\n"
        "analyses: {modes: , sweep: {samples: 128, results: [modes]}}\n"
    )
    variation = study.variations["sweep"]
    motor, propeller = variation.figures
    assert (motor.name, motor.law.uniform, propeller.name) == (
        "motor-1.inertia",
        0.03,
        "propeller-1.inertia",
    )
    assert [path[-1] for path, _ in propeller.paths] == keys
    factor = 1.0 + np.array([[0.03, -0.08]])
    heavy = variation.study(factor[0].tolist())
    assert sum(one.inertia for one in heavy.train.inertias) == pytest.approx(
        1.03 + 0.92 * (5.2 if "%" in water else 6)
    )


@pytest.mark.parametrize(
    ("given", "key"),
    [("stiffness: 20000", "stiffness"), ("flexibility: 5e-5 rad/(N*m)", "flexibility")],
)
def test_a_tolerance_is_that_of_the_stiffness_however_it_is_given(given: str, key: str) -> None:
    text = (TWO % "").replace("stiffness: 20000", f"{given}, tolerance: 10 %")
    variation = torsion.parse(text).variations["sweep"]
    (figure,) = variation.figures
    assert figure.name == f"coupling-1.{key}"
    (spring,) = variation.study([0.9]).train.springs
    assert 1.0 / spring.flexibility == pytest.approx(18000.0, rel=1e-14)


@for_all(
    ("sweep", "place", "words"),
    [
        ("vary: {coupling-2.stiffness: {uniform: 5 %}}", "6:46", "no component"),
        ("vary: {coupling-1.psi: {uniform: 5 %}}", "6:46", "does not give"),
        ("vary: {coupling-1.stiffness: {}}", "6:68", "is missing (a law, a list, a range"),
        ("vary: {coupling-1.stiffness: {uniform: 5 %, normal: 2 %}}", "6:91", "exclude each other"),
        ("vary: {coupling-1.stiffness: {normal: 5 %, within: 4 %}}", "6:90", "`within`"),
        ("vary: {coupling-1.stiffness: {normal: 5 %, within: 5 %}}", "6:90", "`within`"),
        ("vary: {coupling-1.stiffness: {uniform: 120 %}}", "6:78", "out of range"),
        ('vary: {"*.mass": {uniform: 5 %}}', "6:46", "no component has a key `mass`"),
        (
            'vary: {"*.inertia": {uniform: 5 %}}, together: [[disc-1.inertia, disc-3.inertia]]',
            "6:87",
            "disc-3",
        ),
        ("vary: {coupling-1.stiffness: {uniform: 5 %}}, samples: 1000", "6:94", "512 or 1024"),
        ("samples: 128", "6:38", "no parameter of the file varies"),
    ],
)
def test_faults_of_a_sweep_are_located(sweep: str, place: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        torsion.parse(TWO % sweep)
    (fault,) = caught.value.faults
    assert words in f"{fault.message} ({fault.hint})"
    assert f"{fault.line}:{fault.column}" == place


def test_a_range_that_leaves_the_limits_of_its_key_is_refused() -> None:
    text = TWO.replace(
        "coupling: {stiffness: 20000}", "shaft: {length: 1 m, diameter: 60 mm, bore: 50 mm}"
    )
    with pytest.raises(InputError, match=r"shaft-1\.diameter times 0\.7"):
        torsion.parse(text % "vary: {shaft-1.diameter: {uniform: 30 %}}")


def test_a_law_beside_a_catalogue_is_about_the_row_however_the_variants_are_solved(
    tmp_path: Path,
) -> None:
    (tmp_path / "series.csv").write_text(
        "name,stiffness [N*m/rad]\nA,10000\nB,40000\n", encoding="utf-8"
    )
    vary = "vary: {coupling-1: {catalogue: series.csv}, coupling-1.stiffness: {uniform: 15 %}}, samples: 128"
    (tmp_path / "scene.yaml").write_text(TWO % vary, encoding="utf-8")
    study = torsion.read(tmp_path / "scene.yaml")
    row, factor = swept(study).factor.T
    stiffness = np.array([1e4, 4e4])[row.astype(int)] * factor
    exact = np.sqrt(stiffness * (1 / 1.2 + 1 / 0.8)) / (2 * pi)
    assert swept(study).frequency[0] == pytest.approx(exact, rel=1e-13)
    alone = torsion.run(study.variations["sweep"].study([row[0], factor[0]]), only=["modes"])
    assert alone.results["modes"].frequency[0] == pytest.approx(exact[0], rel=1e-13)


def test_a_figure_that_lowers_a_value_decides_as_one_that_raises_it() -> None:
    used = np.linspace(0.1, 0.9, 6)
    factor = np.column_stack([[1.0, 0.0, 2.0, 1.0, 2.0, 3.0], -used])
    assert _decides(used, factor) == (1, pytest.approx(-1.0, rel=1e-15))


def test_equal_values_share_their_ranks() -> None:
    from scipy.stats import spearmanr

    used = np.array([0.1, 0.5, 0.5, 0.9, 0.9, 0.2, np.nan])
    factor = np.column_stack([np.ones(7), [1.0, 0.0, 1.0, 1.0, 1.0, 0.0, 5.0]])
    place, correlation = _decides(used, factor)
    assert place == 1
    assert correlation == pytest.approx(spearmanr(used[:6], factor[:6, 1]).statistic, rel=1e-14)


def test_few_failures_are_no_surer_than_none() -> None:
    none, one = np.zeros(512, dtype=bool), np.arange(512) == 7
    assert probability(one, "sobol")[2] > probability(none, "sobol")[2] > 0.0
