"""A train with a clearance and friction in angles of its stations, by Taylor series of extended precision."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.motion.loaded_modes import LoadedModes, ModalTrain, Piece
from torsion.kernels.motion.piecewise_elements import Clearance, Friction
from torsion.kernels.trees.tree import Tree


@dataclass
class Reference:
    """J theta'' + C theta' + K theta = torques, in angles, with one clearance and one friction element."""

    inertia: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    clearance: tuple[np.ndarray, float, float, float]  # ends, stiffness, half, viscous
    friction: tuple[np.ndarray, float, float]
    load: np.ndarray  # of the real part of exp(rate t)
    steady: np.ndarray
    rate: complex  # 1/s

    def matrix(self, contact: int, slip: int) -> np.ndarray:
        """Of (angles, speeds, slip, cos, sin, 1), by acceleration."""
        n = len(self.inertia)
        found = np.zeros((2 * n + 4, 2 * n + 4), dtype=np.longdouble)
        found[:n, n : 2 * n] = np.eye(n)
        rows = self.rows(contact, slip)
        push = -np.concatenate([self.stiffness, self.damping], axis=1)
        found[n : 2 * n, : 2 * n] = push / self.inertia[:, None]
        for torque, ends in zip(rows[:2], (self.clearance[0], self.friction[0]), strict=True):
            found[n : 2 * n] -= np.outer(ends / self.inertia, torque)
        found[n : 2 * n, -3] += self.load / self.inertia
        found[n : 2 * n, -1] += self.steady / self.inertia
        if slip:
            found[2 * n] = rows[3]
        decay, turn = self.rate.real, self.rate.imag
        found[-3:-1, -3:-1] = [[decay, -turn], [turn, decay]]
        return found

    def rows(self, contact: int, slip: int) -> list[np.ndarray]:
        """Torque of the clearance and of the friction, twist of the clearance, speed of the friction."""
        n = len(self.inertia)
        (ends, k, half, c), (own, stiff, most) = self.clearance, self.friction
        twist, speed, rub, pull, one = np.zeros((5, 2 * n + 4), dtype=np.longdouble)
        twist[:n], one[-1], speed[n : 2 * n], rub[n : 2 * n] = ends, 1.0, ends, own
        pull[:n], pull[2 * n] = stiff * own, -stiff
        torque = k * (twist - contact * half * one) + c * speed if abs(contact) == 1 else 0.0 * one
        return [torque, slip * most * one if slip else pull, twist, rub]

    def functions(self, contact: int, slip: int) -> list[tuple[np.ndarray, tuple[int, int]]]:
        """Rows that end a regime below zero, and the regime that follows."""
        half, one = self.clearance[2], np.eye(2 * len(self.inertia) + 4, dtype=np.longdouble)[-1]
        torque, rubbing, twist, speed = self.rows(contact, slip)
        if contact == 0:
            found = [(half * one - twist, (1, slip)), (half * one + twist, (-1, slip))]
        elif abs(contact) == 1:
            found = [(contact * torque, (2 * contact, slip))]
        else:
            side = contact // 2
            found = [
                (side * twist - half * one, (0, slip)),
                (-side * self.rows(side, slip)[0], (side, slip)),
            ]
        if slip:
            return [*found, (slip * speed, (contact, 0))]
        most = self.friction[2]
        return [*found, (most * one - rubbing, (contact, 1)), (most * one + rubbing, (contact, -1))]

    def run(self, step: float, events: int) -> tuple[list[float], list[tuple[float, float]]]:
        """Times of the events from rest, and both torques at them."""
        return self._march(step, events, 2.0, [])[:2]

    def torques(self, times: np.ndarray, step: float = 2e-4) -> np.ndarray:
        """(2, times) N m of both elements, from rest."""
        return np.array(self._march(step, 10**6, float(times[-1]) + step, times.tolist())[2]).T

    def _march(self, step: float, events: int, end: float, at: list[float]):
        n = len(self.inertia)
        z, time, state = np.zeros(2 * n + 4, dtype=np.longdouble), np.longdouble(0.0), (0, 0)
        z[-1] = z[-3] = 1.0
        times, values, read = [], [], []
        while len(times) < events and time < end:
            matrix, functions = self.matrix(*state), self.functions(*state)
            terms = [z]
            for power in range(1, 22):
                terms.append(matrix @ terms[-1] * (np.longdouble(step) / power))
            best, following = np.longdouble(2.0), state
            for row, after in functions:
                ends = [term @ row for term in terms]
                if sum(ends) < 0.0 and ends[0] > -1e-14 * max(map(abs, ends)):
                    low, high = np.longdouble(0.0), np.longdouble(1.0)
                    for _ in range(70):
                        middle = (low + high) / 2
                        low, high = (
                            (low, middle) if polynomial(ends, middle) < 0.0 else (middle, high)
                        )
                    if low < best:
                        best, following = low, after
            share = min(best, np.longdouble(1.0))
            later = time + share * np.longdouble(step)
            while len(read) < len(at) and at[len(read)] <= later:
                inside = polynomial(
                    terms, (np.longdouble(at[len(read)]) - time) / np.longdouble(step)
                )
                read.append([float(row @ inside) for row in self.rows(*state)[:2]])
            z, time = polynomial(terms, share), later
            if best <= 1.0:
                if following[1] != state[1] and state[1]:  # sticks with the torque of slipping
                    z[2 * n] = (
                        self.friction[0] @ z[:n] - state[1] * self.friction[2] / self.friction[1]
                    )
                if following[1] != state[1] or abs(following[0]) == 1 or abs(state[0]) == 1:
                    times.append(float(time))
                    values.append(tuple(float(row @ z) for row in self.rows(*following)[:2]))
                state = following
        return times, values, read


def polynomial(terms, share):
    """By Horner's scheme."""
    total = terms[-1] * 0
    for term in reversed(terms):
        total = total * share + term
    return total


def ten_stations(
    ratio: float = 0.0, load: float = 120.0, rate: complex = complex(-0.05, 30.0)
) -> tuple[Reference, LoadedModes]:
    """A free train with a clearance in its middle and friction beside a span, in angles and in modes of its parts.

    ratio: of damping, of every mode of a part; 0: damping that goes with the stiffness. load: N m, with its rate (1/s).
    """
    draw = np.random.default_rng(3)
    inertia, spans, cut = draw.uniform(0.5, 2.0, 10), draw.uniform(5e4, 2e5, 9), 5
    twist = np.eye(10)[:-1] - np.eye(10)[1:]
    own = np.delete(np.arange(9), cut)
    stiffness = (twist[own].T * spans[own]) @ twist[own]
    loads = np.stack([load * np.eye(10)[0], 30.0 * (np.eye(10)[0] - np.eye(10)[9])])
    shape, w = np.zeros((10, 10)), np.empty(8)
    shape[:, 0] = 1.0
    shape[:6, 1], shape[6:, 1] = 1.0 / inertia[:6].sum(), -1.0 / inertia[6:].sum()
    for part, first in ((slice(0, 6), 2), (slice(6, 10), 7)):
        size = part.stop - part.start
        tree = Tree(
            np.arange(-1, size - 1),
            np.array([0.0, *1.0 / spans[part.start : part.stop - 1]]),
            inertia[part],
            np.zeros(size, dtype=bool),
        )
        found = tree_modes(tree, None)
        w[first - 2 : first + size - 3], shape[part, first : first + size - 1] = (
            found.frequency,
            found.angle,
        )
    shape /= np.sqrt((inertia[:, None] * shape**2).sum(axis=0))
    ends = twist @ shape
    ends[:, 0], ends[8, 1] = 0.0, 0.0
    made = Clearance(ends[cut], 1e5, 0.005, 20.0), Friction(ends[8], 5e4, 5.0)
    damping = 1e-5 * stiffness
    if ratio:
        pushed = inertia[:, None] * shape
        damping = (pushed[:, 2:] * (2.0 * ratio * w)) @ pushed[:, 2:].T
    reference = Reference(
        inertia,
        damping,
        stiffness,
        (twist[cut], 1e5, 0.005, 20.0),
        (twist[8], 5e4, 5.0),
        *loads,
        rate,
    )
    pieces = (Piece(0.0, math.inf, 1.0, rate=rate),), (Piece(0.0, math.inf, 1.0),)
    modes = ModalTrain(w, np.zeros(len(w)), shape.T @ damping @ shape)
    return reference, LoadedModes(modes, pieces, shape.T @ loads.T, np.zeros((0, 10)), made)
