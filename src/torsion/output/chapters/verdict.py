"""Chapters: the conclusion, barred ranges and every check; remarks on those that pass; what is to be measured."""

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import partial

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points, on_terminal, table
from torsion.output.chapters.engine_states import states
from torsion.output.numbers import NONE, RPM, counted, given, given_rpm, number, order, rpm, symbols
from torsion.output.reported_values import (
    UNDAMPED,
    amplitude,
    band_words,
    barred,
    barred_rpm,
    failed,
    mode_near,
    rated,
    reference,
    unreliable,
)
from torsion.output.selection import elements, highest
from torsion.rules.verdict_line import TO_BE_VERIFIED, BarredRange, Check, Checks

STANDING = {
    "stability": "stability",
    "transient": "the greatest torque over time",
}  # rules that need no name: their demand
STRESS = "N/mm2"  # unit of a check that judges the stress of a shaft
MOST_NAMED = 12  # components without a source that are named on the first page
MOST_LISTED = 8  # orders to be measured, ranges of speed without a reliable value


def chapter(findings: Findings) -> Iterator[Block]:
    """The verdict comes first in every report."""
    yield Heading("Verdict", at_end=True)
    yield from on_terminal(conclusion(findings))
    yield from barred_ranges(findings)
    checks = sorted(findings.need(Checks).lines, key=_rank)
    if checks:
        yield table(
            "< Check | < Component -> | < Clause -> check | Worst value -> value | Limit -> | Utilisation [%] | "
            "< Unit -> | At speed [rpm] -> at rpm | < Order | < Standing of the limit -> limit from | < Verdict ->",
            map(partial(_row, findings), checks),
            "Checks against the rules, each at its worst point: those that fail first, then by utilisation of the "
            "limit (value / limit, of a least value limit / value: of a diameter no share of stress). Order: the one "
            "that contributes most",
            marks=[check.verdict for check in checks],
            short="Checks, each at its worst point",
        )
    yield from states(findings)
    yield from _unjudged(findings)
    yield _sources(findings)
    if remarks := _remarks(check for check in checks if check.verdict != "pass"):
        yield Heading("Remarks on the checks that do not pass", 2)
        yield remarks


def remarks(findings: Findings) -> Iterator[Block]:
    """Appendix: what is to be said of checks that pass."""
    if found := _remarks(check for check in findings.need(Checks).lines if check.verdict == "pass"):
        yield Heading("Appendix: remarks on the checks that pass")
        yield found


def _remarks(checks: Iterable[Check]) -> Points | None:
    """Each remark once, with the components that it is about; None where there is none."""
    about: dict[str, list[str]] = {}
    for check in checks:
        if check.note:
            about.setdefault(f"{check.what}: {symbols(check.note)}", []).append(check.where)
    found = (f"{', '.join(dict.fromkeys(where))}: {note}" for note, where in about.items())
    return Points(tuple(found)) if about else None


def _rank(check: Check) -> tuple[int, float]:
    """Failing checks first, then by falling utilisation, those without one last."""
    used = check.utilisation
    return {"fail": 0, "not kept": 1}.get(check.verdict, 2), math.inf if used is None else -used


def _unjudged(findings: Findings) -> Iterator[Paragraph]:
    """The shafts whose stress no rule judges, and why; nothing where the file names no rule."""
    lines = findings.need(Checks).lines
    judged = {check.where for check in lines if check.unit == STRESS}
    reasons = {what.rpartition(" for ")[2]: why for what, why in findings.plan.left_out if " for " in what}
    about: dict[str, list[str]] = {}
    for bar in findings.study.train.bars if findings.study.rules else ():
        if bar.name not in judged:
            about.setdefault(reasons.get(bar.name, "no rule that the file names judges it"), []).append(bar.name)
    if about:
        words = "; ".join(f"{', '.join(names)} ({why})" for why, names in about.items())
        yield Paragraph(f"Shafts whose stress no rule judges: {words}.", "note")


def _sources(findings: Findings) -> Paragraph:
    """How many components and excitations do not say where their figures come from."""
    parts = [part for part in findings.study.train.parts if part.kind != "branch"]
    given = [torque for torque in findings.study.train.torques if torque.path[:1] == ("excitations",)]
    bare = [part.name for part in parts if part.source is None]
    lacking = f"{len(bare)} of {counted(len(parts), 'component')}" if bare else ""
    lacking += f" ({', '.join(bare)})" if 0 < len(bare) <= MOST_NAMED else ""
    acting = sum(torque.source is None for torque in given)
    excited = f"{acting} of {counted(len(given), 'excitation')}" if acting else ""
    lacking = " and ".join(filter(None, (lacking, excited)))
    if lacking:
        return Paragraph(f"Where the figures come from is not stated for {lacking}.", "note")
    return Paragraph("Where the figures come from is stated for every component and excitation.")


def judged(findings: Findings) -> Iterator[Block]:
    """The same; nothing where no rule judged."""
    if findings.need(Checks).lines:
        yield from chapter(findings)


def barred_ranges(findings: Findings) -> Iterator[Block]:
    """Nothing where no range is barred."""
    found, speed = barred(findings), rated(findings)
    if not found:
        return
    yield Paragraph(
        f"Barred for continuous operation: {'; '.join(map(band_words, barred_rpm(findings)))}. The range is to be "
        "passed rapidly, to be marked on the tachometer and to be shown on a notice at every control station. By "
        "formula 16 n_{c}/(18 − λ) to (18 − λ) n_{c}/16 with λ = n_{c}/n_{rated}, extended to every speed at which the "
        "stress exceeds τ_{C} and by the tolerance of the tachometer (IACS UR M68); n_{c} is the critical speed."
    )
    yield table(
        "< Shaft -> | From [rpm] -> from rpm | To [rpm] -> to rpm | < Order -> | Mode -> | Critical speed [rpm] | λ | "
        "From by formula [rpm] | To by formula [rpm]",
        [
            (b.shaft, rpm(b.lower), rpm(b.upper), _order(findings, b.order), _mode(findings, b), rpm(b.critical),
             number(b.critical / speed, 4) if speed else NONE, rpm(b.formula_lower), rpm(b.formula_upper))
            for b in found
        ],
        f"Barred ranges ({rpm(speed)} rpm rated)" if speed else "Barred ranges",
        short="Barred ranges",
    )  # fmt: skip
    times = dict.fromkeys(one for check in findings.need(Checks).lines for one in check.times if check.barred)
    if times:
        cells = [
            (one.motion or "the only", rpm(one.lower), rpm(one.upper), number(one.seconds, 3),
             NONE if one.share is None else number(100.0 * one.share, 3), "ends within" if one.stays else "passes")
            for one in times
        ]  # fmt: skip
        titles = "< Motion over time | From [rpm] | To [rpm] | Within [s] | Reached, of the steady resonance [%] | <"
        yield table(titles, cells, "Motions over time within barred ranges; the rule has no limit of the time")


def _mode(findings: Findings, barred: BarredRange) -> str:
    """The mode that the order of a barred range excites at its critical speed."""
    if barred.order is None:
        return NONE
    return mode_near(findings, float(barred.order) * barred.critical / (2.0 * math.pi))


def closing(findings: Findings) -> Iterator[Block]:
    """The conclusion, and the measurements that would confirm it; only where something was judged or excited."""
    response = findings.get(Response)
    if not findings.need(Checks).lines and response is None:
        return
    yield Heading("Conclusion and proposed measurements")
    yield from conclusion(findings)
    if response is not None and response.lines:
        yield Paragraph("Measurements on the plant that would confirm the calculation:")
        yield Points(tuple(_measurements(findings, response)))


def _measurements(findings: Findings, response: Response) -> Iterator[str]:
    """What to measure: orders over speed, torque of the most loaded shaft, angle where mode 1 moves most."""
    speeds = findings.study.operation.speeds
    ends = (
        "over the speed range" if speeds is None else f"from {given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm"
    )
    orders = ", ".join(order(line.order) for line in response.lines[:MOST_LISTED] if line.order is not None)
    yield (
        f"Run up and down slowly {ends} (speed of {reference(findings)}) and at steps of constant speed, with an "
        f"analysis by orders{f' ({orders})' if orders else ''} and of the frequencies below."
    )
    shafts = [(amplitude(findings, e.spans), e) for e in elements(findings.system) if e.kind == "shaft"]
    if strained := [(values, shaft) for values, shaft in shafts if highest(values) > 0]:
        values, shaft = max(strained, key=lambda pair: highest(pair[0]) * pair[1].ratio)
        at = int(np.argmax(np.nan_to_num(values, nan=0.0).max(axis=1)))
        where = f"the largest amplitude is expected at {rpm(float(response.speed[at]))} rpm"
        yield f"Torque by strain gauges with telemetry on {shaft.name}; {where}."
    modes, own = findings.get(Modes), findings.study.train.stations
    if modes is None or len(modes.frequency) == 0:
        return
    size = np.abs(modes.shape[: len(own), 0] / findings.system.speed_ratio[: len(own)])
    name = own[int(np.argmax(size))].name
    yield f"Angular vibration by encoder or laser at {name}, where mode 1 has its largest amplitude."
    lowest = ", ".join(number(f, 4) for f in modes.frequency[:3].tolist())
    yield f"Compare the measured natural frequencies with {lowest} Hz; a difference above 5 % calls for new data."


def conclusion(findings: Findings) -> Iterator[Block]:
    """The conclusion, that of the comparison of models, and the restrictions of speed, in plain sentences."""
    yield _overall(findings)
    for one in findings.plan.unanswered:
        yield Paragraph(f"No answer: {one.what}, because {one.words}.", "fail")
    compared = findings.results.get("check")
    if compared is not None:
        from torsion.output.chapters.model_comparison import conclusion as compared_models

        yield compared_models(compared)
    if findings.results.get("periodic") is not None:
        from torsion.output.chapters.exact_response import first_order_judged

        if text := first_order_judged(findings):
            yield Paragraph(text, "note")
    if restrictions := _restrictions(findings):
        yield Points(restrictions)


def _order(findings: Findings, of: Fraction | None) -> str:
    """An order by what excites it, where that is known."""
    response = findings.get(Response)
    lines = () if response is None or of is None else response.lines
    return next((line.named(reference(findings)) for line in lines if line.order == of), order(of))


def _row(findings: Findings, check: Check) -> tuple[str, ...]:
    sign = "≥ " if check.at_least else ""
    limit = "none" if np.isnan(check.limit) else sign + given(check.limit)
    nothing = "no answer" if check.clause == "stability" else "no finite value"
    value = nothing if np.isinf(check.value) else number(check.value)
    used = NONE if check.utilisation is None else number(100.0 * check.utilisation, 4)
    return (
        f"{check.what} ({check.rule})", check.where, symbols(check.clause), value, limit, used,
        symbols(check.unit), rpm(check.speed), _order(findings, check.order), check.standing, check.verdict.upper(),
    )  # fmt: skip


def _overall(findings: Findings) -> Paragraph:
    checks, bad = findings.need(Checks).lines, failed(findings)
    if not checks:
        text = "No rule was requested, or none applies to this train: the report gives results without a verdict."
        return Paragraph(text, "note")
    doubt = _to_be_verified(checks)
    standing = " and ".join(
        STANDING[rule] for rule in dict.fromkeys(check.rule for check in checks) if rule in STANDING
    )
    requested = "the rules requested" if findings.study.rules else f"the demand of {standing}; no rule was requested"
    if bad:
        where = ", ".join(dict.fromkeys(check.where for check in bad))
        return Paragraph(f"{_bad(checks)} ({where}). The train does not satisfy {requested}.{doubt}", "fail")
    if any(check.verdict != "pass" for check in checks):
        words = {"pass": "passed", "outside": "outside the range for which the rule has a limit"}
        number_of = {text: sum(check.verdict == key for check in checks) for key, text in words.items()}
        counts = ", ".join(f"{n} {text}" for text, n in number_of.items() if n)
        return Paragraph(f"No check failed: {counts}.{doubt}", "note")
    restricted = " with the restrictions of speed below" if barred_rpm(findings) else ""
    passed = "The only check" if len(checks) == 1 else f"All {len(checks)} checks"
    return Paragraph(f"{passed} passed: the train satisfies {requested}{restricted}.{doubt}", "pass")


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


def _to_be_verified(checks: tuple[Check, ...]) -> str:
    """How many limits are, and which of those are not kept, as a sentence; empty where none is."""
    number_of = sum(check.standing == TO_BE_VERIFIED for check in checks)
    if not number_of:
        return ""
    missed = dict.fromkeys(
        f"{check.where} ({symbols(check.clause)})" for check in checks if check.verdict == "not kept"
    )
    more = f"; of these not kept: {', '.join(missed)}" if missed else ""
    counted = "1 limit is" if number_of == 1 else f"{number_of} limits are"
    return f" {counted} to be verified against the edition in force{more}."


def _restrictions(findings: Findings) -> tuple[str, ...]:
    """Barred and unstable ranges, speeds without an answer, else that nothing restricts the speed."""
    response, bad, stable = findings.get(Response), unreliable(findings), findings.results.get("stability")
    found = [
        f"Barred range: {band_words(band)}. Not for continuous operation; to be passed rapidly."
        for band in barred_rpm(findings)
    ]
    if stable is not None:
        from torsion.output.chapters.stability_ranges import restrictions

        found += restrictions(findings, stable)
    if response is not None and np.any(bad):
        found.append(f"At {_listed(response.speed[bad] * RPM)} {UNDAMPED}")
    if not found and response is not None and findings.need(Checks).lines and not failed(findings):
        found.append("No restriction of speed follows from the checks requested.")
    return tuple(found)


def _listed(speeds: np.ndarray) -> str:
    """Speeds in rpm as ranges of neighbours, the first of them."""
    groups = np.split(speeds, np.flatnonzero(np.diff(speeds) > 0.01 * speeds[1:]) + 1)
    words = ["–".join(dict.fromkeys((number(float(one[0])), number(float(one[-1]))))) for one in groups]
    more = f" (the first {MOST_LISTED} of {len(words)} ranges)" if len(words) > MOST_LISTED else ""
    return f"{', '.join(words[:MOST_LISTED])} rpm{more}"
