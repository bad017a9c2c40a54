"""Very long shafts in a report: segment groups stand for their segments."""

import json
from datetime import date
from typing import Any

import numpy as np
import pytest

import torsion
from torsion.analyses.modes.holzer import holzer
from torsion.analyses.undamped_modes import Modes
from torsion.assembly.system import MOST_GROUPS, segment_groups
from torsion.findings import Findings
from torsion.output.blocks import Figure, Table
from torsion.output.chapters.natural_frequencies import MOST_SEGMENTS, appendix, chapter
from torsion.output.document import document
from torsion.output.html import html
from torsion.output.results_json import text

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


def test_the_results_of_a_long_shaft_are_few_and_sum_to_the_same(long, results):
    whole, modes = long.system, long.need(Modes)
    assert len(whole.stations) == 5007
    assert len(results["stations"]) < 2100
    assert len(results["spans"]) < 2100
    inertia = [station["inertia_kg_m2"] for station in results["stations"]]
    assert sum(inertia) == pytest.approx(whole.inertia.sum(), rel=1e-13)
    flexibility = [span["flexibility_rad_per_Nm"] for span in results["spans"]]
    assert sum(flexibility) == pytest.approx(whole.flexibility.sum(), rel=1e-13)
    for key, number in (("kinetic_share", inertia), ("elastic_share", flexibility)):
        share = np.array(results["modes"][key])
        assert share.shape == (3, len(number))
        np.testing.assert_allclose(share.sum(axis=1), 1.0, rtol=1e-13)
    assert np.array(results["mean"]["torque_Nm"]).shape[0] == len(flexibility)
    by_name = {station.name: k for k, station in enumerate(whole.stations)}
    place = [by_name[station["name"]] for station in results["stations"]]
    alone = torsion.modes(whole, 3)
    np.testing.assert_array_equal(results["modes"]["shape_rad"], alone.shape[place].T)
    np.testing.assert_array_equal(modes.shape, alone.shape)


def test_stretches_follow_one_another_from_the_driving_to_the_driven_station(long, results):
    row = [span for span in results["spans"] if span["component"] == "long"]
    names = [station["name"] for station in results["stations"]]
    assert (row[0]["name"], row[-1]["name"]) == ("long [1..3]", "long [5003]")
    assert [span["driving_station"] for span in row[1:]] == [
        span["driven_station"] for span in row[:-1]
    ]
    assert names[row[0]["driven_station"]] == "long 3/5003"
    ends = long.system.train.part("long").stations
    assert (row[0]["driving_station"], row[-1]["driven_station"]) == (ends[0], ends[-1])
    assert [span["name"] for span in results["spans"] if span["component"] == "short"] == [
        f"short [{k}]" for k in (1, 2, 3)
    ]


def test_a_train_without_long_shafts_is_told_whole(long):
    every = segment_groups(long.system, 6000)
    assert every.is_whole
    np.testing.assert_array_equal(every.stations, np.arange(len(long.system.stations)))
    np.testing.assert_array_equal(
        every.ends, np.column_stack([long.system.driving, long.system.driven])
    )
    assert every.names() == [span.name for span in long.system.spans]


def test_a_mode_of_a_long_shaft_is_drawn_in_stretches_and_the_caption_says_so(long):
    figure = next(block for block in chapter(long) if isinstance(block, Figure))
    angles, torques = figure.plots
    assert sum(line.x.size for line in angles.lines) <= MOST_SEGMENTS + 20
    assert sum(line.x.size for line in torques.lines) <= 2 * (MOST_SEGMENTS + 20)
    assert "drawn with every 11th segment" in figure.caption
    assert max(np.nanmax(np.abs(line.y)) for line in angles.lines) == pytest.approx(1.0, rel=1e-3)


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
    every = segment_groups(found.system, MOST_SEGMENTS)
    assert (every.names(), every.ends.shape, every.spans.size) == ([], (0, 2), 0)
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
    assert "Maximum angular amplitude" in page
    assert "Maximum torque amplitude" not in page


def test_totals_of_a_group_are_those_of_its_own_segments(long) -> None:
    """Inertia and flexibility, and of a mode J angle^2 and torque^2 / k, from the station after the group before."""
    system = long.system
    results, modes = json.loads(text(long)), torsion.modes(system, 3)
    kinetic, elastic = (
        system.inertia[:, None] * modes.shape**2,
        system.flexibility[:, None] * modes.torque**2,
    )
    groups = segment_groups(system, MOST_GROUPS)
    stations = {station.name: place for place, station in enumerate(system.stations)}
    outer = [stations[row["name"]] for row in results["stations"]]
    inner = [0, *(place + 1 for place in outer[:-1])]
    starts = groups.spans.tolist()
    for rows, limits, unit, energy in (
        (
            "stations",
            zip(inner, [place + 1 for place in outer], strict=True),
            "inertia_kg_m2",
            kinetic,
        ),
        (
            "spans",
            zip(starts, [*starts[1:], len(system.spans)], strict=True),
            "flexibility_rad_per_Nm",
            elastic,
        ),
    ):
        key, whole = (
            ("kinetic_share", system.inertia)
            if rows == "stations"
            else ("elastic_share", system.flexibility)
        )
        share = np.array(results["modes"][key])
        for place, (begin, end) in enumerate(limits):
            assert results[rows][place][unit] == pytest.approx(whole[begin:end].sum(), rel=1e-12)
            exact = energy[begin:end].sum(axis=0) / energy.sum(axis=0)
            np.testing.assert_allclose(share[:, place], exact, rtol=1e-9, atol=1e-14)
