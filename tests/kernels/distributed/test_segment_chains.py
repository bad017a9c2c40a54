"""Rows of springs and inertias condensed to their ends, against the dense elimination of what lies inside."""

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
    return whole[np.ix_(ends, ends)] - across @ np.linalg.solve(whole[np.ix_(inside, inside)], across.T)


@pytest.mark.parametrize("s", [0.0, 0.04, 0.9, 0.3 + 0.2j])
def test_a_row_is_at_its_ends_what_the_dense_elimination_leaves(rows, s):
    h, inner, outer = (values[:, 0] for values in rows.at(np.array([s])))
    for bar in range(rows.size):
        at_ends = _dense(rows.flexibility[bar], rows.inertia[bar], s)
        if rows.is_turned[bar]:
            at_ends = at_ends[::-1, ::-1]
        pi = np.array([[1 / h[bar] - s * inner[bar], -1 / h[bar]], [-1 / h[bar], 1 / h[bar] - s * outer[bar]]])
        np.testing.assert_allclose(pi, at_ends, rtol=1e-12, atol=1e-13)


def test_values_at_a_frequency_of_each_row_are_those_at_all_frequencies(rows):
    s = np.array([0.01, 0.2])
    each = rows.at(np.broadcast_to(s, (rows.size, 2)).copy())
    for one, other in zip(rows.at(s), each, strict=True):
        np.testing.assert_array_equal(one, other)


def test_slopes_are_the_derivatives_of_the_values(rows):
    """By a complex step, which cancels nothing."""
    s, step = np.array([0.0, 0.03, 0.1]), 1e-30
    slopes, moved = rows.slopes(s), rows.at(s + 1j * step)
    values = (slopes.flexibility, slopes.inner, slopes.outer)
    for value, slope, there in zip(
        values, (slopes.flexibility_slope, slopes.inner_slope, slopes.outer_slope), moved, strict=True
    ):
        np.testing.assert_allclose(value, there.real, rtol=1e-13)
        np.testing.assert_allclose(slope, there.imag / step, rtol=1e-11, atol=1e-13)


def test_no_frequency_of_a_row_with_fixed_ends_lies_below_the_limit(rows):
    lowest = np.inf
    for h, j in zip(rows.flexibility, rows.inertia, strict=True):
        k, mass = 1.0 / h[h > 0], j[j > 0]
        if mass.size:
            stiff = np.diag(k[:-1] + k[1:]) - np.diag(k[1:-1], 1) - np.diag(k[1:-1], -1)
            root = np.sqrt(mass)
            lowest = min(lowest, float(np.sqrt(np.linalg.eigvalsh(stiff / np.outer(root, root))[0])))
    assert 0.5 * lowest < rows.limit <= lowest
