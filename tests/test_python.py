"""The Python front: its public names, and that it has no meaning of its own."""

import html
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

import torsion


def test_every_public_name_is_listed_and_documented() -> None:
    assert set(torsion.__all__) <= set(dir(torsion))
    assert set(dir(torsion)) - set(torsion.__all__) == {"__version__"}
    assert not [name for name in torsion.__all__ if not getattr(torsion, name).__doc__]


def test_an_unknown_name_of_the_package_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'mode'"):
        _ = torsion.mode


def test_the_import_of_the_package_loads_no_library() -> None:
    code = "import sys, torsion; print({'numpy', 'pydantic', 'yaml', 'scipy'} & set(sys.modules))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed == "set()\n"


def test_two_results_are_compared_in_python() -> None:
    text = "name: pair\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]"
    before, after = (torsion.run(torsion.parse(text.replace("120", k))) for k in ("120", "480"))
    assert not torsion.compare(before, before).is_changed
    (case,) = torsion.compare(before, after).cases
    assert case.modes[0].change == pytest.approx(1.0, rel=1e-9)  # sqrt(480/120) - 1


SPECS = Path(__file__).parents[1] / "shafting_specs"
SMALL = ("usv", "pump_1200kw", "rubber_damper", "twin_motor_ferry", "joint_run_up", "ferry_cases")


@cache
def solved(name: str) -> torsion.Findings:
    return torsion.run(torsion.read(SPECS / f"{name}.yaml"))


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
    assert repr(study.train).startswith(f"Train: {len(study.train.parts)} components ({study.train.parts[0].name}, ")
    assert repr(system) == f"System: lumped, {len(system.stations)} stations, {len(system.spans)} spans"


def test_a_notebook_shows_a_study_its_train_and_its_system_as_tables() -> None:
    findings = solved("pump_1200kw")
    for shown in (findings.study, findings.study.train, findings.system):
        page = shown._repr_html_()
        assert "<table>" in page
        assert html.escape(findings.study.train.parts[-1].name) in page
    assert findings.study._repr_html_().count("<svg") == 1
