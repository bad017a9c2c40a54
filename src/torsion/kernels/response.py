"""Forced response of a tree at many frequencies, with full torques, a residual and an amplification of errors."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.kernels.outward import Answer, Equations, solve
from torsion.kernels.residual import equilibrium_residual
from torsion.kernels.sweeps import EPS, Layout, layout
from torsion.kernels.tree import ComplexArray, FloatArray, IntArray, Tree

NEAR_SINGULAR_LOSS = 1e-8  # relative error of the answer, from rounding of the data, above which a line is marked
CHUNK_VALUES = 2**18  # stations times columns treated at once
SHORTEST_CHUNK, LONGEST_CHUNK = 1024, 2048  # columns: fewer, and calls cost more than sums; more, and caches overflow
Part = slice | IntArray


class Status(IntEnum):
    """How far a response line can be trusted."""

    OK = 0
    NEAR_SINGULAR = 1  # rounding of the data alone moves the answer by more than NEAR_SINGULAR_LOSS
    SINGULAR = 2  # no answer, or no digit of it


@dataclass(frozen=True)
class TreeResponse:
    """Complex amplitudes with the time factor exp(+i w t); `torque[i]` is all that span i exerts on station i."""

    angle: ComplexArray  # (stations, frequencies) rad
    torque: ComplexArray  # (stations, frequencies) N m, elastic and damping share together; 0 at a root
    residual: FloatArray  # (frequencies,) of the worst equation, relative to the terms in it; NaN if not checked
    amplification: (
        FloatArray  # (frequencies,) growth of relative errors of the data; infinite where singular, NaN if not checked
    )
    closing_torque: ComplexArray  # (closing spans, frequencies) N m of each closing span on its end

    def part(self, part: slice) -> "TreeResponse":
        """A view of some frequencies."""
        angle, torque, closing = self.angle[:, part], self.torque[:, part], self.closing_torque[:, part]
        return TreeResponse(angle, torque, self.residual[part], self.amplification[part], closing)

    def store(self, block: "TreeResponse", lines: IntArray) -> None:
        """Replace the lines of these numbers."""
        self.angle[:, lines], self.torque[:, lines] = block.angle, block.torque
        self.residual[lines], self.amplification[lines] = block.residual, block.amplification


def tree_response(
    tree: Tree,
    w: FloatArray,
    force: NDArray[Any],
    *,
    twist: NDArray[Any] | None = None,
    ground_damping: FloatArray | None = None,
    compliance: NDArray[Any] | None = None,
    check: bool = True,
) -> TreeResponse:
    """Response of every station and span at circular frequencies `w` (frequencies,) rad/s.

    force: (stations,) or (stations, frequencies) N m. twist: the same shapes, rad, imposed on span i:
    angle[i] = angle[parent] - compliance torque + twist; also on rigid spans.
    ground_damping N m s/rad and compliance rad/(N m), default `tree.flexibility`: the same shapes.
    check: also compute residual and amplification. A singular line is never raised or warned of: see `status`.
    Raises ValueError for a shape that does not fit. Demmel and Gragg (1993) explain the accuracy of such sweeps.
    """
    problem = pose(tree, w, ground_damping, compliance)
    force = np.asarray(force)
    twist = None if twist is None else np.asarray(twist)
    _check_shapes(tree.size, problem.w, {"force": force, "twist": twist})
    result = blank_response(tree.size, problem.w.size)
    for part in _chunks(problem):
        block = result.part(part)
        solve_part(problem, force, twist, part, block, check=check)
        lost = np.flatnonzero(np.isinf(block.amplification)) + part.start
        if lost.size:
            block = blank_response(tree.size, lost.size)
            solve_part(problem, force, twist, lost, block, check=check, guard=True)
            result.store(block, lost)
    return result


def complex_compliance(
    flexibility: FloatArray, viscous: FloatArray, loss_factor: FloatArray, w: FloatArray
) -> NDArray[Any]:
    """Compliance h/(1 + i eta + i w c h) of spans, rad/(N m); a rigid span stays 0, an infinite h leaves the damper.

    flexibility, viscous (N m s/rad), loss_factor: (spans,). (spans,) if no span is viscous (real if none is lossy),
    else (spans, frequencies) complex.
    """
    h, c, eta = (np.asarray(values, dtype=np.float64) for values in (flexibility, viscous, loss_factor))
    stiffness = np.divide(1.0, h, out=np.full(h.shape, np.inf), where=h > 0)
    if not c.any():
        lossy: NDArray[Any] = h / (1 + 1j * eta) if eta.any() else h
        return lossy
    rigid = h == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        hc: NDArray[Any] = 1 / ((np.where(rigid, 1.0, stiffness) * (1 + 1j * eta))[:, None] + 1j * np.outer(c, w))
    hc[rigid] = 0
    return hc


def status(amplification: FloatArray, residual: FloatArray) -> NDArray[np.uint8]:
    """`Status` of each line, (frequencies,) uint8; a residual that is NaN is not judged.

    Raises ValueError where the amplification is NaN: such a response was not checked.
    """
    if np.isnan(amplification).any():
        raise ValueError("the response was computed without its check, so that its lines have no status")
    loss = np.fmax(EPS * amplification, residual)
    lines = np.where(loss > NEAR_SINGULAR_LOSS, Status.NEAR_SINGULAR, Status.OK)
    lines[~(loss < 1)] = Status.SINGULAR
    return lines.astype(np.uint8)


@dataclass(frozen=True)
class Problem:
    """Everything but the sources, checked once."""

    plan: Layout
    inertia: FloatArray  # (stations,) kg m2
    damping: FloatArray  # (stations,) or (stations, frequencies) N m s/rad to ground
    compliance: NDArray[Any]  # (stations,) or (stations, frequencies) rad/(N m)
    w: FloatArray  # (frequencies,) rad/s


def pose(tree: Tree, w: FloatArray, ground_damping: FloatArray | None, compliance: NDArray[Any] | None) -> Problem:
    """The problem in the arrays that the sweeps take; raises ValueError for a shape that does not fit."""
    damping = np.zeros(tree.size) if ground_damping is None else np.asarray(ground_damping, dtype=np.float64)
    hc = tree.flexibility if compliance is None else np.asarray(compliance)
    w = np.asarray(w, dtype=np.float64)
    if w.ndim != 1:
        raise ValueError(f"w has shape {w.shape}; expected (frequencies,)")
    _check_shapes(tree.size, w, {"compliance": hc, "ground_damping": damping})
    return Problem(layout(tree, hc), tree.moving_inertia, damping, hc, w)


def solve_part(
    problem: Problem,
    force: NDArray[Any],
    twist: NDArray[Any] | None,
    part: Part,
    block: TreeResponse,
    *,
    check: bool,
    guard: bool = False,
) -> None:
    """Fill `block` with the response at the frequencies of `part`."""
    turn = None if twist is None else _columns(twist, part)
    own, hc = _own_stiffness(problem, part), _columns(problem.compliance, part)
    given = Equations(own, list(hc), list(_columns(force, part)), None if turn is None else list(turn))
    if check:
        block.amplification[:] = 0
    rows = Answer(list(block.angle), list(block.torque), block.amplification if check else None)
    with np.errstate(all="ignore"):
        solve(problem.plan, given, rows, guard)
        total = block.angle.sum(axis=0) + block.torque.sum(axis=0)
        if check:
            block.residual[:] = equilibrium_residual(problem.plan, given, rows)
    block.amplification[~np.isfinite(total)] = np.inf
    block.amplification[np.isnan(block.amplification) & check] = np.inf


def residual_of(
    problem: Problem, force: NDArray[Any], twist: NDArray[Any] | None, response: TreeResponse
) -> FloatArray:
    """Worst relative residual of any equation, (frequencies,), of a response found in any way."""
    own, hc = _own_stiffness(problem, slice(None)), list(problem.compliance)
    given = Equations(own, hc, list(force), None if twist is None else list(twist))
    with np.errstate(all="ignore"):
        return equilibrium_residual(problem.plan, given, Answer(list(response.angle), list(response.torque), None))


def _own_stiffness(problem: Problem, part: Part) -> list[Any]:
    """Dynamic stiffness i w cg - w^2 J of each station by itself, N m/rad; real where the whole train is undamped."""
    w = problem.w[part]
    square = -w * w
    if problem.damping.any() or np.iscomplexobj(problem.compliance):
        square = square.astype(np.complex128)
    rows: list[Any] = [square * inertia for inertia in problem.inertia]
    damping = _columns(problem.damping, part)
    for station in np.flatnonzero(damping if damping.ndim == 1 else damping.any(axis=1)):
        rows[station].imag = w * damping[station]
    return rows


def blank_response(stations: int, frequencies: int, closing: int = 0) -> TreeResponse:
    """A response to be filled in place."""
    angle, torque = (np.zeros((stations, frequencies), dtype=np.complex128) for _ in range(2))
    residual, amplification = (np.full(frequencies, np.nan) for _ in range(2))
    return TreeResponse(angle, torque, residual, amplification, np.zeros((closing, frequencies), dtype=np.complex128))


def _check_shapes(stations: int, w: FloatArray, arrays: dict[str, NDArray[Any] | None]) -> None:
    allowed = ((stations,), (stations, w.size))
    for name, values in arrays.items():
        if values is not None and values.shape not in allowed:
            raise ValueError(f"{name} has shape {values.shape}; expected {allowed[0]} or {allowed[1]}")


def _chunks(problem: Problem) -> list[slice]:
    """The frequencies in pieces whose rows stay in the cache."""
    length = int(np.clip(CHUNK_VALUES // problem.plan.size, SHORTEST_CHUNK, LONGEST_CHUNK))
    return [slice(start, start + length) for start in range(0, problem.w.size, length)]


def _columns(values: NDArray[Any], part: Part) -> NDArray[Any]:
    """The columns of `values` that `part` names; values that do not vary along the columns stay as they are."""
    return values if values.ndim == 1 else values[:, part]
