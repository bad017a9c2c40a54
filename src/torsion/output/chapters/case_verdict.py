"""The cases of a file: one row a case, and every check in all cases."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace

from torsion.output import check_words
from torsion.output.blocks import Table, head, table
from torsion.output.headline import Cases, case_verdict, lines_of, omitted_rules
from torsion.output.numbers import NONE, number, symbols
from torsion.results import listed
from torsion.rules.verdict_line import WORDS, Check

Key = tuple[str, str, str, str, int]  # rule, clause, component, what, which of several


def overview(cases: Cases) -> Table:
    """Return one row a case: its checks, its highest utilisation and its verdict."""
    rows, marks = list[tuple[object, ...]](), list[str]()
    omitted = {name: f", without {listed(rules)}" for name, rules in omitted_rules(cases).items()}
    for name, findings in cases.items():
        checks, word = lines_of(findings), case_verdict(findings)
        with_limit = [check for check in checks if check.utilisation is not None]
        highest = max(with_limit, key=lambda check: check.utilisation or 0.0, default=None)
        text = WORDS[word] if findings.is_answered else f"{WORDS[word]}: not computed"
        case = findings.study.case
        rows.append(
            (
                name,
                f"{case.folder}/report.html" if case is not None and findings.is_answered else NONE,
                len(checks),
                sum(check.fails for check in checks),
                NONE if highest is None else number(100.0 * (highest.utilisation or 0.0), 4),
                NONE if highest is None else f"{highest.where}: {symbols(highest.clause)}",
                (text + omitted.get(name, "")) if findings.is_judged else f"{text} (information)",
            )
        )
        marks.append(word if findings.is_judged else "")
    columns = head(
        "< Case -> | < Report | Checks | Failed -> failed | Highest utilisation [%] -> util., % | "
        "< Component and clause -> component | < Verdict ->"
    )
    return table(
        tuple(replace(column, is_files=column.title == "Report") for column in columns),
        rows,
        "Cases of the model file",
        marks=marks,
        short="Cases",
        rows_in_summary=4,
    )


@dataclass(frozen=True)
class Row:
    """One check in every case that has it."""

    key: Key
    each: Mapping[str, Check]  # by name of the case
    worst: str  # name of the case

    @property
    def check(self) -> Check:
        """The worst of its checks."""
        return self.each[self.worst]

    @property
    def rank(self) -> tuple[float, ...]:
        """Sort key: the worst check first."""
        return check_words.rank(self.check)


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
