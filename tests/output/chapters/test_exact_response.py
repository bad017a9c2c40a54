"""Every cell, word and curve of the chapter on the exact response, of torques that are all written by hand."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from tests.output.drawn import bands, levels, marks, unit

import torsion
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.stability.first_order_compared import (
    compare_first_order,
    exact_half_range,
)
from torsion.analyses.stability.periodic_orbits import Found, PeriodicResponse
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table
from torsion.output.chapters.response.exact_response import MODEL, chapter, first_order_judged
from torsion.output.stored.scene import elements

RPM = 30.0 / math.pi
TRAIN = """
name: three joints, the second behind 3:1, the last behind 6:1
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 3}, rated: {speed: 750 rpm, power: 1 kW}}
train:
- motor: {name: drive, inertia: 2}
- coupling: {name: first, stiffness: 2e4, viscous: 0.4, vibratory_torque: 500}
- joint: {name: front, angle: 10 deg}
- shaft: {name: tube, length: 1, diameter: 0.05, segments: 2}
- gear: {name: stage, ratio: 3, inertia: [0.1, 0.2], mesh_stiffness: 1e6}
- joint: {name: rear, angle: 12 deg}
- coupling: {name: last, stiffness: 3e4, viscous: 0.6}
- gear: {name: down, ratio: 2, inertia: [0.1, 0.2]}
- joint: {name: end, angle: 9 deg}
- disc: {name: screw, inertia: 0.8}
analyses: {modes: {count: 1}}
"""
FIRST_SPEED = np.array([40.0, 60.0, 80.0, 90.0])  # rad/s
SPEED = np.array([45.0, 65.0, 85.0])
LINES = (Fraction(1, 2), Fraction(2, 3), Fraction(2))
ORDERS = (Fraction(2, 3), Fraction(4, 3), Fraction(2), Fraction(4))
FIRST = {  # (speeds, lines) N m
    "first": [[10, 20, 30], [40, 50, 60], [11, 7000, 33], [44, 55, 66]],
    "tube": [[1, 2, 3], [4, 5, 6], [7, 8, 9], [10, 200, 12]],
    "last": [[9, 0, 7], [6, 5, 4], [3, 2, 1], [8, 11, 12]],
}
EXACT = {  # (speeds, orders) N m
    "first": [[2000, 9, 80, 2], [8000, 500, 70, 79.9], [3000, 400, 60, 3]],
    "tube": [[100, 10, 20, 30], [40, 11, 21, 31], [50, 12, 22, 32]],
    "last": [[0.1, 0, 0, 0], [0.2, 0, 0, 0.01], [1.0, 0, 0.005, 0]],
}
HALF = {
    "first": [6000, 6100, 6400, 6200],
    "tube": [160, 110, 120, 130],
    "last": [4, 8, 5, 6],
}  # (speeds,) N m


@pytest.fixture(scope="module")
def train() -> Findings:
    return torsion.run(torsion.parse(TRAIN))


def laid(train: Findings, sizes: dict[str, Any], *axes: int) -> np.ndarray:
    """(axes, spans) values of the elements; the shaft has them in its second segment and half of them in its first."""
    found = np.zeros((*axes, len(train.system.spans)))
    for element in elements(train.system):
        for k, span in enumerate(element.spans):
            share = 1.0 if k == len(element.spans) - 1 else 0.5
            found[..., span] = share * np.array(sizes.get(element.name, 0.0))
    return found


def exact(train: Findings, torque: np.ndarray, **changed: Any) -> PeriodicResponse:
    """A periodic response at three speeds; `is_unstable` is given as it stands in the results."""
    unstable = changed.pop("is_unstable", [False] * 3)
    number = len(torque)
    found = PeriodicResponse(
        speed=SPEED[:number],
        orders=ORDERS,
        angle=np.empty(0),
        torque=torque * np.exp(0.7j),
        mean=np.empty(0),
        drive=np.array([11.5, 14.25, 12.75])[:number],
        harmonics=np.array([12, 14, 13])[:number],
        truncation=np.array([1.5e-12, 2.5e-11, np.nan])[:number],
        status=np.zeros(number, dtype=np.uint8),
        why=("",) * number,
        orbits=(None,) * number,
        growth=np.array([-0.25, 0.75, -0.5])[:number],
    )
    found = replace(found, **changed)
    vars(found)["is_unstable"] = np.array(unstable)
    return found


def answered(
    train: Findings, first: dict[str, Any] = FIRST, torque: dict[str, Any] = EXACT, **changed: Any
) -> Findings:
    """Both responses and the synthesis; of the first order the middle line is in phase with the exact one."""
    lines = tuple(Line(order, None, ("joint",)) for order in LINES)
    both = Response(
        FIRST_SPEED,
        np.ones(4, dtype=bool),
        changed.pop("lines", lines),
        np.ones((4, 3)),
        np.empty(0),
        laid(train, first, 4, 3) * 1j,
        np.zeros((4, len(train.system.spans))),
        np.zeros((4, 3)),
        changed.pop("first_status", np.zeros((4, 3), dtype=np.uint8)),
        np.zeros((4, 3)),
        train.system,
    )
    half = laid(train, HALF, 4)
    made = Synthesis(half, half, half, half, Fraction(6))
    periodic = exact(train, laid(train, torque, 3, 4), **changed)
    return with_comparison(train.having(response=both, synthesis=made, periodic=periodic))


def with_comparison(found: Findings) -> Findings:
    """Compared as they stand."""
    return found.having(first_order_compared=compare_first_order(found))


def table(blocks: list[Block], words: str) -> Table:
    return next(block for block in blocks if isinstance(block, Table) and words in block.caption)


def texts(blocks: list[Block]) -> list[str]:
    return [block.text for block in blocks if isinstance(block, Paragraph)]


def half_range(parts: Any) -> float:
    """Of orders 2/3, 4/3, 2 and 4 in phase, over a revolution and a half."""
    turn = np.linspace(0.0, 3.0 * math.pi, 200_001)
    wave = sum(
        size * np.cos(float(order) * turn + 0.7) for size, order in zip(parts, ORDERS, strict=True)
    )
    return float(wave.max() - wave.min()) / 2.0


def test_blocks_of_the_chapter_in_their_order(train: Findings) -> None:
    blocks = list(chapter(answered(train)))
    assert [type(block) for block in blocks] == [Heading, Paragraph, Table, *[Figure] * 3]
    assert list(chapter(train)) == []
    assert list(chapter(answered(train).having(response=None))) == []
    none = answered(train, torque={})
    assert [type(block) for block in chapter(none)] == [Heading, Paragraph]


def test_introduction_states_harmonics_what_they_leave_out_and_the_drive(train: Findings) -> None:
    """The fourteen harmonics at the second speed leave out most of what is known."""
    (said,) = texts(list(chapter(answered(train))))
    assert said == (
        f"{MODEL} 3 speeds, up to 14 harmonics of the common period; estimated maximum omitted harmonic: 2.5·10⁻¹¹ "
        "of the largest; mean torque of the drive 11.500 to 14.250 N m."
    )
    fixed = (Line(Fraction(2), None, ("a",)), Line(None, 3.0, ("b",)), Line(None, 4.0, ("b",)))
    nothing = np.full(3, np.nan)
    bare = answered(
        train, lines=fixed, harmonics=np.zeros(3, dtype=int), truncation=nothing, drive=nothing
    )
    assert texts(list(chapter(bare))) == [
        f"{MODEL} 3 speeds, no periodic motion at any of them. Torques of fixed frequency are not included."
    ]
    some = texts(list(chapter(answered(train, drive=np.array([np.nan, 3.25, np.nan])))))[0]
    assert some.endswith("mean torque of the drive 3.2500 to 3.2500 N m.")


def test_speeds_that_are_not_to_be_relied_on_with_the_reason(train: Findings) -> None:
    status = np.array([Found.NONE, Found.OK, Found.COARSE], dtype=np.uint8)
    found = answered(train, status=status, why=("no end", "", ""), is_unstable=[False, True, False])
    blocks = list(chapter(found))
    assert [type(block) for block in blocks][:4] == [Heading, Paragraph, Table, Table]
    flagged = table(blocks, "with unreliable amplitudes")
    grows = "unstable: the train does not settle in this motion"
    assert flagged.rows == (
        ("429.7183", "none", "no", "−0.250", "1.5·10⁻¹²", "no end"),
        ("620.7043", "ok", "yes", "0.750", "2.5·10⁻¹¹", grows),
        ("811.6902", "coarse", "no", "−0.500", "–", "more harmonics would be needed"),
    )
    assert flagged.marks == ("fail", "fail", "note")
    assert flagged.caption.endswith("marked in the figures")
    bare = table(
        list(chapter(answered(train, status=status, growth=None))), "with unreliable amplitudes"
    )
    assert [(row[0], row[3]) for row in bare.rows] == [("429.7183", "–"), ("811.6902", "–")]


def test_of_more_than_twenty_such_speeds_the_first_twenty_are_listed(train: Findings) -> None:
    speed = np.arange(301.0, 324.0) / RPM
    status = np.full(23, Found.COARSE, dtype=np.uint8)
    status[1] = Found.OK
    wide = {
        "speed": speed,
        "status": status,
        "why": ("",) * 23,
        "growth": None,
        "truncation": np.full(23, 0.1),
    }
    for count, words in ((23, "figures; the first 20 of 22"), (21, "marked in the figures")):
        few = {key: one if one is None else one[:count] for key, one in wide.items()}
        found = answered(train)
        torque = np.ones((count, 4, len(train.system.spans)))
        coarse = replace(found.need(PeriodicResponse), torque=torque, **few)
        vars(coarse)["is_unstable"] = np.zeros(count, dtype=bool)
        flagged = table(list(chapter(found.having(periodic=coarse))), "with unreliable amplitudes")
        assert [row[0] for row in flagged.rows] == [f"{n}.0000" for n in (301, *range(303, 322))]
        assert flagged.caption.endswith(words)


def test_speeds_with_several_motions_are_named(train: Findings) -> None:
    others = exact(train, laid(train, EXACT, 3, 4)[:2], speed=SPEED[[0, 0]])
    blocks = list(chapter(answered(train, others=replace(others, status=others.status[:2]))))
    note = blocks[2]
    assert isinstance(note, Paragraph)
    assert "several periodic motions (429.72 rpm)" in note.text
    assert note.kind == "note"


def test_both_methods_side_by_side_in_one_unit(train: Findings) -> None:
    """All orders together come first; orders below 1 % of an element's largest torque are left out."""
    status = np.array([Found.OK, Found.COARSE, Found.OK], dtype=np.uint8)
    found = table(
        list(chapter(answered(train, status=status, is_unstable=[True, False, False]))),
        "First order against",
    )
    half = {name: [half_range(parts) for parts in EXACT[name]] for name in EXACT}
    share = {name: max(half[name]) / max(HALF[name]) - 1.0 for name in half}
    assert [row[:4] for row in found.rows[:3]] == [
        ("first", "all", "6.4000", "763.94"),
        ("tube", "all", "0.16000", "381.97"),
        ("last", "all", "0.0080000", "572.96"),
    ]
    for row, name, at in zip(found.rows, half, (1, 0, 2), strict=False):
        assert float(row[4]) == pytest.approx(max(half[name]) / 1e3, rel=1e-4)
        assert float(row[5]) == pytest.approx(SPEED[at] * RPM, rel=1e-4)
        assert float(row[6].replace("−", "-")) == pytest.approx(100.0 * share[name], rel=5e-3)
        assert row[6][0] == ("+" if share[name] > 0.0 else "−")
    assert {share[name] > 0.0 for name in share} == {True, False}
    assert [row[7] for row in found.rows[:3]] == ["coarse there", "unstable there", ""]
    order = "2/3 ≈ 0.6667"
    assert found.rows[3:] == (
        ("first", order, "7.0000", "763.94", "8.0000", "620.70", "+14.3", "coarse there"),
        ("first", "4/3 ≈ 1.3333", "–", "–", "0.50000", "620.70", "–", "coarse there"),
        ("first", "2", "0.066000", "859.44", "0.080000", "429.72", "+21.2", "unstable there"),
        ("tube", order, "0.20000", "859.44", "0.10000", "429.72", "−50.0", "unstable there"),
        ("tube", "4/3 ≈ 1.3333", "–", "–", "0.012000", "811.69", "–", ""),
        ("tube", "2", "0.012000", "859.44", "0.022000", "811.69", "+83.3", ""),
        ("tube", "4", "–", "–", "0.032000", "811.69", "–", ""),
        ("last", order, "0.011000", "859.44", "0.0010000", "811.69", "−90.9", ""),
        ("last", "2", "0.012000", "859.44", "5.0000·10⁻⁶", "811.69", "−100", ""),
        ("last", "4", "–", "–", "1.0000·10⁻⁵", "620.70", "–", "coarse there"),
    )
    assert found.marks == tuple("fail" if row[7] else "" for row in found.rows)
    assert [column.unit for column in found.columns] == [
        "",
        "",
        "kN m",
        "rpm",
        "kN m",
        "rpm",
        "%",
        "",
    ]
    assert found.caption.endswith("of the total (all)")


def test_first_order_without_a_reliable_value_has_none_beside_the_exact_one(
    train: Findings,
) -> None:
    """Of lines of fixed frequency no sum is compared."""
    singular = np.zeros((4, 3), dtype=np.uint8)
    singular[3, 1] = Status.SINGULAR
    found = table(list(chapter(answered(train, first_status=singular))), "First order against")
    assert {row[2:4] for row in found.rows if row[1] in ("all", "2/3 ≈ 0.6667")} == {("–", "–")}
    assert {row[6] for row in found.rows if row[1] != "2"} == {"–"}
    fixed = (
        Line(Fraction(2), None, ("a",)),
        Line(None, 3.0, ("b",)),
        Line(Fraction(1), None, ("b",)),
    )
    rows = table(list(chapter(answered(train, lines=fixed))), "First order against").rows
    assert "all" not in {row[1] for row in rows}
    assert {row[2] for row in rows if row[:2] == ("tube", "2")} == {"10.000"}
    nothing = {name: np.array(sizes) * 0.0 for name, sizes in FIRST.items()}
    rows = compare_first_order(answered(train, first=nothing)).each
    assert {math.isnan(row.excess) for row in rows if row.order == 2} == {True}


def test_rounding_is_nothing_and_never_that_of_a_speed_without_a_motion(train: Findings) -> None:
    tiny = EXACT | {"last": [[np.nan] * 4, [1e-9, 0, 0, 0], [2e-9, 0, 0, 0]]}
    status = np.array([Found.NONE, Found.OK, Found.OK], dtype=np.uint8)
    rows = [
        row
        for row in compare_first_order(answered(train, torque=tiny, status=status)).each
        if row.component == "last"
    ]
    assert [(row.order, row.exact, row.exact_speed) for row in rows] == [
        (None, 0.0, SPEED[1]),
        (ORDERS[0], 0.0, SPEED[1]),
        (ORDERS[2], 0.0, SPEED[1]),
    ]


@pytest.mark.parametrize("unknown", [0, 2])
def test_half_range_of_two_orders_has_its_closed_form(train: Findings, unknown: int) -> None:
    """2a cos x + a cos 2x reaches 3a and -1.5a; a speed without a motion has none."""
    sizes = np.array([[2.0, 1.0, 0.0, 0.0], [20.0, 10.0, 0.0, 0.0], [200.0, 100.0, 0.0, 0.0]])
    wanted = np.array([2.25, 22.5, 225.0])
    sizes[unknown], wanted[unknown] = np.nan, np.nan
    status = np.where(np.arange(3) == unknown, Found.NONE, Found.OK).astype(np.uint8)
    found = answered(train, torque={"tube": sizes, "first": 3.0 * sizes}, status=status)
    flat = found.need(PeriodicResponse)
    found = found.having(periodic=replace(flat, torque=np.abs(flat.torque)))
    tube = next(one for one in elements(train.system) if one.name == "tube")
    np.testing.assert_allclose(
        exact_half_range(found.need(PeriodicResponse), list(tube.spans)), wanted, rtol=1e-9
    )
    np.testing.assert_allclose(
        exact_half_range(found.need(PeriodicResponse), [0]), 3.0 * wanted, rtol=1e-9
    )
    long = (Fraction(1), Fraction(1_000_001, 1_000_000), Fraction(3), Fraction(4))
    found = found.having(periodic=replace(flat, torque=np.abs(flat.torque), orders=long))
    np.testing.assert_allclose(
        exact_half_range(found.need(PeriodicResponse), list(tube.spans)),
        wanted * 3.0 / 2.25,
        rtol=1e-9,
    )


def test_rules_on_the_first_order_name_where_the_exact_one_exceeds_it_most(train: Findings) -> None:
    text = "The rules judge the first-order response, not the exact periodic response."
    ruled = replace(train, study=torsion.parse(TRAIN + "rules: [coupling-maker]\n"))
    assert (
        first_order_judged(answered(train)) == first_order_judged(answered(ruled, torque={})) == ""
    )
    most = half_range(EXACT["first"][1])
    share = 100.0 * (most / 6400.0 - 1.0)
    wanted = (
        f"{text} The maximum excess of the exact response is in first: total amplitude {most:.1f} N m at 620.70 "
        "rpm against "
        f"6400.0 N m at 763.94 rpm of the first order (+{share:.1f} %)."
    )
    assert first_order_judged(answered(ruled)) == wanted
    blocks = list(chapter(answered(ruled)))
    assert (blocks[2].text, blocks[2].kind) == (wanted, "note")
    fixed = (
        Line(Fraction(2, 3), None, ("a",)),
        Line(None, 3.0, ("b",)),
        Line(Fraction(2), None, ("b",)),
    )
    assert first_order_judged(answered(ruled, lines=fixed)) == (
        f"{text} The maximum excess of the exact response is in first: amplitude of order 2/3 8000.0 N m at 620.70 rpm "
        "against 44.000 N m at 859.44 rpm of the first order (+18100 %)."
    )
    singular = np.full((4, 3), Status.SINGULAR, dtype=np.uint8)
    assert first_order_judged(answered(ruled, first_status=singular)) == text


def test_curves_at_the_orders_of_the_joints_and_twice_them(train: Findings) -> None:
    """Joints at 1, 1/3 and 1/6 of the speed: orders 1/3, 2/3, 4/3, 2 and 4, of which the first four are drawn."""
    status = np.array([Found.NONE, Found.OK, Found.COARSE], dtype=np.uint8)
    blocks = list(chapter(answered(train, status=status, is_unstable=[False, True, False])))
    first, tube, last = (block for block in blocks if isinstance(block, Figure))
    assert [block.caption.split(", orders")[0] for block in (first, tube, last)] == [
        "Torque in first",
        "Torque in tube",
        "Torque in last",
    ]
    assert (first.name, tube.name) == ("periodic-1-0", f"periodic-3-{len(train.system.spans) - 2}")
    names = ("order 2/3 ≈ 0.6667", "order 4/3 ≈ 1.3333", "order 2")
    lines = [f"{name}, {how}" for name in names for how in ("exact", "first order")]
    lines.remove("order 4/3 ≈ 1.3333, first order")  # there is none
    assert list(first.lines) == lines
    for k, column in ((0, 1), (2, 2)):
        before = first.lines[f"{names[k]}, first order"]
        assert before.y == pytest.approx(np.array(FIRST["first"])[:, column] / 1e3)
        assert before.x == pytest.approx(FIRST_SPEED * RPM)
    for k in range(3):
        exactly = first.lines[f"{names[k]}, exact"]
        assert exactly.y == pytest.approx(np.array(EXACT["first"])[:, k] / 1e3)
        assert exactly.x == pytest.approx(SPEED * RPM)
    assert levels(first)["rated speed"] == [pytest.approx(750.0)]
    assert (unit(first), unit(tube)) == ("kN m", "N m")
    assert bands(first, "no answer") == [pytest.approx((SPEED[0] * RPM, SPEED[1] * RPM))]
    for name, k in (("unstable motion", 1), ("not resolved", 2)):
        assert [x for x, _ in marks(first, name)] == pytest.approx([SPEED[k] * RPM] * 3)
    assert next(iter(tube.lines.values())).y == pytest.approx([100.0, 40.0, 50.0])


def test_of_many_elements_sixty_rows_are_listed_and_the_six_largest_drawn() -> None:
    """Seventeen couplings with four rows each; the later ones carry more, and the sixteenth nothing."""
    chain = "".join(
        f", coupling: {{name: c{k}, stiffness: 1e3}}, disc: {{inertia: 1}}" for k in range(1, 18)
    )
    made = torsion.run(torsion.parse(f"name: long\ntrain: [disc: {{inertia: 1}}{chain}]\n"))
    sizes = {
        f"c{k}": [[0] * 4, [0] * 4, [0.01 * k, 0.01, 0.01, 0]] for k in range(1, 18) if k != 16
    }
    blocks = list(chapter(answered(made, first={}, torque=sizes)))
    found = table(blocks, "First order against")
    assert (len(found.rows), found.caption.endswith("of the total (all); the first 60 of 64")) == (
        60,
        True,
    )
    assert [row[0] for row in found.rows if row[1] == "all"] == [
        f"c{k}" for k in range(1, 18) if k != 16
    ]
    drawn = [block.caption.split()[2].rstrip(",") for block in blocks if isinstance(block, Figure)]
    assert drawn == ["c11", "c12", "c13", "c14", "c15", "c17"]
