"""A line of eight sections against an axisymmetric model of the whole, with consistent inertia."""

import numpy as np
import pytest
from benchmarks import steps_line


@pytest.mark.parametrize("fillet", [0.0, 0.005])  # m; without the inertia of fillets 1.9e-4
def test_junctions_bring_a_stepped_line_to_the_axisymmetric_one(fillet: float) -> None:
    whole = steps_line.axisymmetric(steps_line.line(fillet), fine=1e-5)
    errors = steps_line.one_dimensional(junctions=True, fillet=fillet) / whole - 1.0
    plain = steps_line.one_dimensional(junctions=False) / whole - 1.0
    assert np.all(np.abs(errors) <= 1e-4)
    assert np.all(plain > 1e-2)
