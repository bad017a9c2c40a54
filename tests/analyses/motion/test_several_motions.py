"""Several motions over time in one file: each with results, a section and verdicts of its own."""

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.derived.fatigue import cycles, miner
from torsion.analyses.motion.events.transient_settings import Fatigue
from torsion.analyses.motion.transient_motion import Transients
from torsion.errors import InputError
from torsion.output.blocks import Figure, Heading, Paragraph
from torsion.output.chapters.motion_over_time import chapter
from torsion.output.stored.results_json import results
from torsion.output.write import write
from torsion.rules.verdict_line import Checks

SCENE = """name: x
operation: {rated: {speed: 600 rpm, power: 60 kW}}
train:
- motor: {name: drive, inertia: 1}
- coupling: {name: rubber, stiffness: 1e4, viscous: 20, max_torque: 1 kN*m}
- shaft: {name: line, length: 1 m, diameter: 60 mm, segments: 8}
- propeller: {name: screw, inertia: 2}
analyses:
  transient:
"""
TRIP = "  - {name: trip, duration: 1 s, events: [{at: drive, stop: {}}]}\n"
HIT = "  - {name: hit, duration: 1 s, plot: rubber, events: [{at: screw, pulse: {torque: -8 kN*m, length: 10 ms}}]}\n"
NO_ICE = "  - {name: ice, duration: 1 s, events: [{at: screw, ice: {torque: 1, case: 1}}]}\n"


def test_every_motion_has_results_verdicts_and_a_section_of_its_own() -> None:
    found = torsion.run(torsion.parse(SCENE + TRIP + HIT))
    assert [one.name for one in found.need(Transients).each] == ["trip", "hit"]
    checks = found.need(Checks).lines
    assert [check.what for check in checks] == [
        f"Greatest torque over time: {k}" for k in ("trip", "hit")
    ]
    assert [check.verdict for check in checks] == ["pass", "fail"]
    blocks = list(chapter(found))
    assert [one.text for one in blocks if isinstance(one, Heading)][1:] == [
        "Transient: trip",
        "Transient: hit",
    ]
    drawn = [one.name for one in blocks if isinstance(one, Figure)]
    assert "motion hit rubber" in drawn
    assert "motion hit line" not in drawn
    assert [one["name"] for one in results(found)["transient"]] == ["trip", "hit"]


def test_a_motion_without_an_answer_takes_no_other_with_it() -> None:
    found = torsion.run(torsion.parse(SCENE + TRIP + NO_ICE + HIT))
    assert [one.name for one in found.need(Transients).each] == ["trip", "hit"]
    assert "ice needs a turning propeller" in found.plan.unanswered[0].why
    assert found.plan.unanswered[0].line == 11


@for_all(
    ("text", "words"),
    [
        (SCENE + TRIP + TRIP, "two motions are called 'trip'"),
        (SCENE + TRIP + TRIP.replace("name: trip, ", ""), "a motion in a list needs a name"),
        (SCENE + TRIP.replace("duration: 1 s", "duration: 1 m"), "length"),
        (SCENE.replace("  transient:\n", "  transient: []\n"), "the list of motions is empty"),
        (
            SCENE.replace("  transient:\n", "  model: exact\n  transient:\n") + TRIP,
            "not the model exact",
        ),
    ],
)
def test_a_faulty_list_of_motions_is_refused(text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        torsion.parse(text)


def test_too_few_samples_are_refused_where_what_they_miss_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for module in ("peaks", "torque_curves"):
        monkeypatch.setattr(f"torsion.analyses.motion.curves.{module}.MOST_TIMES", 40_000)
    text = """name: x
train: [disc: {name: d1, inertia: 2}, coupling: {stiffness: 1e7}, disc: {inertia: 3}]
analyses: {transient: {duration: 1e3 s, samples: 100, events: [{at: d1, step: {torque: 1}}]}}
"""
    (one,) = torsion.run(torsion.parse(text)).plan.unanswered
    assert "modes with fewer than 4 samples in a period" in one.why
    assert (one.line, one.is_input) == (3, True)


def test_a_band_of_modes_says_what_twice_as_many_change() -> None:
    whole, band = (
        torsion.run(torsion.parse(SCENE + HIT.replace("1 s,", f"1 s, modes: {number},", 1)))
        .need(Transients)
        .each[0]
        for number in ("all", 4)
    )
    assert whole.change is None
    assert band.modes == 4
    assert 0.0 < band.change < 0.02
    assert np.abs(band.peak - whole.peak).max() < 2.0 * band.change * whole.peak.max()


def test_finite_elements_move_as_the_segments_of_a_shaft() -> None:
    lumped, fem = (
        torsion.run(
            torsion.parse(
                (SCENE + HIT.replace("1 s,", "0.2 s,", 1)).replace(
                    "  transient:\n", f"  model: {model}\n  transient:\n"
                )
            )
        )
        .need(Transients)
        .each[0]
        for model in ("lumped", "fem")
    )
    assert fem.peak[0] == pytest.approx(lumped.peak[0], rel=1e-3)
    assert fem.status == "ok"


def test_cycles_are_those_of_the_standard_and_their_damage_is_miners_sum() -> None:
    counted = list(cycles(np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2])))
    ranges = {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}  # ASTM E1049-85, 5.4.4
    assert {key: sum(n for half, _, n in counted if 2.0 * half == key) for key in ranges} == ranges
    line = Fatigue(amplitude=10.0, cycles=1e6, slope=5.0)
    assert miner(counted, line) == pytest.approx(2.1199375e-8, rel=1e-14, abs=0.0)


def test_a_mean_torque_counts_by_goodman() -> None:
    line = Fatigue(amplitude=10.0, cycles=1e6, slope=5.0, mean="goodman", ultimate=50.0)
    assert miner([(8.0, 10.0, 1.0)], line) == pytest.approx(1e-6)
    assert miner([(8.0, -50.0, 1.0)], line) == np.inf


def test_damage_of_a_swing_that_goes_on_is_that_of_its_cycles() -> None:
    text = """name: x
train: [disc: {inertia: 2}, coupling: {name: s1, stiffness: 1e4}, disc: {inertia: 3}]
analyses:
  transient:
    {duration: 10 s, initial: {torque: {s1: 50}}, fatigue: {amplitude: 100, cycles: 1e6, slope: 5}}
"""
    found = torsion.run(torsion.parse(text)).need(Transients).each[0]
    number = 10.0 * np.sqrt(1e4 / 1.2) / (2.0 * np.pi)
    assert found.damage[0] == pytest.approx((number - 0.5) * 0.5**5 / 1e6, rel=2e-3, abs=0.0)


def test_damage_is_counted_at_the_components_that_the_file_names_alone() -> None:
    text = """name: x
train:
- disc: {inertia: 2}
- coupling: {name: s1, stiffness: 1e4}
- disc: {inertia: 3}
- coupling: {name: s2, stiffness: 1e4}
- disc: {inertia: 2}
analyses:
  transient: {duration: 1 s, initial: {torque: {s1: 50}}, fatigue: LINE}
"""
    line = "{amplitude: 100, cycles: 1e6, slope: 5, at: AT}"
    first, second, both = (
        torsion.run(torsion.parse(text.replace("LINE", line.replace("AT", names))))
        .need(Transients)
        .each[0]
        .damage
        for names in ("s1", "s2", "[s1, s2]")
    )
    assert np.isfinite(both).all()
    assert first.tolist() == pytest.approx([both[0], np.nan], nan_ok=True)
    assert second.tolist() == pytest.approx([np.nan, both[1]], nan_ok=True)


def test_all_samples_are_written_where_the_file_exports_them(tmp_path) -> None:
    trip, hit = (
        TRIP.replace("1 s,", "1 s, export: csv,"),
        HIT.replace("1 s,", "1 s, export: npz,", 1),
    )
    found = torsion.run(torsion.parse(SCENE + trip + hit))
    write(found, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "motion-trip.csv",
        "motion.npz",
        "report.html",
        "results.json",
    ]
    first, second = found.need(Transients).each
    head, *rows = (tmp_path / "motion-trip.csv").read_text().splitlines()
    titles = [title.strip('"') for title in head.split(",")]
    values = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    np.testing.assert_array_equal(
        values[:, titles.index("torque in rubber [N*m]")], first.torque[0]
    )
    with np.load(tmp_path / "motion.npz") as arrays:
        np.testing.assert_array_equal(arrays["hit: time [s]"], second.time)
        np.testing.assert_array_equal(arrays["hit: speed of drive [rad/s]"], second.speed[0])


def test_a_figure_shows_the_peaks_between_its_samples() -> None:
    found = torsion.run(torsion.parse(SCENE + HIT.replace("1 s,", "1 s, samples: 1000,", 1)))
    (one,) = found.need(Transients).each
    (drawn,) = [
        block
        for block in chapter(found)
        if isinstance(block, Figure) and block.name == "motion hit rubber"
    ]
    (line,) = drawn.lines.values()
    unit = 1e-3  # kN m
    assert (line.y.max(), line.y.min()) == pytest.approx(
        (one.greatest[0] * unit, one.least[0] * unit), rel=1e-15
    )
    assert one.torque[0].max() < one.greatest[0]
    assert (np.diff(line.x) >= 0.0).all()


def test_a_motion_that_cannot_be_trusted_says_so_in_report_and_verdict() -> None:
    found = torsion.run(torsion.parse(SCENE + HIT.replace("1 s,", "1 s, modes: 1,", 1)))
    (one,) = found.need(Transients).each
    assert "twice as many modes change a peak" in one.status
    assert "give more `modes`" in one.status
    texts = [
        block.text
        for block in chapter(found)
        if isinstance(block, Paragraph) and block.kind == "fail"
    ]
    assert texts == [f"Not reliable: {one.status}."]
    (check,) = found.need(Checks).lines
    assert check.verdict == "fail"
    assert check.note == f"{one.status}; such a motion is never a pass"


def test_shafts_are_divided_for_their_modes_where_a_file_names_a_motion_alone() -> None:
    alone = SCENE.replace(", segments: 8", "") + TRIP.replace("1 s,", "0.01 s, samples: 100,")
    named = alone.replace("  transient:\n", "  modes:\n  transient:\n")
    first, second = (torsion.run(torsion.parse(text)) for text in (alone, named))
    assert first.system.segments == second.system.segments
    assert first.system.segments["line"] > 1
