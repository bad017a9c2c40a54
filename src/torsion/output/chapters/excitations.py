"""Appendix: what excites the train."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import amplitude
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, degrees, given, given_rpm, number, order, scale
from torsion.output.reported_values import NOT_STATED, rated, reference, steady_at_rated
from torsion.primitives import Torque
from torsion.results import listed

MOST_NAMED = 60  # harmonic components


def chapter(findings: Findings) -> Iterator[Block]:
    """The torques and the harmonic components of the response; joints have their own chapter."""
    train, response = findings.study.train, findings.get(Response)
    angled = [mesh for mesh in train.constraints if mesh.error]
    if not train.torques and not angled:
        return
    yield Heading("Appendix: excitations")
    if any(torque.cylinder is None for torque in train.torques):
        yield _torques(findings)
    if engines := ", ".join(part.name for part in train.parts if part.engine is not None):
        yield Paragraph(f"Cylinders of {engines}: see the chapter on engines.")
    if compressors := ", ".join(part.name for part in train.parts if part.compressor is not None):
        yield Paragraph(f"Throws of {compressors}: see the chapter on compressors.")
    if angled:
        names = listed([f"{mesh.name} (order {mesh.error[0][0]})" for mesh in angled])
        yield Paragraph(
            f"Joints that excite the train, with the order of their driving shaft: {names}."
        )
    if response is not None and response.lines:
        yield _lines(findings, response)


def _torques(findings: Findings) -> Table:
    rows, sizes = [], _at_rated(findings)
    unit = scale("N m", [size for size in sizes if size is not None])
    for torque, size in zip(_plain(findings), sizes, strict=True):
        station, own_order = findings.system.stations[torque.station], torque.order
        frequency = "all requested" if torque.frequency is None else given(torque.frequency)
        rows.append(
            (
                torque.name,
                order(own_order),
                order(None if own_order is None else own_order * station.ratio),
                NONE if own_order is not None else frequency,
                _amplitude(torque),
                unit.text(size),
                degrees(torque.phase),
                torque.source or NOT_STATED,
            )
        )
    return table(
        "< Component | Order, own shaft | Order, reference | Frequency [Hz] | < Amplitude as given | "
        f"Amplitude at rated speed [{unit.unit}] | Phase [deg] | < Source",
        rows,
        "Harmonic torques",
    )


def _plain(findings: Findings) -> list[Torque]:
    """The torques but for those of cylinders."""
    return [torque for torque in findings.study.train.torques if torque.cylinder is None]


def _at_rated(findings: Findings) -> list[float | None]:
    """N m at the rated speed, of every torque; None where that is not known."""
    speed, mean = rated(findings), steady_at_rated(findings)
    torques = _plain(findings)
    if speed is None:
        return [
            None if torque.of_mean or torque.table or torque.mesh else torque.torque
            for torque in torques
        ]
    amplitudes: list[float | None] = []
    for torque in torques:
        is_known = (
            torque.mesh is None
            and _reaches(findings, torque, speed)
            and (mean is not None or not torque.of_mean)
        )
        amplitudes.append(
            float(np.abs(amplitude(findings.system, torque, np.array([speed]), mean))[0])
            if is_known
            else None
        )
    return amplitudes


def _reaches(findings: Findings, torque: Torque, speed: float) -> bool:
    """The table of a torque has the speed (rad/s of the reference)."""
    own_speed = speed * float(findings.system.stations[torque.station].ratio)
    return not torque.table or torque.table[0][0] <= own_speed <= torque.table[-1][0]


def _amplitude(torque: Torque) -> str:
    words = []
    if torque.mesh is not None:
        return f"{number(1e6 * torque.mesh[1])} µrad of the driving gear"
    if torque.table:
        unit = scale("N m", [t for _, t in torque.table])
        words.append(
            "; ".join(
                f"{given(t * unit.factor)} {unit.unit} at {given_rpm(n)} rpm"
                for n, t in torque.table
            )
        )
    if torque.torque or not (torque.of_mean or torque.table):
        unit = scale("N m", [torque.torque])
        words.append(f"{given(torque.torque * unit.factor)} {unit.unit}")
    if torque.of_mean:
        words.append(f"{100 * torque.of_mean:.6g} % of the mean torque")
    return " + ".join(words)


def _lines(findings: Findings, response: Response) -> Paragraph:
    """The harmonic components of the response in one sentence."""
    names = listed([line.named(reference(findings)) for line in response.lines], ", ", MOST_NAMED)
    return Paragraph(
        f"Harmonic components of the response, per revolution of {reference(findings)}: {names}. Contributions of one "
        "order are added as phasors."
    )
