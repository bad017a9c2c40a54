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
Piece = tuple[
    IntArray, FloatArray, FloatArray
]  # blocks, states (states, columns) and lengths (s) of steps


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
    train = motion.train
    gained = np.zeros(
        (2 + len(train.elements), len(motion.begin))
    )  # work, damped, heat of each element
    largest = 0.0
    node, weight = np.polynomial.legendre.leggauss(GAUSS)
    node, weight = (node + 1.0) / 2.0, weight / 2.0
    for number in np.unique(motion.regime[:-1]).tolist():
        one, whole = motion.regimes[number], list[FloatArray]()
        for block, start, length in _steps(
            motion, one, np.flatnonzero(motion.regime[:-1] == number)
        ):
            is_whole = len(block) >= train.size and bool((length == one.step).all())
            powers = np.zeros((len(gained), len(block)))
            if is_whole and not whole:
                whole = [
                    one.moved(np.eye(train.size), np.full(train.size, share * one.step))
                    for share in node
                ]
            for at, (share, factor) in enumerate(zip(node, weight, strict=True)):
                z = whole[at] @ start if is_whole else one.moved(start, share * length)
                powers += factor * _powers(train, one, z)
                largest = max(largest, float(_energies(train, one, z).max(initial=0.0)))
            gained[:, block] += powers * length
    gained[2:][[not one.loses for one in train.elements]] = (
        0.0  # what rounding left there stays in the balance
    )
    stored = _stored(motion)
    total = np.concatenate([np.zeros((len(gained), 1)), np.cumsum(gained[:, :-1], axis=1)], axis=1)
    total[2:] += (motion.released - motion.released[0]).T
    error = stored - stored[0] - total[0] + total[1:].sum(axis=0)
    largest = max(largest, float(stored.max(initial=0.0)))
    residual = float(np.abs(error).max(initial=0.0)) / largest if largest else 0.0
    return EnergyBalance(
        float(total[0, -1]),
        total[2:, -1],
        float(total[1, -1]),
        float(stored[-1] - stored[0]),
        residual,
    )


def _steps(motion: EventDrivenMotion, one: Regime, blocks: IntArray) -> Iterator[Piece]:
    """Whole steps of the blocks of a regime, then what is left of each."""
    length = motion.begin[blocks + 1] - motion.begin[blocks]
    number = np.minimum((length / one.step).astype(int), STEPS)
    rest = length - number * one.step
    for part in np.array_split(np.arange(len(blocks)), len(blocks) // COLUMNS + 1):
        z = motion.state[blocks[part]].T.copy()
        for step in range(int(number[part].max(initial=0))):
            going = number[part] > step
            yield blocks[part[going]], z[:, going], np.full(int(going.sum()), one.step)
            z[:, going] = one.over_step(z[:, going])
        left = rest[part] > 0.0
        yield blocks[part[left]], z[:, left], rest[part[left]]


def _powers(train: PiecewiseTrain, one: Regime, z: FloatArray) -> FloatArray:
    """(2 + elements, columns) W: work of the torques, loss in the damping of the modes, heat of every element."""
    change = one.matrix @ z
    speed, torque = z[train.layout[2]], one.torque @ z / train.root[:, None]
    of_rest = train.resting @ change
    own = (
        train.relative_speed @ z
        + of_rest
        - train.series @ (one.torque @ change / train.root[:, None])
    )
    work = (train.rows(train.force) @ z * speed).sum(axis=0) + (torque * of_rest).sum(axis=0)
    damped = (train.damping @ speed * speed).sum(axis=0)
    return np.concatenate(
        [work[None], damped[None], torque * own - one.elastic @ z * (one.elastic @ change)]
    )


def _stored(motion: EventDrivenMotion) -> FloatArray:
    """(blocks,) J at the begin of each."""
    found = np.empty(len(motion.begin))
    for number, one in enumerate(motion.regimes):
        here = motion.regime == number
        found[here] = _energies(motion.train, one, motion.state[here].T)
    return found


def _energies(train: PiecewiseTrain, one: Regime, z: FloatArray) -> FloatArray:
    """(columns,) J of states."""
    place, speed = train.layout[1:3]
    torque = one.torque @ z / train.root[:, None]
    parts = (z[place] ** 2, z[speed] ** 2, (one.elastic @ z) ** 2, torque * (train.series @ torque))
    return np.asarray(0.5 * sum(part.sum(axis=0) for part in parts))
