"""Forced response of a train with closed loops: a tree, and the chords that close it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.loops.chords import around, pairs
from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import TreeResponse, pose, residual_of, tree_response


@dataclass(frozen=True)
class Chords:
    """The spans that close loops in a tree: angle[end] = angle[begin] - compliance torque + twist.

    The tree should hold the stiffest spans of every loop and these the softest; a tree of soft spans loses digits.
    """

    begin: IntArray  # (chords,) station
    end: IntArray  # (chords,) station, on which the torque is counted
    compliance: NDArray[Any]  # (chords,) or (chords, frequencies) rad/(N m)
    twist: NDArray[Any]  # (chords,) or (chords, frequencies) rad


def looped_response(
    tree: Tree,
    chords: Chords,
    w: FloatArray,
    force: NDArray[Any],
    *,
    twist: NDArray[Any] | None = None,
    ground_damping: FloatArray | None = None,
    compliance: NDArray[Any] | None = None,
) -> TreeResponse:
    """Response of tree and chords; arguments as of `tree_response`, torques of chords in addition.

    Loop torques follow from the twist around each loop, summed span by span, of the open train under the sources and
    under a pair of unit torques in place of each chord. A frequency at which the open train is in
    resonance is marked as singular. Raises ValueError if a chord joins parts that the tree does not join.
    """
    sign, pair = around(tree, chords.begin, chords.end), pairs(tree.size, chords.begin, chords.end)
    given: dict[str, Any] = {"ground_damping": ground_damping, "compliance": compliance}
    opened = [
        tree_response(tree, w, force, twist=twist, **given),
        *(tree_response(tree, w, row, **given) for row in pair),
    ]
    hc = _rows(tree.flexibility if compliance is None else compliance)
    with np.errstate(all="ignore"):
        torque, loss = _loop_torques(chords, sign, opened, hc, twist)
        loss = loss * np.max([part.amplification for part in opened], axis=0)
        angles, torques = opened[0].angle.copy(), opened[0].torque.copy()
        for part, row in zip(opened[1:], torque, strict=True):
            angles += part.angle * row
            torques += part.torque * row
        loss[~np.isfinite(angles.sum(axis=0) + torques.sum(axis=0) + torque.sum(axis=0)) | np.isnan(loss)] = np.inf
        result = TreeResponse(angles, torques, torques, np.empty_like(loss), loss, torque)
        problem = pose(tree, w, _rows(force) + pair.T @ torque, twist=twist, **given)
        result.residual[:] = np.fmax(residual_of(problem, result), _chord_residual(chords, result))
    return result


def _rows(values: NDArray[Any]) -> NDArray[Any]:
    """Values with an axis for the frequencies."""
    return np.asarray(values).reshape(len(values), -1)


def _loop_torques(
    chords: Chords, sign: FloatArray, opened: list[TreeResponse], hc: NDArray[Any], twist: NDArray[Any] | None
) -> tuple[ComplexArray, FloatArray]:
    """Torques (chords, frequencies), and the loss of digits (frequencies,) of the equations they solve."""
    own = np.broadcast_to(_rows(chords.compliance), (len(sign), opened[0].torque.shape[1]))
    open_twist = _rows(chords.twist) + sign @ (hc * opened[0].torque)
    if twist is not None:
        open_twist = open_twist - sign @ _rows(twist)
    matrix = np.stack([-(sign @ (hc * part.torque)).T for part in opened[1:]], axis=-1)  # (frequencies, chords, chords)
    terms = sum(np.abs(sign) @ np.abs(hc * part.torque) for part in opened[1:]) + np.abs(own)
    chord, one = np.arange(len(sign)), np.eye(len(sign))
    matrix[:, chord, chord] += own.T
    scaled, right = matrix / terms.T[:, :, None], open_twist.T / terms.T
    lost = ~np.isfinite(scaled).all(axis=(1, 2))
    scaled[lost] = one
    least = np.linalg.svd(scaled, compute_uv=False)[:, -1]
    lost |= least == 0
    scaled[lost] = one
    torque: ComplexArray = np.linalg.solve(scaled, right[:, :, None])[:, :, 0].T.astype(np.complex128)
    torque[:, lost] = np.nan
    return torque, np.where(lost, np.inf, np.maximum(1.0, 1 / least))


def _chord_residual(chords: Chords, answer: TreeResponse) -> FloatArray:
    """Worst residual (frequencies,) of the equation of any chord, relative to the terms in it."""
    wound, twist = _rows(chords.compliance) * answer.chord_torque, _rows(chords.twist)
    begin, end = answer.angle[chords.begin], answer.angle[chords.end]
    error = np.abs(end - begin + wound - twist) / (np.abs(end) + np.abs(begin) + np.abs(wound) + np.abs(twist))
    worst: FloatArray = np.fmax.reduce(error, axis=0, initial=0.0)
    return worst
