"""Modes of long rows of stations, against closed forms and, for short rows forced the same way, many digits."""

import mpmath as mp
import numpy as np
import pytest

from torsion.errors import SolveError
from torsion.kernels.long_chain import long_chain_modes as driver
from torsion.kernels.long_chain.long_chain_modes import long_chain_modes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.sturm import count_bounds
from torsion.kernels.tree import Tree

LONG = 20_000


def _uniform(size, held=()):
    stations = np.arange(size)
    return Tree(stations - 1, np.ones(size), np.ones(size), np.isin(stations, held))


def _row(seed, size, *, rigid=0.0, massless=0.0, held=()):
    rng = np.random.default_rng(seed)
    flexibility = np.where(rng.random(size) < rigid, 0.0, 10 ** -rng.uniform(0, 12, size))
    inertia = np.where(rng.random(size) < massless, 0.0, 10 ** rng.uniform(-6, 4, size))
    return Tree(
        np.arange(size) - 1,
        flexibility,
        inertia,
        np.isin(np.arange(size), [h % size for h in held]),
    )


def _componentwise(found, exact):
    """Largest relative error of a component that 120 digits determine, up to the common sign of the shape."""
    worst = 0.0
    for mode in range(found.shape[1]):
        column, reference = found[:, mode].tolist(), exact[mode]
        lead = max(range(len(reference)), key=lambda i, r=reference: abs(r[i]))
        sign = 1 if column[lead] * reference[lead] > 0 else -1
        small = mp.mpf(10) ** -95 * abs(reference[lead])
        errors = (
            abs(sign * mp.mpf(f) / e - 1)
            for f, e in zip(column, reference, strict=True)
            if abs(e) >= small
        )
        worst = max(worst, *map(float, errors))
    return worst


@pytest.mark.parametrize(
    ("held", "phase"), [((), "free"), ((0,), "quarter"), ((-1,), "quarter"), ((0, -1), "half")]
)
def test_long_uniform_chain_has_the_frequencies_2_sin(held, phase):
    modes = tree_modes(_uniform(LONG, [h % LONG for h in held]), 20)
    j = np.arange(1, 21)
    turns = {
        "free": j / (2 * LONG),
        "quarter": (2 * j - 1) / (4 * LONG - 2),
        "half": j / (2 * (LONG - 1)),
    }
    exact = 2 * np.sin(np.pi * turns[phase])
    np.testing.assert_allclose(modes.frequency, exact, rtol=1e-15)
    assert modes.certified
    assert modes.rigid == (phase == "free")
    assert np.all((modes.lower < exact) & (exact < modes.upper))
    assert np.all(modes.upper < modes.lower * (1 + 1e-12))


def test_long_uniform_chain_has_cosine_shapes_and_sine_torques():
    modes = tree_modes(_uniform(LONG), 8)
    j, station = np.arange(1, 9), np.arange(LONG)[:, None]
    shape = np.sqrt(2 / LONG) * np.cos(j * np.pi * (station + 0.5) / LONG)
    torque = np.sqrt(2 / LONG) * modes.frequency * np.sin(j * np.pi * station / LONG)
    largest = np.sqrt(2 / LONG)
    np.testing.assert_allclose(modes.angle, shape, atol=1e-11 * largest)
    np.testing.assert_allclose(
        modes.torque[1:] / modes.frequency, torque[1:] / modes.frequency, atol=1e-10 * largest
    )
    np.testing.assert_allclose(modes.angle.T @ modes.angle, np.eye(8), atol=1e-12)
    np.testing.assert_allclose(modes.rigid_angle, LONG**-0.5, rtol=1e-14)


@pytest.mark.parametrize("held", [(), (0,), (-1,), (0, -1)])
@pytest.mark.parametrize("size", [3, 8, 15])
def test_stiff_rows_are_right_in_every_component(exact_modes, held, size):
    tree = _row(size, size, held=held)
    modes, exact = long_chain_modes(tree, size), exact_modes(tree)
    assert len(modes.frequency) == len(exact.frequency)
    for low, w, high in zip(
        modes.lower.tolist(), exact.frequency, modes.upper.tolist(), strict=True
    ):
        assert low <= w <= high <= low * (1 + 1e-13)
    np.testing.assert_allclose(modes.frequency, [float(w) for w in exact.frequency], rtol=3e-15)
    assert _componentwise(modes.angle, exact.angle) < 1e-12
    assert _componentwise(modes.torque[1:], [t[1:] for t in exact.torque]) < 1e-12


@pytest.mark.parametrize("held", [(), (0,), (-1,), (0, -1)])
@pytest.mark.parametrize("seed", range(4))
def test_rigid_spans_and_massless_stations_are_merged_without_loss(exact_modes, held, seed):
    tree = _row(seed, 16, rigid=0.3, massless=0.3, held=held)
    modes, exact = long_chain_modes(tree, 16), exact_modes(tree)
    np.testing.assert_allclose(modes.frequency, [float(w) for w in exact.frequency], rtol=5e-15)
    for low, w, high in zip(
        modes.lower.tolist(), exact.frequency, modes.upper.tolist(), strict=True
    ):
        assert low <= w <= high
    largest = [max(map(abs, t)) for t in exact.torque]
    lead = [int(np.argmax([abs(float(a)) for a in shape])) for shape in exact.angle]
    for mode, (angle, torque) in enumerate(zip(exact.angle, exact.torque, strict=True)):
        sign = np.sign(modes.angle[lead[mode], mode] * float(angle[lead[mode]]))
        free = (
            tree.flexibility[1:] > 0
        )  # what a rigid span to a fixed station carries is compared below
        moved = np.array([float(t / largest[mode]) for t in torque[1:]])
        stated = sign * modes.torque[1:, mode] / float(largest[mode])
        np.testing.assert_allclose(stated[free], moved[free], atol=1e-13)
        np.testing.assert_allclose(
            sign * modes.angle[:, mode], [float(a) for a in angle], rtol=1e-11, atol=0
        )


@pytest.mark.parametrize("held", [(), (0, -1)])
def test_rigid_spans_carry_what_the_stations_beyond_them_need(held):
    tree = _row(11, 40, rigid=0.4, massless=0.2, held=held)
    modes = long_chain_modes(tree, 6)
    inner = slice(1, -1)
    needed = modes.frequency**2 * tree.moving_inertia[inner, None] * modes.angle[inner]
    change = modes.torque[2:] - modes.torque[1:-1]
    size = np.abs(modes.torque).max(axis=0)
    fixed = np.abs(modes.angle[inner]) > 0.0
    np.testing.assert_allclose((change / size)[fixed], (needed / size)[fixed], atol=1e-13)


@pytest.mark.parametrize("root", [0, 1, 7, 19])
def test_a_row_numbered_from_any_station_has_the_same_modes(root):
    straight = _row(5, 20)
    order = [root, *(s for d in range(1, 20) for s in (root - d, root + d) if 0 <= s < 20)]
    place = np.empty(20, dtype=np.int64)
    place[order] = np.arange(20)
    parent, flexibility = np.full(20, -1), np.zeros(20)
    for station in range(20):
        if station != root:
            toward = station - 1 if station > root else station + 1
            parent[place[station]] = place[toward]
            flexibility[place[station]] = straight.flexibility[max(station, toward)]
    tree = Tree(parent, flexibility, straight.inertia[order], np.zeros(20, bool))
    modes, same = long_chain_modes(tree, 6), long_chain_modes(straight, 6)
    np.testing.assert_allclose(modes.frequency, same.frequency, rtol=1e-15)
    sign = np.sign(np.sum(modes.angle[place] * same.angle * straight.inertia[:, None], axis=0))
    np.testing.assert_allclose(modes.angle[place], sign * same.angle, rtol=1e-12)
    other = tree_modes(tree, 6)
    sign = np.sign(np.sum(other.angle * modes.angle * tree.inertia[:, None], axis=0))
    np.testing.assert_allclose(modes.torque, sign * other.torque, rtol=1e-12)


def test_stiff_long_row_is_enclosed_as_the_rigorous_counts_of_the_tree_say():
    tree = _row(3, 4000, rigid=0.05, massless=0.05)
    modes = tree_modes(tree, 6)
    most, least = count_bounds(tree, modes.frequency * (1 - 1e-12), modes.frequency * (1 + 1e-12))
    mode = np.arange(6) + modes.rigid
    assert np.all(most <= mode)
    assert np.all(least > mode)
    assert np.all(modes.upper < modes.lower * (1 + 1e-12))
    energy = tree.flexibility @ modes.torque**2
    np.testing.assert_allclose(energy, modes.frequency**2, rtol=1e-12)


def test_progress_is_told_after_every_mode():
    stated = []
    tree_modes(_uniform(3000), 5, progress=lambda done, wanted: stated.append((done, wanted)))
    assert stated == [(k, 5) for k in range(1, 6)]


def test_two_equal_halves_on_a_soft_span_are_left_to_the_tree():
    half = _row(2, 12)
    flexibility = np.concatenate([half.flexibility, [1e25], half.flexibility[:0:-1]])
    tree = Tree(
        np.arange(24) - 1,
        flexibility,
        np.concatenate([half.inertia, half.inertia[::-1]]),
        np.zeros(24, bool),
    )
    assert long_chain_modes(tree, 6) is None
    assert len(tree_modes(tree, 6).frequency) == 6


@pytest.mark.parametrize(
    ("parent", "held"),
    [
        ([-1, 0, 0, 0], ()),
        ([-1, 0, -1, 2], ()),
        ([-1, 0, 1, 1], ()),
        ([-1, 0, 0, 2], (0,)),
        ([-1, -1], ()),
    ],
)
def test_what_is_no_row_is_left_to_the_tree(parent, held):
    size = len(parent)
    tree = Tree(np.array(parent), np.ones(size), np.ones(size), np.isin(np.arange(size), held))
    assert long_chain_modes(tree, 2) is None


@pytest.mark.parametrize("held", [(), (0,)])
def test_a_row_without_elastic_modes_is_left_to_the_tree(held):
    tree = Tree(np.arange(4) - 1, np.zeros(4), np.ones(4), np.isin(np.arange(4), held))
    assert long_chain_modes(tree, 2) is None


def test_without_the_routines_the_tree_finds_the_same(monkeypatch):
    tree = _uniform(2000)
    with_them = tree_modes(tree, 3)
    monkeypatch.setattr(driver, "are_available", lambda: False)
    assert long_chain_modes(tree, 3) is None
    np.testing.assert_allclose(tree_modes(tree, 3).frequency, with_them.frequency, rtol=1e-13)


def test_units_far_out_of_range_are_refused():
    with pytest.raises(SolveError, match="check the units"):
        long_chain_modes(
            Tree(np.arange(3) - 1, np.full(3, 1e-200), np.full(3, 1e-150), np.zeros(3, bool)), 1
        )


def test_shapes_of_close_frequencies_are_orthogonal():
    size = 2000
    flexibility = np.ones(size)
    flexibility[size // 2] = 1e8
    tree = Tree(np.arange(size) - 1, flexibility, np.ones(size), np.zeros(size, bool))
    modes = long_chain_modes(tree, 9)
    close = np.diff(modes.frequency) < 1e-4 * modes.frequency[1:]
    assert np.count_nonzero(close) == 4
    np.testing.assert_allclose(modes.angle.T @ modes.angle, np.eye(9), atol=1e-14)
