"""Modes of trains with shafts as continua, against closed forms and transfer matrices in many digits."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from torsion.errors import SolveError
from torsion.kernels.distributed.continuous_shafts import UniformShafts, uniform_shafts
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.modes.mode_shapes import TreeModes
from torsion.kernels.modes.natural_modes import count_below, tree_modes
from torsion.kernels.trees.tree import Tree


def _modes(tree: Tree, shafts: Shafts, count: int) -> TreeModes:
    return tree_modes(replace(tree, shafts=shafts), count)


def _part(modes: TreeModes, name: str) -> np.ndarray:
    return getattr(modes if hasattr(modes, name) else modes.shafts, name)


@pytest.mark.parametrize(("held", "shift"), [((), 0.0), ((0,), 0.5), ((0, 16), 0.0)])
def test_a_uniform_shaft_free_or_held_swings_in_sines(
    trains, held: tuple[int, ...], shift: float
) -> None:
    """And its torques are sines too, its energies halves of each other, its ends bare of torque."""
    train, bars = trains.chain(16, held=held), trains.pieces(2.0, 3.0, 5.0, 16)
    modes = _modes(train, bars, 10)
    number = np.arange(1, 11) - shift
    exact = [mp.pi * k / 2 * mp.sqrt(mp.mpf(3) / 5) for k in number]
    assert trains.off(modes.frequency, exact) < 4e-16
    assert modes.certified
    assert (modes.lower < exact).all()
    assert (modes.upper > exact).all()
    assert np.all(modes.upper - modes.lower < 1e-13 * modes.frequency)
    wave = np.sin if held else np.cos
    along = np.pi * number * np.linspace(0.0, 1.0, 17)[:, None]
    size = np.sqrt(2.0 / 10.0)
    sign = np.sign(np.sum(modes.angle * wave(along), axis=0))
    assert np.allclose(modes.angle, size * wave(along) * sign, rtol=0, atol=2e-14)
    slope = (np.cos(along) if held else -np.sin(along)) * size * np.pi * number / 2.0 * 3.0
    assert np.allclose(-modes.torque[1:], slope[:-1] * sign, rtol=0, atol=1e-13 * slope.max())
    assert np.allclose(
        -modes.shafts.torque_outer[1:], slope[1:] * sign, rtol=0, atol=1e-13 * slope.max()
    )
    if 16 not in held:
        assert not modes.shafts.torque_outer[-1].any()
    assert np.allclose(modes.shafts.kinetic.sum(axis=0), 1.0, rtol=1e-14)
    assert np.allclose(modes.shafts.elastic.sum(axis=0), 1.0, rtol=1e-14)
    if not held:
        assert modes.rigid == 1
        assert np.allclose(modes.rigid_angle, np.sqrt(1.0 / 10.0), rtol=1e-15)


def test_energies_of_each_piece_are_the_integrals_along_it(trains) -> None:
    modes = _modes(trains.chain(8), trains.pieces(1.0, 1.0, 1.0, 8), 4)
    for k in range(1, 5):
        ends = np.linspace(0.0, 1.0, 9)
        kinetic = np.diff(ends + np.sin(2 * np.pi * k * ends) / (2 * np.pi * k))
        elastic = np.diff(ends - np.sin(2 * np.pi * k * ends) / (2 * np.pi * k))
        assert np.allclose(modes.shafts.shaft_kinetic[:, k - 1], kinetic, atol=3e-15)
        assert np.allclose(modes.shafts.elastic[1:, k - 1], elastic, atol=3e-15)


def test_mode_500_of_a_shaft(trains) -> None:
    modes = _modes(trains.chain(640), trains.pieces(1.0, 1.0, 1.0, 640), 500)
    exact = [mp.pi * k for k in range(1, 501)]
    assert trains.off(modes.frequency, exact) < 1e-14
    assert (modes.lower <= exact).all()
    assert (modes.upper >= exact).all()


@pytest.mark.parametrize(
    ("first", "last", "published"),
    [
        (None, 1.0, [0.860333589019380, 3.42561845948173, 6.43729817917195, 9.52933440536196]),
        (1.0, 1.0, [1.30654237418881, 3.67319440630425, 6.58462004256417, 9.63168463569187]),
        (0.5, 2.0, [1.33850528549289, 3.76231286633799, 6.65035956592251, 9.68012641025234]),
    ],
)
def test_a_shaft_with_end_discs_has_the_roots_of_its_frequency_equation(
    trains, first, last, published
) -> None:
    """Discs a, c times the shaft: (b^2 a c - 1) sin b = b (a + c) cos b; with a fixed end (None) b tan b = 1."""
    discs = {12: last * 6.0} if first is None else {0: first * 6.0, 12: last * 6.0}
    modes = _modes(
        trains.chain(12, discs, (0,) if first is None else ()),
        trains.pieces(2.0, 12.0, 3.0, 12),
        len(published),
    )

    def equation(b):
        if first is None:
            return b * mp.sin(b) - mp.cos(b)
        return (b**2 * first * last - 1) * mp.sin(b) - b * (first + last) * mp.cos(b)

    exact = [trains.root_near(equation, b) for b in published]
    assert np.allclose(modes.frequency, published, rtol=2e-15 + 1e-14)
    assert trains.off(modes.frequency, exact) < 1e-15  # c/L = sqrt(12/3)/2 = 1


def test_a_drill_string_has_its_published_frequencies(trains) -> None:
    """Friswell et al. (2010) chapter 9: 800 m of 0.78 by 0.65 m, a top drive and a bottom-hole assembly at its ends."""
    area = mp.pi / 32 * (mp.mpf("0.78") ** 4 - mp.mpf("0.65") ** 4)
    rigidity, heavy = float(75e9 * area), float(8000 * area)
    modes = _modes(
        trains.chain(12, {0: 200.0, 12: 10.0}), trains.pieces(800.0, rigidity, heavy, 12), 6
    )
    assert np.allclose(
        modes.frequency / (2 * np.pi),
        [1.91033229, 3.82066476, 5.73099757, 7.64133089, 9.5516649, 11.46199977],
        rtol=3e-9,
    )
    line = [("disc", 200), ("shaft", 800, rigidity, heavy), ("disc", 10)]
    exact = [trains.root_near(lambda w: trains.line(line, w * w)[1, 0], w) for w in modes.frequency]
    assert trains.off(modes.frequency, exact) < 1e-15


STEPS = ((0.4, 2e6, 0.8), (0.9, 5e6, 2.0), (0.3, 1e6, 0.4), (0.7, 8e6, 3.2), (0.5, 4e5, 0.16))
DISCS = {0: 3.0, 2: 0.5, 5: 8.0}


def _stepped(trains, cut: int) -> tuple[Tree, Shafts, list]:
    """Five lengths, each in `cut` pieces, and three discs."""
    data = np.array(
        [(length / cut, rigidity, heavy) for length, rigidity, heavy in STEPS for _ in range(cut)]
    ).T
    train = trains.chain(5 * cut, {cut * place: value for place, value in DISCS.items()})
    parts: list = [("disc", DISCS[0])]
    for place, step in enumerate(STEPS, 1):
        parts += [("shaft", *step), *([("disc", DISCS[place])] if place in DISCS else [])]
    return train, Shafts(np.arange(1, 5 * cut + 1), (uniform_shafts(*data),)), parts


def test_a_stepped_shaft_with_three_discs_equals_its_transfer_matrix(trains) -> None:
    train, bars, parts = _stepped(trains, 3)
    modes = _modes(train, bars, 10)
    equation = lambda w: trains.line(parts, w * w)[1, 0]  # noqa: E731
    exact = [trains.root_near(equation, w) for w in modes.frequency]
    assert trains.off(modes.frequency, exact) < 1e-15
    assert trains.sign_changes(equation, float(exact[-1]) * 1.01, 400) == 10
    for mode, w in enumerate(exact[:4]):
        self_motion = _along(trains, parts, w)
        ratio = modes.angle[::3, mode] / modes.angle[0, mode]
        assert (
            trains.off(ratio[1:], [x for x, _, _ in self_motion]) < 2e-13
        )  # a mode's shape is this sensitive to w
        torque = [t for _, t, _ in self_motion], [t for _, _, t in self_motion]
        assert trains.off(modes.torque[1::3, mode] / modes.angle[0, mode], torque[0]) < 2e-13
        assert (
            trains.off(modes.shafts.torque_outer[3::3, mode] / modes.angle[0, mode], torque[1])
            < 2e-13
        )


def _along(trains, parts, w):
    """Angle at the outer end and torque at both ends of each length, in many digits; the first disc turns by 1."""
    state, found = mp.matrix([1, 0]), []
    for part in parts:
        before, state = state, trains.line([part], w * w) * state
        if part[0] == "shaft":
            found.append((state[0], before[1], state[1]))
    return found


def test_cutting_a_length_into_pieces_changes_nothing(trains) -> None:
    few, many = (_modes(*_stepped(trains, cut)[:2], 8) for cut in (3, 11))
    assert np.allclose(few.frequency, many.frequency, rtol=2e-15)
    assert np.allclose(few.angle[::3], many.angle[::11], rtol=1e-12, atol=1e-14)
    assert np.allclose(
        few.shafts.torque_outer[3::3], many.shafts.torque_outer[11::11], rtol=1e-11, atol=1e-9
    )


def test_a_cone_has_the_frequencies_of_its_elementary_solution(trains) -> None:
    """Free at both ends, diameter 1 to 0.5: with x = r b, T = 0 is tan x = 3 x/(3 - x^2) across, as in many digits."""
    modes = _modes(trains.chain(14), trains.tapered(lambda x: (1.0 - 0.5 * x) ** 4, 14), 10)

    def equation(w):
        def turn(z):
            return (3 / z**3 - 1 / z) * mp.sin(z) - 3 * mp.cos(z) / z**2, (
                -(3 / z**3 - 1 / z) * mp.cos(z) - 3 * mp.sin(z) / z**2
            )

        (a, b), (c, d) = turn(2 * w), turn(w)
        return a * d - b * c

    exact = [trains.root_near(equation, w) for w in modes.frequency]
    assert trains.off(modes.frequency, exact) < 1e-15
    assert trains.sign_changes(equation, float(exact[-1]) * 1.01, 200) == 10


@pytest.mark.parametrize("seed", range(5))
def test_a_train_of_very_unequal_pieces_keeps_its_digits(trains, seed: int) -> None:
    """Stiffnesses over twelve decades between discs over six."""
    rng = np.random.default_rng(seed)
    rigid = 10.0 ** rng.permutation(np.linspace(0, 12, 8))
    discs = {k: 10.0 ** rng.uniform(-3, 3) for k in range(0, 9, 2)}
    heavy, length = 1e-9 * 10.0 ** rng.uniform(-1, 1, 8), 10.0 ** rng.uniform(-2, 0, 8)
    bars = Shafts(np.arange(1, 9), (uniform_shafts(length, rigid, heavy),))
    train = trains.chain(8, discs)
    count = int(count_below(replace(train, shafts=bars), np.array([0.9 * bars.limit]))[0]) - 1
    modes = _modes(train, bars, count)
    parts = [("disc", discs[0])]
    for k in range(8):
        parts += [("shaft", length[k], rigid[k], heavy[k]), ("disc", discs.get(k + 1, 0.0))]
    exact = [
        trains.root_near(lambda w: trains.line(parts, w * w)[1, 0], w) for w in modes.frequency
    ]
    assert count >= 3
    assert modes.frequency[-1] > 1000 * modes.frequency[0]
    assert trains.off(modes.frequency, exact) < 1e-14


def test_a_bar_without_density_is_a_spring(random_tree) -> None:
    plain = random_tree(3, size=12)
    node = np.arange(1, 12)
    bars = Shafts(node, (uniform_shafts(np.ones(11), 1.0 / plain.flexibility[node], 0.0),))
    bare = Tree(plain.parent, np.zeros(12), plain.inertia, plain.held)
    one, other = tree_modes(plain), _modes(bare, bars, 99)
    assert np.allclose(one.frequency, other.frequency, rtol=2e-15)
    assert np.allclose(one.angle, other.angle, rtol=1e-11, atol=0)
    assert np.allclose(one.torque, other.torque, rtol=1e-11, atol=0)
    assert np.allclose(other.torque, other.shafts.torque_outer, rtol=4e-15, atol=0)


def _star(arms: int, cut: int, centre: float) -> tuple[Tree, Shafts]:
    """Equal shafts of length 1 on one hub, each in `cut` pieces."""
    parent = [-1] + [0 if k == 0 else arm * cut + k for arm in range(arms) for k in range(cut)]
    size = arms * cut + 1
    inertia = np.zeros(size)
    inertia[0] = centre
    law = uniform_shafts(np.full(size - 1, 1.0 / cut), 1.0, 1.0)
    return Tree(np.array(parent), np.zeros(size), inertia, np.zeros(size, bool)), Shafts(
        np.arange(1, size), (law,)
    )


def test_equal_branches_have_repeated_frequencies_with_orthogonal_shapes(trains) -> None:
    """Four equal shafts on a hub: each quarter-wave frequency occurs three times, the hub at rest in all of them."""
    train, bars = _star(4, 4, 2.0)
    modes = _modes(train, bars, 8)
    exact = sorted(
        [mp.pi / 2] * 3
        + [3 * mp.pi / 2] * 3
        + [trains.root_near(lambda w: 2 * w + 4 * mp.tan(w), w) for w in (2.4, 5.0)]
    )
    assert trains.off(modes.frequency, exact) < 1e-15
    quarter = [k for k in range(8) if abs(modes.frequency[k] / exact[0] - 1) < 1e-12]
    tips, hub = modes.angle[[4, 8, 12, 16]][:, quarter], modes.angle[0, quarter]
    assert np.abs(hub).max() < 1e-13
    assert np.allclose(
        tips.T @ tips, 2.0 * np.eye(3), atol=1e-13
    )  # the inertia of sin^2 over a length 1 is a half
    root = modes.torque[[1, 5, 9, 13]][:, quarter]
    assert np.allclose(np.abs(root), np.abs(tips) * np.pi / 2, atol=1e-12)
    assert np.allclose(modes.shafts.kinetic.sum(axis=0), 1.0, rtol=1e-13)


def test_repeated_shapes_of_stepped_branches_are_those_of_one_branch_by_itself(trains) -> None:
    """Three equal arms of two unlike lengths on a hub that stays at rest; both ends' torques, not the angles alone."""
    arm = uniform_shafts([0.4, 0.8], [1.0, 3.0], [2.0, 0.3])
    alone = _modes(trains.chain(2, {2: 0.2}, (0,)), Shafts(np.array([1, 2]), (arm,)), 1)
    arms = uniform_shafts(np.tile([0.4, 0.8], 3), np.tile([1.0, 3.0], 3), np.tile([2.0, 0.3], 3))
    inertia = np.array([5.0, 0, 0.2, 0, 0.2, 0, 0.2])
    train = Tree(np.array([-1, 0, 1, 0, 3, 0, 5]), np.zeros(7), inertia, np.zeros(7, bool))
    modes = _modes(train, Shafts(np.arange(1, 7), (arms,)), 3)
    pair = [k for k in range(3) if abs(modes.frequency[k] / alone.frequency[0] - 1) < 1e-13]
    assert len(pair) == 2
    for name in ("angle", "torque", "torque_outer"):
        one = _part(alone, name)[1:, 0]
        scale = modes.angle[[2, 4, 6]][:, pair] / alone.angle[2, 0]
        expected = np.einsum("am,s->asm", scale, one).reshape(6, 2)
        assert np.allclose(
            _part(modes, name)[1:, pair], expected, rtol=0, atol=1e-13 * np.abs(one).max()
        ), name
    assert np.allclose(modes.shafts.kinetic[:, pair].sum(axis=0), 1.0, rtol=1e-13)


def test_close_frequencies_keep_orthogonal_shapes(trains) -> None:
    """Two equal shafts tied by a soft spring: symmetric and antisymmetric, halves of the energy in each shaft."""
    cut = 6
    parent = np.array([-1, *range(cut), 0, *range(cut + 1, 2 * cut + 1)])
    size = 2 * cut + 2
    flexibility = np.zeros(size)
    flexibility[cut + 1] = 1e9
    train = Tree(parent, flexibility, np.zeros(size), np.zeros(size, bool))
    node = np.array([*range(1, cut + 1), *range(cut + 2, size)])
    bars = Shafts(node, (uniform_shafts(np.full(2 * cut, 1.0 / cut), 1.0, 1.0),))
    modes = _modes(train, bars, 5)
    half = modes.shafts.shaft_kinetic[:cut].sum(axis=0)
    assert np.allclose(half[1:], 0.5, atol=1e-6) or np.allclose(half, 0.5, atol=1e-6)
    ends = modes.angle[[0, cut + 1]]
    for k in (1, 3):
        product = ends[0, k] * ends[0, k + 1] + ends[1, k] * ends[1, k + 1]
        assert abs(product) < 1e-13 * np.abs(ends[:, k]).max() ** 2


def test_rigid_spans_held_stations_and_massless_ones_need_no_care(trains) -> None:
    """A rigid span between two shafts, and one to a fixed wall, are as if they were not there."""
    parent, flexibility = np.arange(-1, 7), np.array([0, 0, 0, 0, 0, 0, 0, 0.0])
    node = np.array([2, 3, 5, 6, 7])  # 0 fixed, 1 rigidly on it, 4 rigidly on 3
    bars = Shafts(node, (uniform_shafts(np.full(5, 0.2), 1.0, 1.0),))
    train = Tree(parent, flexibility, np.zeros(8), np.arange(8) == 0)
    modes = _modes(train, bars, 3)
    assert trains.off(modes.frequency, [mp.pi / 2, 3 * mp.pi / 2, 5 * mp.pi / 2]) < 1e-15
    assert modes.rigid == 0
    size = np.sqrt(2.0) * np.array([0.5, 1.5, 2.5]) * np.pi
    assert np.allclose(np.abs(modes.torque[1]), size, rtol=1e-13)
    assert np.allclose(modes.torque[4], modes.shafts.torque_outer[3], rtol=1e-12)
    assert not modes.angle[:2].any()


def test_two_separate_trains_have_two_rigid_motions_and_all_modes_of_both(trains) -> None:
    parent = np.array([-1, 0, 1, 2, -1, 4, 5, 6])
    node = np.array([1, 2, 3, 5, 6, 7])
    bars = Shafts(node, (uniform_shafts(np.repeat([1 / 3, 0.5 / 3], 3), 1.0, 1.0),))
    modes = _modes(Tree(parent, np.zeros(8), np.zeros(8), np.zeros(8, bool)), bars, 3)
    assert modes.rigid == 2
    assert trains.off(modes.frequency, [mp.pi, 2 * mp.pi, 2 * mp.pi]) < 1e-15
    assert np.allclose(np.abs(modes.rigid_angle.max(axis=0)), [1.0, np.sqrt(2.0)], rtol=1e-15)
    products = modes.angle.T @ np.diag([1, 2, 2, 1, 1, 2, 2, 1]) @ modes.angle
    assert abs(products[1, 2]) < 1e-13


def test_counts_step_at_every_frequency_and_their_bounds_on_either_side(trains) -> None:
    train = replace(trains.chain(20), shafts=trains.pieces(1.0, 1.0, 1.0, 20))
    exact = np.pi * np.arange(1, 16)
    assert np.array_equal(count_below(train, exact * (1 + 1e-13)), np.arange(2, 17))
    assert np.array_equal(count_below(train, exact * (1 - 1e-13)), np.arange(1, 16))
    near = exact * (1.0 + 2.0**-52)
    at_most, at_least = (count_below(train, near, bound=side) for side in (1, -1))
    assert np.all(at_most >= np.arange(2, 17))
    assert np.all(at_least <= np.arange(1, 16) + 1)
    assert np.all(at_least < at_most)


def _random_train(random_tree, seed: int, held: str) -> tuple[Tree, Shafts]:
    """Shafts, springs, rigid spans and massless stations in a tree, stiffnesses over eight decades."""
    rng = np.random.default_rng(seed)
    plain = random_tree(seed, size=14, held=held)
    inertia = np.where(rng.random(14) < 0.5, 0.0, plain.inertia)
    kind = rng.integers(0, 4, 14)
    flexibility = np.where((kind == 0) & ~plain.held, 0.0, 10.0 ** -rng.uniform(0, 8, 14))
    node = np.array([i for i in range(1, 14) if kind[i] > 1])
    law = uniform_shafts(
        rng.uniform(0.1, 1.0, len(node)),
        10.0 ** rng.uniform(0, 8, len(node)),
        10.0 ** rng.uniform(-6, -2),
    )
    flexibility[node] = 0.0
    return Tree(plain.parent, flexibility, inertia, plain.held), Shafts(node, (law,))


def _exact_count(train: Tree, bars: Shafts, w) -> int:
    """Frequencies below w, from the pivots of the elimination in many digits; below the limit of every shaft."""
    s, law, of = mp.mpf(float(w)) ** 2, bars.laws[0], {int(i): k for k, i in enumerate(bars.node)}
    h = [mp.mpf(float(v)) for v in train.flexibility]
    own = [mp.mpf(float(j)) for j in train.inertia]
    for i, k in of.items():
        mu = mp.sqrt(mp.mpf(float(law.flexibility[k])) * 2 * mp.mpf(float(law.half[k])) * s)
        h[i] = mp.mpf(float(law.flexibility[k])) * mp.sin(mu) / mu
        for end in (i, int(train.parent[i])):
            own[end] += mp.mpf(float(law.half[k])) * mp.tan(mu / 2) / (mu / 2)
    seen, count = [mp.inf if held else -s * j for held, j in zip(train.held, own, strict=True)], 0
    for i in range(train.size - 1, -1, -1):
        count += seen[i] < 0
        if train.parent[i] >= 0:
            inverse = mp.mpf(0) if mp.isinf(seen[i]) else (mp.inf if seen[i] == 0 else 1 / seen[i])
            pivot = h[i] + inverse
            count -= pivot < 0
            passed = mp.mpf(0) if mp.isinf(pivot) else (mp.inf if pivot == 0 else 1 / pivot)
            seen[int(train.parent[i])] += passed
    return int(count)


@pytest.mark.parametrize("held", ["none", "root", "leaves"])
@pytest.mark.parametrize("seed", range(8))
def test_counts_in_many_digits_confirm_every_enclosure(random_tree, seed: int, held: str) -> None:
    train, bars = _random_train(random_tree, seed, held)
    whole = replace(train, shafts=bars)
    count = int(count_below(whole, np.array([0.9 * bars.limit]))[0])
    rigid = _modes(train, bars, 0).rigid
    modes = _modes(train, bars, count - rigid)
    assert np.all(modes.upper - modes.lower < 3e-13 * modes.frequency)
    for k, (low, high) in enumerate(zip(modes.lower, modes.upper, strict=True)):
        assert _exact_count(train, bars, low) <= rigid + k < _exact_count(train, bars, high)
    if count > rigid:
        assert np.allclose(modes.shafts.kinetic.sum(axis=0), 1.0, rtol=1e-12)
        assert np.allclose(modes.shafts.elastic.sum(axis=0), 1.0, rtol=1e-10)


def test_modes_above_what_the_pieces_resolve_are_refused(trains) -> None:
    train, bars = trains.chain(4), trains.pieces(1.0, 1.0, 1.0, 4)
    assert len(_modes(train, bars, 3).frequency) == 3
    with pytest.raises(
        SolveError, match=r"only 3 of the requested .* divide the shafts more finely"
    ):
        _modes(train, bars, 4)


def test_no_mode_asked_for_is_none_given(trains) -> None:
    modes = _modes(trains.chain(4), trains.pieces(1.0, 1.0, 1.0, 4), 0)
    assert modes.frequency.shape == (0,)
    assert modes.angle.shape == (5, 0)
    assert modes.rigid == 1


class _Rough(UniformShafts):
    """A law that is wrong by nearly as much as it says."""

    def at(self, square):
        flexibility, inner, outer = super().at(square)
        return flexibility * (1.0 - 0.9e-6), inner * (1.0 - 0.9e-6), outer * (1.0 - 0.9e-6)

    def rounding(self, square):
        return np.full(len(square), 1e-6)


@pytest.mark.parametrize(("pieces", "rough"), [(256, False), (16, False), (16, True)])
def test_a_bound_of_counts_outweighs_the_stiffness_passed_on_and_the_rounding_of_the_law(
    pieces: int, rough: bool
):
    """Of a free shaft the frequencies are j pi exactly, for powers of 2 are exact."""
    law = (_Rough if rough else UniformShafts)(
        *(np.full(pieces, v) for v in (1 / pieces, 0.5 / pieces, pieces**-2.0))
    )
    tree = Tree(
        np.arange(-1, pieces),
        np.zeros(pieces + 1),
        np.zeros(pieces + 1),
        np.zeros(pieces + 1, bool),
    )
    exact = [mp.pi * j for j in range(1, 6)]
    near = np.array([[float(w) * (1.0 + k * 2.0**-52) for k in range(-6, 7)] for w in exact])
    below = np.array(
        [[1 + sum(w < mp.mpf(x) for w in exact) for x in row] for row in near.tolist()]
    )
    train = replace(tree, shafts=Shafts(np.arange(1, pieces + 1), (law,)))
    at_most, at_least = (count_below(train, near.ravel(), bound=side) for side in (1, -1))
    assert np.all(at_most.reshape(below.shape) >= below)
    assert np.all(at_least.reshape(below.shape) <= below)


def test_a_shaft_between_fixed_stations_leaves_the_rest_of_the_train_alone() -> None:
    """Station 1 is rigid on the fixed root, 2 is fixed as well: a disc of 4 on a spring of 1/100 from 1 goes at 5."""
    law = uniform_shafts([0.1], 1e4, 2.0)
    held = np.array([True, False, True, False])
    tree = Tree(np.array([-1, 0, 1, 1]), np.array([0, 0, 0, 0.01]), np.array([0, 0, 0, 4.0]), held)
    modes = tree_modes(replace(tree, shafts=Shafts(np.array([2]), (law,))), 1)
    assert abs(modes.frequency[0] / 5.0 - 1.0) < 1e-15
    assert np.allclose(modes.torque[3], -100.0 * modes.angle[3], rtol=1e-14)
    assert np.allclose(modes.shafts.torque_outer[1], modes.torque[3], rtol=1e-14)
