"""Every cell, word and curve of the chapters on the response, of amplitudes that are all written by hand."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from tests.for_all import for_all
from tests.output.drawn import bands, levels, plot, titles, unit

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import FrequencyResponse, Response, Synthesis
from torsion.analyses.response.component_loads import component_loads, local_maxima
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table
from torsion.output.chapters.response.forced_response import (
    angles,
    chapter,
    over_frequency,
)

RPM = 30.0 / math.pi
TRAIN = """
name: four discs and a spring to ground
operation: {speeds: {from: 5 rad/s, to: 40 rad/s, steps: 6}, rated: {speed: 30 rad/s, power: 1.2 kW}}
train:
- disc: {name: flywheel, inertia: 2}
- coupling: {name: soft, stiffness: 300, loss_factor: 0.05}
- gear: {name: stage, ratio: 5/2, inertia: [0.5, 1.5], mesh_stiffness: 4 kN*m/rad}
- coupling: {name: stiff, stiffness: 800, loss_factor: 0.05, vibratory_torque: 2500}
- disc: {name: screw, inertia: 12, stiffness: 30}
excitations: [{at: flywheel, order: 1/2, torque: 3}]
"""
SHAFT = """
name: a shaft in three segments
operation: {speeds: {from: 5 rad/s, to: 12 rad/s, steps: 2}}
train: [disc: {inertia: 1}, shaft: {name: shaft, length: 1, diameter: 0.1, segments: 3}, disc: {inertia: 1}]
"""
SOFT, STIFF, STAY, STAGE = range(4)  # spans; the third leads to ground
SPEED = np.array([5.0, 12.0, 19.0, 26.0, 33.0, 40.0])  # rad/s
LINES = (
    Line(Fraction(1, 2), None, ("flywheel", "flywheel")),
    Line(Fraction(2), None, ("screw", "stage")),
    Line(None, 3.5, ("stage",)),
)
SIZE = np.zeros((6, 3, 4))  # N m of (speeds, lines, spans)
SIZE[:, :, SOFT] = [[10, 21, 3], [40, 22, 4], [90, 23, 5], [50, 24, 6], [20, 70, 7], [11, 25, 2]]
SIZE[:, :, STIFF] = [[1, 2, 3], [2, 9000, 4], [3, 4, 5], [4, 100, 70], [5, 6, 800], [6, 7, 90]]
SIZE[:, :, STAGE] = [[6, 1, 2], [5, 2, 3], [4, 3, 4], [3, 4, 5], [2, 5, 6], [1, 6, 7]]
PEAK = 19.0 / 4.0 / math.pi  # Hz, of order 1/2 in the soft coupling
MEAN = np.outer([1.0, 2.0, 3.0, 4.0, 5.0, -6.0], [100.0, 250.0, 0.5, 101.0])
ANGLE = np.outer([1.0, 2.0, 7.0, 4.0, 5.0, 6.0], [1e-3, 2e-3, 3e-3])[:, :, None] * np.array(
    [1.0, -2.0, 3j, 4.0, 0.0]
)
RESPONSE = {
    "speed": SPEED,
    "requested": np.array([True, True, False, True, True, False]),
    "lines": LINES,
    "frequency": np.array([[w / 4.0 / math.pi, w / math.pi, 3.5] for w in SPEED.tolist()]),
    "angle": ANGLE,
    "torque": SIZE * np.exp(1j * SIZE),
    "mean": MEAN,
    "residual": np.arange(18.0).reshape(6, 3) * 1e-15,
    "status": np.zeros((6, 3), dtype=np.uint8),
    "joint_error": np.zeros((6, 3)),
}
HALF = SIZE.sum(axis=1) * 0.75
SYNTHESIS = Synthesis(HALF, HALF + 1.0, SIZE.sum(axis=1) * 0.5, SIZE.sum(axis=1), Fraction(2))


@pytest.fixture(scope="module")
def train() -> Findings:
    return torsion.run(torsion.parse(TRAIN))


def answered(train: Findings, made: Synthesis | None = SYNTHESIS, **changed: Any) -> Findings:
    """The train with the response of above, changed, and that synthesis."""
    found = train.having(
        response=Response(**(RESPONSE | {"system": train.system} | changed)), synthesis=made
    )
    return with_loads(found)


def with_loads(found: Findings) -> Findings:
    """The same with the loads that follow from its response, if there are any."""
    if found.get(Synthesis) is None or not found.need(Response).lines:
        return found.having(component_loads=None)
    return found.having(component_loads=component_loads(found))


def with_modes(
    train: Findings, *frequency: float, damping: tuple[float, ...] | None = None
) -> Findings:
    """Natural frequencies in Hz, and their damping ratios where they are damped."""
    none, hertz = np.empty(0), np.array(frequency)
    damped = (
        None
        if damping is None
        else DampedModes(hertz, np.array(damping), none, none, none, none, 0.0)
    )
    return train.having(modes=replace(train.need(Modes), frequency=hertz), damped_modes=damped)


def table(blocks: list[Block], words: str) -> Table:
    return next(block for block in blocks if isinstance(block, Table) and words in block.caption)


def texts(blocks: list[Block]) -> list[str]:
    return [block.text for block in blocks if isinstance(block, Paragraph)]


def figures(blocks: list[Block]) -> list[Figure]:
    return [block for block in blocks if isinstance(block, Figure)]


def test_blocks_of_the_chapter_in_their_order(train: Findings) -> None:
    """The spring to ground carries no torque, so that nothing is said of it."""
    blocks = list(chapter(answered(train)))
    kinds = [Heading, Paragraph, Paragraph, Table, Table, Figure, Figure]
    assert [type(block) for block in blocks] == kinds
    assert [block.caption for block in figures(blocks)] == [
        "Vibratory torque in soft, coupling",
        "Vibratory torque in stiff, coupling",
    ]
    assert [block.name for block in figures(blocks)] == ["torque-1-0", "torque-3-1"]
    nothing = answered(train, torque=0.0 * RESPONSE["torque"])
    assert [type(block) for block in chapter(nothing)] == kinds[:3]
    assert list(chapter(answered(train, lines=()))) == []
    assert list(chapter(train.having(response=None))) == []


def test_introduction_counts_and_names_the_common_cycle(train: Findings) -> None:
    said = texts(list(chapter(answered(train))))
    assert said[0] == (
        "3 harmonic components at 4 requested speeds. The program added 2 speeds near resonances, so that the grid "
        "resolves every peak. Amplitudes are zero to peak; the amplitude of a total is half of its peak-to-peak value. "
        "A torque is the full torque in the section (elastic plus damping) at the speed of the component. The total "
        "vibratory torque is the phase-correct sum of all orders over the common period of 2 revolutions of flywheel."
    )
    assert said[1] == "Largest relative residual of equilibrium: 1.7·10⁻¹⁴."
    assert len(said) == 2


@for_all(
    ("turns", "words"),
    [
        (Fraction(1), "over the common period of 1 revolution of flywheel."),
        (Fraction(1, 2), "over the common period of 1/2 revolution of flywheel."),
        (Fraction(3, 2), "over the common period of 3/2 revolutions of flywheel."),
        (
            Fraction(0),
            "no common period. The total is the sum of their magnitudes, which is an upper bound.",
        ),
        (None, "at the speed of the component."),
    ],
)
def test_common_cycle_in_words(train: Findings, turns: Fraction | None, words: str) -> None:
    made = None if turns is None else replace(SYNTHESIS, turns=turns)
    assert texts(list(chapter(answered(train, made))))[0].endswith(words)


def test_introduction_names_what_is_left_out_and_what_the_rules_read(train: Findings) -> None:
    left = (Line(Fraction(3), None, ("a", "b")), Line(Fraction(5, 2), None, ("c",)))
    said = texts(list(chapter(answered(train, left_out=left, remark="too many"))))[0]
    assert "the phase-correct sum of the requested orders" in said
    assert said.endswith(
        " Not requested by orders and therefore omitted: 3 × a, b; 2.5 × c. Note on the speeds: too many."
    )
    ruled = replace(train, study=torsion.parse(TRAIN + "rules: [coupling-maker]\n"))
    assert "near resonances and rule limits, so" in texts(list(chapter(answered(ruled))))[0]
    asked = torsion.parse(
        TRAIN + "rules: [coupling-maker]\nanalyses: {response: {orders: [1/2]}}\n"
    )
    assert texts(list(chapter(answered(replace(train, study=asked)))))[0].endswith(
        " The rules judge the total of all orders, so all orders are reported."
    )


def test_speeds_without_a_reliable_answer_are_counted(train: Findings) -> None:
    """Two statuses at one speed count once; the residual is the largest of what is reliable and known."""
    status, residual = np.zeros((6, 3), dtype=np.uint8), np.array(RESPONSE["residual"])
    status[5], status[1, 0], residual[4, 2] = Status.NEAR_SINGULAR, Status.SINGULAR, math.nan
    said = [
        b
        for b in chapter(answered(train, status=status, residual=residual))
        if isinstance(b, Paragraph)
    ][1]
    assert said.text.startswith(
        "Largest relative residual of equilibrium: 1.3·10⁻¹⁴. At 2 speeds the equations are singular"
    )
    assert said.kind == "note"
    none = [
        b for b in chapter(answered(train, status=status + np.uint8(1))) if isinstance(b, Paragraph)
    ][1]
    assert none.text.startswith("Largest relative residual of equilibrium: 0. At 6 speeds")


def test_largest_torque_of_every_element_with_what_makes_it_up(train: Findings) -> None:
    """In the soft coupling the largest together is that of order 1/2 at 19 rad/s."""
    found = table(list(chapter(answered(train))), "Maximum vibratory torque")
    assert found.rows == (
        (
            "soft",
            "88.500",
            "181.44",
            "0.5 × flywheel",
            "90.000",
            "59.000",
            "118.00",
            "300.00",
        ),
        (
            "stage",
            "10.500",
            "381.97",
            "3.5 Hz (stage)",
            "7.0000",
            "7.0000",
            "14.000",
            "−606.00",
        ),
        ("stiff", "6754.5", "114.59", "2 × screw, stage", "9000.0", "4503.0", "9006.0", "500.00"),
    )
    assert [column.unit for column in found.columns][1::3] == ["N m", "N m", "N m"]
    status = np.zeros((6, 3), dtype=np.uint8)
    status[3, 1] = Status.SINGULAR
    found = table(list(chapter(answered(train, status=status))), "Maximum vibratory torque")
    assert set(found.rows) == {
        (name, "no reliable value", *["–"] * 6) for name in ("soft", "stage", "stiff")
    }
    tiny = np.array(RESPONSE["torque"])
    tiny[:, :, STAGE] *= 1e-12
    small = replace(SYNTHESIS, half_range=HALF * np.where(np.arange(4) == STAGE, 1e-12, 1.0))
    found = table(
        list(chapter(answered(train, small, torque=tiny, mean=MEAN[::-1]))),
        "Maximum vibratory torque",
    )
    assert found.rows[1] == ("stage", "0", "–", "–", "0", "0", "0", "−0.60600")


def test_sums_and_mean_are_those_of_the_segment_with_the_largest_half_range() -> None:
    made = torsion.run(torsion.parse(SHAFT))
    sizes = np.array([[[10.0, 30.0, 20.0]], [[11.0, 31.0, 21.0]]])
    part = {
        "speed": SPEED[:2],
        "requested": np.ones(2, dtype=bool),
        "lines": LINES[:1],
        "torque": sizes,
        "mean": np.array([[100.0, 200.0, 300.0], [400.0, 500.0, 600.0]]),
        "angle": np.ones((2, 1, 4)),
    }
    narrow = {
        key: RESPONSE[key][:2, :1] for key in ("frequency", "residual", "status", "joint_error")
    }
    half = np.array([[1.0, 2.0, 1.5], [3.0, 7.0, 5.0]])
    synthesis = Synthesis(half, half, half + 20.0, 60.0 - half, Fraction(2))
    found = with_loads(
        made.having(response=Response(**part, **narrow, system=made.system), synthesis=synthesis)
    )
    row = table(list(chapter(found)), "Maximum vibratory torque").rows[0]
    assert row == (
        "shaft",
        "7.0000",
        "114.59",
        "0.5 × flywheel",
        "31.000",
        "27.000",
        "53.000",
        "500.00",
    )


def test_peaks_are_inner_maxima_of_a_fiftieth_of_the_largest(train: Findings) -> None:
    """Of the stiff coupling 180 N m would be a fiftieth of 9000 N m; the stage has no inner maximum."""
    found = with_modes(train, 1.512, 3.82, 5.0)
    rows = table(list(chapter(answered(found))), "Resonance peaks").rows
    assert rows == (
        ("soft", "0.5 × flywheel", "0.090000", "181.44", "1.5120", "1"),
        ("soft", "2 × screw, stage", "0.070000", "315.13", "10.504", "–"),
        ("soft", "3.5 Hz (stage)", "0.0070000", "315.13", "3.5000", "–"),
        ("stiff", "2 × screw, stage", "9.0000", "114.59", "3.8197", "2"),
        ("stiff", "3.5 Hz (stage)", "0.80000", "315.13", "3.5000", "–"),
    )
    torque = np.array(RESPONSE["torque"])
    for size, rest in ((180.0, 1), (179.9, 0)):
        torque[3, 1, STIFF] = size
        loads = answered(train, torque=torque).results["component_loads"]
        speeds = [peak.speed for peak in loads.peaks if peak.component == "stiff"]
        assert speeds == [SPEED[k] for k in (1, 4, 3)][: 2 + rest]


@pytest.mark.parametrize(
    ("frequency", "damping", "mode"),
    [
        ((1.556,), None, "1"),
        ((1.559,), None, "–"),
        ((), None, "–"),
        ((1.559, 3.0), (0.01, 0.2), "–"),
        ((9.0, 2.2), (0.01, 0.24), "2"),
        ((9.0, 2.2), (0.24, 0.2), "–"),
        ((2.2,), (0.01,), "–"),
        ((1.556,), (0.01,), "1"),
        ((1.5 * PEAK,), (0.25,), "1"),
        ((1.5 * PEAK,), (0.2499,), "–"),
    ],
)
def test_a_peak_belongs_to_a_mode_within_three_percent_or_its_half_power_width(
    train: Findings, frequency: tuple[float, ...], damping: tuple[float, ...] | None, mode: str
) -> None:
    """The first peak of the soft coupling lies at 1.512 Hz; 2.2 Hz is 45.5 % above."""
    found = with_modes(train, *frequency, damping=damping)
    assert table(list(chapter(answered(found))), "Resonance peaks").rows[0][5] == mode


def test_of_more_than_ten_peaks_those_largest_at_one_speed_are_listed(train: Findings) -> None:
    """The stiff coupling turns at 2/5: 100 N m of it count as 40 N m of the soft one."""
    speeds = 61
    speed, torque = np.linspace(1.0, 7.0, speeds), np.zeros((speeds, 1, 4), dtype=complex)
    torque[1::2, 0, SOFT] = np.linspace(41.0, 70.0, 30)
    torque[1::2, 0, STIFF] = np.linspace(76.0, 105.0, 30)
    one = {
        "lines": LINES[:1],
        "status": np.zeros((speeds, 1), dtype=np.uint8),
        "mean": np.ones((speeds, 4)),
        "requested": speed > 0.0,
        "residual": np.zeros((speeds, 1)),
        "frequency": speed[:, None] / 4.0 / math.pi,
        "joint_error": np.zeros((speeds, 1)),
        "angle": np.ones((speeds, 1, 5)),
    }
    half = np.abs(torque[:, 0])
    made = Synthesis(half, half, half, half, Fraction(2))
    found = table(
        list(chapter(answered(train, made, speed=speed, torque=torque, **one))), "Resonance peaks"
    )
    sizes = [(row[0], float(row[2])) for row in found.rows]
    assert sizes == [("soft", 70.0 - k) for k in range(10)]
    assert found.caption.endswith("(the 10 largest of 60)")
    assert table(list(chapter(answered(train))), "Resonance peaks").caption.endswith(
        "in the speed range"
    )


def test_maximum_is_above_the_place_before_and_not_below_that_behind() -> None:
    assert local_maxima(
        np.array([9.0, 1.0, 3.0, 3.0, 1.0, 4.0, math.nan, 5.0, 1.0, 2.0, 1.0, 8.0])
    ) == [2, 9]
    assert local_maxima(np.array([1.0, 2.0, 1.0])) == [1]


def test_largest_angle_of_every_station_but_the_ground(train: Findings) -> None:
    """The third line is largest, at 19 rad/s: 21 mrad times what each station has, at 3.5 Hz."""
    found = table(list(angles(answered(train))), "Maximum angular amplitude")
    assert [row[0] for row in found.rows] == ["flywheel", "soft end", "stage end", "screw"]
    for row, times in zip(found.rows, (1.0, 2.0, 3.0, 4.0), strict=True):
        angle = 0.021 * times
        wanted = [math.degrees(angle), angle, 19.0 * RPM, angle * 3.5 * 60.0]
        assert [float(row[k]) for k in (1, 2, 4, 5)] == pytest.approx(wanted, rel=1e-4)
        assert row[3] == "3.5 Hz (stage)"
    status = np.zeros((6, 3), dtype=np.uint8)
    status[2, 1] = Status.NEAR_SINGULAR
    rows = table(list(angles(answered(train, status=status))), "Maximum angular amplitude").rows
    assert rows[3] == ("screw", "no reliable value", "–", "–", "–", "–")


def test_curves_of_an_element_with_its_permissible_torque(train: Findings) -> None:
    first, third = figures(list(chapter(answered(train))))
    total, *curves = third.lines.values()
    assert [line.name for line in curves] == ["order 0.5", "order 2", "3.5000 Hz"]
    assert [line.label for line in curves] == ["0.5", "2", "3.5000 Hz"]
    for k in range(3):
        assert curves[k].y == pytest.approx(SIZE[:, k, STIFF] / 1e3)
    heavy = int(np.argmax([line.weight for line in curves]))
    assert heavy == int(np.argmax(SIZE[:, :, STIFF].max(axis=0)))
    assert total.name == "total vibratory torque"
    assert total.y == pytest.approx(HALF[:, STIFF] / 1e3)
    assert total.x == pytest.approx(SPEED * RPM)
    assert levels(third) == {
        "permissible vibratory torque (manufacturer)": [2.5],
        "rated speed": [pytest.approx(30.0 * RPM)],
    }
    assert (unit(third), plot(third).bands) == ("kN m", ())
    assert (unit(first), list(levels(first))) == ("N m", ["rated speed"])
    axes = ("frequency", "angle", "torque", "residual", "status", "joint_error")
    for lines in (1, 2):
        few = {key: RESPONSE[key][:, :lines] for key in axes}
        drawn = figures(list(chapter(answered(train, lines=LINES[:lines], **few))))[0]
        assert ("total vibratory torque" not in drawn.lines) == (lines == 1)
    assert (
        "total vibratory torque" not in figures(list(chapter(answered(train, made=None))))[0].lines
    )


def test_of_more_than_eight_orders_seven_are_drawn_and_the_envelope_of_the_others(
    train: Findings,
) -> None:
    lines = tuple(Line(Fraction(n), None, ("screw",)) for n in range(1, 11))
    wide = {
        key: np.repeat(RESPONSE[key][:, :1], 10, axis=1)
        for key in RESPONSE
        if np.ndim(RESPONSE[key]) > 1
    }
    wide["torque"] = wide["torque"] * np.arange(1.0, 11.0)[:, None]
    wide["mean"] = MEAN
    (first, *_) = figures(list(chapter(answered(train, lines=lines, **wide))))
    assert [name for name in first.lines if name.startswith("order")] == [
        f"order {n}" for n in range(4, 11)
    ]
    third = (
        first.lines["order 6"].y / 2.0
    )  # of these torques every order is that many times the first
    np.testing.assert_allclose(first.lines["envelope of the other 3"].y, third, rtol=1e-14)


def test_of_many_elements_three_are_drawn_and_the_others_named() -> None:
    chain = "".join(
        f", coupling: {{name: c{k}, stiffness: 1e3}}, disc: {{inertia: 1}}" for k in range(1, 15)
    )
    operation = "operation: {speeds: {from: 1 rpm, to: 3 rpm, steps: 3}}"
    made = torsion.run(
        torsion.parse(f"name: long\n{operation}\ntrain: [disc: {{inertia: 1}}{chain}]\n")
    )
    size = np.ones((6, 1, 14)) * np.array([3, 1, *range(10, 22)])
    narrow = {
        key: RESPONSE[key][:, :1] for key in ("frequency", "residual", "status", "joint_error")
    }
    response = Response(
        **(
            RESPONSE
            | narrow
            | {
                "lines": LINES[:1],
                "torque": size,
                "mean": np.ones((6, 14)),
                "angle": np.ones((6, 1, 15)),
                "system": made.system,
            }
        )
    )
    blocks = list(chapter(made.having(response=response, synthesis=None)))
    assert [block.caption.split(",")[0][-3:] for block in figures(blocks)] == ["c12", "c13", "c14"]
    assert texts(blocks)[-1].startswith("No figure, because the torque is smaller: c1, c2, ")


SWEEP = FrequencyResponse(
    np.array([1.0, 2.0, 3.0, 4.0]),
    np.ones(4, dtype=bool),
    ("screw",),
    0.0,
    np.outer([1.0, 5.0, 2.0, 3.0], [1e-3, -2e-3, 3e-3j, 4e-3, 0.0]),
    np.outer([1.0, 2.0, 7.0, 3.0], [2e3, -4e3j, 0.0, 6e3]),
    np.zeros(4),
    np.zeros(4, dtype=np.uint8),
    None,  # type: ignore[arg-type]
)


def test_over_frequency_the_largest_torque_and_angle_with_their_curves(train: Findings) -> None:
    found = with_modes(train.having(sweep=replace(SWEEP, system=train.system)), 1.5, 2.5)
    blocks = list(over_frequency(found))
    assert [type(block) for block in blocks] == [Heading, Paragraph, Table, Figure, Figure]
    assert table(blocks, "torque").rows == (
        ("soft", "14.000", "3.0000"),
        ("stage", "42.000", "3.0000"),
        ("stiff", "28.000", "3.0000"),
        ("screw to ground", "0", "1.0000"),
    )
    assert table(blocks, "torque").columns[1].unit == "kN m"
    torque, angle = figures(blocks)
    assert list(torque.lines) == ["soft", "stage", "stiff"]
    assert torque.lines["stiff"].y == pytest.approx([4.0, 8.0, 28.0, 12.0])
    assert list(angle.lines) == ["flywheel", "soft end", "stage end", "screw"]
    assert angle.lines["screw"].y == pytest.approx(np.degrees([4e-3, 20e-3, 8e-3, 12e-3]))
    assert titles(torque) + titles(angle) == ["torque amplitude, kN m", "angular amplitude, deg"]
    for drawn in (torque, angle):
        assert levels(drawn) == {"natural frequencies": [1.5, 2.5]}
        assert all(line.x.tolist() == [1.0, 2.0, 3.0, 4.0] for line in drawn.lines.values())
        assert plot(drawn).bands == ()
    assert [block.caption for block in figures(blocks)] == [
        "Torque amplitude over the frequency",
        "Angular amplitude over the frequency",
    ]
    bare = list(over_frequency(train.having(sweep=replace(SWEEP, system=train.system), modes=None)))
    assert levels(figures(bare)[0]) == {}
    assert list(over_frequency(train)) == []


def test_over_frequency_an_undamped_resonance_has_no_value_and_is_named_once(
    train: Findings,
) -> None:
    """Two frequencies that read alike with five digits are one."""
    status = np.array([Status.OK, Status.SINGULAR, Status.NEAR_SINGULAR, Status.OK], dtype=np.uint8)
    hertz = np.array([1.0, 2.345671, 2.345672, 4.0])
    blocks = list(
        over_frequency(
            train.having(sweep=replace(SWEEP, status=status, frequency=hertz, system=train.system))
        )
    )
    assert texts(blocks)[1].startswith("At 2.3457 Hz the response has no reliable finite value")
    assert table(blocks, "torque").rows[0] == ("soft", "no reliable value", "–")
    assert bands(figures(blocks)[0], "no answer") == [(1.0, 4.0)]
    assert np.isnan(figures(blocks)[0].lines["soft"].y[1:3]).all()


def test_over_frequency_ten_curves_are_drawn_and_a_single_body_has_no_torque() -> None:
    chain = "".join(
        f", coupling: {{stiffness: 1e3}}, disc: {{name: d{k}, inertia: 1}}" for k in range(1, 13)
    )
    made = torsion.run(
        torsion.parse(f"name: long\ntrain: [disc: {{name: d0, inertia: 1}}{chain}]\n")
    )
    sweep = replace(
        SWEEP,
        torque=np.ones((4, 12)),
        angle=np.outer(np.ones(4), np.arange(1.0, 14.0)),
        system=made.system,
    )
    drawn = figures(list(over_frequency(made.having(sweep=sweep))))[1].lines
    assert list(drawn) == [f"d{k}" for k in range(3, 13)]
    alone = torsion.run(torsion.parse("name: one\ntrain: [disc: {name: d0, inertia: 1}]\n"))
    sweep = replace(SWEEP, torque=np.ones((4, 0)), angle=np.ones((4, 1)), system=alone.system)
    assert [type(block) for block in over_frequency(alone.having(sweep=sweep))] == [
        Heading,
        Paragraph,
        Figure,
    ]
