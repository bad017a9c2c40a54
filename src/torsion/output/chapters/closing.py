"""Chapter: the conclusion, the restrictions of speed, and what to measure."""

import hashlib
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings, LeftOut
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Points, Verbatim, table
from torsion.output.check_words import basis
from torsion.output.headline import MOST_LISTED, notes, overall_headline, restrictions
from torsion.output.numbers import number, order, rpm, symbols
from torsion.output.reported_values import speed_range
from torsion.output.stored.scene import checksum, curve_files
from torsion.primitives import SectionMesh
from torsion.results import listed
from torsion.rules.verdict_line import Check, Checks
from torsion.user_files import LARGEST_SIGNAL, read_file, without_controls


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the conclusion, and the measurements that would confirm it, if anything was judged or excited."""
    response = findings.get(Response)
    if not findings.need(Checks).lines and response is None:
        return
    yield Heading("Conclusion and proposed measurements")
    yield from conclusion(findings)
    if response is None or not response.lines:
        return
    yield Paragraph("Measurements on the plant that would confirm the calculation:")
    # Orders over speed, the torque of the most loaded shaft, the angle where mode 1 is largest.
    stated = speed_range(findings)
    ends = f"from {stated}" if stated else "over the speed range"
    excited = [line.order for line in response.lines[:MOST_LISTED] if line.order is not None]
    orders = f" ({', '.join(map(order, excited))})" if excited else ""
    runs = f"Run up and down slowly {ends} (speed of {findings.study.reference})"
    runs += (
        f" and at steps of constant speed. Analyse the orders{orders} and the natural frequencies."
    )
    points = [runs]
    loads = findings.get(ComponentLoads)
    shafts = () if loads is None else loads.shafts
    shaft = max(shafts, key=lambda shaft: shaft.stress or 0.0, default=None)
    if shaft is not None and shaft.stress:
        peak = f"the largest amplitude is expected at {rpm(shaft.speed)} rpm"
        points.append(f"Torque by strain gauges with telemetry on {shaft.shaft}; {peak}.")
    modes, stations = findings.get(Modes), findings.study.train.stations
    if modes is not None and len(modes.frequency):
        angle = modes.shape[: len(stations), 0] / findings.system.speed_ratio[: len(stations)]
        name = stations[int(np.argmax(np.abs(angle)))].name
        lowest = ", ".join(number(f, 4) for f in modes.frequency[:3].tolist())
        compare = f"Compare the measured natural frequencies with {lowest} Hz. If they differ by more than 5 %, "
        compare += "correct the input data and repeat the calculation."
        where = f"at {name}, where mode 1 has its largest amplitude."
        points += [f"Angular vibration by encoder or laser {where}", compare]
    yield Points(tuple(points))


def conclusion(findings: Findings) -> Iterator[Block]:
    """Yield the headline of the verdict, its notes, and the restrictions of operation."""
    (_, words), kind = overall_headline(findings)
    yield Paragraph(f"{words}.", kind)
    yield from notes(findings)
    if sentences := restrictions(findings):
        yield Points(sentences)


MOST_CLAUSES = 20  # of a rule


def steps(findings: Findings) -> Iterator[Block]:
    """The chapter of what was computed, which is always printed."""
    plan = findings.plan
    yield Heading("Appendix: what was computed")
    yield table(
        "what: < Step | method: < Method | < Size | why: < Reason",
        # Of what there is one is not said as several: 1 line at 241 speeds, cycle of 1/2 turns.
        [(line, re.sub(r"(?<![\d.,/])1 (\w+[^s\W])s\b", r"1 \1", line.size)) for line in plan.done],
        "Computed steps",
    )
    if seconds := sum(line.seconds for line in plan.done):
        yield Paragraph(f"Computing time: {number(seconds, 3)} s.")
    if plan.left_out:
        omitted = [LeftOut(*pair) for pair in plan.left_out]
        yield table("what: < Not computed | why: < Reason", omitted, "Not computed")
    if plan.versions:
        yield KeyValues(tuple(plan.versions.items()))


def sources(findings: Findings) -> Iterator[Block]:
    """Appendix: the rules that judged, their clauses and the basis of their limits, and the literature of formulas."""
    checks: dict[tuple[str, str], list[Check]] = {}
    for check in findings.need(Checks).lines:
        checks.setdefault((check.rule, basis(check)), []).append(check)
    if checks:
        yield Heading("Appendix: sources of the limits")
        rows = []
        for (_, words), group in checks.items():
            clauses = dict.fromkeys(symbols(check.clause) for check in group)
            rows.append((group[0], listed(clauses, most=MOST_CLAUSES), words))
        yield table(
            "rule: < Rule | < Clauses | < Basis",
            rows,
            "Rules used by this run and the basis of their limits",
        )
    # The rules are in that table; the editions of the rules are not repeated here.
    literature = [
        ", ".join((used.words, *used.where)) + ("" if used.compared else ", edition not confirmed")
        for used in findings.plan.sources
        if not used.is_rule
    ]
    if literature:
        words = "; ".join(literature)
        yield Paragraph(f"Sources of the formulas used in this calculation: {words}.")


def input_file(findings: Findings) -> Iterator[Block]:
    """Appendix with the text and the checksums of the files; left out where the scene did not come from a file."""
    study, folder = findings.study, Path(findings.study.file or "").parent
    if not study.text:
        return
    meshes = (bar.section.file for bar in study.train.bars if isinstance(bar.section, SectionMesh))
    named = study.shown_file or "Input"
    sums = [(f"{named} with its tables" if study.tables else named, checksum(study) or "")]
    for file in (*dict.fromkeys(meshes), *(str(folder / name) for name in curve_files(study))):
        content = read_file(file, LARGEST_SIGNAL)
        sums.append((without_controls(file), hashlib.sha256(content).hexdigest()))
    yield Heading("Appendix: the input as read")
    yield Paragraph("The report was computed from these files. SHA-256:")
    yield KeyValues(tuple(sums))
    yield Verbatim(study.text)
    for name, table_text in study.tables:
        yield Paragraph(f"Table {name}, SHA-256 {hashlib.sha256(table_text.encode()).hexdigest()}:")
        yield Verbatim(table_text)
