"""Chapter: the plant, as a sketch and as a list of its components."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from torsion.analyses.system_data import SystemData, system_data
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.figure import Disc, Link, Sketch
from torsion.output.numbers import degrees
from torsion.output.station_layout import Layout, label, layout

MOST_LINKS = 60  # of a train that a page draws


def chapter(findings: Findings) -> Iterator[Block]:
    """The components with their speeds and sources."""
    yield Heading("The plant")
    if description := findings.study.description.strip():
        yield Paragraph(description)
    yield Paragraph(
        f"Speed ratio: speed / speed of {findings.study.reference}; for a gear, at the driving wheel."
    )
    yield table(
        "name: < Component | kind: < Kind | ratio: Speed ratio | speed: Rated speed [rpm]:6g? | "
        "source: < Source of the data:? | note: < Note:?",
        (findings.get(SystemData) or system_data(findings)).components,
        "Components",
    )


def sketch(findings: Findings) -> Sketch:
    """Return the train as a sketch."""
    system, positions = findings.system, layout(findings.system)
    finite = system.inertia[(system.inertia > 0) & np.isfinite(system.inertia)]
    carried = (s for s in reversed(system.own_spans) if not system.stations[s.driven].is_ground)
    # By the damper and the station of its housing.
    rings = {(s.part, s.driving): s.driven for s in carried}
    grounds = {s.driving for s in system.own_spans if system.stations[s.driven].is_ground}
    discs = []
    for position, part in enumerate(system.train.parts):
        if not part.is_point or not part.stations:
            continue
        station = part.stations[0]
        inertia = float(system.inertia[station])
        ring = rings.get((position, station))
        discs.append(
            Disc(
                x=float(positions.x[station]),
                row=float(positions.row[station]),
                size=_size(inertia, finite),
                label=label(system.train.parts, position),
                kind=part.kind,
                role=part.symbol.role,
                is_held=math.isinf(inertia),
                is_grounded=station in grounds,
                ring=0.0 if ring is None else max(_size(float(system.inertia[ring]), finite), 0.1),
            )
        )
    return Sketch(tuple(discs), tuple(_links(findings)))


def _size(inertia: float, finite: FloatArray) -> float:
    """0 for the smallest inertia of the train (or three decades below the largest), 1 for the largest."""
    if not 0 < inertia < math.inf:
        return 0.0
    top = math.log10(finite.max())
    low = max(math.log10(finite.min()), top - 3.0)
    return 0.5 if top == low else max((math.log10(inertia) - low) / (top - low), 0.0)


def _links(findings: Findings) -> list[Link]:
    """Everything that the sketch draws between two places."""
    system, positions = findings.system, layout(findings.system)
    bars = {bar.part: bar for bar in reversed(system.train.bars)}
    meshes = {mesh.part: mesh for mesh in reversed(system.train.constraints)}  # of a part the first
    links = [
        _between(positions, s.driving, s.driven, "rigid")
        for s in system.own_spans
        if s.name.endswith(" rigid")
    ]
    for position, part in enumerate(system.train.parts):
        if not part.is_point and len(part.stations) == 2:
            # It is drawn by what it was made into, the sections of a shaft to one scale.
            bar, mesh = bars.get(position), meshes.get(position)
            name, kind, options = label(system.train.parts, position), "coupling", dict[str, Any]()
            if bar is not None:
                sections = (bar, *system.train.sectioned.get(part.whole, ()))
                widest = max(end for section in sections for end in section.outer)
                kind, options["bore"] = "shaft", bar.bore[0] / bar.outer[0]
                options["taper"] = tuple(end / widest for end in bar.outer)
            elif part.joint is not None:
                kind, name = "joint", f"{name} ({degrees(part.joint.angle, 3)}°)"
            elif part.kind == "crank":
                kind = "crank"
            elif mesh is not None:
                kind, options["ratio"] = "gear", float(mesh.ratio)
            drawn = _between(
                positions, *part.stations, kind, label=name, parts=(position,), **options
            )
            # Lines lead down to its row where it begins a branch or closes a loop.
            (x0, row0), (x1, row1) = drawn.start, drawn.end
            if part.path[0] == "links":
                level = max(row0, row1) + 0.5
                links += [Link("tie", (x, row), (x, level)) for x, row in (drawn.start, drawn.end)]
                drawn = replace(drawn, start=(x0, level), end=(x1, level))
            elif row0 != row1 and kind != "gear":
                links.append(Link("tie", (x0, row0), (x0, row1)))
                drawn = replace(drawn, start=(x0, row1))
            links.append(drawn)
    for span in system.own_spans:
        is_wheel = system.train.parts[span.part].kind == "gear"
        if is_wheel and span.driven != meshes[span.part].driven:
            more = {"ratio": float(span.ratio), "parts": (span.part,)}
            links.append(_between(positions, span.driving, span.driven, "gear", **more))
    return links


def _between(positions: Layout, driving: int, driven: int, kind: str, **more: Any) -> Link:
    start, end = ((float(positions.x[s]), float(positions.row[s])) for s in (driving, driven))
    return Link(kind, start, end, **more)
