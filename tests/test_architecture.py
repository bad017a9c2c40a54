"""Floors, doors, circles and lengths of the source."""

import ast
from pathlib import Path

import pytest

SOURCE = Path(__file__).parent.parent / "src" / "torsion"
FLOORS = {
    "errors": -1, "arrays": -1, "user_files": -1,  # the ground under every floor
    "units": 0, "kernels": 0, "kinematics": 0,
    "usual_ranges": 0.5,
    "results": 1, "fields": 1, "primitives": 1, "two_columns": 1,
    "components": 2,
    "train": 3,
    "study": 4, "assembly": 4,
    "findings": 5,
    "analyses": 6,
    "rules": 7,
    "schema": 8,
    "output": 9,
    "runner": 10, "commands": 11, "live": 12, "sweeping": 12, "lasting_output": 12, "cli": 13, "__main__": 14,
}  # fmt: skip
DOORS = {
    "yaml": ("schema/yaml_source.py",),
    "pint": ("units.py",),
    "skfem": ("assembly/", "analyses/lateral/"),
    "meshio": ("assembly/section/section_mesh.py", "output/surface/vtu.py"),
    "matplotlib": (),
    "jinja2": ("output/",),
    "typst": ("output/",),
    "typer": ("cli.py",),
    "dask": ("sweeping/cluster.py",),
    "distributed": ("sweeping/cluster.py",),
    "pyarrow": ("sweeping/parts.py",),
}
FILES = sorted(path for path in SOURCE.rglob("*.py") if path != SOURCE / "__init__.py")


def _imports(path: Path, *, typed: bool = False) -> list[str]:
    """Modules that a file imports anywhere in it; with `typed` also those named to the type checker alone."""
    found: list[str] = []

    def visit(node: ast.AST) -> None:
        if not typed and isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
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


def test_no_cycle_of_imports() -> None:
    """Every import counts: those inside functions and those named to the type checker alone too."""
    names = {".".join(("torsion", *path.relative_to(SOURCE).with_suffix("").parts)): path for path in FILES}
    names = {name.removesuffix(".__init__"): path for name, path in names.items()}
    arrows = {name: {m for m in _imports(path, typed=True) if m in names} for name, path in names.items()}

    def reached(name: str) -> set[str]:
        seen, left = set[str](), [name]
        while left:
            new = arrows[left.pop()] - seen
            seen |= new
            left += new
        return seen

    cycles = {name.removeprefix("torsion.") for name in names if name in reached(name)}
    assert not cycles, f"a cycle among {sorted(cycles)}"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(SOURCE).as_posix())
def test_a_file_has_one_subject_and_at_most_400_lines(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 400
    assert ast.get_docstring(ast.parse(text)) is not None, "a file says its subject in its first sentence"


def test_every_room_has_a_floor() -> None:
    rooms = {path.relative_to(SOURCE).parts[0].removesuffix(".py") for path in FILES}
    assert rooms <= FLOORS.keys()
