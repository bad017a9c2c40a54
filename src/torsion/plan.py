"""What was done, by which method, of what size, in what time; and what was left out and why."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import metadata
from typing import ParamSpec, TypeVar

from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.study import Study

P = ParamSpec("P")
Result = TypeVar("Result")

DEFAULT = ("modes", "response")  # analyses of a file that names none
ALWAYS = ("steady",)  # named by `operation`


@dataclass(frozen=True, slots=True)
class PlanLine:
    """One step that was done."""

    what: str
    method: str
    size: str
    seconds: float
    why: str


@dataclass(frozen=True)
class Unanswered:
    """An analysis that was tried and has no answer."""

    analysis: str  # its key in `analyses`, with the key of a setting behind a dot
    what: str  # in words
    why: str
    remedy: str
    line: int | None  # of the file, from 1
    text: str  # all of it, with the line quoted
    is_named: bool  # the file names it, or the default does where the file names none
    is_input: bool  # the input is at fault

    @property
    def words(self) -> str:
        """Cause, line and remedy in one sentence."""
        where = "" if self.line is None else f" (line {self.line} of the file)"
        return f"{self.why}{where}" + (f"; remedy: {self.remedy}" if self.remedy else "")


@dataclass(frozen=True)
class Plan:
    """The whole of it, printed on the last page of the report."""

    done: tuple[PlanLine, ...]
    left_out: tuple[tuple[str, str], ...]  # (what, why)
    versions: dict[str, str]
    unanswered: tuple[Unanswered, ...] = ()  # each stands in `left_out` too


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

    study: Study
    lines: list[PlanLine] = field(default_factory=list)
    left_out: list[tuple[str, str]] = field(default_factory=list)
    unanswered: list[Unanswered] = field(default_factory=list)
    errors: list[InputError | SolveError] = field(default_factory=list)  # behind `unanswered`

    @contextmanager
    def step(self, what: str, why: str) -> Iterator[Step]:
        """Time a step; the block fills in its method and size."""
        step, start = Step(what, why), time.perf_counter()
        yield step
        self.lines.append(PlanLine(what, step.method, step.size, time.perf_counter() - start, why))

    def without(self, what: str, why: str) -> None:
        """Note what was left out."""
        self.left_out.append((what, why))

    def attempt(
        self, analysis: str, what: str, run: Callable[P, Result], *args: P.args, **keywords: P.kwargs
    ) -> Result | None:
        """What `run` returns; None where it has no answer, which the plan then says with cause, line and remedy.

        Every analysis runs through here, so that one without an answer takes no other with it. Raises what `run`
        raises where a rule of the file reads the analysis.
        """
        try:
            return run(*args, **keywords)
        except (InputError, SolveError) as error:
            if _is_ruled(self.study, analysis):
                raise
            found = _unanswered(self.study, analysis, what, error)
            self.errors.append(error)
            self.unanswered.append(found)
            self.without(what, found.words)
        return None

    def plan(self, versions: dict[str, str]) -> Plan:
        """All that was collected."""
        return Plan(tuple(self.lines), tuple(self.left_out), versions, tuple(self.unanswered))


def _is_ruled(study: Study, analysis: str) -> bool:
    if not study.rules:
        return False
    from torsion.rules import needed

    return analysis in needed(study)


def _is_named(study: Study, analysis: str) -> bool:
    """The file names an analysis, or the setting of one, or names none and this is a default."""
    if analysis in ALWAYS or not study.analyses:
        return analysis in (*ALWAYS, *DEFAULT)
    name, *keys = analysis.split(".")
    settings: object = study.analyses.get(name)
    for key in keys:
        settings = getattr(settings, key, None)
    return settings is not None


def _unanswered(study: Study, analysis: str, what: str, error: InputError | SolveError) -> Unanswered:
    """The error as the plan tells it, located in the file where it says its place or the file names the analysis."""
    from torsion.schema.read import located

    is_named = _is_named(study, analysis)
    if isinstance(error, InputError):
        faults = list(error.faults)
    else:
        named = ("analyses", *analysis.split(".")) if is_named and study.analyses and analysis not in ALWAYS else ()
        faults = [Fault(error.path or named, error.message, error.hint)]
    known = InputError(faults, str(error))
    if all(fault.path for fault in faults):
        known = located(known, study)
    why = "; ".join(fault.message for fault in known.faults)
    remedy = "; ".join(fault.hint for fault in known.faults if fault.hint)
    line = next((fault.line for fault in known.faults), None)
    return Unanswered(analysis, what, why, remedy, line, str(known), is_named, isinstance(error, InputError))


def versions(system: System, bends: bool = False) -> dict[str, str]:
    """Versions of the program, of Python and of the libraries that the numbers come from."""
    from torsion import __version__

    names = ["numpy", "scipy", "pydantic", "PyYAML"]
    if bends or (system.bars is not None and system.bars.degree):
        names.append("scikit-fem")
    python = ".".join(str(part) for part in sys.version_info[:3])
    return {"torsion": __version__, "Python": python, **{name: metadata.version(name) for name in names}}
