"""Sweeps of the steady response: near-rigid coupling, exact resonance, speeds down to 0."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from benchmarks import dense_peers, ours, peers_opentorsion, references
from benchmarks.cases import Case
from benchmarks.extremes import Sweep
from benchmarks.stiffness_frequencies import PEER, line, near_rigid_data
from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import Status, status, tree_response

RESPONSE = "torsion tree_response"
COUPLING = 3  # the span that grows stiff


def near_rigid_torque(stiffnesses: Sequence[float]) -> Sweep:
    """The torque in the coupling itself."""
    sweep = Sweep(
        "near_rigid_torque",
        "Near-rigid coupling: its torque",
        "The same chain, 1 N m at the first disc at 60 rad/s; the relative error of the torque in the coupling.",
        "stiffness of the coupling, N m/rad",
    )
    inertia, springs = near_rigid_data()
    for stiffness in stiffnesses:
        springs[COUPLING - 1] = stiffness
        _add(sweep, stiffness, line("near-rigid", inertia, springs), 60.0, span=COUPLING)
    springs[COUPLING - 1] = 1e60
    exact = references.response(line("rigid", inertia, springs), 60.0, _unit(6))[1]
    bare = ours.tree(line("rigid", inertia, springs))
    flexibility = bare.flexibility.copy()
    flexibility[COUPLING] = 0.0
    found = tree_response(
        replace(bare, flexibility=flexibility), np.array([60.0]), np.array(_unit(6))
    )
    error = references.torque_errors(found.torque[[COUPLING], 0], [exact[COUPLING]])[0]
    sweep.remarks.append(
        f"Rigid altogether (flexibility 0): torsion's torque is {error:.1e} off the limit."
    )
    return sweep


def resonance(ratios: Sequence[float]) -> Sweep:
    """At the double nearest to an undamped natural frequency, with less and less damping."""
    sweep = Sweep(
        "resonance",
        "Response at resonance",
        "Free chain of ten discs, dampers to ground in proportion to the inertias, at the double nearest to the third "
        "natural frequency; the largest error of the torques, over the largest torque. The line without points "
        "is no method: it is how far the torques at the next double frequency lie.",
        "damping ratio",
    )
    random = np.random.default_rng(5)
    inertia, springs = random.uniform(0.5, 2.0, 10).tolist(), random.uniform(1e4, 5e4, 9).tolist()
    w = float(references.frequencies(line("bare", inertia, springs), [3])[0])
    beside, known_from = float(np.nextafter(w, np.inf)), dict[str, float]()
    for ratio in ratios:
        case = line("damped", inertia, springs, damping=[2 * ratio * w * j for j in inertia])
        _add(sweep, ratio, case, w)
        exact, near = (references.response(case, value, _unit(10))[1] for value in (w, beside))
        difference = max(abs(a - b) for a, b in zip(exact, near, strict=True)) / max(
            abs(a) for a in exact
        )
        sweep.limit.append((ratio, float(difference)))
        known_from.setdefault(_status(case, w), ratio)
    undamped = _status(line("bare", inertia, springs), w)
    words = ", ".join(f"{name} from {ratio:.2g} on" for name, ratio in known_from.items())
    sweep.remarks.append(
        f"torsion's own status of the line: {words}; without any damping {undamped}."
    )
    return sweep


def slow(frequencies: Sequence[float]) -> Sweep:
    """A free train near standstill."""
    sweep = Sweep(
        "slow",
        "Speed near 0",
        "Free chain of six discs, 1 N m at the first; the largest error of the torques, over the largest torque. The "
        "train as a whole moves by ever larger angles while its twist stays finite.",
        "frequency, rad/s",
    )
    inertia, springs = near_rigid_data()
    case = line("slow", inertia, springs)
    for w in frequencies:
        _add(sweep, w, case, w)
    held = np.zeros(6, dtype=bool)
    held[0] = True
    bare: Tree = replace(ours.tree(case), held=held)
    force = np.array(_unit(6)[::-1])
    found = tree_response(bare, np.zeros(1), force)
    twist = float(np.abs(np.abs(found.torque[1:, 0]) - 1.0).max())
    sweep.remarks += [
        f"At exactly 0, free: torsion gives the status {_status(case, 0.0)}, as there is no steady answer.",
        f"At exactly 0, first disc fixed, 1 N m at the last: all torques are 1 N m, torsion's error {twist:.1e}.",
    ]
    return sweep


def _add(sweep: Sweep, at: float, case: Case, w: float, *, span: int | None = None) -> None:
    """Every program's error of all torques over the largest, or of one span over its own."""
    force = np.array(_unit(case.size))
    exact = references.response(case, w, force.tolist())[1]
    part = slice(1, None) if span is None else slice(span, span + 1)

    def error(torque: np.ndarray) -> float:
        return references.torque_errors(torque[part], exact[part])[0]

    frequency = np.array([w])
    assembly = peers_opentorsion.assembled(peers_opentorsion.elements(case))
    periodic = peers_opentorsion.excitation(case, assembly, force.tolist(), frequency)
    response = ours.Response(case, force.tolist(), frequency)
    sweep.add(RESPONSE, at, lambda: error(response.span_torque(response())[:, 0]))
    sweep.add(
        PEER, at, lambda: error(peers_opentorsion.span_torque(case, assembly, periodic)[:, 0])
    )
    sweep.add(dense_peers.SOLVE, at, lambda: error(dense_peers.span_torque(case, force, w)))


def _status(case: Case, w: float) -> str:
    found = ours.Response(case, _unit(case.size), np.array([w]))()
    return (
        Status(int(status(found.amplification, found.residual)[0])).name.lower().replace("_", "-")
    )


def _unit(size: int) -> list[complex]:
    return [1.0 + 0.0j, *([0.0j] * (size - 1))]
