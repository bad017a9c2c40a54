"""Floors, doors, circles and lengths of the source."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parent.parent / "src" / "torsion"
FLOORS = {
    "errors": -1,  # the ground under every floor
    "units": 0, "kernels": 0, "kinematics": 0,
    "fields": 1, "primitives": 1,
    "components": 2,
    "train": 3,
    "study": 4, "assembly": 4,
    "analyses": 5,
    "rules": 6,
    "schema": 7, "plan": 7, "asked": 7,
    "steps": 8,
    "findings": 9,
    "report": 10, "plots": 10,
    "job": 11, "cli": 12, "__main__": 13,
}  # fmt: skip
DOORS = {
    "yaml": ("schema/source.py",),
    "pint": ("units.py",),
    "skfem": ("assembly/", "analyses/lateral/"),
    "meshio": ("assembly/section/mesh.py", "report/surface/vtu.py"),
    "matplotlib": ("plots/",),
    "jinja2": ("report/",),
    "typst": ("report/",),
    "typer": ("cli.py",),
    "dask": (),
}
FILES = sorted(path for path in SOURCE.rglob("*.py") if path != SOURCE / "__init__.py")


def _imports(path: Path) -> list[str]:
    """Modules that a file imports, but for those named to the type checker alone."""
    found: list[str] = []

    def visit(node: ast.AST) -> None:
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            return
        if isinstance(node, ast.Import):
            found.extend(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found.append(node.module or "")
            found.extend(f"{node.module}.{alias.name}" for alias in node.names)
        for child in ast.iter_child_nodes(node):
            visit(child)

    visit(ast.parse(path.read_text(encoding="utf-8")))
    return found


def _room(module: str) -> str:
    return module.split(".")[1]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(SOURCE).as_posix())
def test_a_file_imports_only_from_lower_floors_and_its_own_folder(path: Path) -> None:
    own = path.relative_to(SOURCE).parts[0].removesuffix(".py")
    for module in _imports(path):
        if module.startswith("torsion.") and _room(module) in FLOORS:
            assert _room(module) == own or FLOORS[_room(module)] < FLOORS[own], f"{own} imports {module}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(SOURCE).as_posix())
def test_a_heavy_library_enters_by_its_door_alone(path: Path) -> None:
    name = path.relative_to(SOURCE).as_posix()
    for module in _imports(path):
        doors = DOORS.get(module.split(".")[0])
        assert doors is None or name.startswith(doors), f"{name} imports {module}"


def test_no_circle_of_imports() -> None:
    names = {".".join(("torsion", *path.relative_to(SOURCE).with_suffix("").parts)): path for path in FILES}
    names = {name.removesuffix(".__init__"): path for name, path in names.items()}
    arrows = {name: {m for m in _imports(path) if m in names and m != name} for name, path in names.items()}
    while arrows:
        free = [name for name, targets in arrows.items() if not targets & arrows.keys()]
        assert free, f"a circle among {sorted(arrows)}"
        for name in free:
            del arrows[name]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(SOURCE).as_posix())
def test_a_file_has_one_subject_and_at_most_300_lines(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 300
    assert ast.get_docstring(ast.parse(text)) is not None, "a file says its subject in its first sentence"


def test_every_room_has_a_floor() -> None:
    rooms = {path.relative_to(SOURCE).parts[0].removesuffix(".py") for path in FILES}
    assert rooms <= FLOORS.keys()
