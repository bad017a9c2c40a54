"""Parts of a page: rows of numbers, misprints, figures, and the page as Markdown."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

COMMAND = "python -m benchmarks.papers"


@dataclass(frozen=True)
class Misprint:
    """One fault of a paper."""

    where: str
    printed: str
    right: str
    checked: str


@dataclass(frozen=True)
class Picture:
    """A figure with its words; `svg` is the drawing."""

    name: str
    caption: str
    svg: str


@dataclass(frozen=True)
class Page:
    """All that a page says."""

    name: str
    title: str
    reference: str
    what: str
    notation: str
    numbers: tuple[tuple[str, ...], ...]  # rows of: what, paper, ours, difference
    checks: str  # how far ours can be trusted
    pictures: tuple[Picture, ...]
    misprints: tuple[Misprint, ...]
    missing: tuple[str, ...]  # what could not be rebuilt
    computed_by: str = ""  # modules, where no train file can say what the paper computes
    tested_by: str = ""

    def text(self) -> str:
        """Markdown."""
        figures = [
            f"![{picture.name}]({picture.name}.svg)\n\n{picture.caption}"
            for picture in self.pictures
        ]
        scene = f"from `shafting_specs/papers/{self.name}.yaml`"
        faults = [
            (fault.where, fault.printed, fault.right, fault.checked) for fault in self.misprints
        ]
        parts = [
            f"# {self.title}",
            self.reference,
            self.what,
            self.notation,
            "## Numbers",
            table(("what", "paper", "ours", "ours − paper"), self.numbers),
            self.checks,
            "## Figures",
            *figures,
            "## Misprints and gaps of the paper",
            table(("where", "printed", "right", "how it was checked"), faults),
            "## Limits of the reproduction",
            "\n".join(f"- {what}" for what in self.missing),
            (
                f"Rebuilt by `{COMMAND}` {f'with {self.computed_by}' if self.computed_by else scene}; the numbers and "
                f"the misprints are kept by `tests/papers/{self.tested_by or f'test_{self.name}.py'}`."
            ),
        ]
        return "\n\n".join(parts) + "\n"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table; vertical strokes inside a cell are escaped."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
    )


def compared(
    what: str, printed: str, ours: float, unit: str = "", digits: int = 12
) -> tuple[str, ...]:
    """A row: the paper's number as printed, ours, and the difference with the printed number's digits in mind."""
    difference = ours - float(printed)
    half = 0.5 * 10.0 ** -len(printed.partition(".")[2])
    verdict = (
        "agrees as printed" if abs(difference) <= half * (1.0 + 1e-9) else "**does not agree**"
    )
    shown = "0" if abs(difference) <= 1e-12 * abs(ours) else f"{difference:+.2g}"
    return what, _with(printed, unit), _with(f"{ours:.{digits}g}", unit), f"{shown}, {verdict}"


def stated(
    what: str, ours: float | str, unit: str = "", paper: str = "curve only", digits: int = 12
) -> tuple[str, ...]:
    """A row without a printed number to compare with."""
    value = ours if isinstance(ours, str) else f"{ours:.{digits}g}"
    return what, paper, _with(value, unit), "–"


def bound(found: ArrayLike, expected: ArrayLike, limit: str) -> str:
    """The limit as text, after making sure that the largest difference, relative to the largest value, is below it.

    A page quotes bounds, not roundings: it reads the same wherever it is built.
    """
    difference = np.abs(
        np.asarray(found, dtype=complex) - np.asarray(expected, dtype=complex)
    ).max()
    if not difference <= float(limit) * np.abs(np.asarray(expected)).max():
        raise ArithmeticError(f"difference {difference:.3g}, promised {limit} relative")
    return limit


def apart(found: ArrayLike, expected: ArrayLike) -> str:
    """Largest difference relative to the largest value, two digits: how wrong a printed equation is."""
    difference = np.abs(np.asarray(found) - np.asarray(expected)).max()
    return f"{100.0 * difference / np.abs(np.asarray(expected)).max():.2g} %"


def _with(value: str, unit: str) -> str:
    return f"{value} {unit}".strip()
