"""The triangles of a cross-section: read from a mesh file (the one place that does), divided, and their boundary."""

import contextlib
import io
import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.trees.tree import connected
from torsion.user_files import check_file

LARGEST_FILE = 20_000_000  # bytes; a mesh of MOST triangles has a tenth of it
MOST = 10_000  # triangles; they are divided into four at least once
PLANE = {"triangle": 3, "triangle6": 6}
BODIES = ("tetra", "hexahedron", "wedge", "pyramid", "polyhedron")
LOWER = ("vertex", "line", "line3")  # points and sides, by which a mesher marks boundaries

# Of the four triangles in one: their corners among its nodes, and its functions at the middles of their sides.
_QUARTERS = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]])
_AT = np.vstack([np.eye(3), (np.eye(3) + np.roll(np.eye(3), 1, axis=1)) / 2.0])[_QUARTERS]
_MIDDLES = (_AT + np.roll(_AT, -1, axis=1)) / 2.0  # (4, 3, 3) barycentric
_SHAPES = np.concatenate(
    [_MIDDLES * (2.0 * _MIDDLES - 1.0), 4.0 * _MIDDLES * np.roll(_MIDDLES, -1, axis=2)], axis=2
)
_GAUSS = np.polynomial.legendre.leggauss(2)  # exact for the area under a parabola


class SectionFault(Exception):
    """What is wrong with a mesh as a cross-section, what would be right, and at which point it is."""

    def __init__(self, message: str, hint: str = "", point: FloatArray | None = None) -> None:
        self.message = (
            message if point is None else f"{message} at ({point[0]:.6g}, {point[1]:.6g})"
        )
        self.hint = hint
        super().__init__(self.message)


@dataclass(frozen=True)
class Triangles:
    """Quadratic triangles, straight or curved: three corners, then the nodes amid the sides 01, 12 and 20."""

    points: FloatArray  # (points, 2)
    nodes: IntArray  # (triangles, 6)

    @cached_property
    def sides(self) -> IntArray:
        """(3 triangles, 3) first corner, last corner, node amid, around every triangle."""
        corners, middles = self.nodes[:, :3], self.nodes[:, 3:]
        return np.stack([corners, np.roll(corners, -1, axis=1), middles], axis=2).reshape(-1, 3)


@dataclass(frozen=True)
class Boundary:
    """Sides that one triangle alone has, the section on their left; the loop 0 is the outer one."""

    sides: IntArray  # (sides, 3) first corner, last corner, node amid
    loop: IntArray  # (sides,)
    area: FloatArray  # (loops,) within each loop, negative around holes


def read_triangles(file: str | Path) -> Triangles:
    """The triangles of a mesh file in its own unit; raises SectionFault.

    Cells of lower dimension are marks and points that no triangle has are construction points: both say nothing here.
    """
    mesh = _read(Path(file))
    cells = {block.type: 0 for block in mesh.cells}
    for block in mesh.cells:
        cells[block.type] += len(block.data)
    for kind, number in cells.items():
        if number and kind not in (*PLANE, *LOWER):
            if kind.startswith(BODIES):
                hint = "mesh the cross-section alone"
                raise SectionFault(f"the mesh is a body ({number} cells `{kind}`)", hint)
            hint = "triangles with 3 or 6 nodes are read"
            raise SectionFault(f"the mesh has {number} cells `{kind}`", hint)
    kinds = [kind for kind in PLANE if cells.get(kind)]
    if len(kinds) != 1:
        raise SectionFault(
            "the mesh has no triangles"
            if not kinds
            else "straight and quadratic triangles are mixed"
        )
    if cells[kinds[0]] > MOST:
        raise SectionFault(
            f"the mesh has {cells[kinds[0]]} triangles",
            f"at most {MOST}; a section needs far fewer",
        )
    nodes: IntArray = np.concatenate(
        [block.data for block in mesh.cells if block.type == kinds[0]]
    ).astype(np.int64)
    if nodes.min() < 0 or nodes.max() >= len(mesh.points):
        raise SectionFault("a triangle of the mesh names a point that is not there")
    used, position = np.unique(nodes, return_inverse=True)
    points, nodes = np.asarray(mesh.points, dtype=float)[used], position.reshape(nodes.shape)
    if not np.all(np.isfinite(points)):
        raise SectionFault("a coordinate of the mesh is not a finite number")
    flat = np.ascontiguousarray(points[:, :2])
    # Relative to the extent: rounding of figures written with ten digits.
    if points.shape[1] == 3 and np.ptp(points[:, 2]) > 1e-9 * np.ptp(flat, axis=0).max():
        hint = "draw the section in the plane of x and y"
        raise SectionFault("the mesh is not plane: z is not constant", hint)
    return Triangles(flat, nodes) if PLANE[kinds[0]] == 6 else with_middles(flat, nodes)


def with_middles(points: FloatArray, corners: IntArray) -> Triangles:
    """Straight triangles (triangles, 3) with a node in the middle of every side."""
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, _, edge = edges_of(sides)
    middles = points[edges].mean(axis=1)
    nodes = np.concatenate([corners, len(points) + edge.reshape(-1, 3)], axis=1)
    return Triangles(np.concatenate([points, middles]), nodes)


def _read(file: Path) -> Any:
    """The mesh as meshio has it."""
    try:
        check_file(file, LARGEST_FILE)
        with file.open("rb"):
            pass
    except FileNotFoundError:
        raise SectionFault("the mesh file does not exist", str(file)) from None
    except (OSError, ValueError) as error:
        words = getattr(error, "strerror", None) or error
        raise SectionFault(f"the mesh cannot be read: {words}", str(file)) from None
    import meshio

    sink = io.StringIO()  # meshio prints what it could not read, and ends the program
    with (
        contextlib.redirect_stdout(sink),
        contextlib.redirect_stderr(sink),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore")
        warnings.filterwarnings(
            "error", message="string or file could not be read"
        )  # numpy, of numbers cut short
        try:
            return meshio.read(file)
        except (Exception, SystemExit) as error:
            hint = "a triangle mesh that meshio reads, by its ending: .msh (Gmsh), .vtk, .vtu, .inp, ..."
            if isinstance(error, ImportError):
                hint = f"this sort of file needs the Python package {error.name}; .msh, .vtk and .vtu need none"
            raise SectionFault(f"'{file.name}' cannot be read as a mesh", hint) from None


def edges_of(sides: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Every edge (edges, 2) once, by its ends in ascending order; the first side of each; the edge of every side."""
    edges, first, edge = np.unique(
        np.sort(sides[:, :2], axis=1), axis=0, return_index=True, return_inverse=True
    )
    return edges, first, edge.ravel()


def boundary(mesh: Triangles) -> Boundary:
    """The boundary of a sound mesh, the loop of the largest area first."""
    edge = edges_of(mesh.sides)[2]
    sides = mesh.sides[np.bincount(edge)[edge] == 1]
    joined = connected(len(mesh.points), sides[:, 0], sides[:, 1])[sides[:, 0]]
    loop = np.unique(joined, return_inverse=True)[1]

    # The integral of (x dy - y dx)/2 along each parabola.
    first, last, amid = (mesh.points[sides[:, k]] for k in range(3))
    slope, bend, under = (last - first) / 2.0, (first + last) / 2.0 - amid, np.zeros(len(sides))
    for t, weight in zip(*_GAUSS, strict=True):
        (x, y), (dx, dy) = (amid + slope * t + bend * t**2).T, (slope + 2.0 * bend * t).T
        under += weight * (x * dy - y * dx) / 2.0
    area = np.asarray(np.bincount(loop, weights=under), dtype=float)
    order = np.argsort(-area, kind="stable")
    return Boundary(sides, np.argsort(order, kind="stable")[loop], area[order])


def refined(mesh: Triangles) -> Triangles:
    """Every triangle divided into four, of the same, straight or curved, outline."""
    finer = with_middles(mesh.points, mesh.nodes[:, _QUARTERS].reshape(-1, 3))
    middles = np.einsum("qmn,tnd->tqmd", _SHAPES, mesh.points[mesh.nodes])
    finer.points[finer.nodes[:, 3:]] = middles.reshape(-1, 3, 2)
    return finer
