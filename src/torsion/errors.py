"""The two ways in which a computation can end without an answer, and what a fault of the input is."""

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass

SOLVED, FAILED_CHECK, BAD_INPUT, REFUSED = 0, 1, 2, 3  # exit status of the commands
Path = tuple[
    str | int, ...
]  # keys and list positions from the top of the file, e.g. ("train", 2, "shaft", "length")


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
    # Where it stands, with its line: a table that the scene names; empty: the scene itself.
    file: str = ""

    @property
    def sentence(self) -> str:
        """The fault in words, without the file."""
        where = ".".join(map(str, self.path)) or "input"
        origin = f" by {'.'.join(map(str, self.other))}" if self.other else ""
        return f"{where}: {self.message}{origin}" + (f" ({self.hint})" if self.hint else "")


class Refusal(ValueError):
    """A value that is not possible: what is wrong, what would be right, and which entry of a mapping or list it is of."""

    def __init__(self, message: str, hint: str = "", key: str | Path = ()) -> None:
        self.message, self.hint = message, hint
        self.key: Path = (key,) if isinstance(key, str) and key else tuple(key)
        super().__init__(f"{message} ({hint})" if hint else message)


class TorsionError(Exception):
    """Base of every error that `torsion` raises on purpose."""


class InputError(TorsionError):
    """The user must change the input. Holds every fault that was found, not only the first."""

    def __init__(self, faults: list[Fault] | tuple[Fault, ...], text: str = "") -> None:
        self.faults = tuple(faults)
        super().__init__(text or "\n".join(fault.sentence for fault in self.faults))

    @property
    def message(self) -> str:
        """What is wrong, without places and hints."""
        return "; ".join(fault.message for fault in self.faults)

    def __reduce__(self) -> tuple[type["InputError"], tuple[tuple[Fault, ...], str]]:
        """Return the error as it goes from one process to another."""
        return type(self), (self.faults, str(self))


def refusal(message: str, hint: str = "") -> InputError:
    """Return the error for input that is no part of a model file, such as an option or a folder."""
    return InputError([Fault((), message, hint)], f"{message} ({hint})" if hint else message)


class SolveError(TorsionError):
    """No answer to the promised accuracy: the cause, what to try, and the place of the file that it is about."""

    def __init__(self, message: str, hint: str = "", path: Path = ()) -> None:
        self.message, self.hint, self.path = message, hint, path
        self.located = ""  # the same with the place in the study's file and its line; set by the run of a study
        super().__init__(f"{message}; {hint}" if hint else message)


def nearest(word: str, candidates: Iterable[str], cutoff: float = 0.6) -> str | None:
    """Return the candidate that `word` was probably meant to be; capitals, '-' and '_' do not count.

    A word that is a part of one candidate alone stands for it.
    """
    words = [word, *candidates]
    plain, *spellings = (re.sub("[- ]", "_", spelling.casefold()) for spelling in words)
    by_plain = dict(zip(spellings, words[1:], strict=True))
    close = difflib.get_close_matches(plain, by_plain, 1, cutoff)
    holding = [candidate for candidate in by_plain if plain in candidate.split("_")]
    close = close or (holding if len(holding) == 1 else [])
    return by_plain[close[0]] if close else None
