"""What was found of a study: the results of its analyses, and the plan of how they came about."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from torsion.fields import Declared
from torsion.plan import Log, Plan

if TYPE_CHECKING:
    from torsion.assembly.system import System
    from torsion.study import Study

Result = TypeVar("Result")
Settings = TypeVar("Settings", bound=Declared)
Progress = Callable[[str, float], None]  # (what, share done 0..1)


def silent(what: str, share: float) -> None:
    """No progress is shown."""


@dataclass(frozen=True)
class Results:
    """A study and what was found of it, each result under the name that it has in every output."""

    study: "Study"
    results: Mapping[str, Any]

    def get(self, kind: type[Result]) -> Result | None:
        """The result of that class; None where it was not found."""
        return next((found for found in self.results.values() if isinstance(found, kind)), None)

    def need(self, kind: type[Result]) -> Result:
        """The result of that class; raises LookupError where it was not found."""
        found = self.get(kind)
        if found is None:
            raise LookupError(f"{kind.__name__} was not computed")
        return found

    @property
    def system(self) -> "System":
        """The train as assembled, in the discretisation that the results are of."""
        found: System = self.results["system"]
        return found


@dataclass(frozen=True)
class Findings(Results):
    """Everything that a study requests."""

    plan: Plan

    @property
    def failed(self) -> bool:
        """A limit, of a rule or of the comparison of the models, is not kept."""
        return any(getattr(found, "fails", False) for found in self.results.values())


@dataclass(frozen=True)
class Work(Results):
    """A run under way: what analyses read, and where they put what they find."""

    results: dict[str, Any] = field(default_factory=dict)
    log: Log = field(default_factory=Log)
    progress: Progress = silent
    ruled: frozenset[str] = frozenset()  # analyses that the rules of the study read
    rules: Any = None  # the module of the rules, for the speeds that their verdicts stand on

    def settings(self, name: str, kind: type[Settings]) -> Settings:
        """The settings of an analysis, defaults where the file names it without any or not at all."""
        given = self.study.analyses.get(name)
        return given if isinstance(given, kind) else kind()

    def put(self, **found: Any) -> None:
        """Keep results under their names."""
        self.results.update(found)
