"""Bands over tolerances against all corners and 50-digit figures; stiffnesses for a frequency against the same."""

import itertools

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import torsion
from torsion.analyses.tolerances import Tolerances, scaled, tolerances
from torsion.analyses.undamped_modes import modes, modes_as_discretised

INERTIA, STIFFNESS = (1.2, 0.35, 0.6, 0.95), (20000.0, 310000.0, 47000.0)
WIDE = (0.15, 0.03, 0.08)
AIMS = (  # span, mode, Hz, N m/rad: roots of the characteristic equation to 18 digits
    (1, 1, 40.0, 445474.195060636745), (1, 2, 55.0, 27113.357406885973), (2, 3, 60.0, 8863.92602550130498),
    (3, 2, 75.0, 103123.009101467866), (3, 2, 120.0, 315913.497861724244),
)  # fmt: skip


def scene(stiffness=STIFFNESS, inertia=INERTIA, wide=WIDE, rest="") -> str:
    train = [f"  - disc: {{inertia: {inertia[0]!r}}}\n"]
    for k, tolerance, own in zip(stiffness, wide, inertia[1:], strict=True):
        extra = f", tolerance: {tolerance!r}" if tolerance else ""
        train.append(f"  - coupling: {{stiffness: {k!r}{extra}}}\n  - disc: {{inertia: {own!r}}}\n")
    return f"name: chain\ntrain:\n{''.join(train)}{rest}"


def found(text: str) -> Tolerances:
    return torsion.run(torsion.parse(text)).need(Tolerances)


def exact(stiffness, inertia=INERTIA) -> list[float]:
    """Frequencies of a free chain in 50 digits, Hz."""
    with mp.workdps(50):
        size = len(inertia)
        matrix, root = mp.matrix(size, size), [mp.sqrt(mp.mpf(one)) for one in inertia]
        for at, k in enumerate(map(mp.mpf, stiffness)):
            for a, b, sign in ((at, at, 1), (at + 1, at + 1, 1), (at, at + 1, -1), (at + 1, at, -1)):
                matrix[a, b] += sign * k / (root[a] * root[b])
        values = sorted(mp.eigsy(matrix, eigvals_only=True))[1:]
        return [float(mp.sqrt(one) / (2 * mp.pi)) for one in values]


def test_bands_are_the_corners_to_rounding() -> None:
    made = found(scene())
    for sign, band in ((-1, made.lower), (1, made.upper)):
        ends = [k * (1 + sign * t) for k, t in zip(STIFFNESS, WIDE, strict=True)]
        assert band == pytest.approx(exact(ends), rel=3e-15)
    assert (made.lower < exact([k * (1 - t) for k, t in zip(STIFFNESS, WIDE, strict=True)])).all()  # a bound


def test_each_coupling_alone_without_it_and_rigid() -> None:
    first = found(scene()).couplings[0]
    assert first.lower == pytest.approx(exact((17000.0, *STIFFNESS[1:])), rel=1e-14)
    assert first.upper == pytest.approx(exact((23000.0, *STIFFNESS[1:])), rel=1e-14)
    assert first.softest == pytest.approx([0.0, *exact(STIFFNESS[1:], INERTIA[1:])], rel=1e-14)
    assert first.stiffest[:2] == pytest.approx(exact(STIFFNESS[1:], (1.55, 0.6, 0.95)), rel=1e-14)
    assert first.stiffest[2] == np.inf


@pytest.mark.parametrize(("span", "mode", "hertz", "stiffness"), AIMS)
def test_stiffness_that_puts_a_mode_where_it_should_be(span: int, mode: int, hertz: float, stiffness: float) -> None:
    aim = f"analyses: {{modes: , tolerances: {{aim: [{{mode: {mode}, frequency: {hertz} Hz}}]}}}}\n"
    one = found(scene(wide=(0, 0, 0), rest=aim)).aims[span - 1]
    assert one.coupling == f"coupling-{span}"
    assert one.stiffness == pytest.approx(stiffness, rel=1e-14)


def test_no_stiffness_is_told_beyond_what_a_coupling_reaches() -> None:
    made = found(scene(rest="analyses: {modes: , tolerances: {aim: [{mode: 2, frequency: 45 Hz}]}}\n"))
    first, second, third = made.aims
    assert first.stiffness is None
    assert 45.0 < first.softest == pytest.approx(exact(STIFFNESS[1:], INERTIA[1:])[0], rel=1e-14)
    assert second.stiffness is not None
    assert third.stiffness is not None


def test_an_aim_at_a_mode_that_is_not_computed_is_refused_where_it_stands() -> None:
    text = scene(rest="analyses: {modes: {count: 2}, tolerances: {aim: [{mode: 3, frequency: 45 Hz}]}}\n")
    done = torsion.run(torsion.parse(text))
    (failed,) = done.plan.unanswered
    assert (failed.line, done.exit_status) == (10, 2)
    assert "mode 3 is not among the 2 computed" in failed.why


def test_critical_speeds_move_with_their_mode_and_may_enter_the_range() -> None:
    rest = "operation: {speeds: {from: 300 rpm, to: 700 rpm}}\nexcitations: [{at: disc-1, order: 2, torque: 10 N*m}]\n"
    done = torsion.run(torsion.parse(scene(rest=rest)))
    made = done.need(Tolerances)
    assert made.critical_lower == pytest.approx(made.lower * np.pi, rel=1e-14)
    assert made.critical_upper == pytest.approx(made.upper * np.pi, rel=1e-14)
    from torsion.output.chapters.tolerances import chapter

    (row,) = next(one for one in chapter(done) if "speed range" in getattr(one, "caption", "")).rows
    assert row[0] == "671.41"
    assert row[-1] == "only within the tolerances"


def test_a_case_at_an_end_of_the_tolerances_has_no_band() -> None:
    done = torsion.run(torsion.parse(scene(rest="cases: {from: tolerances}\n")))
    assert done.need(Tolerances).lower.size
    assert all(case.get(Tolerances) is None for case in done.cases.values())


def test_a_table_over_frequency_is_scaled_as_a_whole() -> None:
    table = "table: {over: frequency, at: [1 Hz, 20 Hz], stiffness: [%s, %s]}"
    text = "name: x\ntrain:\n  - disc: {inertia: 10}\n  - coupling: {%s}\n  - disc: {inertia: 40}\n"
    made = found(text % (table % ("20e3", "40e3") + ", tolerance: 10 %"))
    for end, k in ((made.lower, ("18e3", "36e3")), (made.upper, ("22e3", "44e3"))):
        assert end == pytest.approx(modes(torsion.assemble(torsion.parse(text % (table % k)).train), 1).frequency)


@settings(max_examples=25, deadline=None)
@given(st.integers(2, 5), st.integers(0, 2**32 - 1))
def test_no_corner_of_a_random_tree_lies_outside(size: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    train = ["  - disc: {inertia: 1.0}\n"]
    for _ in range(size):
        k, tolerance, own = 10.0 ** rng.uniform(2, 7), rng.uniform(0.01, 0.3), 10.0 ** rng.uniform(-2, 2)
        train.append(f"  - coupling: {{stiffness: {k!r}, tolerance: {tolerance!r}}}\n  - disc: {{inertia: {own!r}}}\n")
    study = torsion.parse(f"name: x\ntrain:\n{''.join(train)}")
    nominal = modes(torsion.assemble(study.train), size)
    made = tolerances(study, nominal, None)
    wide = [one.tolerance for one in made.couplings]
    corners = [
        modes_as_discretised(
            scaled(nominal.system, dict(enumerate(1 + s * t for s, t in zip(signs, wide, strict=True)))), size
        )
        for signs in itertools.product((-1, 1), repeat=size)
    ]
    every = np.array([one.frequency for one in corners])
    assert made.lower == pytest.approx(every.min(axis=0), rel=1e-12)  # the bounds of the enclosure
    assert made.upper == pytest.approx(every.max(axis=0), rel=1e-12)
    assert (made.lower <= every.min(axis=0) * (1.0 + 1e-14)).all()
    assert (made.upper >= every.max(axis=0) * (1.0 - 1e-14)).all()


def test_a_coupling_that_closes_a_loop_is_taken_out_and_made_rigid() -> None:
    ring = scene(
        rest="links: [{between: [disc-1, disc-4], coupling: {name: chord, stiffness: 4e3, tolerance: 10 %}}]\n"
    )
    made = found(ring)
    chord = next(one for one in made.couplings if one.coupling == "chord")
    assert chord.softest == pytest.approx(exact(STIFFNESS), rel=1e-14)
    k = np.diag([20000.0 + 47000.0, 330000.0, 357000.0]) - np.array(
        [[0, 20000.0, 47000.0], [20000.0, 0, 310000.0], [47000.0, 310000.0, 0]]
    )
    root = np.sqrt([1.2 + 0.95, 0.35, 0.6])
    hertz = np.sqrt(np.linalg.eigvalsh(k / np.outer(root, root))[1:]) / (2.0 * np.pi)
    assert chord.stiffest[:2] == pytest.approx(hertz, rel=1e-13)
