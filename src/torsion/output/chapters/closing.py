"""Chapter: the conclusion in plain sentences, the restrictions of speed, and what is to be measured."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.sweep.sweep_results import Sweep
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Heading, Paragraph, Points
from torsion.output.check_words import about
from torsion.output.headline import failing_share
from torsion.output.numbers import RPM, given_rpm, number, order, rpm, symbols
from torsion.output.reported_values import (
    UNDAMPED,
    amplitude,
    band_words,
    barred_rpm,
    failed,
    reference,
    tilted,
    unreliable,
)
from torsion.output.selection import elements, highest
from torsion.results import listed
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, Checks

STANDING = {
    "stability": "stability",
    "transient": "the greatest torque over time",
}  # rules that need no name: their demand
MOST_LISTED = 8  # orders to be measured, ranges of speed without a reliable value


def chapter(findings: Findings) -> Iterator[Block]:
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
    yield overall(findings)
    for one in findings.plan.unanswered:
        yield Paragraph(f"No answer: {one.what}, because {one.words}.", "fail")
    yield from beside(findings)
    if restrictions := _restrictions(findings):
        yield Points(restrictions)


def beside(findings: Findings) -> Iterator[Paragraph]:
    """What the comparison of models, a fit to measurements and the exact periodic motion, say of the verdict."""
    compared = findings.results.get("check")
    if compared is not None:
        from torsion.output.chapters.model_comparison import conclusion as compared_models

        yield compared_models(compared)
    if findings.results.get("fit") is not None:
        from torsion.output.chapters.fit import conclusion as fitted

        yield fitted(findings.results["fit"])
    if findings.results.get("periodic") is not None:
        from torsion.output.chapters.exact_response import first_order_judged

        if text := first_order_judged(findings):
            yield Paragraph(text, "note")


def overall(findings: Findings) -> Paragraph:
    """The conclusion in a sentence."""
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
        where = listed(about(bad), most=4)
        return Paragraph(f"{_bad(checks)} ({where}). The train does not satisfy {requested}.{doubt}", "fail")
    if missing := [check for check in checks if check.verdict == "not judged"]:
        words = listed(dict.fromkeys(f"{check.what}, {check.where}" for check in missing), "; ", most=4)
        return Paragraph(
            f"No check failed, and {len(missing)} of {len(checks)} could not be judged: {words}.{doubt}", "note"
        )
    limited = sum(check.verdict == "restricted" for check in checks)
    restricted = f" with the restrictions below ({limited} of them)" if limited else ""
    passed = "The only check" if len(checks) == 1 else f"All {len(checks)} checks"
    sweep = findings.get(Sweep)
    if sweep is not None and (sweep.fails or sweep.is_partial):
        text = f"{passed} of the file as it stands passed{restricted}, but {failing_share(sweep)}.{doubt}"
        return Paragraph(text, "fail" if sweep.fails else "note")
    text = f"{passed} passed{restricted}: the train satisfies {requested}.{doubt}"
    return Paragraph(text, "note" if limited else "pass")


def _bad(checks: tuple[Check, ...]) -> str:
    """How many checks failed, in words."""
    failed = sum(check.fails for check in checks)
    return "The only check failed" if len(checks) == 1 else f"{failed} of {len(checks)} checks failed"


def _to_be_verified(checks: tuple[Check, ...]) -> str:
    """How many limits are, and which of those are exceeded, as a sentence; empty where none is."""
    number_of = sum(check.standing == TO_BE_VERIFIED for check in checks)
    if not number_of:
        return ""
    missed = listed(
        dict.fromkeys(
            f"{one} ({symbols(check.clause)})"
            for check in checks
            if check.verdict == "not kept"
            for one in about([check])
        ),
        most=4,
    )
    more = f"; of these exceeded: {missed}" if missed else ""
    counted = "1 limit is" if number_of == 1 else f"{number_of} limits are"
    return f" {counted} to be verified against the edition in force{more}."


def _restrictions(findings: Findings) -> tuple[str, ...]:
    """Barred and unstable ranges, speeds without an answer, else that nothing restricts the speed."""
    found = [
        f"Barred range: {band_words(band)}. Not for continuous operation; to be passed rapidly."
        for band in barred_rpm(findings)
    ]
    return (*found, *other_restrictions(findings, is_barred=bool(found)))


def other_restrictions(findings: Findings, *, is_barred: bool) -> tuple[str, ...]:
    """The same without the barred ranges; that nothing restricts the speed where these do not."""
    response, bad, stable = findings.get(Response), unreliable(findings), findings.results.get("stability")
    conditions = (words for check in findings.need(Checks).lines for words in check.restrictions)
    found = [f"{words[:1].upper()}{words[1:]}." for words in dict.fromkeys(conditions)]
    if stable is not None:
        from torsion.output.chapters.stability_ranges import restrictions

        found += restrictions(findings, stable)
    if tilted(findings):
        from torsion.output.chapters.stability_ranges import tilt_restrictions

        found += tilt_restrictions(findings)
    if response is not None and np.any(bad):
        found.append(f"At {_listed(response.speed[bad] * RPM)} {UNDAMPED}")
    if unreached := check_words.unreached(findings):
        found.append(unreached)
    if not (found or is_barred) and response is not None and findings.need(Checks).lines and not failed(findings):
        found.append("No restriction of speed follows from the checks requested.")
    return tuple(found)


def _listed(speeds: np.ndarray) -> str:
    """Speeds in rpm as ranges of neighbours, the first of them."""
    groups = np.split(speeds, np.flatnonzero(np.diff(speeds) > 0.01 * speeds[1:]) + 1)
    words = ["–".join(dict.fromkeys((number(float(one[0])), number(float(one[-1]))))) for one in groups]
    more = f" (the first {MOST_LISTED} of {len(words)} ranges)" if len(words) > MOST_LISTED else ""
    return f"{', '.join(words[:MOST_LISTED])} rpm{more}"
