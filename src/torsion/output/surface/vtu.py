"""The mode shapes as modes.vtu, which ParaView opens: the train as a surface, with what each mode does to it."""

import tempfile
from pathlib import Path

import numpy as np

from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.surface.axes import axes
from torsion.output.surface.surface import Rings, angles, rings, shapes, surface, torques, turned

NAME = "modes.vtu"
AROUND, LEAST_AROUND = 48, 12  # points on a ring
MOST_NUMBERS = 30_000_000  # in the file


def vtu(_document: Document, findings: Findings) -> bytes:
    """The file; raises InputError where there is no mode, or more than such a file can hold."""
    import meshio

    modes, found = shapes(findings), rings(findings.system, axes(findings.system))
    count = modes.frequency.size
    made = surface(found, _around(findings, found, count))
    quads, digits = len(made.quads), max(2, len(str(count)))
    cells = [("quad", made.quads)] + ([("triangle", made.triangles)] if len(made.triangles) else [])

    def split(values: np.ndarray) -> list[np.ndarray]:
        own = values[made.strip]
        return [own[:quads], own[quads:]][: len(cells)]

    at_points: dict[str, np.ndarray] = {}
    at_cells = {"component": split(found.part.astype(np.int32)), "to_scale": split(found.to_scale.astype(np.uint8))}
    for mode in range(count):
        name, angle, torque = f"mode_{mode + 1:0{digits}}", angles(found, modes, mode), torques(found, modes, mode)
        at_points[f"{name}_displacement"] = made.tangent * turned(found, angle)[made.ring, None]
        at_points[f"{name}_angle"] = angle[made.ring]
        at_points[f"{name}_angle_relative"] = (angle / np.abs(angle).max())[made.ring]
        at_cells[f"{name}_torque"] = split(torque)
        if np.isfinite(found.modulus).any():
            at_cells[f"{name}_stress"] = split(torque / found.modulus)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / NAME
        meshio.Mesh(made.points, cells, point_data=at_points, cell_data=at_cells).write(path, file_format="vtu")
        return path.read_bytes()


def _around(findings: Findings, found: Rings, modes: int) -> int:
    """As many points on a ring as the file has room for."""
    most = MOST_NUMBERS // (found.x.size * (3 + 7 * modes))
    if most < LEAST_AROUND:
        size = f"{modes} modes on {found.x.size} rings"
        message = f"{size} are more than {NAME} is made for"
        path = ("analyses",) if findings.study.analyses else ("train",)
        raise InputError([Fault(path, message, "request fewer modes (`modes: {count: 6}`), or leave --vtu out")])
    return min(most, AROUND)
