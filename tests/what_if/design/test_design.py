"""Designs: the true optimum by enumeration and closed forms, robust choices, the file that they make, and faults."""

from collections.abc import Sequence
from itertools import product
from math import log, pi
from pathlib import Path

import numpy as np
import pytest
from tests.contracts.frozen import solved
from tests.for_all import for_all

import torsion
from torsion.errors import InputError, SolveError
from torsion.findings import Findings, Work
from torsion.output.chapters.what_if.design import conclusion
from torsion.rules.verdict_line import Checks
from torsion.study import Study
from torsion.what_if.design.design_results import Design
from torsion.what_if.design.design_run import run
from torsion.what_if.sweep.sweep_results import Sweep
from torsion.what_if.variants.laws import uniform_samples

SCENES = Path(__file__).parents[3] / "shafting_specs"
SCENE = SCENES / "design_coupling.yaml"
TWO = """name: two discs
train:
  - disc: {inertia: 1.2}
  - coupling: {stiffness: 20000, tolerance: 15 %%}
  - disc: {inertia: 0.8}
analyses:
  modes: {count: 1}
%s
"""
THREE = """name: three discs
train:
  - disc: {name: a, inertia: 1.2}
  - coupling: {name: soft, stiffness: 20000}
  - disc: {name: b, inertia: 0.5}
  - coupling: {name: stiff, stiffness: 50000}
  - disc: {name: c, inertia: 0.8}
analyses:
  modes: {count: 2}
  design:
    choose:
      soft.stiffness: {from: 5000, to: 60000}
      stiff.stiffness: {from: 20000, to: 90000}
      b.inertia: {from: 0.1, to: 1.0, step: 0.05}
    aim: {mode-1.frequency: 60 Hz}
    keep: [{mode-2.frequency: {below: 65 Hz}}]
    evaluations: 600
    seed: %d
"""


def designed(text: str, name: str = "train.yaml") -> Design:
    return torsion.run(torsion.parse(text, name)).need(Design)


def stiffness_at(frequency: float) -> float:
    return (2 * pi * frequency) ** 2 * 1.2 * 0.8 / 2.0


@pytest.mark.parametrize("most", [20, 24, 26, 60])
def test_a_search_tries_no_more_trains_than_it_may(most: int) -> None:
    """Two ranges: 5 by 5 of a map are more than 20."""
    lines = (THREE % 1).replace("evaluations: 600", f"evaluations: {most}").splitlines()
    text = "\n".join(line for line in lines if "b.inertia" not in line and "keep" not in line)
    found = designed(text)
    assert found.evaluations == found.solves <= most


def test_stiffness_for_a_frequency_is_the_closed_form() -> None:
    found = designed(
        TWO
        % "  design: {choose: {coupling-1.stiffness: {from: 1e4, to: 4e4}}, aim: {mode-1.frequency: 33 Hz}}"
    )
    assert found.picked[0] == pytest.approx(stiffness_at(33.0), rel=2e-6)
    assert found.chosen == 1
    assert found.before_frequency == pytest.approx(
        np.sqrt(20000 * 2.0 / 0.96) / (2 * pi), rel=1e-14
    )
    assert found.evaluations == found.solves <= 250


def test_a_robust_choice_is_the_best_at_the_worst_of_the_samples_of_the_sweep() -> None:
    text = TWO % (
        "  design: {choose: {coupling-1.stiffness: {from: 1e4, to: 4e4}}, aim: {mode-1.frequency: 33}, robust: true}\n"
        "  sweep: {vary: {coupling-1.stiffness: {uniform: +-30 %}}, samples: 128}"
    )
    study = torsion.parse(text)
    found = torsion.run(study).need(Design)
    words = [one.worst_at.rpartition(" ")[2] for one in found.best]
    assert found.solves == 17 * found.evaluations
    factor = np.array([float(word) for word in words if word])
    low, high = (
        factor.min(),
        factor.max(),
    )  # of all samples: the softest and the stiffest are the worst
    assert found.picked[0] == pytest.approx(stiffness_at(33.0) / np.sqrt(low * high), rel=1e-5)
    best = found.aims[found.allowed].max()
    assert best == pytest.approx(-log(high / low) / 4.0, rel=1e-5)


def test_alternatives_that_are_no_numbers_are_solved_by_themselves() -> None:
    ends = [0.1 + 0.01 * k for k in range(20)]
    listed = ", ".join(f"[0.1, {end:.2f}]" for end in ends)
    found = designed(
        TWO.replace("tolerance: 15 %%", "inertia: [0.1, 0.2]")
        % f"  design: {{choose: {{coupling-1.inertia: {{values: [{listed}]}}}}, aim: {{mode-1.frequency: 27 Hz}}}}"
    )
    frequency = np.sqrt(20000 * (1 / 1.3 + 1 / (0.8 + np.array(ends)))) / (2 * pi)
    assert found.evaluations == 20
    assert found.picked[0] == np.argmin(np.abs(np.log(frequency / 27.0)))


def test_a_robust_choice_keeps_a_condition_in_every_sample_of_a_case() -> None:
    text = TWO % (
        "  design: {choose: {coupling-1.stiffness: {from: 2.2e4, to: 2.8e4}}, aim: {mode-1.frequency: 33}, robust: true,\n"
        "    evaluations: 2500, keep: [{mode-1.frequency: {above: 30 Hz}}]}\n"
        "  sweep: {vary: {coupling-1.stiffness: {uniform: +-3 %}}, samples: 128}\n"
        "cases: {heavy: {set: {disc-2.inertia: 1.6}}}"
    )
    found = designed(text)
    softest = 1.0 - 0.03 * (1.0 - 2.0 * uniform_samples(16, 1, "latin", 1).min())
    assert found.picked[0] * softest == pytest.approx(
        (2 * pi * 30.0) ** 2 / (1 / 1.2 + 1 / 1.6), rel=2e-5
    )


def test_a_limit_to_be_verified_has_no_margin_but_rules_out_what_exceeds_it() -> None:
    """16000 s-2 are 20.1 Hz, once 1200 rpm to 1 %; the margin is that of the mean torque of 50 kW alone."""
    found = designed(
        """name: two discs
operation: {speeds: {from: 1000 rpm, to: 1200 rpm}, rated: {speed: 1200 rpm, power: 50 kW}}
train:
  - disc: {inertia: 1}
  - coupling: {name: rubber, stiffness: 1000, rated_torque: 1 kN*m}
  - disc: {inertia: 1}
rules: [api-684, coupling-maker]
analyses: {modes: {count: 1}, design: {choose: {rubber.stiffness: {values: [1000, 8000]}}, aim: margin}}
"""
    )
    assert found.uncounted == ("train: separation, api-684",)
    assert found.aims == pytest.approx(2 * [log(1000.0 * 40.0 * pi / 50e3)], rel=1e-12)
    assert found.allowed.tolist() == [True, False]
    assert [candidate.is_allowed for candidate in found.best] == [True, False]


def largest_first_frequency() -> float:
    """By enumeration, Hz: of all inertias, on a grid of both stiffnesses, where mode 2 is below 65 Hz."""
    best = 0.0
    soft, stiff = np.meshgrid(np.linspace(5e3, 6e4, 221), np.linspace(2e4, 9e4, 281))
    zero = np.zeros_like(soft)
    k = np.array(
        [[soft, -soft, zero], [-soft, soft + stiff, -stiff], [zero, -stiff, stiff]]
    ).transpose(2, 3, 0, 1)
    for inertia in np.arange(0.1, 1.001, 0.05):
        root = np.sqrt(np.array([1.2, inertia, 0.8]))
        f = np.sqrt(np.abs(np.linalg.eigvalsh(k / np.outer(root, root)))) / (2 * pi)
        best = max(best, f[..., 1][f[..., 2] <= 65.0].max(initial=0.0))
    return best


def test_the_true_optimum_is_found_from_three_of_three_seeds() -> None:
    true = largest_first_frequency()
    found = [designed(THREE % seed) for seed in range(3)]
    assert all("differential evolution" in one.method for one in found)
    for one in found:
        best = one.best[one.chosen - 1]
        assert best.is_allowed
        assert best.frequency > true  # a grid stays below it
        assert one.evaluations <= 620


def written(size: str, diameter: int) -> str:
    """The scene with the figures of a row written in by hand, without its design."""
    rows = [
        line.split(",")
        for line in (SCENES / "design_coupling_series.csv").read_text().splitlines()[2:]
    ]
    (row,) = (one for one in rows if one[0] == size)
    text = SCENE.read_text()
    head, _, tail = text.partition("  # what may be chosen")
    text = head + tail[tail.index("rules:") :]
    for before, after in (
        ("stiffness: 13 kN", f"stiffness: {row[1]} kN"),
        ("psi: 0.85", f"psi: {row[2]}"),
        ("rated_torque: 1.6 kN", f"rated_torque: {row[3]} kN"),
        ("vibratory_torque: 220 N", f"vibratory_torque: {row[4]} N"),
        ("diameter: 60 mm", f"diameter: {diameter} mm"),
    ):
        assert before in text
        text = text.replace(before, after)
    return text


@pytest.fixture(scope="module")
def scene() -> Findings:
    return solved("design_coupling")


@pytest.fixture(scope="module")
def enumerated() -> dict[tuple[str, str], tuple[float, float, float]]:
    """Margin, second frequency (Hz) and mass (kg) of every combination, each a file of its own."""
    found = {}
    for size, diameter in product(
        ("R 100", "R 125", "R 160", "R 200", "R 250", "R 315"), (55, 60, 65, 70)
    ):
        one = torsion.run(torsion.parse(written(size, diameter)))
        margin = min(log(check.limit / check.value) for check in one.need(Checks).lines)
        mass = 7850 * pi / 4 * (diameter / 1000) ** 2 * 1.4
        mass += dict(
            zip(
                ("R 100", "R 125", "R 160", "R 200", "R 250", "R 315"),
                (28, 34, 43, 53, 66, 82),
                strict=True,
            )
        )[size]
        found[size, f"{diameter} mm"] = margin, float(one.results["modes"].frequency[1]), mass
    return found


def test_margins_conditions_and_masses_are_those_of_every_file_by_itself(
    scene: Findings, enumerated
) -> None:
    found = scene.need(Design)
    allowed = {
        key: one for key, one in enumerated.items() if not 118.0 < one[1] < 132.0 and one[2] < 130.0
    }
    names = [
        (found.rows[0][int(size)], f"{55 + 5 * round((diameter - 55) / 5)} mm")
        for size, diameter in found.values
    ]
    assert sorted(names) == sorted(enumerated)
    assert found.aims == pytest.approx(
        [enumerated[name][0] for name in names], abs=5e-4
    )  # side by side
    assert found.amounts == pytest.approx([enumerated[name][2] for name in names], rel=1e-12)
    kept = [name in allowed and enumerated[name][0] >= 0.0 for name in names]
    assert found.allowed.tolist() == kept
    best = max(allowed, key=lambda key: allowed[key][0])
    assert tuple(found.best[0].values) == best
    assert (found.chosen, found.best[0].proven) == (1, "kept")
    assert found.best[0].proven_margin == pytest.approx(allowed[best][0], rel=1e-12)
    fails = [check for check in scene.need(Checks).lines if check.fails]
    assert found.before == pytest.approx(-log(fails[0].utilisation), rel=1e-12)
    front = [
        (mass, margin)
        for margin, _, mass in allowed.values()
        if not any(other[2] <= mass and other[0] > margin + 1e-12 for other in allowed.values())
    ]
    lightest = {
        round(margin, 9): min(m for m, other in front if abs(other - margin) < 1e-9)
        for _, margin in front
    }
    assert found.front_margin == pytest.approx(sorted(lightest), abs=5e-4)
    assert found.front_amount == pytest.approx(sorted(lightest.values()), rel=1e-12)


def test_the_designed_file_has_the_values_its_comments_and_the_verdict(scene: Findings) -> None:
    variation, found = scene.study.variations["design"], scene.need(Design)
    text = variation.text(found.picked.tolist(), without=["design"])
    assert "# R 160" in text
    assert "design:" not in text
    again = torsion.run(torsion.parse(text))
    by_hand = torsion.run(torsion.parse(written("R 315", 70)))
    assert not again.failed
    assert np.array_equal(again.results["modes"].frequency, by_hand.results["modes"].frequency)


FLOW = "coupling: {stiffness: %s, tolerance: 15 %%}"
BLOCK = """coupling:
      stiffness: %s  # of the maker
      tolerance: 15 %%"""


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (FLOW % 20000, (FLOW % "30000 N*m/rad").replace("}", ", psi: 0.8, source: 'k.csv, one'}")),
        (BLOCK % 20000, f"{BLOCK % '30000 N*m/rad'}\n      psi: 0.8\n      source: 'k.csv, one'"),
    ],
)
def test_keys_that_a_catalogue_adds_are_written_beside_the_others(
    before: str, after: str, tmp_path: Path
) -> None:
    (tmp_path / "k.csv").write_text("name,stiffness [N*m/rad],psi\none,30000,0.8\n")
    text = (TWO % "").replace("coupling: {stiffness: 20000, tolerance: 15 %}", before)
    design = (
        "  design: {choose: {coupling-1: {catalogue: k.csv}}, aim: {mode-1.frequency: 33 Hz}}\n"
    )
    study = torsion.parse(
        text.replace("modes: {count: 1}\n", "modes: {count: 1}\n" + design),
        str(tmp_path / "t.yaml"),
    )
    assert study.variations["design"].text([0.0], without=["design"]) == text.replace(
        before, after.replace('"k.csv, one"', "'k.csv, one'")
    )


def test_a_file_with_aliases_is_written_anew() -> None:
    text = TWO.replace("inertia: 1.2", "inertia: &own 1.2").replace("inertia: 0.8", "inertia: *own")
    study = torsion.parse(
        text
        % "  design: {choose: {disc-1.inertia: {from: 1, to: 2}}, aim: {mode-1.frequency: 33 Hz}}"
    )
    again = torsion.parse(study.variations["design"].text([1.5], without=["design"]))
    assert [one.inertia for one in again.train.inertias] == [1.5, 1.2]


def test_a_choice_that_the_ordinary_solution_disagrees_with_gives_way_to_the_next() -> None:
    text = "  design: {choose: {coupling-1.stiffness: {values: [20000, 21000, 30000]}}, aim: {mode-1.frequency: 33 Hz}}"
    study = torsion.parse(TWO % text)
    before = torsion.run(study, only=("modes",))

    def one_without_answer(study: Study, **given: Sequence[str]) -> Findings:
        if not given and study.train.springs[0].flexibility == 1 / 21000:
            raise SolveError("no answer here")
        return torsion.run(study, **given)

    work = Work(study, dict(before.results), solve=one_without_answer)
    run(work)
    found = work.need(Design)
    assert [one.proven for one in found.best] == ["disagrees", "kept", ""]
    assert (found.chosen, found.picked.tolist()) == (2, [0.0])


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        (
            "coupling-1: {catalogue: one.csv}",
            "coupling-1 only: mode-1.frequency at 33 Hz is not reached",
        ),
        ("coupling-1.source: {values: [one, two]}", "is not reached"),
        (
            "disc-1.inertia: {values: [1, 2]}, propeller-1.blades: {from: 3, to: 5, step: 1}",
            "propeller-1.blades 3",
        ),
    ],
)
def test_odd_choices_have_an_answer(chosen: str, words: str, tmp_path: Path) -> None:
    """One row alone, words, and whole numbers."""
    (tmp_path / "one.csv").write_text("name,stiffness [N*m/rad]\nonly,30000\n")
    text = TWO % f"  design: {{choose: {{{chosen}}}, aim: {{mode-1.frequency: 33 Hz}}}}"
    text = text.replace("tolerance: 15 %", "source: one").replace(
        "  - disc: {inertia: 0.8}", "  - propeller: {inertia: 0.8, blades: 3}"
    )
    found = torsion.run(torsion.parse(text, str(tmp_path / "t.yaml")))
    assert words in conclusion(found.need(Design))


GRID = "{disc-1.inertia: {from: 1, to: 2, step: 1e-6}, disc-2.inertia: {from: 1, to: 2, steps: 99}}"
ONE = "coupling-1.stiffness: {from: 1e4, to: 4e4}"


AT_3 = "aim: {mode-1.frequency: 3}"


@for_all(
    ("design", "place", "words"),  # the fault is where the text `place` begins
    [
        ("choose: {}", "{}", "the mapping is too short: 0"),
        (f"choose: {{{ONE}}}", "{choose", "has no limit"),
        (f"choose: {{{ONE}}}, aim: most", "most", "'most' is no aim"),
        (f"choose: {{{ONE}}}, aim: {{mode-0.frequency: 3}}", "3}", "none of `mode-2.frequency`"),
        (f"choose: {{{ONE}}}, aim: {{mass: 3}}", "3}", "is no aim"),
        (f"choose: {{{ONE}}}, aim: {{mode-1.frequency: 3 mm}}", "3 mm", "mm"),
        (f"choose: {{{ONE}}}, {AT_3}, keep: [{{mass: {{}}}}]", "{}", "nothing says"),
        (
            f"choose: {{{ONE}}}, {AT_3}, keep: [{{mass: {{outside: [3, 2]}}}}]",
            "{outside",
            "not below",
        ),
        (f"choose: {{{ONE}}}, {AT_3}, against: cost", "against", "no catalogue states a cost"),
        (f"choose: {{{ONE}}}, {AT_3}, robust: true", "true", "does not name"),
        (f"choose: {{coupling-1.psi: {{from: 1, to: 2}}}}, {AT_3}", "coupling-1", "does not give"),
        (f"choose: {{disc-1: {{catalogue: none.csv}}}}, {AT_3}", "none.csv", "does not exist"),
        (f"choose: {GRID}, {AT_3}", "choose", "combinations"),
        (
            f"choose: {{{ONE}}}, {AT_3}, robust: true}}\n  sweep: {{vary: {{coupling-1.stiffness: {{values: [1, 2]}}}}",
            "true",
            "in the place of",
        ),
    ],
)
def test_faults_of_a_design_are_located(design: str, place: str, words: str) -> None:
    text = TWO % f"  design: {{{design}}}"
    with pytest.raises(InputError) as caught:
        torsion.parse(text)
    (fault,) = caught.value.faults
    assert words in f"{fault.message} ({fault.hint})"
    assert (fault.line, fault.column) == (8, text.splitlines()[7].index(place) + 1)


@for_all(
    ("table", "place", "words"),
    [
        ("stiffness [N*m/rad]\n30000", "1:1", "the column `name` is missing"),
        ("name,stiffness [N*m/rad]", "1:1", "no rows below"),
        ("name,weight,stiffness [N*m/rad]\na,1,30000", "1:6", "unknown column `weight`"),
        ("name,stiffness [N*m/rad],psi\na,30000,\nb,1,0.5", "2:9", "`psi` is empty"),
        ("name,mass,stiffness [N*m/rad]\na,3,1", "1:6", "has no unit"),
        ("name,cost,stiffness [N*m/rad]\na,-3,1", "2:3", "below 0"),
        ("name,stiffness [kg]\na,3", "1:6", "unit"),
        ("name,stiffness [N*m/rad]\na,3\na,4", "3:1", "name 'a' is in line 2 already"),
        ("name,stiffness [N*m/rad]\na,3\nb,-4", "3:3", "out of range"),
    ],
)
def test_faults_of_a_catalogue_are_located_in_it(
    table: str, place: str, words: str, tmp_path: Path
) -> None:
    (tmp_path / "k.csv").write_text(table + "\n")
    text = (
        TWO % "  design: {choose: {coupling-1: {catalogue: k.csv}}, aim: {mode-1.frequency: 33 Hz}}"
    )
    with pytest.raises(InputError) as caught:
        torsion.parse(text, str(tmp_path / "t.yaml"))
    (fault,) = caught.value.faults
    assert words in f"{fault.message} ({fault.hint})"
    assert (f"{fault.line}:{fault.column}", fault.file) == (place, str(tmp_path / "k.csv"))


def test_a_catalogue_varies_in_a_sweep_as_well(tmp_path: Path) -> None:
    (tmp_path / "k.csv").write_text(
        "name,stiffness [N*m/rad],mass [kg]\none,30000,3\ntwo,20000,4\n"
    )
    text = TWO % "  sweep: {vary: {coupling-1: {catalogue: k.csv}}, samples: 128}"
    found = torsion.run(torsion.parse(text, str(tmp_path / "t.yaml"))).need(Sweep)
    exact = np.sqrt(np.where(found.factor[:, 0] == 0, 30000, 20000) * 2.0 / 0.96) / (2 * pi)
    assert found.frequency[0] == pytest.approx(exact, rel=1e-13)
    assert {0.0, 1.0} == set(found.factor[:, 0])


def test_a_choice_that_breaks_a_condition_is_solved_and_not_kept() -> None:
    """At most 20 kN m/rad make 32.5 Hz, and 40 Hz is the condition."""
    found = designed(
        TWO % "  design: {choose: {coupling-1.stiffness: {from: 1e4, to: 2e4}}, "
        "aim: {mode-1.frequency: 33 Hz}, keep: [{mode-1.frequency: {above: 40 Hz}}]}"
    )
    assert not found.allowed.any()
    assert found.best[0].frequency == pytest.approx(np.sqrt(2e4 * 2.0 / 0.96) / (2 * pi), rel=1e-6)
    assert (found.best[0].is_allowed, found.best[0].proven) == (False, "not kept")
