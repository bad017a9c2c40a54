"""Meshes that are no cross-section are refused where the file names them, in words that help."""

import os

import meshio
import numpy as np
import pytest
from tests.for_all import for_all
from typer.testing import CliRunner

import torsion
from torsion.assembly.section.section_mesh import MOST, SectionFault
from torsion.assembly.section.section_result import section_mesh
from torsion.cli import app
from torsion.primitives import SectionMesh

SQUARE = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (0, 0, 0)]
FOUR = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
AMID = [
    (0, -1, 0),
    (0.5, -0.5, 0),
    (-0.5, -0.5, 0),
]  # the nodes amid the sides of the first triangle


def moved(points, x):
    return [(a + x, b, c) for a, b, c in points]


BROKEN = {
    "a body": (
        [*SQUARE[:4], (0, 0, 1)],
        {"tetra": [(0, 1, 2, 4)]},
        "body tetra cross-section alone",
    ),
    "a body with its skin": (
        [*SQUARE[:4], (0, 0, 1)],
        {"triangle": [(0, 1, 2)], "tetra": [(0, 1, 2, 4)]},
        "body",
    ),
    "quadrangles": (SQUARE, {"quad": [(0, 1, 2, 3)]}, "quad triangles"),
    "lines alone": (SQUARE, {"line": [(0, 1)]}, "no triangles"),
    "both sorts": (
        SQUARE + AMID,
        {"triangle": FOUR[1:], "triangle6": [(0, 1, 4, 5, 6, 7)]},
        "mixed",
    ),
    "bulged": ([*SQUARE[:4], (0, 0, 0.1)], {"triangle": FOUR}, "plane z"),
    "not a number": ([*SQUARE[:4], (np.nan, 0, 0)], {"triangle": FOUR}, "finite"),
    "no area": ([*SQUARE, (1, 0, 0)], {"triangle": [*FOUR, (1, 2, 5)]}, "triangle 5 no area"),
    "a point thrice": (SQUARE, {"triangle": [*FOUR, (4, 4, 4)]}, "triangle 5 no area"),
    "inverted": (SQUARE, {"triangle": [*FOUR[:3], FOUR[3][::-1]]}, "triangle 4 inverted"),
    "turned inside out by a node": (
        [*SQUARE[:3], (0.1, 0.6, 0), (1, 0, 0), (0, 0, 0)],
        {"triangle6": [(0, 2, 1, 5, 4, 3)]},
        "1 inside out",
    ),
    "double point": (
        [*SQUARE, (0, 0, 0)],
        {"triangle": [*FOUR[:2], (2, 3, 5), (3, 0, 5)]},
        "coincide (0, 0) merge",
    ),
    "two pieces": (
        moved(SQUARE, -2) + moved(SQUARE, 2),
        {"triangle": FOUR + [tuple(i + 5 for i in t) for t in FOUR]},
        "2 pieces",
    ),
    "joined by a point": (
        [(-1, -1, 0), (1, -1, 0), (0, 0, 0), (1, 1, 0), (-1, 1, 0)],
        {"triangle": [(0, 1, 2), (2, 3, 4)]},
        "in a point",
    ),
    "three at a side": ([*SQUARE, (0, -0.5, 0)], {"triangle": [*FOUR, (0, 1, 5)]}, "overlap side"),
    "twice": (SQUARE, {"triangle": [*FOUR, FOUR[0]]}, "overlap side"),
    "more than a turn": (
        [(r * np.cos(k * 0.6), r * np.sin(k * 0.6), 0) for k in range(12) for r in (1, 2)],
        {"triangle": [t for k in range(0, 22, 2) for t in ((k, k + 1, k + 3), (k, k + 3, k + 2))]},
        "meets itself",
    ),
    "a flap": (
        [*SQUARE, (0.5, 0.4, 0)],
        {"triangle": [*FOUR[:3], (3, 0, 5)]},
        "meet only in a point",
    ),
    "hanging node": (
        [(-1, -1, 0), (1, -1, 0), (0, 1, 0), (0, -1, 0), (-1, -3, 0), (1, -3, 0)],
        {"triangle": [(0, 1, 2), (4, 3, 0), (4, 5, 3), (5, 1, 3)]},
        "meets itself hanging",
    ),
    "off the axis": (moved(SQUARE, 3), {"triangle": FOUR}, "centroid (3, axis origin"),
    "a kilometre": (
        [(1e4 * x, 1e4 * y, 0) for x, y, _ in SQUARE],
        {"triangle": FOUR},
        "2e+04 m wide `unit`",
    ),
    "too many": (SQUARE, {"triangle": [FOUR[0]] * (MOST + 1)}, f"{MOST + 1} triangles at most"),
}
UNREADABLE = {
    "a.msh": b"hello",
    "b.msh": b"",
    "c.vtk": b"\x00\xff" * 50,
    "d.vtk": b"# vtk DataFile Version 3.0\n",
    "e.stp": b"x",
    "f.msh": b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n",
    "g.vtu": b"<x",
    "h": b"x",
    "i.xdmf": b"x",
    "j.med": b"x",
    "k.msh": b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n1 x y z\n$EndNodes\n",
}
SHAFT = (
    "shaft: {length: 1, section: {mesh: NAME}, unusual: true}"  # the meshes here are metres wide
)
SCENE = f"name: a\ntrain:\n- disc: {{inertia: 1}}\n- {SHAFT}\n- disc: {{inertia: 1}}\n"


@for_all("case", BROKEN)
def test_broken_mesh_is_refused_where_the_file_names_it(tmp_path, case) -> None:
    points, cells, words = BROKEN[case]
    meshio.write(tmp_path / "bad.vtu", meshio.Mesh(np.array(points, dtype=float), cells))
    (tmp_path / "scene.yaml").write_text(SCENE.replace("NAME", "bad.vtu"))
    with pytest.raises(torsion.InputError) as caught:
        torsion.read(tmp_path / "scene.yaml")
    (fault,) = caught.value.faults
    assert (fault.line, fault.column) == (4, 38)
    assert [word for word in words.split() if word not in f"{fault.message} ({fault.hint})"] == []


def test_a_mesh_whose_unit_is_forgotten_is_refused_and_a_meant_one_is_read(tmp_path) -> None:
    meshio.write(tmp_path / "square.vtu", meshio.Mesh(30.0 * np.array(SQUARE), {"triangle": FOUR}))
    meant = SCENE.replace("NAME", "square.vtu")
    for text in (meant, meant.replace(", unusual: true", "").replace("vtu}", "vtu, unit: mm}")):
        (tmp_path / "scene.yaml").write_text(text)
        assert torsion.read(tmp_path / "scene.yaml").train.bars
    (tmp_path / "scene.yaml").write_text(meant.replace(", unusual: true", ""))
    with pytest.raises(
        torsion.InputError, match=r"scene.yaml:4:38: the section is 60 m wide .*`unusual: true`"
    ):
        torsion.read(tmp_path / "scene.yaml")


@for_all("name", UNREADABLE)
def test_unreadable_mesh_is_refused_without_a_traceback_or_a_word_of_its_reader(
    tmp_path, capfd, name
) -> None:
    (tmp_path / name).write_bytes(UNREADABLE[name])
    with pytest.raises(SectionFault, match=f"'{name}' cannot be read as a mesh"):
        section_mesh(SectionMesh(str(tmp_path / name)))
    assert capfd.readouterr() == ("", "")


@for_all("name", ["absent.msh", "", ".", "\0.msh", "x" * 5000, "/dev/null"])
def test_what_is_no_file_is_refused(tmp_path, name) -> None:
    with pytest.raises(SectionFault):
        section_mesh(SectionMesh(os.path.join(tmp_path, name)))


def test_a_file_that_is_too_large_is_not_even_opened(tmp_path) -> None:
    with (tmp_path / "large.msh").open("wb") as file:
        file.truncate(30_000_000)
    with pytest.raises(SectionFault, match="at most 20 MB"):
        section_mesh(SectionMesh(str(tmp_path / "large.msh")))


def test_command_ends_with_status_2_and_the_place(tmp_path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE.replace("NAME", "absent.msh"))
    done = CliRunner().invoke(
        app, ["solve", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "out")]
    )
    assert done.exit_code == 2
    assert "scene.yaml:4:38: the mesh file does not exist" in done.output
    assert not (tmp_path / "out").exists()


@for_all(
    ("keys", "words"),
    [
        ("length: 1", "`diameter` is missing"),
        ("length: 1, bore: 0.1", "`diameter` is missing"),
        ("length: 1, diameter: 0.1, section: {mesh: a.msh}", "a `section` has no `diameter`"),
        ("length: 1, bore: 0.1, section: {mesh: a.msh}", "a `section` has no `bore`"),
        ("length: 1, section: {mesh: a.msh, unit: foot}", "none of"),
        ("length: 1, section: {unit: mm}", "`mesh` is missing"),
        ("length: 1, section: a.msh", "not a mapping"),
        ("length: 1, section: {mesh: ''}", ""),
    ],
)
def test_shaft_has_diameters_or_a_section(keys, words) -> None:
    text = f"name: a\ntrain:\n- disc: {{inertia: 1}}\n- shaft: {{{keys}}}\n"
    with pytest.raises(torsion.InputError) as caught:
        torsion.parse(text)
    (fault,) = caught.value.faults
    assert words in fault.message
    assert fault.line == 4


def test_missing_diameter_is_told_beside_other_faults() -> None:
    with pytest.raises(torsion.InputError) as caught:
        torsion.parse("name: a\ntrain:\n- shaft: {length: 1 kg, colour: red}\n")
    assert len(caught.value.faults) == 3
