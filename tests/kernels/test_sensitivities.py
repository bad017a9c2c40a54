"""Sensitivities of frequencies and of a response: many digits, closed forms, and the independent published digits."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.loops import Chords, graph_modes, looped_response
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.sensitivities import (
    compliance_slopes,
    frequency_sensitivity,
    response_sensitivity,
)
from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import complex_compliance, tree_response

FOUR = (1.2, 0.35, 0.6, 0.95), (20000.0, 310000.0, 47000.0)
BY_STIFFNESS = [  # 50 digits, a dense symmetric eigenproblem; modes by spans
    [0.403343153160794559, 0.0206704170166392124, 0.075986429822566229],
    [0.0842550621870688425, 0.00246320490974162563, 0.413281732903189532],
    [0.0124017846521365989, 0.476866378073619162, 0.0107318372742442391],
]
BY_INERTIA = [
    [-0.293803734606897595, -0.0119116068010872881, -0.0299821608160149916, -0.164302497776000125],
    [-0.0125071575598935434, -0.120045703683979212, -0.185336914012647659, -0.182110224743479586],
    [
        -0.000140720736434668295,
        -0.311591076611707694,
        -0.187906731622950252,
        -0.000361471028907385519,
    ],
]


def test_a_chain_of_four_discs_has_its_published_sensitivities(chain) -> None:
    tree = chain(*FOUR)
    found = frequency_sensitivity(tree, tree_modes(tree))
    assert found.stiffness[1:] == pytest.approx(np.transpose(BY_STIFFNESS), rel=1e-14)
    assert found.inertia == pytest.approx(np.transpose(BY_INERTIA), rel=1e-14)


@pytest.mark.parametrize(
    ("seed", "shape", "held"),
    [(1, "chain", "none"), (2, "branched", "root"), (3, "bushy", "leaves"), (4, "chain", "none")],
)
def test_shares_of_stiff_trains_are_right_to_their_last_digits_however_small(
    random_tree, exact_modes, seed, shape, held
) -> None:
    tree = random_tree(seed, size=7, shape=shape, held=held)
    found, (by_stiffness, by_inertia) = (
        frequency_sensitivity(tree, tree_modes(tree)),
        _shares(tree, exact_modes(tree)),
    )
    assert by_stiffness[tree.parent >= 0].min() < 1e-20
    assert found.stiffness == pytest.approx(by_stiffness, rel=3e-13, abs=1e-200)
    assert found.inertia == pytest.approx(by_inertia, rel=3e-13, abs=1e-200)


def _shares(tree, exact):
    """Half of each share of energy (stations, modes), the kinetic ones negative, from angles of 120 digits."""
    square = [[w**2] * tree.size for w in exact.frequency]
    elastic = [
        [
            float(mp.mpf(float(h)) * t**2 / s / 2)
            for h, t, s in zip(tree.flexibility, *row, strict=True)
        ]
        for row in zip(exact.torque, square, strict=True)
    ]
    kinetic = [
        [-float(mp.mpf(float(j)) * x**2) / 2 for j, x in zip(tree.inertia, row, strict=True)]
        for row in exact.angle
    ]
    return np.array(elastic).T * (tree.parent >= 0)[:, None], np.array(kinetic).T * ~tree.held[
        :, None
    ]


def test_frequencies_of_a_closed_loop_move_by_the_sensitivities() -> None:
    """Against differences of the roots of the determinant in 60 digits, and the sums 1/2 and -1/2."""
    tree = Tree(
        np.array([-1, 0, 1, 1]),
        np.array([0.0, 5e-5, 3e-6, 2e-5]),
        np.array([1.2, 0.35, 0.6, 0.95]),
        HELD,
    )
    first, second, chord = np.array([3]), np.array([2]), np.array([4e-4])
    modes = graph_modes(tree, first, second, chord)
    found = frequency_sensitivity(tree, modes, chord)
    assert (found.stiffness.sum(axis=0) + found.chord.sum(axis=0)) == pytest.approx(0.5, rel=1e-14)
    assert found.inertia.sum(axis=0) == pytest.approx(-0.5, rel=1e-14)
    spans = [(0, 1), (1, 2), (1, 3), (3, 2)]
    with mp.workdps(60):
        h = [mp.mpf(float(v)) for v in [*tree.flexibility[1:], *chord]]
        inertia = [mp.mpf(float(v)) for v in tree.inertia]
        wanted = np.vstack([found.stiffness[1:], found.chord, found.inertia])
        for mode, w in enumerate(modes.frequency):
            exact = [_moved(spans, h, inertia, w, figure) for figure in range(8)]
            assert wanted[:, mode] == pytest.approx(np.array(exact), rel=1e-13, abs=0)


HELD = np.zeros(4, dtype=bool)
STEP = mp.mpf(10) ** -25


def _moved(spans, h, inertia, w, figure, other=None):
    """d ln w/d ln of a stiffness or, numbered behind them, an inertia; or of both `figure` and `other`: differences."""

    def log_frequency(*changes):
        k, j = [1 / v for v in h], list(inertia)
        for place, change in zip((figure, other), changes, strict=False):
            values, at = (k, place) if place < len(k) else (j, place - len(k))
            values[at] *= mp.exp(change)

        def determinant(square):
            matrix = mp.diag([-square * v for v in j])
            for (a, b), own in zip(spans, k, strict=True):
                matrix[a, a] += own
                matrix[b, b] += own
                matrix[a, b] -= own
                matrix[b, a] -= own
            return mp.det(matrix)

        start = mp.mpf(float(w)) ** 2
        return (
            mp.log(
                mp.findroot(
                    determinant, (start, start * (1 + mp.mpf(10) ** -12)), tol=1e-90, verify=False
                )
            )
            / 2
        )

    if other is None:
        return float((log_frequency(STEP) - log_frequency(-STEP)) / (2 * STEP))
    step = mp.mpf(10) ** -14
    corners = [
        one * two * log_frequency(one * step, two * step) for one in (1, -1) for two in (1, -1)
    ]
    return float(sum(corners) / (4 * step**2))


@pytest.mark.parametrize(
    "target", [{"span": 1}, {"span": 4}, {"station": 3}, {"span": 3, "is_looped": True}]
)
def test_the_adjoint_gives_the_derivatives_of_a_response_by_every_figure(target) -> None:
    """Against central differences of a dense mixed system in 60 digits, value by value."""
    is_looped, rng = target.pop("is_looped", False), np.random.default_rng(5)
    spans = [(0, 1), (1, 2), (1, 3), (3, 4), (3, 5)] + [(5, 2)] * is_looped
    tree = Tree(
        np.array([-1, 0, 1, 1, 3, 3]),
        np.append(0.0, 10 ** -rng.uniform(3, 6, 5)),
        10 ** rng.uniform(-1, 1, 6),
        np.zeros(6, dtype=bool),
    )
    w, force, ground = (
        np.array([37.0, 137.0]),
        rng.normal(size=6),
        np.array([0.0, 0.0, 0.0, 0.0, 0.0, 3.0]),
    )
    hc = tree.flexibility / (1 + 0.1j)
    given = {"compliance": hc, "ground_damping": ground}
    chords = (
        Chords(np.array([5]), np.array([2]), np.array([1e-3 / (1 + 0.05j)]), np.zeros(1))
        if is_looped
        else None
    )
    if chords is None:  # noqa: SIM108
        response = tree_response(tree, w, force, **given)
    else:
        response = looped_response(tree, chords, w, force, **given)
    found = response_sensitivity(tree, w, response, chords=chords, **target, **given)
    figures = np.concatenate(
        [hc[1:], [] if chords is None else chords.compliance, tree.inertia, ground]
    )
    figures = np.concatenate([figures, force, np.zeros(len(spans))])
    derivative = np.vstack(
        [
            found.compliance[1:],
            found.chord,
            found.inertia,
            found.ground_damping,
            found.force,
            found.twist[1:],
            found.chord_twist,
        ]
    )
    row = target["station"] if "station" in target else 5 + target["span"]
    for at, one in enumerate(w):
        with mp.workdps(60):
            exact = np.array(
                [
                    _slope(spans, figures, len(force), float(one), row, k)
                    for k in range(len(figures))
                ]
            )
        assert np.abs(derivative[:, at] / exact - 1.0).max() < 1e-13


def _slope(spans, figures, n, w, row, figure):
    """Derivative of unknown `row` (angles, then span torques) by one figure."""

    def unknowns(change):
        values = [mp.mpc(complex(v)) for v in figures]
        values[figure] += change
        m = len(spans)
        matrix, right = mp.zeros(n + m), mp.matrix(values[m + 2 * n :])
        for i in range(n):
            matrix[i, i] = mp.mpc(0, w) * values[m + n + i] - mp.mpf(w) ** 2 * values[m + i]
        for s, (parent, station) in enumerate(spans):
            matrix[station, n + s], matrix[parent, n + s] = -1, 1
            matrix[n + s, station], matrix[n + s, parent], matrix[n + s, n + s] = 1, -1, values[s]
        return mp.lu_solve(matrix, right)[row]

    return complex((unknowns(STEP) - unknowns(-STEP)) / (2 * STEP))


def test_a_compliance_follows_stiffness_loss_and_damper_by_its_slopes() -> None:
    k, c, eta, w = (
        np.array([2e4, 3e5]),
        np.array([3.0, 0.0]),
        np.array([0.1, 0.2]),
        np.array([10.0, 400.0]),
    )
    slopes = compliance_slopes(k, c, eta, 1j * w)
    step = 1e-6
    for number, (ks, cs, es) in enumerate([(step, 0, 0), (0, 0, step), (0, step, 0)]):
        ends = [
            complex_compliance(1 / (k * np.exp(s * ks)), c + s * cs, eta + s * es, w)
            for s in (1.0, -1.0)
        ]
        assert slopes[number] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-8)


def test_the_target_of_a_response_is_one_span_or_one_station(chain) -> None:
    tree, w = chain(*FOUR), np.array([10.0])
    response = tree_response(tree, w, np.ones(4))
    for wrong in ({}, {"span": 1, "station": 1}):
        with pytest.raises(ValueError, match="either the span"):
            response_sensitivity(tree, w, response, **wrong)


def test_the_amplitude_at_a_peak_follows_a_stiffness_by_its_partial_derivative() -> None:
    """Peak of one lossy oscillator held at its root: |T| = F/eta at w = sqrt(k/J), whatever k."""
    one = Tree(np.array([-1, 0]), np.array([0.0, 1e-4]), np.ones(2), np.array([True, False]))
    w, hc = np.array([100.0]), np.array([0.0, 1e-4 / (1 + 0.1j)])
    response = tree_response(one, w, np.array([0.0, 1.0]), compliance=hc)
    by_compliance = response_sensitivity(one, w, response, span=1, compliance=hc).compliance[1]
    slope = compliance_slopes(np.array([1e4]), np.zeros(1), np.array([0.1]), 1j * w)[0][0]
    change = (by_compliance * slope / response.torque[1]).real
    assert change == pytest.approx([0.0], abs=1e-13)
