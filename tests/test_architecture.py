"""Floors, doors, circles and lengths of the source."""

import ast
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).parent.parent / "src" / "torsion"
FLOORS = {
    "errors": -2,
    "arrays": -1,
    "columns": -1,
    "user_files": -1,
    "sources": -1,  # the ground under every floor
    "units": 0,
    "processes": 0,
    "kernels": 0,
    "results": 1,
    "fields": 1,
    "primitives": 1,
    "tables": 1,
    "model": 2,
    "train": 3,
    "study": 4,
    "assembly": 4,
    "findings": 5,
    "analyses": 6,
    "what_if": 6.5,
    "rules": 7,
    "schema": 8,
    "formulas": 8,
    "output": 9,
    "runner": 10,
    "commands": 11,
    "live": 12,
    "sweeping": 12,
    "exchange": 12,
    "command_endings": 11.5,
    "exchange_commands": 12.6,
    "cli": 13,
    "__main__": 14,
}
DOORS = {
    "yaml": ("schema/yaml_source.py",),
    "pint": ("units.py",),
    "skfem": ("assembly/", "analyses/lateral/"),
    "meshio": ("assembly/section/section_mesh.py", "output/files/mode_lines.py"),
    "matplotlib": ("output/figures/matplotlib_axes.py",),
    "pandas": ("output/files/data_frames.py",),
    "jinja2": ("output/",),
    "typst": ("output/",),
    "typer": ("cli.py", "command_endings.py", "exchange_commands.py"),
    "dask": ("sweeping/cluster.py",),
    "distributed": ("sweeping/cluster.py",),
    "pyarrow": ("sweeping/sweep_folder.py",),
}
FILES = sorted(path for path in SOURCE.rglob("*.py") if path != SOURCE / "__init__.py")


@cache
def _read(path: Path) -> tuple[list[str], list[str], bool]:
    """Modules that a file imports anywhere in it, those named to the type checker alone, whether it says its subject.

    Of all trees at once, a million nodes, every search for garbage would take longer than the last.
    """
    tree = ast.parse(path.read_text(encoding="utf-8"))
    run, typed = list[str](), list[str]()

    def visit(node: ast.AST, found: list[str]) -> None:
        if isinstance(node, ast.If):
            names = {part.id for part in ast.walk(node.test) if isinstance(part, ast.Name)}
            if "TYPE_CHECKING" in names:
                found = typed
        if isinstance(node, ast.Import):
            found.extend(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found.append(node.module or "")
            found.extend(f"{node.module}.{alias.name}" for alias in node.names)
        for child in ast.iter_child_nodes(node):
            if not isinstance(child, ast.expr):  # an expression holds no statement
                visit(child, found)

    visit(tree, run)
    return run, typed, ast.get_docstring(tree) is not None


def _imports(path: Path, *, typed: bool = False) -> list[str]:
    """Modules that a file imports anywhere in it; with `typed` also those named to the type checker alone."""
    run, only_typed, _ = _read(path)
    return run + only_typed if typed else run


def _room(module: str) -> str:
    return module.split(".")[1]


def _name(path: Path) -> str:
    return path.relative_to(SOURCE).as_posix()


def test_a_file_imports_only_from_lower_floors_and_its_own_folder() -> None:
    offenders = []
    for path in FILES:
        room = path.relative_to(SOURCE).parts[0].removesuffix(".py")
        inside = [
            module
            for module in _imports(path)
            if module.startswith("torsion.") and _room(module) in FLOORS
        ]
        offenders += [
            f"{_name(path)} imports {module}"
            for module in inside
            if _room(module) != room and FLOORS[_room(module)] >= FLOORS[room]
        ]
    assert not offenders


def test_a_heavy_library_enters_by_its_door_alone() -> None:
    offenders = [
        f"{_name(path)} imports {module}"
        for path in FILES
        for module in _imports(path)
        if module.split(".")[0] in DOORS and not _name(path).startswith(DOORS[module.split(".")[0]])
    ]
    assert not offenders


def test_no_cycle_of_imports() -> None:
    """Every import counts: those inside functions and those named to the type checker alone too."""
    names = {
        ".".join(("torsion", *path.relative_to(SOURCE).with_suffix("").parts)): path
        for path in FILES
    }
    names = {name.removesuffix(".__init__"): path for name, path in names.items()}
    arrows = {
        name: {m for m in _imports(path, typed=True) if m in names} for name, path in names.items()
    }

    def reached(name: str) -> set[str]:
        seen, left = set[str](), [name]
        while left:
            new = arrows[left.pop()] - seen
            seen |= new
            left += new
        return seen

    cycles = {name.removeprefix("torsion.") for name in names if name in reached(name)}
    assert not cycles, f"a cycle among {sorted(cycles)}"


def test_a_file_has_one_subject_and_at_most_540_lines() -> None:
    texts = {_name(path): path.read_text(encoding="utf-8") for path in FILES}
    assert not [name for name, text in texts.items() if len(text.splitlines()) > 540]
    assert not [_name(path) for path in FILES if not _read(path)[2]]


def test_every_room_has_a_floor() -> None:
    rooms = {path.relative_to(SOURCE).parts[0].removesuffix(".py") for path in FILES}
    assert rooms <= FLOORS.keys()
