"""What a march samples by one matrix, against the motion at the same times and its derivatives."""

import math

import numpy as np
import pytest

from torsion.kernels.motion.linear_regime import Regime, regime_of
from torsion.kernels.motion.loaded_modes import POINTS, LoadedModes, ModalTrain, Piece, Start
from torsion.kernels.motion.piecewise_elements import Clearance, Friction
from torsion.kernels.motion.sampled_rows import ROWS, features, sample

LENGTH = 4e-3
TIMES = LENGTH * np.array([0.0, 0.13, 0.5, 0.81, 1.0])
# A capacity and a torque, each a ramp times an exponential, and one that has both from the begin of the interval.
LOADS = [
    [Piece(0.0, math.inf, 40.0, 900.0, rate=-35.0)],
    [Piece(0.0, 0.5, 3.0 + 2.0j, 500.0 - 80.0j, rate=-5.0 + 210.0j), Piece(0.0, 1.0, 7.0, -60.0)],
]


def train_of(stiffness: float) -> LoadedModes:
    """A free train with a friction clutch by a signal and a damped play, and modes that are left out."""
    ends = np.array([[0.0, 1.1, -0.7], [0.0, 0.4, 1.3]])
    modes = ModalTrain(np.array([60.0, 230.0]), np.array([0.02, 0.01]), np.diag([0.0, 1.5, 0.8]))
    compliance = np.array([[3e-6, 1e-6], [1e-6, 5e-6]]) if math.isfinite(stiffness) else None
    return LoadedModes(
        modes,
        LOADS,
        np.array([[0.0, 0.6], [0.0, -0.9], [0.0, 0.5]]),
        np.array([[0.8, 0.3, -1.2]]),
        (Friction(ends[0], stiffness, signal=0), Clearance(ends[1], 2e4, 1e-3, 6.0)),
        compliance,
        None if compliance is None else np.array([[0.0, 2e-6, 4e-6], [0.0, -3e-6, 1e-6]]),
    )


def start_of(regime: Regime) -> Start:
    """Some begin of a step, with a torque that follows the motion."""
    random = np.random.default_rng(7)
    coordinates, free = len(regime.root), regime.free.shape[1]
    y = random.normal(size=(coordinates, 2)) @ np.array([[1.0], [1.0j]])
    y[:free] = y[:free].real
    powers = LENGTH ** np.arange(POINTS)[:, None, None]
    polynomial = 50.0 * random.normal(size=(POINTS, 1, 1)) / powers
    offset = 1e-3 * random.normal(size=(2, 1))
    turned, begun = random.normal(size=(free, 1)), np.zeros((1, 1))
    return Start(np.array([0.02]), y, turned, offset, polynomial, begun)


@pytest.mark.parametrize(
    ("stiffness", "states"),
    [(9e3, (1, 1)), (9e3, (-1, 2)), (9e3, (0, 0)), (math.inf, (1, -1)), (math.inf, (0, 1))],
)
def test_samples_are_the_motion_and_its_derivatives(stiffness: float, states: tuple) -> None:
    train = train_of(stiffness)
    regime = regime_of(train, states)
    start = start_of(regime)
    begin = np.concatenate([features(train, 0, start), start.polynomial.ravel()])

    def sampled(name: str) -> np.ndarray:
        rows = ROWS[name](regime)
        return sample(regime, train.history.acting[0], rows, TIMES) @ begin

    motion = regime.read(0, start, TIMES)
    second = train.inputs_at(0, start, TIMES, 3)[:, :, 2]
    state = np.concatenate([motion.position, motion.speed, motion.inputs, motion.input_rates])
    rates = np.concatenate([motion.speed, motion.acceleration, motion.input_rates, second])
    known = {
        "events": (regime.events @ state, regime.events @ rates),
        "interfaces": (
            train.shape @ motion.position,
            train.shape @ motion.speed,
            train.shape @ motion.acceleration,
        ),
    }
    for name, expected in known.items():
        value = np.split(sampled(name), len(expected))
        for quantity, of_motion in zip(value, expected, strict=True):
            assert quantity == pytest.approx(of_motion, rel=1e-10, abs=1e-10 * np.ptp(of_motion))
    y, turned = regime.coordinates(0, start, TIMES)
    assert sampled("coordinates") == pytest.approx(
        np.concatenate([y.real, y.imag, turned]), rel=1e-10, abs=1e-12
    )
