"""Mutants of the program that its tests should kill: `python -m benchmarks.mutants --number 60 --seed 1`.

Each mutant is one change at one place of a copy of `src`: a sign, a factor, a comparison, an index, a pair of opposite
names. The tests of that part run against the copy; a mutant that they all pass has survived and is listed. Places are
drawn by seed, evenly over the parts, so that a run can be repeated; `--list` shows them without running anything.
Pictures (`DRAWN`) are left as they are: their look is looked at.
Some mutants mean the same as the program (a maximum over one span): whoever reads the list judges that.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SECONDS = 300.0  # after which a mutant counts as killed: it does not end
FROZEN = "tests/contracts/test_frozen_digits.py"
NUMBERS = "tests/output/test_numbers_of_two_discs.py"
PARTS: dict[str, tuple[str, ...]] = {  # part of src/torsion: the tests that should kill its mutants
    "rules": ("tests/rules", NUMBERS, FROZEN),
    "analyses/response/synthesis.py": ("tests/analyses/response", NUMBERS, FROZEN),
    "output": (FROZEN, "tests/output"),
    "output/stored/scene.py": (FROZEN, "tests/output"),
    "output/stored/results_json.py": (FROZEN, "tests/output"),
    "output/pages/terminal.py": (FROZEN, "tests/output"),
    "output/chapters": (FROZEN, "tests/output"),
}
DRAWN = ("output/drawing", "output/figures")  # pictures
OPERATORS: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
}
COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Lt: ">=",
    ast.LtE: "<",
    ast.Gt: "<=",
    ast.GtE: ">",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.In: "not in",
    ast.NotIn: "in",
    ast.Is: "is not",
    ast.IsNot: "is",
}
PAIRS = (
    ("max", "min"),
    ("nanmax", "nanmin"),
    ("maximum", "minimum"),
    ("argmax", "argmin"),
    ("nanargmax", "nanargmin"),
    ("fmax", "fmin"),
    ("any", "all"),
    ("floor", "ceil"),
    ("lower", "upper"),
    ("first", "last"),
    ("driving", "driven"),
    ("real", "imag"),
    ("greatest", "least"),
    ("half_range", "bound"),
    ("peak", "rms"),
    ("station", "span"),
    ("stations", "spans"),
    ("kinetic", "elastic"),
    ("sin", "cos"),
    ("speed", "frequency"),
    ("before", "after"),
)
OPPOSITE = {name: other for pair in PAIRS for name, other in (pair, pair[::-1])}


@dataclass(frozen=True)
class Mutant:
    """One change: the text between two places of a file is replaced."""

    part: str
    path: Path  # within src/torsion
    line: int
    begin: int  # bytes from the start of the file
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        return f"src/torsion/{self.path}:{self.line}: {self.old} -> {self.new}"

    def applied(self, text: bytes) -> bytes:
        """The file with the change."""
        return text[: self.begin] + self.new.encode() + text[self.end :]


def mutants(part: str) -> list[Mutant]:
    """Every mutant of a part, by file and place."""
    source = ROOT / "src" / "torsion"
    files = [source / part] if part.endswith(".py") else sorted((source / part).rglob("*.py"))
    files = [file for file in files if not file.relative_to(source).as_posix().startswith(DRAWN)]
    return [
        mutant
        for file in files
        for mutant in _of_file(part, file.relative_to(source), file.read_bytes())
    ]


def _of_file(part: str, path: Path, text: bytes) -> Iterator[Mutant]:
    starts = [0]
    for row in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(row))
    tree = ast.parse(text)
    skipped = {
        id(inner)
        for node in ast.walk(tree)
        for outer in _not_run(node)
        for inner in ast.walk(outer)
    }
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        for where, new in _changes(node, text.decode()):
            begin = starts[where[0] - 1] + where[1]
            end = starts[where[2] - 1] + where[3]
            yield Mutant(part, path, where[0], begin, end, text[begin:end].decode(), new)


def _not_run(node: ast.AST) -> Iterator[ast.AST]:
    """Annotations, type aliases and what is imported for types alone."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        yield from (
            one
            for one in (
                node.returns,
                *(arg.annotation for arg in ast.walk(node.args) if isinstance(arg, ast.arg)),
            )
            if one is not None
        )
    elif isinstance(node, ast.AnnAssign):
        yield node.annotation
    elif (
        isinstance(node, ast.If)
        and isinstance(node.test, ast.Name)
        and node.test.id == "TYPE_CHECKING"
    ):
        yield node


Place = tuple[int, int, int, int]  # line and column of begin and end


def _changes(node: ast.AST, text: str) -> Iterator[tuple[Place, str]]:
    """Places and what stands there instead."""
    match node:
        case ast.BinOp(left, op, right) if type(op) in OPERATORS:
            a, b = (ast.get_source_segment(text, side) or "" for side in (left, right))
            yield _place(node), f"({a}) {OPERATORS[type(op)][1]} ({b})"
            if isinstance(op, ast.Mult):
                yield _place(node), f"({a})"
        case ast.UnaryOp(ast.USub() | ast.Not(), operand):
            yield _place(node), f"({ast.get_source_segment(text, operand)})"
        case ast.Compare(left, [op], [right]):
            a, b = (ast.get_source_segment(text, side) or "" for side in (left, right))
            yield _place(node), f"({a}) {COMPARISONS[type(op)]} ({b})"
        case ast.BoolOp(op, values):
            word = " or " if isinstance(op, ast.And) else " and "
            yield (
                _place(node),
                "("
                + word.join(f"({ast.get_source_segment(text, value)})" for value in values)
                + ")",
            )
        case ast.Attribute(_, name) if name in OPPOSITE:
            place = _place(node)
            yield (place[2], place[3] - len(name), place[2], place[3]), OPPOSITE[name]
        case ast.Call(ast.Name(name)) if name in OPPOSITE:
            yield _place(node.func), OPPOSITE[name]
        case ast.Constant(bool(value)):
            yield _place(node), str(not value)
        case ast.Constant(int(value) | float(value)):
            yield _place(node), repr(value + 1)


def _place(node: ast.AST) -> Place:
    return node.lineno, node.col_offset, node.end_lineno, node.end_col_offset  # type: ignore[attr-defined]


def drawn(number: int, seed: int, only: str) -> list[Mutant]:
    """`number` mutants, as many of every part as of every other; of files whose path has `only` in it."""
    dice = random.Random(seed)
    pools = [[one for one in mutants(part) if only in str(one.path)] for part in PARTS]
    for pool in pools:
        dice.shuffle(pool)
    found: list[Mutant] = []
    while len(found) < number and any(pools):
        found += [pool.pop() for pool in pools if pool]
    return found[:number]


def passes(part: str, mutant: Mutant | None = None) -> bool:
    """The tests of a part pass, with the mutant or without any."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "src"
        shutil.copytree(ROOT / "src", source, ignore=shutil.ignore_patterns("__pycache__"))
        if mutant is not None:
            file = source / "torsion" / mutant.path
            file.write_bytes(mutant.applied(file.read_bytes()))
        there = {**os.environ, "PYTHONPATH": str(source), "PYTHONDONTWRITEBYTECODE": "1"}
        command = [
            sys.executable,
            "-m",
            "pytest",
            "-x",
            "-q",
            "-p",
            "no:cacheprovider",
            "-n",
            "0",
            *PARTS[part],
        ]
        try:
            done = subprocess.run(
                command, cwd=ROOT, env=there, capture_output=True, timeout=SECONDS, check=False
            )
        except subprocess.TimeoutExpired:
            return False
    return done.returncode == 0


def main() -> None:
    """Draw mutants, run their tests, print those that survive."""
    command = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    command.add_argument("--number", type=int, default=60)
    command.add_argument("--seed", type=int, default=1)
    command.add_argument("--only", default="", help="part of a path: mutants of these files alone")
    command.add_argument("--workers", type=int, default=2)
    command.add_argument("--list", action="store_true", help="print the mutants and run nothing")
    requested = command.parse_args()
    found = drawn(requested.number, requested.seed, requested.only)
    if requested.list:
        print(*found, sep="\n")
        return
    survived = 0
    with ThreadPoolExecutor(requested.workers) as pool:
        parts = sorted({mutant.part for mutant in found})
        failing = [
            part for part, sound in zip(parts, pool.map(passes, parts), strict=True) if not sound
        ]
        if failing:
            sys.exit(f"the tests of {', '.join(failing)} fail without any mutant")
        for mutant, lives in zip(
            found, pool.map(lambda one: passes(one.part, one), found), strict=True
        ):
            survived += lives
            print(f"{'SURVIVED' if lives else 'killed  '} {mutant}", flush=True)
    print(f"{survived} of {len(found)} survived")


if __name__ == "__main__":
    main()
