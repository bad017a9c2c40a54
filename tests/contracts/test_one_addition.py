"""A component, an analysis, a rule and an output are one file and one registry entry each: all else follows."""

import io
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from docs.site import model_file_manual, results_manual
from docs.site.results_manual import documented
from rich.console import Console

import torsion
from torsion import rules
from torsion.analyses import ANALYSES, Analysis
from torsion.model import KINDS
from torsion.output import renderers
from torsion.output.blocks import Heading, KeyValues, Table
from torsion.output.chapters.plant import sketch
from torsion.output.document import document
from torsion.output.pages.terminal import show
from torsion.output.renderers import Output
from torsion.output.write import write
from torsion.schema.json_schema import json_schema

COMPONENT = '''
"""Toy: a disc whose inertia follows from its diameter."""
from torsion.fields import Across, required
from torsion.model.component import Component
from torsion.model.parts import Symbol

class SolidDisc(Component, keyword="solid-disc", sort="point", symbol=Symbol("load")):
    """A solid disc is an inertia that follows from its diameter."""

    title = "solid disc"
    example = "- solid-disc: {diameter: 300 mm}"
    diameter: Across = required("diameter of every solid disc")

    def data_sheet(self):
        yield "Diameter", f"{1e3 * self.diameter:g} mm"

    def lower(self, build):
        build.inertia(build.point(), 100.0 * self.diameter**4)
'''
ANALYSIS = '''
"""Toy: how fast the rim of each disc runs."""
import numpy as np
from torsion.fields import Across, Declared, given
from torsion.arrays import FloatArray
from torsion.results import reported, result

class RimSettings(Declared):
    radius: Across = given("radius of every rim", 0.5)

@reported
class Rims:
    fastest: float = result("m/s", (), "speed of the fastest rim")
    rim: FloatArray = result("m/s", ("station",), "speed of the rim at each station")
    series: FloatArray = result("m/s", ("speed", "station"), "speed of the rims over the speed range")

def run(work):
    radius, rated = work.settings("rims", RimSettings).radius, work.study.operation.rated.speed
    rim = radius * rated * np.array([float(station.ratio) for station in work.system.stations])
    work.put(rims=Rims(float(rim.max()), rim, np.outer([0.5, 1.0], rim)))
'''
RULE = '''
"""Toy: no rim runs faster than allowed."""
from typing import Annotated
from torsion.fields import Quantity, required
from torsion.rules.verdict_line import Check, Rule, RuleSettings, verdict_of

class Allowed(RuleSettings):
    speed: Annotated[float, Quantity("m/s", above=0)] = required("highest speed of a rim")

class RimSpeed(Rule[Allowed]):
    settings_class, needs = Allowed, ("rims",)

    def judge(self, evidence):
        fastest, limit = evidence.results["rims"].fastest, self.settings.speed
        kept = verdict_of(fastest <= limit, "setting")
        return (Check("rim-speed", "v_max", "all", "speed of a rim", fastest, limit, "m/s", kept, "setting"),)
'''
OUTPUT = '''
"""Toy: the captions of the tables, one a line."""
def captions(document):
    return "\\n".join(item.block.caption for item in document.body if hasattr(item.block, "rows"))
'''
SCENE = """
name: toys
operation: {rated: {speed: 60 rad/s}}
train: [disc: {name: near, inertia: 2}, coupling: {stiffness: 120}, gear: {ratio: 2}, disc: {name: far, inertia: 3}]
analyses: {rims: {radius: 30 cm}}
rules: [{rim-speed: {speed: 10 m/s}}]
"""


@pytest.fixture
def toys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The four files and their four entries; the folder that they stand in."""
    texts = {"component": COMPONENT, "analysis": ANALYSIS, "rule": RULE, "output": OUTPUT}
    for name, text in ((f"toy_{kind}", text) for kind, text in texts.items()):
        (tmp_path / f"{name}.py").write_text(text)
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.syspath_prepend(str(tmp_path))
    entry = Analysis(
        "speed of the rims",
        "toy_analysis",
        settings="RimSettings",
        needs=("modes",),
        results={"rims": "Rims"},
    )
    monkeypatch.setitem(KINDS, "solid-disc", "toy_component:SolidDisc")
    monkeypatch.setitem(ANALYSES, "rims", entry)
    monkeypatch.setitem(rules.RULES, "rim-speed", "toy_rule:RimSpeed")
    monkeypatch.setitem(renderers.OUTPUTS, "captions", Output("toy_output:captions", ".txt"))
    return tmp_path


def test_a_component_is_in_the_train_its_sketch_its_data_sheet_and_both_manuals(toys: Path) -> None:
    text = SCENE.replace(
        "disc: {name: near, inertia: 2}", "solid-disc: {name: near, diameter: 300 mm}"
    )
    found = torsion.run(torsion.parse(text))
    assert found.system.inertia[0] == pytest.approx(100.0 * 0.3**4, rel=1e-15)
    made = document(found)
    sheets = [item.block.pairs for item in made.body if isinstance(item.block, KeyValues)]
    assert (("Component", "near"), ("Diameter", "300 mm")) in sheets
    (disc,) = [disc for disc in sketch(found).discs if disc.label == "1 near"]
    assert disc.role == "load"
    assert "diameter of every solid disc" in model_file_manual.pages()["components/solid-disc.md"]
    assert "diameter of every solid disc" in json.dumps(json_schema())


def test_an_analysis_is_in_the_results_and_in_both_manuals(toys: Path) -> None:
    found = torsion.run(torsion.parse(SCENE))
    write(found, toys / "out")
    rims = json.loads((toys / "out" / "results.json").read_text(encoding="utf-8"))["rims"]
    fastest = 0.3 * 60.0
    assert rims["fastest_m_per_s"] == pytest.approx(fastest, rel=1e-15)
    ratios = [float(station.ratio) for station in found.system.stations]
    np.testing.assert_allclose(
        rims["rim_m_per_s"], [fastest * ratio for ratio in ratios], rtol=1e-15
    )
    by_path = {key.path: key for key in documented()}
    assert (by_path["rims.rim_m_per_s"].axes, by_path["rims.rim_m_per_s"].unit) == (
        ("station",),
        "m/s",
    )
    assert "speed of the rim at each station" in "".join(results_manual.pages().values())
    assert "radius of every rim" in "".join(model_file_manual.pages().values())
    assert "radius of every rim" in json.dumps(json_schema())


def test_an_analysis_without_a_chapter_is_reported_as_declared(toys: Path) -> None:
    made = document(torsion.run(torsion.parse(SCENE)))
    assert "Speed of the rims" in [
        item.block.text for item in made.body if isinstance(item.block, Heading)
    ]
    tables = {item.block.caption: item.block for item in made.body if isinstance(item.block, Table)}
    assert tables["Single values of rims"].rows == (
        ("fastest", "18.000", "m/s", "speed of the fastest rim"),
    )
    by_station = dict(tables["Values of rims"].rows)
    assert (by_station["near"], by_station["far"]) == ("18.000", "9.0000")
    text = [point for item in made.body for point in getattr(item.block, "items", ())]
    size = f"2 by {len(by_station)} values"
    assert (
        f"speed of the rims over the speed range: {size}, `rims.series_m_per_s` of results.json"
        in text
    )
    stream = io.StringIO()
    show(made, None, Console(file=stream, width=80, color_system=None))
    assert "fastest" in stream.getvalue()
    assert max(len(line) for line in stream.getvalue().splitlines()) <= 80


def test_a_rule_is_in_the_verdicts_everywhere(toys: Path) -> None:
    found = torsion.run(torsion.parse(SCENE))
    assert found.failed
    made, stream = document(found), io.StringIO()
    show(made, None, Console(file=stream, width=80, color_system=None))
    assert "v_max" in stream.getvalue()
    assert "FAIL" in stream.getvalue()
    (row,) = next(item.block for item in made.body if isinstance(item.block, Table)).rows
    assert (*row[:5], row[-1]) == ("speed of a rim", "all", "18.000", "10", "m/s", "✗ FAIL")
    assert "v_max" in row[-2]
    assert "highest speed of a rim" in "".join(model_file_manual.pages().values())
    assert "highest speed of a rim" in json.dumps(json_schema())


def test_an_output_is_written_with_every_report(toys: Path) -> None:
    write(torsion.run(torsion.parse(SCENE)), toys / "out")
    assert (
        "Single values of rims"
        in (toys / "out" / "report.txt").read_text(encoding="utf-8").splitlines()
    )


def test_without_the_entries_the_words_are_refused() -> None:
    with pytest.raises(torsion.InputError, match=r"rims(.|\n)*rim-speed"):
        torsion.parse(SCENE)
