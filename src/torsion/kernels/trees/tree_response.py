"""Forced response of a tree at many frequencies, with full torques, a residual and an amplification of errors."""

from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.trees.elimination import EPS, Layout, eliminate, forced, layout
from torsion.kernels.trees.tree import Tree

if TYPE_CHECKING:
    from torsion.kernels.distributed.span_laws import Pi


@dataclass(frozen=True)
class Chords:
    """The spans that close loops in a tree: angle[end] = angle[begin] - compliance torque + twist.

    The tree should hold the stiffest spans of every loop and these the softest; a tree of soft spans loses digits.
    """

    begin: IntArray  # (chords,) station
    end: IntArray  # (chords,) station, on which the torque is counted
    compliance: NDArray[Any]  # (chords,) or (chords, frequencies) rad/(N m)
    twist: NDArray[Any]  # (chords,) or (chords, frequencies) rad


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


CANCELLED = 1e-6  # of the largest: rounding of it, 1e-14, is then what NEAR_SINGULAR_LOSS allows of a smaller one
NEAR_SINGULAR_LOSS = 1e-8  # relative error of the answer, from rounding of the data, above which a frequency is marked
CHUNK_VALUES = 2**18  # stations times columns treated at once, whose rows stay in the cache
# Columns; fewer, and calls cost more than sums (measured).
SHORTEST_CHUNK, LONGEST_CHUNK = 512, 2048


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
    # (stations, frequencies) N m, elastic and damping share together; 0 at a root.
    torque: ComplexArray
    # (stations, frequencies) N m; `torque` itself where no span has inertia.
    torque_outer: ComplexArray
    residual: FloatArray  # (frequencies,) of the worst equation, relative to the terms in it
    # (frequencies,) growth of relative errors of the data; infinite where singular
    amplification: FloatArray
    chord_torque: ComplexArray  # (chords, frequencies) N m of each chord of a loop on its end


def tree_response(tree: Tree, w: FloatArray, force: NDArray[Any], **given: Any) -> TreeResponse:
    """Response of every station and span; arguments and errors as of `pose`.

    A singular frequency is never raised or warned of: see `status`.
    Demmel and Gragg (1993) explain the accuracy of such sweeps.
    """
    problem = pose(tree, w, force, **given)
    size, number, chords = tree.size, problem.w.size, problem.chords
    angle, torque = np.empty((2, size, number), dtype=complex)
    outer = torque if tree.shafts is None else torque.copy()
    of_chords = np.empty((0 if chords is None else len(chords.begin), number), dtype=complex)
    residual, amplification = np.empty((2, number))
    result = TreeResponse(angle, torque, outer, residual, amplification, of_chords)
    length = max(SHORTEST_CHUNK, min(CHUNK_VALUES // size, LONGEST_CHUNK))
    for part in (slice(start, start + length) for start in range(0, number, length)):
        solved = _solved(problem, part)
        for values, found in zip(vars(result).values(), solved, strict=True):
            values[..., part] = found
    return result


def complex_compliance(
    flexibility: FloatArray, viscous: FloatArray, loss_factor: FloatArray, w: FloatArray
) -> NDArray[Any]:
    """Compliance h/(1 + i eta + i w c h) of spans, rad/(N m); a rigid span stays 0, an infinite h leaves the damper.

    flexibility, viscous (N m s/rad), loss_factor: (spans,), or (spans, frequencies) of trains side by side.
    (spans,) if no span is viscous and no figure has columns (real if none is lossy), else (spans, frequencies) complex.
    """
    h, c, eta = (np.asarray(values, dtype=float) for values in (flexibility, viscous, loss_factor))
    if max(h.ndim, c.ndim, eta.ndim) > 1 or c.any():
        h, c, eta = (values.reshape(len(values), -1) for values in (h, c, eta))
    if not c.any():
        return h / (1 + 1j * eta) if eta.any() else h
    stiffness = np.divide(1.0, h, out=np.full(h.shape, np.inf), where=h > 0)
    rigid = h == 0
    with np.errstate(divide="ignore", invalid="ignore"):
        hc: NDArray[Any] = 1 / (np.where(rigid, 1.0, stiffness) * (1 + 1j * eta) + 1j * (c * w))
    return np.where(rigid, 0.0, hc)


def status(amplification: FloatArray, residual: FloatArray) -> NDArray[np.uint8]:
    """`Status` at each frequency, (frequencies,) uint8; a residual that is NaN is not judged."""
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
    # What the distributed shafts have brought: hc, and -w^2 J at both ends, (shafts, columns)
    pi: "Pi | None" = None


@dataclass(frozen=True)
class Problem:
    """What `tree_response` is given, checked once; arrays have a column for each frequency, or stand for all."""

    plan: Layout
    tree: Tree
    w: FloatArray  # (frequencies,) rad/s
    force: NDArray[Any]  # (stations, ...) N m
    twist: NDArray[Any] | None  # (stations, ...) rad of the span
    damping: FloatArray  # (stations, ...) N m s/rad to ground
    compliance: NDArray[Any]  # (stations, ...) rad/(N m)
    shaft_loss: FloatArray  # (shafts,) loss factor of each distributed shaft
    chords: Chords | None

    def equations(self, part: slice) -> Equations:
        """Return the equations at the frequencies of `part`."""
        w, tree, shafts = self.w[part], self.tree, self.tree.shafts
        stiffness: NDArray[Any] = columns(tree.inertia_columns, part) * -(w * w)
        if self.damping.any():
            stiffness = stiffness + 1j * (w * columns(self.damping, part))
        compliance, force = columns(self.compliance, part), columns(self.force, part)
        twist = None if self.twist is None else columns(self.twist, part)
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
    chords: Chords | None = None,
    shaft_loss: FloatArray | None = None,
) -> Problem:
    """Return the problem of the response at circular frequencies `w` (frequencies,) rad/s, in fitting arrays.

    Of trains of one layout side by side the tree has a column of inertias (and `compliance` one) for each frequency.
    force: (stations,) or (stations, frequencies) N m. twist: the same shapes, rad, imposed on span i:
    angle[i] = angle[parent] - compliance torque + twist; also on rigid spans.
    ground_damping N m s/rad and compliance rad/(N m), default `tree.flexibility`: the same shapes.
    chords: spans that close loops in the tree.
    shaft_loss: loss factor (shafts,) of the shear modulus of each distributed shaft of the tree, whose compliance is
    not used and whose twist must be 0.
    Raises ValueError for a shape that does not fit, SolveError for a frequency at which the law of a shaft ends.
    """
    w, shafts, none = np.asarray(w, dtype=float), tree.shafts, np.zeros(tree.size)
    if w.ndim != 1:
        raise ValueError(f"w has shape {w.shape}; expected (frequencies,)")
    damping = none if ground_damping is None else np.asarray(ground_damping, dtype=float)
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
        else np.asarray(shaft_loss, dtype=float)
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
    acting = np.where(tree.held, 0.0, force.T).T
    imposed = twist if twist.any() else None
    return Problem(layout(tree, rigid), tree, w, acting, imposed, damping, hc, loss, chords)


def _solved(problem: Problem, part: slice) -> tuple[NDArray[Any], ...]:
    """Return the fields of the response at the frequencies of `part`."""
    given, plan, tree = problem.equations(part), problem.plan, problem.tree
    with np.errstate(all="ignore"):
        sides = eliminate(plan, given.own, given.compliance, guard=True)
        angle, torque = forced(sides, given.force, given.twist)

        # Growth of relative errors of the data: 1 + 2 sum |own receptance| over the free stations, twice the change of
        # the determinant under relative changes of every inertia and damper to ground. In a mode the springs hold as
        # much energy as the inertias, hence twice; |z| is taken as |real| + |imaginary|.
        amplification, residual = np.ones(angle.shape[1]), np.zeros(angle.shape[1])
        for station in np.flatnonzero(~np.array(plan.prescribed)).tolist():
            loss = given.own[station] * sides.divisor[station] * sides.meeting[station]
            amplification += 2 * (np.abs(loss.real) + np.abs(loss.imag))
        of_chords = np.zeros((0, angle.shape[1]), dtype=complex)
        if problem.chords is not None:
            compliance, imposed = (
                columns(values, part)
                for values in (problem.chords.compliance, problem.chords.twist)
            )
            chords = replace(problem.chords, compliance=compliance, twist=imposed)
            ends = chords.begin, chords.end
            pair = np.where(tree.held, 0.0, pairs(tree.size, *ends))
            units = [forced(sides, row) for row in pair[:, :, None]]
            wound = [given.compliance * row for row in (torque, *(unit[1] for unit in units))]
            of_chords, loss = chord_torques(chords, around(tree, *ends), wound, given.twist)
            for unit, row in zip(units, of_chords, strict=True):
                angle, torque = angle + unit[0] * row, torque + unit[1] * row
            given = replace(given, force=given.force + pair.T @ of_chords)
            amplification *= loss

            # The worst of the equations of the chords, relative to the terms in it.
            end, begin, opened = angle[chords.end], angle[chords.begin], compliance * of_chords
            terms = (np.abs(values) for values in (end, begin, opened, imposed))
            error = np.abs(end - begin + opened - imposed) / sum(terms)
            residual = np.fmax.reduce(error, axis=0, initial=0.0)
        residual = np.fmax(equilibrium_residual(plan, given, angle, torque), residual)
        total = angle.sum(axis=0) + torque.sum(axis=0) + of_chords.sum(axis=0) + amplification
        amplification[~np.isfinite(total)] = np.inf
        outer = torque
        if given.pi is not None and tree.shafts is not None:
            node, outer = tree.shafts.node, torque.copy()
            outer[node] -= given.pi[2] * angle[node]
            torque[node] += given.pi[1] * angle[tree.shaft_parent]
    return angle, torque, outer, residual, amplification, of_chords


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
            worst = np.fmax(worst, np.abs(error) / np.maximum(scale, least_torque))

        # Of a span: angle = angle of the parent - hc torque + twist.
        if parent >= 0:
            error = given.compliance[station] * torque[station]
            scale = np.abs(error)
            scale += turned[station] + turned[parent]
            error += angle[station] - angle[parent]
            if given.twist is not None:
                error -= given.twist[station]
                scale += np.abs(given.twist[station])
            worst = np.fmax(worst, np.abs(error) / np.maximum(scale, least_angle))
    return worst
