"""openTorsion as its documentation uses it: elements, Assembly, modal analysis, vibratory torque."""

from collections.abc import Sequence
from importlib.metadata import version

import numpy as np
import opentorsion

from benchmarks.cases import Case

NAME = f"openTorsion {version('opentorsion')}"


class Numbering:
    """Nodes of a case: one a station and one a driving wheel; the root is last.

    openTorsion keeps the torque of a shaft in the row of its left node, so every shaft needs a left node of its own
    that is not the last: the child's end.
    """

    def __init__(self, case: Case):
        wheels = [i for i in range(case.size) if case.gear[i]]
        self.count = case.size + len(wheels)
        self.station = [self.count - 1 - i for i in range(case.size)]
        self.end = list(self.station)  # node at the child's end of every span
        for node, i in enumerate(wheels):
            self.end[i] = node
        self.spans = sorted(
            range(1, case.size), key=lambda i: self.end[i]
        )  # in the order of the torque's rows


def elements(case: Case) -> dict[str, list[object]]:
    """The arguments of `opentorsion.Assembly`."""
    nodes = Numbering(case)
    shafts, disks, gears = [], [], []
    for i in range(case.size):
        station, end, gear = nodes.station[i], nodes.end[i], case.gear[i]
        disks.append(opentorsion.Disk(station, case.inertia[i], c=case.damping[i]))
        if i > 0:
            parent = nodes.station[case.parent[i]]
            shafts.append(
                opentorsion.Shaft(end, parent, k=case.stiffness[i], I=0.0, c=case.viscous[i])
            )
        if gear:
            driving = opentorsion.Gear(end, gear.driving_inertia, gear.driving_teeth)
            gears += [
                driving,
                opentorsion.Gear(station, gear.driven_inertia, gear.driven_teeth, parent=driving),
            ]
    return {"shaft_elements": shafts, "disk_elements": disks, "gear_elements": gears or None}


def assembled(arguments: dict[str, list[object]]) -> opentorsion.Assembly:
    """What is timed as the assembly."""
    return opentorsion.Assembly(**arguments)


def undamped_frequencies(assembly: opentorsion.Assembly) -> np.ndarray:
    """Elastic frequencies (rad/s, ascending) of `undamped_modal_analysis`; the lowest is taken for the rigid motion."""
    squares, _ = assembly.undamped_modal_analysis()
    return np.sqrt(np.sort(np.abs(squares)))[1:]


def damped_frequencies(assembly: opentorsion.Assembly) -> np.ndarray:
    """Elastic frequencies (rad/s, ascending) of `modal_analysis`, which gives every one twice."""
    return np.sort(assembly.modal_analysis()[0])[2::2]


def excitation(
    case: Case, assembly: opentorsion.Assembly, force: Sequence[complex], w: np.ndarray
) -> opentorsion.PeriodicExcitation:
    """The same force (stations,) at every frequency."""
    nodes = Numbering(case)
    full = np.zeros(nodes.count, dtype=complex)
    full[nodes.station] = force
    return on_nodes(assembly, full, w)


def on_nodes(
    assembly: opentorsion.Assembly, force: np.ndarray, w: np.ndarray
) -> opentorsion.PeriodicExcitation:
    """The same force (nodes,) at every frequency, on the angles that are left when the gears are eliminated."""
    if assembly.gear_elements is not None:
        force = assembly.T(assembly.E()).T @ force
    periodic = opentorsion.PeriodicExcitation(len(force), w)
    periodic.U = np.repeat(force[:, None], len(w), axis=1)
    return periodic


def angles(assembly: opentorsion.Assembly, periodic: opentorsion.PeriodicExcitation) -> np.ndarray:
    """Angle of every free station, which `vibratory_torque` works out as well and does not give."""
    return assembly.ss_response(periodic.U, periodic.omegas)[0]


def span_torque(
    case: Case, assembly: opentorsion.Assembly, periodic: opentorsion.PeriodicExcitation
) -> np.ndarray:
    """Torque in span i on station i, (stations, frequencies); row 0, the root, is zero."""
    rows, _ = assembly.vibratory_torque(periodic)
    torque = np.zeros((case.size, rows.shape[1]), dtype=complex)
    torque[Numbering(case).spans] = -rows  # its rows are k (child - parent)
    return torque
