"""The command `torsion compare`."""

import json
import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

from torsion.command_endings import say
from torsion.errors import refusal
from torsion.exchange.comparison import (
    CaseComparison,
    compare_results,
    read_results,
)
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.document import Cover, Document, numbered
from torsion.output.numbers import NONE, number
from torsion.output.pages.html import html as render_page
from torsion.output.pages.terminal import show
from torsion.output.reports import REPORTS
from torsion.rules.verdict_line import WORDS
from torsion.user_files import printable

SHORT = 12  # digits of a checksum
DISCLAIMER = "Both calculations are as they were reported; nothing was solved again."


def _case_blocks(case: CaseComparison) -> Iterator[Block]:
    """The chapter of one case: verdict, then every table with a change."""
    yield Heading(f"Case {case.name}" if case.name else "Model file")
    verdicts = [
        verdict or "case not present" for verdict in (case.verdict_before, case.verdict_after)
    ]
    head = f"Case {case.name}: " if case.name else "Verdict: "
    yield Paragraph(f"{head}checks of A {verdicts[0]}, of B {verdicts[1]}.", brief=True)
    if not case.is_changed:
        yield Paragraph("No change.", brief=True)
        return
    if case.inputs:
        titles = "< Component -> | < Input -> | < A -> | < B -> | < Unit -> | Change [%]:3 -> %"
        changes = list[tuple[Any, ...]]()
        for change in case.inputs:
            before, after, relative = change.before, change.after, None
            if isinstance(before, int | float) and isinstance(after, int | float) and before:
                relative = after / before - 1.0
            values = _value(before), _value(after)
            about = change.component or NONE, change.what
            changes.append((*about, *values, change.unit, relative))
        yield table(titles, changes, "Input that differs", short="Input that differs")
    if any(pair.is_changed for pair in case.modes):
        titles = (
            "Mode of A -> A | Mode of B -> B | Frequency A [Hz] -> Hz A | Frequency B [Hz] -> Hz B "
            "| Change [%]:3 -> % | MAC:3 -> MAC"
        )
        rows = (
            (
                pair.before or "new",
                pair.after or "gone",
                pair.frequency_before,
                pair.frequency_after,
                pair.change,
                pair.criterion,
            )
            for pair in case.modes
        )
        yield table(titles, rows, "Natural frequencies", short="Natural frequencies")
    if case.checks:
        titles = (
            "< Check -> | < Component -> | < Rule -> | < Verdict A -> A | < Verdict B -> B "
            "| Utilisation A [%]:4 -> % A | Utilisation B [%]:4 -> % B"
        )
        differing = (
            (
                change.what,
                change.component,
                change.rule,
                "not present" if before is None else WORDS[before],
                "not present" if after is None else WORDS[after],
                change.utilisation_before,
                change.utilisation_after,
            )
            for change in case.checks
            for before, after in [(change.verdict_before, change.verdict_after)]
        )
        yield table(titles, differing, "Checks that differ", short="Checks that differ")


def _value(value: Any) -> Any:
    """Return a value of the input for a cell: a number, or the words of anything else."""
    if isinstance(value, list):
        return ", ".join(number(x) if isinstance(x, int | float) else str(x) for x in value) or NONE
    return float(value) if isinstance(value, int | float) else value


def compare(before: Path, after: Path, page: Path | None = None, *, as_json: bool = False) -> bool:
    """Print the comparison of two results and write its page; return whether something changed.

    Raises InputError if a file cannot be read or the page cannot be written.
    """
    comparison = compare_results(read_results(before), read_results(after))
    facts = (
        ("A", f"{comparison.name_before}, input SHA-256 {comparison.checksum_before[:SHORT]}"),
        ("B", f"{comparison.name_after}, input SHA-256 {comparison.checksum_after[:SHORT]}"),
    )
    blocks = [block for case in comparison.cases for block in _case_blocks(case)]
    cover = Cover(REPORTS["compare"].title, comparison.name_after, facts, DISCLAIMER)
    document = Document(cover, tuple(numbered(blocks)), "compare")
    if as_json:
        data: dict[str, Any] = asdict(comparison) | {"is_changed": comparison.is_changed}
        for case in data["cases"]:
            for pair in case["modes"]:
                if math.isnan(pair["criterion"]):
                    pair["criterion"] = None
        say(json.dumps(data, indent=2, ensure_ascii=False))
    else:
        show(document)
    if page is not None:
        try:
            page.write_text(render_page(document), encoding="utf-8")
        except OSError as error:
            raise refusal(f"{printable(str(page))} cannot be written: {error.strerror}") from None
        if not as_json:
            say(f"Comparison: {printable(str(page))}")
    return comparison.is_changed
