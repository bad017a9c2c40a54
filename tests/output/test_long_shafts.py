"""Very long shafts in a report: every segment is reported."""

import json
from datetime import date
from typing import Any

import numpy as np
import pytest

import torsion
from torsion.analyses.modes.holzer import holzer
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Figure, Table
from torsion.output.chapters.modes.natural_frequencies import appendix, chapter
from torsion.output.document import document
from torsion.output.pages.html import html
from torsion.output.stored.results_json import text

SCENE = """
name: two long shafts
operation: {rated: {speed: 100 rad/s, power: 1 kW}}
train:
  - disc: {name: a, inertia: 1.0}
  - shaft: {name: long, length: 20 m, diameter: 0.1 m, segments: 5003}
  - disc: {name: b, inertia: 2.0}
  - shaft: {name: short, length: 1 m, diameter: 0.1 m, segments: 3}
  - disc: {name: c, inertia: 1.0}
analyses: {modes: {count: 3}}
"""


@pytest.fixture(scope="module")
def long() -> Findings:
    """Two shafts, one of more segments than are stated."""
    return torsion.run(torsion.parse(SCENE))


@pytest.fixture(scope="module")
def results(long: Findings) -> dict[str, Any]:
    """Its results as they are read back."""
    return json.loads(text(long))


def test_every_segment_of_a_long_shaft_is_among_the_results(long, results):
    system = long.system
    inertia = [station["inertia_kg_m2"] for station in results["stations"]]
    assert inertia == system.inertia.tolist()
    assert [span["flexibility_rad_per_Nm"] for span in results["spans"]] == (
        system.flexibility.tolist()
    )
    modes = torsion.modes(system, 3)
    np.testing.assert_array_equal(results["modes"]["shape_rad"], modes.shape.T)
    for key, energy in (
        ("kinetic_share", system.inertia[:, None] * modes.shape**2),
        ("elastic_share", system.flexibility[:, None] * modes.torque**2),
    ):
        share = np.array(results["modes"][key]).T
        np.testing.assert_allclose(share, energy / energy.sum(axis=0), rtol=1e-9, atol=1e-14)


def test_segments_follow_one_another_from_the_driving_to_the_driven_station(long, results):
    row = [span for span in results["spans"] if span["component"] == "long"]
    names = [station["name"] for station in results["stations"]]
    assert [span["name"] for span in row] == [f"long [{k}]" for k in range(1, 5004)]
    assert [span["driving_station"] for span in row[1:]] == [
        span["driven_station"] for span in row[:-1]
    ]
    assert names[row[2]["driven_station"]] == "long 3/5003"
    ends = long.system.train["long"].stations
    assert (row[0]["driving_station"], row[-1]["driven_station"]) == (ends[0], ends[-1])


def test_a_mode_of_a_long_shaft_is_drawn_by_every_segment(long):
    figure = next(block for block in chapter(long) if isinstance(block, Figure))
    angles = figure.plots[0]
    assert sum(line.x.size for line in angles.lines) >= len(long.system.stations)
    assert max(np.nanmax(np.abs(line.y)) for line in angles.lines) == pytest.approx(1.0, rel=1e-12)


def _value(cell: str) -> float:
    """A printed number: "−1.2346·10⁷"."""
    plain = cell.translate(str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789"))
    return float(plain.replace("·10", "e"))


def test_the_holzer_table_has_a_long_shaft_as_one_row(long):
    printed = next(
        b for b in appendix(long) if isinstance(b, Table) and b.caption.startswith("Holzer")
    )
    assert [row[1] for row in printed.rows] == ["a", "b", "c"]
    inertia = np.array([_value(row[2]) for row in printed.rows])
    assert inertia == pytest.approx(long.system.lumped_inertia[:3], rel=1e-6)
    found = holzer(long.system, long.need(Modes), 0)
    assert found.relative_residual < 1e-12
    for row in (1, 2):
        ends = found.transfer[row] @ (found.angle[row - 1], found.torque_in[row])
        assert ends == pytest.approx([found.angle[row], found.torque_out[row]], rel=1e-10)


@pytest.mark.parametrize("inertia", ["inertia: 1, damping: 2", "inertia: 1", "held: true"])
def test_a_train_of_one_station_and_no_span_has_a_report(inertia):
    excited = (
        "" if "held" in inertia else ", ripple: [{order: 1, torque: 3}, {order: 2, torque: 1}]"
    )
    speeds = "operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 3}}\n"
    found = torsion.run(torsion.parse(f"name: x\n{speeds}train: [motor: {{{inertia}{excited}}}]\n"))
    assert [station["name"] for station in json.loads(text(found))["stations"]] == ["motor-1"]
    assert "motor-1" in html(document(found, date(2026, 1, 1)))


def test_a_train_of_one_station_has_a_response_over_frequency():
    requested = "{response: {frequencies: {from: 1, to: 20, steps: 20}}}"
    found = torsion.run(
        torsion.parse(
            f"name: x\ntrain: [disc: {{name: wheel, inertia: 2}}]\nanalyses: {requested}\n"
            "excitations: [{at: wheel, torque: 10}]\n"
        )
    )
    page = html(document(found, date(2026, 1, 1)))
    assert "Angular amplitude over the frequency" in page
    assert "Maximum torque amplitude" not in page
