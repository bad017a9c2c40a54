"""A check in the words of the report: its rank, value, limit, utilisation, order and sign, and how much it uses."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Paragraph
from torsion.output.figures.figure import Grade, Use
from torsion.output.numbers import NONE, counted, given, given_rpm, number, order, symbols
from torsion.results import listed
from torsion.rules.verdict_line import KINDS, WORDS, Basis, Check, Checks, Verdict

SIGNS: Mapping[Verdict, str] = {
    "pass": "✓",
    "restricted": "!",
    "not judged": "?",
    "fail": "✗",
    "not kept": "✗",
}
STRESS, TORQUE = "N/mm2", "N m"  # units of the checks of a stress and of a torque
GRADES: tuple[tuple[float, Grade], ...] = (  # of a pass, below
    (0.5, "low"),
    (0.8, "middle"),
    (math.inf, "high"),
)
NEAR = (0.99, 1.01)  # shares of a limit that have more digits, so that none over it reads 100 %
LEAST_LISTED = 0.1  # utilisation of the listed checks that pass
FEWEST_ROWS = 5  # are listed anyway
NOT_JUDGED = Use("not judged", "", (3.0, 0.0))


def rank(check: Check) -> tuple[float, ...]:
    """Return the sort key of reports: failing checks, then what is not judged, then by falling utilisation.

    A limit that is not kept and of which no share is known, as of 0, is infinitely exceeded: by falling excess.
    """
    used, excess = check.utilisation, abs(check.value - check.limit)
    order = {"fail": 0.0, "not kept": 1.0, "not judged": 1.5}.get(check.verdict, 2.0)
    if used is None:
        used = math.inf if check.fails else -math.inf
    return order, -used, -excess if math.isinf(used) and not math.isnan(excess) else 0.0


def is_listed(check: Check, row: int) -> bool:
    """Return whether it stands in the table of checks, in this row of the ranked checks."""
    is_small = check.utilisation is not None and check.utilisation < LEAST_LISTED
    return row < FEWEST_ROWS or check.verdict != "pass" or not is_small


def omitted(count: int) -> Paragraph:
    """Return the sentence about checks that a table leaves out."""
    return Paragraph(
        f"{counted(count, 'more check')} below {100 * LEAST_LISTED:g} % of the limit in results.json."
    )


def quoted(name: str) -> str:
    """Return a name in a list, in quotes where it holds what parts the names of the list."""
    return f'"{name}"' if "," in name else name


def value(check: Check) -> str:
    """Return the worst value, in words where there is none."""
    if np.isnan(check.value):
        return NONE
    nothing = "no solution" if check.clause == "stability" else "no finite value"
    return nothing if np.isinf(check.value) else number(check.value)


def limit(check: Check) -> str:
    """Return the limit, of a least value with its sign."""
    if np.isnan(check.limit):
        return "none"
    return ("≥ " if check.at_least else "") + given(check.limit)


def against(check: Check) -> str:
    """Return value and limit in words: "90.0 mm, required 98.7 mm or more" or "45.1, permissible 33.2 N/mm²"."""
    in_unit = f" {unit(check)}".rstrip()
    words = value(check) + in_unit * bool(np.isfinite(check.value))
    if np.isnan(check.limit):
        return f"{words}, no limit"
    kind, addition = ("required", " or more") if check.at_least else ("permissible", "")
    return f"{words}, {kind} {given(check.limit)}{in_unit}{addition}"


def basis(check: Check) -> str:
    """Return where the limit is from, in words."""
    return (check.basis or Basis(KINDS[check.standing])).words


def editions(checks: Iterable[Check]) -> str:
    """Return rule and edition of the text that each rule's limits follow, as a sentence; empty if there is none."""
    texts = dict.fromkeys(
        f"{check.rule}: {check.basis.edition}"
        for check in checks
        if check.basis is not None and check.basis.edition
    )
    return f"Texts of the rules: {'; '.join(texts)}." if texts else ""


def percent(used: float) -> str:
    """Return the share of a limit: '63.2 %', '0 %'; no share above 1 reads 100 %, and none below it."""
    return f"{number(100.0 * used, 5 if NEAR[0] <= used <= NEAR[1] else 3)} %"


def unreached(findings: Findings) -> str:
    """Return the speeds that rules demand and that were not judged, as a sentence; empty where there are none."""
    demanded = dict[str, dict[str, None]]()
    for check in findings.need(Checks).lines:
        reach = check.reach
        if reach is not None and check.verdict == "not judged":
            words = f"{given_rpm(reach.last)} to {given_rpm(reach.demanded)}"
            if reach.demanded < reach.first:
                words = f"below {given_rpm(reach.first)}"
            demanded.setdefault(words, {})[check.rule] = None
    ranges = (f"{ends} rpm, required by {listed(rules)}" for ends, rules in demanded.items())
    return f"Not checked: {'; '.join(ranges)}. Extend operation.speeds." if demanded else ""


def unit(check: Check) -> str:
    """Return the unit with its signs; empty for a pure number."""
    return "" if check.unit in ("", "1") else symbols(check.unit)


def contributing(findings: Findings, excited: Fraction | None) -> str:
    """Return an order by what excites it, where that is known."""
    response = findings.get(Response)
    lines = () if response is None or excited is None else response.lines
    return next(
        (line.named(findings.study.reference) for line in lines if line.order == excited),
        order(excited),
    )


def use(check: Check) -> Use:
    """Return how much of its limit a check uses, as sign, verdict and share."""
    used = check.utilisation
    share = "" if used is None or math.isinf(used) else f" {percent(used)}"
    words = f"{SIGNS[check.verdict]} {WORDS[check.verdict]}{share}"
    if check.verdict == "not judged" or not check.has_limit:
        return replace(NOT_JUDGED, words=words)
    if check.fails:
        grade: Grade = "over" if math.isfinite(check.value) else "no answer"
        return Use(grade, words, rank(check), SIGNS["fail"])
    return Use(next(grade for upper, grade in GRADES if (used or 0.0) < upper), words, rank(check))


def use_of_part(checks: Iterable[Check]) -> Use:
    """Return the worst use of stress or torque of a component; another limit that it does not keep in words alone."""
    ranked = sorted((check for check in checks if check.has_limit), key=rank)
    strain = next((check for check in ranked if check.unit in (STRESS, TORQUE)), None)
    graded = NOT_JUDGED if strain is None else use(strain)
    failing = use_of_joint(check for check in ranked if check.unit not in (STRESS, TORQUE))
    if failing is None:
        return graded
    words = "\n".join(filter(None, (graded.words, failing.words)))
    return Use(graded.grade, words, min(graded.rank, failing.rank), failing.mark)


def use_of_joint(checks: Iterable[Check]) -> Use | None:
    """Return the worst limit of any kind that a joint does not keep; None where it keeps all."""
    worst = min((check for check in checks if check.fails), key=rank, default=None)
    if worst is None:
        return None
    exceeded = use(worst)
    return replace(exceeded, words=f"{exceeded.words}:\n{symbols(worst.clause)}")
