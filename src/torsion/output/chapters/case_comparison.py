"""Chapters: all cases of a file side by side, their checks, frequencies and curves; and what one case changes."""

from collections.abc import Iterator, Mapping, Sequence

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Column, Heading, Paragraph, Table, table, texts
from torsion.output.chapters.case_verdict import Row, side_by_side
from torsion.output.figures import case_curves
from torsion.output.figures.figure import Figure
from torsion.output.headline import Cases
from torsion.output.numbers import NONE, RPM, counted, exact, number, rpm, symbols
from torsion.output.reported_values import barred_rpm, responds, synthesis
from torsion.output.selection import elements, highest, torques
from torsion.rules import RULES
from torsion.rules.verdict_line import WORDS, Check
from torsion.study import Change

MOST_COLUMNS = 4  # cases beside each other in one table
MOST_MODES = 8
BY_CASE, NOT_JUDGED = "by case", "not checked"
Loads = dict[str, dict[str, case_curves.Curve]]  # by component, by case


def chapter(findings: Findings) -> Iterator[Block]:
    """Behind the verdict of a file with cases all of them; of one case what it changes; nothing of a file without."""
    if findings.study.case is not None:
        yield from _one(findings)
    if findings.cases:
        yield Heading("Cases side by side", at_end=True)
        yield from _all(findings.each)


def _one(findings: Findings) -> Iterator[Block]:
    """What a case changes of the file."""
    case = findings.study.case
    if case is not None:
        yield Heading("Changes by this case")
        if not case.is_judged:
            yield Paragraph(
                "This case is for information. It is not part of the verdict.", "note", brief=True
            )
        rows = [(one.what, one.before, one.after) for one in case.changes]
        yield table(
            "< Parameter | < Nominal case | < This case", rows, "Changes of the input by this case"
        )


def _all(cases: Cases) -> Iterator[Block]:
    yield from _checks(cases)
    yield from _barred(cases)
    yield from _frequencies(cases)
    yield from _loads(cases)
    changes = [
        (name, one.what, one.before, one.after) for name, f in cases.items() for one in _changes(f)
    ]
    titles = "< Case | < Parameter | < Nominal case | < This case"
    yield table(titles, changes, "Changes of the input by the cases")
    normal = next(iter(cases))
    yield Paragraph(
        f"The following chapters are for the nominal case {normal}. Every other case has its own report."
    )


def _changes(findings: Findings) -> tuple[Change, ...]:
    return () if findings.study.case is None else findings.study.case.changes


def _checks(cases: Cases) -> Iterator[Block]:
    """Rows are checks, columns cases, the last the worst case; of many cases several tables."""
    ranked = side_by_side(cases)
    rows = [row for place, row in enumerate(ranked) if check_words.is_listed(row.check, place)]
    if not rows:
        return
    for shown, part in _columns(cases):
        columns = map(
            texts, ("Check", "Component", "Clause", "Limit", "Unit", *shown, "Worst case")
        )
        yield table(
            tuple(columns),
            [_cells(cases, row, shown) for row in rows],
            "Checks by case, worst first: value, speed of the reference and, in brackets, the order with the largest "
            f"contribution; value / limit if the limit differs by case{part}",
            marks=[row.check.verdict for row in rows],
        )
    if omitted := len(ranked) - len(rows):
        yield Paragraph(
            f"{counted(omitted, 'more check')} below {check_words.SMALL} in results.json."
        )


def _columns(cases: Cases) -> Iterator[tuple[list[str], str]]:
    """Names of the cases that stand beside each other in one table, and which of all they are, for its caption."""
    names = list(cases)
    for first in range(0, len(names), MOST_COLUMNS):
        shown = names[first : first + MOST_COLUMNS]
        part = (
            f"; cases {first + 1} to {first + len(shown)} of {len(names)}"
            if len(names) > MOST_COLUMNS
            else ""
        )
        yield shown, part


def _cells(cases: Cases, row: Row, shown: Sequence[str]) -> tuple[str, ...]:
    first = next(iter(row.each.values()))
    limits = {check_words.limit(check) for check in row.each.values()}
    limit = limits.pop() if len(limits) == 1 else BY_CASE
    each = [
        _cell(row.each[name], with_limit=limit == BY_CASE)
        if name in row.each
        else _lacking(cases[name], first)
        for name in shown
    ]
    most = row.each[row.worst].verdict
    return (
        f"{first.what} ({first.rule})",
        first.where,
        symbols(first.clause),
        limit,
        symbols(first.unit),
        *each,
        f"{row.worst}: {WORDS[most]}",
    )


def _lacking(findings: Findings, check: Check) -> str:
    """Of a case that has not such a check: that it names not the rule of it, else nothing."""
    return (
        NOT_JUDGED if check.rule in RULES and check.rule not in dict(findings.study.rules) else NONE
    )


def _cell(check: Check, *, with_limit: bool) -> str:
    """The worst value of a check, where it stands, and its verdict where that is no pass."""
    text = check_words.value(check)
    text += f" / {check_words.limit(check)}" if with_limit else ""
    text += "" if check.speed is None else f" at {rpm(check.speed)} rpm"
    text += "" if check.order is None else f" ({exact(check.order)})"
    return text if check.verdict == "pass" else f"{text} {WORDS[check.verdict]}"


def _barred(cases: Cases) -> Iterator[Table]:
    """The barred ranges of every case; nothing where there is none."""
    rows = [
        (name, rpm(low / RPM), rpm(high / RPM))
        for name, found in cases.items()
        for low, high in (barred_rpm(found) if found.is_answered else ())
    ]
    if rows:
        titles = "< Case -> | From [rpm] -> from rpm | To [rpm] -> to rpm"
        caption = "Cases: barred ranges"
        yield table(titles, rows, caption, short="Cases: barred ranges")


def _frequencies(cases: Cases) -> Iterator[Block]:
    """Natural frequencies of every case, one row each."""
    found = {
        name: case.need(Modes).frequency
        for name, case in cases.items()
        if case.get(Modes) is not None
    }
    yield from _frequency_table(found, "Natural frequencies of the cases")


def _shown(found: Mapping[str, FloatArray]) -> int:
    """How many modes are shown."""
    return min(max((len(one) for one in found.values()), default=0), MOST_MODES)


def _frequency_table(found: Mapping[str, FloatArray], caption: str) -> Iterator[Table]:
    """found: (modes,) Hz by case."""
    if count := _shown(found):
        columns = (texts("Case"), *(Column(f"Mode {k + 1}", "Hz") for k in range(count)))
        rows = [
            (name, *_padded([number(f, 7) for f in one.tolist()], count))
            for name, one in found.items()
        ]
        yield table(columns, rows, caption)


def _padded(cells: list[str], count: int) -> list[str]:
    return (cells + [NONE] * count)[:count]


def _loads(cases: Cases) -> Iterator[Figure]:
    """The most stressed shaft in every case; without shafts the coupling nearest to its rating."""
    from torsion.output.chapters.component_loads import stress_curves

    solved = {name: case for name, case in cases.items() if case.is_answered and responds(case)}
    stresses: Loads = {}
    for name, case in solved.items():
        for bar in case.study.train.bars:
            curve = stress_curves(case, bar)
            stresses.setdefault(bar.name, {})[name] = (curve.speed * RPM, curve.stress)
    if stresses:
        shaft = _largest(stresses)
        caption = f"Vibratory shear stress of {shaft} in the cases"
        yield case_curves.curves(
            "case-stress", caption, stresses[shaft], "shear stress amplitude", "N/mm²"
        )
        return

    torque_over_rating, loads = _torques(solved)
    if loads:
        component = _largest(torque_over_rating or loads)
        unit = torques(values for _, values in loads[component].values())
        drawn = {
            name: (speed, values * unit.factor)
            for name, (speed, values) in loads[component].items()
        }
        caption = f"Total vibratory torque in {component} in the cases"
        yield case_curves.curves("case-torque", caption, drawn, "torque amplitude", unit.unit)


def _torques(solved: Cases) -> tuple[Loads, Loads]:
    """Over rpm: torque / rating of couplings that have one, and the torque (N m) of every element except shafts."""
    torque_over_rating: Loads = {}
    loads: Loads = {}
    for name, case in solved.items():
        speed = case.need(Response).speed * RPM
        for element in elements(case.system):
            ratings = case.study.train.parts[element.part].ratings
            values = synthesis(case, element.spans)
            if element.kind != "shaft":
                loads.setdefault(element.name, {})[name] = (speed, values)
            if ratings is not None and ratings.vibratory_torque:
                torque_over_rating.setdefault(element.name, {})[name] = (
                    speed,
                    values / ratings.vibratory_torque,
                )
    return torque_over_rating, loads


def _largest(loads: Loads) -> str:
    """The name whose curves reach highest."""
    return max(loads, key=lambda name: max(highest(values) for _, values in loads[name].values()))
