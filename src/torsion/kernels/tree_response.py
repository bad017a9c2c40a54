"""Forced response of a tree at many frequencies, with full torques, a residual and an amplification of errors."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.distributed.span_laws import Pi
from torsion.kernels.sweeps import EPS, Equations, Layout, layout, solve, values_or_rows
from torsion.kernels.tree import Tree

CANCELLED = 1e-6  # of the largest: rounding of it, 1e-14, is then what NEAR_SINGULAR_LOSS allows of a smaller one
NEAR_SINGULAR_LOSS = 1e-8  # relative error of the answer, from rounding of the data, above which a frequency is marked
CHUNK_VALUES = 2**18  # stations times columns treated at once, whose rows stay in the cache
BLOCK_VALUES = 2**14  # of which the residual is found at once: 256 KiB of each array
SHORTEST_CHUNK, LONGEST_CHUNK = (
    1024,
    2048,
)  # columns: fewer, and calls cost more than sums; more, and caches overflow
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
        """A response to be filled in place."""
        angle, torque = np.zeros((2, tree.size, frequencies), dtype=np.complex128)
        outer = torque if tree.shafts is None else torque.copy()
        residual, amplification = np.full((2, frequencies), np.nan)
        return cls(
            angle,
            torque,
            outer,
            residual,
            amplification,
            np.zeros((0, frequencies), dtype=np.complex128),
        )

    def part(self, part: slice) -> "TreeResponse":
        """A view of some frequencies."""
        return TreeResponse(*(values[..., part] for values in vars(self).values()))

    def store(self, block: "TreeResponse", at: IntArray) -> None:
        """Replace what stands at these numbers of frequencies."""
        for name, values in vars(self).items():
            values[..., at] = getattr(block, name)


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
    given: dict[str, Any] = {
        "ground_damping": ground_damping,
        "compliance": compliance,
        "shaft_loss": shaft_loss,
    }
    problem = pose(tree, w, force, twist=twist, **given)
    result = TreeResponse.blank(tree, problem.w.size)
    length = max(SHORTEST_CHUNK, min(CHUNK_VALUES // tree.size, LONGEST_CHUNK))
    for part in (slice(start, start + length) for start in range(0, problem.w.size, length)):
        block = result.part(part)
        solve_part(problem, part, block, check=check)
        lost = np.flatnonzero(np.isinf(block.amplification)) + part.start
        if lost.size:
            block = TreeResponse.blank(tree, lost.size)
            solve_part(problem, lost, block, check=check, guard=True)
            result.store(block, lost)
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
class Problem:
    """What `tree_response` is given, checked once."""

    plan: Layout
    tree: Tree
    w: FloatArray  # (frequencies,) rad/s
    force: list[Any]  # N m, a number or a row a station; None where none acts at any frequency
    twist: list[Any]  # rad, the same of the span
    damping: FloatArray  # (stations,) or (stations, frequencies) N m s/rad to ground
    damped: list[int]  # stations with such damping
    compliance: NDArray[Any]  # (stations,) or (stations, frequencies) rad/(N m)
    shaft_loss: FloatArray  # (shafts,) loss factor of each distributed shaft

    def equations(self, part: Part) -> tuple[Equations, Pi | None]:
        """The equations at the frequencies of `part`, and what the distributed shafts have brought to them."""
        own, compliance, shafts = (
            _own_stiffness(self, part),
            _columns(self.compliance, part),
            self.tree.shafts,
        )
        force, twist = (
            [row[part] if isinstance(row, np.ndarray) else row for row in rows]
            for rows in (self.force, self.twist)
        )
        if shafts is None:
            return Equations(own, compliance, force, twist), None
        square = self.w[part] * self.w[part]
        lossy = self.shaft_loss.any()
        flexibility, inner, outer = (
            shafts.lossy(square, self.shaft_loss) if lossy else shafts.at(square)
        )
        pi = flexibility, inner * -square, outer * -square
        own = own.astype(np.result_type(own, inner), copy=False)
        self.tree.add_ends(own, *pi[1:])
        rows = np.empty(
            (self.tree.size, len(square)), dtype=np.result_type(compliance, flexibility)
        )
        rows[:] = compliance[:, None] if compliance.ndim == 1 else compliance
        rows[shafts.node] = flexibility
        return Equations(own, rows, force, twist), pi


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
    """The problem in the arrays that the sweeps take; arguments and errors as of `tree_response`."""
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
    damped = np.flatnonzero(_any_in_rows(damping)).tolist()
    return Problem(
        layout(tree, rigid), tree, w, _acting(force), _acting(twist), damping, damped, hc, loss
    )


def _acting(values: NDArray[Any]) -> list[Any]:
    """Numbers or rows, one a station; None for a station on which nothing acts at any frequency."""
    rows = zip(values_or_rows(values), _any_in_rows(values), strict=True)
    return [row if acts else None for row, acts in rows]


def _any_in_rows(values: NDArray[Any]) -> list[bool]:
    """Whether any value of each station differs from zero."""
    if values.ndim == 1:
        return list((values != 0).tolist())
    return [row.size > 0 and bool(row[0] != 0 or row.any()) for row in values]


def solve_part(
    problem: Problem, part: Part, block: TreeResponse, *, check: bool, guard: bool = False
) -> None:
    """Fill `block` with the response at the frequencies of `part`.

    Amplification is 1 + 2 sum |own receptance| over the stations: twice the relative change of the determinant of the
    dynamic stiffness under relative changes of every inertia and damper to ground. In a mode the springs hold as much
    energy as the inertias, hence twice; |z| is taken as |real| + |imaginary|.
    """
    given, pi = problem.equations(part)
    columns = block.angle.shape[1]
    sensitivity = np.zeros(columns * given.own.itemsize // 8) if check else None
    with np.errstate(all="ignore"):
        solve(problem.plan, given, block.angle, block.torque, sensitivity=sensitivity, guard=guard)
        lost = ~np.isfinite(block.angle.sum(axis=0) + block.torque.sum(axis=0))
        if sensitivity is not None:
            block.residual[:] = equilibrium_residual(problem.plan, given, block.angle, block.torque)
            block.amplification[:] = 1 + 2 * sensitivity.reshape(columns, -1).sum(axis=1)
            lost |= ~np.isfinite(block.amplification)
        if pi is not None and problem.tree.shafts is not None:
            node, block.torque_outer[:] = problem.tree.shafts.node, block.torque
            block.torque_outer[node] -= pi[2] * block.angle[node]
            block.torque[node] += pi[1] * block.angle[problem.tree.shaft_parent]
    block.amplification[lost] = np.inf


def residual_of(problem: Problem, response: TreeResponse) -> FloatArray:
    """Worst relative residual of any equation, (frequencies,), of a response found in any way."""
    given, pi = problem.equations(slice(None))
    torque = response.torque
    if pi is not None and problem.tree.shafts is not None:
        torque = torque.copy()
        torque[problem.tree.shafts.node] -= pi[1] * response.angle[problem.tree.shaft_parent]
    with np.errstate(all="ignore"):
        return equilibrium_residual(problem.plan, given, response.angle, torque)


def _own_stiffness(problem: Problem, part: Part) -> NDArray[Any]:
    """Dynamic stiffness i w cg - w^2 J of each station by itself, N m/rad; real where the whole train is undamped."""
    w, inertia = problem.w[part], _columns(problem.tree.moving_inertia, part)
    inertia, square = inertia[:, None] if inertia.ndim == 1 else inertia, -w * w
    if (
        not problem.damped
        and not problem.shaft_loss.any()
        and not np.iscomplexobj(problem.compliance)
    ):
        return inertia * square
    own = np.empty((problem.plan.size, w.size), dtype=np.complex128)
    if inertia.shape[1] == 1:
        np.multiply(
            inertia, square.astype(np.complex128).view(np.float64), out=own.view(np.float64)
        )
    else:
        own.imag = 0.0
        np.multiply(inertia, square, out=own.real)
    damping = _columns(problem.damping, part)
    for station in problem.damped:
        own[station].imag = w * damping[station]
    return own


def _columns(values: NDArray[Any], part: Part) -> NDArray[Any]:
    """The columns of `values` that `part` names; values that do not vary along the columns stay as they are."""
    return values if values.ndim == 1 else values[:, part]


Terms = tuple[ComplexArray, FloatArray]  # an answer (stations, columns), and its magnitudes


@dataclass(frozen=True)
class _Balance:
    """Equations, one a station: coefficient times value, plus or minus what `other` is here less there = acting."""

    coefficient: NDArray[Any]  # (stations,) or (stations, columns)
    value: Terms
    other: Terms
    plus: np.ufunc
    minus: np.ufunc
    there: Sequence[Sequence[int]]  # stations whose `other` counts
    acting: Sequence[Any]
    without: list[bool]  # stations that have no such equation

    def put(self, block: slice, error: ComplexArray, scale: FloatArray) -> None:
        """What each equation of a block is wrong by, and the sum of the magnitudes in it."""
        factor = self.coefficient[block]
        factor = factor[:, None] if factor.ndim == 1 else factor
        (value, size), (other, other_size) = self.value, self.other
        np.multiply(factor, value[block], out=error)
        if factor.shape[1] == 1:
            np.multiply(np.abs(factor), size[block], out=scale)
        else:
            np.abs(error, out=scale)
        self.plus(error, other[block], out=error)
        scale += other_size[block]
        for mine, there in _runs(
            (i, there) for i, near in enumerate(self.there[block]) for there in near
        ):
            self.minus(error[mine], other[there], out=error[mine])
            scale[mine] += other_size[there]
        for line, row in enumerate(self.acting[block]):
            if row is not None:
                error[line] -= row
                scale[line] += np.abs(row)


def equilibrium_residual(
    plan: Layout, given: Equations, angle: ComplexArray, torque: ComplexArray
) -> FloatArray:
    """Worst relative residual, (columns,), over every station that is not fixed and every span.

    Computed from the answer alone, so that it also sees what the sweeps could not know. An equation whose terms are
    all zero is satisfied. Terms count as no less than CANCELLED of the largest torque (of a span: angle) of the column:
    where two sources cancel exactly, what is beyond them is rounding, which has no accuracy of its own.
    """
    size, columns = angle.shape
    angles, torques, worst = (angle, np.abs(angle)), (torque, np.abs(torque)), np.zeros(columns)
    inner, roots = (
        [() if parent < 0 else (parent,) for parent in plan.parent],
        [parent < 0 for parent in plan.parent],
    )
    stations = _Balance(
        given.own, angles, torques, np.subtract, np.add, plan.children, given.force, plan.held
    )
    spans = _Balance(
        given.compliance, torques, angles, np.add, np.subtract, inner, given.twist, roots
    )
    height = min(size, max(1, BLOCK_VALUES // max(columns, 1)))
    errors, (scales, sizes) = (
        np.empty((height, columns), dtype=np.complex128),
        np.empty((2, height, columns)),
    )
    for start in range(0, size, height):
        block = slice(start, min(start + height, size))
        error, scale, relative = (part[: block.stop - start] for part in (errors, scales, sizes))
        for balance, floor in ((stations, torques), (spans, angles)):
            balance.put(block, error, scale)
            np.maximum(scale, CANCELLED * floor[1].max(axis=0), out=scale)
            np.abs(error, out=relative)
            np.divide(relative, scale, out=relative)
            relative[balance.without[block]] = 0
            np.fmax(worst, np.fmax.reduce(relative, axis=0), out=worst)
    return worst


def _runs(pairs: Iterable[tuple[int, int]]) -> list[tuple[slice, slice]]:
    """Pairs of lines in as few runs of both as they form in the order given; a chain is one run."""
    found: list[list[int]] = []
    for here, there in pairs:
        if found and found[-1][0] + found[-1][2] == here and found[-1][1] + found[-1][2] == there:
            found[-1][2] += 1
        else:
            found.append([here, there, 1])
    return [
        (slice(here, here + count), slice(there, there + count)) for here, there, count in found
    ]
