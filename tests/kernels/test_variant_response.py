"""Responses of many trains side by side: each train by itself, 40 digits, closed forms; peaks and their told error."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import complex_compliance, tree_response
from torsion.kernels.variant_response import Trains, resonance_grid, variant_peaks


def layout(parent: list[int], held: tuple[int, ...] = ()) -> Tree:
    size = len(parent)
    fixed = np.zeros(size, dtype=bool)
    fixed[list(held)] = True
    return Tree(np.array(parent), np.zeros(size), np.zeros(size), fixed)


def chain(
    size: int, count: int, *, eta: float = 0.05, seed: int = 1, spread: float = 0.15
) -> Trains:
    """Random chains, one of whose spans is soft and lossy."""
    rng = np.random.default_rng(seed)
    middle = rng.uniform(0.5, 2.0, (2, size, 1)) * np.array([1e-4, 1.0])[:, None, None]
    h, j = middle * rng.uniform(1.0 - spread, 1.0 + spread, (2, size, count))
    loss = np.full(size, eta / 4.0)
    loss[1] = eta
    return Trains(layout([*range(-1, size - 1)]), h, j, np.zeros(size), loss, np.zeros(size))


@settings(max_examples=25, deadline=None)
@given(st.integers(2, 18), st.booleans(), st.booleans(), st.booleans(), st.integers(0, 2**32 - 1))
def test_columns_of_inertias_are_each_train_by_itself(
    size: int, is_held: bool, is_rigid: bool, is_damped: bool, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    tree = layout([-1, *(int(rng.integers(0, k)) for k in range(1, size))], (0,) if is_held else ())
    h, j, loss, viscous, ground = 10.0 ** rng.uniform(-1, 1, (5, size, 7))
    if is_rigid:
        h[rng.integers(1, size)] = 0.0
    h[0] = viscous[0] = 0.0
    loss, viscous, ground = (is_damped * own for own in (loss / 10.0, viscous, ground))
    w, force = 10.0 ** rng.uniform(-1, 1, 7), rng.normal(size=(size, 7)) * (1.0 + 1j)
    twist = np.zeros((size, 7))
    twist[-1] = 0.1
    hc = complex_compliance(h, viscous, loss, w)
    both = replace(tree, inertia=j, flexibility=h)
    found = tree_response(both, w, force, twist=twist, ground_damping=ground, compliance=hc)
    for k in range(7):
        mine = complex_compliance(h[:, k], viscous[:, k], loss[:, k], w[k : k + 1]).reshape(
            size, -1
        )[:, 0]
        alone = tree_response(
            replace(tree, inertia=j[:, k], flexibility=h[:, k]),
            w[k : k + 1],
            force[:, k],
            twist=twist[:, k],
            ground_damping=ground[:, k],
            compliance=mine,
        )
        for name in ("angle", "torque", "amplification"):
            one, other = getattr(found, name)[..., k], getattr(alone, name)[..., 0]
            assert (
                np.abs(one - other).max() <= 1e-13 * np.abs(other).max() * alone.amplification[0]
            ), name
        # Near an undamped resonance the residual grows with the answer.
        assert max(found.residual[k], alone.residual[0]) < 1e-13 * max(1.0, alone.amplification[0])


def test_columns_are_the_response_in_forty_digits() -> None:
    """A geared tree of four stations, by elimination of the assembled equations."""
    rng, parent = np.random.default_rng(5), [-1, 0, 1, 1]
    h, j = 10.0 ** rng.uniform(-6, 0, (4, 3)), 10.0 ** rng.uniform(-3, 2, (4, 3))
    w, force, loss = (
        np.array([0.7, 30.0, 900.0]),
        np.array([0.0, 3.0, 0.0, 1.0 - 2.0j]),
        np.array([0.0, 0.1, 0.02, 0.3]),
    )
    hc = complex_compliance(h, np.zeros(4), loss, w)
    found = tree_response(replace(layout(parent), inertia=j), w, force, compliance=hc)
    with mp.workdps(40):
        for k in range(3):
            whole = mp.diag([-(mp.mpf(w[k]) ** 2) * mp.mpf(one) for one in j[:, k]])
            stiffness = [0, *((1 + 1j * mp.mpf(loss[i])) / mp.mpf(h[i, k]) for i in (1, 2, 3))]
            for i in (1, 2, 3):
                for a, b, sign in (
                    (i, i, 1),
                    (parent[i], parent[i], 1),
                    (i, parent[i], -1),
                    (parent[i], i, -1),
                ):
                    whole[a, b] += sign * stiffness[i]
            angle = mp.lu_solve(whole, mp.matrix([mp.mpc(complex(one)) for one in force]))
            torque = [complex(stiffness[i] * (angle[parent[i]] - angle[i])) for i in (1, 2, 3)]
            assert np.abs(found.angle[:, k] / [complex(one) for one in angle] - 1).max() < 1e-13
            assert np.abs(found.torque[1:, k] / torque - 1).max() < 1e-13


def test_another_number_of_columns_is_refused() -> None:
    with pytest.raises(ValueError, match="inertia has shape"):
        tree_response(replace(layout([-1, 0]), inertia=np.ones((2, 3))), np.ones(4), np.ones(2))


def test_peaks_are_those_of_a_search_and_the_told_error_covers_them() -> None:
    trains, force, band = chain(6, 12), np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]), (1.0, 130.0)
    found = variant_peaks(trains, force, band)
    assert found.ok.all()
    for k in range(12):
        one = trains.part(slice(k, k + 1))

        def torque(w: np.ndarray, one: Trains = one) -> np.ndarray:
            return np.abs(one.response(np.reshape(w, (1, -1)), force).torque)

        even = np.linspace(*band, 4001)
        sampled = torque(even)
        for span in range(1, 6):
            top = np.clip(sampled[span].argmax(), 1, 3999)
            sharp = minimize_scalar(
                lambda w, span=span: -torque(np.array([w]))[span, 0],
                bounds=even[[top - 1, top + 1]],
                method="bounded",
                options={"xatol": 1e-9},
            )
            true = max(-sharp.fun, sampled[span].max())
            assert abs(found.torque[span, k] / true - 1.0) <= found.error[span, k] + 1e-9
            assert found.torque[span, k] == pytest.approx(true, rel=1e-6)
    assert np.median(found.error[1:]) < 1e-4


def test_a_mode_that_only_some_trains_have_within_the_band_is_found_there() -> None:
    """The second mode of a free chain lies above the band of the middle train, and within that of the soft ones."""
    trains = chain(3, 64, eta=0.004, spread=0.3)
    middle = np.sort(trains.resonances(1e3)[0][1])
    band = (0.6 * middle[0], middle[20])
    found = variant_peaks(trains, np.array([0.0, 0.0, 1.0]), band)
    within = trains.resonances(1e3)[0][1] < 0.999 * band[1]
    even = np.broadcast_to(np.linspace(*band, 20001), (64, 20001))
    for k in np.flatnonzero(within).tolist():
        dense = np.abs(
            trains.part(slice(k, k + 1)).response(even[:1], np.array([0.0, 0.0, 1.0])).torque
        ).max(axis=1)
        assert (found.torque[1:, k] >= (1.0 - 1e-6) * dense[1:]).all()
    assert 0 < within.sum() < 64


def test_a_resonance_without_damping_is_no_number() -> None:
    trains = chain(4, 5, eta=0.0)
    found = variant_peaks(trains, np.array([1.0, 0.0, 0.0, 0.0]), (1.0, 150.0))
    assert not found.ok.any()
    assert np.isinf(found.torque).all()


def test_more_trains_than_are_solved_at_once_are_the_same_as_some_of_them() -> None:
    trains, force = chain(5, 400), np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    found = variant_peaks(trains, force, (1.0, 120.0))
    some = replace(
        trains.part(slice(150, 400)), loss_factor=np.tile(trains.loss_factor[:, None], 250)
    )
    assert found.torque[1:, 150:] == pytest.approx(
        variant_peaks(some, force, (1.0, 120.0)).torque[1:], rel=1e-6
    )


def test_a_grid_holds_every_resonance_and_its_half_power_points() -> None:
    grid = resonance_grid(
        np.array([[10.0, 11.0], [500.0, 600.0]]),
        np.array([0.01, 0.01]),
        np.linspace(1.0, 100.0, 17),
    )
    assert grid.shape == (2, 2 * (17 + 11) - 1)
    for row, centre in zip(grid, (10.0, 11.0), strict=True):
        for share in (0.99, 1.0, 1.01):
            assert np.abs(row - share * centre).min() < 1e-12
    assert (np.diff(grid, axis=1) >= 0.0).all()
    assert (grid[:, [0, -1]] == [1.0, 100.0]).all()


def test_no_peak_of_a_heavily_damped_train_is_missed_unless_the_error_says_so() -> None:
    """Random chains with a viscous damper that may couple its stations; the truth by 6000 even points."""
    rng, force, band, moved = (
        np.random.default_rng(3),
        np.array([0.0, 0.0, 0.0, 1.0]),
        (0.2, 4.0),
        0,
    )
    w = np.linspace(*band, 6000)
    for _ in range(60):
        h, j = np.exp(rng.uniform(-1.5, 1.5, (2, 4, 1))) * rng.uniform(0.85, 1.15, (2, 4, 3))
        viscous, loss = np.zeros(4), np.full(4, 0.02)
        viscous[rng.integers(1, 4)] = np.exp(rng.uniform(-4.0, 4.0)) / h.mean()
        trains = Trains(layout([-1, 0, 1, 2]), h, j, viscous, loss, np.zeros(4))
        found = variant_peaks(trains, force, band)
        true = (
            np.abs(trains.response(np.tile(w, (3, 1)), force).torque)
            .reshape(4, 3, -1)
            .max(axis=2)[1:]
        )
        moved += bool(np.isinf(found.error[1:]).any())
        missed = true / found.torque[1:] - 1.0
        assert (missed <= 5e-3 + 2.0 * found.error[1:]).all()
    assert 10 < moved < 50
