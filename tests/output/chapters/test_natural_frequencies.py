"""Every cell, word and curve of the chapter on natural frequencies, against the modes and the laws of a train."""

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.output.drawn import named, plot

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table
from torsion.output.chapters.modes.natural_frequencies import (
    all_modes,
    appendix,
    chapter,
    holzer_tables,
)
from torsion.output.station_layout import layout

RPM = 30.0 / math.pi
GEARED = """
name: a shaft, a rigid mesh at 5/2, a branch at twice the speed of its end and a spring to ground
materials: {alloy: {shear_modulus: 80 GPa, density: 7850}}
train:
- disc: {name: wheel, inertia: 2}
- shaft: {name: line, length: 2 m, diameter: 30 mm, segments: 5, material: alloy}
- gear:
    name: stage
    ratio: 5/2
    inertia: [0.5, 1.5]
    branches: [{ratio: 2, train: [coupling: {name: side, stiffness: 500}, disc: {name: pump, inertia: 0.3}]}]
- coupling: {name: soft, stiffness: 800}
- disc: {name: screw, inertia: 12, stiffness: 30}
analyses: {modes: {count: 3}}
"""
SPEED = {
    "stage end": 0.4,
    "screw": 0.4,
    "screw ground": 0.4,
    "stage wheel 2": 0.5,
    "pump": 0.5,
}  # of the wheel's
CHAIN = "name: chain\ntrain: [disc: {{name: d0, inertia: 1}}{rest}]\nanalyses: {{modes: {{count: {count}}}}}\n"


def value(text: str) -> float:
    """A cell as a number."""
    mantissa, _, power = text.replace("−", "-").partition("·10")
    return float(mantissa) * 10.0 ** int(
        power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0
    )


def chain(couplings: int, count: int, end: str = "") -> Findings:
    rest = "".join(
        f", coupling: {{name: c{k}, stiffness: 100}}, disc: {{name: d{k}, inertia: 2}}"
        for k in range(1, couplings + 1)
    )
    return torsion.run(torsion.parse(CHAIN.format(rest=rest + end, count=count)))


@pytest.fixture(scope="module")
def geared() -> Findings:
    return torsion.run(torsion.parse(GEARED))


@pytest.fixture(scope="module")
def long() -> Findings:
    """Of 16 discs and 15 modes."""
    return chain(15, 15)


def table(blocks: list[Block], words: str) -> Table:
    return next(block for block in blocks if isinstance(block, Table) and words in block.caption)


def texts(blocks: list[Block]) -> list[str]:
    return [block.text for block in blocks if isinstance(block, Paragraph)]


def with_modes(findings: Findings, **changed: Any) -> Findings:
    return findings.having(modes=replace(findings.need(Modes), **changed))


def damped(speed: float, overdamped: int) -> DampedModes:
    """Two modes of 5 and 7 Hz, the second without damping, and so many real roots, 10, 20, ... /s."""
    none = np.empty(0)
    roots = np.array([-2.5 + 31.0j, 0.0 + 44.0j])
    return DampedModes(
        np.array([5.0, 7.0]),
        np.array([0.08, 0.0]),
        roots,
        none,
        none,
        10.0 * np.arange(1.0, overdamped + 1),
        speed,
    )


def test_blocks_of_the_chapter_in_their_order(geared: Findings) -> None:
    blocks = list(chapter(geared))
    assert [type(block) for block in blocks] == [Heading, Paragraph, Table, Figure, Figure, Figure]
    hertz = [f"{one:.5g}" for one in geared.need(Modes).frequency]
    assert blocks[0] == Heading("Natural frequencies and mode shapes")
    assert [
        (block.name, block.caption.split(":")[0]) for block in blocks if isinstance(block, Figure)
    ] == [(f"mode-{k + 1}", f"Mode {k + 1}, {hertz[k]} Hz") for k in range(3)]
    brief, full = (
        [block.caption.split(",")[0] for block in some(geared) if isinstance(block, Table)]
        for some in (appendix, all_modes)
    )
    assert brief == [
        *(f"Holzer table of mode {k}" for k in (1, 2, 3)),
        "Shares of the kinetic and elastic energy",
    ]
    assert full == [f"Constants of the shafts at the frequency of mode {k}" for k in (1, 2, 3)]
    assert list(chapter(geared.having(modes=None))) == []
    none = np.empty(0)
    bare = with_modes(geared, frequency=none, lower=none, upper=none)
    assert [type(block) for block in chapter(bare)] == [Heading, Paragraph]


@pytest.mark.parametrize(
    ("rigid", "words"),
    [
        (0, "The train has no rigid-body mode and 3 elastic modes (undamped)."),
        (2, "The train has 2 rigid-body modes (0 Hz) and 3 elastic modes (undamped)."),
        (1, "The train has one rigid-body mode (0 Hz) and 3 elastic modes (undamped)."),
    ],
)
def test_rigid_motions_and_the_certificate_in_words(
    geared: Findings, rigid: int, words: str
) -> None:
    for certified, more in (
        (True, "Sturm counts prove"),
        (False, "The bounds of these frequencies are not"),
    ):
        text = texts(list(chapter(with_modes(geared, rigid=rigid, certified=certified))))[0]
        assert text.startswith(words)
        assert more in text


def test_frequencies_with_their_bounds_and_nodes(geared: Findings) -> None:
    hertz, wide = geared.need(Modes).frequency, np.array([1e-3, 2e-3, 4e-3])
    found = with_modes(geared, lower=hertz * (1.0 - wide), upper=hertz * (1.0 + 2.0 * wide))
    rows = table(list(chapter(found)), "Natural frequencies of").rows
    assert [(row[0], row[3]) for row in rows] == [("1", "0"), ("2", "1"), ("3", "2")]
    for row, f, away in zip(rows, hertz, wide, strict=True):
        wanted = [f, 60.0 * f, f * (1.0 - away), f * (1.0 + 2.0 * away)]
        assert [value(row[k]) for k in (1, 2, 4, 5)] == pytest.approx(wanted, rel=1e-6)
        assert [len(row[k].replace(".", "").lstrip("0")) for k in (1, 2, 4, 5)] == [7, 7, 10, 10]


def test_damped_frequencies_and_what_decays_without_oscillation(geared: Findings) -> None:
    blocks = list(chapter(geared.having(damped_modes=damped(100.0, 9))))
    found = table(blocks, "Damped natural frequencies")
    assert found.rows == (("1", "5.000000", "8.000"), ("2", "7.000000", "0"))
    assert found.caption == found.short == "Damped natural frequencies, damping at 954.93 rpm"
    listed = ", ".join(f"{k}0.00" for k in range(1, 9))
    assert texts(blocks)[1] == f"Overdamped modes (decay without oscillation): {listed}, … 1/s."
    blocks = list(chapter(geared.having(damped_modes=damped(0.5, 8))))
    assert (
        table(blocks, "Damped natural").caption
        == "Damped natural frequencies, damping at 4.7746 rpm"
    )
    assert texts(blocks)[1] == f"Overdamped modes (decay without oscillation): {listed} 1/s."
    blocks = list(chapter(geared.having(damped_modes=damped(0.0, 0))))
    assert (table(blocks, "Damped natural").caption, len(texts(blocks))) == (
        "Damped natural frequencies",
        1,
    )


def test_shares_of_energy_of_a_shaft_are_those_of_its_segments_together(geared: Findings) -> None:
    """Less than two per cent of a mode is blank, and a part with less in every mode has no row."""
    modes, system = geared.need(Modes), geared.system
    names = [station.name for station in system.stations]
    inner = [k for k, name in enumerate(names) if name.startswith("line ") and "/" in name]
    assert len(inner) == 4
    kinetic, elastic = np.array(modes.kinetic), np.array(modes.elastic)
    wanted = {f"kinetic: {name}": kinetic[k] for k, name in enumerate(names[:7])}
    wanted["kinetic: line (inner segments)"] = kinetic[inner].sum(axis=0)
    spans = {span.name: elastic[k] for k, span in enumerate(system.spans)}
    wanted |= {f"elastic: {name}": spans[name] for name in ("soft", "side", "screw to ground")}
    wanted["elastic: line"] = sum(spans[f"line [{k}]"] for k in range(1, 6))
    shares = {share.component: share.share for share in modes.energy_shares}
    for name, share in wanted.items():
        np.testing.assert_allclose(shares[name], share, rtol=1e-14)
    found = table(list(appendix(geared)), "Shares of the kinetic")
    assert [row[0] for row in found.rows] == [
        name for name, share in shares.items() if share.max() >= 0.02
    ]
    assert "kinetic: screw ground" not in [row[0] for row in found.rows]
    assert [column.title for column in found.columns] == ["Component", "Mode 1", "Mode 2", "Mode 3"]


def test_a_share_of_exactly_two_per_cent_is_printed() -> None:
    found = chain(1, 1)
    modes = replace(found.need(Modes))
    vars(modes).update(kinetic=np.array([[0.02], [0.0199]]), elastic=np.array([[0.0199]]))
    shares = table(list(appendix(found.having(modes=modes))), "Shares of the kinetic")
    assert shares.rows == (("kinetic: d0", "2.00"),)


def test_without_excitation_six_modes_have_a_figure_and_twelve_in_the_full_report(
    long: Findings,
) -> None:
    blocks, full = list(chapter(long)), list(all_modes(long))
    assert [block.name for block in blocks if isinstance(block, Figure)] == [
        f"mode-{k}" for k in range(1, 7)
    ]
    assert [block.name for block in full if isinstance(block, Figure)] == [
        f"mode-{k}" for k in range(7, 13)
    ]
    assert texts(full)[-1] == "Modes 13 to 15 are in results.json."
    assert len(table(blocks, "Natural frequencies of").rows) == 15
    assert len(table(list(appendix(long)), "Shares of the kinetic").columns) == 13


def test_modes_up_to_the_highest_excited_frequency_have_a_figure() -> None:
    text = """
name: driven
train: [disc: {name: a, inertia: 1}, coupling: {stiffness: 1e4, psi: 1}, disc: {inertia: 1},
        coupling: {stiffness: 1e4, psi: 1}, disc: {inertia: 1}, coupling: {stiffness: 1e6, psi: 1}, disc: {inertia: 1}]
operation: {speeds: {from: 100 rpm, to: 600 rpm, steps: 3}}
excitations: [{at: a, order: 3, torque: 5}]
"""
    found = torsion.run(torsion.parse(text))
    highest = 3.0 * 600.0 / 60.0
    count = sum(one <= highest for one in found.need(Modes).frequency)
    assert 1 <= count < 3
    assert len([block for block in chapter(found) if isinstance(block, Figure)]) == count


@pytest.mark.parametrize("mode", [0, 1, 2])
def test_holzer_table_obeys_the_laws_of_a_geared_train(geared: Findings, mode: int) -> None:
    """A row's angle is its own over its speed; a link carries what stands before it, and k times its twist.

    The shaft is one row: the torque at its end is that at its begin and the torques of its inner segments.
    """
    modes, system = geared.need(Modes), geared.system
    names = [station.name for station in system.stations]
    block, constants = holzer_tables(geared, modes, mode)
    rows = {row[1]: row[2:] for row in block.rows}
    assert list(rows) == [
        "wheel",
        "line end",
        "stage end",
        "screw",
        "screw ground",
        "stage wheel 2",
        "pump",
    ]
    assert [row[0] for row in block.rows] == ["1", "2", "3", "4", "5", "6", "7"]
    first, square = modes.shape[0, mode], (2.0 * math.pi * modes.frequency[mode]) ** 2
    angle = {
        name: modes.shape[k, mode] / SPEED.get(name, 1.0) / first for k, name in enumerate(names)
    }
    inertia = {
        name: system.lumped_inertia[k] * SPEED.get(name, 1.0) ** 2 for k, name in enumerate(names)
    }
    torque = {
        name: square * inertia[name] * angle[name] for name in names if name != "screw ground"
    }
    for name, row in rows.items():
        assert value(row[1]) == pytest.approx(angle[name], rel=1e-6, abs=1e-12)
        assert row[1] == "0" or len(row[1].lstrip("−0.").replace(".", "")) == 7
        if name == "screw ground":
            assert (row[0], row[2]) == ("∞", "–")
        else:
            wanted = inertia[name], torque[name]
            assert (value(row[0]), value(row[2])) == pytest.approx(wanted, rel=1e-6)
    assert rows["wheel"][3:] == ("–", "–", "–", "–", "–", "–")
    links = {
        "screw": ("3", "soft", "stage end", 1.0 / 800.0 / 0.16),
        "screw ground": ("4", "screw to ground", "screw", 1.0 / 30.0 / 0.16),
        "pump": ("6", "side", "stage wheel 2", 1.0 / 500.0 / 0.25),
    }
    for name, (row, through, other, flexible) in links.items():
        twist = angle[other] - angle[name]
        assert rows[name][3:5] == (row, through)
        wanted = [twist / flexible, flexible, twist, twist / flexible]
        assert [value(cell) for cell in rows[name][5:]] == pytest.approx(wanted, rel=1e-5)
    before = torque["wheel"]
    behind = before + sum(torque[f"line {k}/5"] for k in (1, 2, 3, 4))
    assert (rows["line end"][3:5], rows["line end"][6]) == (("1", "line"), "–")
    entering = [before, angle["wheel"] - angle["line end"], behind]
    assert [value(rows["line end"][k]) for k in (5, 7, 8)] == pytest.approx(entering, rel=1e-5)
    branch = torque["stage wheel 2"] + torque["pump"]
    ahead = behind + torque["line end"]
    for name, through, carried in (
        ("stage end", "stage", ahead + branch),
        ("stage wheel 2", "stage wheel 2", -branch),
    ):
        assert [rows[name][k] for k in (3, 4, 6, 7)] == ["2", through, "0", "0"]
        assert value(rows[name][5]) == pytest.approx(carried, rel=1e-4, abs=1e-4 * abs(branch))
    assert value(block.caption.rpartition(" ")[2]) < 1e-13
    ((name, *four),) = constants.rows
    a, h, b, d = map(value, four)
    assert (name, a * d + b * h) == ("line", pytest.approx(1.0, rel=1e-6))
    ends = [a * angle["wheel"] - h * before, b * angle["wheel"] + d * before]
    assert ends == pytest.approx([angle["line end"], behind], rel=1e-5)
    assert re.fullmatch(
        rf"Holzer table of mode {mode + 1}, ω² = [\d.]+ rad²/s², referred to the reference speed, first amplitude 1 "
        r"rad, residual / largest torque \S+",
        block.caption,
    )
    assert value(block.caption.split()[7]) == pytest.approx(square, rel=1e-10)


@pytest.mark.parametrize(("heavy", "first"), [(6.647, "largest"), (6.640, "first")])
def test_holzer_table_of_a_first_station_that_hardly_moves_is_scaled_by_the_largest(
    heavy: float, first: str
) -> None:
    """The discs of 1 and 2 kg m2 swing against one another, and the first a thousand times less."""
    text = f"""
name: heavy
train: [disc: {{name: a, inertia: {heavy}}}, coupling: {{name: k, stiffness: 10}}, disc: {{name: b, inertia: 1}},
        coupling: {{name: m, stiffness: 1000}}, disc: {{name: c, inertia: 2}}]
analyses: {{modes: {{count: 2}}}}
"""
    found = torsion.run(torsion.parse(text))
    modes = found.need(Modes)
    (block,) = holzer_tables(found, modes, 1)
    shape = modes.shape[:, 1] / (
        np.abs(modes.shape[:, 1]).max() if first == "largest" else modes.shape[0, 1]
    )
    shape *= np.sign(shape[0])
    square = (2.0 * math.pi * modes.frequency[1]) ** 2
    assert square * heavy / 10.0 - 1.0 == pytest.approx(
        1000.5 if first == "largest" else 999.5, abs=0.3
    )
    assert [value(row[3]) for row in block.rows] == pytest.approx(shape, rel=1e-6)
    assert [value(row[4]) for row in block.rows] == pytest.approx(
        square * shape * [heavy, 1.0, 2.0], rel=1e-6
    )
    for row, k, twist in zip(block.rows[1:], (10.0, 1000.0), -np.diff(shape), strict=False):
        wanted = [k * twist, 1.0 / k, twist, k * twist]
        assert [value(row[j]) for j in (7, 8, 9, 10)] == pytest.approx(wanted, rel=1e-6)
    assert f"referred to the reference speed, {first} amplitude 1 rad" in block.caption


def test_a_link_that_closes_a_loop_has_a_row_behind_the_others() -> None:
    text = """
name: two discs and three couplings
train: [disc: {name: a, inertia: 1}, coupling: {stiffness: 1e4}, disc: {name: b, inertia: 2}]
links: [{between: [a, b], coupling: {stiffness: 2e4}}, {between: [a, b], coupling: {stiffness: 3e4}}]
"""
    rows = table(list(appendix(torsion.run(torsion.parse(text)))), "Holzer").rows
    assert [row[1] for row in rows] == ["a", "b", "b, closing a loop", "b, closing a loop"]
    assert [row[3] for row in rows] == ["1.000000", "−0.5000000", "−0.5000000", "−0.5000000"]
    assert [value(row[7]) for row in rows[1:]] == pytest.approx([1.5e4, 3e4, 4.5e4], rel=1e-6)


def test_a_shaft_with_distributed_inertia_has_no_inertia_at_its_ends() -> None:
    text = GEARED.replace("count: 3}", "count: 1}, model: exact").replace("30 mm", "90 mm")
    blocks = list(appendix(torsion.run(torsion.parse(text))))
    assert [row[2] for row in table(blocks, "Holzer").rows[:2]] == ["2.000000", "0.5000000"]


def test_plot_of_a_mode_is_referred_and_relative_to_its_largest(geared: Findings) -> None:
    """Points of the branch stand beside the main line and have no name on it."""
    modes, system = geared.need(Modes), geared.system
    names = [station.name for station in system.stations]
    drawn = next(block for block in chapter(geared) if isinstance(block, Figure))
    place = layout(system)
    at = dict(zip(names, zip(place.x.tolist(), place.row.tolist(), strict=True), strict=True))
    angle = modes.shape[:, 0] / np.array([SPEED.get(name, 1.0) for name in names])
    angle = dict(zip(names, (angle / angle[np.abs(angle).argmax()]).tolist(), strict=True))
    inside = {"soft": 0.4, "screw to ground": 0.4, "side": 0.5}
    torque = modes.torque[:, 0] * np.array([inside.get(span.name, 1.0) for span in system.spans])
    upper, lower = drawn.plots
    line = ["wheel", *(f"line {k}/5" for k in (1, 2, 3, 4)), "line end"]
    main = named(upper)["main line"]
    pairs = list(zip(main.x.tolist(), main.y.tolist(), strict=True))
    start = pairs.index(pytest.approx((at["wheel"][0], angle["wheel"])))
    assert pairs[start : start + 6] == [pytest.approx((at[name][0], angle[name])) for name in line]
    branch = named(upper)["branch 1"]
    turned = ["stage wheel 2", "pump", "", "line end", "stage wheel 2"]
    assert branch.y.tolist() == pytest.approx(
        [angle.get(name, math.nan) for name in turned], nan_ok=True
    )
    assert at["pump"][1] == 1.0
    (stations,) = upper.marks
    wanted = sorted((at[name][0], angle[name]) for name in names[:7])
    np.testing.assert_allclose(sorted(zip(stations.x, stations.y, strict=True)), wanted, rtol=1e-12)
    size = np.abs(torque).max()
    steps = dict(zip((span.name for span in system.spans), torque / size, strict=True))
    shown = {name: one.y[np.isfinite(one.y)] for name, one in named(lower).items()}
    assert {round(one, 9) for one in shown["branch 1"].tolist()} == {
        round(one, 9) for name, one in steps.items() if name in ("side", "stage wheel 2")
    }
    assert {round(one, 9) for one in shown["main line"].tolist()} == {
        round(steps[span.name], 9)
        for span in system.spans
        if span.name not in ("side", "screw to ground")
        and at[system.stations[span.driven].name][1] == 0.0
        and at[system.stations[span.driving].name][0] != at[system.stations[span.driven].name][0]
    }
    links = {
        "line": ("wheel", "line end"),
        "stage": ("line end", "stage end"),
        "soft": ("stage end", "screw"),
    }
    middle = {name: (at[a][0] + at[b][0]) / 2.0 for name, (a, b) in links.items()}
    wanted = {"wheel": at["wheel"][0], **middle, "screw": at["screw"][0]}
    assert {name: x for x, name in upper.x.places} == pytest.approx(wanted)
    assert drawn.caption.endswith(
        "angle and torque, referred to the reference speed and relative to their maximum"
    )


@pytest.mark.parametrize(("couplings", "named"), [(6, 14), (7, 9)])
def test_links_are_named_in_a_plot_of_at_most_fourteen_components(
    couplings: int, named: int
) -> None:
    """A disc on the last one makes fourteen components, or sixteen."""
    more = chain(couplings, 1, ", disc: {name: end, inertia: 1}")
    drawn = next(block for block in chapter(more) if isinstance(block, Figure))
    assert len(plot(drawn).x.places) == named
