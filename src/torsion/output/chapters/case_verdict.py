"""The cases of a file: one row a case, and every check in all cases."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from torsion.output import check_words
from torsion.output.blocks import Table, table
from torsion.output.headline import Cases, case_verdict, lines_of, omitted_rules
from torsion.output.numbers import NONE, symbols
from torsion.results import listed
from torsion.rules.verdict_line import WORDS, Check


def overview(cases: Cases) -> Table:
    """Return one row a case: its checks, its highest utilisation and its verdict."""
    rows, marks = list[tuple[object, ...]](), list[str]()
    omitted = {name: f", without {listed(rules)}" for name, rules in omitted_rules(cases).items()}
    for name, findings in cases.items():
        checks, word, case = lines_of(findings), case_verdict(findings), findings.study.case
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

    @property
    def check(self) -> Check:
        """The check of the worst case."""
        return self.checks[self.worst]


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
        rows.append(Row(checks, min(names, key=lambda name: check_words.rank(checks[name]))))
    return sorted(rows, key=lambda row: check_words.rank(row.check))
