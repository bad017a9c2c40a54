"""The two ways in which a computation can end without an answer, and what a fault of the input is."""

from dataclasses import dataclass

Path = tuple[str | int, ...]  # keys and list positions from the top of the file, e.g. ("train", 2, "shaft", "length")


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing wrong with the input: where it stands, what is wrong and what would be right."""

    path: Path
    message: str
    hint: str = ""
    at_key: bool = False  # the fault is the key itself (unknown, duplicate), not its value
    line: int | None = None  # 1-based; set by the reader, which knows where every path stands
    column: int | None = None
    other: Path = ()  # another place that the fault is about; the reader quotes its line


class TorsionError(Exception):
    """Base of every error that `torsion` raises on purpose."""


class InputError(TorsionError):
    """The user must change the input. Holds every fault that was found, not only the first."""

    def __init__(self, faults: list[Fault] | tuple[Fault, ...], text: str = "") -> None:
        self.faults = tuple(faults)
        super().__init__(text or "\n".join(_sentence(fault) for fault in self.faults))


class SolveError(TorsionError):
    """No answer to the promised accuracy: the cause, what to try, and the place of the file that it is about."""

    def __init__(self, message: str, hint: str = "", path: Path = ()) -> None:
        self.message, self.hint, self.path = message, hint, path
        super().__init__(f"{message}; {hint}" if hint else message)


def _sentence(fault: Fault) -> str:
    where = ".".join(str(step) for step in fault.path) or "input"
    other = f" by {'.'.join(str(step) for step in fault.other)}" if fault.other else ""
    hint = f" ({fault.hint})" if fault.hint else ""
    return f"{where}: {fault.message}{other}{hint}"
