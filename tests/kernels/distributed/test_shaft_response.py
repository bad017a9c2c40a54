"""Response of trains with shafts as continua, against transfer matrices in many digits."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from torsion.errors import SolveError
from torsion.kernels.distributed.continuous_shafts import uniform_shafts
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.modes.mode_shapes import TreeModes
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import Status, status, tree_response


def _modes(tree: Tree, shafts: Shafts, count: int) -> TreeModes:
    return tree_modes(replace(tree, shafts=shafts), count)


LENGTH, RIGIDITY, HEAVY = (
    np.array([0.4, 0.9, 0.3]),
    np.array([2e6, 5e6, 1e6]),
    np.array([0.8, 2.0, 0.4]),
)
DISCS = [3.0, 0.0, 0.5, 8.0]


def _train(cut: int) -> tuple[Tree, Shafts]:
    inertia = np.zeros(3 * cut + 1)
    inertia[::cut] = DISCS
    law = uniform_shafts(*(np.repeat(values, cut) for values in (LENGTH / cut, RIGIDITY, HEAVY)))
    size = 3 * cut + 1
    return Tree(np.arange(-1, 3 * cut), np.zeros(size), inertia, np.zeros(size, bool)), Shafts(
        np.arange(1, size), (law,)
    )


def _exact(trains, w: float, eta: float, force: list[complex]):
    """Angles of the four stations and torques at both ends of the three lengths: a state with a column of sources."""
    s, turn = mp.mpf(w) ** 2, mp.mpc(1, eta)
    state = mp.matrix(
        [[1, 0], [0, 0]]
    )  # (angle, torque towards the far end), by the first angle and by the sources
    places, ends = [], []
    for k, disc in enumerate(DISCS):
        places.append(state[0, :])
        state = trains.line([("disc", disc)], s) * state
        state[1, 1] += mp.mpmathify(force[k])
        if k < 3:
            before = state[1, :]
            state = (
                trains.line([("shaft", LENGTH[k], turn * mp.mpf(RIGIDITY[k]), HEAVY[k])], s) * state
            )
            ends.append((before, state[1, :]))
    first = -state[1, 1] / state[1, 0]

    def stated(rows):
        return np.array([complex(row[0] * first + row[1]) for row in rows])

    return stated(places), stated([a for a, _ in ends]), stated([b for _, b in ends])


@pytest.mark.parametrize("eta", [0.0, 0.02])
@pytest.mark.parametrize("cut", [1, 3])
def test_the_response_equals_transfer_matrices(trains, eta: float, cut: int) -> None:
    train, bars = _train(cut)
    w = np.array([5.0, 300.0, 900.0, 2100.0, 4000.0])
    force = np.zeros(train.size, complex)
    force[::cut] = [1.0, 0.0, 0.5 - 2.0j, 3.0j]
    found = tree_response(
        replace(train, shafts=bars), w, force, shaft_loss=np.full(len(bars.node), eta)
    )
    assert np.all(status(found.amplification, found.residual) == Status.OK)
    assert found.residual.max() < 1e-14
    for column, speed in enumerate(w):
        angle, inner, outer = _exact(trains, speed, eta, force[::cut].tolist())
        for values, exact in (
            (found.angle[::cut, column], angle),
            (found.torque[1::cut, column], inner),
            (found.torque_outer[cut::cut, column], outer),
        ):
            assert np.abs(values - exact).max() < 1e-12 * np.abs(exact).max()


def test_loss_factors_may_differ_from_shaft_to_shaft(trains) -> None:
    """One lossy shaft between two others, against one whose law is evaluated at one complex s."""
    train, bars = _train(1)
    w, loss = np.array([700.0, 1500.0]), np.array([0.0, 0.1, 0.03])
    found = tree_response(replace(train, shafts=bars), w, np.array([1.0, 0, 0, 0]), shaft_loss=loss)
    for column, speed in enumerate(w):
        s = mp.mpf(speed) ** 2
        parts = []
        for k, disc in enumerate(DISCS):
            parts.append(("disc", disc))
            if k < 3:
                parts.append(
                    ("shaft", LENGTH[k], mp.mpc(1, loss[k]) * mp.mpf(RIGIDITY[k]), HEAVY[k])
                )
        whole = trains.line(parts, s)
        line = trains.line(parts[1:], s)
        first = complex(-line[1, 1] / whole[1, 0])
        assert abs(found.angle[0, column] / first - 1) < 1e-12


def test_a_bar_without_density_responds_as_a_spring_with_loss() -> None:
    h = np.array([0.0, 1e-6, 2e-7, 5e-6])
    train = Tree(np.array([-1, 0, 1, 1]), h, np.array([1.0, 2.0, 0.3, 0.4]), np.zeros(4, bool))
    eta, w = np.array([0.0, 0.02, 0.0, 0.1]), np.linspace(0.0, 3000.0, 40)[1:]
    force = np.array([1.0, 0.0, 2.0, -1.0])
    plain = tree_response(train, w, force, compliance=h / (1 + 1j * eta))
    bare = Tree(train.parent, np.zeros(4), train.inertia, train.held)
    bars = Shafts(np.array([2, 1, 3]), (uniform_shafts(1.0, 1.0 / h[[2, 1, 3]], 0.0),))
    found = tree_response(replace(bare, shafts=bars), w, force, shaft_loss=eta[[2, 1, 3]])
    assert np.allclose(found.angle, plain.angle, rtol=1e-12)
    assert np.allclose(found.torque, plain.torque, rtol=1e-12)
    assert np.allclose(found.torque_outer, plain.torque, rtol=1e-12)


def test_without_bars_both_ends_of_a_span_have_one_torque(random_tree) -> None:
    found = tree_response(random_tree(1, size=6), np.array([1.0, 2.0]), np.ones(6))
    assert found.torque_outer is found.torque


def test_exactly_at_resonance_a_line_is_marked(trains) -> None:
    train, bars = trains.chain(4, {4: 1.0}), trains.pieces(1.0, 1.0, 1.0, 4)
    w = _modes(train, bars, 1).frequency
    found = tree_response(
        replace(train, shafts=bars), np.append(w, 2.2), np.array([1.0, 0, 0, 0, 0])
    )
    marks = status(found.amplification, found.residual)
    assert marks[0] != Status.OK
    assert marks[1] == Status.OK


def test_at_standstill_a_held_shaft_twists_by_its_flexibility(trains) -> None:
    train, bars = trains.chain(3, held=(0,)), trains.pieces(2.0, 5.0, 1.0, 3)
    found = tree_response(replace(train, shafts=bars), np.zeros(1), np.array([0, 0, 0, 10.0]))
    assert np.allclose(found.angle[:, 0], [0, 4 / 3, 8 / 3, 4], rtol=1e-15)
    assert np.allclose(found.torque[1:, 0], -10.0, rtol=1e-15)


def test_residual_of_lossy_shafts_is_rounding(trains) -> None:
    train, bars = _train(2)
    given = replace(train, shafts=bars), np.array([100.0, 2000.0]), np.arange(7.0)
    assert tree_response(*given, shaft_loss=np.full(6, 0.01)).residual.max() < 1e-14


def test_a_twist_along_a_bar_is_refused() -> None:
    train, bars = _train(1)
    with pytest.raises(ValueError, match="twist is imposed on a span with distributed inertia"):
        tree_response(
            replace(train, shafts=bars), np.ones(1), np.ones(4), twist=np.array([0, 1.0, 0, 0])
        )
    with pytest.raises(ValueError, match=r"shaft_loss has shape \(2,\); expected \(3,\)"):
        tree_response(replace(train, shafts=bars), np.ones(1), np.ones(4), shaft_loss=np.ones(2))


def test_a_frequency_beyond_the_series_of_a_profile_is_refused(trains) -> None:
    bars = trains.tapered(lambda x: (1.0 + x) ** 4, 2)
    with pytest.raises(SolveError, match="divide the shafts more finely"):
        tree_response(replace(trains.chain(2), shafts=bars), np.array([100.0]), np.ones(3))
