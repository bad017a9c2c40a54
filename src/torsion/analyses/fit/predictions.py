"""What the train gives in place of what was measured, with its figures at given factors, and the slopes of that."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

import numpy as np

from torsion.analyses.response.over_speed import response_of_orders
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly import assemble, resolving
from torsion.assembly.system import System
from torsion.errors import InputError, SolveError
from torsion.kernels.tree_response import Status
from torsion.study import Study, Variation

STEP = 1e-5  # of the logarithm of a factor: a central difference errs by some 1e-10 of its square and 1e-11 of rounding


@dataclass(frozen=True)
class Curve:
    """Measured amplitudes of one order."""

    at: str
    order: Fraction  # per revolution of the reference
    quantity: str  # angle, speed or torque
    within: float
    speed: FloatArray  # (points,) rad/s of the reference
    amplitude: ComplexArray  # (points,) in SI
    has_phase: bool
    origin: str  # what of the file it is


class Train:
    """The train of a file with its figures at given factors, divided as that of the file is."""

    def __init__(self, variation: Variation, system: System, curves: tuple[Curve, ...], count: int) -> None:
        self.variation, self.curves, self.count = variation, curves, count
        self.system = system  # of the file, as finely as all that was measured needs
        self._known = lru_cache(maxsize=64)(self._assembled)

    def _assembled(self, factors: tuple[float, ...]) -> tuple[Study, System]:
        """Raises SolveError for factors with which the file would be at fault."""
        try:
            study = self.variation.study(factors)
        except InputError as error:
            message = "; ".join(fault.message for fault in error.faults)
            raise SolveError(f"the file with fitted figures is at fault: {message}", "a smaller deviation") from None
        train, segments = study.train, self.system.segments
        if self.system.model == "lumped":
            bars = tuple(replace(bar, segments=segments.get(bar.name, bar.segments)) for bar in train.bars)
            train = replace(train, bars=bars)
        return study, assemble(train, self.system.model, **vars(self.system.requested))

    def modes(self, factors: Sequence[float]) -> Modes:
        """The lowest modes."""
        return modes_as_discretised(self._known(tuple(factors))[1], self.count)

    def amplitudes(self, factors: Sequence[float], curve: Curve, speed: FloatArray | None = None) -> ComplexArray:
        """(speeds,) in SI; raises SolveError where the response has no value there."""
        study, system = self._known(tuple(factors))
        points = curve.speed if speed is None else speed
        found = response_of_orders(study, system, [curve.order], points)
        line = next(place for place, one in enumerate(found.lines) if one.order == curve.order)
        if (found.status[:, line] == Status.SINGULAR).any():
            raise SolveError(f"the response of order {curve.order} has no finite value at a speed", "give damping")
        if curve.quantity == "torque":
            part = study.train.position(curve.at)
            span = next(k for k, one in enumerate(system.spans) if one.part == part)
            return found.torque[:, line, span]
        station = next(k for k, one in enumerate(system.stations) if one.name == curve.at)
        angle = found.angle[:, line, station]
        return angle * (2j * math.pi * found.frequency[:, line]) if curve.quantity == "speed" else angle

    def logarithms(self, factors: Sequence[float], numbers: Sequence[int]) -> FloatArray:
        """ln of the frequencies of the modes `numbers` (from 0), and of all amplitudes; then their phases in rad."""
        found = [np.log(self.modes(factors).frequency[list(numbers)])] if len(numbers) else []
        for curve in self.curves:
            values = np.log(self.amplitudes(factors, curve))
            found += [values.real, values.imag] if curve.has_phase else [values.real]
        return np.concatenate(found)

    def wrapped(self, difference: FloatArray, modes: int) -> FloatArray:
        """The same differences of `logarithms`, behind those of so many modes, with phases within half a revolution."""
        place, found = modes, difference.copy()
        for curve in self.curves:
            place += curve.speed.size
            if curve.has_phase:
                found[place : place + curve.speed.size] = np.angle(np.exp(1j * found[place : place + curve.speed.size]))
                place += curve.speed.size
        return found

    def slopes(self, logs: FloatArray, numbers: Sequence[int]) -> FloatArray:
        """(measurements, figures): d `logarithms`/d ln factor."""
        amplitudes = self._differences(logs, lambda factors: self.logarithms(factors, ()), 0) if self.curves else None
        frequencies = self.mode_slopes(logs, numbers) if len(numbers) else None
        return np.vstack([one for one in (frequencies, amplitudes) if one is not None])

    def mode_slopes(self, logs: FloatArray, numbers: Sequence[int]) -> FloatArray:
        """(modes, figures): those of the frequencies alone, by the shares of both energies where the layout stays.

        d ln f/d ln k is half the share of a span in the elastic energy, -d ln f/d ln J that of a station in the kinetic
        one (Rayleigh 1877, 1, art. 90).
        """
        each = list(numbers)
        moved = [[self._known(tuple(np.exp(ends).tolist()))[1] for ends in pair] for pair in _either_side(logs)]
        if all(map(_is_plain, (self.system, *(one for pair in moved for one in pair)))):
            found = self.modes(np.exp(logs).tolist())
            elastic, kinetic = found.elastic[:, each], found.kinetic[:, each]
            columns = [
                -0.5 * (_change(*(one.flexibility for one in pair)) @ elastic)
                - 0.5 * (_change(*(one.lumped_inertia for one in pair)) @ kinetic)
                for pair in moved
            ]
            return np.stack(columns, axis=1)
        return self._differences(logs, lambda factors: np.log(self.modes(factors).frequency[list(numbers)]), None)

    def _differences(
        self, logs: FloatArray, values: Callable[[Sequence[float]], FloatArray], modes: int | None
    ) -> FloatArray:  # fmt: skip
        """Central; phases lie behind the curves of so many modes."""
        columns = []
        for pair in _either_side(logs):
            ends = [values(np.exp(moved).tolist()) for moved in pair]
            apart = ends[1] - ends[0]
            columns.append((apart if modes is None else self.wrapped(apart, modes)) / (2.0 * STEP))
        return np.stack(columns, axis=1)


def _either_side(logs: FloatArray) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Of each figure, all of them with that one a step lower and a step higher."""
    for row in STEP * np.eye(len(logs)):
        yield logs - row, logs + row


def _is_plain(system: System) -> bool:
    """Its frequencies follow from springs and lumped inertias alone."""
    return system.bars is None and not system.tables


def _change(low: FloatArray, high: FloatArray) -> FloatArray:
    """Slopes of logarithms between the values at both ends of a step; 0 of what has none."""
    used = (low > 0.0) & np.isfinite(low) & (high > 0.0) & np.isfinite(high)
    return np.log(np.where(used, high, 1.0) / np.where(used, low, 1.0)) / (2.0 * STEP)


def resolved_for(system: System, curves: Sequence[Curve]) -> System:
    """The system divided finely enough for every order that was measured."""
    highest = max((float(one.order) * one.speed.max() / (2.0 * math.pi) for one in curves), default=0.0)
    return resolving(system.whole, highest)
