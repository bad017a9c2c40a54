"""What an unstable range is called: principal of one mode, sum or difference of two, by the modes that take part in it.

With a coefficient that varies at w0, motions grow near k w0 = w_i + w_j (i = j: principal), and where the stiffness is
not symmetric or the damping uneven, near k w0 = |w_i - w_j|.
"""

from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from typing import Literal

import numpy as np

from torsion.analyses.motion.floquet import Multipliers
from torsion.analyses.motion.modes import Basis
from torsion.arrays import FloatArray

TAKES_PART = 0.02  # of the largest modal energy
ALONE = 0.1  # of the largest: a second mode with less makes no zone of two modes where one alone explains it
DETUNED = 0.35  # of w0: no combination explains a growth farther away
MIXED_COSTS = 0.05  # of w0: where two modes take part, a zone of both is believed before one of either alone
RANK_COSTS = 0.02  # of w0, per rank: a near miss of a low rank is believed before a hit of a high one


@dataclass(frozen=True)
class Zone:
    """A parametric resonance."""

    kind: Literal["principal", "sum", "difference", "unexplained"]
    modes: tuple[int, ...]  # elastic modes, counted from 1; 0 is the free turning
    rank: int  # k of k w0 = combination
    detuning: float  # (combination - k w0)/w0

    @property
    def name(self) -> str:
        """In words."""
        if self.kind == "unexplained":
            return f"unstable in mode {self.modes[0]}" if self.modes else "unstable"
        if self.kind == "principal":
            share = "" if self.rank == 1 else f"/{self.rank}"
            return f"principal of mode {self.modes[0]} (2 w{self.modes[0]}{share})"
        i, j = self.modes
        pair = f"w{i} + w{j}" if self.kind == "sum" else f"w{j} - w{i}"
        return f"{self.kind} of modes {i} and {j} " + (f"({pair})" if self.rank == 1 else f"(({pair})/{self.rank})")


def modal_energy(found: Multipliers, shapes: Basis, reduced: Basis | None = None) -> FloatArray:
    """(modes,) energy of the fastest growing motion in each mode at reference angle zero, largest 1.

    reduced: the basis that the motion is told in, with more behind it; None: the coordinates.
    """
    onto = shapes.shape.T * shapes.inertia
    if reduced is not None:
        onto = onto @ reduced.shape
    number = onto.shape[1]
    angle, speed = onto @ found.vector[:number, 0], onto @ found.speed[:number, 0]
    energy = (shapes.frequency * np.abs(angle)) ** 2 + np.abs(speed) ** 2
    return np.asarray(energy / max(float(energy.max()), np.finfo(float).tiny))


def zone(energy: FloatArray, shapes: Basis, w0: float) -> Zone:
    """The combination of the modes that take part which lies nearest to a multiple of w0 (rad/s)."""
    rigid = shapes.rigid
    taking = [int(k) for k in np.argsort(-energy) if energy[k] > TAKES_PART]
    w = shapes.frequency
    choices: list[tuple[float, Zone]] = []

    def consider(
        kind: Literal["principal", "sum", "difference"], modes: tuple[int, ...], combination: float, cost: float = 0.0
    ) -> None:
        rank = max(1, round(combination / w0))
        away = combination / w0 - rank
        if abs(away) < DETUNED:
            told = tuple(max(0, mode - rigid + 1) for mode in modes)
            choices.append((abs(away) + RANK_COSTS * rank + cost, Zone(kind, told, rank, away)))

    strong = [k for k in taking if energy[k] > ALONE]
    for mode in strong if len(strong) < 2 else []:
        consider("principal", (mode,), 2.0 * w[mode])
    if not choices:
        for mode in strong:
            consider("principal", (mode,), 2.0 * w[mode], MIXED_COSTS)
        for i, j in combinations(sorted(taking), 2):
            consider("sum", (i, j), w[i] + w[j])
            consider("difference", (i, j), w[j] - w[i])
    if not choices:
        return Zone("unexplained", tuple(max(0, k - rigid + 1) for k in taking[:1]), 0, 0.0)
    return min(choices, key=lambda one: one[0])[1]


def candidates(
    shapes: Basis, orders: tuple[Fraction, ...], first: float, last: float, most_rank: int = 2
) -> FloatArray:
    """Reference speeds (rad/s) in a range at which a combination of two modes meets a multiple of a joint's frequency.

    orders: frequencies of the joints / reference speed.
    """
    w = shapes.frequency[shapes.rigid :]
    i, j = np.triu_indices(len(w))
    found = np.concatenate([w[i] + w[j], np.abs(w[i] - w[j])[i != j], w])
    speed = np.concatenate([found / (float(order) * rank) for order in orders for rank in range(1, most_rank + 1)])
    return np.unique(speed[(speed > first) & (speed < last)])
