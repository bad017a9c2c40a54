"""The verdict in words: headline, worst check, restrictions and the basis of the limits; no other module words it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Box, Paragraph
from torsion.output.check_words import SIGNS
from torsion.output.figures.figure import runs
from torsion.output.numbers import RPM, counted, number, rpm, symbols
from torsion.output.reported_values import (
    UNDAMPED,
    band_words,
    barred,
    barred_rpm,
    mode_of,
    tilted,
)
from torsion.results import listed
from torsion.rules.verdict_line import (
    TO_BE_VERIFIED,
    VERIFIED_CLAUSE,
    WORDS,
    Check,
    Checks,
    Verdict,
    worst_verdict,
)

if TYPE_CHECKING:
    from torsion.what_if.sweep.sweep_results import Sweep

Head = tuple[str, str]  # sign, words
Kind = Literal["pass", "fail", "note"]
Cases = Mapping[str, Findings]
MOST_CASES = 4  # named in the headline
MOST_RANGES = 3  # barred ranges, failing ranges and failed analyses named in the box
MOST_LISTED = 8  # ranges of speed without a reliable value
KINDS: Mapping[Verdict, Kind] = {
    "pass": "pass",
    "restricted": "note",
    "not judged": "note",
    "fail": "fail",
    "not kept": "fail",
}


def verdict(findings: Findings) -> Verdict:
    """Return the worst verdict of the checks, of a comparison, fit or sweep that fails, and of missing answers.

    A case that was not solved is not judged.
    """
    if not findings.is_answered:
        return "not judged"
    # By its name: its class is not loaded where there is none.
    sweep: Sweep | None = findings.results.get("sweep")
    if any(
        getattr(findings.results.get(name), "fails", False) for name in ("check", "fit", "sweep")
    ):
        return "fail"
    worst = worst_verdict(findings.need(Checks).lines)
    if findings.plan.unanswered and WORDS[worst] != "FAIL":
        return "not judged"
    return "restricted" if worst == "pass" and sweep is not None and sweep.is_partial else worst


def headline(findings: Findings) -> tuple[Head, Kind]:
    """Return sign and words of the verdict with one clause, and how it stands out."""
    word = verdict(findings)
    return (SIGNS[word], f"{WORDS[word]}: {_clause(findings, word)}"), KINDS[word]


def _clause(findings: Findings, word: Verdict) -> str:
    """Return why the verdict is what it is."""
    checks = sorted(findings.need(Checks).lines, key=check_words.rank)
    first = next((check for check in checks if WORDS[check.verdict] == WORDS[word]), None)
    sweep: Sweep | None = findings.results.get("sweep")
    if sweep is not None and (
        (word == "restricted" and sweep.is_partial) or (first is None and sweep.fails)
    ):
        share = f"{100.0 * sweep.share_failing:.3g} % of the variants fail a check"
        if sweep.fail_at_most is None:
            return share
        return f"{share}, {100.0 * sweep.fail_at_most:.3g} % are permitted"
    if word == "not judged" and findings.plan.unanswered:
        return "an analysis was not computed"
    if first is None and word == "fail":
        return "the comparison of the models or the fit to measurements"
    if first is None:
        return "no rule judges this train" if findings.study.rules else "no rule is named"
    if word == "pass":
        return "1 limit met" if len(checks) == 1 else f"{len(checks)} limits met"
    if word == "restricted":
        bands = ", ".join(map(band_words, barred_rpm(findings)))
        return f"barred range {bands}" if bands else first.restrictions[0]
    used, speed = first.utilisation, "" if first.speed is None else f" at {rpm(first.speed)} rpm"
    share = ""
    if used is not None and np.isfinite(used) and word != "not judged":
        share = f" {check_words.percent(used)} of its limit"
    return f"{first.what}, {first.where}{share}{speed} ({first.rule})"


def headline_of_cases(cases: Cases) -> tuple[Head, Kind]:
    """Return sign and words of the worst verdict of the judged cases, with the names of the cases that have it."""
    counted_cases = judged(cases)
    with_rules = {
        name: case
        for name, case in counted_cases.items()
        if case.study.rules or lines_of(case) or case.plan.unanswered
    }
    verdicts = {name: verdict(case) for name, case in (with_rules or counted_cases).items()}
    worst = next(word for word in WORDS if word in verdicts.values())
    names = [name for name, word in verdicts.items() if WORDS[word] == WORDS[worst]]
    if len(verdicts) == 1:
        which = _named(names)
    elif len(names) < len(verdicts):
        which = f"{_named(names[:MOST_CASES])} ({len(names)} of {len(verdicts)})"
    else:
        which = "both cases" if len(names) == 2 else f"all {len(names)} cases"
    for name, rules in omitted_rules(cases).items():
        which += f", without {listed(rules)} in case {name}"
        if worst == "pass":  # one case omits a rule: the file as a whole does not pass it
            worst = "restricted"
    return (SIGNS[worst], f"{WORDS[worst]}: {which}"), KINDS[worst]


def overall_headline(findings: Findings) -> tuple[Head, Kind]:
    """Return the headline over all cases of a file, or of the findings alone."""
    return headline_of_cases(findings.each) if findings.cases else headline(findings)


def _named(names: Sequence[str]) -> str:
    return f"{'case' if len(names) == 1 else 'cases'} {', '.join(names)}"


def judged(cases: Cases) -> Cases:
    """Return the cases that count for the verdict."""
    return {name: case for name, case in cases.items() if case.is_judged}


def lines_of(findings: Findings) -> tuple[Check, ...]:
    """Return the checks of a case; none if it was not solved."""
    return findings.need(Checks).lines if findings.is_answered else ()


def omitted_rules(cases: Cases) -> dict[str, tuple[str, ...]]:
    """Return, by judged case, the rules of other cases that it does not name."""
    rules = {name: dict(case.study.rules) for name, case in judged(cases).items()}
    all_rules = dict.fromkeys(rule for named in rules.values() for rule in named)
    return {
        name: tuple(lacking)
        for name, named in rules.items()
        if (lacking := [rule for rule in all_rules if rule not in named])
    }


def case_name(findings: Findings) -> str:
    """Return the case of the findings; empty for a file without cases."""
    return next(iter(findings.each)) if findings.cases or findings.study.case is not None else ""


def box(findings: Findings) -> Box:
    """Return the verdict with its worst check, restrictions, what was not computed, and the basis of the limits.

    For a file with cases it is the verdict over all of them.
    """
    cases = findings.each if findings.cases else {"": findings}
    solved = {name: case for name, case in judged(cases).items() if case.is_answered}

    def failed(case: Findings) -> str:
        """Return the analyses that failed, with the reason."""
        steps = (f"{step.what}: {step.words}" for step in case.plan.unanswered)
        return listed(steps, "; ", most=MOST_RANGES)

    def unknown_clauses(case: Findings) -> str:
        """Return the clauses that a user confirms and no check has, with the reason."""
        left_out = case.plan.left_out
        return listed((f"{what}: {why}" for what, why in left_out if VERIFIED_CLAUSE in what), "; ")

    lines = [*worst_line(solved), *_joined("Sweep", solved, _sweep_words)]
    if "design" in findings.results:
        from torsion.output.chapters.what_if.design import design_line

        lines += design_line(findings)
    if any(part.engine is not None for part in findings.study.train.parts):
        from torsion.output.chapters.response.crank_machines import states

        if words := listed(states(findings), "; "):
            lines.append(("Engine state", words))
    lines += [
        *_joined("Barred ranges", solved, _barred_words),
        *_joined("Restrictions", solved, lambda case: " ".join(other_restrictions(case))),
        *_joined("Not computed", cases, failed),
        *_joined("Not confirmed", solved, unknown_clauses),
        *(("Note", note.text) for note in notes(findings)),
    ]
    if unjudged := [name for name, case in cases.items() if not case.is_judged]:
        lines.append(("For information", f"{_named(unjudged)}: not part of the verdict"))
    if checks := tuple(check for case in solved.values() for check in lines_of(case)):
        of_cases = f" in {len(solved)} cases" if len(solved) > 1 else ""
        count = f"{len(checks)}{of_cases}: {Checks(checks).counts}"
        unconfirmed = sum(check.standing == TO_BE_VERIFIED for check in checks)
        if unconfirmed:
            limits = sum(not np.isnan(check.limit) for check in checks)
            verb = "follows" if unconfirmed == 1 else "follow"
            count += f". {unconfirmed} of {limits} limits {verb} an edition that is not confirmed"
        lines.append(("Checks", count))
    (sign, words), kind = overall_headline(findings)
    case = "" if findings.study.case is None else f"Case {case_name(findings)}: "
    return Box(sign, case + words, kind, tuple(lines))


def _joined(
    title: str, cases: Cases, words_of: Callable[[Findings], str]
) -> Iterator[tuple[str, str]]:
    """Yield one line with the words of every case that has any."""
    names = dict[str, list[str]]()
    for name, case in cases.items():
        if text := words_of(case):
            names.setdefault(text, []).append(name)
    sentences = [f"{_named(group)}: {text}" if group[0] else text for text, group in names.items()]
    if sentences:
        *before, last = sentences
        yield title, "; ".join([*(text.removesuffix(".") for text in before), last])


def worst(findings: Findings) -> Check | None:
    """Return the check that ranks first among those with a limit."""
    checks = (check for check in lines_of(findings) if check.has_limit)
    return min(checks, key=check_words.rank, default=None)


def worst_line(cases: Cases) -> Iterator[tuple[str, str]]:
    """Yield the worst check over the cases: component, quantity, value, limit, utilisation, speed, cause, basis."""
    checks = {name: check for name, case in cases.items() if (check := worst(case)) is not None}
    if not checks:
        return
    name, check = min(checks.items(), key=lambda entry: check_words.rank(entry[1]))
    if check.utilisation is None and not check.fails:
        return
    words = [f"{check.where}: {check.what} {check_words.against(check)}"]
    if check.utilisation is not None and np.isfinite(check.utilisation):
        words[0] += f": utilisation {check_words.percent(check.utilisation)}"
    if check.speed is not None:
        words.append(f"at {rpm(check.speed)} rpm")
    if check.order is not None:
        words.append(f"mainly order {check_words.contributing(cases[name], check.order)}")
    if check.misfire:
        words.append(f"with {check.misfire}")
    basis = f"{symbols(check.clause)}, {check.rule}; basis: {check_words.basis(check)}"
    case = f"case {name}, " if name else ""
    title = "Worst check" if check.fails else "Largest utilisation"
    yield title, f"{case}{', '.join(words)} ({basis})"


def _sweep_words(findings: Findings) -> str:
    """Return how many variants of a sweep fail a check."""
    sweep: Sweep | None = findings.results.get("sweep")
    result = None if sweep is None else sweep.any_fails
    if sweep is None or result is None:
        return ""
    unsolved = f"; {sweep.unsolved} not solved" if sweep.unsolved else ""
    if sweep.method == "grid":
        variants, ranges = counted(sweep.samples, "variant"), ""
        if sweep.grid is not None and len(sweep.grid.axes) == 1 and sweep.grid.axes[0].is_numeric:
            axis = sweep.grid.axes[0]
            ends = [
                dict.fromkeys((axis.words[a], axis.words[b])) for a, b in runs(sweep.grid.fails)
            ]
            failing = listed(map(" to ".join, ends), most=MOST_RANGES)
            ranges = f": {axis.name} {failing}" if ends else ""
        return f"{result.failing:,} of {variants} fail a check{ranges}{unsolved}"
    share, low, high = (
        number(100.0 * (value or 0.0), 3)
        for value in (result.probability, result.lower, result.upper)
    )
    fail = f"none of {sweep.samples:,} variants fails"
    if result.failing:
        fail = f"{share} % of the variants fail a check"
    return f"{fail} (95 % CI {low} to {high} %){unsolved}"


def _barred_words(findings: Findings) -> str:
    """Return the barred ranges with shaft, order and mode."""
    ranges = []
    for band in barred(findings):
        words = [band_words((band.lower * RPM, band.upper * RPM)), band.shaft]
        if band.order is not None:
            order = check_words.contributing(findings, band.order)
            words += [f"order {order}", f"mode {mode_of(findings, band)}"]
        ranges.append(", ".join(words))
    return listed(ranges, "; ", most=MOST_RANGES)


def notes(findings: Findings) -> Iterator[Paragraph]:
    """Yield what the comparison of models, the fit and the exact periodic response add to the verdict."""
    compared = findings.results.get("check")
    if compared is not None:
        from torsion.output.chapters.model_comparison import conclusion as compared_models

        yield compared_models(compared)
    if findings.results.get("fit") is not None:
        from torsion.output.chapters.what_if.fit import conclusion as fitted

        yield fitted(findings.results["fit"])
    if findings.results.get("periodic") is not None:
        from torsion.output.chapters.response.exact_response import first_order_judged

        if text := first_order_judged(findings):
            yield Paragraph(text, "note")


def restrictions(findings: Findings) -> tuple[str, ...]:
    """Return the restrictions of operation as sentences, or that there is none."""
    ranges = [
        f"Barred range: {band_words(band)}. No continuous operation; pass it rapidly."
        for band in barred_rpm(findings)
    ]
    sentences = (*ranges, *other_restrictions(findings))
    is_met = verdict(findings) in ("pass", "restricted")
    if sentences or findings.get(Response) is None or not is_met:
        return sentences
    return ("No restriction of speed follows from the checks.",)


def other_restrictions(findings: Findings) -> tuple[str, ...]:
    """Return the restrictions other than barred ranges: conditions of checks, unstable ranges, unreliable speeds."""
    conditions = (words for check in findings.need(Checks).lines for words in check.restrictions)
    sentences = [f"{words[:1].upper()}{words[1:]}." for words in dict.fromkeys(conditions)]
    stability = findings.results.get("stability")
    if stability is not None or tilted(findings):
        from torsion.output.chapters import stability_ranges

        if stability is not None:
            sentences += stability_ranges.restrictions(findings, stability)
        sentences += stability_ranges.tilt_restrictions(findings)
    response = findings.get(Response)
    if response is not None and response.unreliable.any():
        speeds = response.speed[response.unreliable] * RPM
        # Neighbours form one range.
        groups = np.split(speeds, np.flatnonzero(np.diff(speeds) > 0.01 * speeds[1:]) + 1)
        ranges = ["–".join(dict.fromkeys(map(number, group[[0, -1]].tolist()))) for group in groups]
        omitted = ""
        if len(ranges) > MOST_LISTED:
            omitted = f" (the first {MOST_LISTED} of {len(ranges)} ranges)"
        sentences.append(f"At {', '.join(ranges[:MOST_LISTED])} rpm{omitted} {UNDAMPED}")
    return (*sentences, *filter(None, [check_words.unreached(findings)]))
