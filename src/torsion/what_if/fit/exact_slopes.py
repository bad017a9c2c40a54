"""Exact slopes of modes and amplitudes by the parameters of a fit, from a train in columns.

The slopes of the train's numbers follow from a complex step through its lowering. Those of frequencies are shares of
energy; those of amplitudes are one more response, to what a change of each parameter adds to the equations of motion.
"""

import numpy as np

from torsion.analyses.response.harmonic_components import Sources, excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.columns import NotInColumns, picker
from torsion.sources import source
from torsion.study import Study, Variation
from torsion.what_if.fit.measurements import Curve
from torsion.what_if.variants.train_rows import numbers_of_system

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
            train = variation.in_columns(steps)
            if not _is_linear(study, system):
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
        change = _compliance_slopes(system, self.elastic, w)
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


def _is_linear(study: Study, system: System) -> bool:
    """Whether a response is that of springs, dampers and lumped inertias to sources that none of these changes."""
    train = system.train
    has_joints = any(mesh.error for mesh in train.constraints)
    return not (
        system.tables
        or system.bars is not None
        or train.modal_damping
        or train.has_nonlinear_couplings
        or train.has_tables_over("vibratory torque")
        or (has_joints and study.has_mean_torque)  # the static twist turns its phase
        or any(len(excitation.apart) > 1 for excitation in excitations(system))
    )


def _compliance_slopes(system: System, slopes: FloatArray, w: FloatArray) -> ComplexArray:
    """Return derivatives (spans, figures, points) of 1/((1 + i eta)/h + i w c) by each figure.

    slopes: (3, spans, figures) of flexibility h, damper c and loss factor eta.
    """
    flexibility, viscous, loss = (
        values[:, None, None] for values in (system.flexibility, system.viscous, system.loss_factor)
    )
    by_flexibility, by_viscous, by_loss = slopes[..., None]
    is_spring = np.isfinite(flexibility)
    h = np.where(is_spring, flexibility, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(is_spring, 1.0, 0.0) * (1.0 + 1j * loss) + 1j * w * viscous * h
        change = (1.0 + 1j * loss) * by_flexibility - 1j * h * by_loss - 1j * w * h * h * by_viscous
        return np.asarray(change / share**2)
