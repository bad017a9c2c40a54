"""What was done, by which method, of what size, in what time; and what was left out and why."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import metadata

from torsion.assembly.system import System


@dataclass(frozen=True, slots=True)
class PlanLine:
    """One step that was done."""

    what: str
    method: str
    size: str
    seconds: float
    why: str


@dataclass(frozen=True)
class Plan:
    """The whole of it, printed on the last page of the report."""

    done: tuple[PlanLine, ...]
    left_out: tuple[tuple[str, str], ...]  # (what, why)
    versions: dict[str, str]


@dataclass
class Step:
    """A step under way; its words may be filled in while it runs."""

    what: str
    why: str
    method: str = ""
    size: str = ""


@dataclass
class Log:
    """Collects the plan while the work goes on."""

    lines: list[PlanLine] = field(default_factory=list)
    left_out: list[tuple[str, str]] = field(default_factory=list)

    @contextmanager
    def step(self, what: str, why: str) -> Iterator[Step]:
        """Time a step; the block fills in its method and size."""
        step, start = Step(what, why), time.perf_counter()
        yield step
        self.lines.append(PlanLine(what, step.method, step.size, time.perf_counter() - start, why))

    def without(self, what: str, why: str) -> None:
        """Note what was left out."""
        self.left_out.append((what, why))


def versions(system: System, bends: bool = False) -> dict[str, str]:
    """Versions of the program, of Python and of the libraries that the numbers come from."""
    from torsion import __version__

    names = ["numpy", "scipy", "pydantic", "PyYAML"]
    if bends or (system.bars is not None and system.bars.degree):
        names.append("scikit-fem")
    python = ".".join(str(part) for part in sys.version_info[:3])
    return {"torsion": __version__, "Python": python, **{name: metadata.version(name) for name in names}}
