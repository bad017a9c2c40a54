"""Motion of trains with play, friction, stages and clutches: closed forms and figures of reference, from the file."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.train import nonlinear_couplings
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.assembly import assemble
from torsion.errors import InputError, SolveError
from torsion.kernels.motion import march
from torsion.output.chapters.motion_over_time import chapter

RIPPLE = ", ripple: [{frequency: 40 Hz, torque: 150 %}]"
DRIVE = """name: x
operation: {{speeds: {{from: 500 rpm, to: 1500 rpm}}, rated: {{speed: 1200 rpm, power: 20 kW}}}}
train:
- motor: {{inertia: 1{ripple}}}
- coupling: {{name: c1, stiffness: 2e4, viscous: 10}}
- disc: {{inertia: 0.2}}
- coupling: {{name: c2, stiffness: 4e4, {c2}}}
- gear: {{teeth: [20, 41], inertia: [0.1, 0.3]}}
- coupling: {{name: c3, stiffness: 4e4, {c3}}}
- propeller: {{inertia: 2}}
"""
PLAY = "clearance: {angle: 0.5 deg, viscous: 5}"
CLUTCH = """name: x
train: [disc: {{name: engine, inertia: 5}}, coupling: {{name: clutch, {}}}, disc: {{name: drum, inertia: 20}}]
"""


def moved(text: str, **body) -> TransientMotion:
    study = torsion.parse(text)
    settings = TransientSettings.model_validate({"initial": "rest", "events": [], **body})
    return transient(study, assemble(study.train, model="lumped"), settings)


def clutch(coupling: str, *events: dict, duration: float = 3.0) -> TransientMotion:
    """An engine at 150 rad/s, and a drum at rest."""
    return moved(
        CLUTCH.format(coupling),
        duration=duration,
        initial={"speed": {"engine": "150 rad/s"}},
        events=list(events),
    )


def whats(found: TransientMotion) -> list[tuple[float, str]]:
    assert found.switching is not None
    return [(event.time, event.what) for event in found.switching.events]


def test_a_free_pair_with_play_hits_in_turn() -> None:
    parts = "disc: {name: a, inertia: 2}, coupling: {stiffness: 1e5, clearance: 0.02 rad}, disc: {inertia: 3}"
    found = moved(f"name: x\ntrain: [{parts}]\n", duration=1.0, initial={"speed": {"a": "5 rad/s"}})
    hits = [time for time, what in whats(found) if what == "contact"]
    assert hits[0] == pytest.approx(0.002, rel=1e-14)
    assert hits[59] == pytest.approx(0.880084974938913, rel=1e-13)
    assert found.switching is not None
    assert (
        found.switching.couplings[0].heat == 0.0
    )  # a play without friction and damping makes none
    assert found.residual < 1e-12
    assert found.peak[0] == pytest.approx(1732.0508075688772, rel=1e-13)
    assert found.reversals[0] == len(hits) - 1
    assert found.residual < 1e-12


def test_a_clutch_that_closes_brings_both_sides_to_one_speed() -> None:
    found = clutch("flexibility: 0, capacity: 400", {"at": "clutch", "clutch": {"close": 0.0}})
    assert whats(found) == [(pytest.approx(1.5, rel=1e-14), "stuck")]
    assert found.speed[:, -1] == pytest.approx([30.0, 30.0], rel=1e-14)
    assert found.switching is not None
    assert found.switching.couplings[0].heat == pytest.approx(45e3, rel=1e-13)


def test_a_clutch_with_a_ramp_under_load_sticks_when_the_speeds_meet() -> None:
    events = (
        {"at": "clutch", "time": 0.1, "clutch": {"close": 0.5}},
        {"at": "engine", "time": 1.0, "step": {"torque": 100}},
    )
    found = clutch("stiffness: 1e6, capacity: 400", *events)
    # 150 rad/s less 25 over the ramp and 40 after it; then 100 - 20 rad/s2
    assert whats(found)[:2] == [
        (0.1, "slip"),
        (pytest.approx(0.6 + 0.4 + 85.0 / 80.0, rel=1e-13), "stuck"),
    ]
    assert found.residual < 1e-12
    assert found.greatest_at == pytest.approx(
        [0.6], rel=1e-15
    )  # the first of all times at which it carries 400 N m


@pytest.mark.parametrize("late", [0.1, 0.0])
@pytest.mark.parametrize("coupling", ["flexibility: 0", "stiffness: 1e6", "stiffness: 2e3"])
def test_a_clutch_that_opens_slips_and_lets_go(coupling: str, late: float) -> None:
    events = (
        {"at": "clutch", "clutch": {"close": 0.0}},
        {"at": "engine", "step": {"torque": 100}},
        {"at": "clutch", "time": 2.5, "clutch": {"open": late}},
    )
    found = clutch(f"{coupling}, capacity: 400", *events)
    assert whats(found)[-1] == (2.5 + late, "open")
    momentum = 5.0 * 150.0 + 100.0 * 3.0
    assert np.array([5.0, 20.0]) @ found.speed[:, -1] == pytest.approx(momentum, rel=1e-13)
    assert found.torque[0, found.time > 2.6] == pytest.approx(0.0, abs=1e-9)
    assert found.residual < 1e-12


def test_a_clutch_by_a_table_keeps_its_last_capacity() -> None:
    event = {"at": "clutch", "clutch": {"torque": ((0.5, 0.0), (1.0, 200.0))}}
    found = clutch("flexibility: 0, capacity: 400", event, duration=5.0)
    # the relative speed falls by 50 rad/s2 * 0.25 s over the ramp, then by 50 rad/s2
    assert [time for time, what in whats(found) if what == "stuck"] == [
        pytest.approx(1.0 + 137.5 / 50.0, rel=1e-13)
    ]


@pytest.mark.parametrize(
    ("c2", "c3"),
    [
        (PLAY, "loss_factor: 0.02"),
        (PLAY, "hysteresis_torque: [10, 20], viscous: 3"),
        (
            "viscous: 1",
            "stages: [{from: 0.1 deg, stiffness: 1e5, hysteresis_torque: 5}, {from: 1 deg, stiffness: 1e6}]",
        ),
        ("capacity: 300", PLAY),
    ],
)
def test_a_steady_train_stays_as_it_is(c2: str, c3: str) -> None:
    text = DRIVE.format(ripple="", c2=c2, c3=c3)
    found = moved(
        text, duration=0.5, initial="steady", events=[{"at": "motor-1", "step": {"torque": 0.0}}]
    )
    mean = 20e3 / (1200.0 * math.pi / 30.0)
    assert found.before == pytest.approx(
        [mean, mean, mean * 41 / 20, mean], rel=1e-14
    )  # spans: c1, c2, c3, mesh
    assert np.abs(found.torque - found.before[:, None]).max() <= 1e-12 * found.before.max()
    assert whats(found) == []


def test_a_play_that_stays_closed_is_a_linear_train() -> None:
    """The steady vibration under a mean torque that keeps the faces together is the response of the linear train."""
    text = DRIVE.format(ripple=RIPPLE, c2=PLAY, c3="viscous: 60")
    still = [{"at": "motor-1", "step": {"torque": 0.0}}]
    found = moved(text, duration=4.0, initial="steady", events=still, samples=50_000)
    assert whats(found) == []
    study = torsion.parse(DRIVE.format(ripple=RIPPLE, c2="viscous: 5", c3="viscous: 60"))
    system = assemble(study.train, model="lumped")
    steady = TransientSettings.model_validate(
        {"duration": 4.0, "initial": "steady", "events": still, "samples": 50_000}
    )
    linear = transient(study, system, steady)
    late = found.time > 3.9
    assert np.abs(found.torque - linear.torque)[:, late].max() <= 1e-9 * np.abs(linear.torque).max()


def test_friction_that_never_slips_is_a_spring() -> None:
    events = [{"at": "motor-1", "pulse": {"torque": 20.0, "length": 0.01}}]
    sticks, spring = (
        moved(DRIVE.format(ripple="", c2=c2, c3="viscous: 3"), duration=0.3, events=events)
        for c2 in ("hysteresis_torque: {torque: 1e6, stiffness: 3e4}, viscous: 2", "viscous: 2")
    )
    assert np.abs(sticks.torque - spring.torque).max() > 0.1 * np.abs(spring.torque).max()
    stiffer = DRIVE.format(ripple="", c2="viscous: 2", c3="viscous: 3").replace(
        "c2, stiffness: 4e4", "c2, stiffness: 7e4"
    )
    both = moved(stiffer, duration=0.3, events=events)
    assert sticks.greatest == pytest.approx(both.greatest, rel=1e-12)


# The small truck: clutch with friction, figures from the article's fit (reference: exact motion, 3 digits).
TRUCK = {
    "J": (0.1256, 0.00242, 0.01571, 0.0101, 0.05, 1.9, 150.0),
    "k": (943.5, 8000.0, 12000.0, 60000.0, 28640.0, 40000.0),
    "time": (7.187e-05, 2e-05, 2e-05, 2e-05, 2e-05, 0.002),
}


def truck(ratio: float, friction: float) -> str:
    J, k, c = (
        TRUCK["J"],
        TRUCK["k"],
        [k * t for k, t in zip(TRUCK["k"], TRUCK["time"], strict=True)],
    )
    springs = [f"coupling: {{stiffness: {a}, viscous: {b!r}}}" for a, b in zip(k, c, strict=True)]
    dry = f"hysteresis_torque: {{torque: {friction}, stiffness: 2e4}}"
    springs[0] = f"coupling: {{name: clutch, stiffness: {k[0]}, viscous: {c[0]!r}, {dry}}}"
    rows = [
        f"disc: {{name: engine, inertia: {J[0]}}}",
        springs[0],
        f"disc: {{name: hub, inertia: {J[1]}}}",
        springs[1],
        f"gear: {{ratio: {ratio}, inertia: [0, {J[2]}]}}",
        "disc: {name: output, unusual: true, inertia: 1e-12, damping: 0.4672}",
        springs[2],
        f"disc: {{name: pinion, inertia: {J[3]}}}",
        springs[3],
        f"gear: {{ratio: 4.875, inertia: [0, {J[4]}]}}",
        springs[4],
        f"disc: {{inertia: {J[5]}}}",
        springs[5],
        f"disc: {{inertia: {J[6]}}}",
    ]
    return f"name: x\ntrain: [{', '.join(rows)}]\n"


@pytest.mark.parametrize(
    ("ratio", "rpm", "friction", "known"),
    [
        (1.95, 1760, 2.851, (33.419601, 181.911824, 101.404703, 103.961250)),
        (1.95, 1760, 7.139, (28.602966, 32.918593, 18.349562, 18.812312)),
        (1.0, 1400, 2.851, (44.274516, 89.908829, 101.235346, 97.431258)),
        (1.0, 1400, 7.139, (39.046421, 59.337386, 66.813763, 64.303003)),
    ],
)
def test_the_truck_vibrates_at_order_2_as_its_clutch_lets_it(
    ratio: float, rpm: float, friction: float, known: tuple[float, ...]
) -> None:
    w = 2.0 * rpm * math.pi / 30.0
    period, text = 2.0 * math.pi / w, truck(ratio, friction)
    sine = {"torque": 147.8, "frequency": w / (2.0 * math.pi), "phase": "90 deg"}
    found = moved(
        text, duration=1.75 + 8 * period, events=[{"at": "engine", "sine": sine}], samples=35_000
    )
    names = [station.name for station in torsion.parse(text).train.stations]
    late = found.time >= 1.75
    for name, amplitude in zip(("engine", "hub", "output", "pinion"), known, strict=True):
        speed = found.speed[names.index(name), late] * 30.0 / math.pi
        order_2 = 2.0 * abs(np.mean(speed * np.exp(-1j * w * found.time[late])))
        assert order_2 == pytest.approx(amplitude, rel=1e-3)
    assert found.residual < 1e-11
    assert found.switching is not None
    assert found.switching.sensitive_after is None


def test_a_band_of_modes_with_the_compliance_of_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A stiff train with a play: modes up to a band, the others in series with the contact."""
    draw = np.random.default_rng(8)
    J, k = draw.uniform(0.5, 2.0, 8), 10.0 ** np.array([5.0, 9.0, 6.0, 5.3, 9.0, 5.0, 8.5])
    rows = [f"disc: {{name: d{n}, inertia: {one!r}}}" for n, one in enumerate(J.tolist())]
    links = [f"coupling: {{stiffness: {one!r}, loss_factor: 0.02}}" for one in k.tolist()]
    links[3] = (
        f"coupling: {{stiffness: {float(k[3])!r}, clearance: {{angle: 0.01 rad, viscous: 20}}}}"
    )
    parts = ", ".join(one for pair in zip(rows, [*links, ""], strict=True) for one in pair if one)
    text, sine = f"name: x\ntrain: [{parts}]\n", {"torque": 60.0, "frequency": 12.0}
    body = {
        "duration": 0.3,
        "events": [{"at": "d0", "sine": sine}, {"at": "d7", "step": {"torque": -20}}],
    }
    whole = moved(text, **body)
    assert whole.switching is not None
    assert whole.modes == 6
    assert whole.switching.band_change == 0.0
    monkeypatch.setattr(
        nonlinear_couplings, "LARGEST_ANGLE", 0.3 * 2e4
    )  # rad/s of the band: below the stiff spans
    band = moved(text, **body)
    assert band.switching is not None
    assert band.modes < whole.modes
    soft = k < 1e7
    error = np.abs(band.greatest - whole.greatest) / whole.greatest
    assert error[soft].max() < 2e-4
    assert band.switching.band_change > 0.0
    assert len(whats(band)) == len(whats(whole))


CLOSE = "{at: %s, clutch: {close: 1 s}}"


@for_all(
    ("coupling", "body", "words"),
    [
        ("stiffness: 1e4", f"events: [{CLOSE % 'clutch'}]", "'clutch' is no clutch"),
        ("stiffness: 1e4, capacity: 5", f"events: [{CLOSE % 'engine'}]", "'engine' is no clutch"),
        ("stiffness: 1e4, capacity: 5", f"events: [{CLOSE % 'clutsh'}]", "did you mean 'clutch'?"),
        (
            "stiffness: 1e4, capacity: 5",
            "events: [{at: clutch, clutch: {}}]",
            "one of `torque`, `close` and `open`",
        ),
        (
            "stiffness: 1e4, capacity: 5",
            "events: [{at: clutch, clutch: {torque: [[0 s, 1], [1 s, -1]]}}]",
            "not negative",
        ),
        (
            "stiffness: 1e4, capacity: 5",
            "events: [{at: clutch, step: {torque: 1}}]",
            "is a coupling, not a point",
        ),
        (
            "stiffness: 1e4",
            "events: [], initial: {speed: {engine: 5 rad/s}}",
            "need a clutch or a clearance",
        ),
        (
            "stiffness: 1e4, capacity: 5",
            "initial: {speed: {engin: 5 rad/s}}",
            "did you mean 'engine'?",
        ),
    ],
)
def test_faults_between_a_clutch_and_its_events(coupling: str, body: str, words: str) -> None:
    text = CLUTCH.format(coupling) + f"analyses: {{transient: {{duration: 2 s, {body}}}}}\n"
    with pytest.raises(InputError) as refused:
        torsion.parse(text)
    assert words in str(refused.value)
    assert refused.value.faults[0].line == 3


def test_a_mean_torque_beyond_the_capacity_is_refused() -> None:
    text = DRIVE.format(ripple="", c2="capacity: 100", c3="viscous: 3")
    with pytest.raises(InputError, match="slips the clutch 'c2' before the events"):
        moved(text, duration=0.1, initial="steady", events=[{"at": "motor-1", "stop": {}}])


def test_a_play_at_a_point_without_inertia_is_refused() -> None:
    parts = "disc: {name: a, inertia: 2}, coupling: {stiffness: 1e5, clearance: 1 deg}, coupling: {stiffness: 1e4}"
    with pytest.raises(SolveError, match="ends at a point without inertia"):
        moved(
            f"name: x\ntrain: [{parts}, disc: {{inertia: 3}}]\n",
            duration=1.0,
            initial={"speed": {"a": "5 rad/s"}},
        )


def test_a_motion_that_impacts_make_sensitive_says_from_when_on() -> None:
    """Two plays in line under two torques: differences of rounding grow until they show."""
    parts = (
        "disc: {name: a, inertia: 1}, coupling: {stiffness: 2e4, clearance: 2 deg}, disc: {inertia: 0.3}, "
        "coupling: {stiffness: 5e4, clearance: 1 deg}, disc: {name: c, inertia: 0.7}"
    )
    events = [
        {"at": "a", "sine": {"torque": 80, "frequency": 9}},
        {"at": "c", "sine": {"torque": 30, "frequency": 5.3}},
    ]
    found = moved(f"name: x\ntrain: [{parts}]\n", duration=3.5, events=events)
    assert found.switching is not None
    assert 0.5 < found.switching.sensitive_after < 3.0
    assert len(whats(found)) > 450  # how many depends on rounding from then on
    assert found.residual < 1e-11  # each of the motions that cannot be told apart is one
    scatter = found.switching.scatter
    assert (
        scatter > 1e-6 * found.peak
    ).any()  # the peaks are late, where both are motions of their own
    assert found.peak == pytest.approx(
        np.maximum(np.abs(found.greatest), np.abs(found.least)) + scatter, rel=1e-14
    )
    apart = bool((scatter > 0.1 * found.peak).any())
    assert apart == ("impacts make the motion sensitive" in found.status)
    assert (
        replace(found, switching=replace(found.switching, scatter=0.2 * found.peak)).status != "ok"
    )


def test_a_twist_released_in_a_play_rebounds_with_all_its_energy() -> None:
    parts = "disc: {inertia: 2}, coupling: {name: s, stiffness: 1e4, clearance: 0.02 rad}, disc: {inertia: 3}"
    found = moved(f"name: x\ntrain: [{parts}]\n", duration=1.0, initial={"torque": {"s": 50.0}})
    w, speed = math.sqrt(1e4 / 1.2), 50.0 / math.sqrt(1e4 * 1.2)
    first, second = (time for time, _ in whats(found)[:2])
    assert first == pytest.approx(math.pi / 2.0 / w, rel=1e-13)
    assert second - first == pytest.approx(0.02 / speed, rel=1e-12)
    assert found.least[0] == pytest.approx(-50.0, rel=1e-12)


def test_the_report_lists_what_couplings_did() -> None:
    text = CLUTCH.format("stiffness: 1e6, capacity: 400") + (
        "analyses: {transient: {duration: 3 s, initial: {speed: {engine: 150 rad/s}}, "
        "events: [{at: clutch, clutch: {close: 0.5 s}}]}}\n"
    )
    findings = torsion.run(torsion.parse(text))
    blocks = {getattr(block, "caption", ""): block for block in chapter(findings)}
    assert tuple(blocks["Couplings with backlash, friction, stages or a capacity"].rows[0][:3]) == (
        "clutch",
        "0",
        "0",
    )
    assert any("clutch" in row for row in blocks["Events of these couplings"].rows)
    assert any("clutch" in what for what, _ in findings.plan.left_out)


def test_a_brake_stops_its_disc_and_turns_its_energy_into_heat() -> None:
    parts = "disc: {name: a, inertia: 2}, coupling: {name: brake, flexibility: 0, capacity: 50}, disc: {held: true}"
    text = f"name: x\ntrain: [{parts}]\n"
    brake = {"at": "brake", "time": 0.5, "clutch": {"close": 0.0}}
    found = moved(text, duration=6.0, initial={"speed": {"a": "100 rad/s"}}, events=[brake])
    assert whats(found) == [(0.5, "slip"), (pytest.approx(4.5, rel=1e-14), "stuck")]
    assert found.switching is not None
    assert found.switching.couplings[0].heat == pytest.approx(1e4, rel=1e-13)
    assert found.speed[0, -1] == 0.0


def test_rigid_clutches_beside_each_other_are_refused() -> None:
    text = CLUTCH.format("flexibility: 0, capacity: 50") + (
        "links: [{between: [engine, drum], coupling: {flexibility: 0, capacity: 30}}]\n"
    )
    with pytest.raises(SolveError, match="nothing divides their torque"):
        moved(text, duration=1.0, events=[{"at": "engine", "step": {"torque": 10}}])


RING = (
    (
        "disc: {name: a, inertia: 1}",
        "coupling: {name: ab, stiffness: 1e4}",
        "disc: {name: b, inertia: 1.5}",
    ),
    (
        "disc: {name: b, inertia: 1.5}",
        "coupling: {name: bc, stiffness: 2e4}",
        "disc: {name: c, inertia: 2}",
    ),
    ("disc: {name: c, inertia: 2}", "coupling: {name: ca, stiffness: 3e4, clearance: 1 deg}", ""),
)


def test_a_play_that_closes_a_loop_is_that_of_the_loop_closed_elsewhere() -> None:
    parts, link = ", ".join((*RING[0], *RING[1][1:])), RING[2][1]
    there = moved(
        f"name: x\ntrain: [{parts}]\nlinks: [{{between: [c, a], {link}}}]\n",
        duration=1.0,
        events=[{"at": "a", "sine": {"torque": 100, "frequency": 9}}],
    )
    parts = ", ".join((*RING[1], link, RING[0][0]))
    elsewhere = moved(
        f"name: x\ntrain: [{parts}]\nlinks: [{{between: [a, b], {RING[0][1]}}}]\n",
        duration=1.0,
        events=[{"at": "a", "sine": {"torque": 100, "frequency": 9}}],
    )
    assert len(whats(there)) == 36
    assert there.peak[[0, 1, 2]] == pytest.approx(elsewhere.peak[[2, 0, 1]], rel=1e-11)
    assert there.residual < 1e-12


def test_a_play_that_is_never_used_up_leaves_nothing_of_its_balance_of_energy() -> None:
    """Over whole periods the work is nothing; the error is of the energy between."""
    parts = "disc: {name: a, inertia: 1}, coupling: {stiffness: 1e4, clearance: 400 deg}, disc: {inertia: 1}"
    sine = {"at": "a", "sine": {"torque": 100, "frequency": 8}}
    found = moved(f"name: x\ntrain: [{parts}]\n", duration=1.0, events=[sine])
    assert found.peak[0] == 0.0
    assert found.residual < 1e-14
    assert found.status == "ok"


def test_the_most_events_of_a_motion_are_said_with_a_shorter_duration(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(march, "MOST_EVENTS", 20)
    parts = "disc: {name: a, inertia: 2}, coupling: {stiffness: 1e5, clearance: 0.02 rad}, disc: {inertia: 3}"
    text = f"name: x\ntrain: [{parts}]\n"
    with pytest.raises(
        SolveError, match=r"has its 20 events at 0\.1.* s, .*; a `duration` below 0\.1"
    ) as refused:
        moved(text, duration=1.0, initial={"speed": {"a": "5 rad/s"}})
    assert refused.value.path == ("analyses", "transient", "duration")
    motions = "[{name: none, duration: 1 ms, initial: {speed: {a: 5 rad/s}}},\n {name: long, duration: 1 s, "
    several = f"{text}analyses: {{transient: {motions}initial: {{speed: {{a: 5 rad/s}}}}}}]}}\n"
    assert torsion.run(torsion.parse(several)).plan.unanswered[0].line == 4


def test_events_that_cannot_reach_the_end_are_refused_early(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(march, "MOST_EVENTS", 200)
    monkeypatch.setattr(march, "WATCHED", 10)
    parts = "disc: {name: a, inertia: 2}, coupling: {stiffness: 1e5, clearance: 0.02 rad}, disc: {inertia: 3}"
    with pytest.raises(
        SolveError, match=r"its 20 events at .* s, and no more than 200 are followed"
    ) as refused:
        moved(f"name: x\ntrain: [{parts}]\n", duration=10.0, initial={"speed": {"a": "5 rad/s"}})
    assert refused.value.hint is not None
    reaches = float(refused.value.hint.removeprefix("a `duration` below ").removesuffix(" s"))
    monkeypatch.undo()
    found = moved(
        f"name: x\ntrain: [{parts}]\n", duration=reaches, initial={"speed": {"a": "5 rad/s"}}
    )
    assert len(whats(found)) == pytest.approx(200, rel=0.05)  # it bounces evenly
