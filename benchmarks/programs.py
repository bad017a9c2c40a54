"""One question put to several programs on one train: their errors, and their times in turn."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from torsion.analyses.compare.timing import Candidate, Pace, Spread, TimedRow, timed
from torsion.errors import SolveError


@dataclass(frozen=True)
class Effort:
    """How much to do."""

    sizes: tuple[int, ...]
    seconds: float  # of timing a case
    modes: int  # with references, where there are more
    response: tuple[
        tuple[int, int, int], ...
    ]  # size, frequencies of torsion's call, frequencies of the peers'
    response_references: int  # frequencies with references
    ross: bool
    largest_of_ross: int
    largest_of_damped: int  # of openTorsion's `modal_analysis`


FULL = Effort(
    sizes=(10, 100, 1000),
    seconds=4.0,
    modes=60,
    response=((10, 1000, 1000), (10, 10000, 1000), (100, 10000, 200), (1000, 1000, 3)),
    response_references=12,
    ross=True,
    largest_of_ross=100,
    largest_of_damped=1000,
)
QUICK = Effort(
    sizes=(10, 100),
    seconds=1.0,
    modes=20,
    response=((10, 1000, 500), (100, 1000, 50)),
    response_references=6,
    ross=True,
    largest_of_ross=10,
    largest_of_damped=100,
)


@dataclass
class Row:
    """One case: what every program answered, and in what time."""

    case: str
    size: int
    referenced: int  # modes or frequencies that have a reference
    requested: int = 0  # response only: frequencies of the kernel's call
    enclosed: int = 0  # references inside torsion's own enclosures
    lost: dict[str, int] = field(default_factory=dict)  # frequencies that a program does not find
    timed: dict[str, TimedRow] = field(
        default_factory=dict
    )  # errors: worst, each; size: frequencies of one call
    faults: tuple[str, ...] = ()

    def least(self, name: str) -> tuple[float, float] | None:
        """Smallest and median seconds of a program's answer to one frequency, what it stands on taken as given."""
        found = self.timed.get(name)
        return None if found is None else _times(Spread.of(found.solve), found.size)

    def whole(self, name: str) -> tuple[float, float] | None:
        """The same with the assembly."""
        found = self.timed.get(name)
        return None if found is None else _times(found.total, found.size)


def _times(spread: Any, size: int) -> tuple[float, float]:
    return spread.least / size, spread.median / size


def program(
    name: str,
    solve: Callable[[Any], Any],
    errors: Callable[[Any], tuple[float, ...]],
    assemble: Callable[[], Any] = lambda: None,
    frequencies: int = 1,
) -> Candidate:
    """A program that answers so many frequencies in one call; what it raises is kept as its fault."""
    return Candidate(
        name, "", frequencies, lambda: tolerant(lambda _: assemble())(None), tolerant(solve), errors
    )


def tolerant(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """The function, with all that it raises as SolveError: programs fail in ways of their own."""

    def call(given: Any) -> Any:
        try:
            return function(given)
        except Exception as fault:
            words = f"{type(fault).__name__}: {fault}".splitlines()[0][:120]
            raise SolveError(words) from fault

    return call


def measure(row: Row, programs: Sequence[Candidate], seconds: float) -> Row:
    """The row with all programs timed A B A B ... until about `seconds` are used.

    A program that takes more than a fifth of the time allowed is run once, and that run is its only sample.
    """
    pace = Pace(rounds=1, seconds=seconds, slow=seconds / 5, slow_rounds=0, runs=20, turn=0.05)
    found, row.faults = timed([[one] for one in programs], pace)
    row.timed = {one.curve: one for one in found}
    return row
