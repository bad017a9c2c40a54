"""The ice torque that follows from a class: formulas by hand, what a file may say of it, and what it lacks."""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.events.events import Event, Point
from torsion.analyses.motion.events.milling_ice import CLASSES, greatest_ice_torque
from torsion.analyses.motion.transient_motion import Transients
from torsion.errors import InputError
from torsion.kernels.motion.loaded_modes import value
from torsion.model.parts import PropellerRecord
from torsion.output.blocks import Paragraph, Table
from torsion.output.chapters.motion_over_time import chapter
from torsion.output.stored.results_json import results
from torsion.rules.verdict_line import Checks

SCREW = PropellerRecord(1.0, None, 4, 4.0, 0.8, None, 0.25)
TWICE = 4.0 * math.pi  # rad/s: 2 revolutions a second
SCENE = """name: x
operation: {{rated: {{speed: 480 rpm, power: 60 kW}}}}
train: [motor: {{inertia: 1}}, gear: {{ratio: 4}}, shaft: {{length: 1 m, diameter: 90 mm}}, propeller: {{name: screw,
        inertia: 2, {}}}]
analyses: {{transient: {{duration: 3 s, events: [{{at: screw, ice: {{{}}}}}]}}}}
"""
BRIEF = SCENE.replace("3 s", "0.5 s")
WHOLE = "blades: 4, diameter: 4 m, pitch_ratio: 0.8, hub_ratio: 25 %"


def by_hand(factor: float, thickness: float, diameter: float, large: bool) -> float:
    """N m at P/D 0.8, d/D 0.25 and 2 revolutions a second, of 30 digits."""
    with mpmath.workdps(30):
        d, h, shape = (
            mpmath.mpf(diameter),
            mpmath.mpf(thickness),
            mpmath.mpf(3) / 4 * mpmath.mpf(0.8) ** mpmath.mpf(0.16),
        )
        shape *= (2 * d) ** mpmath.mpf(0.17)
        size = mpmath.mpf(1.9) * d ** mpmath.mpf(1.9) * h ** mpmath.mpf(1.1) if large else d**3
        return float(1000 * mpmath.mpf(factor) * shape * size)


@pytest.mark.parametrize(
    ("factor", "thickness"), [(14.7, 4.0), (10.9, 1.0), (7.7, 1.2), (10.4, 2.5)]
)
@pytest.mark.parametrize("share", [0.5, 1.0, 1.0 + 1e-12, 2.0])
def test_the_greatest_torque_is_that_of_either_formula(
    factor: float, thickness: float, share: float
) -> None:
    diameter = 1.8 * thickness * share
    found = greatest_ice_torque(factor, thickness, replace(SCREW, diameter=diameter), TWICE)
    assert found == pytest.approx(by_hand(factor, thickness, diameter, share > 1.0), rel=1e-14)


def test_both_formulas_meet_but_for_the_rounding_of_their_factor() -> None:
    ends = [
        greatest_ice_torque(10.9, 1.0, replace(SCREW, diameter=1.8 * (1.0 + k)), TWICE)
        for k in (0.0, 1e-13)
    ]
    assert ends[1] / ends[0] == pytest.approx(1.9 / 1.8**1.1, rel=1e-12)
    assert ends[1] / ends[0] == pytest.approx(0.9953, abs=1e-4)


def test_the_torque_of_a_large_propeller_is_that_of_the_printed_factor_20_7() -> None:
    """297.14285 kN m by the formula of the Baltic classes with 20.7, which is 1.9 x 10.9 = 20.71 rounded."""
    assert greatest_ice_torque(10.9, 1.0, SCREW, TWICE) == pytest.approx(
        297142.85 * 20.71 / 20.7, rel=2e-8
    )


@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize("is_ducted", [False, True])
def test_a_class_takes_its_ice_and_its_factor(name: str, is_ducted: bool) -> None:
    polar = name in ("PC1", "PC2", "PC3", "PC4", "PC5")
    factor = {(True, False): 14.7, (True, True): 10.4, (False, False): 10.9, (False, True): 7.7}[
        polar, is_ducted
    ]
    body = Event.model_validate({"at": "x", "ice": {"class": name, "case": 1}}).body
    at = Point("x", TWICE, blades=4, propeller=replace(SCREW, is_ducted=is_ducted))
    found, thickness = body.of_class(at), CLASSES[name].thickness
    assert found.torque == pytest.approx(
        by_hand(factor, thickness, 4.0, 1.8 * thickness < 4.0), rel=1e-14
    )
    assert (found.revolutions, body.revolutions) == (2.0 * thickness, 2.0 * thickness)


def test_the_ice_of_the_classes_is_thinner_from_each_to_the_next() -> None:
    polar, baltic = (
        [CLASSES[name].thickness for name in CLASSES if name.startswith(start)]
        for start in ("PC", "I")
    )
    assert polar == [4.0, 3.5, 3.0, 2.5, 2.0, 1.75, 1.5]
    assert baltic == [1.75, 1.5, 1.2, 1.0]


def test_a_class_mills_like_the_torque_that_follows_from_it() -> None:
    """Also where the revolutions are no whole number: 2 x 1.2 m."""
    at = Point("x", 10.0, blades=4, propeller=SCREW, rated_speed=TWICE)
    for case in (1, 2, 3, 4):
        named = Event.model_validate({"at": "x", "ice": {"class": "IB", "case": case}})
        size = by_hand(10.9, 1.2, 4.0, True)
        same = Event.model_validate(
            {"at": "x", "ice": {"torque": size, "case": case, "turns": 2.4}}
        )
        time = np.linspace(0.0, 2.0, 2001)
        one, other = (value(event.pieces(at), time) for event in (named, same))
        assert one == pytest.approx(other, abs=1e-12 * size)
        assert np.abs(one).max() > 0.2 * size
        assert not one[time > 2.4 * 2.0 * math.pi / 10.0 + 1e-9].any()


@pytest.mark.parametrize("turns", [2.05, 2.4, 2.6])
@pytest.mark.parametrize(
    ("case", "factor", "width"), [(1, 0.75, 90.0), (2, 1.0, 135.0), (3, 0.5, 45.0)]
)
def test_the_half_sines_end_with_the_revolutions(
    turns: float, case: int, factor: float, width: float
) -> None:
    """By the rule itself: every blade from where it hits, 90 degrees behind the last, with ramps of 270 degrees."""
    event = Event.model_validate({"at": "x", "ice": {"torque": 1.0, "case": case, "turns": turns}})
    time = np.linspace(0.0, 2.0, 4001)
    turned, last = np.degrees(10.0 * time), 360.0 * turns
    exact = np.zeros_like(turned)
    for hit in range(11):
        for first in (90.0 * hit, 90.0 * hit + 45.0)[: 2 if case == 3 else 1]:
            inside = (turned >= first) & (turned < min(first + width, last))
            exact -= np.where(
                inside, factor * np.sin(np.radians(180.0 * (turned - first) / width)), 0.0
            )
    exact *= np.interp(turned, [0.0, 270.0, last - 270.0, last], [0.0, 1.0, 1.0, 0.0])
    assert value(event.pieces(Point("x", 10.0, blades=4)), time) == pytest.approx(exact, abs=1e-11)


def test_rounding_of_the_revolutions_makes_no_piece_of_no_length() -> None:
    """The second block of blade 83 of six would begin where 13.75 revolutions end, but for 1.4e-14 rad."""
    event = Event.model_validate({"at": "x", "ice": {"torque": 1.0, "case": 3, "turns": 13.75}})
    pieces = event.pieces(Point("x", 10.0, blades=6))
    assert min(piece.end - piece.begin for piece in pieces) > 1e-6
    assert len({piece.begin for piece in pieces}) >= 2 * 82


def test_a_thickness_and_a_speed_of_the_file_take_the_place_of_those_of_the_class() -> None:
    body = {"class": "IA", "case": 1, "thickness": "0.9 m", "speed": "120 rpm"}
    ice = Event.model_validate({"at": "x", "ice": body}).body
    found = ice.of_class(Point("x", 3.0, blades=4, propeller=SCREW, rated_speed=5.0))
    assert found.torque == pytest.approx(by_hand(10.9, 0.9, 4.0, True), rel=1e-14)
    assert found.revolutions == pytest.approx(1.8, rel=1e-15)


@for_all(
    ("body", "words"),
    [
        ("case: 1", "ice has a `torque` or a `class`"),
        ("class: IA, torque: 1, case: 1", "ice of a `class` has no separate `torque`"),
        ("torque: 1, thickness: 1 m, case: 1", "`thickness` is of a class of ice"),
        ("torque: 1, speed: 100 rpm, case: 1", "`speed` is of a class of ice"),
        ("class: PC8, case: 1", "PC8"),
        ("class: IA", "ice has a `case`, or an `angle`"),
        ("class: IA, case: 1, thickness: 0 m", "more than 0 m"),
        ("class: IA, case: 1, thickness: 700 m", "outside the usual range"),
        ("class: IA, case: 1, thickness: 0.7 m", "at most 252 deg for 1.4 turns"),
        ("class: IA, case: 1, turns: 0.5", "at least 1"),
    ],
)
def test_what_does_not_go_together_is_refused_at_its_place(body: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(SCENE.format(WHOLE, body))
    assert words in str(refused.value)
    assert refused.value.faults[0].line == 5


@pytest.mark.parametrize(
    ("screw", "words"),
    [
        ("blades: 4, pitch_ratio: 0.8, hub_ratio: 0.25", "class IA needs `diameter` of 'screw'"),
        ("blades: 4, diameter: 4 m, hub_ratio: 0.25", "class IA needs `pitch_ratio` of 'screw'"),
        ("blades: 4, diameter: 4 m, pitch_ratio: 0.8", "class IA needs `hub_ratio` of 'screw'"),
        ("blades: 4", "needs `diameter` and `pitch_ratio` and `hub_ratio` of 'screw'"),
        ("diameter: 4 m, pitch_ratio: 0.8, hub_ratio: 0.25", "a turning propeller with `blades`"),
        ("blades: 7, diameter: 4 m, pitch_ratio: 0.8, hub_ratio: 0.25", "3 to 6 blades, not 7"),
    ],
)
def test_what_a_class_lacks_of_its_propeller_is_said_at_its_place(screw: str, words: str) -> None:
    (one,) = torsion.run(torsion.parse(SCENE.format(screw, "class: IA, case: 1"))).plan.unanswered
    assert words in one.why
    assert (one.line, one.is_input) == (5, True)
    assert one.remedy


def test_a_class_needs_a_speed_where_nothing_turns_before() -> None:
    ice = Event.model_validate({"at": "x", "ice": {"class": "IA", "case": 1}}).body
    at = Point("x", blades=4, propeller=SCREW, turns=True)
    assert ice.lacks(at)[0] == "the ice torque of class IA needs the speed of 'x'"
    assert ice.lacks(replace(at, rated_speed=1.0)) is None
    assert (
        Event.model_validate(
            {"at": "x", "ice": {"class": "IA", "case": 1, "speed": "9 rpm"}}
        ).body.lacks(at)
        is None
    )


def test_the_torque_of_a_class_follows_the_angle_of_a_train_that_starts() -> None:
    at, size = (
        Point("x", 0.0, blades=4, propeller=SCREW, rated_speed=TWICE, turns=True),
        by_hand(10.9, 1.2, 4.0, True),
    )
    bodies = {"class": "IB", "case": 1}, {"torque": size, "turns": 2.4, "case": 1}
    events = [Event.model_validate({"at": "x", "ice": body}) for body in bodies]
    assert [event.pieces(at) for event in events] == [(), ()]
    one, other = (
        [(*law.history.begin, *(level for acting in law.history.acting for level in acting.level))]
        for event in events
        for law in event.body.laws(0.0, at)
    )
    assert np.array(one) == pytest.approx(np.array(other), rel=1e-13)
    assert np.abs(one).max() > 0.3 * size


def test_the_report_says_formula_inputs_and_that_they_are_to_be_verified() -> None:
    found = torsion.run(torsion.parse(BRIEF.format(WHOLE, "class: IA, case: 1")))
    (motion,) = found.need(Transients).each
    (torque,) = motion.ice
    assert torque.torque == pytest.approx(by_hand(10.9, 1.5, 4.0, True), rel=1e-13)
    ((read,),) = [one["ice"] for one in results(found)["transient"]]
    assert (read["ice_class"], read["thickness_m"], read["ducted"]) == ("IA", 1.5, False)
    blocks = list(chapter(found))
    (row,) = next(
        block.rows for block in blocks if isinstance(block, Table) and "ice torque" in block.caption
    )
    assert row == (
        "screw",
        "IA",
        "1.5000",
        "no",
        "10.900",
        "4.0000",
        "0.25000",
        "0.80000",
        "120.00",
        "3.0000",
        f"{by_hand(10.9, 1.5, 4.0, True) / 1e3:.2f}",
    )
    notes = [
        block.text for block in blocks if isinstance(block, Paragraph) and block.kind == "note"
    ]
    assert sum("edition not confirmed" in note for note in notes) == 2
    assert any(
        "1.9 k (1 − d/D) (P/D)^0.16 (n D)^0.17 D^1.9 H^1.1 for diameters beyond 1.8 H" in note
        for note in notes
    )


def test_a_torque_of_the_file_has_no_formula_in_the_report() -> None:
    found = torsion.run(torsion.parse(BRIEF.format(WHOLE, "torque: 2 kN*m, angle: 90 deg")))
    assert found.need(Transients).each[0].ice == ()
    assert not [block for block in chapter(found) if "to be verified" in getattr(block, "text", "")]


ICED = """name: x
operation: {rated: {speed: 100 rpm, power: 20 kW}, load: propeller}
train:
- motor: {name: m, inertia: 20}
- coupling: {name: c, stiffness: 1e5, viscous: 50, max_torque: 90 kN*m}
- propeller: {name: p, inertia: 20, blades: 4}
analyses:
  transient:
    duration: 2 s
    events:
    - {at: p, time: 0.05 s, ice: {torque: SIZE, angle: 90 deg, turns: 2, ramp: 0 deg}}
MORE"""
FOLLOWS = """    - {at: m, start: {torque: [[0 rpm, 2.1 kN*m], [100 rpm, 1909.9 N*m], [300 rpm, 0]]}}
    - {at: p, load: {law: propeller}}
"""


@pytest.mark.parametrize("slowed", [0.095, 0.105, 3.0])
def test_ice_that_slows_a_train_whose_torques_do_not_follow_never_passes(slowed: float) -> None:
    # half sines without a gap: 2/pi of their torque for two revolutions at the speed before, of 0.6 s, on 40 kg m2
    size = slowed * 40.0 * (2.0 * math.pi * 100.0 / 60.0) / 1.2 * math.pi / 2.0
    found = torsion.run(torsion.parse(ICED.replace("SIZE", repr(size)).replace("MORE", "")))
    motion = found.need(Transients).each[0]
    assert motion.slowed == pytest.approx(-slowed, rel=1e-2)  # it vibrates about that
    (line,) = found.need(Checks).lines
    doubt = f"the ice slows the train by {-100.0 * motion.slowed:.3g} %"
    assert (doubt in motion.status) == (slowed > 0.1) == (line.verdict == "fail")


def test_ice_where_torques_follow_the_speed_gives_no_such_doubt() -> None:
    found = torsion.run(torsion.parse(ICED.replace("SIZE", "3000").replace("MORE", FOLLOWS)))
    motion = found.need(Transients).each[0]
    assert motion.slowed is None
    assert motion.speed[-1].min() < 0.9 * motion.speed_before
    assert motion.status == "ok"
