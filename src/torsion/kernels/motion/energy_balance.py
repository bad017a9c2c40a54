"""The balance of energy of an event-driven motion: stored, put in by the torques, and lost, by Gauss quadrature of it.

An element of torque T, of which e is elastic, takes T u' from the modes; what it does not store is its heat:
    heat' = T (u' + rest' - (F T)') - e e'
with what the modes that are left out add to its twist. The quadrature goes over the steps of every block.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion
from torsion.kernels.motion.linear_regime import STEPS, Regime
from torsion.kernels.motion.piecewise_train import PiecewiseTrain

GAUSS = 10  # nodes of a step: squares of its fastest motion turn by 4 rad in it
COLUMNS = 4096  # states at once


@dataclass(frozen=True)
class EnergyBalance:
    """Energies of the whole motion."""

    work: float  # J, of the torques
    heat: FloatArray  # (elements,) J
    damped: float  # J, lost in the damping of the modes
    stored: float  # J, gained
    residual: float  # largest error at the begin of any block, of the largest energy


def energy_balance(motion: EventDrivenMotion) -> EnergyBalance:
    """The energies, and how far their balance is from zero."""
    train, blocks = motion.train, motion.regime[:-1]
    # work, damped, heat of each element
    gained = np.zeros((2 + len(train.elements), len(motion.begin)))
    stored, largest = np.empty(len(motion.begin)), 0.0
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    nodes, weights = (nodes + 1.0) / 2.0, weights / 2.0
    for number, regime in enumerate(motion.regimes):
        ends = motion.regime == number
        stored[ends] = _energies(train, regime, motion.state[ends].T)
        full_step = list[FloatArray]()
        for block, start, length in _steps(motion, regime, np.flatnonzero(blocks == number)):
            is_full = len(block) >= train.size and bool((length == regime.step).all())
            if is_full and not full_step:
                unit, lengths = np.eye(train.size), np.full(train.size, regime.step)
                full_step = [regime.moved(unit, share * lengths) for share in nodes]
            powers = np.zeros((len(gained), len(block)))
            for node, (share, weight) in enumerate(zip(nodes, weights, strict=True)):
                z = full_step[node] @ start if is_full else regime.moved(start, share * length)
                powers += weight * _powers(train, regime, z)
                largest = max(largest, float(_energies(train, regime, z).max(initial=0.0)))
            gained[:, block] += powers * length
    # What rounding left where nothing is lost stays in the balance.
    gained[2:][[not element.loses for element in train.elements]] = 0.0
    total = np.concatenate([np.zeros((len(gained), 1)), np.cumsum(gained[:, :-1], axis=1)], axis=1)
    total[2:] += (motion.released - motion.released[0]).T
    error = np.abs(stored - stored[0] - total[0] + total[1:].sum(axis=0)).max(initial=0.0)
    largest = max(largest, float(stored.max(initial=0.0)))
    return EnergyBalance(
        float(total[0, -1]),
        total[2:, -1],
        float(total[1, -1]),
        float(stored[-1] - stored[0]),
        float(error) / largest if largest else 0.0,
    )


def _steps(
    motion: EventDrivenMotion, regime: Regime, blocks: IntArray
) -> Iterator[tuple[IntArray, FloatArray, FloatArray]]:
    """Blocks, states (states, columns) and lengths (s) of full steps of a regime, then of what is left of each block."""
    length, step = motion.begin[blocks + 1] - motion.begin[blocks], regime.step
    number = np.minimum((length / step).astype(int), STEPS)
    remainder = length - number * step
    for part in np.array_split(np.arange(len(blocks)), len(blocks) // COLUMNS + 1):
        z = motion.state[blocks[part]].T.copy()
        for full in range(int(number[part].max(initial=0))):
            going = number[part] > full
            yield blocks[part[going]], z[:, going], np.full(np.count_nonzero(going), step)
            z[:, going] = regime.over_step(z[:, going])
        left = remainder[part] > 0.0
        yield blocks[part[left]], z[:, left], remainder[part[left]]


def _powers(train: PiecewiseTrain, regime: Regime, z: FloatArray) -> FloatArray:
    """(2 + elements, columns) W: work of the torques, loss in the damping of the modes, heat of every element."""
    change = regime.matrix @ z
    speed, torque = z[train.layout[2]], regime.torque @ z / train.root[:, None]
    resting = train.resting @ change
    series = train.series @ (regime.torque @ change / train.root[:, None])
    relative = train.relative_speed @ z + resting - series
    work = (train.rows(train.force) @ z * speed).sum(axis=0) + (torque * resting).sum(axis=0)
    damped = (train.damping @ speed * speed).sum(axis=0)
    heat = torque * relative - regime.elastic @ z * (regime.elastic @ change)
    return np.concatenate([work[None], damped[None], heat])


def _energies(train: PiecewiseTrain, regime: Regime, z: FloatArray) -> FloatArray:
    """Energy stored in the train at states (states, columns): (columns,) J."""
    position, speed = train.layout[1:3]
    torque = regime.torque @ z / train.root[:, None]
    squares = (z[position] ** 2, z[speed] ** 2, (regime.elastic @ z) ** 2)
    return np.asarray(
        0.5 * sum(part.sum(axis=0) for part in (*squares, torque * (train.series @ torque)))
    )
