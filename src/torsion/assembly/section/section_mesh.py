"""The triangles of a cross-section from a mesh file; the one place that reads meshes."""

import contextlib
import io
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from torsion.arrays import FloatArray, IntArray

LARGEST_FILE = 20_000_000  # bytes; a mesh of MOST triangles has a tenth of it
MOST = 10_000  # triangles; they are divided into four at least once
PLANE = {"triangle": 3, "triangle6": 6}
LOWER = ("vertex", "line", "line3")  # points and sides, by which a mesher marks boundaries


class SectionFault(Exception):
    """What is wrong with a mesh as a cross-section, and what would be right."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message, self.hint = message, hint


@dataclass(frozen=True)
class Triangles:
    """Quadratic triangles, straight or curved: three corners, then the nodes amid the sides 01, 12 and 20."""

    points: FloatArray  # (points, 2)
    nodes: IntArray  # (triangles, 6)


def read_triangles(file: str | Path) -> Triangles:
    """The triangles of a mesh file in its own unit; raises SectionFault.

    Cells of lower dimension are marks and points that no triangle has are construction points: both say nothing here.
    """
    mesh = _read(Path(file))
    cells = {block.type: 0 for block in mesh.cells}
    for block in mesh.cells:
        cells[block.type] += len(block.data)
    _refuse_other_cells(cells)
    kinds = [kind for kind in PLANE if cells.get(kind)]
    if len(kinds) != 1:
        raise SectionFault("the mesh has no triangles" if not kinds else "straight and quadratic triangles are mixed")
    if cells[kinds[0]] > MOST:
        raise SectionFault(f"the mesh has {cells[kinds[0]]} triangles", f"at most {MOST}; a section needs far fewer")
    nodes: IntArray = np.concatenate([block.data for block in mesh.cells if block.type == kinds[0]]).astype(np.int64)
    if nodes.min() < 0 or nodes.max() >= len(mesh.points):
        raise SectionFault("a triangle of the mesh names a point that is not there")
    used, place = np.unique(nodes, return_inverse=True)
    flat, nodes = _flat(np.asarray(mesh.points, dtype=float)[used]), place.reshape(nodes.shape)
    return Triangles(flat, nodes) if PLANE[kinds[0]] == 6 else with_middles(flat, nodes)


def with_middles(points: FloatArray, corners: IntArray) -> Triangles:
    """Straight triangles (triangles, 3) with a node in the middle of every side."""
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, place = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    middles = points[edges].mean(axis=1)
    nodes = np.concatenate([corners, len(points) + place.reshape(-1, 3)], axis=1)
    return Triangles(np.concatenate([points, middles]), nodes)


def _read(file: Path) -> Any:
    """The mesh as meshio has it."""
    try:
        if not file.is_file():
            raise SectionFault("the mesh is a folder" if file.is_dir() else "the mesh file does not exist", str(file))
        if file.stat().st_size > LARGEST_FILE:
            raise SectionFault(f"the mesh file has more than {LARGEST_FILE // 1_000_000} MB")
        with file.open("rb"):
            pass
    except (OSError, ValueError) as error:
        words = getattr(error, "strerror", None) or error
        raise SectionFault(f"the mesh cannot be read: {words}", str(file)) from None
    import meshio

    sink = io.StringIO()  # meshio prints what it could not read, and ends the program
    with contextlib.redirect_stdout(sink), contextlib.redirect_stderr(sink), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        warnings.filterwarnings("error", message="string or file could not be read")  # numpy, of numbers cut short
        try:
            return meshio.read(file)
        except (Exception, SystemExit) as error:
            hint = "a triangle mesh that meshio reads, by its ending: .msh (Gmsh), .vtk, .vtu, .inp, ..."
            if isinstance(error, ImportError):
                hint = f"this sort of file needs the Python package {error.name}; .msh, .vtk and .vtu need none"
            raise SectionFault(f"'{file.name}' cannot be read as a mesh", hint) from None


def _refuse_other_cells(cells: dict[str, int]) -> None:
    """Raise SectionFault where there is anything but triangles with 3 or 6 nodes."""
    for kind, number in cells.items():
        if number and kind not in PLANE and kind not in LOWER:
            if kind.startswith(("tetra", "hexahedron", "wedge", "pyramid", "polyhedron")):
                raise SectionFault(f"the mesh is a body ({number} cells `{kind}`)", "mesh the cross-section alone")
            raise SectionFault(f"the mesh has {number} cells `{kind}`", "triangles with 3 or 6 nodes are read")


def _flat(points: FloatArray) -> FloatArray:
    """(points, 2): x and y of finite points that lie in a plane of constant z."""
    if not np.all(np.isfinite(points)):
        raise SectionFault("a coordinate of the mesh is not a finite number")
    if points.shape[1] == 3:
        x_y, z = np.ptp(points[:, :2], axis=0).max(), np.ptp(points[:, 2])
        if z > 1e-9 * x_y:  # of the extent: rounding of figures written with ten digits
            raise SectionFault("the mesh is not plane: z is not constant", "draw the section in the plane of x and y")
    return np.ascontiguousarray(points[:, :2])
