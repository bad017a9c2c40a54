"""Rows of springs and inertias condensed to their ends, against the dense elimination of what lies inside."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.distributed.segment_chains import SegmentChains

SEGMENTS = 7


@pytest.fixture
def rows() -> SegmentChains:
    """Four rows, the third shorter and the fourth a single spring; the second is given from its outer end."""
    rng = np.random.default_rng(3)
    h, j = rng.uniform(0.5, 2.0, (2, 4, SEGMENTS))
    j[:, -1] = 0.0
    h[2, 4:], j[2, 3:] = 0.0, 0.0
    h[3, 1:], j[3] = 0.0, 0.0
    return SegmentChains(h, j, np.array([False, True, False, False]))


def _dense(flexibility: np.ndarray, inertia: np.ndarray, s: complex) -> np.ndarray:
    """(2, 2) dynamic stiffness at both ends of a row, by elimination of all inside at once."""
    k = 1.0 / flexibility[flexibility > 0]
    size = len(k) + 1
    whole = np.zeros((size, size), dtype=complex)
    for at, stiffness in enumerate(k):
        whole[at : at + 2, at : at + 2] += stiffness * np.array([[1, -1], [-1, 1]])
    inside = np.arange(1, size - 1)
    whole[inside, inside] -= s * inertia[: size - 2]
    ends = [0, size - 1]
    if not inside.size:
        return whole
    across = whole[np.ix_(ends, inside)]
    return whole[np.ix_(ends, ends)] - across @ np.linalg.solve(
        whole[np.ix_(inside, inside)], across.T
    )


@pytest.mark.parametrize("s", [0.0, 0.04, 0.9, 0.3 + 0.2j])
def test_a_row_is_at_its_ends_what_the_dense_elimination_leaves(rows, s):
    h, inner, outer = (values[:, 0] for values in rows.at(np.array([s])))
    for bar in range(rows.size):
        at_ends = _dense(rows.flexibility[bar], rows.inertia[bar], s)
        if rows.is_turned[bar]:
            at_ends = at_ends[::-1, ::-1]
        pi = np.array(
            [[1 / h[bar] - s * inner[bar], -1 / h[bar]], [-1 / h[bar], 1 / h[bar] - s * outer[bar]]]
        )
        np.testing.assert_allclose(pi, at_ends, rtol=1e-12, atol=1e-13)


def test_values_at_a_frequency_of_each_row_are_those_at_all_frequencies(rows):
    s = np.array([0.01, 0.2])
    each = rows.at(np.broadcast_to(s, (rows.size, 2)).copy())
    for one, other in zip(rows.at(s), each, strict=True):
        np.testing.assert_array_equal(one, other)


def _pi_in_many_digits(
    flexibility: np.ndarray, inertia: np.ndarray, s: mp.mpf
) -> tuple[mp.mpf, ...]:
    """Flexibility and end inertias of a row, by transfer matrices: angle and torque from the outer to the inner end."""
    across = mp.eye(2)
    for h, j in zip(flexibility.tolist(), inertia.tolist(), strict=True):
        across = mp.matrix([[1, 0], [-s * j, 1]]) * mp.matrix([[1, h], [0, 1]]) * across
    return (
        across[0, 1],
        (1 - across[0, 0]) / (s * across[0, 1]),
        (1 - across[1, 1]) / (s * across[0, 1]),
    )


@pytest.mark.parametrize("s", [0.001, 0.03, 0.1])
def test_slopes_are_the_derivatives_of_the_values(rows, s):
    """Differences in many digits."""
    found = vars(rows.slopes(np.array([s])))
    values, slopes = (
        [found[name + end][:, 0] for name in ("flexibility", "inner", "outer")]
        for end in ("", "_slope")
    )
    for row in range(rows.size):
        at, step = mp.mpf(s), mp.mpf(10) ** -20
        here, high, low = (
            _pi_in_many_digits(rows.flexibility[row], rows.inertia[row], at + d)
            for d in (0, step, -step)
        )
        order = (0, 2, 1) if rows.is_turned[row] else (0, 1, 2)
        for k, end in enumerate(order):
            derivative = float((high[end] - low[end]) / (2 * step))
            assert values[k][row] == pytest.approx(float(here[end]), rel=1e-13)
            assert slopes[k][row] == pytest.approx(derivative, rel=1e-12, abs=1e-15)


def test_no_frequency_of_a_row_with_fixed_ends_lies_below_the_limit(rows):
    lowest = np.inf
    for h, j in zip(rows.flexibility, rows.inertia, strict=True):
        k, mass = 1.0 / h[h > 0], j[j > 0]
        if mass.size:
            stiff = np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
            root = np.sqrt(mass)
            lowest = min(
                lowest, float(np.sqrt(np.linalg.eigvalsh(stiff / np.outer(root, root))[0]))
            )
    assert 0.5 * lowest < rows.limit <= lowest
