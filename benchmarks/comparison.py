"""What one comparison holds: a program's answer or its fault, and the questions put to all programs alike."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from benchmarks.timing import Timing


@dataclass
class Kept:
    """A function that keeps its last answer, or the fault it failed with, so that what is timed is also checked."""

    function: Callable[[], Any]
    answer: Any = None
    fault: str = ""

    def __call__(self) -> None:
        """Runs the function, unless it has failed before."""
        if self.fault:
            return
        try:
            self.answer = self.function()
        except Exception as fault:
            self.fault = f"{type(fault).__name__}: {str(fault).splitlines()[0] if str(fault) else ''}"[:120]


@dataclass(frozen=True)
class Error:
    """How far an answer is from the reference."""

    worst: float = float("nan")  # relative; of torques over the largest torque of the same frequency
    each: float = float("nan")  # torques only: every one over its own
    lost: int = 0  # frequencies that are missing altogether
    fault: str = ""


@dataclass
class Row:
    """One case: errors and times by program."""

    case: str
    size: int
    referenced: int  # modes or frequencies that have a reference
    asked: int = 0  # response only: frequencies of the kernel's call
    enclosed: int = 0  # references inside torsion's own enclosures
    errors: dict[str, Error] = field(default_factory=dict)
    times: dict[str, Timing] = field(default_factory=dict)  # response: seconds a frequency


@dataclass(frozen=True)
class Effort:
    """How much to do."""

    sizes: tuple[int, ...]
    seconds: float  # of timing a case
    modes: int  # with references, where there are more
    response: tuple[tuple[int, int, int], ...]  # size, frequencies of torsion's call, frequencies of the peers'
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
