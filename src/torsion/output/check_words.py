"""A check in the words of the report: its rank, value, limit, utilisation, order and sign, and how much it uses."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.figures.figure import Grade, Use
from torsion.output.numbers import NONE, given, given_rpm, number, order, symbols
from torsion.output.reported_values import reference
from torsion.results import listed
from torsion.rules.reached_speeds import BEGINS, reach_words
from torsion.rules.verdict_line import WORDS, Check, Checks, Standing, Verdict

SIGNS: Mapping[Verdict, str] = {
    "pass": "✓",
    "restricted": "!",
    "not judged": "?",
    "fail": "✗",
    "not kept": "✗",
}
BASIS: Mapping[Standing, str] = {
    "rule text": "rule text",
    "confirmed": "confirmed",
    "to be verified": "edition not confirmed",
    "maker": "manufacturer",
    "setting": "stated by user",
    "by definition": "by definition",
}
STRESS, TORQUE = "N/mm2", "N m"  # units of the checks of a stress and of a torque
GRADES: tuple[tuple[float, Grade], ...] = (
    (0.5, "low"),
    (0.8, "middle"),
    (math.inf, "high"),
)  # of a pass, below
NEAR = (0.99, 1.01)  # shares of a limit that have more digits, so that none over it reads 100 %
LEAST_LISTED, FEWEST_ROWS = (
    0.1,
    5,
)  # utilisation of the listed checks that pass; so many rows are listed anyway
SMALL = f"{100 * LEAST_LISTED:g} % of the limit"
NOT_JUDGED = Use("not judged", "", (3.0, 0.0))


def rank(check: Check) -> tuple[float, ...]:
    """Failing checks first, then what is not judged, then by falling utilisation.

    A limit that is not kept and of which no share is known, as of 0, is infinitely exceeded: by falling excess.
    """
    used, excess = check.utilisation, abs(check.value - check.limit)
    order = {"fail": 0.0, "not kept": 1.0, "not judged": 1.5}.get(check.verdict, 2.0)
    if used is None:
        used = math.inf if check.fails else -math.inf
    return order, -used, -excess if math.isinf(used) and not math.isnan(excess) else 0.0


def is_listed(check: Check, row: int) -> bool:
    """It stands in the table of checks, in this row of the ranked checks; a small utilisation does not."""
    small = check.utilisation is not None and check.utilisation < LEAST_LISTED
    return row < FEWEST_ROWS or check.verdict != "pass" or not small


def is_judged(check: Check) -> bool:
    """It counts for the verdict."""
    return check.has_limit


def quoted(name: str) -> str:
    """A name in a list, in quotes where it holds what parts the names of the list."""
    return f'"{name}"' if "," in name else name


def about(checks: Iterable[Check]) -> Iterable[str]:
    """What checks are about, each once, as names in a list; a check of several parts lists them itself."""
    return dict.fromkeys(one.where if len(one.parts) > 1 else quoted(one.where) for one in checks)


def value(check: Check) -> str:
    """The worst value, in words where there is none."""
    if np.isnan(check.value):
        return NONE
    nothing = "no solution" if check.clause == "stability" else "no finite value"
    return nothing if np.isinf(check.value) else number(check.value)


def limit(check: Check) -> str:
    """The limit, of a least value with its sign."""
    return (
        "none" if np.isnan(check.limit) else ("≥ " if check.at_least else "") + given(check.limit)
    )


def against(check: Check) -> str:
    """Return value and limit in words: "90.0 mm, required 98.7 mm or more" or "45.1, permissible 33.2 N/mm²"."""
    in_unit = f" {unit(check)}".rstrip()
    words = value(check) + in_unit * bool(np.isfinite(check.value))
    if np.isnan(check.limit):
        return f"{words}, no limit"
    if check.at_least:
        return f"{words}, required {given(check.limit)}{in_unit} or more"
    return f"{words}, permissible {given(check.limit)}{in_unit}"


def basis(check: Check) -> str:
    """Return where the limit is from, in words."""
    if check.basis is not None and check.basis.kind == "confirmed":
        return check.basis.words.rpartition(": ")[2]
    return BASIS[check.standing]


def editions(checks: Iterable[Check]) -> str:
    """Return rule and edition of the text that each rule's limits follow, as a sentence; empty if there is none."""
    texts = dict.fromkeys(
        f"{check.rule}: {check.basis.edition}"
        for check in checks
        if check.basis is not None and check.basis.kind in ("text", "confirmed", "unconfirmed")
    )
    return f"Texts of the rules: {'; '.join(texts)}." if texts else ""


def percent(used: float) -> str:
    """The share of a limit: '63.2 %', '0 %'; no share above 1 reads 100 %, and none below it."""
    return f"{number(100.0 * used, 5 if NEAR[0] <= used <= NEAR[1] else 3)} %"


def reached(findings: Findings) -> str:
    """Which speeds the checks of a study stand on, where a rule demands more; empty where none does."""
    known = [check.reach for check in findings.need(Checks).lines if check.reach is not None]
    point = findings.study.operation.rated
    if not known or point is None:
        return ""
    if reach_words(least := min(known, key=lambda one: one.last), point.speed).startswith(BEGINS):
        return f"from {given_rpm(least.first)} rpm only"
    return f"up to {given_rpm(least.last)} rpm only"


def unreached(findings: Findings) -> str:
    """What rules demand and was not judged, as a sentence; empty where nothing is."""
    point, demanded = findings.study.operation.rated, dict[str, list[str]]()
    for check in findings.need(Checks).lines:
        if check.reach is not None and point is not None and check.verdict == "not judged":
            first, last, end = map(
                given_rpm, (check.reach.first, check.reach.last, check.reach.demanded)
            )
            begins = reach_words(check.reach, point.speed).startswith(BEGINS)
            ends = f"below {first}" if begins else f"{last} to {end}"
            rules = demanded.setdefault(f"{ends} rpm", [])
            rules += [check.rule] if check.rule not in rules else []
    each = "; ".join(f"{ends}, required by {listed(rules)}" for ends, rules in demanded.items())
    return f"Not checked: {each}. Extend `operation.speeds`.".replace("`", "") if demanded else ""


def unit(check: Check) -> str:
    """With its signs; empty for a pure number."""
    return "" if check.unit in ("", "1") else symbols(check.unit)


def contributing(findings: Findings, of: Fraction | None) -> str:
    """An order by what excites it, where that is known."""
    response = findings.get(Response)
    lines = () if response is None or of is None else response.lines
    return next((line.named(reference(findings)) for line in lines if line.order == of), order(of))


def use(check: Check) -> Use:
    """How much of its limit a check uses, as sign, verdict and share."""
    used = check.utilisation
    share = "" if used is None or math.isinf(used) else f" {percent(used)}"
    words = f"{SIGNS[check.verdict]} {WORDS[check.verdict]}{share}"
    if check.verdict == "not judged" or not is_judged(check):
        return Use("not judged", words, (3.0, 0.0))
    if check.fails:
        return Use(
            "over" if math.isfinite(check.value) else "no answer", words, rank(check), SIGNS["fail"]
        )
    return Use(next(grade for most, grade in GRADES if (used or 0.0) < most), words, rank(check))


def use_of_part(checks: Iterable[Check]) -> Use:
    """Of all checks of a component: its worst of stress or torque; others that keep no limit in words alone."""
    every = sorted(filter(is_judged, checks), key=rank)
    strain = [one for one in every if one.unit in (STRESS, TORQUE)]
    others = [one for one in every if one.fails and one.unit not in (STRESS, TORQUE)]
    found = use(strain[0]) if strain else NOT_JUDGED
    if not others:
        return found
    more = f"{use(others[0]).words}:\n{symbols(others[0].clause)}"
    words = f"{found.words}\n{more}" if found.words else more
    worst = use(min((*strain[:1], others[0]), key=rank))
    return Use(found.grade, words, worst.rank, worst.mark)


def use_of_joint(checks: Iterable[Check]) -> Use | None:
    """The worst limit of any kind that a joint does not keep; None where it keeps all."""
    worst = min((one for one in checks if one.fails), key=rank, default=None)
    if worst is None:
        return None
    found = use(worst)
    return replace(found, words=f"{found.words}:\n{symbols(worst.clause)}")
