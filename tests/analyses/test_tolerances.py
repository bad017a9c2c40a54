"""Bands over tolerances against all corners and 50-digit figures; stiffnesses for a frequency against the same."""

import itertools

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import torsion
from torsion.analyses.modes.tolerances import Tolerances, tolerances
from torsion.analyses.undamped_modes import Modes, modes, undamped_tree
from torsion.kernels.modes.variant_modes import variant_modes

INERTIA, STIFFNESS = (1.2, 0.35, 0.6, 0.95), (20000.0, 310000.0, 47000.0)
WIDE = (0.15, 0.03, 0.08)
AIMS = (  # span, mode, Hz, N m/rad: roots of the characteristic equation to 18 digits
    (1, 1, 40.0, 445474.195060636745),
    (1, 2, 55.0, 27113.357406885973),
    (2, 3, 60.0, 8863.92602550130498),
    (3, 2, 75.0, 103123.009101467866),
    (3, 2, 120.0, 315913.497861724244),
)


def scene(stiffness=STIFFNESS, inertia=INERTIA, wide=WIDE, rest="", heavy=(0, 0, 0, 0)) -> str:
    extra = [
        f", tolerance: {float(tolerance)!r}" if tolerance else "" for tolerance in (*wide, *heavy)
    ]
    discs = [
        f"  - disc: {{inertia: {float(own)!r}{words}}}\n"
        for own, words in zip(inertia, extra[len(wide) :], strict=True)
    ]
    train = [discs[0]]
    for k, words, disc in zip(stiffness, extra, discs[1:], strict=False):
        train.append(f"  - coupling: {{stiffness: {float(k)!r}{words}}}\n{disc}")
    return f"name: chain\ntrain:\n{''.join(train)}{rest}"


def found(text: str) -> Tolerances:
    return torsion.run(torsion.parse(text)).need(Tolerances)


def exact(stiffness, inertia=INERTIA) -> list[float]:
    """Frequencies of a free chain in 50 digits, Hz."""
    with mp.workdps(50):
        size = len(inertia)
        matrix, root = mp.matrix(size, size), [mp.sqrt(mp.mpf(one)) for one in inertia]
        for at, k in enumerate(map(mp.mpf, stiffness)):
            for a, b, sign in (
                (at, at, 1),
                (at + 1, at + 1, 1),
                (at, at + 1, -1),
                (at + 1, at, -1),
            ):
                matrix[a, b] += sign * k / (root[a] * root[b])
        values = sorted(mp.eigsy(matrix, eigvals_only=True))[1:]
        return [float(mp.sqrt(one) / (2 * mp.pi)) for one in values]


def test_bands_are_the_corners_to_rounding() -> None:
    made = found(scene())
    for sign, band in ((-1, made.lower), (1, made.upper)):
        ends = [k * (1 + sign * t) for k, t in zip(STIFFNESS, WIDE, strict=True)]
        assert band == pytest.approx(exact(ends), rel=3e-15)
    low, high = (
        exact([k * (1 + sign * t) for k, t in zip(STIFFNESS, WIDE, strict=True)])
        for sign in (-1, 1)
    )
    assert (made.lower < low).all()  # a bound
    assert (high < made.upper).all()


HEAVY = (0.05, 0.02, 0.05, 0.10)
BAND = (  # Hz, 50 digits at both corners
    (21.687013520647802, 49.3572064377235996, 186.692212955598523),
    (26.5229964228740613, 57.517067077812821, 199.31615016961541),
)


def test_bands_over_stiffnesses_and_inertias_are_the_published_corners() -> None:
    made = found(scene(heavy=HEAVY))
    assert made.lower == pytest.approx(BAND[0], rel=4e-15)
    assert made.upper == pytest.approx(BAND[1], rel=4e-15)
    one = found(scene(wide=(0.15,) * 3, heavy=(0.05,) * 4))
    assert one.lower / one.frequency == pytest.approx(
        [np.sqrt(0.85 / 1.05)] * 3, rel=1e-14
    )  # any train, any mode
    assert one.upper / one.frequency == pytest.approx([np.sqrt(1.15 / 0.95)] * 3, rel=1e-14)


def test_the_figure_that_matters_most_comes_first() -> None:
    made = found(scene(heavy=HEAVY))
    ranked = {one.figure: one for one in made.figures}
    assert len(ranked) == 7
    first = ranked["coupling-1.stiffness"]  # sensitivities of mode 1 in 50 digits
    assert first.sensitivity[0] == pytest.approx(0.403343153160794559, rel=1e-14)
    assert ranked["disc-4.inertia"].sensitivity[0] == pytest.approx(
        -0.164302497776000125, rel=1e-14
    )
    assert ranked["disc-4.inertia"].change == pytest.approx(
        -0.1 * ranked["disc-4.inertia"].sensitivity
    )
    assert sum(one.sensitivity for one in made.figures) == pytest.approx(np.zeros(3), abs=1e-14)
    assert made.figures[0] is first
    half = sum(one.change for one in made.figures)  # the band to second order
    assert (made.upper - made.lower) / made.frequency == pytest.approx(2.0 * half, rel=1e-2)


def test_water_and_a_gear_move_a_mode_as_their_figures_do() -> None:
    """Ranking of a geared train with entrained water: by differences of the solved frequencies."""
    text = (
        "name: x\ntrain:\n  - motor: {inertia: %r, tolerance: 4 %%}\n  - coupling: {stiffness: 9e3, tolerance: 10 %%}\n"
        "  - gear: {ratio: 5/2, inertia: [0.1, 0.4]}\n  - shaft: {length: 2, diameter: 0.1, material: steel}\n"
        "  - propeller: {inertia: %r, entrained: 25 %%, tolerance: 8 %%}\n"
    )
    made, step = found(text % (1.2, 40.0)), 1e-6
    ranked = {one.figure: one.sensitivity for one in made.figures}
    for figure, one in (("motor-1.inertia", (1.2, 0.0)), ("propeller-1.inertia", (0.0, 40.0))):
        ends = [
            found(text % (1.2 + s * step * one[0], 40.0 + s * step * one[1])).frequency
            for s in (1.0, -1.0)
        ]
        assert ranked[figure] == pytest.approx(
            np.log(ends[0] / ends[1]) / (2 * step), rel=1e-6, abs=1e-9
        )
    light = found(text % (1.2, 40.0))
    assert (light.lower < light.frequency).all()


def test_a_fixed_point_has_no_tolerance() -> None:
    with pytest.raises(torsion.InputError, match="could vary"):
        torsion.parse(
            "name: x\ntrain:\n  - disc: {held: true, tolerance: 5 %}\n  - coupling: {stiffness: 1}\n"
            "  - disc: {inertia: 1}\n"
        )


def test_each_coupling_alone_without_it_and_rigid() -> None:
    first = found(scene()).couplings[0]
    assert first.lower == pytest.approx(exact((17000.0, *STIFFNESS[1:])), rel=1e-14)
    assert first.upper == pytest.approx(exact((23000.0, *STIFFNESS[1:])), rel=1e-14)
    width = np.subtract(exact((23000.0, *STIFFNESS[1:])), exact((17000.0, *STIFFNESS[1:])))
    assert first.change == pytest.approx(width / exact(STIFFNESS), rel=1e-12)
    assert first.softest == pytest.approx([0.0, *exact(STIFFNESS[1:], INERTIA[1:])], rel=1e-14)
    assert first.stiffest[:2] == pytest.approx(exact(STIFFNESS[1:], (1.55, 0.6, 0.95)), rel=1e-14)
    assert first.stiffest[2] == np.inf


@pytest.mark.parametrize(("span", "mode", "hertz", "stiffness"), AIMS)
def test_stiffness_that_puts_a_mode_where_it_should_be(
    span: int, mode: int, hertz: float, stiffness: float
) -> None:
    aim = f"analyses: {{modes: , tolerances: {{aim: [{{mode: {mode}, frequency: {hertz} Hz}}]}}}}\n"
    one = found(scene(wide=(0, 0, 0), rest=aim)).aims[span - 1]
    assert one.coupling == f"coupling-{span}"
    assert one.stiffness == pytest.approx(stiffness, rel=1e-14)


def test_no_stiffness_is_told_beyond_what_a_coupling_reaches() -> None:
    made = found(
        scene(rest="analyses: {modes: , tolerances: {aim: [{mode: 2, frequency: 45 Hz}]}}\n")
    )
    first, second, third = made.aims
    assert first.stiffness is None
    assert 45.0 < first.softest == pytest.approx(exact(STIFFNESS[1:], INERTIA[1:])[0], rel=1e-14)
    assert second.stiffness is not None
    assert third.stiffness is not None


def test_an_aim_at_a_mode_that_is_not_computed_is_refused_where_it_stands() -> None:
    text = scene(
        rest="analyses: {modes: {count: 2}, tolerances: {aim: [{mode: 3, frequency: 45 Hz}]}}\n"
    )
    done = torsion.run(torsion.parse(text))
    (failed,) = done.plan.unanswered
    assert (failed.line, done.exit_status) == (10, 2)
    assert "mode 3 is none of the 2 that are computed" in failed.why


def test_critical_speeds_move_with_their_mode_and_may_enter_the_range() -> None:
    rest = "operation: {speeds: {from: 300 rpm, to: 700 rpm}}\nexcitations: [{at: disc-1, order: 2, torque: 10 N*m}]\n"
    done = torsion.run(torsion.parse(scene(rest=rest)))
    made = done.need(Tolerances)
    assert made.critical_lower == pytest.approx(made.lower * np.pi, rel=1e-14)
    assert made.critical_upper == pytest.approx(made.upper * np.pi, rel=1e-14)
    from torsion.output.chapters.modes.tolerances import chapter

    (row,) = next(one for one in chapter(done) if "speed range" in getattr(one, "caption", "")).rows
    assert row[0] == "671.41"
    assert row[-1] == "no"  # nominally outside


def test_a_case_at_an_end_of_the_tolerances_has_no_band() -> None:
    done = torsion.run(torsion.parse(scene(rest="cases: {from: tolerances}\n")))
    assert done.need(Tolerances).lower.size
    assert all(case.get(Tolerances) is None for case in done.cases.values())


def test_a_table_over_frequency_is_scaled_as_a_whole() -> None:
    table = "table: {over: frequency, at: [1 Hz, 20 Hz], stiffness: [%s, %s]}"
    text = "name: x\ntrain:\n  - disc: {inertia: 10}\n  - coupling: {%s}\n  - disc: {inertia: 40}\n"
    made = found(text % (table % ("20e3", "40e3") + ", tolerance: 10 %"))
    for end, k in ((made.lower, ("18e3", "36e3")), (made.upper, ("22e3", "44e3"))):
        assert end == pytest.approx(
            modes(torsion.assemble(torsion.parse(text % (table % k)).train), 1).frequency
        )


@settings(max_examples=25, deadline=None)
@given(st.integers(2, 4), st.integers(0, 2**32 - 1))
def test_no_corner_of_a_random_train_lies_outside(size: int, seed: int) -> None:
    """Every combination of the ends of all stiffnesses and inertias, side by side."""
    rng = np.random.default_rng(seed)
    k, j = (10.0 ** rng.uniform(*ends, size) for ends in ((2, 7), (-2, 2)))
    wide = rng.uniform(0.01, 0.3, 2 * size + 1)
    study = torsion.parse(scene(k, np.append(j, 1.0), wide[:size], heavy=wide[size:]))
    nominal = modes(torsion.assemble(study.train), size)
    made = tolerances(study, nominal, None)
    factor = 1.0 + np.array(list(itertools.product((-1, 1), repeat=2 * size + 1))) * wide
    tree, node = undamped_tree(nominal.system), nominal.system.condensed
    inertia, flexibility = (
        np.repeat(own[:, None], len(factor), axis=1) for own in (tree.inertia, tree.flexibility)
    )
    inertia[node.node] *= factor[:, size:].T
    flexibility[node.span] /= factor[:, :size].T
    every = variant_modes(tree, flexibility, inertia, size).frequency / (2.0 * np.pi)
    assert made.lower == pytest.approx(every.min(axis=1), rel=1e-12)  # the bounds of the enclosure
    assert made.upper == pytest.approx(every.max(axis=1), rel=1e-12)
    assert (made.lower[:, None] <= every * (1.0 + 1e-14)).all()
    assert (made.upper[:, None] >= every * (1.0 - 1e-14)).all()


@pytest.mark.parametrize("seed", range(6))
def test_no_corner_of_a_train_with_loops_lies_outside(seed: int) -> None:
    """Every combination of the ends of all figures, by the dense problem."""
    rng, loops = np.random.default_rng(seed), 1 + seed % 2
    k, j, chord = (
        10.0 ** rng.uniform(*ends, n) for ends, n in (((2, 5), 3), ((-1, 1), 4), ((2, 5), loops))
    )
    wide = rng.uniform(0.01, 0.3, 7 + loops)
    links = [
        f"  - {{between: [disc-{1 + one}, disc-{3 + one}], coupling: {{stiffness: {c!r}, tolerance: {t!r}}}}}\n"
        for one, (c, t) in enumerate(zip(chord.tolist(), wide[7:].tolist(), strict=True))
    ]
    made = found(scene(k, j, wide[:3], "links:\n" + "".join(links), wide[3:7]))
    spans = [(0, 1), (1, 2), (2, 3), *((one, one + 2) for one in range(loops))]
    for signs in itertools.product((-1, 1), repeat=7 + loops):
        factor, matrix = 1.0 + np.array(signs) * wide, np.zeros((4, 4))
        for (a, b), own in zip(spans, np.append(k * factor[:3], chord * factor[7:]), strict=True):
            matrix[[a, b, a, b], [a, b, b, a]] += own * np.array([1.0, 1.0, -1.0, -1.0])
        root = np.sqrt(j * factor[3:7])
        corner = np.sqrt(np.linalg.eigvalsh(matrix / np.outer(root, root))[1:]) / (2.0 * np.pi)
        assert (made.lower <= corner * (1.0 + 1e-9)).all()
        assert (made.upper >= corner * (1.0 - 1e-9)).all()


@pytest.mark.parametrize("model", ["exact", "fem"])
def test_no_corner_of_a_train_with_a_distributed_shaft_lies_outside(model: str) -> None:
    """Each corner as a train of its own; the band is no wider than they are."""
    text = (
        "name: x\nanalyses: {model: %s}\ntrain:\n  - disc: {inertia: %r%s}\n  - coupling: {stiffness: %r%s}\n"
        "  - disc: {inertia: 2}\n  - shaft: {length: 2 m, diameter: 80 mm}\n  - disc: {inertia: %r%s}\n"
    )
    made = found(
        text % (model, 5.0, ", tolerance: 5 %", 4e5, ", tolerance: 10 %", 8.0, ", tolerance: 20 %")
    )
    ends = [(one * (1 - t), one * (1 + t)) for one, t in ((5.0, 0.05), (4e5, 0.1), (8.0, 0.2))]
    corners = np.array(
        [
            torsion.run(torsion.parse(text % (model, a, "", b, "", c, ""))).need(Modes).frequency
            for a, b, c in itertools.product(*ends)
        ]
    )
    shown = corners[:, : made.lower.size]
    assert made.lower == pytest.approx(shown.min(axis=0), rel=1e-11)
    assert made.upper == pytest.approx(shown.max(axis=0), rel=1e-11)
    assert (made.lower <= shown.min(axis=0) * (1.0 + 1e-13)).all()
    assert (made.upper >= shown.max(axis=0) * (1.0 - 1e-13)).all()


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


def test_sensitivities_to_all_inertias_beside_a_spring_to_ground_add_up_to_minus_a_half() -> None:
    """All inertias times c make every frequency c**-0.5 as high, on a spring to ground as without one (Euler)."""
    discs = (
        "  - disc: {inertia: 2, stiffness: 8 kN*m/rad, tolerance: 5 %}\n",
        "  - disc: {inertia: 3, tolerance: 5 %}\n",
    )
    result = found(f"name: a\ntrain:\n{discs[0]}  - coupling: {{stiffness: 1e4}}\n{discs[1]}")
    assert {figure.figure for figure in result.figures} == {"disc-1.inertia", "disc-2.inertia"}
    assert sum(figure.sensitivity for figure in result.figures) == pytest.approx(-0.5, rel=1e-12)
