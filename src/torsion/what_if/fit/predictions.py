"""What a train has of what was measured, at any values of its parameters: frequencies, amplitudes and their slopes."""

import math
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache

import numpy as np

from torsion.analyses.response.over_speed import response_of_orders
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly import as_divided, of_train, resolving
from torsion.assembly.system import System
from torsion.columns import NotInColumns
from torsion.errors import InputError, SolveError
from torsion.kernels.tree_response import Status
from torsion.study import Study, Variation
from torsion.what_if.fit.exact_slopes import ExactSlopes
from torsion.what_if.fit.measurements import Curve

STEP = 1e-5  # of the logarithm of a factor: a central difference errs by some 1e-10 of its square and 1e-11 of rounding
Factors = tuple[float, ...]


class Train:
    """The train of a file with its parameters at given factors, divided as that of the file is."""

    def __init__(
        self, variation: Variation, system: System, curves: tuple[Curve, ...], count: int
    ) -> None:
        self.variation, self.curves, self.count = variation, curves, count
        self.system = system  # of the file, as finely as all that was measured needs
        self._assembled = lru_cache(maxsize=64)(self._read)
        self._modes = lru_cache(maxsize=64)(
            lambda factors: modes_as_discretised(self._assembled(factors)[1], count)
        )

    def _read(self, factors: Factors) -> tuple[Study, System]:
        """Return study and system with these factors; raises SolveError if the file is at fault."""
        try:
            try:
                train = self.variation.in_columns(np.array([factors]))
                study = self.variation.studies(train)(0)
            except NotInColumns:
                study = self.variation.study(factors)
        except InputError as error:
            message = f"the file with updated parameters is invalid: {error.message}"
            raise SolveError(message, "a smaller deviation") from None
        if self.system.model == "lumped":
            return study, as_divided(self.system, study.train)
        return study, of_train(self.system, study.train)

    def modes(self, factors: Iterable[float]) -> Modes:
        """Return the lowest modes with these factors."""
        return self._modes(tuple(factors))

    def amplitudes(
        self, factors: Iterable[float], curve: Curve, speed: FloatArray | None = None
    ) -> ComplexArray:
        """Return amplitudes (speeds,) in SI; raises SolveError if the response has no value there."""
        study, system = self._assembled(tuple(factors))
        speeds = curve.speed if speed is None else speed
        response = response_of_orders(study, system, [curve.order], speeds)
        line = [line.order for line in response.lines].index(curve.order)
        if (response.status[:, line] == Status.SINGULAR).any():
            raise SolveError(
                f"the response of order {curve.order} has no finite value at a speed",
                "give damping",
            )
        return curve.of_response(system, speeds, response.angle[:, line], response.torque[:, line])

    def logarithms(self, factors: Iterable[float], numbers: Sequence[int]) -> FloatArray:
        """Return ln of the frequencies of the modes `numbers` (from 0), and of all amplitudes; then their phases in rad."""
        at = tuple(factors)
        rows = [np.log(self.modes(at).frequency[list(numbers)])] if len(numbers) else []
        for curve in self.curves:
            values = np.log(self.amplitudes(at, curve))
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

        def exact(slopes: ExactSlopes) -> FloatArray:
            rows = [self._slopes_of_modes(slopes, logs, numbers)] if len(numbers) else []
            for curve in self.curves:
                by_figure = slopes.of_curve(curve)
                rows += [by_figure.real, by_figure.imag] if curve.has_phase else [by_figure.real]
            return np.vstack(rows)

        def changed(low: Factors, high: Factors) -> FloatArray:
            difference = self.logarithms(high, numbers) - self.logarithms(low, numbers)
            return self.wrapped(difference, len(numbers))

        return self._slopes(logs, exact, changed)

    def mode_slopes(self, logs: FloatArray, numbers: Sequence[int]) -> FloatArray:
        """Return d ln frequency/d ln factor (modes, figures)."""
        return self._slopes(
            logs,
            lambda slopes: self._slopes_of_modes(slopes, logs, numbers),
            lambda low, high: np.log(
                self.modes(high).frequency[list(numbers)] / self.modes(low).frequency[list(numbers)]
            ),
        )

    def _slopes_of_modes(
        self, slopes: ExactSlopes, logs: FloatArray, numbers: Sequence[int]
    ) -> FloatArray:
        return slopes.of_modes(self.modes(np.exp(logs).tolist()))[list(numbers)]

    def _slopes(
        self,
        logs: FloatArray,
        exact: Callable[[ExactSlopes], FloatArray],
        changed: Callable[[Factors, Factors], FloatArray],
    ) -> FloatArray:
        """Return slopes (values, figures): exact where they are known, by central differences of all others."""
        factors = np.exp(logs)
        slopes = ExactSlopes(self.variation, factors, *self._assembled(tuple(factors.tolist())))
        columns = {}
        if slopes.figures.size:
            columns = dict(zip(slopes.figures.tolist(), exact(slopes).T, strict=True))
        for figure, step in enumerate(STEP * np.eye(len(logs))):
            if figure not in columns:
                ends = (tuple(np.exp(logs + sign * step).tolist()) for sign in (-1.0, 1.0))
                columns[figure] = changed(*ends) / (2.0 * STEP)
        return np.stack([columns[figure] for figure in range(len(logs))], axis=1)


def resolved_for(system: System, curves: Sequence[Curve]) -> System:
    """Return the system divided finely enough for every order that was measured."""
    tops = (float(curve.order) * curve.speed.max() / (2.0 * math.pi) for curve in curves)
    return resolving(system, max(tops, default=0.0))
