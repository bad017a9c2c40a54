"""Periodic torques act in every motion over time, by the angle of their station, and the motion says which acted."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion import commands
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.train.state_before import acting_torques
from torsion.analyses.motion.transient_motion import TransientMotion, Transients
from torsion.analyses.response.amplitudes import Response
from torsion.assembly import assemble
from torsion.errors import InputError, SolveError
from torsion.output.blocks import Paragraph
from torsion.output.chapters.motion_over_time import chapter
from torsion.output.stored.results_json import results
from torsion.rules.verdict_line import Checks

ORACLES = json.loads((Path(__file__).parent / "drives_oracles.json").read_text())["acting_torques"]
SCENES = Path(__file__).parents[4] / "shafting_specs"
RIPPLE = ", ripple: [{order: 1, torque: 50 N*m}]"
SCENE = """name: x
train:
- motor: {name: m, inertia: 3RIPPLE}
- coupling: {name: coupling, stiffness: 3000, viscous: 6, max_torque: 50 N*m}
- disc: {name: load, inertia: 1}
analyses: {transient: {duration: 2 s, tolerance: 1e-10, BODY}}
"""
AT_SPEED = "initial: {speed: 600 rpm}"
STEP = ", events: [{at: m, step: {torque: 1 N*m}}]"


def scene(body: str, ripple: str = RIPPLE) -> str:
    return SCENE.replace("RIPPLE", ripple).replace("BODY", body)


def moved(text: str) -> TransientMotion:
    (motion,) = torsion.run(torsion.parse(text)).need(Transients).each
    return motion


@pytest.mark.parametrize(
    ("body", "ripple", "expected"),
    [
        (AT_SPEED + STEP, RIPPLE, ORACLES["step_and_order"]),
        (AT_SPEED, RIPPLE, ORACLES["order_only"]),
        (AT_SPEED + STEP, "", ORACLES["step_only"]),
        (AT_SPEED + STEP + ", torques: none", RIPPLE, ORACLES["step_only"]),
        (
            "initial: rest" + STEP.replace("1 N", "200 N"),
            RIPPLE,
            ORACLES["rest_step_200_and_order"],
        ),
        ("initial: rest" + STEP.replace("1 N", "200 N"), "", ORACLES["rest_step_200_only"]),
    ],
)
def test_a_ripple_by_the_angle_of_its_motor_has_the_torques_of_an_independent_integration(
    body: str, ripple: str, expected: dict[str, float]
) -> None:
    motion = moved(scene(body, ripple))
    first = motion.greatest[0] > -motion.least[0]
    assert motion.peak[0] == pytest.approx(expected["greatest"], rel=2e-9)
    assert (motion.greatest_at if first else motion.least_at)[0] == pytest.approx(
        expected["at"], abs=3e-6
    )
    assert motion.speed[0, -1] * 30.0 / math.pi == pytest.approx(
        expected["end_speed_motor_rpm"], rel=1e-10
    )
    assert motion.torque[0, -1] == pytest.approx(expected["torque_end"], rel=2e-8)


def test_the_steady_response_at_the_initial_speed_has_the_amplitude_of_the_oracle() -> None:
    head = "name: x\noperation: {speeds: {from: 600 rpm, to: 601 rpm, steps: 2}}\n"
    text = scene(AT_SPEED).replace("name: x\n", head, 1)
    response = torsion.run(
        torsion.parse(text[: text.index("analyses:")] + "analyses: {response: }\n")
    ).need(Response)
    at = int(np.argmin(np.abs(response.speed - 600 * math.pi / 30.0)))
    assert abs(response.torque[at, 0, 0]) == pytest.approx(
        ORACLES["steady_amplitude_600"], rel=1e-11
    )


def test_the_limit_of_a_coupling_fails_by_a_ripple_in_a_motion_that_begins_at_a_speed() -> None:
    (check,) = torsion.run(torsion.parse(scene(AT_SPEED + STEP))).need(Checks).lines
    assert (check.verdict, check.value) == (
        "fail",
        pytest.approx(ORACLES["step_and_order"]["greatest"], rel=1e-8),
    )


def test_a_steady_vibration_by_the_angle_leaves_that_of_the_speed_before_with_the_square_of_its_amplitude() -> (
    None
):
    """A cos(k angle) is A cos(kwt) but for terms of second order: by the angle of the vibration, and by its drift."""
    rated = "operation: {rated: {speed: 600 rpm, power: 60 kW}}\ntrain:"
    deviations = []
    for size in (4.0, 2.0):
        ripple = f", ripple: [{{LAW, torque: {size} N*m}}]"
        text = (
            scene("initial: steady", ripple)
            .replace("train:", rated)
            .replace("duration: 2 s", "duration: 0.4 s")
        )
        by_angle, fixed = (
            moved(text.replace("LAW", law)) for law in ("order: 2", "frequency: 20 Hz")
        )
        deviations.append(np.abs(by_angle.torque - fixed.torque).max())
    assert deviations[0] < 0.01 * np.ptp(fixed.torque)
    assert deviations[0] / deviations[1] == pytest.approx(4.0, rel=1e-3)


def test_a_torque_of_a_fixed_frequency_acts_from_rest_as_the_closed_form_has_it() -> None:
    """Two discs under A cos(wt) without damping: the twist beats between the natural and the forced frequency."""
    text = scene("initial: rest", ", ripple: [{frequency: 10 Hz, torque: 50 N*m}]").replace(
        ", viscous: 6", ""
    )
    motion = moved(text)
    natural, forced = math.sqrt(3000.0 * (1.0 / 3.0 + 1.0)), 20.0 * math.pi
    shape = np.cos(forced * motion.time) - np.cos(natural * motion.time)
    exact = 3000.0 * (50.0 / 3.0) * shape / (natural**2 - forced**2)
    assert motion.torque[0] == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    assert motion.steps == 0  # linear in time: no collocation


def test_a_share_of_the_mean_torque_is_that_of_the_speed_at_which_the_motion_begins() -> None:
    """At half of the rated speed a load of the second power has a quarter of the rated torque."""
    rated = "operation: {rated: {speed: 1200 rpm, power: 25.1327412287183 kW}}\ntrain:"  # 200 N m at 1200 rpm
    share = scene(AT_SPEED, ", ripple: [{frequency: 10 Hz, torque: {of_mean: 100 %}}]").replace(
        "train:", rated
    )
    share = share.replace("disc: {name: load", "propeller: {name: load")
    amount = share.replace("{of_mean: 100 %}", "50 N*m")
    assert moved(share).greatest[0] == pytest.approx(moved(amount).greatest[0], rel=1e-12)


BRAKED = """name: x
operation: {rated: {speed: 1500 rpm}}
train:
- motor: {name: m, inertia: 3, ripple: [{order: 2, torque: AT_MOTOR, phase: 25 deg}]}
- coupling: {name: c, stiffness: 30000, viscous: 20, max_torque: 2000 N*m}
- disc: {name: d, inertia: 1}
- coupling: {name: e, stiffness: 40000, viscous: 20}
- pump: {name: p, inertia: 4, power: 200 kW, blades: 3, excitation: [{blade_order: 1, torque: AT_PUMP}]LAW}
analyses: {transient: {duration: 1 s, events: [{at: p, time: 0.1 s, EVENT}]}}
"""
BRAKE = "step: {torque: -700 N*m}"  # and the train, whose mean torques stay, slows to 500 rpm
LOAD = "load: {law: constant, torque: 2000 N*m}"
MEAN = 200e3 / (50.0 * math.pi)


def braked(
    motor: float, pump: float, event: str = BRAKE, *, share: bool, law: str = ""
) -> TransientMotion:
    """The motion with ripples of these shares of the mean torque at 1500 rpm, as shares or in N m."""
    sizes = [f"{100.0 * one!r} %" if share else f"{one * MEAN!r} N*m" for one in (motor, pump)]
    text = BRAKED.replace("AT_MOTOR", sizes[0]).replace("AT_PUMP", sizes[1]).replace("EVENT", event)
    return moved(text.replace("LAW", law))


@pytest.mark.parametrize("law", ["", ", load: constant", ", load: {exponent: 1.5}"])
def test_a_share_of_a_mean_torque_that_stays_does_not_follow_the_law_of_the_load(law: str) -> None:
    by_share, by_amount = (braked(0.2, 0.1, share=share, law=law) for share in (True, False))
    assert by_amount.speed[0, -1] < 0.8 * by_amount.speed_before
    assert by_share.torque == pytest.approx(
        by_amount.torque, rel=1e-8, abs=1e-6 * by_amount.peak.max()
    )
    assert (
        "mean torques (they stay at their initial values; the law of a load acts by an event `load`)"
        in by_share.acting
    )


ENGINE = """engine: {name: m, cylinders: 4, strokes: 4, firing_order: [1, 3, 4, 2], inertia: 0.5, stiffness: 5 MN*m/rad,
    geometry: {bore: 170 mm, stroke: 190 mm, rod_length: 380 mm}, masses: {reciprocating: 5},
    gas: {cycle: wiebe, compression_ratio: 15, charge: 2.8 bar, exhaust: 2.5 bar, imep: 18 bar, p_max: 140 bar,
    duration: 65 deg}}
- disc: {inertia: 2}
"""


def test_the_gas_of_cylinders_at_a_mean_torque_that_stays_does_not_follow_the_law_of_the_load() -> (
    None
):
    """Both laws give one torque at the rated speed, at which the motion begins."""
    text = (
        BRAKED.replace("AT_PUMP", "0 N*m")
        .replace("EVENT", BRAKE)
        .replace("duration: 1 s", "duration: 0.45 s")
    )
    head, tail = text[: text.index("motor:")], text[text.index("- coupling: {name: c") :]
    by_law = [
        moved(head + ENGINE + tail.replace("LAW", f", load: {law}"))
        for law in ("quadratic", "constant")
    ]
    assert by_law[0].speed[0, -1] < 0.85 * by_law[0].speed_before
    assert by_law[0].torque == pytest.approx(
        by_law[1].torque, rel=1e-7, abs=1e-6 * by_law[1].peak.max()
    )


def test_where_a_load_acts_by_an_event_the_share_at_its_point_follows_a_law_and_that_of_the_motor_stays() -> (
    None
):
    by_share, by_amount = (braked(0.2, 0.0, LOAD, share=share) for share in (True, False))
    assert by_amount.speed[0, -1] < 0.9 * by_amount.speed_before
    assert by_share.torque == pytest.approx(
        by_amount.torque, rel=1e-8, abs=1e-6 * by_amount.peak.max()
    )
    by_share, by_amount = (braked(0.0, 0.3, LOAD, share=share) for share in (True, False))
    late = by_share.time > 0.8
    assert np.ptp(by_share.torque[1, late]) < 0.9 * np.ptp(by_amount.torque[1, late])
    assert "mean torques" in " ".join(by_share.acting)


@pytest.mark.parametrize("kind", ["order: 1", "frequency: 10 Hz"])
def test_a_share_of_a_mean_torque_that_is_not_known_is_refused_by_its_name(kind: str) -> None:
    text = scene(AT_SPEED + STEP, f", ripple: [{{{kind}, torque: {{of_mean: 10 %}}}}]")
    (fault,) = torsion.run(torsion.parse(text)).plan.unanswered
    assert "the torque at 'm' is a share of the mean torque, which is not known" in fault.why
    assert fault.is_input


TWO = RIPPLE + "}\n- coupling: {stiffness: 1e4, viscous: 1}\n- disc: {name: middle, inertia: 1"
TWO_EXCITE = scene("BODY", TWO).replace(
    "analyses", "excitations: [{at: load, order: 2, torque: 30 N*m}]\nanalyses"
)


def test_torques_are_left_out_by_name() -> None:
    some = moved(TWO_EXCITE.replace("BODY", AT_SPEED + ", torques: [m]"))
    one = moved(scene(AT_SPEED, TWO))
    assert np.array_equal(some.torque, one.torque)
    assert some.not_acting[0] == "order 2 at load (left out by `torques`)"


@pytest.mark.parametrize(
    ("scene", "engine"),
    [("v12_generator_set", "engine"), ("reciprocating_compressor", "compressor")],
)
def test_the_orders_of_all_cylinders_act_under_the_name_of_their_machine(
    scene: str, engine: str
) -> None:
    study = torsion.read(SCENES / f"{scene}.yaml")
    settings = TransientSettings(duration=1.0, initial="rest")
    (orders, *_) = acting_torques(study, settings).acting
    assert orders.endswith(f" orders at {engine} (by its angle)")


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ("[motor]", "no periodic torque acts at 'motor'"),
        ("[coupling]", "no periodic torque acts at 'coupling'"),
        ("[]", "`torques` names nothing"),
        ("5", "`none` or a list of names"),
    ],
)
def test_names_without_a_periodic_torque_are_refused(names: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(scene(AT_SPEED + f", torques: {names}"))
    assert words in str(refused.value)
    assert refused.value.faults[0].line == 6


def test_another_method_of_integration_is_refused_at_its_place() -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(scene(AT_SPEED + STEP + ", method: newmark"))
    assert "no method 'newmark'" in str(refused.value)
    assert refused.value.faults[0].line == 6


def test_plan_page_and_results_say_which_torques_act(tmp_path: Path) -> None:
    text = scene(AT_SPEED + STEP)
    line = (
        "Acting: order 1 at m (50 N m, by its angle); step 1 N m at m from 0 s. "
        "Not acting: mean torques (the initial speed is given)."
    )
    findings = torsion.run(torsion.parse(text))
    (entry,) = results(findings)["transient"]
    assert entry["acting"] == ["order 1 at m (50 N m, by its angle)", "step 1 N m at m from 0 s"]
    assert entry["not_acting"] == ["mean torques (the initial speed is given)"]
    said = [
        block for block in chapter(findings) if isinstance(block, Paragraph) and block.text == line
    ]
    assert [block.brief for block in said] == [True]  # so it is printed on the terminal
    (tmp_path / "scene.yaml").write_text(text)
    assert (
        line
        in {what: size for what, size, _ in commands.plan(tmp_path / "scene.yaml").steps}[
            "motion over time"
        ]
    )


def test_an_engine_at_the_speed_of_its_rating_takes_no_steps_for_an_edge_at_which_its_law_stays_the_same() -> (
    None
):
    """The load is constant from 1350 rpm on, so nothing of the harmonics changes at 1500 rpm."""
    text = (SCENES / "v12_generator_set.yaml").read_text().split("analyses:")[0]
    motion = moved(text + "analyses: {transient: {duration: 0.02 s, initial: {speed: 1500 rpm}}}\n")
    assert motion.steps
    assert motion.changes == ()


FAST = scene(AT_SPEED + STEP, ", ripple: [{order: 100, torque: 50 N*m}]").replace(
    "tolerance: 1e-10, ", ""
)


def test_the_plan_says_how_long_a_fast_order_takes(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(FAST.replace("duration: 2 s", "duration: 10 s"))
    sizes = {what: size for what, size, _ in commands.plan(tmp_path / "scene.yaml").steps}
    assert sizes["motion over time"].endswith(" At most about 8e+04 steps, 2e+01 s of computing.")


def test_a_fast_order_runs_over_many_periods_and_shakes_the_coupling_as_its_closed_form_says() -> (
    None
):
    """300 periods of 1 kHz: the twist of two discs under a torque A far above their mode is A/(J w^2), and k of it."""
    motion = moved(
        FAST.replace(STEP, ", samples: 1201").replace("duration: 2 s", "duration: 0.3 s")
    )
    late = motion.time > 0.15
    w, damping = 2000.0 * math.pi, 6.0
    stiffness = 3000.0 + 1j * w * damping
    inertia = 3.0 * 1.0 / 4.0  # of the twist
    exact = abs(stiffness / (stiffness - inertia * w**2)) * 50.0 * 1.0 / 4.0
    assert motion.steps > 900
    order = 2.0 * np.mean(motion.torque[0, late] * np.exp(-1j * w * motion.time[late]))
    assert abs(order) == pytest.approx(exact, rel=1e-2)


def test_an_order_that_would_take_hours_is_refused_with_what_to_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("torsion.kernels.motion.collocation.WATCHED", 100)
    study = torsion.parse(FAST.replace("duration: 2 s", "duration: 1 h"))
    settings = study.analyses["transient"]
    assert isinstance(settings, TransientSettings)
    with pytest.raises(
        SolveError, match="1000000 steps \\(about ten minutes\\) are the limit"
    ) as refused:
        transient(study, assemble(study.train), settings)
    assert "leave torques out with `torques`" in refused.value.hint
