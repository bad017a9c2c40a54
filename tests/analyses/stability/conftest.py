"""The equations of motion in time, for an integrator that knows nothing of harmonics."""

from collections.abc import Callable

import numpy as np
import pytest

from torsion.analyses.stability.equations_of_motion import Loading, state
from torsion.analyses.stability.mechanism import Layout, gathered
from torsion.kernels.periodic.harmonic_balance import Motion

Slope = Callable[[float, np.ndarray], np.ndarray]


@pytest.fixture(scope="session")
def in_time() -> Callable[[Layout, Loading, np.ndarray], Slope]:
    """Of a mechanism under a load: d/dt of (deviations, speeds of deviation) of the free coordinates at a time, s."""

    def equations(layout: Layout, loading: Loading, load: np.ndarray) -> Slope:
        free = layout.free
        assert not layout.hysteretic.any(), "a loss factor acts on harmonics only"

        def slope(t: float, y: np.ndarray) -> np.ndarray:
            column = y[:, None]
            motion = Motion(column[:free], column[free:], np.zeros((free, 1)))
            now = state(layout, loading, motion, load, np.array([loading.speed * t]))
            first = now.turning.first
            mass = gathered(layout, layout.inertia[:, None] * first**2)[:, 0]
            return np.concatenate([y[free:], -gathered(layout, first * now.residual)[:, 0] / mass])

        return slope

    return equations
