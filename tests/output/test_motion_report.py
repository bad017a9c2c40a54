"""Report, results and terminal of the exact response and of stability: side by side, and nothing bad unmarked."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from docs.site.results_manual import documented
from rich.console import Console

import torsion
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.stability.first_order_compared import FirstOrderCompared, exact_half_range
from torsion.analyses.stability.periodic_orbits import Found, PeriodicResponse
from torsion.analyses.stability.stability_over_speed import Stability, StabilityMap
from torsion.analyses.stability.unstable_ranges import UnstableRange
from torsion.findings import Findings
from torsion.output.blocks import Block, Box, Figure, Paragraph, Table
from torsion.output.chapters import closing, verdict
from torsion.output.chapters import stability_ranges as stability
from torsion.output.chapters.modes import critical_speeds as critical
from torsion.output.chapters.response import exact_response as periodic
from torsion.output.chapters.response import forced_response as response
from torsion.output.chapters.response.exact_response import first_order_judged
from torsion.output.chapters.stability_ranges import words
from torsion.output.document import document
from torsion.output.drawing.svg import svg
from torsion.output.numbers import NONE, RPM, rpm
from torsion.output.pages.terminal import show
from torsion.output.stored.results_json import results
from torsion.rules.stable_motion import stability_check
from torsion.rules.verdict_line import Checks

KEYS = {key.path: key.meaning for key in documented()}

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
    text = text.replace("20 deg, inertia", "20 deg, phase: 90 deg, inertia").replace(
        "phase: 90 deg, ", "", 1
    )
    return torsion.run(
        torsion.parse(text.replace("96 rad/s, to: 116", "53 rad/s, to: 54"), "crossed.yaml")
    )


@pytest.fixture(scope="module")
def broken(unstable: Findings) -> Findings:
    """The same, but that one speed has no periodic motion, one a coarse one, and points of the map are missing."""
    found, grown = unstable.need(PeriodicResponse), unstable.need(StabilityMap).growth.copy()
    status, torque = found.status.copy(), found.torque.copy()
    status[:2], torque[0] = (Found.NONE, Found.COARSE), np.nan
    grown[1:3, 1] = np.nan
    why = ("Newton's method did not end", *found.why[1:])
    growth = np.where(np.arange(len(status)) == 0, np.nan, found.growth)
    stable = unstable.need(Stability)
    rates = np.where(np.arange(len(stable.speed)) == 0, np.nan, stable.growth)
    return unstable.having(
        periodic=replace(found, status=status, torque=torque, why=why, growth=growth),
        stability=replace(stable, growth=rates, unsolved=stable.speed[:1]),
        stability_map=replace(unstable.need(StabilityMap), growth=grown),
    )


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
    compared = found.need(FirstOrderCompared).each
    together = {row.component: row for row in compared if row.order is None}
    assert together.pop("a").exact > 10.0
    assert {name: row.first for name, row in together.items()} == {
        "first": 0.0,
        "b": 0.0,
        "last": 0.0,
    }
    assert all(row.exact == 0.0 and np.isnan(row.excess) for row in together.values())
    assert {row.component for row in compared if row.order is not None} == {"a"}
    stream = io.StringIO()
    show(document(found), None, Console(file=stream, width=200, color_system=None))
    text = stream.getvalue()
    assert (
        "·10⁻¹"
        not in text[text.index("Maximum vibratory torque") : text.index("Joints of a shaft line")]
    )
    table = next(block for block in response.chapter(found) if isinstance(block, Table))
    assert {row[0]: row[1] for row in table.rows if row[0] != "a"} == {
        "first": "0",
        "b": "0",
        "last": "0",
    }


def test_both_methods_stand_side_by_side_for_every_element_and_order(unstable: Findings) -> None:
    rows = table(periodic.chapter(unstable), "First order against exact").rows
    assert {row[0] for row in rows} >= {"first", "tube", "joint-1"}
    assert {row[1] for row in rows} >= {"all", "2", "4"}
    fourth = next(row for row in rows if row[:2] == ("tube", "4"))
    assert (fourth[2], fourth[6]) == ("–", "–")


def test_half_range_of_all_orders_is_that_of_the_motion_in_time(unstable: Findings) -> None:
    found = unstable.need(PeriodicResponse)
    turned = np.linspace(0.0, 2.0 * np.pi, 20001)
    wave = np.exp(1j * np.outer([float(order) for order in found.orders], turned))
    value = (found.torque[:, :, 0] @ wave).real
    half = (value.max(axis=1) - value.min(axis=1)) / 2.0
    np.testing.assert_allclose(exact_half_range(found, (0,)), half, rtol=1e-6)


def test_rules_on_the_first_order_are_told_with_the_difference_at_the_worst_point(
    unstable: Findings,
) -> None:
    worst = max(
        (row for row in unstable.need(FirstOrderCompared).each if row.order is None),
        key=lambda row: row.excess,
    )
    text = first_order_judged(unstable)
    assert worst.component in text
    assert "first-order" in text
    stated = [
        b for b in closing.conclusion(unstable) if isinstance(b, Paragraph) and b.text == text
    ]
    assert [one.kind for one in stated] == ["note"]
    assert first_order_judged(unstable.having(first_order_compared=None)) == ""


def test_every_unstable_speed_is_flagged_in_the_tables_and_marked_in_the_figures(
    unstable: Findings,
) -> None:
    blocks = [*periodic.chapter(unstable), *stability.chapter(unstable)]
    flagged = table(blocks, "with unreliable amplitudes")
    assert len(flagged.rows) == unstable.need(PeriodicResponse).is_unstable.sum() > 0
    assert set(flagged.marks) == {"fail"}
    ranges = table(blocks, "Unstable ranges")
    assert [(row[2], row[5]) for row in ranges.rows] == [("principal of mode 1 (2 w1)", "UNSTABLE")]
    drawn = {b.name: svg(b) for b in blocks if isinstance(b, Figure)}
    assert all("unstable" in text for name, text in drawn.items() if name != "stability-map")
    assert (
        next(b for b in blocks if getattr(b, "name", "") == "stability-map")
        .panels[0]
        .cells.values.max()
        > 0
    )
    assert "principal of mode 1" in drawn["stability-growth"]


def test_verdict_table_has_the_stability_and_fails(unstable: Findings) -> None:
    blocks = list(verdict.chapter(unstable))
    row = next(row for row in table(blocks, "Checks, each").rows if "stability" in row[8])
    assert row[-1] == "✗ FAIL"
    (stated,) = (block for block in blocks if isinstance(block, Box))
    assert stated.text.startswith("FAIL: ")
    assert "Unstable range" in dict(stated.lines)["Restrictions"]


def test_what_was_not_found_is_flagged_and_never_a_number(broken: Findings) -> None:
    blocks = [*periodic.chapter(broken), *stability.chapter(broken)]
    rows = table(blocks, "with unreliable amplitudes").rows
    assert [row[1] for row in rows[:2]] == ["none", "coarse"]
    assert "did not end" in rows[0][5]
    said = [block.text for block in blocks if isinstance(block, Paragraph) and block.kind == "fail"]
    assert "No periodic motion was found at 1 speed; stability is not known there." in said
    figures = [svg(block) for block in blocks if isinstance(block, Figure)]
    assert sum("no periodic motion found" in one for one in figures) == len(figures)
    stated = results(broken)["periodic"]
    assert stated["status"][:2] == ["none", "coarse"]
    assert stated["orders"][0]["torque_Nm"][0][0] == [None, None]


def test_several_motions_at_one_speed_are_told(several: Findings) -> None:
    found = several.need(PeriodicResponse).others
    said = [block.text for block in periodic.chapter(several) if isinstance(block, Paragraph)]
    (note,) = (text for text in said if "several periodic motions" in text)
    assert found.speed.size > 0
    assert all(f"{rpm(speed)} rpm" in note for speed in found.speed.tolist())


def test_every_key_of_the_exact_motion_is_documented_and_there(
    unstable: Findings, several: Findings
) -> None:
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
    keys = {key for key in KEYS if key.split(".")[0] in names}
    assert found == {
        key for key in keys if not key.startswith("stability.drifts[]")
    }  # its mean speed does not drift


def rpm_range(first: float, last: float, **ends: tuple) -> UnstableRange:
    """An unstable range between two speeds in rpm; `unknown` in rpm too."""
    unknown = tuple(None if one is None else one / RPM for one in ends.get("unknown", (None, None)))
    zone = "principal", (1,), 1
    return UnstableRange(
        *zone,
        first / RPM,
        last / RPM,
        ends.get("is_open", (False, False)),
        2.0,
        (first + last) / 2.0 / RPM,
        unknown,
    )


NAME = ", principal of mode 1 (2 w1)"


@pytest.mark.parametrize(
    ("one", "text"),
    [
        (rpm_range(772.38, 780.11), f"772.3 to 780.2 rpm{NAME}"),
        (rpm_range(772.38, 899.98), f"772.3 to 900.0 rpm{NAME}"),
        (rpm_range(300.01, 310.0), f"300.0 to 310.0 rpm{NAME}"),
        (rpm_range(300.0, 900.0), f"300.0 to 900.0 rpm{NAME}"),
        (
            rpm_range(772.38, 780.0, unknown=(None, 900)),
            f"772.3 to at least 780 rpm{NAME}; 780 to 900 rpm not known",
        ),
        (
            rpm_range(420.0, 620.43, unknown=(300, None)),
            f"at most 420 to 620.5 rpm{NAME}; 300 to 420 rpm not known",
        ),
        (
            rpm_range(500.0, 900.0, is_open=(False, True)),
            f"500.0 to 900 rpm{NAME}; continues above 900 rpm (not requested)",
        ),
        (
            rpm_range(300.0, 300.0, is_open=(True, False), unknown=(None, 420)),
            (
                f"at 300 rpm{NAME}; continues below 300 rpm (not requested); "
                "300 to 420 rpm not known"
            ),
        ),
    ],
)
def test_ends_of_a_range_are_told_as_boundaries_only_where_they_are(
    one: UnstableRange, text: str
) -> None:
    assert words(one, (300.0 / RPM, 900.0 / RPM)) == text


def test_boundary_is_not_rounded_beyond_the_speeds_asked_for() -> None:
    assert words(rpm_range(333.34, 400.0), (333.33 / RPM, 399.99 / RPM)).startswith(
        "333.33 to 399.99 rpm"
    )


def known(findings: Findings, *ranges: UnstableRange) -> Findings:
    """The same with other unstable ranges."""
    return findings.having(stability=replace(findings.need(Stability), ranges=ranges))


def shown(findings: Findings) -> str:
    out = io.StringIO()
    show(document(findings), console=Console(file=out, width=160))
    return out.getvalue()


def test_open_and_unknown_ends_are_marked_in_report_terminal_and_json(unstable: Findings) -> None:
    ends = rpm_range(950.0, 960.0, is_open=(True, False), unknown=(None, 990))
    marked = known(unstable, ends, rpm_range(1000.0, 1010.0))
    (first, second) = table(stability.chapter(marked), "Unstable ranges").rows
    assert (first[0], first[1]) == ("950.000000", "960.000000")
    assert first[-1].endswith("960 to 990 rpm not known")
    assert second[-1] == NONE
    assert "960 to 990 rpm not known" in " ".join(shown(marked).split())
    stated = results(marked)["stability"]["ranges"][0]
    assert stated["goes_on"] == [True, False]
    assert stated["unknown_to_rad_per_s"] == [None, pytest.approx(990.0 / RPM)]
    assert "goes on" not in shown(known(unstable, rpm_range(1000.0, 1010.0)))


def test_stretch_without_a_motion_is_told_once_in_the_conclusion(unstable: Findings) -> None:
    speed, growth = np.array([900.0, 930.0, 960.0, 1000.0, 1040.0, 1080.0]) / RPM, np.full(6, -1.0)
    growth[[2, 4]] = np.nan
    bare = replace(
        unstable.need(Stability),
        speed=speed,
        growth=growth,
        unsolved=speed[[2, 4]],
        requested=np.ones(6, dtype=bool),
    )
    one = rpm_range(910.0, 930.0, unknown=(None, 1000))
    stated = " ".join(shown(known(unstable.having(stability=bare), one)).split())
    assert stated.count("rpm not known. Not for operation.") == 1
    assert (
        "No periodic motion was found from 1000 to 1080 rpm; stability is not known there."
        in stated
    )
    assert "found from 930" not in stated


def test_map_that_misses_the_unstable_ranges_is_not_told_as_stable(unstable: Findings) -> None:
    mapped = unstable.need(StabilityMap)
    quiet = unstable.having(stability_map=replace(mapped, growth=np.full_like(mapped.growth, -1.0)))
    missed = known(
        quiet,
        rpm_range(*(mapped.speed[:2] * RPM + [1.0, -1.0])),
        rpm_range(*(mapped.speed[1:3] * RPM)),
    )
    blocks = list(stability.chapter(missed))
    said = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
    assert f"Small deviations grow at 0 of {mapped.value.size} values" in said
    assert "It does not show 1 of the 2 unstable ranges above" in said
    said = " ".join(
        block.text for block in stability.chapter(unstable) if isinstance(block, Paragraph)
    )
    assert "between them" not in said


def test_train_without_any_periodic_motion_is_told_as_one_without_an_answer(
    unstable: Findings,
) -> None:
    found, stable = unstable.need(PeriodicResponse), unstable.need(Stability)
    number = len(found.speed)
    none = replace(
        found,
        status=np.full(number, Found.NONE, dtype=np.uint8),
        harmonics=np.zeros(number, dtype=int),
        truncation=np.full(number, np.nan),
        torque=np.full_like(found.torque, np.nan),
        growth=None,
        drive=np.full(number, np.nan),
        why=("none",) * number,
    )
    bare = replace(
        stable,
        growth=np.full_like(stable.growth, np.nan),
        ranges=(),
        unsolved=stable.speed,
        check=np.nan,
    )
    check = stability_check(bare, unstable.study.operation)
    others = tuple(one for one in unstable.need(Checks).lines if one.clause != "stability")
    nothing = unstable.having(periodic=none, stability=bare, checks=Checks((*others, check)))
    blocks = [*stability.chapter(nothing), *periodic.chapter(nothing)]
    said = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
    assert "too large" not in said
    assert "no growth rate is known" in said
    assert "no periodic motion at any of them" in said
    assert "harmonics of the common period" not in said
    (row,) = (
        row for row in table(verdict.chapter(nothing), "Checks, each").rows if "stability" in row[8]
    )
    assert row[2:5] == ("no finite value", "0", "1/s")
    printed = " ".join(shown(nothing).split())
    assert "no solution" in printed
    assert f"no periodic motion was found at any of the {stable.speed.size} speeds tried" in printed
    assert "∞" not in printed


def test_one_of_a_thing_is_told_in_the_singular(unstable: Findings, undamped: Findings) -> None:
    assert "has 1 of 1 critical speed." in list(critical.chapter(undamped))[1].text
    line = replace(unstable.need(Response), lines=unstable.need(Response).lines[:1])
    said = " ".join(
        b.text for b in response.chapter(unstable.having(response=line)) if isinstance(b, Paragraph)
    )
    assert said.startswith("1 harmonic component at ")


def test_terminal_prints_both_methods_and_the_unstable_ranges(unstable: Findings) -> None:
    out = io.StringIO()
    show(document(unstable), console=Console(file=out, width=80))
    assert "Exact periodic response" in out.getvalue()
    assert "principal of mode 1" in out.getvalue()
