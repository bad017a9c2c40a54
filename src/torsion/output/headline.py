"""The headline of a report: the one word of the verdict, and one clause."""

from collections.abc import Mapping
from typing import Literal

import numpy as np

from torsion.analyses.sweep.sweep_results import Sweep
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.check_words import SIGNS
from torsion.output.numbers import rpm
from torsion.output.reported_values import band_words, barred_rpm
from torsion.rules.verdict_line import WORDS, Checks, Verdict, worst_verdict

Head = tuple[str, str]  # sign, words
Kind = Literal["pass", "fail", "note"]
KINDS: Mapping[Verdict, Kind] = {
    "pass": "pass", "restricted": "note", "not judged": "note", "fail": "fail", "not kept": "fail",
}  # fmt: skip


def verdict(findings: Findings) -> Verdict:
    """Return the worst verdict of the checks, of a comparison, fit or sweep that fails, and of missing answers."""
    checks, sweep = findings.need(Checks).lines, findings.get(Sweep)
    if any(getattr(findings.results.get(name), "fails", False) for name in ("check", "fit", "sweep")):
        return "fail"
    worst = worst_verdict(checks)
    if findings.plan.unanswered and WORDS[worst] != "FAIL":
        return "not judged"
    return "restricted" if worst == "pass" and sweep is not None and sweep.is_partial else worst


def failing_share(sweep: Sweep) -> str:
    """How many variants of a sweep fail, where the file permits fewer or says nothing of them, as a clause."""
    share = f"{100.0 * sweep.share_failing:.3g} % of the variants fail a check"
    return share if sweep.fail_at_most is None else f"{share}, {100.0 * sweep.fail_at_most:.3g} % are permitted"


def headline(findings: Findings) -> tuple[Head, Kind]:
    """Sign and words of the verdict with one clause, and how it stands out."""
    word = verdict(findings)
    return (SIGNS[word], f"{WORDS[word]}: {_clause(findings, word)}"), KINDS[word]


def _clause(findings: Findings, word: Verdict) -> str:
    """Why the verdict is what it is."""
    checks = sorted(findings.need(Checks).lines, key=check_words.rank)
    first = next((check for check in checks if WORDS[check.verdict] == WORDS[word]), None)
    sweep = findings.get(Sweep)
    partial_pass = word == "restricted" and sweep is not None and sweep.is_partial
    if sweep is not None and (partial_pass or (first is None and sweep.fails)):
        return failing_share(sweep)
    if first is None and word == "fail":
        return "the comparison of the models, or the fit to measurements"
    if word == "not judged" and findings.plan.unanswered:
        return "an analysis without an answer"
    if first is None:
        return "no rule judges this train" if findings.study.rules else "no rule is named"
    if word == "pass":
        return "1 limit met" if len(checks) == 1 else f"{len(checks)} limits met"
    if word == "restricted":
        bands = barred_rpm(findings)
        return f"barred range {', '.join(map(band_words, bands))}" if bands else next(iter(first.restrictions))
    used, speed = first.utilisation, "" if first.speed is None else f" at {rpm(first.speed)} rpm"
    share = (
        "" if used is None or np.isinf(used) or word == "not judged" else f" {check_words.percent(used)} of its limit"
    )
    return f"{first.what}, {first.where}{share}{speed} ({first.rule})"
