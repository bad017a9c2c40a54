"""What a train has of what was measured, at any values of its parameters: frequencies, amplitudes and their slopes."""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache

import numpy as np

from torsion.analyses.response.harmonic_components import Sources, excitations, sources
from torsion.analyses.response.over_speed import response_of_orders
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly import as_divided, of_train, resolving
from torsion.assembly.system import System
from torsion.columns import NotInColumns, picker
from torsion.errors import InputError, SolveError
from torsion.kernels.trees.tree_response import Status
from torsion.sources import source
from torsion.study import Study, Variation
from torsion.what_if.fit.measurements import Curve
from torsion.what_if.variants.frequencies import numbers_of_system

COMPLEX_STEP = 1e-20  # relative: no difference is formed, so that no digit is lost


class ExactSlopes:
    """The slopes by those parameters of a train, at factors (figures,), that neither excite nor damp to ground.

    study, system: of these factors. `figures`: which parameters have slopes here; none of another train than a linear
    one of springs and lumped inertias.
    """

    def __init__(
        self, variation: Variation, factors: FloatArray, study: Study, system: System
    ) -> None:
        self.study, self.system = study, system
        self.figures: IntArray = np.empty(0, dtype=np.int64)
        count = len(factors)
        steps = factors * (1.0 + 1j * COMPLEX_STEP * np.eye(count + 1, count))
        try:
            train, base = variation.in_columns(steps), system.train
            has_joints = any(mesh.error for mesh in base.constraints)
            if (
                system.tables
                or system.bars is not None
                or base.modal_damping
                or base.has_nonlinear_couplings
                or base.has_tables_over("vibratory torque")
                or (has_joints and study.has_mean_torque)  # the static twist turns its phase
                or any(len(excitation.apart) > 1 for excitation in excitations(system))
            ):
                return
            inertia, elastic = numbers_of_system(system, train, count + 1, complex)
        except NotInColumns:
            return

        # What excites the train and what damps it to ground.
        machines = tuple((part.machine, part.compressor, part.engine) for part in train.parts)
        errors = tuple(mesh.error for mesh in train.constraints)
        pick = picker((train.dampers, train.torques, errors, machines)) or (lambda _: ())
        nominal = pick(count)
        self.figures = np.array([k for k in range(count) if pick(k) == nominal], dtype=np.int64)

        # A flexibility without end has no complex step; no torque passes there but by a damper.
        self.inertia, self.elastic = (
            np.nan_to_num(numbers.imag[..., self.figures] / COMPLEX_STEP, posinf=0.0, neginf=0.0)
            for numbers in (inertia, elastic)
        )

    @source("Rayleigh1877")
    def of_modes(self, modes: Modes) -> FloatArray:
        """Return d ln frequency/d ln factor (modes, figures): half the shares of energy (1, art. 90)."""
        flexibility, inertia = (
            np.where((values > 0.0) & np.isfinite(values), values, np.inf)[:, None]
            for values in (self.system.flexibility, self.system.lumped_inertia)
        )
        of_springs = modes.elastic.T @ (self.elastic[0] / flexibility)
        return np.asarray(-0.5 * (of_springs + modes.kinetic.T @ (self.inertia / inertia)))

    def of_curve(self, curve: Curve) -> ComplexArray:
        """Return the slopes (points, figures) of the logarithms of the amplitudes of a curve."""
        system, condensed, count = self.system, self.system.condensed, len(self.figures)
        (excitation,) = excitations(system, [curve.order])
        steady = steady_if_known(self.study, system, curve.speed)
        damping = ground_damping(system, curve.speed, steady)
        w = excitation.line.circular_frequency(curve.speed)
        value = answer(system, w, sources(system, excitation, curve.speed, steady), damping)

        # A change of inertia acts as a torque, one of a compliance as an imposed twist.
        angle, torque = value.angle.T[:, None], value.torque.T[:, None]
        jump = w * w * self.inertia[..., None] * angle * system.speed_ratio[:, None, None]
        flexibility, c, eta = (
            values[:, None, None]
            for values in (system.flexibility, system.viscous, system.loss_factor)
        )
        by_flexibility, by_viscous, by_loss = self.elastic[..., None]

        # Of the compliance 1/((1 + i eta)/h + i w c) of a spring with flexibility h (spans, figures, points).
        is_spring = np.isfinite(flexibility)
        h = np.where(is_spring, flexibility, 1.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            change = (1.0 + 1j * eta) * by_flexibility - 1j * h * (by_loss + w * h * by_viscous)
            change /= (np.where(is_spring, 1.0, 0.0) * (1.0 + 1j * eta) + 1j * w * c * h) ** 2
        slip = np.where(torque == 0.0, 0.0, -change * torque / system.span_ratio[:, None, None])
        force, twist = np.zeros((2, condensed.tree.size, count, len(w)), dtype=np.complex128)
        np.add.at(force, condensed.node, jump)
        kept = np.flatnonzero(condensed.span >= 0)
        twist[condensed.span[kept]] = (condensed.sign[:, None, None] * slip)[kept]
        acting = force, twist, slip[condensed.extra]
        rows = (values.reshape(len(values), count * len(w)) for values in acting)
        changed = answer(system, np.tile(w, count), Sources(*rows), np.tile(damping, count))

        speeds = np.tile(curve.speed, count)
        slopes = curve.of_response(system, speeds, changed.angle, changed.torque)
        values = curve.of_response(system, curve.speed, value.angle, value.torque)
        return (slopes.reshape(count, -1) / values).T


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
            study = self.variation.studies(np.array([factors]))(0)
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

    def logarithms(
        self, factors: Sequence[float], numbers: Sequence[int], curves: Sequence[Curve]
    ) -> FloatArray:
        """Return ln of the frequencies of the modes `numbers` (from 0), and of all amplitudes; then their phases in rad."""
        rows = [np.log(self.modes(factors).frequency[list(numbers)])] if len(numbers) else []
        for curve in curves:
            values = np.log(self.amplitudes(factors, curve))
            rows += [values.real, values.imag] if curve.has_phase else [values.real]
        return np.concatenate(rows)

    def wrapped(self, difference: FloatArray, modes: int, curves: Sequence[Curve]) -> FloatArray:
        """Return differences of `logarithms` of so many modes with phases within half a revolution."""
        begin, wrapped = modes, difference.copy()
        for curve in curves:
            begin += curve.speed.size
            if curve.has_phase:
                phases = slice(begin, begin + curve.speed.size)
                wrapped[phases] = np.angle(np.exp(1j * wrapped[phases]))
                begin = phases.stop
        return wrapped

    def slopes(
        self, logs: FloatArray, numbers: Sequence[int], curves: Sequence[Curve]
    ) -> FloatArray:
        """Return d `logarithms`/d ln factor (values, figures): exact where known, else by central differences."""
        factors = tuple(np.exp(logs).tolist())
        slopes = ExactSlopes(self.variation, np.exp(logs), *self._assembled(factors))
        columns = {}
        if slopes.figures.size:
            rows = [slopes.of_modes(self.modes(factors))[list(numbers)]] if len(numbers) else []
            for curve in curves:
                by_figure = slopes.of_curve(curve)
                rows += [by_figure.real, by_figure.imag] if curve.has_phase else [by_figure.real]
            columns = dict(zip(slopes.figures.tolist(), np.vstack(rows).T, strict=True))
        for figure, step in enumerate(STEP * np.eye(len(logs))):
            if figure not in columns:
                low, high = (
                    self.logarithms(np.exp(logs + sign * step).tolist(), numbers, curves)
                    for sign in (-1.0, 1.0)
                )
                columns[figure] = self.wrapped(high - low, len(numbers), curves) / (2.0 * STEP)
        return np.stack([columns[figure] for figure in range(len(logs))], axis=1)


def resolved_for(system: System, curves: Sequence[Curve]) -> System:
    """Return the system divided finely enough for every order that was measured."""
    tops = (float(curve.order) * curve.speed.max() / (2.0 * math.pi) for curve in curves)
    return resolving(system, max(tops, default=0.0))
