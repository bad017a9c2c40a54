"""The Python front: its public names, and that it has no meaning of its own."""

import doctest
import html
import inspect
import json
import math
import pickle
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
import yaml
from tests import notebook_example
from tests.contracts.frozen import solved
from tests.for_all import for_all

import torsion
from torsion import formulas
from torsion.model import KINDS
from torsion.model.component import component_class
from torsion.output.stored.results_json import results
from torsion.results import is_declared, quantities
from torsion.rules.verdict_line import Check


def test_every_public_name_is_listed_and_documented() -> None:
    assert set(torsion.__all__) <= set(dir(torsion))
    assert set(dir(torsion)) - set(torsion.__all__) == {"__version__"}
    assert not [name for name in torsion.__all__ if not getattr(torsion, name).__doc__]


def test_an_unknown_name_of_the_package_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'mode'"):
        _ = torsion.mode


def test_the_import_of_the_package_loads_no_library() -> None:
    code = "import sys, torsion; print({'numpy', 'pydantic', 'yaml', 'scipy'} & set(sys.modules))"
    printed = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout
    assert printed == "set()\n"


def test_two_results_are_compared_in_python() -> None:
    text = "name: pair\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]"
    before, after = (torsion.run(torsion.parse(text.replace("120", k))) for k in ("120", "480"))
    assert not torsion.compare(before, before).is_changed
    (case,) = torsion.compare(before, after).cases
    assert case.modes[0].change == pytest.approx(1.0, rel=1e-9)  # sqrt(480/120) - 1


ROOT = Path(__file__).parents[1]
SPECS = ROOT / "shafting_specs"
SMALL = ("usv", "pump_1200kw", "rubber_damper", "twin_motor_ferry", "joint_run_up", "ferry_cases")


@pytest.mark.parametrize("name", SMALL)
def test_every_public_result_is_shown_as_one_line(name: str) -> None:
    findings = solved(name)
    study = findings.study
    shown = [findings, study, study.train, *study.train.parts, *findings.results.values()]
    for text in map(repr, shown):
        assert "\n" not in text
        assert len(text) <= 200, text


def test_a_study_and_what_it_is_made_of_have_their_names_in_one_line() -> None:
    findings = solved("pump_1200kw")
    study, system = findings.study, findings.system
    assert repr(study).startswith(f"Study '{study.name}': {len(study.train.parts)} components, ")
    assert repr(study.train).startswith(
        f"Train: {len(study.train.parts)} components ({study.train.parts[0].name}, "
    )
    assert (
        repr(system)
        == f"System: lumped, {len(system.stations)} stations, {len(system.spans)} spans"
    )


def test_a_notebook_shows_a_study_as_a_sketch_and_tables() -> None:
    findings = solved("pump_1200kw")
    page = findings.study._repr_html_()
    assert "<table>" in page
    assert html.escape(findings.study.train.parts[-1].name) in page
    assert page.count("<svg") == 1


DISCS = """
name: Two discs
operation: {speeds: {from: 300 rpm, to: 1800 rpm}}
train:
- motor: {name: motor, inertia: 0.8}
- coupling: {name: spring, stiffness: 14.4 kN*m/rad, loss_factor: 0.1}
- propeller: {name: propeller, inertia: 0.2}
excitations: [{at: propeller, order: 2, torque: 25 N*m}]
"""


@cache
def two_discs() -> torsion.Findings:
    return torsion.run(torsion.parse(DISCS))


def test_a_component_a_torque_and_a_shape_are_reached_by_name() -> None:
    findings = two_discs()
    assert findings.study.train["spring"].kind == "coupling"
    torque = findings["response"]["spring", 2]
    exact = 25 * 0.8 / (1 - (2 * torque.speed / 300) ** 2 / (1 + 0.1j))  # closed form of two discs
    np.testing.assert_allclose(torque.abs_Nm, np.abs(exact), rtol=1e-10)
    assert torque.max() == pytest.approx(
        25 * 0.8 * math.sqrt(1 + 1 / 0.1**2), rel=1e-8
    )  # at resonance
    assert torque.at_max_rpm == pytest.approx(300 / 2 * 30 / math.pi, rel=1e-8)
    assert repr(torque) == "Torque of spring [N m]: 201 at 1432.4 rpm; order 2"
    shapes = findings["modes"]["motor"], findings["modes"]["propeller"]
    assert shapes[1] / shapes[0] == pytest.approx(-0.8 / 0.2, rel=1e-12)  # no angular momentum


@for_all(
    ("look", "message"),
    [
        (
            lambda f: f.study.train["sprin"],
            "no component is called 'sprin'; did you mean 'spring'?",
        ),
        (
            lambda f: f["response"]["springs"],
            "no component is called 'springs'; did you mean 'spring'?",
        ),
        (lambda f: f["response"]["spring", 3], "no order 3 excites; orders: 2"),
        (lambda f: f["modes"]["moto"], "no station is called 'moto'; did you mean 'motor'?"),
        (lambda f: f["respons"], "no result is called 'respons'; did you mean 'response'?"),
    ],
)
def test_an_unknown_name_is_refused_with_the_nearest_one(
    look: Callable[[torsion.Findings], object], message: str
) -> None:
    with pytest.raises(KeyError) as raised:
        look(two_discs())
    assert raised.value.args == (message,)


def test_a_shaft_in_segments_has_the_torque_of_its_largest_segment() -> None:
    response = solved("usv")["response"]
    positions = [
        k
        for k, span in enumerate(response.system.spans)
        if response.system.train.parts[span.part].kind == "shaft"
    ]
    shaft = response.system.train.parts[response.system.spans[positions[0]].part].whole
    segments = [
        k
        for k in positions
        if response.system.train.parts[response.system.spans[k].part].whole == shaft
    ]
    assert len(segments) > 1
    assert response[shaft].max() == np.abs(response.torque[:, :, segments]).max()
    third = response.system.spans[segments[2]].name
    assert response[third].max() == np.abs(response.torque[:, :, segments[2]]).max()


def test_a_singular_resonance_has_no_largest_amplitude() -> None:
    text = (
        DISCS.replace("loss_factor: 0.1", "")
        .replace("from: 300 rpm", "from: 150 rad/s")
        .replace("1800 rpm", "200 rad/s")
    )
    response = torsion.run(torsion.parse(text.replace(", loss_factor", "")))["response"]
    assert (response.status != 0).any()
    assert math.isnan(response["spring"].max())
    assert "no reliable value" in repr(response["spring"])


@pytest.mark.parametrize("name", SMALL)
def test_every_key_of_a_result_is_an_attribute(name: str) -> None:
    for result in solved(name).results.values():
        if not is_declared(result):
            continue
        for quantity in quantities(type(result)):
            if quantity.key:
                assert quantity.key in dir(result)
                assert (
                    getattr(result, quantity.key) is not None
                    or getattr(result, quantity.name) is None
                )


def test_names_with_units_are_those_of_the_quantities() -> None:
    findings = two_discs()
    modes, response = findings["modes"], findings["response"]
    assert modes.frequency_Hz is modes.frequency
    assert response.torque_Nm is response.torque
    np.testing.assert_allclose(
        response.speed_rpm, response.speed_rad_per_s * 30 / math.pi, rtol=1e-15
    )
    with pytest.raises(AttributeError, match="'Modes' has no attribute 'frequency_rpm'"):
        _ = modes.frequency_rpm
    assert pickle.loads(pickle.dumps(modes)).frequency_Hz.tolist() == modes.frequency.tolist()


def test_a_dictionary_is_what_results_json_holds() -> None:
    findings = solved("usv")
    written = results(findings)
    for name in ("modes", "response"):
        assert findings[name].to_dict() == written[name]
    assert findings["checks"].to_dict()["utilisation"] == [
        check["utilisation"] for check in written["checks"]
    ]
    with pytest.raises(TypeError, match=r"findings\.to_dict"):
        findings["synthesis"].to_dict()


def test_a_data_frame_has_a_row_for_each_mode_check_and_speed_and_order() -> None:
    pytest.importorskip("pandas")
    findings = solved("usv")
    modes, checks, response = findings["modes"], findings["checks"], findings["response"]
    frame = modes.to_dataframe()
    assert frame.index.name == "mode"
    assert frame["frequency_Hz"].tolist() == modes.frequency.tolist()
    rows = checks.to_dataframe()
    assert rows["verdict"].tolist() == [check.verdict for check in checks.lines]
    assert {
        "rule",
        "clause",
        "where",
        "what",
        "value",
        "limit",
        "unit",
        "utilisation",
        "order",
    } <= set(rows)
    torques = response.to_dataframe()
    assert torques.shape[0] == response.status.size
    speed, line = response.speed.size // 2, 1
    row = torques.iloc[speed * len(response.lines) + line]
    assert row.name == (response.speed_rpm[speed], float(response.lines[line].order))
    name = torques.columns[-1].removeprefix("torque_Nm of ")
    assert row[f"torque_Nm of {name}"] == response[name].torque[speed, line]
    assert (
        response[name].to_dataframe()["torque_Nm"].tolist()
        == response[name].torque.ravel().tolist()
    )


def test_a_data_frame_needs_pandas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        two_discs()["modes"].to_dataframe()


@pytest.mark.parametrize("name", [*SMALL, "toleranced_drive", "generator_set_rules"])
def test_what_passes_in_python_passes_on_the_command_line(name: str) -> None:
    findings = solved(name)
    if any(case.study.rules for case in findings.each.values()):
        assert (findings.exit_status == 0) == (findings.passed is True)
    assert (findings.verdict == "FAIL") == (findings.passed is False)
    assert len(findings.checks) == len(findings["checks"].lines)


def test_without_a_rule_nothing_passes_or_fails() -> None:
    assert (two_discs().verdict, two_discs().passed, two_discs().failed) == (
        "NOT JUDGED",
        None,
        False,
    )


def test_the_report_in_a_folder_is_that_of_the_command(tmp_path: Path) -> None:
    paths = two_discs().report(tmp_path / "out")
    assert {"report.html", "results.json"} <= {path.name for path in paths}
    assert {path for path in (tmp_path / "out").rglob("*") if path.is_file()} == set(paths)
    (tmp_path / "train.yaml").write_text(DISCS)
    torsion.solve(tmp_path / "train.yaml", tmp_path / "command")
    assert {path.name for path in paths} == {path.name for path in (tmp_path / "command").iterdir()}


def test_one_file_of_a_report_is_written_by_its_suffix(tmp_path: Path) -> None:
    (page,) = two_discs().report(tmp_path / "two.html")
    assert "<html" in page.read_text(encoding="utf-8")
    two_discs().report(tmp_path / "two.json")
    assert (
        json.loads((tmp_path / "two.json").read_text())["modes"] == two_discs().to_dict()["modes"]
    )
    with pytest.raises(torsion.InputError, match=r"no file of a report ends in '\.docx'"):
        two_discs().report(tmp_path / "two.docx")


def test_a_figure_is_drawn_by_matplotlib_with_its_numbers() -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure = two_discs().figures["torque-1-0"]
    (axes,) = figure.to_matplotlib()
    lines = [line for line in figure.plots[0].lines if line.name]
    drawn = {line.get_label(): line.get_ydata() for line in axes.get_lines()}
    for line in lines:
        np.testing.assert_array_equal(drawn[line.name], line.y)
    assert axes.get_xlabel() == figure.plots[0].x.title
    for other in solved("usv").figures.values():
        if other.plots:
            other.to_matplotlib()[0].figure.canvas.draw()
            pyplot.close("all")
    with pytest.raises(torsion.InputError, match="use its `svg`"):
        next(
            figure for figure in solved("usv").figures.values() if not figure.plots
        ).to_matplotlib()


def built() -> torsion.Study:
    return torsion.build(
        "Two discs",
        [
            torsion.motor("motor", inertia=0.8),
            torsion.coupling("spring", stiffness="14.4 kN*m/rad", loss_factor=0.1),
            torsion.propeller("propeller", inertia=np.float64(0.2)),
        ],
        operation={"speeds": {"from": "300 rpm", "to": "1800 rpm"}},
        excitations=[{"at": "propeller", "order": 2, "torque": "25 N*m"}],
    )


def test_a_study_that_is_built_is_that_of_its_text() -> None:
    study = built()
    assert (
        study.text.splitlines()[4]
        == "- coupling: {name: spring, stiffness: 14.4 kN*m/rad, loss_factor: 0.1}"
    )
    assert study == torsion.parse(study.text)
    assert study.train == replace(torsion.parse(DISCS).train)


def test_there_is_a_constructor_for_every_kind_with_the_keys_of_the_file() -> None:
    assert set(KINDS) <= set(torsion.__all__)
    assert {"stiffness", "loss_factor", "inertia"} <= set(
        inspect.signature(torsion.coupling).parameters
    )
    with pytest.raises(torsion.InputError, match="stifness"):
        torsion.build("pair", [torsion.disc(inertia=2), torsion.coupling(stifness=1)])


@for_all("kind", KINDS)
def test_every_example_of_a_kind_is_written_by_its_constructor(kind: str) -> None:
    for entry in yaml.safe_load(component_class(kind).example):
        body = dict(entry[kind])
        name = body.pop("name", None)
        made = getattr(torsion, kind)(*([name] if name else []), **body)
        assert yaml.safe_load(made.text) == [entry]


def test_a_quantity_of_pint_is_written_with_its_unit() -> None:
    pint = pytest.importorskip("pint")
    units = pint.UnitRegistry()
    entry = torsion.coupling("spring", stiffness=14.4 * units.kN * units.m / units.rad)
    assert entry.text == "- coupling: {name: spring, stiffness: 14.4 kN*m/rad}"


def test_a_stiffness_is_varied_by_the_path_of_a_case() -> None:
    study = built()
    rpm = [
        study.with_({"spring.stiffness": k}).critical_rpm(2)[0]
        for k in (1e4, "14.4 kN*m/rad", 2e4, 2.5e4)
    ]
    exact = [
        60 * math.sqrt(k / 0.16) / (2 * math.pi) / 2 for k in (1e4, 1.44e4, 2e4, 2.5e4)
    ]  # J1 J2/(J1 + J2) = 0.16
    assert rpm == pytest.approx(exact, rel=1e-12)
    heavier = study.with_(
        factor={"propeller.inertia": 1.05},
        remove=["excitations.1"],
        **{"motor.inertia": "0.9 kg*m**2"},
    )
    assert [(change.what, change.before, change.after) for change in heavier.changes] == [
        ("motor.inertia", "0.8", "0.9 kg*m**2"),
        ("propeller.inertia", "0.2", "0.21"),
        ("excitations.1", "{at: propeller, order: 2, torque: 25 N*m}", "not given"),
    ]
    assert heavier == replace(torsion.parse(heavier.text), changes=heavier.changes)
    assert "inertia: 0.9 kg*m**2" in heavier.text


def test_a_variant_is_the_case_with_the_same_keys() -> None:
    text = (
        DISCS
        + "cases: {soft: {set: {spring.stiffness: 9 kN*m/rad}, scale: {motor.inertia: 110 %}}}\n"
    )
    study = torsion.parse(text)
    varied = study.with_({"spring.stiffness": "9 kN*m/rad"}, factor={"motor.inertia": "110 %"})
    case = study.cases["soft"]
    assert case.case is not None
    assert varied.changes == case.case.changes
    assert varied.critical_rpm(2) == case.critical_rpm(2)
    again = case.with_({"spring.stiffness": "14.4 kN*m/rad"})
    assert [change.what for change in again.changes] == ["spring.stiffness", "motor.inertia"]
    assert again.critical_rpm(2)[0] == pytest.approx(
        30 * math.sqrt(1.44e4 * (1 / 0.88 + 1 / 0.2)) / (2 * math.pi)
    )


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("spring.stifness", "unknown key `stifness`"),
        (
            "sprin.stiffness",
            "no component and no section is called `sprin` (did you mean `spring`?)",
        ),
        ("spring", "`spring` is a component without a key"),
    ],
)
def test_a_wrong_path_has_the_fault_of_a_case(path: str, message: str) -> None:
    with pytest.raises(torsion.InputError) as raised:
        built().with_({path: 2e4})
    assert message in str(raised.value)


@for_all("name", formulas.__all__)
def test_a_formula_takes_keywords_states_its_source_and_is_worked_by_hand(name: str) -> None:
    function = getattr(formulas, name)
    assert all(
        p.kind is inspect.Parameter.KEYWORD_ONLY
        for p in inspect.signature(function).parameters.values()
    )
    assert "Source: " in function.__doc__
    assert ">>> " in function.__doc__


def test_the_notebook_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    outcome = doctest.testmod(notebook_example)
    assert outcome.attempted >= 29
    assert not outcome.failed


def test_the_examples_are_typed(tmp_path: Path) -> None:
    api = pytest.importorskip("mypy.api")
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    examples = doctest.DocTestParser().get_examples(notebook_example.__doc__ or "")
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    files = {
        "example_notebook": [example.source for example in examples],
        "example_page": blocks,
    }
    for name, code in files.items():
        (tmp_path / f"{name}.py").write_text("".join(code), encoding="utf-8")
    # With the settings of the repository, so that its cache serves.
    settings = ("--config-file", str(ROOT / "pyproject.toml"))
    printed, _, status = api.run([*settings, *(str(tmp_path / f"{name}.py") for name in files)])
    assert status == 0, printed


def test_the_reference_has_every_public_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "docs" / "site")
    lines = "\n".join(import_module("python_reference").reference())
    names = [*torsion.__all__, *(f"formulas.{name}" for name in formulas.__all__)]
    missing = [name for name in names if not re.search(rf"torsion\.{re.escape(name)}\b", lines)]
    assert not missing


def test_a_train_that_nothing_excites_has_no_torque_by_name() -> None:
    study = torsion.parse(DISCS.partition("excitations")[0])
    with pytest.raises(KeyError, match="nothing excites"):
        study.response()["spring"]


def test_the_torque_of_a_motion_is_reached_by_name() -> None:
    motion = solved("fan_start")["transient"].each[0]
    torque = motion["rubber coupling"]
    assert torque.shape == motion.time_s.shape
    assert np.abs(torque).max() <= motion.peak.max() * (
        1 + 1e-9
    )  # the peak also counts what lies between samples
    assert np.abs(torque).max() > 0.99 * motion.peak.max()
    with pytest.raises(KeyError, match="did you mean 'rubber coupling'"):
        motion["rubber couplin"]


def test_findings_of_a_tilting_shaft_are_copied_to_another_process() -> None:
    findings = solved("cardan_bearings")
    assert results(pickle.loads(pickle.dumps(findings))) == results(findings)


def test_a_part_whose_name_reads_as_a_number_is_built_and_removed_by_its_name() -> None:
    train = [
        torsion.motor("1e3", inertia=1.0),
        torsion.coupling("c", stiffness=1e4),
        torsion.disc("yes", inertia=2.0),
        torsion.coupling("e", stiffness=1e4),
        torsion.disc("0x10", inertia=2.0),
    ]
    study = torsion.build("N", train)
    assert [part.name for part in study.train.parts] == ["1e3", "c", "yes", "e", "0x10"]
    shorter = study.with_(remove="0x10").with_(remove=["e"])
    assert [part.name for part in shorter.train.parts] == ["1e3", "c", "yes"]


def test_a_check_without_a_speed_has_none_in_rpm() -> None:
    check = Check("rule", "clause", "where", "what", 1.0, 2.0, "1", "pass", "rule text", None, None)
    assert check.speed_rpm is None


def test_a_result_by_two_axes_is_no_data_frame() -> None:
    pytest.importorskip("pandas")
    results = solved("usv").results
    for name in ("synthesis", "mean"):
        with pytest.raises(TypeError, match=r"no rows: use `findings\.to_dict"):
            results[name].to_dataframe()
