"""The candidates of the study of accuracy: every model of torsion and openTorsion's elements, on one line of shafts."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

import torsion
from benchmarks.accuracy_references import middle_torques
from benchmarks.accuracy_scenes import Coupling, Disc, Gear, Line, Shaft, halved, scene
from benchmarks.programs import tolerant
from benchmarks.references import worst
from torsion.analyses.compare.model_errors import (
    Loaded,
    candidates,
    counted,
    loaded,
    over_largest,
    response_torques,
)
from torsion.analyses.compare.timing import Candidate, Effort
from torsion.assembly.system import System

MODES = 10
PEER = "openTorsion"
Errors = Callable[[Any], tuple[float, ...]]


def mode_curves(
    line: Line, known: Sequence[Any], effort: Effort, peers: Sequence[int]
) -> list[list[Candidate]]:
    """How to find the first ten modes; error: the largest of `known` (modes,) Hz, relative. peers: elements a shaft."""

    def errors(found: np.ndarray) -> tuple[float, ...]:
        return (worst(found, known),)

    def solve(system: System) -> np.ndarray:
        return np.asarray(torsion.modes(system, MODES).frequency)

    def of_peer(assembly: Any) -> np.ndarray:
        from benchmarks.peers_opentorsion import undamped_frequencies

        return undamped_frequencies(assembly)[:MODES] / (2 * np.pi)

    train, named = torsion.parse(scene(line)).train, partial(Candidate, solve=solve, errors=errors)
    own = candidates(train, float(known[-1]) * (1 + 1e-9), effort, named)
    return [*own, [_peer(line, number, of_peer, errors) for number in peers]]


def torque_curves(
    line: Line, w: np.ndarray, effort: Effort, peers: Sequence[int]
) -> list[list[Candidate]]:
    """How to find the torques at the middles of the shafts; segments, elements and `peers` are those of half a shaft.

    w: (frequencies,) rad/s. Error: the largest, over the largest of these torques at the same frequency.
    """
    halves, exact = halved(line), middle_torques(line, w.tolist())
    study = torsion.parse(scene(halves))
    seconds = [f"item {k}" for k, item in enumerate(halves.items) if isinstance(item, Shaft)][1::2]

    def errors(found: np.ndarray) -> tuple[float, ...]:
        return (float(over_largest(found, exact).max()),)

    def named(curve: str, words: str, size: int, assemble: Callable[[], System]) -> Candidate:
        return Candidate(curve, words, size, lambda: loaded(assemble(), study, w), solve, errors)

    def solve(given: Loaded) -> np.ndarray:
        places = [given.ends.name.index(name) for name in seconds]
        return np.asarray(response_torques(given)[0].torque[:, places])

    def of_peer(assembly: Any, number: int) -> np.ndarray:
        return _peer_torques(halves, number, assembly, w)

    own = candidates(study.train, float(w.max()) / (2 * np.pi), effort, named)
    return [
        *own,
        [_peer(halves, number, partial(of_peer, number=number), errors) for number in peers],
    ]


def _peer(line: Line, number: int, solve: Callable[[Any], np.ndarray], errors: Errors) -> Candidate:
    """openTorsion's shaft elements, so many a shaft; a conical shaft in uniform steps of its mean section."""
    import opentorsion

    parts = _peer_elements(line, number)
    return Candidate(
        PEER,
        counted(number, "element"),
        number,
        lambda: opentorsion.Assembly(*parts),
        tolerant(solve),
        errors,
    )


def _peer_elements(line: Line, number: int) -> tuple[list[Any], list[Any], list[Any] | None]:
    """Shafts, discs and gears from the first node on."""
    from opentorsion import Disk
    from opentorsion import Gear as Wheel
    from opentorsion import Shaft as Element

    node, shafts, disks, gears = 0, list[Any](), list[Any](), list[Any]()
    for item in line.items:
        match item:
            case Disc():
                disks.append(Disk(node, item.inertia, c=item.damping))
            case Coupling():
                shafts.append(Element(node, node + 1, k=item.stiffness, I=0.0))
                node += 1
            case Gear():
                driving = Wheel(node, item.inertia[0], item.teeth[0])
                gears += [driving, Wheel(node + 1, item.inertia[1], item.teeth[1], parent=driving)]
                node += 1
            case Shaft():
                edges = np.linspace(*item.diameter, number + 1).tolist()
                length = item.length / number
                for start, stop in pairwise(edges):
                    diameter = (start + stop) / 2
                    area = np.pi / 32 * (diameter**4 - item.bore**4)
                    stiffness = item.shear_modulus * area / length
                    shafts.append(
                        Element(node, node + 1, k=stiffness, I=item.density * area * length / 6)
                    )
                    node += 1
    return shafts, disks, gears or None


def _peer_torques(halves: Line, number: int, assembly: Any, w: np.ndarray) -> np.ndarray:
    """(frequencies, shafts) the mean of openTorsion's torques of the two elements that meet at the middle."""
    from benchmarks.peers_opentorsion import on_nodes

    rows, _ = assembly.vibratory_torque(
        on_nodes(assembly, np.eye(assembly.dofs, dtype=complex)[0], w)
    )
    behind, first, sense = [], 0, 1
    for item in halves.items:
        match item:
            case Coupling():
                first += 1
            case Gear():
                sense = -sense
            case Shaft():
                first += number
                behind.append(sense * rows[first - 1 : first + 1].mean(axis=0))
    return np.array(behind[::2]).T
