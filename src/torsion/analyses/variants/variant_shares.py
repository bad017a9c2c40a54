"""The response of many variants as one, behind each other, and the shares of limits that clauses make of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Excitation, excitations, sources
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.steady import Steady, steady_if_known
from torsion.analyses.undamped_modes import span_torques
from torsion.analyses.variants.one_by_one import READ, Key
from torsion.analyses.variants.products import Products, Rows, products
from torsion.analyses.variants.side_by_side import varied
from torsion.arrays import BoolArray, ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.components.lowering import Part
from torsion.findings import Results, Work
from torsion.kernels.tree_response import Status, complex_compliance, status, tree_response
from torsion.kernels.variant_response import EVEN, Trains, resonance_grid
from torsion.study import Study, Variation

SAMPLES = 17  # speeds at which trials are compared, and where tables bend


@dataclass(frozen=True)
class Shares:
    """Shares of limits of every clause, a row each."""

    keys: list[Key]
    share: FloatArray  # (clauses, variants, speeds); 0 where it is not judged
    unlimited: BoolArray  # (clauses, variants) the limit is 0 or less at every speed: nothing is kept, or all is 0
    unclear: BoolArray  # (variants,) a response is not ok, or a limit ends between the speeds


@dataclass(frozen=True)
class Swept:
    """The train of the file with all that its response needs, and how figures enter that."""

    work: Work
    system: System
    found: tuple[Excitation, ...]
    enters: Products
    spans: FloatArray  # (spans,) 1 of those whose vibration is judged, else 0

    @property
    def band(self) -> tuple[float, float]:
        """rad/s of the reference."""
        speeds = self.work.study.operation.speeds
        if speeds is None:
            raise ValueError("no speeds")
        return speeds.first, speeds.last

    def trains(self, factor: FloatArray) -> tuple[Trains, list[float]]:
        """Of variants with factors (rows, variants), as damped in the middle of the band; and the orders that act."""
        size, middle = self.system.condensed.tree.size, np.sqrt([self.band[0] * self.band[1]])
        own = np.real(_rows(self.system, self.found, self.work.study, middle)[: 5 * size]) * factor[: 5 * size]
        trains = Trains(self.system.condensed.tree, *(own[k * size : (k + 1) * size] for k in range(5)))
        return trains, [float(one.line.order) for one in self.found if one.line.order is not None]

    def displaces(self, factor: FloatArray) -> bool:
        """Damping moves a resonance away from where `grid` looks for it."""
        trains, orders = self.trains(factor)
        return trains.displaces(max(orders) * self.band[1])

    def grid(self, factor: FloatArray, modes: int) -> tuple[FloatArray, FloatArray]:
        """Speeds (variants, points) rad/s, and natural frequencies (modes, variants) rad/s."""
        (trains, orders), (first, last) = self.trains(factor), self.band
        frequency, ratio = trains.resonances(max(orders, default=0.0) * last, modes)
        centre = [frequency / order for order in orders]
        named = self.work.rules.named_speeds(self.work.study)
        fixed = np.union1d(np.linspace(first, last, EVEN), named[(named > first) & (named < last)])
        return resonance_grid(np.concatenate(centre), np.tile(ratio, len(orders)), fixed), frequency

    def shares(self, speed: FloatArray, factor: FloatArray) -> Shares:
        """Of variants with factors (rows, variants) of the train's rows, at speeds (variants, points) rad/s of each."""
        shape, evidence = speed.shape, self.evidence(speed, factor)
        keys, share, unlimited, unclear = list[Key](), [], [], np.zeros(len(speed), dtype=np.bool_)
        for rule, clause in self.work.rules.pointwise(evidence):
            curve, within = clause.curve, clause.within
            if curve.speed is not evidence.need(Response).speed:  # of the mean torque, which all variants share
                worst = np.max(curve.utilisation(), where=within, initial=-np.inf)
                share.append(np.full(shape, worst))
                unlimited.append(np.zeros(len(speed), dtype=np.bool_))
                unclear |= not np.isfinite(worst)
            else:
                used, limit = (
                    np.where(within, own, 0.0).reshape(shape) for own in (curve.utilisation(), curve.limit <= 0.0)
                )
                none = (limit > 0.0) | ~within.reshape(shape)
                unlimited.append(none.all(axis=1) & within.any())
                unclear |= (limit.any(axis=1) & ~unlimited[-1]) | np.isnan(used).any(axis=1)
                unclear |= (curve.status != Status.OK).reshape(shape).any(axis=1)
                share.append(used)
            keys.append((rule, clause.clause, clause.where, clause.what))
        return Shares(keys, np.array(share), np.array(unlimited), unclear)

    def evidence(self, speed: FloatArray, factor: FloatArray) -> Results:
        """The responses of all variants as one."""
        study, system, points, flat = self.work.study, self.system, speed.shape[1], speed.ravel()
        known = steady_if_known(study, system, flat)
        rows, size = _rows(system, self.found, study, flat, known), system.condensed.tree.size
        rows *= np.repeat(factor, points, axis=1)
        flexibility, inertia, viscous, loss, ground, *acting = rows.reshape(-1, size, flat.size)
        frequency = np.stack([one.line.circular_frequency(flat) for one in self.found], axis=1)
        torque = np.zeros((flat.size, len(self.found), len(system.spans)), dtype=np.complex128)
        residual, amplification = np.empty((2, *frequency.shape))
        tree = replace(system.condensed.tree, flexibility=flexibility.real, inertia=inertia.real)
        for k in range(len(self.found)):
            w = np.ascontiguousarray(frequency[:, k])
            hc = complex_compliance(tree.flexibility, viscous.real, loss.real, w)
            one = tree_response(
                tree, w, acting[2 * k], twist=acting[2 * k + 1], ground_damping=ground.real, compliance=hc
            )
            torque[:, k] = (span_torques(system, one.torque) * self.spans[:, None]).T
            residual[:, k], amplification[:, k] = one.residual, one.amplification
        mean = np.zeros((flat.size, len(system.spans))) if known is None else known.torque.T
        response = Response(
            flat, np.zeros(flat.size, dtype=bool), tuple(one.line for one in self.found), frequency / (2.0 * np.pi),
            np.zeros((*frequency.shape, 0), dtype=np.complex128), torque, mean, residual,
            status(amplification.ravel(), residual.ravel()).reshape(frequency.shape), np.zeros(frequency.shape),
            _of_columns(system, rows.reshape(-1, size, flat.size)[:4].real),
        )  # fmt: skip
        steady = self.work.get(Steady)
        found: dict[str, Any] = {} if steady is None else {"mean": steady}
        found |= {"system": response.system, "response": response, "synthesis": synthesis(response)}
        return Results(study, found)


def _of_columns(system: System, rows: FloatArray) -> System:
    """The system with a column of flexibility and damping for each speed; rows: (4, tree stations, columns)."""
    node, own = system.condensed.span, system.condensed.tree.flexibility
    with np.errstate(all="ignore"):
        times = np.where(own[:, None] > 0.0, rows[0] / own[:, None], 1.0)[node]
    ratio = system.span_ratio[:, None] ** 2
    flexibility, viscous = system.flexibility[:, None] * times, rows[2][node] / ratio
    return replace(system, flexibility=flexibility, viscous=viscous, loss_factor=rows[3][node])


def _rows(
    system: System, found: Sequence[Excitation], study: Study, speed: FloatArray, known: Steady | None = None
) -> ComplexArray:
    """Rows (stations of the tree times (5 + twice the lines), speeds): what the response is made of."""
    condensed, known = system.condensed, known or steady_if_known(study, system, speed)
    ground = np.zeros((condensed.tree.size, len(speed)))
    ground[condensed.node] = ground_damping(system, speed, known) * (system.speed_ratio**2)[:, None]
    own = condensed.tree.flexibility, condensed.tree.moving_inertia, condensed.viscous, condensed.loss_factor
    rows: list[Rows] = [*(np.repeat(one[:, None], len(speed), axis=1) for one in own), ground]
    for one in found:
        acting = sources(system, one, speed, known)
        rows += [acting.force, np.zeros_like(acting.force) if acting.twist is None else acting.twist]
    return np.concatenate(rows).astype(np.complex128)


def unfit(work: Work) -> str:
    """Why the variants cannot be judged side by side, as far as the file says; empty where they may be."""
    from torsion.analyses import ANALYSES

    study, system, train, response = work.study, work.system, work.study.train, work.get(Response)
    if not work.rules.are_pointwise(study):
        return "a rule of the file is not judged at each speed by itself"
    if any(name in study.analyses or ANALYSES[name].wanted(study) for name in READ):
        return "the file has other analyses that are judged"
    if response is None or response.system is not system or system.resolved_to < np.inf:
        return "shafts are divided as each variant needs"
    if system.bars is not None or system.tables or system.groups is not None or system.condensed.extra.size:
        return "shafts with inertia, tables or loops"
    if train.modal_damping or not np.isfinite(system.flexibility).all() or study.has_supports:
        return "damping by mode, couplings without stiffness or bending"
    odd = ("nonlinear", "warming", "joint", "pendulum", "engine", "compressor")
    if any(getattr(part, key) is not None for part in train.parts for key in odd):
        return "engines, joints, couplings that are not linear or get warm"
    return ""


def _read_alike(part: Part) -> tuple[object, ...]:
    """What rules read of a component."""
    return (
        part.name, part.kind, part.stations, part.ratio, part.ratings, part.application_factor, part.max_torque,
        part.damping is None, part.nonlinear, part.warming, part.joint, part.pendulum, part.engine, part.compressor,
    )  # fmt: skip


def swept(work: Work, variation: Variation, values: FloatArray) -> Swept | None:
    """The train with how figures enter it; None where that is not known."""
    study, system = work.study, work.system
    speeds, found = study.operation.speeds, excitations(system)
    if speeds is None or not found or not any(one.line.order is not None for one in found):
        return None
    sample = np.union1d(np.geomspace(speeds.first, speeds.last, SAMPLES), work.rules.named_speeds(study))
    sample = sample[(sample >= speeds.first) & (sample <= speeds.last)]
    mean, same = steady_if_known(study, system, sample), [_read_alike(part) for part in study.train.parts]

    def read(other: Study) -> Rows | None:
        own = varied(system, other)
        condensed, base, lines = own.condensed, system.condensed, excitations(own)
        alike = all(
            np.array_equal(getattr(condensed, key), getattr(base, key)) for key in ("node", "span", "sign", "extra")
        )
        alike = alike and np.array_equal(condensed.tree.parent, base.tree.parent)
        alike = alike and [one.line for one in lines] == [one.line for one in found]
        alike = alike and [_read_alike(part) for part in other.train.parts] == same
        alike = alike and (other.operation, other.rules) == (study.operation, study.rules)
        alike = alike and other.analyses.get("response") == study.analyses.get("response")
        if not alike or own.segments != system.segments:
            return None
        there = steady_if_known(other, own, sample)
        if (there is None) != (mean is None):
            return None
        if there is not None and mean is not None and not np.allclose(there.torque, mean.torque, rtol=1e-12, atol=0.0):
            return None
        return _rows(own, lines, other, sample, there)

    enters = products(variation, values, read)
    if enters is None:
        return None
    whole, judged = Swept(work, system, found, enters, np.ones(len(system.spans))), np.zeros(len(system.spans))
    evidence = whole.evidence(sample[None], np.ones((len(enters.power), 1)))
    for _, clause in work.rules.pointwise(evidence):
        judged[clause.spans] = 1.0
    return replace(whole, spans=judged)
