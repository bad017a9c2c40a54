"""Chapters: all cases of a file side by side, their checks, frequencies and curves; and what one case changes."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Box, Column, Heading, Paragraph, Table, head, table, texts
from torsion.output.chapters import first_page
from torsion.output.chapters.first_page import Head, Kind, worst, worst_line
from torsion.output.check_words import SIGNS
from torsion.output.figures import case_curves
from torsion.output.figures.figure import Figure
from torsion.output.numbers import NONE, RPM, counted, exact, number, rpm, symbols
from torsion.output.reported_values import band_words, barred_rpm, responds, synthesis
from torsion.output.selection import elements, highest, torques
from torsion.results import listed
from torsion.rules import RULES
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, Checks
from torsion.study import Change

MOST_COLUMNS = 4  # cases beside each other in one table
MOST_MODES = 8
MOST_NAMED = 4  # cases in the headline
HEADS = 8  # rows of the first page for the heads of the box, of the table and of the chapter
WORST = "✗!?–~✓"  # signs of headlines, from the worst
RANK = {"fail": 0, "not kept": 1, "in part": 2, "outside": 3, "pass": 4}  # from the worst
BAD = "fail", "not kept"
NO_ANSWER, BY_CASE, NOT_JUDGED = "no answer", "by case", "not judged"
Cases = Mapping[str, Findings]
Loads = dict[str, dict[str, case_curves.Curve]]  # by component, by case
Key = tuple[str, str, str, str, int]  # rule, clause, component, what, which of several


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
        yield Heading("What this case changes")
        if not case.is_judged:
            yield Paragraph("The file has this case for information: it is no part of its verdict.", "note", brief=True)
        rows = [(one.what, one.before, one.after) for one in case.changes]
        yield table("< What | < In the file | < In this case", rows, "Changes of the input file that make this case")


def over_all(findings: Findings) -> Iterator[Block]:
    """Before all else: the verdict over all cases; nothing of a file without."""
    if findings.cases:
        yield Heading("Verdict over all cases", at_end=True)
        yield box(findings.each)
        yield _overview(findings.each)


def box(cases: Cases) -> Box:
    """The worst verdict of those that are judged, in which case, why, and what has no answer."""
    lines = [("Conclusion", _conclusion(cases))]
    found = {name: check for name, one in _judged(cases).items() if one.is_answered if (check := worst(one))}
    if found:
        name = min(found, key=lambda name: check_words.rank(found[name]))
        lines += [(title, f"case {name}, {text}") for title, text in worst_line(cases[name])]
    unknown = [f"{name}: {one.what}, because {one.words}" for name, f in cases.items() for one in f.plan.unanswered]
    bands = {name: barred_rpm(one) for name, one in _judged(cases).items() if _restricts(one)}
    if bands:
        each = (f"{name}: {', '.join(map(band_words, found))}" for name, found in bands.items())
        lines.append(("Barred ranges", "; ".join(each)))
    if unknown:
        lines.append(("No answer", "; ".join(unknown)))
    if left := [name for name, one in cases.items() if not one.is_judged]:
        lines.append(("For information", f"{', '.join(left)}: no part of this verdict"))
    (sign, words), kind = headline(cases)
    return Box(sign, words, kind, tuple(lines))


def headline(cases: Cases) -> tuple[Head, Kind]:
    """The worst of the headlines of the cases that are judged, and of which they are; PASS is what all of them read."""
    each = {
        name: first_page.headline(one) if one.is_answered else (("?", "INCOMPLETE: no answer"), "note")
        for name, one in _judged(cases).items()
    }
    (sign, _), kind = min(each.values(), key=lambda one: WORST.index(one[0][0]))
    of = {name: words.split(", ") for name, ((other, words), _) in each.items() if other == sign}
    all_or_some = f"all {len(each)} cases" if len(of) == len(each) > 1 else counted(len(each), "case")
    some = "" if len(of) == len(each) else f"{len(of)} of "
    which = f" ({listed(of, most=MOST_NAMED)})" if some else ""
    first = next(iter(of.values()))[0].partition(":")[0]
    parts = {part: [name for name in of if part in of[name][1:]] for one in of.values() for part in one[1:]}
    more = [part + (f" ({listed(names, most=MOST_NAMED)})" if len(names) < len(of) else "")
            for part, names in parts.items()]  # fmt: skip
    said = of if sign == SIGNS["outside"] else {}  # without a verdict at all
    more += [f"{listed(rules)} NOT JUDGED in {name}" for name, rules in _left_out(cases).items() if name not in said]
    return (sign, ", ".join([f"{first} in {some}{all_or_some} judged{which}", *more])), kind


def _judged(cases: Cases) -> Cases:
    return {name: one for name, one in cases.items() if one.is_judged}


def rows_of_first_page(cases: Cases) -> int:
    """Rows that the verdict over all cases takes of the first page: of its box, its table, and their heads."""
    return first_page.rows_of(box(cases)) + len(cases) + HEADS


def _all(cases: Cases) -> Iterator[Block]:
    yield from _checks(cases)
    yield from _barred(cases)
    yield from _frequencies(cases)
    yield from _loads(cases)
    changes = [(name, one.what, one.before, one.after) for name, f in cases.items() for one in _changes(f)]
    titles = "< Case | < What | < In the file | < In this case"
    yield table(titles, changes, "What the cases change of the input file")
    normal = next(iter(cases))
    yield Paragraph(
        f"What follows is the case {normal}, the file as it stands. Each other case has a report of its own."
    )


def _changes(findings: Findings) -> tuple[Change, ...]:
    return () if findings.study.case is None else findings.study.case.changes


def _lines(findings: Findings) -> tuple[Check, ...]:
    return findings.need(Checks).lines if findings.is_answered else ()


def verdict(findings: Findings) -> str:
    """The worst verdict of a case, of which a failure is worse than no answer; empty where nothing judged."""
    worst = min((check.verdict for check in _lines(findings)), key=RANK.__getitem__, default="")
    lacks = not findings.is_answered or any(one.is_named for one in findings.plan.unanswered)
    return NO_ANSWER if lacks and worst not in BAD else worst


def _conclusion(cases: Cases) -> str:
    """The verdict over all cases that are judged, in a sentence."""
    judged = {name: verdict(one) for name, one in cases.items() if one.is_judged}
    doubt, left = _to_be_verified(cases), "".join(f"; {words}" for words in _limits(cases))
    bad = [name for name, one in judged.items() if one in BAD]
    none = [name for name, one in judged.items() if one == NO_ANSWER]
    number_of = counted(len(judged), "case")
    if bad or none:
        words = [f"the train does not satisfy what is judged in {', '.join(bad)}"] if bad else []
        words += [f"there is no answer to {', '.join(none)}"] if none else []
        return f"Of {number_of} judged, {' and '.join(words)}{left}.{doubt}"
    if not any(judged.values()):
        return f"No rule judges any of {number_of}: the report gives results without a verdict."
    if all(one == "pass" for one in judged.values()):
        restricted = ", with the restrictions of speed below" if any(map(_restricts, _judged(cases).values())) else ""
        return f"Every check of every case that is judged passed ({number_of}){restricted}{left}.{doubt}"
    unjudged = ", ".join(name for name, one in judged.items() if not one)
    more = f"; nothing judges {unjudged}" if unjudged else ""
    return f"No check of {number_of} judged failed, but not all are within the range of a rule{more}{left}.{doubt}"


def _left_out(cases: Cases) -> dict[str, tuple[str, ...]]:
    """By case that is judged the rules that others of these have and it has not; none of a case that has them all."""
    rules = {name: [rule for rule, _ in one.study.rules] for name, one in _judged(cases).items()}
    every = dict.fromkeys(rule for named in rules.values() for rule in named)
    found = {name: tuple(rule for rule in every if rule not in named) for name, named in rules.items()}
    return {name: lacking for name, lacking in found.items() if lacking}


def _limits(cases: Cases) -> Iterator[str]:
    """What is not judged in which case: rules that it leaves out, and speeds."""
    for name, rules in _left_out(cases).items():
        yield f"{listed(rules)} not judged in {name}"
    for name, one in _judged(cases).items():
        if one.is_answered and (reached := check_words.reached(one)):
            yield f"{name} judged {reached}"


def _to_be_verified(cases: Cases) -> str:
    """How many limits are, as a sentence; empty where none is."""
    rows = [row for row in side_by_side(cases) if row.each[row.worst].standing == TO_BE_VERIFIED]
    are = "limit is" if len(rows) == 1 else "limits are"
    return f" {len(rows)} {are} to be verified against the edition in force." if rows else ""


def _restricts(findings: Findings) -> bool:
    return findings.is_answered and bool(barred_rpm(findings))


def _overview(cases: Cases) -> Table:
    """One row a case."""
    rows, marks = list[tuple[object, ...]](), list[str]()
    without = {name: f", without {listed(rules)}" for name, rules in _left_out(cases).items()}
    for name, found in cases.items():
        lines, word = _lines(found), verdict(found)
        used = [check for check in lines if check.utilisation is not None]
        most = max(used, key=lambda check: check.utilisation or 0.0, default=None)
        failing = sum(check.fails for check in lines)
        text = word.upper() or "not judged"
        case = found.study.case
        file = f"{case.folder}/report.html" if case is not None and found.is_answered else NONE
        rows.append((
            name, file, len(lines), failing,
            NONE if most is None else number(100.0 * (most.utilisation or 0.0), 4),
            NONE if most is None else f"{most.where}: {symbols(most.clause)}",
            (text + without.get(name, "")) if found.is_judged else f"{text} (information)",
        ))  # fmt: skip
        marks.append(("fail" if word == NO_ANSWER else word) if found.is_judged else "")
    columns = head(
        "< Case -> | < Report | Checks | Not passed -> not passed | Highest utilisation [%] -> highest use, % | "
        "< Of -> | < Verdict ->"
    )
    return table(
        tuple(replace(one, is_files=one.title == "Report") for one in columns), rows,
        "The cases: checks, those whose limit is not kept, and the highest utilisation of a limit", marks=marks,
        short="Cases",
    )  # fmt: skip


@dataclass(frozen=True)
class Row:
    """One check in every case that has it."""

    key: Key
    each: Mapping[str, Check]  # by name of the case
    worst: str  # name of the case

    @property
    def rank(self) -> tuple[float, ...]:
        """Its place among the rows: the worst first."""
        return check_words.rank(self.each[self.worst])


def side_by_side(cases: Cases) -> list[Row]:
    """Every check of every case, those that fail first, then by utilisation; the worst is one that is judged."""
    found: dict[Key, dict[str, Check]] = {}
    for name, findings in cases.items():
        seen = Counter[tuple[str, ...]]()
        for check in _lines(findings):
            plain = (check.rule, check.clause, check.where, check.what)
            found.setdefault((*plain, seen[plain]), {})[name] = check
            seen[plain] += 1
    rows = []
    for key, each in found.items():
        judged = [name for name in each if cases[name].is_judged] or list(each)
        rows.append(Row(key, each, min(judged, key=lambda name: check_words.rank(each[name]))))
    return sorted(rows, key=lambda row: row.rank)


def _checks(cases: Cases) -> Iterator[Table]:
    """Rows are checks, columns cases, the last the worst case; of many cases several tables."""
    rows = side_by_side(cases)
    if not rows:
        return
    names = list(cases)
    for first in range(0, len(names), MOST_COLUMNS):
        shown = names[first : first + MOST_COLUMNS]
        columns = map(texts, ("Check", "Component", "Clause", "Limit", "Unit", *shown, "Worst case"))
        part = f"; cases {first + 1} to {first + len(shown)} of {len(names)}" if len(names) > MOST_COLUMNS else ""
        yield table(
            tuple(columns), [_cells(cases, row, shown) for row in rows],
            "Checks side by side, each at its worst point: value, at which speed of the reference, and in brackets the "
            f"order that contributes most; where the limit differs by case, value / limit{part}",
            marks=[row.each[row.worst].verdict for row in rows],
        )  # fmt: skip


def _cells(cases: Cases, row: Row, shown: Sequence[str]) -> tuple[str, ...]:
    first = next(iter(row.each.values()))
    limits = {check_words.limit(check) for check in row.each.values()}
    limit = limits.pop() if len(limits) == 1 else BY_CASE
    each = [_cell(row.each[name], with_limit=limit == BY_CASE) if name in row.each else _lacking(cases[name], first)
            for name in shown]  # fmt: skip
    most = row.each[row.worst].verdict
    return (f"{first.what} ({first.rule})", first.where, symbols(first.clause), limit, symbols(first.unit), *each,
            f"{row.worst}: {most.upper()}")  # fmt: skip


def _lacking(findings: Findings, check: Check) -> str:
    """Of a case that has not such a check: that it names not the rule of it, else nothing."""
    return NOT_JUDGED if check.rule in RULES and check.rule not in dict(findings.study.rules) else NONE


def _cell(check: Check, *, with_limit: bool) -> str:
    """The worst value of a check, where it stands, and its verdict where that is no pass."""
    text = check_words.value(check)
    text += f" / {check_words.limit(check)}" if with_limit else ""
    text += "" if check.speed is None else f" at {rpm(check.speed)} rpm"
    text += "" if check.order is None else f" ({exact(check.order)})"
    return text if check.verdict == "pass" else f"{text} {check.verdict.upper()}"


def _barred(cases: Cases) -> Iterator[Table]:
    """The barred ranges of every case; nothing where there is none."""
    rows = [
        (name, rpm(low / RPM), rpm(high / RPM))
        for name, found in cases.items()
        for low, high in (barred_rpm(found) if found.is_answered else ())
    ]
    if rows:
        titles = "< Case -> | From [rpm] -> from rpm | To [rpm] -> to rpm"
        caption = "Ranges barred for continuous operation in the cases"
        yield table(titles, rows, caption, short="Barred ranges of the cases")


def _frequencies(cases: Cases) -> Iterator[Block]:
    """Natural frequencies of every case, one row each, and over the cases; those of the damped train where it damps."""
    found = {name: one.need(Modes).frequency for name, one in cases.items() if one.get(Modes) is not None}
    damped = {name: one.need(DampedModes).frequency for name, one in cases.items() if one.get(DampedModes) is not None}
    yield from _frequency_table(found, "Natural frequencies of the cases")
    yield from _frequency_table(damped, "Damped natural frequencies of the cases")
    count = _shown(found)
    if len(found) > 1 and count:
        values = np.full((len(found), count), np.nan)
        for row, one in zip(values, found.values(), strict=True):
            row[: min(count, len(one))] = one[:count]
        yield case_curves.frequencies("case-frequencies", "Natural frequencies of the cases", list(found), values)


def _shown(found: Mapping[str, FloatArray]) -> int:
    """How many modes are shown."""
    return min(max((len(one) for one in found.values()), default=0), MOST_MODES)


def _frequency_table(found: Mapping[str, FloatArray], caption: str) -> Iterator[Table]:
    """found: (modes,) Hz by case."""
    if count := _shown(found):
        columns = (texts("Case"), *(Column(f"Mode {k + 1}", "Hz") for k in range(count)))
        rows = [(name, *_padded([number(f, 7) for f in one.tolist()], count)) for name, one in found.items()]
        yield table(columns, rows, caption)


def _padded(cells: list[str], count: int) -> list[str]:
    return (cells + [NONE] * count)[:count]


def _loads(cases: Cases) -> Iterator[Figure]:
    """The most stressed shaft, and the coupling nearest to its rating, else the largest torque, in every case."""
    from torsion.output.chapters.component_loads import stress_curves

    answered = {name: one for name, one in cases.items() if one.is_answered and responds(one)}
    stresses: Loads = {}
    for name, found in answered.items():
        for bar in found.study.train.bars:
            curve = stress_curves(found, bar)
            stresses.setdefault(bar.name, {})[name] = (curve.speed * RPM, curve.stress)
    if stresses:
        most = _largest(stresses)
        caption = f"Vibratory shear stress of {most} in the cases (half range of the synthesis)"
        yield case_curves.curves("case-stress", caption, stresses[most], "shear stress amplitude", "N/mm²")
    rated, loads = _torques(answered)
    if rated or (loads and not stresses):
        most = _largest(rated or loads)
        unit = torques(values for _, values in loads[most].values())
        drawn = {name: (speed, values * unit.factor) for name, (speed, values) in loads[most].items()}
        caption = f"Vibratory torque in {most} in the cases (half range of the synthesis)"
        yield case_curves.curves("case-torque", caption, drawn, "torque amplitude", unit.unit)


def _torques(answered: Cases) -> tuple[Loads, Loads]:
    """Over rpm: of couplings with a rating the torque as a share of it; of every element but shafts that in N m."""
    rated: Loads = {}
    loads: Loads = {}
    for name, found in answered.items():
        speed = found.need(Response).speed * RPM
        for element in elements(found.system):
            ratings = found.study.train.parts[element.part].ratings
            values = synthesis(found, element.spans)
            if element.kind != "shaft":
                loads.setdefault(element.name, {})[name] = (speed, values)
            if ratings is not None and ratings.vibratory_torque:
                rated.setdefault(element.name, {})[name] = (speed, values / ratings.vibratory_torque)
    return rated, loads


def _largest(loads: Loads) -> str:
    """The name whose curves reach highest."""
    return max(loads, key=lambda name: max(highest(values) for _, values in loads[name].values()))
