"""What a train gives at any values of its figures, with exact slopes, without its file being read again.

Of trains of springs, dampers and lumped inertias whose numbers are products or sums of the figures, as trials show: the
slopes of frequencies are shares of energy, those of amplitudes follow from one adjoint response (`sensitivities`).
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import chain
from typing import Any

import numpy as np

from torsion.analyses.response.harmonic_components import Excitation, excitations, sources
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
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
from torsion.what_if.fit.fit_results import OUTSIDE
from torsion.what_if.fit.measurements import Curve
from torsion.what_if.variants.products import Products, Rows, products

OWN = 7  # blocks of rows that do not follow the speed: four of the tree, three of the chords
ACTING = 3  # blocks of rows of an order: torques, twists, twists of chords


@dataclass(frozen=True)
class Target:
    """What a curve is of, on the tree."""

    is_torque: bool
    at: int  # span or station of the tree
    factor: ComplexArray  # (points,) or one: what it is over that of the tree


@dataclass(frozen=True)
class ClosedForms:
    """The numbers of the train of a file, and how figures enter them."""

    system: System
    curves: tuple[Curve, ...]
    targets: tuple["Target", ...]  # of each curve
    found: tuple[Excitation, ...]
    speed: FloatArray  # (speeds,) rad/s, of all curves
    base: Rows  # (rows, speeds) in blocks
    enters: Products
    count: int  # of the modes

    def blocks(self, rows: Rows) -> list[Rows]:
        """The rows of each block."""
        size, chords = self.system.condensed.tree.size, len(self.system.condensed.extra)
        each = (
            [size] * 4
            + [chords] * 3
            + [size] * bool(self.curves)
            + [size, size, chords] * len(self.found)
        )
        return np.split(rows, np.cumsum(each)[:-1])

    def line(self, place: int) -> int:
        """Which of the excitations a curve is of."""
        return next(
            k for k, one in enumerate(self.found) if one.line.order == self.curves[place].order
        )

    @cached_property
    def at(self) -> Callable[[tuple[float, ...]], "AtFigures"]:
        """What it gives with the figures at factors."""
        return lru_cache(maxsize=8)(lambda factors: AtFigures(self, np.array(factors)))


def closed_forms(
    variation: Variation,
    system: System,
    curves: tuple[Curve, ...],
    count: int,
    assembled: Callable[[Study], System],
) -> ClosedForms | None:
    """None where the train is another one, or a figure enters otherwise; assembled: a study, divided as the file is."""
    study, orders = (
        variation.study([one.nominal for one in variation.figures]),
        {curve.order for curve in curves},
    )
    train = study.train
    if (
        system.tables
        or system.bars is not None
        or system.groups is not None
        or train.modal_damping
        or train.has_nonlinear_couplings
        or train.has_tables_over("vibratory torque")
        or (np.isinf(system.flexibility) & (system.viscous == 0.0)).any()
    ):
        return None
    found = tuple(one for one in excitations(system, orders) if one.line.order in orders)
    targets = tuple(_target(system, curve) for curve in curves)
    if any(len(one.apart) > 1 for one in found) or any(
        one.at < 0 for one in targets
    ):  # the torque of a chord
        return None
    speed = np.unique(np.concatenate([[], *(curve.speed for curve in curves)]))

    def rows(other: Study, own: System) -> Rows | None:
        lines = [one for one in excitations(own, orders) if one.line.order in orders]
        return (
            np.vstack([*_rows(other, own, lines, speed)])
            if _alike(own, system, lines, found)
            else None
        )

    base = rows(study, system)
    deviation = np.array([one.law.lognormal for one in variation.figures])
    ends = np.exp(OUTSIDE * np.outer([-1.0, 1.0], deviation))
    enters = (
        None
        if base is None
        else products(variation, ends, lambda other: rows(other, assembled(other)))
    )
    if base is None or enters is None:
        return None
    return ClosedForms(system, curves, targets, found, speed, base, enters, count)


def no_value(curve: Curve) -> SolveError:
    """At a resonance without damping."""
    return SolveError(
        f"the response of order {curve.order} has no finite value at a speed", "give damping"
    )


def spot(system: System, curve: Curve) -> int:
    """The span of a torque, the first of its component; the station of anything else."""
    if curve.quantity == "torque":
        return next(
            k for k, one in enumerate(system.spans) if system.train.parts[one.part].name == curve.at
        )
    return next(k for k, one in enumerate(system.stations) if one.name == curve.at)


def _target(system: System, curve: Curve) -> Target:
    condensed, at = system.condensed, spot(system, curve)
    if curve.quantity == "torque":
        return Target(
            True, int(condensed.span[at]), np.array(condensed.sign[at] / system.span_ratio[at])
        )
    factor = 1j * float(curve.order) * curve.speed if curve.quantity == "speed" else np.array(1.0)
    return Target(False, int(condensed.node[at]), np.asarray(system.speed_ratio[at] * factor))


def _rows(
    study: Study, system: System, found: Sequence[Excitation], speed: FloatArray
) -> Iterator[Rows]:
    """All numbers of a train (rows, speeds), block by block."""
    condensed, extra = system.condensed, system.condensed.extra
    ratio = system.span_ratio[extra] ** 2
    own = (
        condensed.tree.flexibility,
        condensed.tree.moving_inertia,
        condensed.viscous,
        condensed.loss_factor,
    )
    chords = (
        system.flexibility[extra] / ratio,
        system.viscous[extra] * ratio,
        system.loss_factor[extra],
    )
    for each in chain(own, chords):  # a damper alone, whose flexibility is infinite, has 0
        yield np.repeat(np.where(np.isinf(each), 0.0, each)[:, None], max(1, len(speed)), axis=1)
    if not len(speed):
        return
    known, ground = (
        steady_if_known(study, system, speed),
        np.zeros((condensed.tree.size, len(speed))),
    )
    ground[condensed.node] = ground_damping(system, speed, known) * (system.speed_ratio**2)[:, None]
    yield ground
    for one in found:
        acting = sources(system, one, speed, known)
        none = np.zeros_like(acting.force), np.zeros((len(extra), len(speed)))
        yield acting.force
        yield none[0] if acting.twist is None else acting.twist
        yield none[1] if acting.loop_twist is None else acting.loop_twist


def _alike(
    own: System, base: System, lines: Sequence[Excitation], found: Sequence[Excitation]
) -> bool:
    """Two trains differ in numbers alone."""
    mine, theirs = own.condensed, base.condensed
    pairs = [
        (getattr(mine, key), getattr(theirs, key)) for key in ("node", "span", "sign", "extra")
    ]
    pairs += [
        (mine.tree.parent, theirs.tree.parent),
        (own.speed_ratio, base.speed_ratio),
        (own.held, base.held),
    ]
    pairs.append((np.isinf(own.flexibility), np.isinf(base.flexibility)))
    return [one.line for one in lines] == [one.line for one in found] and all(
        np.array_equal(*pair) for pair in pairs
    )


class AtFigures:
    """The train with its figures at factors (figures,)."""

    def __init__(self, forms: ClosedForms, factors: FloatArray) -> None:
        self.forms, self.factors = forms, factors
        self.rows = forms.blocks(forms.base * forms.enters.factors(factors[None]))
        own = [block[:, 0].real for block in self.rows[:OWN]]
        self.flexibility, self.inertia, self.viscous, self.loss, *self.chords = own
        system, tree = forms.system, forms.system.condensed.tree
        self.flexibility[np.isinf(tree.flexibility)] = np.inf
        self.chords[0][np.isinf(system.flexibility[system.condensed.extra])] = np.inf
        self.tree = replace(
            tree,
            flexibility=self.flexibility,
            inertia=np.where(tree.held, tree.inertia, self.inertia),
        )
        self.responses = dict[int, tuple[TreeResponse, dict[str, Any], list[Rows]]]()

    @cached_property
    def slopes(self) -> list[Rows]:
        """Of the logarithm of each row of a block by that of each figure."""
        return self.forms.blocks(self.forms.enters.slopes(self.factors))

    @cached_property
    def modes(self) -> TreeModes:
        """The lowest."""
        tree, (first, second), holds = self.springs, self.ends, np.isfinite(self.chords[0])
        if not holds.any():
            return tree_modes(tree, self.forms.count)
        return graph_modes(
            tree, first[holds], second[holds], self.chords[0][holds], self.forms.count
        )

    @property
    def springs(self) -> Tree:
        """Without the spans that have no stiffness."""
        return self.tree.cut(np.isinf(self.flexibility))

    @property
    def ends(self) -> tuple[IntArray, IntArray]:
        """Tree stations at both ends of each chord."""
        system = self.forms.system
        node, extra = system.condensed.node, system.condensed.extra
        return node[system.driving[extra]], node[system.driven[extra]]

    def mode_slopes(self, numbers: Sequence[int]) -> FloatArray:
        """(modes, figures): d ln f/d ln factor."""
        holds, each = np.isfinite(self.chords[0]), list(numbers)
        moved = frequency_sensitivity(self.springs, self.modes, self.chords[0][holds])
        flexibility, inertia, _, _, chord, *_ = (np.real(one) for one in self.slopes)
        found = moved.inertia[:, each].T @ inertia - moved.stiffness[:, each].T @ flexibility
        return np.asarray(found - moved.chord[:, each].T @ chord[holds])

    def amplitude(self, place: int) -> ComplexArray:
        """Of a curve (points,) in SI; raises SolveError where the response has no value there."""
        found, target = self._response(place)[0], self.forms.targets[place]
        if (status(found.amplification, found.residual) == Status.SINGULAR).any():
            raise no_value(self.forms.curves[place])
        values = found.torque[target.at] if target.is_torque else found.angle[target.at]
        return np.asarray(values * target.factor)

    def amplitude_slopes(self, place: int) -> ComplexArray:
        """(points, figures): slopes of the logarithms of `amplitude`."""
        found, given, acting = self._response(place)
        target, w = self.forms.targets[place], given.pop("w")
        chords, at = given.pop("chords"), {"span" if target.is_torque else "station": target.at}
        by = response_sensitivity(self.tree, w, found, chords=chords, **at, **given)
        first = OWN + 1 + ACTING * self.forms.line(place)
        terms = [
            *self._compliance_terms(
                by.compliance, w, (self.flexibility, self.viscous, self.loss), (0, 2, 3)
            ),
            *self._compliance_terms(by.chord, w, self.chords, (4, 5, 6)),
            (by.inertia * self.inertia[:, None], 1),
            (by.ground_damping * given["ground_damping"], OWN),
            *(
                (one * rows, first + k)
                for k, (one, rows) in enumerate(
                    zip((by.force, by.twist, by.chord_twist), acting, strict=True)
                )
            ),
        ]
        value = found.torque[target.at] if target.is_torque else found.angle[target.at]
        return np.asarray(sum(one.T @ self.slopes[block] for one, block in terms) / value[:, None])

    def _compliance_terms(
        self,
        by: ComplexArray,
        w: FloatArray,
        own: Sequence[FloatArray],
        blocks: tuple[int, int, int],
    ) -> Iterator[tuple[ComplexArray, int]]:
        """Of spans of flexibility, damper and loss factor: the slopes by the logarithms of these, each with its block.

        by: slopes by the complex compliance; none of rigid spans.
        """
        flexibility, viscous, loss = own
        moves = (flexibility > 0.0)[:, None]
        stiffness = 1.0 / np.where(flexibility > 0.0, flexibility, 1.0)
        by_stiffness, by_loss, by_viscous = compliance_slopes(
            stiffness, viscous, loss, 1j * w.astype(np.complex128)
        )
        each = -by_stiffness, by_viscous * viscous[:, None], by_loss * loss[:, None]
        yield from (
            (np.where(moves, by * one, 0.0), block) for one, block in zip(each, blocks, strict=True)
        )

    def _response(self, place: int) -> tuple[TreeResponse, dict[str, Any], list[Rows]]:
        """At the points of a curve, what it was computed with, and what acts."""
        if place not in self.responses:
            curve = self.forms.curves[place]
            w, at = float(curve.order) * curve.speed, np.searchsorted(self.forms.speed, curve.speed)
            first = OWN + 1 + ACTING * self.forms.line(place)
            force, twist, loop_twist = acting = [
                one[:, at] for one in self.rows[first : first + ACTING]
            ]
            given: dict[str, Any] = {
                "ground_damping": self.rows[OWN][:, at].real,
                "compliance": complex_compliance(self.flexibility, self.viscous, self.loss, w),
            }
            chords = None
            if len(loop_twist):
                compliance = complex_compliance(self.chords[0], self.chords[1], self.chords[2], w)
                chords = Chords(*self.ends, compliance, loop_twist)
                found = looped_response(self.tree, chords, w, force, twist=twist, **given)
            else:
                found = tree_response(self.tree, w, force, twist=twist, **given)
            self.responses[place] = found, given | {"w": w, "chords": chords}, acting
        found, given, acting = self.responses[place]
        return found, dict(given), acting
