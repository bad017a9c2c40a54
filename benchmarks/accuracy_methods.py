"""The methods of the study of accuracy: how each assembles a line, finds ten modes, and answers a torque."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

import torsion
from benchmarks.accuracy_scenes import Coupling, Disc, Gear, Line, Shaft, scene
from torsion.analyses.response.excitation import Sources
from torsion.analyses.response.solver import answer

MODES = 10


@dataclass(frozen=True)
class Method:
    """One method at one fineness; `assemble` gives what `modes` and `torques` take."""

    family: str  # methods of one curve
    name: str
    assemble: Callable[[], Any]
    modes: Callable[[Any], np.ndarray]  # Hz, elastic, ascending
    torques: Callable[[Any, np.ndarray], np.ndarray] | None  # at rad/s; (shafts, frequencies) at each shaft's middle


def lumped(line: Line, segments: int) -> Method:
    """torsion's lumped model with so many segments a shaft."""
    train = torsion.parse(scene(line, segments)).train
    torques = _middle_of_segments if segments == 1 or segments % 2 == 0 else None
    return Method("lumped", f"{segments}", lambda: torsion.assemble(train, "lumped"), _modes, torques)


def elements(line: Line, degree: int, number: int) -> Method:
    """torsion's finite elements."""
    train = torsion.parse(scene(line)).train
    name, torques = f"degree {degree} x {number}", _middle_of_pieces if number % 2 == 0 else None
    return Method(
        f"FE degree {degree}", name, lambda: torsion.assemble(train, "fem", degree=degree, elements=number), _modes,
        torques,
    )  # fmt: skip


def exact(line: Line, highest: float, *, halved: bool = False) -> Method:
    """torsion's exact model for a highest frequency (Hz); `halved`: every shaft is cut at its middle as well.

    Only then is the torque at the middle returned.
    """
    train = torsion.parse(scene(line)).train
    if halved:
        pieces = max(torsion.assemble(train, "exact", frequency=highest).segments.values())
        train = torsion.parse(scene(line, pieces + pieces % 2)).train
    torques = _middle_of_pieces if halved else None
    return Method("exact", "exact", lambda: torsion.assemble(train, "exact", frequency=highest), _modes, torques)


def peer(line: Line, number: int) -> Method:
    """openTorsion's shaft elements, so many a shaft; a conical shaft in uniform steps of its mean section."""
    import opentorsion

    from benchmarks.peers_opentorsion import undamped_frequencies

    parts = _peer_elements(line, number)

    def modes(assembly: Any) -> np.ndarray:
        return undamped_frequencies(assembly)[:MODES] / (2 * np.pi)

    def torques(assembly: Any, w: np.ndarray) -> np.ndarray:
        return _peer_torques(line, number, assembly, w)

    return Method("openTorsion", f"{number}", lambda: opentorsion.Assembly(*parts), modes, torques)


def _modes(system: Any) -> np.ndarray:
    return np.asarray(torsion.modes(system, MODES).frequency)


def _answer(system: Any, w: np.ndarray) -> np.ndarray:
    """(spans, frequencies) torque from 1 N m at the first disc."""
    force = np.zeros((system.folded.tree.size, len(w)), dtype=complex)
    force[system.folded.node[0]] = system.speed_ratio[0]
    ground = system.ground_damping(np.ones(len(w)), np.zeros((len(system.stations), len(w))))
    return np.asarray(answer(system, w, Sources(force, None), ground).torque.T)


def _shaft_spans(system: Any) -> list[list[int]]:
    """The spans of every shaft, in their order along it."""
    found: dict[str, list[int]] = {name: [] for name in system.segments}
    for position, span in enumerate(system.spans):
        name = span.name.partition(" [")[0]
        if name in found:
            found[name].append(position)
    return list(found.values())


def _middle_of_segments(system: Any, w: np.ndarray) -> np.ndarray:
    """The mean of the two segments that meet at the middle; of one segment its own."""
    torque = _answer(system, w)
    rows = []
    for spans in _shaft_spans(system):
        half = len(spans) // 2
        rows.append(torque[spans[max(half - 1, 0) : half + 1]].mean(axis=0))
    return np.array(rows)


def _middle_of_pieces(system: Any, w: np.ndarray) -> np.ndarray:
    """The torque at the driving end of the piece behind the middle."""
    torque = _answer(system, w)
    return np.array([torque[spans[len(spans) // 2]] for spans in _shaft_spans(system)])


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
                    shafts.append(Element(node, node + 1, k=stiffness, I=item.density * area * length / 6))
                    node += 1
    return shafts, disks, gears or None


def _peer_torques(line: Line, number: int, assembly: Any, w: np.ndarray) -> np.ndarray:
    """openTorsion's torque of the element at the middle, or the mean of the two that meet there."""
    import opentorsion

    force = np.zeros((assembly.dofs, len(w)), dtype=complex)
    force[0] = 1.0
    if assembly.gear_elements is not None:
        force = assembly.T(assembly.E()).T @ force
    periodic = opentorsion.PeriodicExcitation(len(force), w)
    periodic.U = force
    rows, _ = assembly.vibratory_torque(periodic)
    found, first, sense = [], 0, 1
    for item in line.items:
        match item:
            case Coupling():
                first += 1
            case Gear():
                sense = -sense
            case Shaft():
                half = first + number // 2
                middle = slice(half, half + 1) if number % 2 else slice(half - 1, half + 1)
                found.append(sense * rows[middle].mean(axis=0))
                first += number
    return np.array(found)
