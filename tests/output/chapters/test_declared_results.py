"""An analysis that declares no chapter: every quantity of its results stands in it, or is named with its key."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import torsion
from torsion.analyses import ANALYSES, Analysis
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Heading, Points, Table
from torsion.output.chapters import chapters
from torsion.output.chapters.declared_results import chapter
from torsion.output.reports import Report
from torsion.results import reported, result

TEXT = """
name: x
train:
- disc: {name: a, inertia: 1}
- shaft: {name: s, length: 1 m, diameter: 50 mm, segments: 3}
- disc: {name: b, inertia: 1}
- coupling: {name: c, stiffness: 100}
- disc: {name: d, inertia: 1}
"""


@reported
class Part:
    """A record."""

    rim_speed: float = result("m/s", (), "of the rim")


@reported
class Toys:
    """One of everything that a result can hold."""

    how_many: int = result("", (), "number of toys", default=2)
    share: float | None = result("1", (), "of all", default=None)
    height: FloatArray = result("m", ("station",), "of every station", default=None)
    width: FloatArray = result("mm", ("station",), "across", default=None)
    twist: FloatArray = result("rad", ("span",), "of every span", default=None)
    torque: FloatArray = result(
        "N*m", ("speed", "span"), "in every element", default=None, printed=("element", "speed")
    )
    mark: FloatArray = result("", ("toy",), "of every toy", default=None)
    ends: FloatArray = result("s", ("end",), "first and last", default=None)
    parts: tuple[Any, ...] = result("", (), "all", default=())


@pytest.fixture(scope="module")
def train() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def blocks(findings: Findings, **fields: Any) -> list[Any]:
    system = findings.system
    made = Toys(
        height=np.arange(1.0, len(system.stations) + 1),
        width=np.arange(11.0, len(system.stations) + 11),
        twist=np.arange(21.0, len(system.spans) + 21),
        torque=np.ones((2, len(system.spans))),
        mark=np.arange(60.0),
        ends=np.array([1.0, 2.0]),
    )
    toys = Analysis("toys of the train", "x", results={"toys": "x:Toys", "more": "x:Toys"})
    return chapter(toys, findings.having(toys=replace(made, **fields)))


def tables(made: list[Any]) -> dict[str, Table]:
    return {block.caption: block for block in made if isinstance(block, Table)}


def test_every_quantity_stands_in_a_table_or_is_named(train: Findings) -> None:
    made = blocks(train)
    assert made[0] == Heading("Toys of the train")
    found = tables(made)
    assert list(found) == [
        "Single values of toys",
        "Values of toys",
        "Values of toys_by_span",
        "Values of toys_by_toy",
        "Values of toys_by_end",
    ]
    single = found["Single values of toys"]
    assert single.rows[:2] == (
        ("how many", "2", "", "number of toys"),
        ("share", "–", "1", "of all"),
    )
    assert single.short == "toys"
    stations = found["Values of toys"]
    names = [station.name for station in train.system.stations]
    assert stations.rows == tuple(
        (name, f"{k + 1:.4f}", f"{k + 11:.3f}") for k, name in enumerate(names)
    )
    assert [(one.title, one.short) for one in stations.columns] == [
        ("station", "station"),
        ("height_m", "height_m"),
        ("width_mm", "width_mm"),
    ]
    spans = [span.name for span in train.system.spans]
    assert [row[0] for row in found["Values of toys_by_span"].rows] == spans
    marks = [row[0] for row in found["Values of toys_by_toy"].rows]
    assert marks == [str(k) for k in range(1, 61)]
    (named,) = [block.items for block in made if isinstance(block, Points)]
    shape = f"2 by {len(spans)}"
    assert named == (f"in every element: {shape} values, `toys.torque_Nm` of results.json",)


def test_places_of_another_number_than_the_stations_are_counted(train: Findings) -> None:
    rows = tables(blocks(train, height=np.arange(3.0), width=np.arange(3.0)))["Values of toys"].rows
    assert [row[0] for row in rows] == ["1", "2", "3"]


def test_records_within_a_result_have_their_own_table(train: Findings) -> None:
    made = blocks(train, parts=tuple(Part(float(k)) for k in range(3)))
    assert tables(made)["Values of toys_parts"].rows == (("0",), ("1.0000",), ("2.0000",))


def test_nothing_where_nothing_was_found(train: Findings) -> None:
    assert chapter(Analysis("toys", "x", results={"toys": "x:Toys"}), train) == []


def test_it_stands_for_the_chapters_of_the_analysis(
    train: Findings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where one of its results was found, though another was not."""
    monkeypatch.setitem(
        ANALYSES, "parts", Analysis("parts", "x", results={"part": "x:Part", "more": "x:Part"})
    )
    report = Report("r", ("@parts",), "stem")
    assert chapters(train, report) == []
    head, made = chapters(train.having(part=Part(3.0)), report)
    assert head == Heading("Parts")
    assert isinstance(made, Table)
    assert made.rows == (("rim speed", "3.0000", "m/s", "of the rim"),)
