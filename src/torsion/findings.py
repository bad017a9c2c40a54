"""What was found of a study: the results of its analyses, and the plan.

The plan is what was done, by which method, of what size, in what time; and what was left out and why.
"""

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import metadata
from pathlib import Path as FilePath
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, Self, TypeVar

from torsion.errors import BAD_INPUT, FAILED_CHECK, REFUSED, SOLVED
from torsion.fields import Declared
from torsion.results import Displayed, by_name, derived, reported, result

if TYPE_CHECKING:
    from torsion.assembly.system import System
    from torsion.study import Study

version = cache(metadata.version)  # found on the disc
Result = TypeVar("Result")
Settings = TypeVar("Settings", bound=Declared)
NORMAL = "normal"  # what the file as it stands is called among its cases
Progress = Callable[[str, float], None]  # (what, share done 0..1)


def silent(what: str, share: float) -> None:
    """Show no progress; the default of every `progress`."""


@reported
class PlanLine:
    """One step that was done."""

    what: str = result("a step that was done")
    method: str = result("by which method")
    size: str = result("of what size")
    seconds: float = result("time")
    why: str = result("reason")


@reported
class LeftOut:
    """What was not done."""

    what: str = result("what was left out")
    why: str = result("reason")


@reported
class Unanswered:
    """An analysis that was tried and has no answer."""

    analysis: str = result("an analysis that failed; `left_out` lists it too")
    what: str = result("the same in words")
    why: str = result("cause")
    remedy: str = result("what to change; empty if the cause says it")
    line: int | None = result("line of the file, from 1; null if there is none")
    is_named: bool = result(
        "the analysis was requested in the file; the exit status is then 3", key="named"
    )
    is_input: bool = result(
        "an input error is the reason; the exit status is then 2", key="input_fault"
    )
    text: str  # all of it, with the line quoted

    @property
    def words(self) -> str:
        """Cause, line and remedy in one sentence."""
        where = "" if self.line is None else f" (line {self.line} of the file)"
        return f"{self.why}{where}" + (f"; remedy: {self.remedy}" if self.remedy else "")


@reported
class UsedSource:
    """A publication, rule or standard that the run used."""

    key: str = result("key of the literature (`torsion sources`), or name of the rule")
    words: str = result("authors, work and year, or rule and edition")
    where: tuple[str, ...] = result("equations or chapters, or clauses of the rule")
    compared: bool = result("edition and digits were compared with the publication")
    is_rule: bool = False


@reported
class Plan:
    """The whole of it, printed on the last page of the report."""

    done: tuple[PlanLine, ...] = result("steps in their order")
    left_out: tuple[tuple[str, str], ...]  # (what, why)
    versions: dict[str, str] = result("versions of the libraries")

    unanswered: tuple[Unanswered, ...] = result("analyses without an answer", default=())
    sources: tuple[UsedSource, ...] = ()  # of formulas, methods and rules

    @derived("what was omitted, and why", key="left_out")
    def reasons(self) -> tuple[LeftOut, ...]:
        """Every omitted step as a declared result."""
        return tuple(LeftOut(what, why) for what, why in self.left_out)


@dataclass
class Step:
    """A step under way; its words may be filled in while it runs."""

    method: str = ""
    size: str = ""


@dataclass
class Log:
    """Collects the plan while the work goes on."""

    lines: list[PlanLine] = field(default_factory=list)
    left_out: list[tuple[str, str]] = field(default_factory=list)
    unanswered: list[Unanswered] = field(default_factory=list)
    libraries: dict[str, None] = field(
        default_factory=lambda: dict.fromkeys(("numpy", "scipy", "pydantic", "PyYAML"))
    )

    @contextmanager
    def step(self, what: str, why: str) -> Iterator[Step]:
        """Time a step; the block fills in its method and size."""
        step, start = Step(), time.perf_counter()
        yield step
        # Reproducible reports (SOURCE_DATE_EPOCH) state no times.
        seconds = 0.0 if "SOURCE_DATE_EPOCH" in os.environ else time.perf_counter() - start
        self.lines.append(PlanLine(what, step.method, step.size, seconds, why))

    def without(self, what: str, why: str) -> None:
        """Note a step that was omitted, and the reason."""
        self.left_out.append((what, why))

    def plan(self) -> Plan:
        """Return all that was collected, with the versions of what the numbers come from."""
        python = ".".join(map(str, sys.version_info[:3]))
        versions = {"torsion": version("torsion"), "Python": python}
        versions |= {name: version(name) for name in self.libraries}
        return Plan(tuple(self.lines), tuple(self.left_out), versions, tuple(self.unanswered))


@dataclass(frozen=True)
class Results:
    """A study and what was found of it, each result under the name that it has in every output."""

    study: "Study"
    results: Mapping[str, Any]

    def get(self, kind: type[Result]) -> Result | None:
        """Return the result of that class; None where it was not found."""
        return next((value for value in self.results.values() if isinstance(value, kind)), None)

    def need(self, kind: type[Result]) -> Result:
        """Return the result of that class; raises LookupError where it was not found."""
        if (result := self.get(kind)) is None:
            raise LookupError(f"{kind.__name__} was not computed")
        return result

    def having(self, **found: Any) -> Self:
        """Return the same with other results under those names."""
        return replace(self, results={**self.results, **found})

    @property
    def system(self) -> "System":
        """The train as assembled, in the discretisation that the results are of."""
        system: System = self.results["system"]
        return system


@dataclass(frozen=True, repr=False)
class Findings(Displayed, Results):
    """Everything that a study requests."""

    plan: Plan
    cases: "Mapping[str, Findings]" = field(
        default_factory=dict
    )  # of every case of the study, by name

    def __getitem__(self, name: str) -> Any:
        """Return the result of that name; raises KeyError with the nearest name."""
        return by_name(name, self.results, "result")

    @property
    def verdict(self) -> str:
        """PASS, PASS with restrictions, FAIL or NOT JUDGED: the word of the report, over all cases."""
        (_, words), _ = resolve_name("torsion.output.headline:overall_headline")(self)
        return str(words.partition(":")[0])

    @property
    def passed(self) -> bool | None:
        """True for PASS, with or without restrictions; False for FAIL; None if something is not judged.

        It is never True where the command ends with another exit status than 0.
        """
        verdict = self.verdict
        if verdict == "FAIL":
            return False
        return True if verdict != "NOT JUDGED" and self.exit_status == SOLVED else None

    @property
    def checks(self) -> tuple[Any, ...]:
        """The rows of the verdict: rule, clause, where, what, value, limit, unit, utilisation, verdict, ..."""
        return self.results["checks"].lines if "checks" in self.results else ()

    @property
    def figures(self) -> "Mapping[str, Any]":
        """The figures of the report by name."""
        drawn: Mapping[str, Any] = resolve_name("torsion.output.report_figures:figures")(self)
        return drawn

    def report(self, place: str | FilePath) -> list[FilePath]:
        """Write the report as `solve` does into a folder, or one file of it (.html, .pdf, .json); return the paths."""
        paths: list[FilePath] = resolve_name("torsion.output.write:write_place")(self, place)
        return paths

    def to_dict(self) -> dict[str, Any]:
        """Return everything that results.json holds, with its keys."""
        values: dict[str, Any] = resolve_name("torsion.output.stored.results_json:results")(self)
        return values

    def compare(self, other: "Findings") -> Any:
        """Return what changed from these findings to others: input, natural frequencies and checks."""
        return resolve_name("torsion.exchange.comparison:compare")(self, other)

    @property
    def failed(self) -> bool:
        """A limit, of a rule or of the comparison of the models, is not kept."""
        return any(getattr(result, "fails", False) for result in self.results.values())

    @property
    def is_partial(self) -> bool:
        """A rule was not judged over all that it demands."""
        return any(getattr(result, "is_partial", False) for result in self.results.values())

    @property
    def exit_status(self) -> int:
        """What a command ends with that printed them: of several cases the worst that is judged."""
        judged = [case for case in self.each.values() if case.is_judged or not self.cases]
        unanswered = [what for case in judged for what in case.plan.unanswered]
        if any(answer.is_input for answer in unanswered):
            return BAD_INPUT
        if any(answer.is_named for answer in unanswered):
            return REFUSED
        return FAILED_CHECK if any(case.failed or case.is_partial for case in judged) else SOLVED

    @property
    def without_answer(self) -> tuple[str, ...]:
        """Every analysis without an answer, and the case that it is of, with its cause, as the commands say it."""
        return tuple(
            f"no answer: {answer.what}{f' of case {name}' if self.cases and answer.analysis else ''}\n{answer.text}"
            for name, case in self.each.items()
            for answer in case.plan.unanswered
        )

    @property
    def is_answered(self) -> bool:
        """There are results; a case may have none, and its plan then says why."""
        return bool(self.results)

    @property
    def is_judged(self) -> bool:
        """It counts for the verdict over all cases."""
        return self.study.case is None or self.study.case.is_judged

    @property
    def each(self) -> "dict[str, Findings]":
        """These findings and those of every case, by name; a study that has no case is `normal`."""
        name = self.study.case.name if self.study.case is not None else NORMAL
        return {name: self, **self.cases}


@dataclass(frozen=True)
class Work(Results):
    """A run under way: what analyses read, and where they put what they find."""

    results: dict[str, Any] = field(default_factory=dict)
    log: Log = field(default_factory=Log)
    progress: Progress = silent
    ruled: frozenset[str] = frozenset()  # analyses that the rules of the study read
    solve: Callable[..., Findings] | None = None  # another study to its findings, as `run` does
    # Chunks of a sweep to their parts, in place of this process.
    answered: Callable[..., Any] | None = None

    @property
    def rules(self) -> Any:
        """The module of the rules, for the speeds that their verdicts stand on."""
        return resolve_name("torsion.rules.rule_over_speed")

    def settings(self, name: str, kind: type[Settings]) -> Settings:
        """Return the settings of an analysis, defaults where the file names it without any or not at all."""
        given = self.study.analyses.get(name)
        return given if isinstance(given, kind) else kind()

    def put(self, **found: Any) -> None:
        """Add results under the names that every output uses."""
        self.results.update(found)
