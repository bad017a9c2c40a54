"""Chapter: the verdict over all cases of a file, and the checks of each beside those of the others."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from torsion.findings import Findings
from torsion.output import check_words, headline
from torsion.output.blocks import Block, Box, Heading, Table, head, table
from torsion.output.chapters import first_page
from torsion.output.chapters.first_page import sweep_line, worst, worst_line
from torsion.output.check_words import SIGNS
from torsion.output.numbers import NONE, counted, number, symbols
from torsion.output.reported_values import band_words, barred_rpm
from torsion.results import listed
from torsion.rules.verdict_line import TO_BE_VERIFIED, WORDS, Check, Checks, Verdict

MOST_NAMED = 4  # cases in the headline
HEADS = 8  # rows of the first page for the heads of the box, of the table and of the chapter
ALL = {2: "both cases"}
Cases = Mapping[str, Findings]
Key = tuple[str, str, str, str, int]  # rule, clause, component, what, which of several


def over_all(findings: Findings) -> Iterator[Block]:
    """Before all else: the verdict over all cases; nothing of a file without."""
    if findings.cases:
        yield Heading("Verdict over all cases", at_end=True)
        yield box(findings.each)
        yield _overview(findings.each)


def box(cases: Cases) -> Box:
    """The worst verdict of those that are judged, in which case, why, and what has no answer."""
    lines = [("Conclusion", _conclusion(cases))]
    found = {name: check for name, one in judged(cases).items() if one.is_answered if (check := worst(one))}
    if found:
        name = min(found, key=lambda name: check_words.rank(found[name]))
        lines += [(title, f"case {name}, {text}") for title, text in worst_line(cases[name])]
    swept = [f"{name}: {text}" for name, f in judged(cases).items() if f.is_answered for _, text in sweep_line(f)]
    if swept:
        lines.append(("Sweep", "; ".join(swept)))
    unknown = [f"{name}: {one.what}, because {one.words}" for name, f in cases.items() for one in f.plan.unanswered]
    bands = {name: barred_rpm(one) for name, one in judged(cases).items() if _restricts(one)}
    if bands:
        each = (f"{name}: {', '.join(map(band_words, found))}" for name, found in bands.items())
        lines.append(("Barred ranges", "; ".join(each)))
    if unknown:
        lines.append(("No answer", "; ".join(unknown)))
    if left := [name for name, one in cases.items() if not one.is_judged]:
        lines.append(("For information", f"{', '.join(left)}: no part of this verdict"))
    (sign, words), kind = headline_of_cases(cases)
    return Box(sign, words, kind, tuple(lines))


def headline_of_cases(cases: Cases) -> tuple[headline.Head, headline.Kind]:
    """The worst verdict of the cases that are judged, and of which they are; PASS only where all of them pass."""
    named = {
        name: one for name, one in judged(cases).items() if one.study.rules or lines_of(one) or not one.is_answered
    }
    each = {name: verdict(one) for name, one in (named or judged(cases)).items()}
    worst = next(word for word in WORDS if word in each.values())
    of = [name for name, word in each.items() if WORDS[word] == WORDS[worst]]
    if len(each) == 1:
        which = _named(of)
    elif len(of) < len(each):
        which = f"{_named(of[:MOST_NAMED])} ({len(of)} of {len(each)})"
    else:
        which = ALL.get(len(of), f"all {len(of)} cases")
    left = "".join(f", without {listed(rules)} in case {name}" for name, rules in left_out(cases).items())
    if left and worst == "pass":  # a rule that one case leaves out is no whole pass
        worst = "restricted"
    return (SIGNS[worst], f"{WORDS[worst]}: {which}{left}"), headline.KINDS[worst]


def judged(cases: Cases) -> Cases:
    """Those that count for the verdict."""
    return {name: one for name, one in cases.items() if one.is_judged}


def rows_of_first_page(cases: Cases) -> int:
    """Rows that the verdict over all cases takes of the first page: of its box, its table, and their heads."""
    return first_page.rows_of(box(cases)) + len(cases) + HEADS


def lines_of(findings: Findings) -> tuple[Check, ...]:
    """The checks of a case; none of one without an answer."""
    return findings.need(Checks).lines if findings.is_answered else ()


def verdict(findings: Findings) -> Verdict:
    """Return the worst verdict of a case; what has no answer is not judged."""
    return headline.verdict(findings) if findings.is_answered else "not judged"


def _conclusion(cases: Cases) -> str:
    """The verdict over all cases that are judged, in a sentence."""
    each = {name: verdict(one) for name, one in cases.items() if one.is_judged}
    doubt, left = _to_be_verified(cases), "".join(f"; {words}" for words in _limits(cases))
    bad = [name for name, word in each.items() if WORDS[word] == "FAIL"]
    none = [name for name, word in each.items() if word == "not judged" and _lacks_answer(cases[name])]
    open_cases = [name for name, word in each.items() if word == "not judged" and name not in none]
    number_of = counted(len(each), "case")
    if bad or none or open_cases:
        words = [f"the train does not satisfy what is judged in {_named(bad)}"] if bad else []
        words += [f"there is no answer to {_named(none)}"] if none else []
        words += [f"something is not judged in {_named(open_cases)}"] if open_cases else []
        return f"Of {number_of} judged, {' and '.join(words)}{left}.{doubt}"
    restricted = ", with the restrictions of its report" if "restricted" in each.values() else ""
    return f"Every check of every case that is judged passed ({number_of}){restricted}{left}.{doubt}"


def _lacks_answer(findings: Findings) -> bool:
    return not findings.is_answered or any(one.is_named for one in findings.plan.unanswered)


def _named(cases: Sequence[str]) -> str:
    """The cases, so that their names are not read as words of the sentence."""
    return f"{'case' if len(cases) == 1 else 'cases'} {', '.join(cases)}"


def left_out(cases: Cases) -> dict[str, tuple[str, ...]]:
    """By case that is judged the rules that others of these have and it has not; none of a case that has them all."""
    rules = {name: [rule for rule, _ in one.study.rules] for name, one in judged(cases).items()}
    every = dict.fromkeys(rule for named in rules.values() for rule in named)
    found = {name: tuple(rule for rule in every if rule not in named) for name, named in rules.items()}
    return {name: lacking for name, lacking in found.items() if lacking}


def _limits(cases: Cases) -> Iterator[str]:
    """What is not judged in which case: rules that it leaves out, and speeds."""
    for name, rules in left_out(cases).items():
        yield f"case {name} without {listed(rules)}"
    for name, one in judged(cases).items():
        if one.is_answered and (reached := check_words.reached(one)):
            yield f"case {name} judged {reached}"


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
    without = {name: f", without {listed(rules)}" for name, rules in left_out(cases).items()}
    for name, found in cases.items():
        lines, word = lines_of(found), verdict(found)
        used = [check for check in lines if check.utilisation is not None]
        most = max(used, key=lambda check: check.utilisation or 0.0, default=None)
        failing = sum(check.fails for check in lines)
        text = WORDS[word] if found.is_answered else f"{WORDS[word]}: no answer"
        case = found.study.case
        file = f"{case.folder}/report.html" if case is not None and found.is_answered else NONE
        rows.append((
            name, file, len(lines), failing,
            NONE if most is None else number(100.0 * (most.utilisation or 0.0), 4),
            NONE if most is None else f"{most.where}: {symbols(most.clause)}",
            (text + without.get(name, "")) if found.is_judged else f"{text} (information)",
        ))  # fmt: skip
        marks.append(word if found.is_judged else "")
    columns = head(
        "< Case -> | < Report | Checks | Not passed -> not passed | Highest utilisation [%] -> highest use, % | "
        "< Of -> | < Verdict ->"
    )
    return table(
        tuple(replace(one, is_files=one.title == "Report") for one in columns), rows,
        "The cases: checks, those that fail, and the highest utilisation of a limit", marks=marks,
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
        for check in lines_of(findings):
            plain = (check.rule, check.clause, check.where, check.what)
            found.setdefault((*plain, seen[plain]), {})[name] = check
            seen[plain] += 1
    rows = []
    for key, each in found.items():
        counted_in = [name for name in each if cases[name].is_judged] or list(each)
        rows.append(Row(key, each, min(counted_in, key=lambda name: check_words.rank(each[name]))))
    return sorted(rows, key=lambda row: row.rank)
