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
from torsion.output.chapters import plant, verdict
from torsion.output.chapters.modes import mass_elastic, natural_frequencies
from torsion.output.chapters.response import forced_response
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Figure
from torsion.output.numbers import counted, number
from torsion.output.pages.html import environment
from torsion.output.reported_values import harmonic_name
from torsion.output.stored.scene import NO_VALUE, Element, elements, highest
from torsion.results import one_line
from torsion.rules.verdict_line import WORDS, Checks
from torsion.study import Study

MOST_ROWS = 30  # of stations, or of spans
MOST_MODES = 30  # in the table of their frequencies
FEW = 6  # frequencies in a line


def bundle(shown: Any) -> dict[str, str]:
    """Return one line and a fragment without scripts for a study, Findings, Modes or a Response."""
    content: dict[type, Callable[[Any], Iterator[Block]]] = {
        Study: _study,
        Findings: _findings,
        Modes: _modes,
        Response: _response,
    }
    blocks, template = content[type(shown)](shown), environment().get_template("notebook.html")
    page = template.render(blocks=blocks, drawn=lambda figure: Markup(svg(figure)))
    return {"text/plain": repr(shown), "text/html": page}


def line(shown: Any) -> str:
    """Return Findings, Modes or Response in one line."""
    match shown:
        case Findings():
            checks = shown.get(Checks)
            judged = "no check"
            if checks is not None and checks.lines:
                count = counted(len(checks.lines), "check")
                judged = f"{WORDS[headline.verdict(shown)]}, {count}"
            text = f"{shown.study.name}; {judged}; results: {', '.join(shown.results)}"
        case Modes():
            ellipsis = ", …" if shown.frequency.size > FEW else ""
            hertz = ", ".join(map(number, shown.frequency[:FEW].tolist()))
            text = counted(shown.frequency.size, "elastic mode")
            text += f": {hertz}{ellipsis} Hz" if hertz else ""
        case Response():
            components = counted(len(shown.lines), "harmonic component")
            text = f"{components} at {counted(shown.speed.size, 'speed')}"
        case _:
            raise TypeError(f"{type(shown).__name__} has no display")
    return one_line(f"{type(shown).__name__}: {text}")


def _findings(findings: Findings) -> Iterator[Block]:
    """Yield the first chapter of the report, and its first figure."""
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
    """Yield the sketch of the train and its mass-elastic tables, nothing solved."""
    findings = _alone(None, assembled(study), study)
    yield KeyValues((("Study", study.name),))
    yield from _plant(findings)
    for block in mass_elastic.chapter(findings):
        if isinstance(block, Table):
            caption, count = block.caption, len(block.values)
            caption += f"; the first {MOST_ROWS} of {count}" * (count > MOST_ROWS)
            yield replace(block, values=block.values[:MOST_ROWS], caption=caption)


def _modes(modes: Modes) -> Iterator[Block]:
    """Yield the frequencies with their bounds, and the first mode over the train."""
    if modes.frequency.size:
        yield natural_frequencies.frequencies(modes, MOST_MODES)
        yield from natural_frequencies.plots(_alone(modes, modes.system), modes, (0,))
    else:
        yield Paragraph("no elastic modes")


def _response(response: Response) -> Iterator[Block]:
    """Yield the largest harmonic component of every element, and the curve of the one that carries most."""
    findings = _alone(response, response.system)
    rows, strongest = list[tuple[Any, ...]](), dict[Element, float]()
    for element in elements(response.system):
        size = response.amplitude(element.spans)
        if not response.torque[..., list(element.spans)].any():
            continue
        strongest[element] = highest(size) * element.ratio
        speed, line = divmod(int(np.argmax(size)), size.shape[1])
        if not np.isfinite(size[speed, line]):  # a value that is not known may be the largest
            rows.append((element.name, NO_VALUE, None, None))
        else:
            at = float(response.speed[speed])
            rows.append((element.name, size[speed, line], at, harmonic_name(response, line)))
    if not rows:
        yield Paragraph("nothing excites")
        return
    titles = "< Element | Torque amplitude [~N m] | At speed [rpm] | Order"
    yield table(titles, rows, "Largest torque amplitude of any one harmonic component")
    yield forced_response.curves(findings, max(strongest, key=strongest.__getitem__))


def _alone(result: Any, system: System, study: Study | None = None) -> Findings:
    """Return findings of one result, with the train that it is of."""
    results = {"system": system, "result": result, "checks": Checks(())}
    return Findings(study or Study("", system.train), results, Plan((), (), {}))
