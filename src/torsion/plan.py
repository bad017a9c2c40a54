"""What was done, by which method, of what size, in what time; and what was left out and why."""

import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import metadata

from torsion.results import derived, reported, result


@reported
class PlanLine:
    """One step that was done."""

    what: str = result("", (), "a step that was done")
    method: str = result("", (), "by which method")
    size: str = result("", (), "of what size")
    seconds: float = result("", (), "time")
    why: str = result("", (), "reason")


@reported
class LeftOut:
    """What was not done."""

    what: str = result("", (), "what was left out")
    why: str = result("", (), "reason")


@reported
class Unanswered:
    """An analysis that was tried and has no answer."""

    analysis: str = result("", (), "an analysis that was tried and has no answer; each stands in `left_out` too")
    what: str = result("", (), "the same in words")
    why: str = result("", (), "cause")
    remedy: str = result("", (), "what to change; empty where the cause says it")
    line: int | None = result("", (), "line of the file, from 1; null where there is none")
    is_named: bool = result("", (), "the file names the analysis; the exit status is then 3", key="named")
    is_input: bool = result("", (), "the input is at fault; the exit status is then 2", key="input_fault")
    text: str  # all of it, with the line quoted

    @property
    def words(self) -> str:
        """Cause, line and remedy in one sentence."""
        where = "" if self.line is None else f" (line {self.line} of the file)"
        return f"{self.why}{where}" + (f"; remedy: {self.remedy}" if self.remedy else "")


@reported
class Plan:
    """The whole of it, printed on the last page of the report."""

    done: tuple[PlanLine, ...] = result("", (), "steps in their order")
    left_out: tuple[tuple[str, str], ...]  # (what, why)
    versions: dict[str, str] = result("", (), "versions of the libraries")

    unanswered: tuple[Unanswered, ...] = result("", (), "analyses without an answer", default=())

    @derived("", (), "what was left out, and why", key="left_out")
    def reasons(self) -> tuple[LeftOut, ...]:
        """Every pair as a result."""
        return tuple(LeftOut(what, why) for what, why in self.left_out)


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
    unanswered: list[Unanswered] = field(default_factory=list)
    libraries: dict[str, None] = field(default_factory=lambda: dict.fromkeys(("numpy", "scipy", "pydantic", "PyYAML")))

    @contextmanager
    def step(self, what: str, why: str) -> Iterator[Step]:
        """Time a step; the block fills in its method and size."""
        step, start = Step(what, why), time.perf_counter()
        yield step
        self.lines.append(PlanLine(what, step.method, step.size, time.perf_counter() - start, why))

    def without(self, what: str, why: str) -> None:
        """Note what was left out."""
        self.left_out.append((what, why))

    def unanswer(self, found: Unanswered) -> None:
        """Note an analysis that was tried and has no answer."""
        self.unanswered.append(found)
        self.without(found.what, found.words)

    def plan(self) -> Plan:
        """All that was collected, with the versions of what the numbers come from."""
        return Plan(tuple(self.lines), tuple(self.left_out), versions(self.libraries), tuple(self.unanswered))


def versions(libraries: Iterable[str]) -> dict[str, str]:
    """Versions of the program, of Python and of the libraries."""
    python = ".".join(str(part) for part in sys.version_info[:3])
    return {
        "torsion": metadata.version("torsion"),
        "Python": python,
        **{name: metadata.version(name) for name in libraries},
    }
