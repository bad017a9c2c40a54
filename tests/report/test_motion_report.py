"""Report, results and terminal of the exact response and of stability: side by side, and nothing bad unmarked."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

import torsion
from torsion.analyses.motion.periodic import Found
from torsion.findings import Findings
from torsion.report.blocks import Block, Figure, Paragraph, Table
from torsion.report.chapters import periodic, response, stability, verdict
from torsion.report.figures import svg
from torsion.report.json.keys import KEYS
from torsion.report.json.results import results
from torsion.report.motion import compared, exact_half_range, first_order_judged
from torsion.report.terminal.tables import show

TRAIN = """
name: six stations
operation:
  speeds: {from: 96 rad/s, to: 116 rad/s, steps: 6}
  load: constant
  rated: {speed: 100 rad/s, power: 30 kW}
train:
  - motor: {inertia: 2.0, damping: 0.5}
  - coupling: {name: first, stiffness: 2e4, viscous: 0.4, vibratory_torque: 500 N*m}
  - joint: {angle: 25 deg, inertia: [0.02, 0.02]}
  - coupling: {name: tube, stiffness: 1.5e4, viscous: 0.3}
  - joint: {angle: 25 deg, inertia: [0.02, 0.02]}
  - coupling: {stiffness: 3e4, viscous: 0.6}
  - disc: {name: screw, inertia: 0.8, damping: 1.5}
analyses:
  response:
  stability: {map: {over: angle, from: 20 deg, to: 30 deg, steps: 3}}
rules: [coupling-maker]
"""


@pytest.fixture(scope="module")
def unstable() -> Findings:
    return torsion.run(torsion.parse(TRAIN, "six.yaml"))


@pytest.fixture(scope="module")
def several() -> Findings:
    """The yokes crossed: near resonance there is more than one motion."""
    text = TRAIN[: TRAIN.index("  stability:")].replace("25 deg", "20 deg")
    text = text.replace("20 deg, inertia", "20 deg, phase: 90 deg, inertia").replace("phase: 90 deg, ", "", 1)
    return torsion.run(torsion.parse(text.replace("96 rad/s, to: 116", "53 rad/s, to: 54"), "crossed.yaml"))


@pytest.fixture(scope="module")
def broken(unstable: Findings) -> Findings:
    """The same, but that one speed has no periodic motion, one a coarse one, and points of the map are missing."""
    found, grown = unstable.periodic, unstable.stability_map.growth.copy()
    status, torque = found.status.copy(), found.torque.copy()
    status[:2], torque[0] = (Found.NONE, Found.COARSE), np.nan
    grown[1:3, 1] = np.nan
    why = ("Newton's method did not end", *found.why[1:])
    growth = np.where(np.arange(len(status)) == 0, np.nan, found.growth)
    stable = unstable.stability
    rates = np.where(np.arange(len(stable.speed)) == 0, np.nan, stable.growth)
    return replace(
        unstable, periodic=replace(found, status=status, torque=torque, why=why, growth=growth),
        stability=replace(stable, growth=rates, unsolved=stable.speed[:1]),
        stability_map=replace(unstable.stability_map, growth=grown),
    )  # fmt: skip


def table(blocks: list[Block], words: str) -> Table:
    return next(block for block in blocks if isinstance(block, Table) and words in block.caption)


CANCELLED = """
name: two joints in W
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 3}, rated: {speed: 600 rpm, power: 20 kW}}
train:
  - motor: {inertia: 1, damping: 1}
  - coupling: {name: first, stiffness: 1e4, viscous: 5}
  - joint: {name: a, angle: 20 deg}
  - joint: {name: b, angle: 20 deg}
  - coupling: {name: last, stiffness: 1e4, viscous: 5}
  - disc: {inertia: 1, damping: 2}
analyses: {response: {method: harmonic-balance}}
"""


def test_what_two_joints_cancel_to_rounding_is_told_as_nothing_and_without_percentages() -> None:
    """The massless body between two like joints alone turns unevenly; the rest turns evenly to the last digit."""
    found = torsion.run(torsion.parse(CANCELLED, "w.yaml"))
    together = {row.element.name: row for row in compared(found) if row.order is None}
    assert together.pop("a").exact[0] > 10.0
    assert {name: row.first[0] for name, row in together.items()} == {"first": 0.0, "b": 0.0, "last": 0.0}
    assert all(row.exact[0] == 0.0 and np.isnan(row.excess) for row in together.values())
    assert {row.element.name for row in compared(found) if row.order is not None} == {"a"}
    stream = io.StringIO()
    show(found, None, Console(file=stream, width=200, color_system=None))
    text = stream.getvalue()
    assert "·10⁻¹" not in text[text.index("Largest vibratory torque") : text.index("Joints of a shaft line")]
    table = next(block for block in response.chapter(found) if isinstance(block, Table))
    assert {row[0]: row[1] for row in table.rows if row[0] != "a"} == {"first": "0", "b": "0", "last": "0"}


def test_both_methods_stand_side_by_side_for_every_element_and_order(unstable: Findings) -> None:
    rows = table(periodic.chapter(unstable), "First order against exact").rows
    assert {row[0] for row in rows} >= {"first", "tube", "joint-1"}
    assert {row[1] for row in rows} >= {"all", "2", "4"}
    fourth = next(row for row in rows if row[:2] == ("tube", "4"))
    assert (fourth[2], fourth[6]) == ("–", "–")


def test_half_range_of_all_orders_is_that_of_the_motion_in_time(unstable: Findings) -> None:
    found = unstable.periodic
    turned = np.linspace(0.0, 2.0 * np.pi, 20001)
    wave = np.exp(1j * np.outer([float(order) for order in found.orders], turned))
    value = (found.torque[:, :, 0] @ wave).real
    half = (value.max(axis=1) - value.min(axis=1)) / 2.0
    np.testing.assert_allclose(exact_half_range(unstable, (0,)), half, rtol=1e-6)


def test_rules_on_the_first_order_are_told_with_the_difference_at_the_worst_point(unstable: Findings) -> None:
    worst = max((row for row in compared(unstable) if row.order is None), key=lambda row: row.excess)
    text = first_order_judged(unstable)
    assert worst.element.name in text
    assert "first-order" in text
    told = [b for b in verdict.conclusion(unstable) if isinstance(b, Paragraph) and b.text == text]
    assert [one.kind for one in told] == ["note"]
    assert first_order_judged(replace(unstable, periodic=None)) == ""


def test_every_unstable_speed_is_flagged_in_the_tables_and_marked_in_the_figures(unstable: Findings) -> None:
    blocks = [*periodic.chapter(unstable), *stability.chapter(unstable)]
    flagged = table(blocks, "not to be relied on")
    assert len(flagged.rows) == unstable.periodic.is_unstable.sum() > 0
    assert set(flagged.marks) == {"fail"}
    ranges = table(blocks, "Unstable ranges")
    assert [(row[2], row[6]) for row in ranges.rows] == [("principal of mode 1 (2 w1)", "UNSTABLE")]
    drawn = {b.name: svg(b) for b in blocks if isinstance(b, Figure)}
    assert all("unstable" in drawn[name] for name in drawn)
    assert "principal of mode 1" in drawn["stability-growth"]


def test_verdict_table_has_the_stability_and_fails(unstable: Findings) -> None:
    blocks = verdict.chapter(unstable)
    row = next(row for row in table(blocks, "Checks against").rows if "stability" in row[0])
    assert row[-1] == "FAIL"
    assert any("Unstable range" in item for block in blocks for item in getattr(block, "items", ()))


def test_what_was_not_found_is_flagged_and_never_a_number(broken: Findings) -> None:
    blocks = [*periodic.chapter(broken), *stability.chapter(broken)]
    rows = table(blocks, "not to be relied on").rows
    assert [row[1] for row in rows[:2]] == ["none found", "coarse"]
    assert "did not end" in rows[0][4]
    assert table(blocks, "Speeds without an answer").marks == ("fail",)
    values = table(blocks, "by value")
    assert "in part unknown" in values.rows[1][-1]
    figures = [svg(block) for block in blocks if isinstance(block, Figure)]
    assert sum("no periodic motion found" in one for one in figures) == len(figures) - 1
    told = results(broken)["periodic"]
    assert told["status"][:2] == ["none", "coarse"]
    assert told["orders"][0]["torque_Nm"][0][0] == [None, None]


def test_several_motions_at_one_speed_are_told_with_their_growth(several: Findings) -> None:
    found = several.periodic.others
    rows = table(periodic.chapter(several), "at the same speed").rows
    assert [row[1] for row in rows].count("another") == found.speed.size > 0
    assert rows[0][1] == "told"
    told, another = (float(row[2]) for row in rows[:2])
    assert another == pytest.approx(np.abs(found.torque[0]).max(), rel=1e-4)
    assert abs(told - another) > 0.01 * told


def test_every_key_of_the_exact_motion_is_documented_and_there(unstable: Findings, several: Findings) -> None:
    made = {**results(unstable), "periodic": results(several)["periodic"]}
    json.dumps(made, allow_nan=False)

    def leaves(value: object, at: str) -> set[str]:
        if at in KEYS:
            return {at}
        if isinstance(value, dict):
            return set().union(*(leaves(part, f"{at}.{key}") for key, part in value.items()))
        if isinstance(value, list):
            return set().union(*(leaves(part, f"{at}[]") for part in value))
        return {at}

    names = ("periodic", "stability", "stability_map")
    found = set().union(*(leaves(made[name], name) for name in names))
    assert found == {key for key in KEYS if key.split(".")[0] in names}


def test_terminal_prints_both_methods_and_the_unstable_ranges(unstable: Findings) -> None:
    out = io.StringIO()
    show(unstable, console=Console(file=out, width=80))
    assert "Exact periodic response" in out.getvalue()
    assert "principal of mode 1" in out.getvalue()
