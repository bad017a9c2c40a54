"""Forced response of a tree at many frequencies, with full torques, a residual and an amplification of errors."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.distributed.span_laws import Pi
from torsion.kernels.elimination import EPS, Layout, SpanSides, eliminate, forced, layout
from torsion.kernels.tree import Tree

CANCELLED = 1e-6  # of the largest: rounding of it, 1e-14, is then what NEAR_SINGULAR_LOSS allows of a smaller one
NEAR_SINGULAR_LOSS = 1e-8  # relative error of the answer, from rounding of the data, above which a frequency is marked
CHUNK_VALUES = 2**18  # stations times columns treated at once, whose rows stay in the cache
SHORTEST_CHUNK, LONGEST_CHUNK = (
    512,
    2048,
)  # columns; fewer, and calls cost more than sums (measured)
Part = slice | IntArray


class Status(IntEnum):
    """How far the response at one frequency can be trusted."""

    OK = 0
    NEAR_SINGULAR = 1  # rounding of the data alone moves the answer by more than NEAR_SINGULAR_LOSS
    SINGULAR = 2  # no answer, or no digit of it


@dataclass(frozen=True)
class TreeResponse:
    """Complex amplitudes with the time factor exp(+i w t); `torque[i]` is all that span i exerts on station i.

    A span with distributed inertia has two: `torque` at its inner (the parent's) end, `torque_outer` on station i.
    """

    angle: ComplexArray  # (stations, frequencies) rad
    torque: (
        ComplexArray  # (stations, frequencies) N m, elastic and damping share together; 0 at a root
    )
    torque_outer: (
        ComplexArray  # (stations, frequencies) N m; `torque` itself where no span has inertia
    )
    residual: FloatArray  # (frequencies,) of the worst equation, relative to the terms in it; NaN if not checked
    # (frequencies,) growth of relative errors of the data; infinite where singular, NaN if not checked
    amplification: FloatArray
    chord_torque: ComplexArray  # (chords, frequencies) N m of each chord of a loop on its end

    @classmethod
    def blank(cls, tree: Tree, frequencies: int) -> "TreeResponse":
        """Return a response to be filled in place."""
        angle, torque = np.zeros((2, tree.size, frequencies), dtype=np.complex128)
        outer = torque if tree.shafts is None else torque.copy()
        residual, amplification = np.full((2, frequencies), np.nan)
        none = np.zeros((0, frequencies), dtype=np.complex128)
        return cls(angle, torque, outer, residual, amplification, none)

    def store(self, part: Part, block: "TreeResponse") -> None:
        """Replace what stands at the frequencies `part`."""
        for name, values in vars(self).items():
            values[..., part] = getattr(block, name)


def tree_response(
    tree: Tree,
    w: FloatArray,
    force: NDArray[Any],
    *,
    twist: NDArray[Any] | None = None,
    ground_damping: FloatArray | None = None,
    compliance: NDArray[Any] | None = None,
    check: bool = True,
    shaft_loss: FloatArray | None = None,
) -> TreeResponse:
    """Response of every station and span at circular frequencies `w` (frequencies,) rad/s.

    Of trains of one layout side by side the tree has a column of inertias (and `compliance` one) for each frequency.
    force: (stations,) or (stations, frequencies) N m. twist: the same shapes, rad, imposed on span i:
    angle[i] = angle[parent] - compliance torque + twist; also on rigid spans.
    ground_damping N m s/rad and compliance rad/(N m), default `tree.flexibility`: the same shapes.
    shaft_loss: loss factor (shafts,) of the shear modulus of each distributed shaft of the tree, whose compliance is
    not used and whose twist must be 0.
    check: also compute residual and amplification. A singular frequency is never raised or warned of: see `status`.
    Raises ValueError for a shape that does not fit, SolveError for a frequency at which the law of a shaft ends.
    Demmel and Gragg (1993) explain the accuracy of such sweeps.
    """
    given = {"ground_damping": ground_damping, "compliance": compliance, "shaft_loss": shaft_loss}
    problem = pose(tree, w, force, twist=twist, **given)
    result = TreeResponse.blank(tree, problem.w.size)
    length = max(SHORTEST_CHUNK, min(CHUNK_VALUES // tree.size, LONGEST_CHUNK))
    for start in range(0, problem.w.size, length):
        part = np.arange(start, min(start + length, problem.w.size))
        block = solve_part(problem, slice(start, start + length), check=check)
        result.store(slice(start, start + length), block)
        if (lost := part[np.isinf(block.amplification)]).size:
            result.store(lost, solve_part(problem, lost, check=check, guard=True))
    return result


def complex_compliance(
    flexibility: FloatArray, viscous: FloatArray, loss_factor: FloatArray, w: FloatArray
) -> NDArray[Any]:
    """Compliance h/(1 + i eta + i w c h) of spans, rad/(N m); a rigid span stays 0, an infinite h leaves the damper.

    flexibility, viscous (N m s/rad), loss_factor: (spans,), or (spans, frequencies) of trains side by side.
    (spans,) if no span is viscous and no figure has columns (real if none is lossy), else (spans, frequencies) complex.
    """
    h, c, eta = (
        np.asarray(values, dtype=np.float64) for values in (flexibility, viscous, loss_factor)
    )
    if max(h.ndim, c.ndim, eta.ndim) > 1 or c.any():
        h, c, eta = (values.reshape(len(values), -1) for values in (h, c, eta))
    if not c.any():
        lossy: NDArray[Any] = h / (1 + 1j * eta) if eta.any() else h
        return lossy
    stiffness = np.divide(1.0, h, out=np.full(h.shape, np.inf), where=h > 0)
    rigid = h == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        hc: NDArray[Any] = 1 / (np.where(rigid, 1.0, stiffness) * (1 + 1j * eta) + 1j * (c * w))
    return np.where(rigid, 0.0, hc)


def status(amplification: FloatArray, residual: FloatArray) -> NDArray[np.uint8]:
    """`Status` at each frequency, (frequencies,) uint8; a residual that is NaN is not judged.

    Raises ValueError where the amplification is NaN: such a response was not checked.
    """
    if np.isnan(amplification).any():
        raise ValueError("the response was computed without its check, so that it has no status")
    loss = np.fmax(EPS * amplification, residual)
    lines = np.where(loss > NEAR_SINGULAR_LOSS, Status.NEAR_SINGULAR, Status.OK)
    lines[~(loss < 1)] = Status.SINGULAR
    return lines.astype(np.uint8)


@dataclass(frozen=True)
class Equations:
    """One linear system for every column: own angle = force + torques, angle = angle of parent - hc torque + twist."""

    own: NDArray[
        Any
    ]  # (stations, columns) N m/rad, the dynamic stiffness of each station by itself
    compliance: NDArray[Any]  # hc, (stations, 1) or (stations, columns) rad/(N m)
    force: NDArray[Any]  # (stations, 1) or (stations, columns) N m, 0 on fixed stations
    twist: NDArray[Any] | None  # rad, the same of the spans; none: 0
    pi: Pi | None = (
        None  # what the distributed shafts have brought: hc, and -w^2 J at both ends, (shafts, columns)
    )


@dataclass(frozen=True)
class Problem:
    """What `tree_response` is given, checked once; arrays have one column, or one for each frequency."""

    plan: Layout
    tree: Tree
    w: FloatArray  # (frequencies,) rad/s
    force: NDArray[Any]  # (stations, .) N m
    twist: NDArray[Any] | None  # (stations, .) rad of the span
    damping: FloatArray  # (stations, .) N m s/rad to ground
    compliance: NDArray[Any]  # (stations, .) rad/(N m)
    shaft_loss: FloatArray  # (shafts,) loss factor of each distributed shaft

    def equations(self, part: Part) -> Equations:
        """Return the equations at the frequencies of `part`."""
        w, tree, shafts = self.w[part], self.tree, self.tree.shafts
        stiffness: NDArray[Any] = _columns(tree.inertia_columns, part) * -(w * w)
        if self.damping.any():
            stiffness = stiffness + 1j * (w * _columns(self.damping, part))
        compliance, force = _columns(self.compliance, part), _columns(self.force, part)
        twist = None if self.twist is None else _columns(self.twist, part)
        if shafts is None:
            return Equations(stiffness, compliance, force, twist)

        square, lossy = w * w, self.shaft_loss.any()
        flexibility, inner, outer = (
            shafts.lossy(square, self.shaft_loss) if lossy else shafts.at(square)
        )
        pi = flexibility, inner * -square, outer * -square
        stiffness = stiffness.astype(np.result_type(stiffness, inner), copy=False)
        tree.add_ends(stiffness, *pi[1:])
        rows = np.empty((tree.size, len(w)), dtype=np.result_type(compliance, flexibility))
        rows[:] = compliance
        rows[shafts.node] = flexibility
        return Equations(stiffness, rows, force, twist, pi)


def pose(
    tree: Tree,
    w: FloatArray,
    force: NDArray[Any],
    *,
    twist: NDArray[Any] | None = None,
    ground_damping: FloatArray | None = None,
    compliance: NDArray[Any] | None = None,
    shaft_loss: FloatArray | None = None,
) -> Problem:
    """Return the problem in the arrays that the elimination takes; arguments and errors as of `tree_response`."""
    w, shafts, none = np.asarray(w, dtype=np.float64), tree.shafts, np.zeros(tree.size)
    if w.ndim != 1:
        raise ValueError(f"w has shape {w.shape}; expected (frequencies,)")
    damping = none if ground_damping is None else np.asarray(ground_damping, dtype=np.float64)
    hc = tree.flexibility if compliance is None else np.asarray(compliance)
    force, twist = np.asarray(force), none if twist is None else np.asarray(twist)
    allowed = (tree.size,), (tree.size, w.size)
    given = {
        "compliance": hc,
        "ground_damping": damping,
        "force": force,
        "twist": twist,
        "inertia": tree.inertia,
    }
    for name, values in given.items():
        if values.shape not in allowed:
            raise ValueError(
                f"{name} has shape {values.shape}; expected {allowed[0]} or {allowed[1]}"
            )
    loss = (
        np.zeros(len(tree.shaft_parent))
        if shaft_loss is None
        else np.asarray(shaft_loss, dtype=np.float64)
    )
    if loss.shape != tree.shaft_parent.shape:
        raise ValueError(f"shaft_loss has shape {loss.shape}; expected {tree.shaft_parent.shape}")
    rigid, highest = hc, float(np.max(w, initial=0.0))
    if shafts is not None:
        rigid = hc.copy()
        rigid[shafts.node] = 1.0  # no shaft is
        if highest > shafts.reach:
            raise SolveError(
                f"{highest:.6g} rad/s is above {shafts.reach:.6g} rad/s, to which the pieces of the shafts are short"
                " enough; divide the shafts more finely"
            )
        if twist[shafts.node].any():
            raise ValueError(
                "a twist is imposed on a span with distributed inertia; expected a plain span next to it"
            )
    acting = np.where(tree.held, 0.0, force.T).T.reshape(tree.size, -1)
    return Problem(
        layout(tree, rigid),
        tree,
        w,
        acting,
        twist.reshape(tree.size, -1) if twist.any() else None,
        damping.reshape(tree.size, -1),
        hc.reshape(tree.size, -1),
        loss,
    )


def _columns(values: NDArray[Any], part: Part) -> NDArray[Any]:
    """Return the columns of `values` that `part` names; a single column stands for all."""
    return values if values.shape[1] == 1 else values[:, part]


def solve_part(problem: Problem, part: Part, *, check: bool, guard: bool = False) -> TreeResponse:
    """Return the response at the frequencies of `part`."""
    given, plan = problem.equations(part), problem.plan
    with np.errstate(all="ignore"):
        sides = eliminate(plan, given.own, given.compliance, guard=guard)
        angle, torque = forced(sides, given.force, given.twist)
        columns = angle.shape[1]
        residual, amplification = np.full((2, columns), np.nan)
        lost = ~np.isfinite(angle.sum(axis=0) + torque.sum(axis=0))
        if check:
            residual = equilibrium_residual(plan, given, angle, torque)
            amplification = amplification_of(given.own, sides)
            lost |= ~np.isfinite(amplification)
        amplification[lost] = np.inf
        outer = torque
        if given.pi is not None and problem.tree.shafts is not None:
            node, outer = problem.tree.shafts.node, torque.copy()
            outer[node] -= given.pi[2] * angle[node]
            torque[node] += given.pi[1] * angle[problem.tree.shaft_parent]
    chords = np.zeros((0, columns), dtype=np.complex128)
    return TreeResponse(angle, torque, outer, residual, amplification, chords)


def residual_of(problem: Problem, response: TreeResponse) -> FloatArray:
    """Return the worst relative residual of any equation, (frequencies,), of a response found in any way."""
    given, torque = problem.equations(slice(None)), response.torque
    if given.pi is not None and problem.tree.shafts is not None:
        torque = torque.copy()
        torque[problem.tree.shafts.node] -= given.pi[1] * response.angle[problem.tree.shaft_parent]
    with np.errstate(all="ignore"):
        return equilibrium_residual(problem.plan, given, response.angle, torque)


def amplification_of(station_stiffness: NDArray[Any], sides: SpanSides) -> FloatArray:
    """Return the growth (columns,) of relative errors of the data: 1 + 2 sum |own receptance| over the free stations.

    Twice the relative change of the determinant of the dynamic stiffness under relative changes of every inertia and
    damper to ground. In a mode the springs hold as much energy as the inertias, hence twice; |z| is taken as
    |real| + |imaginary|.
    """
    plan, total = sides.plan, np.zeros(station_stiffness.shape[1])
    for station in range(plan.size):
        if not plan.prescribed[station]:
            loss = station_stiffness[station] * sides.divisor[station]
            loss *= sides.meeting[station]
            total += np.abs(loss.real)
            total += np.abs(loss.imag)
    return 1 + 2 * total


def equilibrium_residual(
    plan: Layout, given: Equations, angle: ComplexArray, torque: ComplexArray
) -> FloatArray:
    """Return the worst relative residual, (columns,), over every station that is not fixed and every span.

    Computed from the answer alone, so that it also sees what the elimination could not know. An equation whose terms
    are all zero is satisfied. Terms count as no less than CANCELLED of the largest torque (of a span: angle) of the
    column: where two sources cancel exactly, what is beyond them is rounding, which has no accuracy of its own.
    """
    turned, carried = np.abs(angle), np.abs(torque)
    least_angle, least_torque = CANCELLED * turned.max(axis=0), CANCELLED * carried.max(axis=0)
    worst = np.zeros(angle.shape[1])

    def add_equation(error: NDArray[Any], scale: FloatArray, floor: FloatArray) -> None:
        np.fmax(worst, np.abs(error) / np.maximum(scale, floor), out=worst)

    for station, parent in enumerate(plan.parent):
        # Of a station: own angle = force + torque of its span - those of the spans to its children.
        force = given.force[station]
        if not plan.held[station]:
            error = given.own[station] * angle[station]
            scale = np.abs(error)
            scale += carried[station] + np.abs(force)
            error -= torque[station] + force
            for child in plan.children[station]:
                error += torque[child]
                scale += carried[child]
            add_equation(error, scale, least_torque)

        # Of a span: angle = angle of the parent - hc torque + twist.
        if parent >= 0:
            error = given.compliance[station] * torque[station]
            scale = np.abs(error)
            scale += turned[station] + turned[parent]
            error += angle[station] - angle[parent]
            if given.twist is not None:
                error -= given.twist[station]
                scale += np.abs(given.twist[station])
            add_equation(error, scale, least_angle)
    return worst
