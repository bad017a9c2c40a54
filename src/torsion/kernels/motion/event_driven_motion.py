"""A motion in steps of linear regimes, to be read at any time exactly, and the balance of its energy.

What is stored, put in by the torques, and lost is found by Gauss quadrature. An element of torque T, of which e is
elastic, takes T u' from the modes; what it does not store is its heat:
    heat' = T (u' + rest' - (F T)') - e e'
with what the modes that are left out add to its twist. What the balance lacks is the error of the whole computation.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.motion.linear_regime import Reading, Regime
from torsion.kernels.motion.loaded_modes import LoadedModes, Start

BLOCK = 20_000  # coordinates at a time

# rad of the fastest motion in a window, and its nodes: squares turn twice as far in it, and err by 3e-15
GAUSS = {3.0: 10, 10.0: 20, 30.0: 36}
COLUMNS = 40_000  # times at once
CHECKED = 64  # windows of a linear train in which its balance is verified


@dataclass(frozen=True)
class Event:
    """A change of the regime of an element."""

    time: float  # s
    element: int
    word: str  # contact, separation, slip, stuck, open


@dataclass(eq=False)
class EventDrivenMotion:
    """The motion of a train from step to step; begin: (steps,) s."""

    train: LoadedModes
    steps: tuple[tuple[int, int, Start], ...]  # regime and interval of the history of each
    regimes: tuple[Regime, ...]
    events: tuple[Event, ...]
    end: float  # s

    def __post_init__(self) -> None:
        self.begin = np.concatenate([start.time for *_, start in self.steps])
        # Which group each step is of; of every regime and interval its steps, beside each other.
        keys = [step[:2] for step in self.steps]
        numbers = {key: number for number, key in enumerate(dict.fromkeys(keys))}
        self._group = np.array([numbers[key] for key in keys])
        self._groups = list[tuple[Regime, int, IntArray, Start]]()
        for (regime, interval), number in numbers.items():
            chosen = np.flatnonzero(self._group == number)
            columns = zip(*(self.steps[step][2] for step in chosen.tolist()), strict=True)
            starts = Start(*(np.concatenate(column, axis=-1) for column in columns))
            self._groups.append((self.regimes[regime], interval, chosen, starts))

    def readings(
        self, time: FloatArray, step: IntArray
    ) -> Iterator[tuple[Regime, IntArray, Reading, FloatArray]]:
        """Regimes, which of some times (s) are in each, the motion there in a step each, and where that began.

        Positions of rigid motions (motions, times) rad count from there.
        """
        group = self._group[step]
        for number in np.unique(group).tolist():
            columns = np.flatnonzero(group == number)
            regime, interval, chosen, starts = self._groups[number]
            for part in np.array_split(columns, 1 + columns.size * len(regime.root) // BLOCK):
                which = np.searchsorted(chosen, step[part])
                start = Start(*(column[..., which] for column in starts))
                yield (
                    regime,
                    part,
                    regime.read(interval, start, time[part] - start.time),
                    start.begun,
                )

    def at(self, time: FloatArray) -> Reading:
        """The motion at times (s); positions are whole ones."""
        step = np.maximum(np.searchsorted(self.begin, time, side="right") - 1, 0)
        n, m, number = self.train.motions, self.train.inputs, len(self.train.elements)
        whole = Reading(*(np.empty((size, len(time))) for size in (n, n, m, m, n, number, number)))
        for _, columns, reading, begun in self.readings(time, step):
            reading.position[: len(begun)] += begun
            for values, part in zip(whole, reading, strict=True):
                values[:, columns] = part
        return whole


@dataclass(frozen=True)
class EnergyBalance:
    """Energies of the whole motion; of a linear train the residual alone."""

    work: float  # J, of the torques
    heat: FloatArray  # (elements,) J
    damped: float  # J, lost in the damping of the modes
    stored: float  # J, gained
    residual: float  # largest error, of the largest energy


class _Windows(NamedTuple):
    """Short times within steps."""

    begin: FloatArray
    end: FloatArray
    step: IntArray
    nodes: int  # of Gauss, in each


def energy_balance(motion: EventDrivenMotion) -> EnergyBalance:
    """The energies, and how far their balance is from zero."""
    is_linear = not motion.train.elements
    windows = _windows(motion)
    nodes, weights = np.polynomial.legendre.leggauss(windows.nodes)
    shares = np.concatenate([[0.0], (nodes + 1.0) / 2.0, [1.0]])
    # work, damped, heat of each element; energy of all, and of each element, at begin and end
    number, count = len(motion.train.elements), len(windows.begin)
    gained, ends = np.zeros((2 + number, count)), np.zeros((2, 1 + number, count))
    largest = 0.0
    for part in np.array_split(np.arange(count), 1 + count * len(shares) // COLUMNS):
        length = (windows.end - windows.begin)[part, None]
        times = windows.begin[part, None] + length * shares
        steps = np.repeat(windows.step[part], len(shares))
        powers = np.zeros((len(gained), times.size))
        energy = np.zeros((1 + number, times.size))
        for regime, columns, reading, _ in motion.readings(times.ravel(), steps):
            powers[:, columns], energy[:, columns] = _powers_and_energies(regime, reading)
        powers = powers.reshape(len(gained), *times.shape)[..., 1:-1]
        gained[:, part] = powers @ weights * length[:, 0] / 2.0
        energy = energy.reshape(1 + number, *times.shape)
        ends[:, :, part] = energy[..., [0, -1]].transpose(2, 0, 1)
        largest = max(largest, float(energy[0].max(initial=0.0)))
    heat, stored = gained[2:].sum(axis=1), float(ends[1, 0, -1] - ends[0, 0, 0])
    lack = ends[1, 0] - ends[0, 0] - gained[0] + gained[1:].sum(axis=0)
    if is_linear:
        largest = max(largest, _energy_of_impulses(motion, windows))
    else:
        # Friction whose capacity falls at once gives up what its spring holds.
        signals = [element.signal is not None for element in motion.train.elements]
        released = ends[1, 1:, :-1] - ends[0, 1:, 1:]
        released[np.logical_not(signals)] = 0.0
        heat += released.sum(axis=1)
        jumps = ends[0, 0, 1:] - ends[1, 0, :-1] + released.sum(axis=0)
        lack = np.cumsum(lack + np.append(jumps, 0.0))
        # What rounding left where nothing is lost stays in the balance.
        elements = motion.train.elements
        heat[[not (element.slips or element.viscous) for element in elements]] = 0.0
    error = float(np.abs(lack).max(initial=0.0))
    residual = error / largest if largest else 0.0
    return EnergyBalance(float(gained[0].sum()), heat, float(gained[1].sum()), stored, residual)


def _windows(motion: EventDrivenMotion) -> _Windows:
    """The whole motion in windows, of a linear one CHECKED, each within one step; so long that nodes are fewest."""
    edges = np.append(motion.begin, motion.end)
    if not motion.train.elements:
        begin = np.linspace(0.0, motion.end, CHECKED, endpoint=False)
        fastest_of_all = max(regime.fastest for regime in motion.regimes)
        lasts = motion.end / max(CHECKED, 2.0 * fastest_of_all * motion.end)
        step = np.maximum(np.searchsorted(motion.begin, begin, side="right") - 1, 0)
        return _Windows(
            begin, np.minimum(begin + lasts, edges[step + 1]), step, min(GAUSS.values())
        )
    fastest = np.array([motion.regimes[regime].fastest for regime, *_ in motion.steps])
    length = np.diff(edges)
    numbers = {
        nodes: np.maximum(np.ceil(length * fastest / radians), 1.0).astype(int)
        for radians, nodes in GAUSS.items()
    }
    nodes, number = min(numbers.items(), key=lambda pair: pair[0] * int(pair[1].sum()))
    step = np.repeat(np.arange(len(number)), number)
    within = np.arange(len(step)) - np.repeat(np.cumsum(number) - number, number)
    begin, part = edges[step], (length / number)[step]
    return _Windows(begin + part * within, begin + part * (within + 1.0), step, nodes)


def _energy_of_impulses(motion: EventDrivenMotion, windows: _Windows) -> float:
    """The largest energy that a torque by itself gives a mode, within a window or the mode's own time.

    So a train that runs evenly, its torques against each other, has a scale too.
    """
    train, length = motion.train, float((windows.end - windows.begin).max())
    inputs = np.zeros(train.inputs)
    for _, _, reading, _ in motion.readings((windows.begin + windows.end) / 2.0, windows.step):
        inputs = np.maximum(inputs, np.abs(reading.inputs).max(axis=1))
    lasts = 1.0 / np.maximum(train.modes.w_of_all, 1.0 / length)
    impulse = np.abs(train.push) * inputs * lasts[:, None]
    return float(0.5 * np.square(impulse).max(initial=0.0))


def _powers_and_energies(regime: Regime, reading: Reading) -> tuple[FloatArray, FloatArray]:
    """(2 + elements, times) W: work of the torques, loss in the damping of the modes, heat of every element.

    Then (1 + elements, times) J stored in the train, and in its elements.
    """
    train, speed, changes = regime.train, reading.speed, reading.input_rates
    # (rows, times) of all values, and their rates: of the rates of inputs nothing.
    values = np.concatenate(reading[:4])
    rates = np.concatenate([speed, reading.acceleration, changes, 0.0 * changes])
    work = (train.push @ reading.inputs * speed).sum(axis=0)
    if train.higher_answer is not None:
        answer = train.higher_answer @ changes[1 : train.following.stop]
        work += (reading.torque * answer).sum(axis=0)
    damped = (train.modes.damping @ speed * speed).sum(axis=0)
    bent = regime.elastic @ values
    heat = reading.torque * (regime.twist @ rates) - bent * (regime.elastic @ rates)
    powers = np.concatenate([work[None], damped[None], heat])
    elastic = 0.5 * bent**2
    modes = (train.modes.w_of_all[:, None] * reading.position) ** 2 + reading.speed**2
    energy = 0.5 * modes.sum(axis=0) + elastic.sum(axis=0)
    if train.compliance is not None:
        energy += 0.5 * (reading.torque * (train.compliance @ reading.torque)).sum(axis=0)
    return powers, np.concatenate([energy[None], elastic])
