"""Modes and responses of a train at any values of its parameters, with exact slopes, from a train in columns.

The slopes of the train's rows follow from a complex step through its lowering. The slopes of frequencies are shares of
energy, those of amplitudes follow from one adjoint response (`sensitivities`).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from torsion.analyses.response.harmonic_components import Excitation, excitations, sources
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly import as_divided
from torsion.assembly.system import System
from torsion.columns import NotInColumns, picker
from torsion.errors import SolveError
from torsion.kernels.loops import Chords, graph_modes, looped_response
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.sensitivities import (
    compliance_slopes,
    frequency_sensitivity,
    response_sensitivity,
)
from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import (
    Status,
    TreeResponse,
    complex_compliance,
    status,
    tree_response,
)
from torsion.study import Study, Variation
from torsion.what_if.fit.measurements import Curve
from torsion.what_if.variants.train_rows import Numbers, TrainRows, rows_on_tree

COMPLEX_STEP = 1e-20  # relative: no difference is formed, so that no digit is lost
STEP = (
    1e-3  # of logarithms, of the differences of fourth order of what acts; their error is STEP^4/30
)


@dataclass(frozen=True)
class Target:
    """What a curve is of, on the tree."""

    is_torque: bool
    position: int  # span or station of the tree
    factor: ComplexArray  # (points,) or one: what it is over that of the tree


@dataclass(frozen=True)
class ClosedForms:
    """A train whose parameters are columns, and what was measured of it."""

    variation: Variation
    system: System
    curves: tuple[Curve, ...]
    targets: tuple[Target, ...]  # of each curve
    excitations: tuple[Excitation, ...]
    speed: FloatArray  # (speeds,) rad/s, of all curves
    count: int  # of the modes

    @cached_property
    def evaluated(self) -> Callable[[tuple[float, ...]], "Evaluated"]:
        """The function from factors of the parameters to modes, responses and slopes, with a cache of eight."""
        return lru_cache(maxsize=8)(lambda factors: Evaluated(self, np.array(factors)))

    def studies(self, factors: FloatArray) -> Iterator[tuple[Study, System]]:
        """Yield the study and the system of each row of factors (variants, figures)."""
        train = self.variation.in_columns(factors)
        study_of = self.variation.studies(train)
        for variant in range(len(factors)):
            study = study_of(variant)
            divided = as_divided(self.system, study.train)
            if extra := self.system.condensed.extra.tolist():
                # The stiffest spans of a variant may be others.
                is_extra = np.isin(np.arange(len(divided.spans)), extra)
                divided = replace(divided, in_tree=~is_extra)
            yield study, divided

    def acting(self, study: Study, system: System) -> Numbers:
        """Return what acts on the tree and what damps it to ground (rows, speeds): block by block as `blocks` cuts it."""
        steady = steady_if_known(study, system, self.speed)
        size, extra = system.condensed.tree.size, len(system.condensed.extra)
        ground = np.zeros((size, len(self.speed)))
        damping = ground_damping(system, self.speed, steady)
        ground[system.condensed.node] = damping * (system.speed_ratio**2)[:, None]
        rows: list[Numbers] = [ground]
        orders = {curve.order for curve in self.curves}
        for excitation in excitations(system, orders):
            if excitation.line.order in orders:
                source = sources(system, excitation, self.speed, steady)
                none = np.zeros((size, len(self.speed))), np.zeros((extra, len(self.speed)))
                rows.append(source.force)
                rows.append(none[0] if source.twist is None else source.twist)
                rows.append(none[1] if source.loop_twist is None else source.loop_twist)
        return np.vstack(rows)

    def blocks(self, rows: Numbers, curve: int) -> tuple[Numbers, ...]:
        """Return damping to ground, force, twist and twist of chords for one curve, at all speeds or figures."""
        size, extra = self.system.condensed.tree.size, len(self.system.condensed.extra)
        order = self.curves[curve].order
        line = next(
            k for k, excitation in enumerate(self.excitations) if excitation.line.order == order
        )
        begin = size + line * (2 * size + extra)
        force, twist, loop_twist = np.split(
            rows[begin : begin + 2 * size + extra], [size, 2 * size]
        )
        return rows[:size], force, twist, loop_twist


def closed_forms(
    variation: Variation, system: System, curves: tuple[Curve, ...], count: int
) -> ClosedForms | None:
    """Return the closed forms of a train of springs, dampers and lumped inertias; None of any other train."""
    train, orders = system.train, {curve.order for curve in curves}
    if (
        system.tables
        or system.bars is not None
        or train.modal_damping
        or train.has_nonlinear_couplings
        or train.has_tables_over("vibratory torque")
        or (np.isinf(system.flexibility) & (system.viscous == 0.0)).any()
    ):
        return None
    lines = tuple(line for line in excitations(system, orders) if line.line.order in orders)
    targets = tuple(_target(system, curve) for curve in curves)
    if any(len(line.apart) > 1 for line in lines) or any(
        target.position < 0 for target in targets
    ):  # the torque of a chord
        return None
    speed = np.unique(np.concatenate([[], *(curve.speed for curve in curves)]))
    forms = ClosedForms(variation, system, curves, targets, lines, speed, count)
    try:
        _ = Evaluated(forms, np.ones(len(variation.figures))).slopes
    except NotInColumns:
        return None
    return forms


def no_value(curve: Curve) -> SolveError:
    """Return the error of a resonance without damping."""
    return SolveError(
        f"the response of order {curve.order} has no finite value at a speed", "give damping"
    )


def target_position(system: System, curve: Curve) -> int:
    """Return the span of a torque, the first of its component, or the station of anything else."""
    if curve.quantity == "torque":
        parts = (system.train.parts[span.part].name for span in system.spans)
        return next(k for k, name in enumerate(parts) if name == curve.at)
    return next(k for k, station in enumerate(system.stations) if station.name == curve.at)


def _target(system: System, curve: Curve) -> Target:
    condensed, position = system.condensed, target_position(system, curve)
    if curve.quantity == "torque":
        factor = np.array(condensed.sign[position] / system.span_ratio[position])
        return Target(True, int(condensed.span[position]), factor)
    factor = 1j * float(curve.order) * curve.speed if curve.quantity == "speed" else np.array(1.0)
    return Target(
        False, int(condensed.node[position]), np.asarray(system.speed_ratio[position] * factor)
    )


def _log_slopes(values: Numbers, derivative: Numbers) -> Numbers:
    """Return derivatives over values; 0 where there is no finite value."""
    used = (values != 0.0) & np.isfinite(values) & np.isfinite(derivative)
    return np.where(used, derivative, 0.0) / np.where(used, values, 1.0)


class Evaluated:
    """The train with its parameters at factors (figures,)."""

    def __init__(self, forms: ClosedForms, factors: FloatArray) -> None:
        self.forms, self.factors = forms, factors
        ((self.study, self.system),) = forms.studies(factors[None])
        condensed, extra = self.system.condensed, self.system.condensed.extra
        ratio2 = self.system.span_ratio[extra] ** 2
        self.tree = condensed.tree
        self.chords = (
            self.system.flexibility[extra] / ratio2,
            self.system.viscous[extra] * ratio2,
            self.system.loss_factor[extra],
        )
        self.responses = dict[int, tuple[TreeResponse, dict[str, Any], tuple[Numbers, ...]]]()

    @cached_property
    def acting(self) -> Numbers:
        """What acts on the tree at these parameters, (rows, speeds)."""
        return self.forms.acting(self.study, self.system)

    @cached_property
    def slopes(self) -> TrainRows:
        """Slopes of the logarithms of the train's rows by those of the parameters, for the variants of `TrainRows`."""
        count = len(self.factors)
        steps = self.factors * (1.0 + 1j * COMPLEX_STEP * np.eye(count))
        train = self.forms.variation.in_columns(steps)
        rows = rows_on_tree(self.system, train, count, complex)
        by_row = (
            _log_slopes(row.real, row.imag / COMPLEX_STEP)
            for row in (
                rows.flexibility,
                rows.inertia,
                rows.viscous,
                rows.loss_factor,
                rows.closing,
            )
        )
        return TrainRows(*by_row)

    @cached_property
    def acting_slopes(self) -> Numbers:
        """(figures, rows, speeds) slopes of the logarithms of `acting`; 0 if no parameter acts.

        By differences of fourth order: what acts is a polynomial of the parameters, or turns with a phase.
        """
        forms, count = self.forms, len(self.factors)
        train = forms.variation.in_columns(self.factors[None])
        errors = tuple(mesh.error for mesh in train.constraints)
        loads = train.parts if self.study.has_mean_torque else ()
        slopes = np.zeros((count, *self.acting.shape), dtype=complex)
        if picker((train.dampers, train.torques, errors, loads)) is None:
            return slopes
        steps = STEP * np.array([-2.0, -1.0, 1.0, 2.0])[:, None, None] * np.eye(count)
        factors = (self.factors * np.exp(steps)).reshape(-1, count)
        ends = np.array([forms.acting(*changed) for changed in forms.studies(factors)])
        far_below, below, above, far_above = ends.reshape(4, *slopes.shape)
        change = 8.0 * (above - below) - (far_above - far_below)
        return _log_slopes(np.broadcast_to(self.acting, slopes.shape), change / (12.0 * STEP))

    @cached_property
    def modes(self) -> TreeModes:
        """The lowest `count` natural modes at these parameters."""
        tree, (first, second), holds = self.springs, self.ends, np.isfinite(self.chords[0])
        if not holds.any():
            return tree_modes(tree, self.forms.count)
        return graph_modes(
            tree, first[holds], second[holds], self.chords[0][holds], self.forms.count
        )

    @property
    def springs(self) -> Tree:
        """The tree without the spans that have no stiffness."""
        return self.tree.cut(np.isinf(self.tree.flexibility))

    @property
    def ends(self) -> tuple[IntArray, IntArray]:
        """Tree stations at both ends of each chord."""
        node, extra = self.system.condensed.node, self.system.condensed.extra
        return node[self.system.driving[extra]], node[self.system.driven[extra]]

    def mode_slopes(self, numbers: Sequence[int]) -> FloatArray:
        """Return d ln f/d ln factor (modes, figures)."""
        holds, chosen = np.isfinite(self.chords[0]), list(numbers)
        moved = frequency_sensitivity(self.springs, self.modes, self.chords[0][holds])
        slopes = moved.inertia[:, chosen].T @ self.slopes.inertia
        slopes -= moved.stiffness[:, chosen].T @ self.slopes.flexibility
        return np.asarray(slopes - moved.chord[:, chosen].T @ self.slopes.closing[0][holds])

    def amplitude(self, curve: int) -> ComplexArray:
        """Return the amplitudes of a curve (points,) in SI; raises SolveError if the response has no value there."""
        response, target = self._response(curve)[0], self.forms.targets[curve]
        if (status(response.amplification, response.residual) == Status.SINGULAR).any():
            raise no_value(self.forms.curves[curve])
        return np.asarray(self._value(curve) * target.factor)

    def _value(self, curve: int) -> ComplexArray:
        response, target = self._response(curve)[0], self.forms.targets[curve]
        return np.asarray(
            (response.torque if target.is_torque else response.angle)[target.position]
        )

    def amplitude_slopes(self, curve: int) -> ComplexArray:
        """Return the slopes (points, figures) of the logarithms of `amplitude`."""
        response, given, acting = self._response(curve)
        target, w, chords = self.forms.targets[curve], given.pop("w"), given.pop("chords")
        position = {"span" if target.is_torque else "station": target.position}
        derivatives = response_sensitivity(
            self.tree, w, response, chords=chords, **position, **given
        )
        condensed, slopes = self.system.condensed, self.slopes
        elements = (condensed.tree.flexibility, condensed.viscous, condensed.loss_factor)
        own_slopes = (slopes.flexibility, slopes.viscous, slopes.loss_factor)
        total = (derivatives.inertia * self.tree.moving_inertia[:, None]).T @ slopes.inertia
        total = total + _compliance_terms(derivatives.compliance, w, elements, own_slopes)
        total += _compliance_terms(derivatives.chord, w, self.chords, tuple(slopes.closing))

        # What acts, and what damps to ground, have slopes of their own at every speed.
        speeds = np.searchsorted(self.forms.speed, self.forms.curves[curve].speed)
        for figure, by_row in enumerate(self.acting_slopes[..., speeds]):
            for derivative, rows, row_slopes in zip(
                (
                    derivatives.ground_damping,
                    derivatives.force,
                    derivatives.twist,
                    derivatives.chord_twist,
                ),
                acting,
                self.forms.blocks(by_row, curve),
                strict=True,
            ):
                total[:, figure] += (derivative * rows * row_slopes).sum(axis=0)
        return np.asarray(total / self._value(curve)[:, None])

    def _response(self, curve: int) -> tuple[TreeResponse, dict[str, Any], tuple[Numbers, ...]]:
        """Return the response at the points of a curve, what it was computed with, and what acts."""
        if curve not in self.responses:
            measured = self.forms.curves[curve]
            w = float(measured.order) * measured.speed
            speeds = np.searchsorted(self.forms.speed, measured.speed)
            acting = self.forms.blocks(self.acting[:, speeds], curve)
            ground, force, twist, loop_twist = acting
            condensed = self.system.condensed
            elastic = condensed.tree.flexibility, condensed.viscous, condensed.loss_factor
            given: dict[str, Any] = {
                "ground_damping": ground.real,
                "compliance": complex_compliance(*elastic, w),
            }
            chords = None
            if len(loop_twist):
                chords = Chords(*self.ends, complex_compliance(*self.chords, w), loop_twist)
                response = looped_response(self.tree, chords, w, force, twist=twist, **given)
            else:
                response = tree_response(self.tree, w, force, twist=twist, **given)
            self.responses[curve] = response, given | {"w": w, "chords": chords}, acting
        response, given, acting = self.responses[curve]
        return response, dict(given), acting


def _compliance_terms(
    derivative: ComplexArray,
    w: FloatArray,
    elements: Sequence[FloatArray],
    slopes: Sequence[Numbers],
) -> ComplexArray:
    """Return the sum (points, figures) over spans of flexibility, damper and loss factor `own`; none of rigid spans.

    by: slopes (spans, points) by the complex compliance; slopes: (spans, figures) of the logarithms of `own`.
    """
    flexibility, viscous, loss = elements
    moves = (flexibility > 0.0)[:, None]
    stiffness = 1.0 / np.where(flexibility > 0.0, flexibility, 1.0)
    by_stiffness, by_loss, by_viscous = compliance_slopes(
        stiffness, viscous, loss, 1j * w.astype(np.complex128)
    )
    terms = -by_stiffness, by_viscous * viscous[:, None], by_loss * loss[:, None]
    return np.asarray(
        sum(
            np.where(moves, derivative * term, 0.0).T @ row
            for term, row in zip(terms, slopes, strict=True)
        )
    )
