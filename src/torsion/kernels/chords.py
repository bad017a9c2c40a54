"""The spans that close loops in a tree: their torques in a response, from the twists around the loops."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class Chords:
    """The spans that close loops in a tree: angle[end] = angle[begin] - compliance torque + twist.

    The tree should hold the stiffest spans of every loop and these the softest; a tree of soft spans loses digits.
    """

    begin: IntArray  # (chords,) station
    end: IntArray  # (chords,) station, on which the torque is counted
    compliance: NDArray[Any]  # (chords,) or (chords, frequencies) rad/(N m)
    twist: NDArray[Any]  # (chords,) or (chords, frequencies) rad

    def at(self, part: slice) -> "Chords":
        """Return the chords with an axis for the frequencies, of which these are the ones of `part`."""
        compliance, twist = columns(self.compliance, part), columns(self.twist, part)
        return Chords(self.begin, self.end, compliance, twist)


def columns(values: NDArray[Any], part: slice) -> NDArray[Any]:
    """Return the columns (rows, .) of `values` that `part` names; a single one, or none, stands for all."""
    rows = values.reshape(len(values), -1)
    return rows if rows.shape[1] == 1 else rows[:, part]


def chord_torques(
    chords: Chords, sign: FloatArray, wound: list[NDArray[Any]], twist: NDArray[Any] | None
) -> tuple[ComplexArray, FloatArray]:
    """Return torques (chords, frequencies), and the loss of digits (frequencies,) of the equations they solve.

    Loop torques follow from the twist around each loop, summed span by span, of the open train under the sources and
    under a pair of unit torques in place of each chord. A frequency at which the open train is in resonance is lost.
    sign: `around` the loops; wound: compliance times torque (stations, frequencies) rad of the open train, then under
    each pair of unit torques; twist: imposed on the spans.
    """
    compliance = np.broadcast_to(chords.compliance, (len(sign), wound[0].shape[1]))
    open_twist = chords.twist + sign @ wound[0]
    if twist is not None:
        open_twist = open_twist - sign @ twist
    # (frequencies, chords, chords), complex where the chords alone have losses too
    matrix = np.stack([-(sign @ row).T for row in wound[1:]], axis=-1)
    matrix = matrix.astype(np.result_type(matrix, compliance), copy=False)
    terms = sum(np.abs(sign) @ np.abs(row) for row in wound[1:]) + np.abs(compliance)
    chord, identity = np.arange(len(sign)), np.eye(len(sign))
    matrix[:, chord, chord] += compliance.T
    scaled, right = matrix / terms.T[:, :, None], open_twist.T / terms.T

    # The smallest singular value of the scaled equations says how many digits are lost.
    lost = ~np.isfinite(scaled).all(axis=(1, 2))
    scaled[lost] = identity
    smallest = np.linalg.svd(scaled, compute_uv=False)[:, -1]
    lost |= smallest == 0
    scaled[lost] = identity
    torque: ComplexArray = np.linalg.solve(scaled, right[:, :, None])[:, :, 0].T.astype(
        np.complex128
    )
    torque[:, lost] = np.nan
    return torque, np.where(lost, np.inf, np.maximum(1.0, 1 / smallest))


def chord_residual(chords: Chords, angle: ComplexArray, torque: ComplexArray) -> FloatArray:
    """Return the worst residual (frequencies,) of the equation of any chord, relative to the terms in it."""
    wound, begin, end = chords.compliance * torque, angle[chords.begin], angle[chords.end]
    error = np.abs(end - begin + wound - chords.twist) / (
        np.abs(end) + np.abs(begin) + np.abs(wound) + np.abs(chords.twist)
    )
    worst: FloatArray = np.fmax.reduce(error, axis=0, initial=0.0)
    return worst


def around(tree: Tree, first: IntArray, second: IntArray) -> FloatArray:
    """+1 and -1 (chords, stations) for the spans whose twists add up to angle[first] - angle[second]; else 0.

    Raises ValueError for a chord between parts that nothing else joins.
    """
    sign = np.zeros((len(first), tree.size))
    for chord, ends in enumerate(zip(second.tolist(), first.tolist(), strict=True)):
        ends_reached = list(ends)
        for side, direction in ((0, 1.0), (1, -1.0)):
            while tree.parents[ends_reached[side]] >= 0:
                sign[chord, ends_reached[side]] += direction
                ends_reached[side] = tree.parents[ends_reached[side]]
        if ends_reached[0] != ends_reached[1] and not tree.held[ends_reached].all():
            raise ValueError(
                f"chord {chord} is the only connection of two parts; expected it in the tree"
            )
    return sign


def pairs(stations: int, first: IntArray, second: IntArray) -> FloatArray:
    """Torques (chords, stations) with which a unit torque in each chord acts on the tree."""
    pair, chord = np.zeros((len(first), stations)), np.arange(len(first))
    np.add.at(pair, (chord, second), 1.0)
    np.add.at(pair, (chord, first), -1.0)
    return pair
