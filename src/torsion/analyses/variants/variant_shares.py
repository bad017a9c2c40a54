"""The response of many variants as one, behind each other, and the shares of limits that clauses make of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsion.analyses.discretisation import highest_excited
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Excitation, excitations, sources
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.steady import Steady, steady_if_known
from torsion.analyses.undamped_modes import Modes, span_torques
from torsion.analyses.variants.one_by_one import READ, Key
from torsion.analyses.variants.products import UNCHANGED, Products, Rows, products
from torsion.arrays import BoolArray, ComplexArray, FloatArray
from torsion.assembly import as_divided
from torsion.assembly.lumped import SHARE_OF_ERROR, excess, is_refined, segments_along
from torsion.assembly.shafts import phase
from torsion.assembly.system import System
from torsion.components.lowering import Part
from torsion.findings import Results, Work
from torsion.kernels.tree_response import Status, complex_compliance, status, tree_response
from torsion.kernels.variant_response import EVEN, Trains, resonance_grid
from torsion.study import Study, Variation
from torsion.train import Train

ROUNDING = 1e-9  # relative, of a frequency
RESOLVED = (
    3.0 * SHARE_OF_ERROR
)  # relative: how near trains that resolve a mode have it to each other
SAMPLES = 17  # speeds at which trials are compared, and where tables bend


@dataclass(frozen=True)
class Shares:
    """Shares of limits of every clause, a row each."""

    keys: list[Key]
    share: FloatArray  # (clauses, variants, speeds); 0 where it is not judged
    unlimited: BoolArray  # (clauses, variants) the limit is 0 or less at every speed: nothing is kept, or all is 0
    unclear: BoolArray  # (variants,) a response is not ok, or a limit ends between the speeds
    if_kept: BoolArray  # (clauses,) a variant beyond the limit is judged otherwise


Limit = tuple[str, str, str, str, str]  # rule, clause, where, what, standing


@dataclass(frozen=True)
class Swept:
    """The train of the file with all that its response needs, and how figures enter that."""

    work: Work
    system: System
    found: tuple[Excitation, ...]
    enters: (
        Products  # the rows of the response, behind them the phases along shafts, and the limits
    )
    spans: FloatArray  # (spans,) 1 of those whose vibration is judged, else 0
    limits: tuple[Limit, ...]  # what each of these last rows is the limit of
    highest: float = 0.0  # Hz, up to which the response is requested

    @property
    def band(self) -> tuple[float, float]:
        """rad/s of the reference."""
        first, last = self.work.rules.judged_band(self.work.study)
        return first, last

    def trains(self, factor: Rows) -> tuple[Trains, list[float]]:
        """Of variants with factors (rows, variants), as damped in the middle of the band; and the orders that act."""
        size, middle = self.system.condensed.tree.size, np.sqrt([self.band[0] * self.band[1]])
        own = np.real(
            _rows(self.system, self.found, self.work.study, middle)[: 5 * size]
        ) * np.real(factor[: 5 * size])
        trains = Trains(
            self.system.condensed.tree, *(own[k * size : (k + 1) * size] for k in range(5))
        )
        return trains, [float(one.line.order) for one in self.found if one.line.order is not None]

    def displaces(self, factor: Rows) -> bool:
        """Damping moves a resonance away from where `grid` looks for it."""
        trains, orders = self.trains(factor)
        return trains.displaces(max(orders) * self.band[1])

    def grid(self, factor: Rows, modes: int) -> tuple[FloatArray, FloatArray]:
        """Speeds (variants, points) rad/s, and natural frequencies (modes, variants) rad/s."""
        (trains, orders), (first, last) = self.trains(factor), self.band
        frequency, ratio = trains.resonances(
            max(orders, default=0.0) * last, max(modes, self.modes)
        )
        centre = [frequency / order for order in orders]
        named = self.work.rules.named_speeds(self.work.study)
        fixed = np.union1d(np.linspace(first, last, EVEN), named[(named > first) & (named < last)])
        return resonance_grid(np.concatenate(centre), np.tile(ratio, len(orders)), fixed), frequency

    @property
    def modes(self) -> int:
        """For how many its shafts are divided."""
        known = self.work.get(Modes)
        return 0 if known is None else known.frequency.size

    def is_divided_otherwise(self, factor: Rows, frequency: FloatArray) -> BoolArray:
        """(variants,) by itself a variant of these frequencies (modes, variants) rad/s may have other segments."""
        bars, count = [*filter(is_refined, self.system.train.bars)], factor.shape[1]
        if not bars:
            return np.zeros(count, dtype=np.bool_)
        if len(frequency) < self.modes:
            return np.ones(count, dtype=np.bool_)
        top = frequency[self.modes - 1] / (2.0 * np.pi) if self.modes else np.zeros(count)
        end, each = (
            len(factor) - len(self.limits),
            np.array([[phase(bar, 1.0), excess(bar)] for bar in bars]),
        )
        along = np.real(factor[end - len(bars) : end]) * each[:, :1]
        own = np.array([[self.system.segments[bar.name]] for bar in bars])
        other = np.zeros(count, dtype=np.bool_)
        for sign in (-1.0, 1.0):
            needed = np.maximum(
                self.highest * (1.0 + sign * ROUNDING), top * (1.0 + sign * RESOLVED)
            )
            other |= (segments_along(along * needed, each[:, 1:]) != own).any(axis=0)
        return other

    def shares(self, speed: FloatArray, factor: Rows) -> Shares:
        """Of variants with factors (rows, variants) of the train's rows, at speeds (variants, points) rad/s of each."""
        shape, evidence = speed.shape, self.evidence(speed, factor)
        count, variants = len(self.limits), len(speed)
        share, unlimited = np.zeros((count, *shape)), np.zeros((count, variants), dtype=np.bool_)
        unclear, left = np.zeros(variants, dtype=np.bool_), list(range(count))
        if_kept = np.zeros(count, dtype=np.bool_)
        for rule, clause in self.work.rules.pointwise(evidence):
            k = next((one for one in left if self.limits[one] == _limit(rule, clause)), None)
            if k is None:  # no clause of the sample
                unclear[:] = True
                continue
            left.remove(k)
            if_kept[k] = clause.if_kept
            curve, within = clause.curve, clause.within
            if (
                curve.speed is not evidence.need(Response).speed
            ):  # of the mean torque, which all variants share
                share[k] = np.max(curve.utilisation(), where=within, initial=-np.inf)
                unclear |= not np.isfinite(share[k, 0, 0])
            else:
                used, limit = (
                    np.where(within, own, 0.0).reshape(shape)
                    for own in (curve.utilisation(), curve.limit <= 0.0)
                )
                none = (limit > 0.0) | ~within.reshape(shape)
                unlimited[k] = none.all(axis=1) & within.any()
                unclear |= (limit.any(axis=1) & ~unlimited[k]) | np.isnan(used).any(axis=1)
                unclear |= (curve.status != Status.OK).reshape(shape).any(axis=1)
                share[k] = used
        unclear |= bool(left)
        share /= np.real(factor[len(factor) - count :, :, None])
        return Shares([one[:4] for one in self.limits], share, unlimited, unclear, if_kept)

    def evidence(self, speed: FloatArray, factor: Rows) -> Results:
        """The responses of all variants as one."""
        study, system, points, flat = self.work.study, self.system, speed.shape[1], speed.ravel()
        known = steady_if_known(study, system, flat)
        rows, size = _rows(system, self.found, study, flat, known), system.condensed.tree.size
        rows *= np.repeat(factor[: len(rows)], points, axis=1)
        flexibility, inertia, viscous, loss, ground, *acting = rows.reshape(-1, size, flat.size)
        frequency = np.stack([one.line.circular_frequency(flat) for one in self.found], axis=1)
        torque = np.zeros((flat.size, len(self.found), len(system.spans)), dtype=np.complex128)
        residual, amplification = np.empty((2, *frequency.shape))
        tree = replace(system.condensed.tree, flexibility=flexibility.real, inertia=inertia.real)
        for k in range(len(self.found)):
            w = np.ascontiguousarray(frequency[:, k])
            hc = complex_compliance(tree.flexibility, viscous.real, loss.real, w)
            one = tree_response(
                tree,
                w,
                acting[2 * k],
                twist=acting[2 * k + 1],
                ground_damping=ground.real,
                compliance=hc,
            )
            torque[:, k] = (span_torques(system, one.torque) * self.spans[:, None]).T
            residual[:, k], amplification[:, k] = one.residual, one.amplification
        mean = np.zeros((flat.size, len(system.spans))) if known is None else known.torque.T
        response = Response(
            flat,
            np.zeros(flat.size, dtype=bool),
            tuple(one.line for one in self.found),
            frequency / (2.0 * np.pi),
            np.zeros((*frequency.shape, 0), dtype=np.complex128),
            torque,
            mean,
            residual,
            status(amplification.ravel(), residual.ravel()).reshape(frequency.shape),
            np.zeros(frequency.shape),
            _of_columns(system, rows.reshape(-1, size, flat.size)[:4].real),
        )
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
    system: System,
    found: Sequence[Excitation],
    study: Study,
    speed: FloatArray,
    known: Steady | None = None,
) -> ComplexArray:
    """Rows (stations of the tree times (5 + twice the lines), speeds): what the response is made of."""
    condensed, known = system.condensed, known or steady_if_known(study, system, speed)
    ground = np.zeros((condensed.tree.size, len(speed)))
    ground[condensed.node] = ground_damping(system, speed, known) * (system.speed_ratio**2)[:, None]
    own = (
        condensed.tree.flexibility,
        condensed.tree.moving_inertia,
        condensed.viscous,
        condensed.loss_factor,
    )
    rows: list[Rows] = [*(np.repeat(one[:, None], len(speed), axis=1) for one in own), ground]
    for one in found:
        acting = sources(system, one, speed, known)
        rows += [
            acting.force,
            np.zeros_like(acting.force) if acting.twist is None else acting.twist,
        ]
    return np.concatenate(rows).astype(np.complex128)


def unfit(work: Work) -> str:
    """Why the variants cannot be judged side by side, as far as the file says; empty where they may be."""
    from torsion.analyses import ANALYSES

    study, system, train, response = work.study, work.system, work.study.train, work.get(Response)
    if not work.rules.are_pointwise(study):
        return "a rule of the file is not judged at each speed separately"
    if any(name in study.analyses or ANALYSES[name].wanted(study) for name in READ):
        return "the file has other analyses that are judged"
    if response is None or response.system is not system or system.bars is not None:
        return "shafts are not lumped, or have other segments for the response"
    if system.tables or system.groups is not None or system.condensed.extra.size:
        return "shafts of very many segments, tables or loops"
    if train.modal_damping or not np.isfinite(system.flexibility).all() or study.has_supports:
        return "damping by mode, couplings without stiffness or bending"
    odd = ("nonlinear", "warming", "joint", "pendulum", "engine", "compressor")
    if any(getattr(part, key) is not None for part in train.parts for key in odd):
        return "engines, joints, couplings that are not linear or get warm"
    return ""


def _divided(train: Train) -> list[tuple[str, bool, int]]:
    """What else than the phase along its shafts decides how many segments they have."""
    return [(bar.name, is_refined(bar), excess(bar)) for bar in train.bars]


def _read_alike(part: Part) -> tuple[object, ...]:
    """What rules read of a component, but for what its limits are made of."""
    return (
        part.name,
        part.kind,
        part.stations,
        part.ratio,
        part.damping is None,
        part.nonlinear,
        part.warming,
        part.joint,
        part.pendulum,
        part.engine,
        part.compressor,
    )


def _limit(rule: str, clause: Any) -> Limit:
    return rule, clause.clause, clause.where, clause.what, clause.standing


def swept(work: Work, variation: Variation, values: FloatArray) -> Swept | None:
    """The train with how figures enter it; None where that is not known."""
    study, system = work.study, work.system
    speeds, found = study.operation.speeds, excitations(system)
    if speeds is None or not found or not any(one.line.order is not None for one in found):
        return None
    first, last = work.rules.judged_band(study)
    sample = np.union1d(np.geomspace(first, last, SAMPLES), work.rules.named_speeds(study))
    sample = sample[(sample >= first) & (sample <= last)]
    mean, same = (
        steady_if_known(study, system, sample),
        [_read_alike(part) for part in study.train.parts],
    )
    size = (5 + 2 * len(found)) * system.condensed.tree.size
    highest = highest_excited(study, system, work.ruled)
    whole = Swept(work, system, found, UNCHANGED, np.ones(len(system.spans)), (), highest)
    evidence = whole.evidence(sample[None], np.ones((size, 1)))
    clauses = list(work.rules.pointwise(evidence))

    def read(other: Study) -> Rows | None:
        own = as_divided(system, other.train)
        condensed, base, lines = own.condensed, system.condensed, excitations(own)
        alike = all(
            np.array_equal(getattr(condensed, key), getattr(base, key))
            for key in ("node", "span", "sign", "extra")
        )
        alike = alike and np.array_equal(condensed.tree.parent, base.tree.parent)
        alike = alike and [one.line for one in lines] == [one.line for one in found]
        alike = alike and [_read_alike(part) for part in other.train.parts] == same
        alike = alike and (other.operation, other.rules) == (study.operation, study.rules)
        alike = alike and other.analyses.get("response") == study.analyses.get("response")
        along = [
            phase(bar, 1.0)
            for bar, one in zip(own.train.bars, system.train.bars, strict=False)
            if is_refined(one)
        ]
        if (
            not alike
            or own.segments != system.segments
            or _divided(other.train) != _divided(study.train)
        ):
            return None
        there = steady_if_known(other, own, sample)
        if (there is None) != (mean is None):
            return None
        if (
            there is not None
            and mean is not None
            and not np.allclose(there.torque, mean.torque, rtol=1e-12, atol=0.0)
        ):
            return None
        seen = replace(
            evidence.having(system=replace(evidence.system, train=own.train)), study=other
        )
        limits = _limits(clauses, list(work.rules.pointwise(seen)), sample)
        return (
            None
            if limits is None
            else np.concatenate(
                [
                    _rows(own, lines, other, sample, there),
                    np.outer(along, np.ones(len(sample))),
                    limits,
                ]
            )
        )

    enters = products(variation, values, read)
    if enters is None:
        return None
    judged = np.zeros(len(system.spans))
    for _, clause in clauses:
        judged[clause.spans] = 1.0
    return replace(
        whole, enters=enters, spans=judged, limits=tuple(_limit(*one) for one in clauses)
    )


def _limits(clauses: list[Any], others: list[Any], speed: FloatArray) -> FloatArray | None:
    """(clauses, speeds) limits of the same response as another study judges it, in values of the one.

    None where more differs.
    """
    if [_limit(*one) for one in clauses] != [_limit(*one) for one in others]:
        return None
    found = np.empty((len(clauses), len(speed)))
    for row, (_, one), (_, other) in zip(found, clauses, others, strict=True):
        if not np.array_equal(one.within, other.within):
            return None
        mine, theirs = one.curve.value, other.curve.value
        with np.errstate(all="ignore"):  # a stress is that of the same torque
            ratio = np.where(
                np.isclose(mine, theirs, rtol=1e-12, atol=0.0, equal_nan=True), 1.0, mine / theirs
            )
        row[:] = np.interp(speed, other.curve.speed, other.curve.limit * ratio)
    return found
