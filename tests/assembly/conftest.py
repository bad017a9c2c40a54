"""Triangle meshes of cross-sections, made by the tests themselves and written through meshio."""

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest

from torsion.assembly.section.section_result import SectionResult, section_result
from torsion.primitives import SectionMesh

Drawn = tuple[np.ndarray, np.ndarray]  # points (points, 2), triangles (triangles, 3 or 6)


def mapped(at: Callable[[np.ndarray, np.ndarray], np.ndarray], across: int, along: int) -> Drawn:
    """Quadratic triangles on the image of the unit square, `at(u, v)` (2, ...); ends of u may shrink to a point."""
    u, v = np.meshgrid(
        np.linspace(0, 1, 2 * across + 1), np.linspace(0, 1, 2 * along + 1), indexing="ij"
    )
    drawn = np.moveaxis(at(u, v), 0, -1).reshape(-1, 2)
    same = np.unique(np.round(drawn, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    points, name = drawn[same[1]], same[2].reshape(u.shape)
    nodes = []
    for i in range(0, 2 * across, 2):
        for j in range(0, 2 * along, 2):
            (a, da, d), (ab, amid, cd), (b, bc, c) = name[i : i + 3, j : j + 3]
            if a == d:
                nodes.append((a, b, c, ab, bc, cd))
            elif b == c:
                nodes.append((a, c, d, ab, cd, da))
            else:
                nodes += [(a, b, c, ab, bc, amid), (a, c, d, amid, cd, da)]
    used, place = np.unique(nodes, return_inverse=True)
    return points[used], place.reshape(-1, 6)


def around(
    outline: Callable[[np.ndarray], np.ndarray], across: int, along: int, hole: float = 0.0
) -> Drawn:
    """A section within `outline(angle)` (2, ...), and a hole of the same shape and so many times its size."""
    return mapped(lambda u, v: (hole + (1.0 - hole) * u) * outline(2.0 * np.pi * v), across, along)


def blocks(filled: list[str], cells: int) -> Drawn:
    """Straight triangles on unit squares, a row of '#' and '.' a line, `cells` to each side; centred on the grid."""
    rows, columns = len(filled), len(filled[0])
    number = {}
    triangles = []

    def name(i: int, j: int) -> int:
        return number.setdefault((i, j), len(number))

    for j in range(rows * cells):
        for i in range(columns * cells):
            if filled[j // cells][i // cells] == "#":
                a, b, c, d = name(i, j), name(i + 1, j), name(i + 1, j + 1), name(i, j + 1)
                triangles += [(a, b, c), (a, c, d)]
    points = np.array(list(number)) / cells - np.array([columns, rows]) / 2.0
    return points, np.array(triangles)


def write(drawn: Drawn, file: Path, **how: str) -> str:
    """The mesh as a file of the sort that its ending says; its name."""
    points, nodes = drawn
    kind = "triangle" if nodes.shape[1] == 3 else "triangle6"
    meshio.write(
        file, meshio.Mesh(np.column_stack([points, np.zeros(len(points))]), [(kind, nodes)]), **how
    )
    return str(file)


@pytest.fixture
def solved(tmp_path) -> Callable[..., SectionResult]:
    """The cross-section of a drawn mesh, through a file of it."""

    def solve(drawn: Drawn, scale: float = 1.0) -> SectionResult:
        return section_result(SectionMesh(write(drawn, tmp_path / "section.vtu"), scale))

    return solve


@pytest.fixture
def draw() -> Callable[..., Drawn]:
    """Outlines by name: around, mapped, blocks."""
    return {"around": around, "mapped": mapped, "blocks": blocks, "write": write}.__getitem__
