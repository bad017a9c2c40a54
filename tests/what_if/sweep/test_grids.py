"""Combinations of lists and steps against the closed form of two discs and the files written out; Sobol's indices."""

import shutil
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest
from tests.contracts.frozen import solved
from tests.for_all import for_all

import torsion
from torsion.errors import InputError
from torsion.output.chapters import verdict
from torsion.output.chapters.what_if.sweep import chapter
from torsion.output.figures.figure import Figure
from torsion.rules.verdict_line import Checks
from torsion.what_if.sweep.sweep_results import Grid, Sweep
from torsion.what_if.sweep.sweep_run import estimated, grid_of
from torsion.what_if.sweep.sweep_settings import Points
from torsion.what_if.variants import chunks
from torsion.what_if.variants.laws import uniform_samples

TWO = """name: two discs
materials: {steel-2: {shear_modulus: 79.3 GPa, density: 7850 kg/m**3, loss_factor: 0.002}}
operation: {rated: {speed: 1500 rpm, power: 100 kW}}
train:
  - disc: {inertia: 1.2}
  - coupling: {stiffness: 20 kN*m/rad, rated_torque: 1 kN*m%s}
  - disc: {inertia: 0.8}
analyses: {modes: {count: 1}, sweep: {%s}}
"""
FOUR = """name: four discs
train:
  - disc: {inertia: 1.2}
  - coupling: {stiffness: 20000}
  - disc: {inertia: 0.35}
  - coupling: {stiffness: 310000}
  - disc: {inertia: 0.6}
  - coupling: {stiffness: 47000}
  - disc: {inertia: 0.95}
analyses: {modes: {count: 2}, sweep: {vary: {coupling-1.stiffness: {values: [12000, 16000, 20000, 25000, 40000]}}}}
"""
LISTED = [  # reference: catalogue list, 18 digits
    [
        19.3543610287755373,
        21.9453155870190878,
        24.0742737742577806,
        26.2609414252796706,
        30.747961733584507,
    ],
    [
        51.6362993020706537,
        52.455817440635524,
        53.3289702398578454,
        54.4891234918039135,
        58.3115262942443452,
    ],
]
FIRST = [
    0.900193165393470396,
    0.0996189890361789477,
]  # reference: f = sqrt(k / J), k +-15 %, J +-5 %
TOTAL = [0.900381010963821052, 0.0998068346065296038]
SCENES = Path(__file__).parents[3] / "shafting_specs"


def swept(sweep: str, more: str = "", rules: str = "") -> Sweep:
    return torsion.run(torsion.parse(TWO % (more, sweep) + rules)).need(Sweep)


def gridded(found: Sweep) -> Grid:
    assert found.grid is not None
    return found.grid


def exact(stiffness: object, inertia: object = 0.8) -> np.ndarray:
    return np.sqrt(np.asarray(stiffness) * (1.0 / 1.2 + 1.0 / np.asarray(inertia))) / (2.0 * pi)


def test_a_curve_is_the_closed_form() -> None:
    found = swept("vary: {coupling-1.stiffness: {from: 10 kN*m/rad, to: 30 kN*m/rad, steps: 41}}")
    grid = gridded(found)
    assert (found.method, found.samples, grid.axes[0].unit, grid.axes[0].in_file) == (
        "grid",
        41,
        "kN*m/rad",
        20.0,
    )
    assert grid.frequency[0] == pytest.approx(exact(np.linspace(1e4, 3e4, 41)), rel=1e-14)


def test_a_map_is_the_closed_form_with_the_last_figure_first() -> None:
    found = swept(
        "vary: {coupling-1.stiffness: {values: [15 kN*m/rad, 0.02 MN*m/rad]}, "
        "disc-2.inertia: {from: 0.5, to: 1, step: 0.25}}"
    )
    grid = gridded(found)
    stiffness, inertia = np.repeat([15e3, 20e3], 3), np.tile([0.5, 0.75, 1.0], 2)
    assert grid.shape == (2, 3)
    assert grid.words(4) == ("0.02 MN*m/rad", "0.75")
    assert grid.frequency[0] == pytest.approx(exact(stiffness, inertia), rel=1e-14)
    assert not grid.axes[0].is_numeric


def test_a_range_in_steps_that_binary_numbers_miss_has_its_last_value() -> None:
    """(0.5 - 0.2)/0.1 is 2.9999999999999996 in double precision."""
    grid = gridded(swept("vary: {disc-2.inertia: {from: 0.2, to: 0.5, step: 0.1}}"))
    assert grid.axes[0].number == pytest.approx([0.2, 0.3, 0.4, 0.5], rel=1e-15)
    assert grid.frequency[0] == pytest.approx(exact(20e3, [0.2, 0.3, 0.4, 0.5]), rel=1e-14)


def test_a_list_has_the_digits_of_the_reference() -> None:
    grid = gridded(torsion.run(torsion.parse(FOUR)).need(Sweep))
    assert grid.frequency == pytest.approx(np.array(LISTED), rel=1e-14)


def test_where_a_check_begins_to_fail_is_that_of_the_closed_form() -> None:
    found = swept(
        "vary: {operation.rated.power: {from: 100 kW, to: 200 kW, steps: 6}}",
        rules="rules: [coupling-maker]\n",
    )
    grid = gridded(found)
    (turn,) = grid.turns
    limit = 1000.0 * 1500.0 * pi / 30.0 / 1000.0  # kW at which the mean torque is 1 kN m
    assert turn.kept == 140.0
    assert turn.failing == 160.0
    assert turn.between == pytest.approx(limit, rel=1e-13)
    assert grid.greatest == pytest.approx(np.linspace(100, 200, 6) / limit, rel=1e-13)
    assert (found.checks[0].lower, found.checks[0].failing) == (None, 3)


def test_where_a_share_without_bound_reaches_its_limit_is_not_known() -> None:
    vary = "vary: {operation.rated.power: {from: 100 kW, to: 200 kW, steps: 6}}"
    text = TWO % ("", vary) + "rules: [coupling-maker]\n"
    study = torsion.parse(text)
    found = torsion.run(study).need(Sweep)
    variation, settings = study.variations["sweep"], study.analyses["sweep"]
    points = Points.from_settings(study, settings, variation.figures)
    (check,) = found.checks
    unbounded = replace(check, utilisation=np.where(check.fails, np.inf, check.utilisation))
    grid = grid_of(variation, points, [unbounded], found.frequency, {})
    assert grid is not None
    (turn,) = grid.turns
    assert (turn.kept, turn.failing, turn.between) == (140.0, 160.0, None)


def test_the_worst_of_two_checks_is_that_of_the_weaker_coupling_and_unknown_without_any() -> None:
    """The mean torque over 1 kN m and over 0.8 kN m; of the second variant neither is known, of the third one."""
    second = (
        "  - coupling: {stiffness: 30 kN*m/rad, rated_torque: 0.8 kN*m}\n  - disc: {inertia: 1}\n"
    )
    vary = "vary: {operation.rated.power: {from: 50 kW, to: 200 kW, steps: 4}}"
    text = (TWO % ("", vary)).replace("analyses:", f"{second}analyses:")
    study = torsion.parse(text + "rules: [coupling-maker]\n")
    found = torsion.run(study).need(Sweep)
    torque = np.linspace(50e3, 200e3, 4) / (1500.0 * pi / 30.0)
    assert found.any_fails is not None
    assert found.any_fails.utilisation == pytest.approx(torque / 800.0, rel=1e-12)
    middle = float(np.median(torque)) / 800.0
    whole = found.any_fails.best, found.any_fails.median, found.any_fails.worst
    assert whole == pytest.approx((torque[0] / 800.0, middle, torque[-1] / 800.0), rel=1e-12)

    weak, strong = found.checks
    known = np.array([True, False, True, True])
    checks = [
        replace(strong, utilisation=np.where(known, strong.utilisation, np.nan)),
        replace(weak, utilisation=np.where([True, False, False, True], weak.utilisation, np.nan)),
    ]
    variation = study.variations["sweep"]
    points = Points.from_settings(study, study.analyses["sweep"], variation.figures)
    grid = grid_of(variation, points, checks, found.frequency, {})
    assert grid is not None
    assert grid.decisive.tolist() == [1, -1, 0, 1]
    expected = [torque[0] / 800.0, np.nan, torque[2] / 1000.0, torque[3] / 800.0]
    assert grid.greatest == pytest.approx(expected, rel=1e-12, nan_ok=True)


def test_a_curve_says_on_the_first_page_where_variants_fail() -> None:
    lines = dict(verdict.box(solved("coupling_curve")).lines)
    assert lines["Sweep"].startswith(
        "7 of 26 variants fail a check: rubber coupling.stiffness 48 kN*m/rad to 60"
    )


@pytest.mark.parametrize(
    ("scene", "figures"),
    [
        ("coupling_curve", ["sweep_curve"]),
        ("coupling_map", ["sweep_map", "sweep_map_mode_1"]),
    ],
)
def test_a_curve_and_a_map_are_drawn_of_what_the_grid_holds(scene: str, figures: list[str]) -> None:
    findings = solved(scene)
    drawn = {block.name: block for block in chapter(findings) if isinstance(block, Figure)}
    grid = gridded(findings.need(Sweep))
    assert list(drawn) == figures
    panel = drawn[figures[0]].plots[0]
    if panel.cells is None:
        shown = panel.lines[0].y / 100.0
        assert np.array_equal(shown, grid.utilisation[0] * 100.0 / 100.0)
    else:
        assert panel.cells.values.ravel() == pytest.approx(100.0 * grid.greatest - 100.0)


def test_a_map_is_the_files_with_both_figures_written_in() -> None:
    findings = solved("coupling_map")
    grid, text = gridded(findings.need(Sweep)), findings.study.text
    for variant in (8, 62):
        stiffness, inertia = grid.words(variant)
        own = text.replace("stiffness: 20 kN*m/rad", f"stiffness: {stiffness}").replace(
            "1.5 kg*m**2", inertia
        )
        alone = torsion.run(
            torsion.parse(own[: own.index("  sweep:")] + own[own.index("rules:") :])
        )
        worst = max(line.utilisation for line in alone.need(Checks).lines)
        assert grid.greatest[variant] == pytest.approx(
            worst, rel=5e-4
        )  # a file alone may miss so much of a peak
        assert grid.greatest[variant] >= worst * (1.0 - 1e-6)
        assert grid.fails[variant] == alone.need(Checks).fails


def test_an_exact_ratio_varies_by_values_alone() -> None:
    text = FOUR.replace("disc: {inertia: 0.6}", "gear: {name: g, ratio: 41/17}")
    begin = text.index("vary:")
    with pytest.raises(InputError, match=r"`g\.ratio` is exact"):
        torsion.parse(text[:begin] + "vary: {g.ratio: {uniform: 5 %}}}}\n")
    grid = gridded(
        torsion.run(
            torsion.parse(text[:begin] + "vary: {g.ratio: {values: [41/17, 1, 2]}}}}\n")
        ).need(Sweep)
    )
    assert grid.axes[0].words == ("41/17", "1", "2")
    assert not grid.axes[0].is_numeric


def test_lists_that_vary_together_go_row_by_row() -> None:
    found = swept(
        "vary: {coupling-1.stiffness: {values: [10 kN*m/rad, 20 kN*m/rad]}, "
        "disc-2.inertia: {values: [0.4, 0.6]}}, "
        "together: [[coupling-1.stiffness, disc-2.inertia]]"
    )
    grid = gridded(found)
    assert found.samples == 2
    assert grid.axes[0].words == ("10 kN*m/rad, 0.4", "20 kN*m/rad, 0.6")
    assert grid.frequency[0] == pytest.approx(exact([1e4, 2e4], [0.4, 0.6]), rel=1e-14)


def test_laws_are_side_by_side_in_every_row_of_a_list(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chunks, "shared_out", lambda *given: pytest.fail("solved one by one"))
    found = swept(
        "vary: {coupling-1.stiffness: {uniform: 10 %}, disc-2.inertia: {values: [0.4, 0.8, 1.6]}}, samples: 128"
    )
    inertia = np.array([0.4, 0.8, 1.6])[found.factor[:, 1].astype(int)]
    assert sorted(set(inertia)) == [0.4, 0.8, 1.6]
    assert found.frequency[0] == pytest.approx(exact(2e4 * found.factor[:, 0], inertia), rel=1e-13)


def test_lists_of_numbers_alone_are_side_by_side(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chunks, "shared_out", lambda *given: pytest.fail("solved one by one"))
    found = swept("vary: {coupling-1.stiffness: {values: [10 kN*m/rad, 20 kN*m/rad, 40 kN*m/rad]}}")
    assert gridded(found).frequency[0] == pytest.approx(exact([1e4, 2e4, 4e4]), rel=1e-13)


def test_a_combination_at_fault_is_a_row_with_its_fault() -> None:
    text = FOUR.replace(
        "disc: {inertia: 0.6}", "shaft: {name: s, length: 1 m, diameter: 60 mm, bore: 40 mm}"
    )
    vary = "vary: {s.bore: {values: [0 mm, 56 mm]}, s.diameter: {values: [55 mm, 60 mm]}}"
    found = torsion.run(torsion.parse(text[: text.index("vary:")] + vary + "}}\n")).need(Sweep)
    ((place, why),) = gridded(found).why
    assert (found.unsolved, place) == (1, 2)
    assert "bore" in why
    assert np.isnan(gridded(found).frequency[:, 2]).all()
    assert list(gridded(found).fails) == [False, False, True, False]


def test_rows_at_fault_leave_their_samples_without_an_answer() -> None:
    text = FOUR.replace(
        "disc: {inertia: 0.6}", "shaft: {name: s, length: 1 m, diameter: 60 mm, bore: 40 mm}"
    )
    rows = "s.bore: {values: [0 mm, 56 mm]}, s.diameter: {values: [55 mm, 60 mm]}"
    vary = f"vary: {{{rows}, coupling-1.stiffness: {{uniform: 10 %}}}}, samples: 128"
    found = torsion.run(torsion.parse(text[: text.index("vary:")] + vary + "}}\n")).need(Sweep)
    at_fault = (found.factor[:, :2] == [1.0, 0.0]).all(axis=1)
    assert found.unsolved == at_fault.sum() > 20
    assert (np.isnan(found.frequency).any(axis=0) == at_fault).all()
    assert "bore" in found.faults[0]


@pytest.mark.parametrize(
    ("figure", "law", "name"),
    [
        ("materials.steel-2.loss_factor", "{uniform: 10 %}", "materials.steel-2.loss_factor"),
        ("operation.rated.power", "{uniform: 10 %}", "operation.rated.power"),
        ("coupling-1.inertia.2", "{values: [0.1, 0.3]}", "coupling-1.inertia.2"),
    ],
)
def test_sections_and_items_of_lists_vary(figure: str, law: str, name: str) -> None:
    study = torsion.parse(
        TWO % (", inertia: [0.1, 0.2]", f"vary: {{{figure}: {law}}}, samples: 128")
    )
    assert [one.name for one in study.variations["sweep"].figures] == [name]


def test_a_key_of_all_varies_every_item_of_a_list_but_those_of_nothing() -> None:
    sweep = 'vary: {"*.inertia": {uniform: 10 %}, disc-1.inertia: {uniform: 5 %}}'
    figures = torsion.parse(TWO % (", inertia: [0, 0.2]", sweep)).variations["sweep"].figures
    assert [one.name for one in figures] == [
        "disc-1.inertia",
        "coupling-1.inertia.2",
        "disc-2.inertia",
    ]
    assert [one.law.uniform for one in figures] == [0.05, 0.1, 0.1]


def test_values_of_a_table_vary(tmp_path: Path) -> None:
    shutil.copy(SCENES / "dredge_pump_line.csv", tmp_path)
    sweep = "analyses: {sweep: {vary: {gearbox output shaft.length: {uniform: 10 %}}, results: [modes], samples: 128}}"
    scene = tmp_path / "scene.yaml"
    scene.write_text(f"{(SCENES / 'dredge_pump_line.yaml').read_text()}\n{sweep}\n")
    variation = torsion.read(scene).variations["sweep"]
    each = (variation.study([factor]) for factor in (1.0, 1.1))
    own, longer = (torsion.run(one, only=["assembly"]).system.flexibility for one in each)
    ratio = longer[own > 0.0] / own[own > 0.0]
    assert sorted(set(np.round(ratio[np.isfinite(ratio)], 12))) == [1.0, 1.1]


def test_indices_of_a_product_are_the_closed_form() -> None:
    drawn = uniform_samples(16384, 4, "sobol", 1)
    first, second = drawn[:, :2], drawn[:, 2:]
    sets = [first, second, *(np.where(np.arange(2) == k, second, first) for k in range(2))]
    values = np.stack(
        [np.sqrt((0.85 + 0.3 * one[:, 0]) / (0.95 + 0.1 * one[:, 1])) for one in sets]
    )
    found, error = estimated(values)
    assert found[0] == pytest.approx(FIRST, abs=2e-5)
    assert found[1] == pytest.approx(TOTAL, abs=2e-5)
    assert error.max() < 1e-3


def test_indices_of_a_sweep_are_the_closed_form_within_their_intervals() -> None:
    """k, then J."""
    sweep = "indices: true, samples: 1024, vary: {coupling-1.stiffness: {uniform: 15 %}, disc-2.inertia: {uniform: 5 %}}"
    text = (TWO % ("", sweep)).replace("inertia: 1.2}", "held: true}")
    found = torsion.run(torsion.parse(text)).need(Sweep)
    assert (found.samples, len(found.indices)) == (1024, 2)
    for one, first, total in zip(found.indices, FIRST, TOTAL, strict=True):
        assert abs(one.first - first) <= 1.5 * one.first_error < 0.03
        assert abs(one.total - total) <= 1.5 * one.total_error < 0.03


@for_all(
    ("sweep", "place", "words"),
    [
        (
            "vary: {coupling-1.stiffness: {uniform: 5 %}}, method: grid",
            "8:93",
            "takes lists and steps",
        ),
        (
            "vary: {coupling-1.stiffness: {from: 1, to: 2, steps: 9999999}, disc-1.inertia: {values: [1, 2]}}",
            "8:39",
            "19,9",
        ),
        (
            "vary: {coupling-1.stiffness: {values: [1, 2]}}, method: grid, samples: 128",
            "8:110",
            "no samples",
        ),
        (
            "vary: {coupling-1.stiffness: {uniform: 5 %}}, together: [[]]",
            "8:96",
            "the list is too short: 0",
        ),
        ("vary: {coupling-1.stiffness: {uniform: 5 %}}, results: [checks]", "8:94", "no rules"),
        (
            "vary: {coupling-1.stiffness: {uniform: 5 %}}, indices: true, method: latin",
            "8:94",
            "sobol",
        ),
        (
            "vary: {coupling-1.stiffness: {uniform: 5 %}, '\"coupling-1\".stiffness': {uniform: 6 %}}",
            "8:84",
            "already",
        ),
        (
            (
                "vary: {coupling-1.stiffness: {uniform: 5 %}, disc-2.inertia: {uniform: 6 %}}, "
                "together: [[coupling-1.stiffness, disc-2.inertia]]"
            ),
            "8:128",
            "vary as one",
        ),
        ("vary: {coupling-1.stiffness: {triangular: [0.9, 0.8, 1]}}", "8:81", "do not rise"),
        ("vary: {coupling-1.rated_torque: {values: [1 kN*m, 1 m]}}", "8:46", "a torque"),
        ("vary: {coupling-1.inertia: {uniform: 5 %}}", "8:46", "coupling-1.inertia.1"),
    ],
)
def test_faults_of_grids_and_indices_are_located(sweep: str, place: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        torsion.parse(TWO % (", inertia: [0.1, 0.2]", sweep))
    (fault,) = caught.value.faults
    assert words in f"{fault.message} ({fault.hint})"
    assert f"{fault.line}:{fault.column}" == place
