"""Forced response of a train with closed loops: a tree, and spans that close it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.kernels.response import TreeResponse, pose, residual_of, tree_response
from torsion.kernels.tree import ComplexArray, FloatArray, IntArray, Tree


@dataclass(frozen=True)
class Closing:
    """Spans that close loops in a tree: angle[end] = angle[begin] - compliance torque + twist.

    The tree should hold the stiffest spans of every loop and these the softest; a tree of soft spans loses digits.
    """

    begin: IntArray  # (closing spans,) station
    end: IntArray  # (closing spans,) station, on which the torque is counted
    compliance: NDArray[Any]  # (closing spans,) or (closing spans, frequencies) rad/(N m)
    twist: NDArray[Any]  # (closing spans,) or (closing spans, frequencies) rad


def closed_response(
    tree: Tree,
    closing: Closing,
    w: FloatArray,
    force: NDArray[Any],
    *,
    twist: NDArray[Any] | None = None,
    ground_damping: FloatArray | None = None,
    compliance: NDArray[Any] | None = None,
    check: bool = True,
) -> TreeResponse:
    """Response of tree and closing spans; arguments as of `tree_response`, torques of closing spans in addition.

    Loop torques follow from the twist around each loop, summed span by span, of the open train under the sources and
    under a pair of unit torques in place of each closing span. A line in which the open train by itself is in
    resonance is marked as singular. Raises ValueError if a closing span joins parts that the tree does not join.
    """
    w = np.asarray(w, dtype=np.float64)
    force = np.asarray(force)
    sign = _around(tree, closing)
    pair = _pairs(tree.size, closing)
    given: dict[str, Any] = {"ground_damping": ground_damping, "compliance": compliance, "check": True}
    opened = [
        tree_response(tree, w, force, twist=twist, **given),
        *(tree_response(tree, w, row, **given) for row in pair),
    ]
    hc = _rows(tree.flexibility if compliance is None else compliance)
    with np.errstate(all="ignore"):
        torque, loss = _loop_torques(closing, sign, opened, hc, twist)
        loss = loss * np.max([part.amplification for part in opened], axis=0)
        angles, torques = (_sum([getattr(part, name) for part in opened], torque) for name in ("angle", "torque"))
        loss[~np.isfinite(angles.sum(axis=0) + torques.sum(axis=0) + torque.sum(axis=0)) | np.isnan(loss)] = np.inf
    result = TreeResponse(angles, torques, np.full(w.size, np.nan), loss if check else np.full(w.size, np.nan), torque)
    if check:
        acting = _rows(force) + np.tensordot(pair.T, torque, axes=1)
        problem = pose(tree, w, ground_damping, compliance)
        result.residual[:] = np.fmax(residual_of(problem, acting, twist, result), _closing_residual(closing, result))
    return result


def _rows(values: NDArray[Any]) -> NDArray[Any]:
    """Values with an axis for the frequencies."""
    values = np.asarray(values)
    return values[:, None] if values.ndim == 1 else values


def _around(tree: Tree, closing: Closing) -> FloatArray:
    """Direction, (closing spans, stations), in which each span is passed from `begin` to `end`; 0 where it is not."""
    sign = np.zeros((len(closing.begin), tree.size))
    parent = tree.parent.tolist()
    for number, ends in enumerate(zip(closing.end.tolist(), closing.begin.tolist(), strict=True)):
        here = list(ends)
        for side, direction in ((0, 1.0), (1, -1.0)):
            while parent[here[side]] >= 0:
                sign[number, here[side]] += direction
                here[side] = parent[here[side]]
        if here[0] != here[1] and not tree.held[here].all():
            raise ValueError(f"closing span {number} joins two parts that nothing else joins; expected it in the tree")
    return sign


def _pairs(stations: int, closing: Closing) -> FloatArray:
    """Torques, (closing spans, stations), with which a unit torque in each closing span acts on the tree."""
    pair = np.zeros((len(closing.begin), stations))
    lines = np.arange(len(closing.begin))
    np.add.at(pair, (lines, closing.end), 1.0)
    np.add.at(pair, (lines, closing.begin), -1.0)
    return pair


def _loop_torques(
    closing: Closing, sign: FloatArray, opened: list[TreeResponse], hc: NDArray[Any], twist: NDArray[Any] | None
) -> tuple[ComplexArray, FloatArray]:
    """Torques (closing spans, frequencies), and the loss of digits (frequencies,) of the equations they solve."""
    own = np.broadcast_to(_rows(closing.compliance), (len(sign), opened[0].torque.shape[1]))
    open_twist = _rows(closing.twist) + np.tensordot(sign, hc * opened[0].torque, axes=1)
    if twist is not None:
        open_twist = open_twist - np.tensordot(sign, _rows(twist), axes=1)
    matrix = np.stack([-np.tensordot(sign, hc * part.torque, axes=1) for part in opened[1:]], axis=-1)
    terms = sum(np.tensordot(np.abs(sign), np.abs(hc * part.torque), axes=1) for part in opened[1:]) + np.abs(own)
    matrix = np.moveaxis(matrix, 1, 0)  # (frequencies, closing spans, closing spans)
    lines = np.arange(len(sign))
    matrix[:, lines, lines] += own.T
    scaled, right = matrix / terms.T[:, :, None], open_twist.T / terms.T
    lost = ~np.isfinite(scaled).all(axis=(1, 2))
    scaled[lost] = np.eye(len(sign))
    least = np.linalg.svd(scaled, compute_uv=False)[:, -1]
    lost |= least == 0
    scaled[lost] = np.eye(len(sign))
    torque: ComplexArray = np.linalg.solve(scaled, right[:, :, None])[:, :, 0].T.astype(np.complex128)
    torque[:, lost] = np.nan
    return torque, np.where(lost, np.inf, np.maximum(1.0, 1 / least))


def _sum(parts: list[ComplexArray], torque: ComplexArray) -> ComplexArray:
    total = parts[0].copy()
    for part, row in zip(parts[1:], torque, strict=True):
        total += part * row
    return total


def _closing_residual(closing: Closing, answer: TreeResponse) -> FloatArray:
    wound = _rows(closing.compliance) * answer.closing_torque
    begin, end, twist = answer.angle[closing.begin], answer.angle[closing.end], _rows(closing.twist)
    with np.errstate(all="ignore"):
        error = np.abs(end - begin + wound - twist) / (np.abs(end) + np.abs(begin) + np.abs(wound) + np.abs(twist))
    worst: FloatArray = np.fmax.reduce(error, axis=0, initial=0.0)
    return worst
