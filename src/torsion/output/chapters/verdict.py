"""Chapter: the verdict of every rule in one table, the conclusion and the restrictions of speed."""

from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.compare.side_by_side import Compared
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, head, on_terminal
from torsion.output.chapters.model_comparison import conclusion as compared_models
from torsion.output.numbers import RPM, given, number, order, rpm
from torsion.output.reported_values import band_words, barred_rpm, failed, unreliable
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, Checks

if TYPE_CHECKING:
    from torsion.analyses.motion.stability_over_speed import Stability

COLUMNS = head(
    "< Check | < Component -> | < Clause -> check | Worst value -> value | Limit -> | < Unit -> | "
    "At speed [rpm] -> at rpm | Order | < Limit from -> | < Verdict ->"
)


def chapter(findings: Findings) -> list[Block]:
    """The verdict comes first in every report."""
    blocks: list[Block] = [Heading("Verdict", at_end=True)]
    checks = findings.need(Checks).lines
    if checks:
        caption = "Checks against the rules, each at its worst point; without an order: all orders together, or none"
        rows, marks = tuple(_row(check) for check in checks), tuple(check.verdict for check in checks)
        blocks.append(Table(COLUMNS, rows, caption, marks, "Checks, each at its worst point"))
    blocks.extend(on_terminal(conclusion(findings)))
    notes = _notes(findings)
    if notes:
        blocks.extend([Heading("Remarks on the checks", 2), Points(notes)])
    return blocks


def judged(findings: Findings) -> list[Block]:
    """The same; nothing where no rule judged."""
    return chapter(findings) if findings.need(Checks).lines else []


def conclusion(findings: Findings) -> list[Block]:
    """The conclusion, that of the comparison of models, and the restrictions of speed, in plain sentences."""
    blocks: list[Block] = [_overall(findings)]
    for one in findings.plan.unanswered:
        blocks.append(Paragraph(f"No answer: {one.what}, because {one.words}.", "fail"))
    compared = findings.get(Compared)
    if compared is not None:
        blocks.append(compared_models(compared))
    if findings.results.get("periodic") is not None:
        from torsion.output.first_order_and_exact import first_order_judged

        text = first_order_judged(findings)
        blocks += [Paragraph(text, "note")] if text else []
    restrictions = _restrictions(findings)
    if restrictions:
        blocks.append(Points(restrictions))
    return blocks


def _row(check: Check) -> tuple[str, ...]:
    sign = "≥ " if check.at_least else ""
    limit = "none" if np.isnan(check.limit) else sign + given(check.limit)
    nothing = "no answer" if check.clause == "stability" else "no finite value"
    value = nothing if np.isinf(check.value) else number(check.value)
    what = f"{check.what} ({check.rule})"
    unit = check.unit.replace("mm2", "mm²").replace("s2", "s²")
    at = rpm(check.speed), order(check.order)
    return what, check.where, check.clause, value, limit, unit, *at, check.standing, check.verdict.upper()


def _overall(findings: Findings) -> Paragraph:
    checks, bad, doubt = findings.need(Checks).lines, failed(findings), _to_be_verified(findings.need(Checks).lines)
    if not checks:
        text = "No rule was requested, or none applies to this train: the report gives results without a verdict."
        return Paragraph(text, "note")
    if bad:
        where = ", ".join(dict.fromkeys(check.where for check in bad))
        text = f"{_bad(checks)} ({where}). The train does not satisfy {_requested(findings)}.{doubt}"
        return Paragraph(text, "fail")
    if any(check.verdict != "pass" for check in checks):
        return Paragraph(f"No check failed: {_count(checks)}.{doubt}", "note")
    restricted = " with the restrictions of speed below" if barred_rpm(findings) else ""
    passed = "The only check" if len(checks) == 1 else f"All {len(checks)} checks"
    return Paragraph(f"{passed} passed: the train satisfies {_requested(findings)}{restricted}.{doubt}", "pass")


def _bad(checks: tuple[Check, ...]) -> str:
    """How many checks failed, and how many limits that are to be verified are not kept, in words."""
    failed, not_kept = (sum(check.verdict == verdict for check in checks) for verdict in ("fail", "not kept"))
    if len(checks) == 1:
        return "The only check failed" if failed else "The limit of the only check is not kept"
    if not failed:
        limits, are = ("limit", "is") if not_kept == 1 else ("limits", "are")
        return f"The {limits} of {not_kept} of {len(checks)} checks {are} not kept"
    more = f", the limits of {not_kept} more are not kept" if not_kept else ""
    return f"{failed} of {len(checks)} checks failed{more}"


def _requested(findings: Findings) -> str:
    return "the rules requested" if findings.study.rules else "the demand of stability; no rule was requested"


def _count(checks: tuple[Check, ...]) -> str:
    """How many checks that did not fail stand how, in words."""
    words = {"pass": "passed", "outside": "outside the range for which the rule has a limit"}
    return ", ".join(f"{n} {text}" for key, text in words.items() if (n := sum(c.verdict == key for c in checks)))


def _to_be_verified(checks: tuple[Check, ...]) -> str:
    """How many limits are, and which of those are not kept, as a sentence; empty where none is."""
    number_of = sum(check.standing == TO_BE_VERIFIED for check in checks)
    if not number_of:
        return ""
    missed = dict.fromkeys(f"{check.where} ({check.clause})" for check in checks if check.verdict == "not kept")
    more = f"; of these not kept: {', '.join(missed)}" if missed else ""
    counted = "1 limit is" if number_of == 1 else f"{number_of} limits are"
    return f" {counted} to be verified against the edition in force{more}."


def _restrictions(findings: Findings) -> tuple[str, ...]:
    found = [
        f"Barred range: {band_words(band)}. Not for continuous operation; to be passed rapidly."
        for band in barred_rpm(findings)
    ]
    found += _unstable(findings)
    bad = unreliable(findings)
    response = findings.get(Response)
    if response is not None and np.any(bad):
        speeds = response.speed[bad] * RPM
        found.append(
            f"At {_listed(speeds)} the response has no reliable finite value (undamped resonance). "
            "No amplitude is stated there, nor a largest one of the range; give the damping of the train."
        )
    if not found and response is not None and findings.need(Checks).lines and not failed(findings):
        found.append("No restriction of speed follows from the checks requested.")
    return tuple(found)


def _unstable(findings: Findings) -> list[str]:
    """The unstable ranges, and where it could not be said whether there is one."""
    stable: Stability | None = findings.results.get("stability")
    if stable is None:
        return []
    from torsion.output.chapters.unstable_ranges import unanswered, words

    ends = float(stable.speed[0]), float(stable.speed[-1])
    found = [f"Unstable range: {words(one, ends)}. Not for operation." for one in stable.ranges]
    nothing = [check for check in findings.need(Checks).lines if check.clause == "stability" and np.isinf(check.value)]
    if nothing:
        return found + [f"No answer on the stability of the {check.where}: {check.note}." for check in nothing]
    return found + [f"No periodic motion was found {where}: nothing is known there." for where in unanswered(stable)]


def _listed(speeds: np.ndarray) -> str:
    groups: list[list[float]] = []
    for speed in speeds.tolist():
        if groups and speed - groups[-1][-1] <= 0.01 * speed:
            groups[-1].append(speed)
        else:
            groups.append([speed])
    words = ["–".join(dict.fromkeys((number(group[0], 5), number(group[-1], 5)))) for group in groups]
    more = f" and {len(words) - 8} further ranges" if len(words) > 8 else ""
    return f"{', '.join(words[:8])} rpm{more}"


def _notes(findings: Findings) -> tuple[str, ...]:
    """Remarks, each once, with the components that it is about."""
    about: dict[str, list[str]] = {}
    for check in findings.need(Checks).lines:
        if check.note:
            about.setdefault(f"{check.what}: {check.note}", []).append(check.where)
    return tuple(f"{', '.join(dict.fromkeys(where))}: {note}" for note, where in about.items())
