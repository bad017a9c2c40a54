"""What the train gives in place of what was measured, with its parameters at given factors, and its slopes."""

import math
from collections.abc import Callable, Sequence
from copy import copy
from functools import lru_cache

import numpy as np

from torsion.analyses.response.over_speed import response_of_orders
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly import as_divided, of_train, resolving
from torsion.assembly.system import System
from torsion.errors import InputError, SolveError
from torsion.kernels.tree_response import Status
from torsion.study import Study, Variation
from torsion.what_if.fit.closed_forms import closed_forms, no_value, target_position
from torsion.what_if.fit.measurements import Curve

STEP = 1e-5  # of the logarithm of a factor: a central difference errs by some 1e-10 of its square and 1e-11 of rounding


class Train:
    """The train of a file with its parameters at given factors, divided as that of the file is."""

    def __init__(
        self, variation: Variation, system: System, curves: tuple[Curve, ...], count: int
    ) -> None:
        self.variation, self.curves, self.count = variation, curves, count
        self.system = system  # of the file, as finely as all that was measured needs
        self._assembled = lru_cache(maxsize=64)(self._read)
        self.closed = closed_forms(variation, system, curves, count)

    def by_reading(self) -> "Train":
        """Return the same train with its file read again for all parameters."""
        train = copy(self)
        train.closed = None
        return train

    def _read(self, factors: tuple[float, ...]) -> tuple[Study, System]:
        """Read the file with these factors; raises SolveError if it is at fault."""
        try:
            study = self.variation.study(factors)
        except InputError as error:
            message = "; ".join(fault.message for fault in error.faults)
            raise SolveError(
                f"the file with updated parameters is invalid: {message}", "a smaller deviation"
            ) from None
        if self.system.model == "lumped":
            return study, as_divided(self.system, study.train)
        return study, of_train(self.system, study.train)

    def modes(self, factors: Sequence[float]) -> Modes:
        """Return the lowest modes of the file read with these factors."""
        return modes_as_discretised(self._assembled(tuple(factors))[1], self.count)

    def frequencies(self, factors: Sequence[float]) -> FloatArray:
        """Return the lowest frequencies (modes,) Hz."""
        if self.closed is None:
            return self.modes(factors).frequency
        modes = self.closed.evaluated(tuple(factors)).modes
        return np.asarray(modes.frequency / (2.0 * math.pi))

    def amplitudes(
        self, factors: Sequence[float], curve: Curve, speed: FloatArray | None = None
    ) -> ComplexArray:
        """Return amplitudes (speeds,) in SI; raises SolveError if the response has no value there."""
        study, system = self._assembled(tuple(factors))
        response = response_of_orders(
            study, system, [curve.order], curve.speed if speed is None else speed
        )
        line = [line.order for line in response.lines].index(curve.order)
        if (response.status[:, line] == Status.SINGULAR).any():
            raise no_value(curve)
        values = response.torque if curve.quantity == "torque" else response.angle
        amplitudes = values[:, line, target_position(system, curve)]
        if curve.quantity == "speed":
            amplitudes = amplitudes * (2j * math.pi * response.frequency[:, line])
        return np.asarray(amplitudes)

    def logarithms(self, factors: Sequence[float], numbers: Sequence[int]) -> FloatArray:
        """Return ln of the frequencies of the modes `numbers` (from 0), and of all amplitudes; then their phases in rad."""
        rows = [np.log(self.frequencies(factors)[list(numbers)])] if len(numbers) else []
        closed = None if self.closed is None else self.closed.evaluated(tuple(factors))
        for position, curve in enumerate(self.curves):
            values = np.log(
                self.amplitudes(factors, curve) if closed is None else closed.amplitude(position)
            )
            rows += [values.real, values.imag] if curve.has_phase else [values.real]
        return np.concatenate(rows)

    def wrapped(self, difference: FloatArray, modes: int) -> FloatArray:
        """Return differences of `logarithms` of so many modes with phases within half a revolution."""
        begin, wrapped = modes, difference.copy()
        for curve in self.curves:
            begin += curve.speed.size
            if curve.has_phase:
                phases = slice(begin, begin + curve.speed.size)
                wrapped[phases] = np.angle(np.exp(1j * wrapped[phases]))
                begin = phases.stop
        return wrapped

    def slopes(self, logs: FloatArray, numbers: Sequence[int]) -> FloatArray:
        """Return d `logarithms`/d ln factor (measurements, figures)."""
        if self.closed is None:
            return self._differences(
                logs, lambda factors: self.logarithms(factors, numbers), len(numbers)
            )
        closed = self.closed.evaluated(tuple(np.exp(logs).tolist()))
        rows = [closed.mode_slopes(numbers)] if len(numbers) else []
        for position, curve in enumerate(self.curves):
            slopes = closed.amplitude_slopes(position)
            rows += [slopes.real, slopes.imag] if curve.has_phase else [slopes.real]
        return np.vstack(rows)

    def mode_slopes(self, logs: FloatArray, numbers: Sequence[int]) -> FloatArray:
        """Return d ln frequency/d ln factor (modes, figures)."""
        if self.closed is not None:
            return self.closed.evaluated(tuple(np.exp(logs).tolist())).mode_slopes(numbers)
        return self._differences(
            logs, lambda factors: np.log(self.frequencies(factors)[list(numbers)]), None
        )

    def _differences(
        self, logs: FloatArray, values: Callable[[Sequence[float]], FloatArray], modes: int | None
    ) -> FloatArray:
        """Return central differences; the phases of curves lie behind so many modes, None for no curves."""
        columns = []
        for step in STEP * np.eye(len(logs)):
            low, high = (values(np.exp(logs + sign * step).tolist()) for sign in (-1.0, 1.0))
            change = high - low if modes is None else self.wrapped(high - low, modes)
            columns.append(change / (2.0 * STEP))
        return np.stack(columns, axis=1)


def resolved_for(system: System, curves: Sequence[Curve]) -> System:
    """Return the system divided finely enough for every order that was measured."""
    tops = (float(curve.order) * curve.speed.max() / (2.0 * math.pi) for curve in curves)
    return resolving(system, max(tops, default=0.0))
