"""What the train gives in place of what was measured, with its figures at given factors, and the slopes of that."""

import math
from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import replace
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
from torsion.what_if.fit.closed_forms import closed_forms, no_value, target_position
from torsion.what_if.fit.measurements import Curve

STEP = 1e-5  # of the logarithm of a factor: a central difference errs by some 1e-10 of its square and 1e-11 of rounding


class Train:
    """The train of a file with its figures at given factors, divided as that of the file is."""

    def __init__(
        self, variation: Variation, system: System, curves: tuple[Curve, ...], count: int
    ) -> None:
        self.variation, self.curves, self.count = variation, curves, count
        self.system = system  # of the file, as finely as all that was measured needs
        self._known = lru_cache(maxsize=64)(self._read)
        self.closed = closed_forms(variation, system, curves, count)

    def by_reading(self) -> "Train":
        """The same with its file read again for all figures."""
        other = copy(self)
        other.closed = None
        return other

    def _read(self, factors: tuple[float, ...]) -> tuple[Study, System]:
        """Raises SolveError for factors with which the file would be at fault."""
        try:
            study = self.variation.study(factors)
        except InputError as error:
            message = "; ".join(fault.message for fault in error.faults)
            raise SolveError(
                f"the file with updated parameters is invalid: {message}", "a smaller deviation"
            ) from None
        return study, self._assembled(study)

    def _assembled(self, study: Study) -> System:
        train, segments = study.train, self.system.segments
        if self.system.model == "lumped":
            bars = tuple(
                replace(bar, segments=segments.get(bar.name, bar.segments)) for bar in train.bars
            )
            train = replace(train, bars=bars)
        return assemble(train, self.system.model, **vars(self.system.requested))

    def modes(self, factors: Sequence[float]) -> Modes:
        """The lowest modes."""
        return modes_as_discretised(self._known(tuple(factors))[1], self.count)

    def frequencies(self, factors: Sequence[float]) -> FloatArray:
        """(modes,) Hz of these."""
        if self.closed is None:
            return self.modes(factors).frequency
        return np.asarray(self.closed.evaluated(tuple(factors)).modes.frequency / (2.0 * math.pi))

    def amplitudes(
        self, factors: Sequence[float], curve: Curve, speed: FloatArray | None = None
    ) -> ComplexArray:
        """(speeds,) in SI; raises SolveError where the response has no value there."""
        study, system = self._known(tuple(factors))
        points = curve.speed if speed is None else speed
        found = response_of_orders(study, system, [curve.order], points)
        line = next(place for place, one in enumerate(found.lines) if one.order == curve.order)
        if (found.status[:, line] == Status.SINGULAR).any():
            raise no_value(curve)
        if curve.quantity == "torque":
            return found.torque[:, line, target_position(system, curve)]
        angle = found.angle[:, line, target_position(system, curve)]
        return (
            angle * (2j * math.pi * found.frequency[:, line])
            if curve.quantity == "speed"
            else angle
        )

    def logarithms(self, factors: Sequence[float], numbers: Sequence[int]) -> FloatArray:
        """ln of the frequencies of the modes `numbers` (from 0), and of all amplitudes; then their phases in rad."""
        found = [np.log(self.frequencies(factors)[list(numbers)])] if len(numbers) else []
        for place, curve in enumerate(self.curves):
            closed = None if self.closed is None else self.closed.evaluated(tuple(factors))
            values = np.log(
                self.amplitudes(factors, curve) if closed is None else closed.amplitude(place)
            )
            found += [values.real, values.imag] if curve.has_phase else [values.real]
        return np.concatenate(found)

    def wrapped(self, difference: FloatArray, modes: int) -> FloatArray:
        """The same differences of `logarithms`, behind those of so many modes, with phases within half a revolution."""
        place, found = modes, difference.copy()
        for curve in self.curves:
            place += curve.speed.size
            if curve.has_phase:
                found[place : place + curve.speed.size] = np.angle(
                    np.exp(1j * found[place : place + curve.speed.size])
                )
                place += curve.speed.size
        return found

    def slopes(self, logs: FloatArray, numbers: Sequence[int]) -> FloatArray:
        """(measurements, figures): d `logarithms`/d ln factor."""
        found = [self.mode_slopes(logs, numbers)] if len(numbers) else []
        if self.curves and self.closed is None:
            found.append(self._differences(logs, lambda factors: self.logarithms(factors, ()), 0))
        elif self.closed is not None:
            closed = self.closed.evaluated(tuple(np.exp(logs).tolist()))
            for place, curve in enumerate(self.curves):
                slopes = closed.amplitude_slopes(place)
                found += [slopes.real, slopes.imag] if curve.has_phase else [slopes.real]
        return np.vstack(found)

    def mode_slopes(self, logs: FloatArray, numbers: Sequence[int]) -> FloatArray:
        """(modes, figures): those of the frequencies alone, by the shares of both energies where the layout stays.

        d ln f/d ln k is half the share of a span in the elastic energy, -d ln f/d ln J that of a station in the kinetic
        one (Rayleigh 1877, 1, art. 90).
        """
        if self.closed is not None:
            return self.closed.evaluated(tuple(np.exp(logs).tolist())).mode_slopes(numbers)
        each = list(numbers)
        moved = [
            [self._known(tuple(np.exp(ends).tolist()))[1] for ends in pair]
            for pair in _either_side(logs)
        ]
        if all(map(_is_plain, (self.system, *(one for pair in moved for one in pair)))):
            found = self.modes(np.exp(logs).tolist())
            elastic, kinetic = found.elastic[:, each], found.kinetic[:, each]
            columns = [
                -0.5 * (_change(*(one.flexibility for one in pair)) @ elastic)
                - 0.5 * (_change(*(one.lumped_inertia for one in pair)) @ kinetic)
                for pair in moved
            ]
            return np.stack(columns, axis=1)
        return self._differences(
            logs, lambda factors: np.log(self.modes(factors).frequency[list(numbers)]), None
        )

    def _differences(
        self, logs: FloatArray, values: Callable[[Sequence[float]], FloatArray], modes: int | None
    ) -> FloatArray:
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
    highest = max(
        (float(one.order) * one.speed.max() / (2.0 * math.pi) for one in curves), default=0.0
    )
    return resolving(system.whole, highest)
