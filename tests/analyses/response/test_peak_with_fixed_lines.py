"""The peak of a synthesis with lines of fixed frequency, whose magnitudes are added, under a mean torque."""

from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.response.synthesis import synthesis

A, B, FIXED = (
    1.0,
    2.0,
    0.5,
)  # N m; A cos t + B cos 2t has the greatest value A + B, the least -(B + A^2/(8 B))


@pytest.mark.parametrize("mean", [0.0, 7.0, -7.0])
def test_the_fixed_line_adds_to_the_peak_on_either_side_of_the_mean(mean):
    lines = (Line(Fraction(1), None, ()), Line(Fraction(2), None, ()), Line(None, 3.0, ()))
    torque, blank = np.array([[[A], [B], [FIXED * 1j]]]), np.zeros((1, 3))
    response = Response(
        np.ones(1),
        np.ones(1, dtype=bool),
        lines,
        blank,
        torque,
        torque,
        np.array([[mean]]),
        blank,
        blank.astype(np.uint8),
        blank,
        None,
    )
    found = synthesis(response)
    high, low = A + B, -(B + A**2 / (8.0 * B))
    assert found.peak[0, 0] == pytest.approx(
        max(abs(mean + high + FIXED), abs(mean + low - FIXED)), rel=1e-14
    )
    assert found.half_range[0, 0] == pytest.approx((high - low) / 2.0 + FIXED, rel=1e-14)
