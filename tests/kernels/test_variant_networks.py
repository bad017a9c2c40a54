"""Many trains with closed loops: each as one train by itself, and rings in closed form."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from benchmarks.cases import chain
from hypothesis import given, settings
from hypothesis import strategies as st

from torsion.kernels.modes import variant_networks
from torsion.kernels.modes.loops import graph_modes
from torsion.kernels.modes.network_counts import Elimination, Network, modal_way, network_count
from torsion.kernels.modes.variant_modes import ritz_values
from torsion.kernels.modes.variant_networks import counted_modes, network_modes
from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import pairs


@settings(max_examples=30, deadline=None)
@given(
    st.integers(3, 18),
    st.integers(1, 2),
    st.booleans(),
    st.booleans(),
    st.floats(0.0, 0.6),
    st.integers(0, 2**32 - 1),
)
def test_random_trains_with_loops_are_those_by_themselves(
    size: int, loops: int, is_stiff: bool, is_held: bool, spread: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    parent, held = (
        np.array([-1, *(int(rng.integers(0, k)) for k in range(1, size))]),
        np.zeros(size, dtype=bool),
    )
    held[0], wide = is_held, 5.0 if is_stiff else 0.5
    h, j, c = (10.0 ** rng.uniform(-wide, wide, (rows, 1)) for rows in (size, size, loops))
    h, j, c = (middle * np.exp(spread * rng.normal(size=(len(middle), 5))) for middle in (h, j, c))
    ends = tuple(np.array([rng.choice(size, 2, replace=False) for _ in range(loops)]).T)
    tree, count = Tree(parent, np.zeros(size), np.zeros(size), held), min(4, size - 1)
    found = network_modes(tree, h, j, count, ends, c)
    for k in range(5):
        own = replace(tree, flexibility=h[:, k], inertia=j[:, k])
        alone = graph_modes(own, *ends, c[:, k], count)
        assert found.frequency[:, k] == pytest.approx(alone.frequency, rel=2e-13)
        assert (found.lower[:, k] <= alone.upper).all()  # both enclose the same
        assert (alone.lower <= found.upper[:, k]).all()


@pytest.mark.parametrize("row", [0, 1])
def test_a_train_far_from_the_others_is_solved_by_itself(row: int) -> None:
    """Its energies in their modes are rounding: there is nothing to begin with."""
    values = np.ones((2, 6, 4))
    values[row, 3] = [1e-20, 1e-6, 1e6, 1e20]
    tree = Tree(np.arange(-1, 5), np.zeros(6), np.zeros(6), np.zeros(6, dtype=bool))
    ends = np.array([1]), np.array([4])
    found = network_modes(tree, *values, 4, ends, np.ones((1, 4)))
    assert found.alone > 0
    for k in range(4):
        own = replace(tree, flexibility=values[0, :, k], inertia=values[1, :, k])
        alone = graph_modes(own, *ends, np.ones(1), 4)
        assert found.frequency[:, k] == pytest.approx(alone.frequency, rel=2e-13)


def test_counts_say_which_mode_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """A start at another mode is not taken: its train is solved by itself."""
    rng = np.random.default_rng(2)
    tree = Tree(np.arange(-1, 7), np.zeros(8), np.zeros(8), np.zeros(8, dtype=bool))
    h, j, c = (rng.uniform(0.8, 1.2, (rows, 10)) for rows in (8, 8, 1))
    ends = np.array([1]), np.array([6])
    right = network_modes(tree, h, j, 3, ends, c)
    assert right.alone == 0
    monkeypatch.setattr(variant_networks, "ritz_values", lambda *given: 1.9 * ritz_values(*given))
    again = network_modes(tree, h, j, 3, ends, c)
    assert again.alone > 0
    assert again.frequency == pytest.approx(right.frequency, rel=1e-14)


def _chains(size: int, loops: int, trains: int) -> tuple:
    """Layout, flexibilities, inertias, ends of chords and their flexibilities of the trains of `benchmarks.sweeps`."""
    case, rng = chain(size, stiff=False), np.random.default_rng(1)
    j = np.array(case.inertia)[:, None] * rng.uniform(0.95, 1.05, (size, trains))
    soft = 1.0 / rng.uniform(0.85, 1.15, (size + loops, trains))
    h = np.concatenate([0 * j[:1], soft[1:size] / np.array(case.stiffness)[1:, None]])
    tree = Tree(np.arange(-1, size - 1), *np.zeros((2, size)), np.zeros(size, dtype=bool))
    ends = np.array([1, 0][:loops]), np.array([size - 2, size - 1][:loops])
    return tree, h, j, ends, soft[size:] / min(case.stiffness[1:])


def test_frequencies_beside_a_pole_of_what_the_root_sees_settle() -> None:
    tree, h, j, ends, c = _chains(10, 1, 400)
    found = network_modes(tree, h, j, 6, ends, c)
    alone = graph_modes(replace(tree, flexibility=h[:, 23], inertia=j[:, 23]), *ends, c[:, 23], 6)
    assert found.frequency[:, 23] == pytest.approx(alone.frequency, rel=4e-15)


def test_loops_through_fixed_rigid_and_massless_stations() -> None:
    parent, ones = np.array([-1, 0, 1, 2]), np.ones(20)
    tree = Tree(parent, np.zeros(4), np.zeros(4), np.array([True, False, False, False]))
    k = np.linspace(0.5, 2.0, 20)
    h, j = np.stack([0 * k, 1 / k, 0 * k, ones]), np.stack([ones, ones, k, 0 * k])
    found = network_modes(
        tree, h, j, 1, (np.array([0, 1]), np.array([2, 3])), np.stack([ones, 1 / k])
    )
    assert found.frequency[0] == pytest.approx(
        np.sqrt((k + 1.0) / (1.0 + k)), rel=4e-15
    )  # one body on both springs
    with pytest.raises(ValueError, match="positive flexibility"):
        network_modes(tree, h, j, 1, (np.array([0]), np.array([2])), 0.0 * ones[None])
    with pytest.raises(ValueError, match="1 elastic modes, not 2"):
        network_modes(tree, h, j, 2, (np.array([1]), np.array([3])), ones[None])


def test_rings_have_their_pairs_of_equal_frequencies() -> None:
    stiff, size = np.array([0.25, 1.0, 3.0]), 6
    tree = Tree(np.arange(-1, size - 1), np.zeros(size), np.zeros(size), np.zeros(size, dtype=bool))
    h = np.repeat(1 / stiff[None], size, axis=0)
    found = network_modes(
        tree, h, np.ones((size, 3)), size - 1, (np.array([0]), np.array([size - 1])), h[:1]
    )
    exact = np.sort(2 * np.sin(np.pi * np.arange(1, size) / size))[:, None] * np.sqrt(stiff)
    assert found.frequency == pytest.approx(exact, rel=4e-15)


def _below(tree: Tree, ends: tuple[np.ndarray, ...], chord: np.ndarray, w: float) -> int:
    """Frequencies below `w` in exact rational numbers: negative pivots of K - w^2 J."""
    free, square = np.flatnonzero(~tree.held).tolist(), Fraction(float(w)) ** 2
    matrix = [[Fraction(0)] * tree.size for _ in range(tree.size)]
    spans = [
        (tree.parent[i], i, tree.flexibility[i]) for i in range(tree.size) if tree.parent[i] >= 0
    ]
    for a, b, h in [*spans, *zip(*ends, chord, strict=True)]:
        for one, other, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            matrix[one][other] += sign / Fraction(float(h))
    for i in free:
        matrix[i][i] -= square * Fraction(float(tree.inertia[i]))
    negative = 0
    for k, i in enumerate(free):
        negative += matrix[i][i] < 0
        for row in free[k + 1 :]:
            share = matrix[row][i] / matrix[i][i]
            for column in free[k + 1 :]:
                matrix[row][column] -= share * matrix[i][column]
    return negative


def _nasty(kind: str, rng: np.random.Generator) -> tuple[Tree, tuple[np.ndarray, ...], np.ndarray]:
    size, loops, wide = (
        int(rng.integers(3, 7)),
        int(rng.integers(1, 4)),
        6.0 if kind == "stiff" else 0.3,
    )
    parent, held = (
        np.array([-1, *(int(rng.integers(0, k)) for k in range(1, size))]),
        np.zeros(size, dtype=bool),
    )
    held[0] = kind != "arms" and rng.random() < 0.3
    h, j, c = (10.0 ** rng.uniform(-wide, wide, rows) for rows in (size, size, loops))
    ends = tuple(np.array([rng.choice(size, 2, replace=False) for _ in range(loops)]).T)
    if kind == "loose":
        c *= 10.0 ** rng.uniform(3, 12, loops)
    if kind == "massless":
        j[rng.integers(1, size)] = 0.0
    if (
        kind == "arms"
    ):  # two alike, with a chord from end to end: modes with and without its torque, close together
        parent, ends, c = (
            np.array([-1, 0, 1, 0, 3]),
            (np.array([2]), np.array([4])),
            10.0 ** rng.uniform(0, 6, 1),
        )
        held, h, j = np.zeros(5, dtype=bool), h[[0, 1, 2, 1, 2]], j[[0, 1, 2, 1, 2]]
        h = h * (1.0 + rng.choice([0.0, 1e-12, 1e-6]) * rng.normal(size=5))
    return Tree(parent, h, j, held), ends, c


@pytest.mark.parametrize("kind", ["random", "stiff", "loose", "massless", "arms"])
def test_certified_bounds_hold_one_more_mode_in_exact_counts(kind: str) -> None:
    rng, certified = np.random.default_rng(5), 0
    for _ in range(25):
        tree, ends, c = _nasty(kind, rng)
        found = counted_modes(tree, *ends, c)
        certified += found.certified
        for mode, (low, high) in enumerate(
            zip(found.lower, found.upper, strict=True) if found.certified else ()
        ):
            assert _below(tree, ends, c, low) <= mode + found.rigid < _below(tree, ends, c, high)
    assert certified >= 15


@pytest.mark.parametrize("kind", ["random", "loose", "massless", "arms"])
def test_counts_of_either_way_err_only_on_their_side(kind: str) -> None:
    """A few roundings from a frequency, and toward any root: never less with +1, never more with -1 than exact."""
    rng = np.random.default_rng(8)
    for _ in range(25):
        tree, ends, c = _nasty(kind, rng)
        modes = graph_modes(tree, *ends, c)
        count = len(modes.frequency)
        h, j, chord = (
            np.repeat(one[:, None], count, axis=1) for one in (tree.flexibility, tree.inertia, c)
        )
        many = Network(replace(tree, flexibility=h, inertia=j), pairs(tree.size, *ends), chord)
        torn, _, _ = variant_networks._torn(many, tree, ends, modes, count)
        if not len(torn.chord) or not count:
            continue
        square = float(modes.frequency.max()) ** 2
        static = variant_networks._way(
            torn, int(rng.choice(np.flatnonzero(~torn.tree.held))), square
        )
        modal, _ = modal_way(static, modes.frequency**2)
        w = modes.frequency * (
            1.0 + rng.choice([-1, 1], count) * 2.0 ** rng.uniform(-52, -38, count)
        )
        exact = np.array([_below(tree, ends, c, one) for one in w])
        for way in (static, modal):
            assert (network_count(way, w, bound=1) >= exact).all()
            assert (network_count(way, w, bound=-1) <= exact).all()


@pytest.mark.parametrize(("size", "loops", "count"), [(6, 1, 4), (10, 2, 6), (20, 1, 6)])
def test_no_train_beside_a_resonance_of_its_torn_tree_is_solved_by_itself(
    size: int, loops: int, count: int
) -> None:
    tree, h, j, ends, c = _chains(size, loops, 400)
    found = network_modes(tree, h, j, count, ends, c)
    assert found.alone <= 0.01 * found.frequency.size
    assert ((found.upper - found.lower) / found.frequency).max() < 4e-12


def test_counts_beside_a_resonance_of_the_torn_tree_err_only_on_their_side() -> None:
    """Where the loads of chords grow a thousandfold in the elimination, and with them their roundings."""
    tree, h, j, ends, c = _chains(10, 1, 2000)
    frequency, below = network_modes(tree, h, j, 1, ends, c).frequency[0], 0
    many = Network(replace(tree, flexibility=h, inertia=j), pairs(10, *ends), c)
    first = replace(tree, flexibility=h[:, 0], inertia=j[:, 0])
    torn, _, _ = variant_networks._torn(many, first, ends, graph_modes(first, *ends, c[:, 0]), 1)
    static = variant_networks._way(torn, 9, float(frequency.mean()) ** 2)
    with np.errstate(all="ignore"):
        grown = np.abs(Elimination(static, frequency**2).load[0]).max(axis=0)
    some = np.argsort(grown)[-12:]
    static, rng = static.columns(some), np.random.default_rng(4)
    modal, _ = modal_way(static, frequency[some] ** 2)
    for exponent in (-51, -48, -45, -43, -41):
        w = frequency[some] * (1.0 + rng.choice([-1, 1], len(some)) * 2.0**exponent)
        exact = [
            _below(replace(tree, flexibility=h[:, k], inertia=j[:, k]), ends, c[:, k], one)
            for k, one in zip(some, w, strict=True)
        ]
        for way in (static, modal):
            assert (network_count(way, w, bound=1) >= exact).all()
            assert (network_count(way, w, bound=-1) <= exact).all()
            below += int((network_count(way, w, bound=1) == network_count(way, w, bound=-1)).sum())
    assert below >= 10  # some are sure


@pytest.mark.parametrize(("loops", "most"), [(20, 20), (45, 20), (46, 0), (100, 0)])
def test_counts_of_a_train_with_many_loops_are_few(
    loops: int, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each takes the square of the loops a station; beyond 45 their rounding hides what they should prove."""
    counts = []

    def counted(*given, **side):
        counts.append(given)
        return network_count(*given, **side)

    monkeypatch.setattr(variant_networks, "network_count", counted)
    size = loops + 1
    tree = Tree(
        np.arange(size) - 1,
        1e-5 / (1.0 + 0.03 * np.arange(size)),
        np.ones(size),
        np.zeros(size, dtype=bool),
    )
    ends = np.arange(loops), np.arange(1, size)
    found = counted_modes(tree, *ends, np.full(loops, 2e-5), 6)
    assert len(counts) <= most
    assert not found.certified
    assert ((found.lower < found.frequency) & (found.frequency < found.upper)).all()


def test_a_ring_with_a_node_at_its_chord_is_certified() -> None:
    """Beside a node a step to Rayleigh's quotient leaves its mode: then counts begin from where the mode was."""
    behind, held = np.array([-1, 0, 1]), np.zeros(3, dtype=bool)
    flexibility, inertia = 1.0 / np.array([np.inf, 2000.0, 1000.0]), np.array([3.0, 1.0, 2.0])
    ring = Tree(behind, flexibility, inertia, held)
    found = counted_modes(ring, np.array([0]), np.array([2]), np.array([1.0 / 4000.0]))
    stiffness = np.array([[6000.0, -2000, -4000], [-2000, 3000, -1000], [-4000, -1000, 5000]])
    root = np.sqrt(inertia)
    squares = np.linalg.eigvalsh(stiffness / root / root[:, None])[1:]
    assert found.certified
    np.testing.assert_allclose(found.frequency**2, squares, rtol=1e-13)
