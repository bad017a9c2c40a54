"""Chapters: all cases of a file side by side, their checks, frequencies and curves; and what one case changes."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Column, Heading, Paragraph, Table, table
from torsion.output.figures.curves import MAIN, MOST_LINES, SPEED, amplitudes, span
from torsion.output.figures.figure import Figure, Line, Panel
from torsion.output.headline import Cases, lines_of, omitted_rules, verdict
from torsion.output.numbers import NONE, RPM, cell, rpm, symbols
from torsion.output.reported_values import barred_rpm, responds, synthesis
from torsion.output.stored.scene import elements, highest, torques
from torsion.results import listed
from torsion.rules import RULES
from torsion.rules.verdict_line import WORDS, Check


def overview(cases: Cases) -> Table:
    """Return one row a case: its checks, its highest utilisation and its verdict."""
    rows, marks = list[tuple[object, ...]](), list[str]()
    omitted = {name: f", without {listed(rules)}" for name, rules in omitted_rules(cases).items()}
    for name, findings in cases.items():
        checks, word, case = lines_of(findings), verdict(findings), findings.study.case
        limited = [check for check in checks if check.utilisation is not None]
        highest = max(limited, key=lambda check: check.utilisation or 0.0, default=None)
        report, text = NONE, WORDS[word]
        if not findings.is_answered:
            text += ": not computed"
        elif case is not None:
            report = f"{case.folder}/report.html"
        text += omitted.get(name, "") if findings.is_judged else " (information)"
        used, where = None, NONE
        if highest is not None:
            used, where = highest.utilisation, f"{highest.where}: {symbols(highest.clause)}"
        failed = sum(check.fails for check in checks)
        rows.append((name, report, len(checks), failed, used, where, text))
        marks.append(word if findings.is_judged else "")
    return table(
        "< Case -> | < Report:l | Checks | Failed -> failed | Highest utilisation [%]:4 -> util., % | "
        "< Component and clause -> component | < Verdict ->",
        rows,
        "Cases of the model file",
        marks=marks,
        short="Cases",
        rows_in_summary=4,
    )


@dataclass(frozen=True)
class Row:
    """One check in every case that has it."""

    checks: Mapping[str, Check]  # by name of the case
    worst: str  # name of the case
    check: Check  # of the worst case


def side_by_side(cases: Cases) -> list[Row]:
    """Return every check of every case, those that fail first, then by utilisation; the worst is one that is judged."""
    by_key: dict[tuple[str, str, str, str, int], dict[str, Check]] = {}
    for name, findings in cases.items():
        seen = Counter[tuple[str, ...]]()
        for check in lines_of(findings):
            key = (check.rule, check.clause, check.where, check.what)
            by_key.setdefault((*key, seen[key]), {})[name] = check
            seen[key] += 1
    rows = []
    for checks in by_key.values():
        names = [name for name in checks if cases[name].is_judged] or list(checks)
        worst = min(names, key=lambda name: check_words.rank(checks[name]))
        rows.append(Row(checks, worst, checks[worst]))
    return sorted(rows, key=lambda row: check_words.rank(row.check))


MOST_COLUMNS = 4  # cases beside each other in one table
MOST_MODES = 8
BY_CASE, NOT_JUDGED = "by case", "not checked"


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield all cases of a file side by side, or what one case changes; nothing for a file without cases."""
    if (case := findings.study.case) is not None:
        yield Heading("Changes by this case")
        if not case.is_judged:
            words = "This case is for information. It is not part of the verdict."
            yield Paragraph(words, "note", brief=True)
        rows = [(change.what, change.before, change.after) for change in case.changes]
        titles = "< Parameter | < Nominal case | < This case"
        yield table(titles, rows, "Changes of the input by this case")
    if not findings.cases:
        return
    cases = findings.each
    yield Heading("Cases side by side", at_end=True)
    yield from _checks(cases)
    answered = {name: case for name, case in cases.items() if case.is_answered}
    bands = [(name, *band) for name, case in answered.items() for band in barred_rpm(case)]
    if bands:
        titles = "< Case -> | From [=rpm] -> from rpm | To [=rpm] -> to rpm"
        yield table(titles, bands, title := "Cases: barred ranges", short=title)
    modes = [(modes, name) for name, case in cases.items() if (modes := case.get(Modes))]
    if count := max((len(case_modes.frequency) for case_modes, _ in modes), default=0):
        columns = (f"frequency@{k}: Mode {k} [Hz]:7" for k in range(1, min(count, MOST_MODES) + 1))
        titles = " | ".join(["< Case", *columns])
        yield table(titles, modes, "Natural frequencies of the cases")
    yield from _loads(answered)
    changes = [
        (name, change.what, change.before, change.after)
        for name, case in cases.items()
        if case.study.case is not None
        for change in case.study.case.changes
    ]
    titles = "< Case | < Parameter | < Nominal case | < This case"
    yield table(titles, changes, "Changes of the input by the cases")
    yield Paragraph(
        f"The following chapters are for the nominal case {next(iter(cases))}. Every other case has its own report."
    )


def _checks(cases: Cases) -> Iterator[Block]:
    """Yield tables with a row for each check and a column for each case, the last the worst case."""
    ranked, names = side_by_side(cases), list(cases)
    rows = [row for index, row in enumerate(ranked) if check_words.is_listed(row.check, index)]
    for first in range(0, len(names) if rows else 0, MOST_COLUMNS):
        shown = names[first : first + MOST_COLUMNS]
        columns = ("Check", "Component", "Clause", "Limit", "Unit", *shown, "Worst case")
        part = f"; cases {first + 1} to {first + len(shown)} of {len(names)}"
        lines = list[tuple[str, ...]]()
        for row in rows:
            check, cells = next(iter(row.checks.values())), list[str]()
            limits = {check_words.limit(check) for check in row.checks.values()}
            for name in shown:
                if (judged := row.checks.get(name)) is None:
                    named = dict(cases[name].study.rules)
                    is_omitted = check.rule in RULES and check.rule not in named
                    cells.append(NOT_JUDGED if is_omitted else NONE)
                    continue
                text = check_words.value(judged)
                text += f" / {check_words.limit(judged)}" * (len(limits) > 1)
                text += "" if judged.speed is None else f" at {rpm(judged.speed)} rpm"
                text += "" if judged.order is None else f" ({cell(judged.order)})"
                text += f" {WORDS[judged.verdict]}" * (judged.verdict != "pass")
                cells.append(text)
            limit = BY_CASE if len(limits) > 1 else limits.pop()
            about = f"{check.what} ({check.rule})", check.where, symbols(check.clause)
            worst = f"{row.worst}: {WORDS[row.check.verdict]}"
            lines.append((*about, limit, symbols(check.unit), *cells, worst))
        yield table(
            tuple(Column(title, align="left") for title in columns),
            lines,
            "Checks by case, worst first: value, speed of the reference and, in brackets, the order with the largest "
            "contribution; value / limit if the limit differs by case"
            + part
            * (len(names) > MOST_COLUMNS),
            marks=[row.check.verdict for row in rows],
        )
    if omitted := len(ranked) - len(rows):
        yield check_words.omitted(omitted)


def _loads(cases: Cases) -> Iterator[Figure]:
    """Yield the most stressed shaft in every answered case; without shafts the component with the largest torque."""
    from torsion.output.chapters.response.component_loads import stress_curves

    answered = {name: case for name, case in cases.items() if responds(case)}
    loads = [case.need(ComponentLoads) for case in answered.values()]
    shafts = [shaft for case in loads for shaft in case.shafts]
    parts = [part for case in loads for part in case.elements]
    if shafts:
        name = max(shafts, key=lambda shaft: shaft.stress or 0.0).shaft
        stresses = {
            case_name: (curve.speed * RPM, curve.stress)
            for case_name, case in answered.items()
            for bar in case.system.train.bars
            if bar.name == name
            for curve in [stress_curves(case, bar)]
        }
        caption = f"Vibratory shear stress of {name} in the cases"
        yield _curves("case-stress", caption, stresses, "shear stress amplitude", "N/mm²")
    elif parts:
        name = max(parts, key=lambda part: part.torque or 0.0).component
        torque = {
            case_name: (case.need(Response).speed * RPM, synthesis(case, element.spans))
            for case_name, case in answered.items()
            for element in elements(case.system)
            if element.name == name
        }
        unit = torques(values for _, values in torque.values())
        drawn = {case: (speed, values * unit.factor) for case, (speed, values) in torque.items()}
        caption = f"Total vibratory torque in {name} in the cases"
        yield _curves("case-torque", caption, drawn, "torque amplitude", unit.unit)


def _curves(
    name: str,
    caption: str,
    drawn: Mapping[str, tuple[FloatArray, FloatArray]],
    quantity: str,
    unit: str,
) -> Figure:
    """Draw one line a case over the speed, rpm, the first heavier; of many cases it and those that reach highest."""
    first = next(iter(drawn))
    ranked = sorted(drawn, key=lambda case: (case != first, -highest(drawn[case][1])))[:MOST_LINES]
    lines = tuple(
        Line(case, *drawn[case], pen, weight=MAIN if case == first else 1.0)
        for pen, case in enumerate(case for case in drawn if case in ranked)
    )
    x = span(SPEED, np.concatenate([line.x for line in lines]))
    y = amplitudes(quantity, unit, [line.y for line in lines])
    return Figure(name, caption, (Panel(x, y, lines),))
