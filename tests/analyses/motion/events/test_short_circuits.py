"""Short circuits of electrical machines: both senses, clearing and reclosing, against an independent integration."""

import json
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.output.blocks import Paragraph
from torsion.output.chapters.motion_over_time import chapter
from torsion.output.stored.results_json import results
from torsion.rules.verdict_line import Checks

ORACLES = json.loads((Path(__file__).parent / "drives_oracles.json").read_text())["short_circuit"]
TWO_PHASE = "{line: 8, double: 4, mean: 0.3}"
THREE_PHASE = "{line: 6, mean: 0.3}"
AGAIN = ", clear: 0.15 s, reclose: 0.40 s"
SCENE = """name: x
operation: {rated: {speed: 1500 rpm, power: 8 MW}, load: constant}
train:
- motor: {name: turbine, inertia: 1500}
- coupling: {name: main, stiffness: 30 MN*m/rad, viscous: 3000, max_torque: 200 kN*m}
- disc: {inertia: 200}
- coupling: {name: second, stiffness: 9 MN*m/rad, viscous: 2000}
- generator: {name: g, inertia: 900}
analyses:
  transient:
    duration: 1.2 s
    events: [{at: g, time: 50 ms, short-circuit: {decay: [0.2 s, 30 ms], coefficients: BODY} }]
"""


def scene(body: str) -> str:
    return SCENE.replace("BODY", body)


def moved(body: str) -> TransientMotion:
    (motion,) = torsion.run(torsion.parse(scene(body))).need(Transients).each
    return motion


@pytest.mark.parametrize(
    ("body", "senses"),
    [
        (TWO_PHASE, ("plus_drives_first", "minus_brakes_first")),
        (
            TWO_PHASE + AGAIN,
            (
                "plus_clear_0.15_reclose_0.40_after_begin",
                "minus_clear_0.15_reclose_0.40_after_begin",
            ),
        ),
        (TWO_PHASE + ", load: falls", ("plus_load_falls", "minus_load_falls")),
        (THREE_PHASE, ("plus", "minus")),
    ],
)
def test_each_sense_of_a_fault_has_the_torques_of_an_independent_integration(
    body: str, senses: tuple[str, str]
) -> None:
    table = ORACLES["three_phase_line_6_mean_0.3"] if body == THREE_PHASE else ORACLES
    for sense, name in zip(("drives", "brakes"), senses, strict=True):
        motion = moved(f"{body}, sense: {sense}")
        for span, expected in enumerate(table[name]):
            assert motion.greatest[span] == pytest.approx(expected["largest"], rel=1e-11)
            assert motion.greatest_at[span] == pytest.approx(expected["at"], abs=1e-8)
            assert motion.least[span] == pytest.approx(expected["least"], rel=1e-11)
            assert motion.least_at[span] == pytest.approx(expected["at_least"], abs=1e-8)


def test_both_senses_are_computed_where_the_file_names_none_and_the_worse_is_judged_and_named() -> (
    None
):
    findings = torsion.run(torsion.parse(scene(TWO_PHASE)))
    (motion,) = findings.need(Transients).each
    for span, pair in enumerate(
        zip(ORACLES["plus_drives_first"], ORACLES["minus_brakes_first"], strict=True)
    ):
        assert motion.greatest[span] == pytest.approx(
            max(one["largest"] for one in pair), rel=1e-11
        )
        assert motion.least[span] == pytest.approx(min(one["least"] for one in pair), rel=1e-11)
    (check,) = findings.need(Checks).lines
    assert (check.verdict, check.value) == ("fail", pytest.approx(211218.4063105, rel=1e-11))
    (entry,) = results(findings)["transient"]
    assert (entry["worst_fault"], entry["faults_computed"]) == ("it brakes first", 2)
    said = [
        block.text for block in chapter(findings) if isinstance(block, Paragraph) and block.brief
    ]
    assert any(
        "computed 2 electrical faults. The curves show the worst: it brakes first" in text
        for text in said
    )


def test_a_range_of_times_of_reclosing_is_scanned_for_the_worst() -> None:
    """A scan in steps of 0.5 ms has 257 340 N m: between its own times this one finds no less."""
    motion = moved(TWO_PHASE + ", sense: brakes, clear: 0.15 s, reclose: [0.2 s, 0.24 s]")
    reference = dict(map(tuple, ORACLES["reclose_scan_minus_coupling_1"]))
    assert motion.greatest[0] > max(reference.values())
    assert motion.greatest[0] == pytest.approx(257340.0, rel=2e-4)
    assert motion.greatest[0] >= 257340.0
    assert motion.worst_fault.startswith("it brakes first, reclosed after 0.2")


@for_all(("reclose", "torque"), ORACLES["reclose_scan_minus_coupling_1"])
def test_each_time_of_reclosing_has_the_torque_of_an_independent_integration(
    reclose: float, torque: float
) -> None:
    motion = moved(f"{TWO_PHASE}, sense: brakes, clear: 0.15 s, reclose: {reclose} s")
    assert motion.greatest[0] == pytest.approx(torque, rel=1e-11)


SOFT = (
    SCENE.replace("30 MN*m/rad, viscous: 3000, max_torque: 200 kN*m", "0.5 MN*m/rad, viscous: 500")
    .replace("9 MN*m/rad, viscous: 2000", "20 MN*m/rad, viscous: 500, max_torque: 620 kN*m")
    .replace("duration: 1.2 s", "duration: 1 s")
)


def test_a_range_is_scanned_as_finely_as_the_fastest_mode_needs_not_the_slowest() -> None:
    """The lowest mode has 5.0 Hz, the other 56 Hz: that one makes the peaks, and any time inside is no worse."""

    def soft(reclose: str) -> Findings:
        body = f"{TWO_PHASE}, clear: 0.15 s, reclose: {reclose}"
        return torsion.run(torsion.parse(SOFT.replace("BODY", body)))

    scan = soft("[0.4 s, 0.42 s]")
    (motion,) = scan.need(Transients).each
    single = [
        soft(f"{time} s").need(Transients).each[0].peak
        for time in (0.4, 0.404, 0.408, 0.412, 0.416, 0.42)
    ]
    assert (motion.peak >= 0.999 * np.max(single, axis=0)).all()
    assert motion.peak[1] >= 641.0e3
    assert scan.need(Checks).lines[0].verdict == "fail"


def test_a_range_that_needs_too_many_faults_is_refused() -> None:
    text = scene(TWO_PHASE + ", clear: 0.15 s, reclose: [0.2 s, 0.9 s]")
    (fault,) = torsion.run(torsion.parse(text)).plan.unanswered
    assert "short circuits would be computed" in fault.why
    assert fault.is_input


@pytest.mark.parametrize("reclose", ["1.2 s", "1.15 s", "[0.4 s, 1.2 s]"])
def test_a_fault_that_would_begin_anew_after_the_end_of_the_motion_is_refused(reclose: str) -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(scene(f"{TWO_PHASE}, clear: 0.15 s, reclose: {reclose}"))
    (fault,) = refused.value.faults
    assert "after the end of the transient response" in fault.message
    assert fault.path[-2:] == ("short-circuit", "reclose")
    assert fault.line == 12


def test_the_torque_of_the_fault_is_that_of_the_power_of_its_machine() -> None:
    half = scene(TWO_PHASE + ", sense: brakes").replace("inertia: 900", "inertia: 900, power: 4 MW")
    (motion,) = (
        torsion.run(torsion.parse(half.replace("power: 8 MW", "power: 4 MW"))).need(Transients).each
    )
    assert motion.greatest[0] == pytest.approx(211218.4063105 / 2.0, rel=1e-10)


@for_all(
    ("old", "new", "words", "line"),
    [
        (
            "generator: {name: g",
            "disc: {name: g",
            "a short circuit acts in an electrical machine (make 'g' a `generator`; its load then leaves there)",
            12,
        ),
        ("at: g", "at: turbine", "", 0),
        ("coefficients: ", "reclose: 0.3 s, coefficients: ", "`reclose` comes after `clear`", 12),
        (
            "coefficients: ",
            "clear: 0.3 s, reclose: [0.2 s, 0.5 s], coefficients: ",
            "`reclose` comes after `clear`",
            12,
        ),
        (
            "coefficients: ",
            "clear: 0.1 s, reclose: [0.5 s, 0.2 s], coefficients: ",
            "from the shorter to the longer",
            12,
        ),
        (
            "coefficients: ",
            "sense: forward, coefficients: ",
            "'forward' is none of 'both', 'brakes' or 'drives'",
            12,
        ),
    ],
)
def test_a_faulty_short_circuit_is_refused_at_its_place(
    old: str, new: str, words: str, line: int
) -> None:
    text = scene(TWO_PHASE).replace(old, new)
    if not words:
        assert torsion.parse(text).analyses
        return
    with pytest.raises(InputError) as refused:
        torsion.parse(text)
    assert words in str(refused.value)
    assert refused.value.faults[0].line == line


def test_a_load_that_falls_needs_a_mean_torque() -> None:
    text = scene(TWO_PHASE + ", load: falls").replace(
        "duration", "initial: {speed: 1500 rpm}\n    duration"
    )
    (fault,) = torsion.run(torsion.parse(text)).plan.unanswered
    assert "no mean torque acts at 'g'" in fault.why


@pytest.mark.parametrize(
    ("event", "other"),
    [
        ("step: {torque: 1 kN*m, length: 0.2 s}", "step: {torque: 1 kN*m, until: 0.2 s}"),
        (
            "sine: {torque: 1 kN*m, frequency: 9 Hz, length: 0.2 s}",
            "sine: {torque: 1 kN*m, frequency: 9 Hz, until: 0.2 s}",
        ),
        ("stop: {length: 0.2 s}", "stop: {until: 0.2 s}"),
    ],
)
def test_length_is_another_word_for_until(event: str, other: str) -> None:
    body = SCENE[SCENE.index("short-circuit") : SCENE.index(" }]")]
    text = SCENE.replace("time: 50 ms", "time: 100 ms").replace(
        "duration: 1.2 s", "duration: 0.4 s"
    )
    each = [
        torsion.run(torsion.parse(text.replace(body, one))).need(Transients).each[0]
        for one in (event, other)
    ]
    assert (each[0].torque == each[1].torque).all()


def test_until_before_the_time_of_its_event_is_refused_as_it_is_a_length() -> None:
    body = SCENE[SCENE.index("short-circuit") : SCENE.index(" }]")]
    text = SCENE.replace(body, "step: {torque: 1 kN*m, until: 0.2 s}").replace(
        "time: 50 ms", "time: 300 ms"
    )
    with pytest.raises(
        InputError, match=r"`until` counts from the begin of the event.*`length: 0.2 s`"
    ):
        torsion.parse(text)
    with pytest.raises(InputError, match="`until` and `length` have the same meaning"):
        torsion.parse(text.replace("until: 0.2 s", "until: 0.4 s, length: 0.4 s"))
