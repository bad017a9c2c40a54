"""Findings, modes and a response as a notebook shows them: tables and one static figure, all names escaped."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from markupsafe import Markup

from torsion.analyses.discretisation import assembled
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.assembly.system import System
from torsion.findings import Findings, Plan
from torsion.output import headline
from torsion.output.blocks import Block, KeyValues, Paragraph, Table, table
from torsion.output.chapters import (
    forced_response,
    mass_elastic,
    natural_frequencies,
    plant,
    verdict,
)
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Figure
from torsion.output.html import environment
from torsion.output.numbers import NONE, counted, number, rpm
from torsion.output.reported_values import amplitude, harmonic_name
from torsion.output.scene import span_rows, station_rows
from torsion.output.selection import NO_VALUE, Selection, elements, highest, largest, torques
from torsion.results import one_line
from torsion.rules.verdict_line import WORDS, Checks
from torsion.study import Study
from torsion.train import Train

MOST_ROWS = 30  # of stations, or of spans
MOST_MODES = 30  # in the table of their frequencies
FEW = 6  # frequencies in a line


def bundle(shown: Any) -> dict[str, str]:
    """Of a study, its train or system, Findings, Modes or Response: one line, and a fragment without scripts."""
    content: dict[type, Callable[[Any], Iterator[Block]]] = {
        Study: _study,
        Train: _train,
        System: _system,
        Findings: _findings,
        Modes: _modes,
        Response: _response,
    }
    blocks = content[type(shown)](shown)
    page = (
        environment()
        .get_template("notebook.html")
        .render(blocks=blocks, drawn=lambda one: Markup(svg(one)))
    )
    return {"text/plain": repr(shown), "text/html": page}


def line(shown: Any) -> str:
    """Return Findings, Modes or Response in one line."""
    match shown:
        case Findings():
            text = _findings_line(shown)
        case Modes():
            text = f"{counted(shown.frequency.size, 'elastic mode')}{_frequencies(shown)}"
        case Response():
            text = " at ".join(
                (
                    counted(len(shown.lines), "harmonic component"),
                    counted(shown.speed.size, "speed"),
                )
            )
        case _:
            raise TypeError(f"{type(shown).__name__} has no display")
    return one_line(f"{type(shown).__name__}: {text}")


def _findings_line(findings: Findings) -> str:
    checks = findings.get(Checks)
    lines = () if checks is None else checks.lines
    judged = (
        f"{WORDS[headline.verdict(findings)]}, {counted(len(lines), 'check')}"
        if lines
        else "no check"
    )
    return f"{findings.study.name}; {judged}; results: {', '.join(findings.results)}"


def _frequencies(modes: Modes) -> str:
    """Return the first frequencies after a colon; nothing if there is none."""
    ellipsis = ", …" if modes.frequency.size > FEW else ""
    return (
        f": {', '.join(map(number, modes.frequency[:FEW].tolist()))}{ellipsis} Hz"
        if modes.frequency.size
        else ""
    )


def _findings(findings: Findings) -> Iterator[Block]:
    """The first chapter of the report, and its first figure."""
    first = [*verdict.chapter(findings)] if findings.get(Checks) is not None else []
    yield KeyValues((("Scene", findings.study.name),))
    further = [block for block in first if isinstance(block, Figure)][1:]
    yield from (block for block in first if not any(block is figure for figure in further))
    if not first:
        yield from _plant(findings)


def _plant(findings: Findings) -> Iterator[Figure]:
    """Yield the sketch of the train; nothing of a train too long for a page."""
    if len((sketch := plant.sketch(findings)).links) <= plant.MOST_LINKS:
        yield Figure("plant", "Train (not to scale)", (sketch,))


def _study(study: Study) -> Iterator[Block]:
    """The sketch of the train and its mass-elastic tables, nothing solved."""
    findings = Findings(study, {"system": assembled(study), "checks": Checks(())}, Plan((), (), {}))
    yield KeyValues((("Study", study.name),))
    yield from _plant(findings)
    yield from (block for block in mass_elastic.chapter(findings) if isinstance(block, Table))


def _train(train: Train) -> Iterator[Block]:
    rows = ((part.name, part.kind, part.ratio) for part in train.parts)
    yield table("< Component | < Kind | Speed ratio", rows, "Components")


def _system(system: System) -> Iterator[Block]:
    """The first stations and spans."""
    chosen = Selection(system)
    stations, spans = station_rows(chosen), span_rows(chosen)
    inertias = [(row.name, row.inertia, row.speed_ratio) for row in stations[:MOST_ROWS]]
    yield table(
        "< Station | Inertia [kg m²] | Speed ratio", inertias, _first("Stations", len(stations))
    )
    stiffnesses = [
        (row.name, row.stiffness, row.viscous, row.loss_factor) for row in spans[:MOST_ROWS]
    ]
    titles = "< Span | Stiffness [N m/rad] | Damping [N m s/rad] | Loss factor"
    yield table(titles, stiffnesses, _first("Spans", len(spans)))


def _first(caption: str, count: int) -> str:
    return caption if count <= MOST_ROWS else f"{caption}; the first {MOST_ROWS} of {count}"


def _modes(modes: Modes) -> Iterator[Block]:
    """The frequencies with their bounds, and the first mode over the train."""
    if modes.frequency.size:
        frequencies = natural_frequencies.frequencies(modes)
        remainder = (
            f"; the first {MOST_MODES} of {len(frequencies.rows)}"
            if len(frequencies.rows) > MOST_MODES
            else ""
        )
        yield replace(
            frequencies,
            values=frequencies.values[:MOST_MODES],
            caption=frequencies.caption + remainder,
        )
        yield from natural_frequencies.plots(_alone(modes), modes, (0,))
    else:
        yield Paragraph("no elastic modes")


def _response(response: Response) -> Iterator[Block]:
    """The largest harmonic component of every element, and the element that carries most over the speed."""
    findings = _alone(response)
    loaded = [
        e
        for e in elements(response.system)
        if np.any(np.abs(response.torque[:, :, list(e.spans)]) > 0)
    ]
    if not loaded:
        yield Paragraph("nothing excites")
        return
    sizes = {element: amplitude(findings, element.spans) for element in loaded}
    unit = torques(sizes.values())
    rows = []
    for element, size in sizes.items():
        peak = largest(size.ravel())
        if peak is None:
            rows.append((element.name, NO_VALUE, NONE, NONE))
        else:
            speed, line = divmod(peak, size.shape[1])
            torque, name = unit.text(float(size[speed, line])), harmonic_name(response, line)
            rows.append((element.name, torque, rpm(float(response.speed[speed])), name))
    titles = f"< Element | Torque amplitude [{unit.unit}] | At speed [rpm] | Order"
    yield table(titles, rows, "Largest torque amplitude of any one harmonic component")
    yield forced_response.curves(
        findings, max(loaded, key=lambda one: highest(sizes[one]) * one.ratio)
    )


def _alone(result: Modes | Response) -> Findings:
    """A result by itself, with the train that it is of."""
    system = result.system
    return Findings(
        Study("", system.train),
        {"system": system, "result": result, "checks": Checks(())},
        Plan((), (), {}),
    )
