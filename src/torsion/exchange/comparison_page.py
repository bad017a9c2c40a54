"""A comparison as a document: tables for the terminal and the page, and rows for JSON."""

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from torsion.exchange.comparison import (
    CaseComparison,
    CheckChange,
    Comparison,
    InputChange,
    ModePair,
)
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.document import Cover, Document, numbered
from torsion.output.numbers import NONE, number
from torsion.output.reports import REPORTS
from torsion.rules.verdict_line import WORDS

SHORT = 12  # digits of a checksum
DISCLAIMER = "Both calculations are as they were reported; nothing was solved again."


def comparison_document(comparison: Comparison) -> Document:
    """Return the comparison as a document of tables."""
    facts = [
        ("A", f"{comparison.name_before}, input SHA-256 {comparison.checksum_before[:SHORT]}"),
        ("B", f"{comparison.name_after}, input SHA-256 {comparison.checksum_after[:SHORT]}"),
    ]
    blocks = [block for case in comparison.cases for block in _case_blocks(case)]
    cover = Cover(REPORTS["compare"].title, comparison.name_after, tuple(facts), DISCLAIMER)
    return Document(cover, tuple(numbered(blocks)), "compare")


def comparison_data(comparison: Comparison) -> dict[str, Any]:
    """Return the comparison as data for JSON; NaN is None."""
    data: dict[str, Any] = asdict(comparison) | {"is_changed": comparison.is_changed}
    for case in data["cases"]:
        for pair in case["modes"]:
            if math.isnan(pair["criterion"]):
                pair["criterion"] = None
    return data


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
        titles = "< Component -> | < Input -> | A -> | B -> | < Unit -> | Change [%] -> %"
        yield table(
            titles, map(_input_row, case.inputs), "Input that differs", short="Input that differs"
        )
    if any(pair.is_changed for pair in case.modes):
        titles = (
            "Mode of A -> A | Mode of B -> B | Frequency A [Hz] -> Hz A | Frequency B [Hz] -> Hz B "
        )
        titles += "| Change [%] -> % | MAC -> MAC"
        yield table(
            titles, map(_mode_row, case.modes), "Natural frequencies", short="Natural frequencies"
        )
    if case.checks:
        titles = "< Check -> | < Component -> | < Rule -> | < Verdict A -> A | < Verdict B -> B "
        titles += "| Utilisation A [%] -> % A | Utilisation B [%] -> % B"
        yield table(
            titles, map(_check_row, case.checks), "Checks that differ", short="Checks that differ"
        )


def _input_row(change: InputChange) -> tuple[str, ...]:
    before, after, relative = change.before, change.after, ""
    if isinstance(before, int | float) and isinstance(after, int | float) and before:
        relative = number(100.0 * (after / before - 1.0), 3)
    return (
        change.component or NONE,
        change.what,
        _value(before),
        _value(after),
        change.unit,
        relative or NONE,
    )


def _value(value: Any) -> str:
    if isinstance(value, list):
        return ", ".join(map(_value, value)) or NONE
    return (
        number(value) if isinstance(value, int | float) else NONE if value is None else str(value)
    )


def _mode_row(pair: ModePair) -> tuple[str, ...]:
    modes = [
        "new" if pair.before is None else str(pair.before),
        "gone" if pair.after is None else str(pair.after),
    ]
    change = NONE if pair.change is None else number(100.0 * pair.change, 3)
    frequencies = [number(frequency) for frequency in (pair.frequency_before, pair.frequency_after)]
    return *modes, *frequencies, change, number(pair.criterion, 3)


def _check_row(change: CheckChange) -> tuple[str, ...]:
    verdicts = [
        "not present" if verdict is None else WORDS[verdict]
        for verdict in (change.verdict_before, change.verdict_after)
    ]
    used = [
        NONE if share is None else number(100.0 * share, 4)
        for share in (change.utilisation_before, change.utilisation_after)
    ]
    return change.what, change.component, change.rule, *verdicts, *used
