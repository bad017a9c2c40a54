"""The mode shapes as modes.vtu, which ParaView opens: every span of the train as a line, with its radius and angles.

The filter *Tube* of ParaView, with the array `radius`, makes bodies of the lines.
"""

import tempfile
from pathlib import Path

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.station_layout import layout

NAME = "modes.vtu"
LENGTH = 0.1  # m: a length of a train without shafts
UNIT = LENGTH / 1.6  # m, of the sketch
THIN = 0.3  # radius of what has no diameter, in the mean radius of the shafts


def vtu(_document: Document, findings: Findings) -> bytes:
    """Return the content of the file; raise InputError if there is no mode."""
    import meshio

    modes, system = findings.get(Modes), findings.system
    if modes is None or not modes.frequency.size:
        lacking = "the train has no elastic mode"
        why = dict(findings.plan.left_out).get("natural frequencies", lacking)
        section = "analyses" if findings.study.analyses else "train"
        hint = "name `modes` in `analyses`" if modes is None and findings.study.analyses else ""
        raise InputError([Fault((section,), f"no mode shape to write: {why}", hint)])
    ends = np.column_stack([system.driving, system.driven])
    points = coordinates(system)
    # The radius (spans, 2) at both ends of every span in m.
    bars = {bar.part: bar for bar in system.train.bars}
    mean = sum(sum(bar.outer) / 4 for bar in bars.values()) / len(bars) if bars else LENGTH / 4
    radius = np.full(ends.shape, THIN * mean)
    for span, stations in enumerate(ends):
        bar = bars.get(int(system.span_part[span]))
        if bar is not None:
            share = (points[stations, 0] - points[bar.driving, 0]) / bar.length
            radius[span] = (bar.outer[0] + (bar.outer[1] - bar.outer[0]) * share) / 2
    cells = [("line", np.arange(ends.size).reshape(-1, 2))]

    at_points: dict[str, FloatArray] = {"radius": radius.ravel()}
    at_cells: dict[str, list[FloatArray]] = {"component": [system.span_part.astype(float)]}
    digits = max(2, len(str(modes.frequency.size)))
    for mode, (angle, torque) in enumerate(zip(modes.shape.T, modes.torque.T, strict=True), 1):
        name = f"mode_{mode:0{digits}}"
        at_points[f"{name}_angle"] = angle[ends].ravel()
        at_points[f"{name}_angle_relative"] = (angle / np.abs(angle).max())[ends].ravel()
        at_cells[f"{name}_torque"] = [torque]

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / NAME
        mesh = meshio.Mesh(
            points[ends].reshape(-1, 3), cells, point_data=at_points, cell_data=at_cells
        )
        mesh.write(path, file_format="vtu")
        return path.read_bytes()


def coordinates(system: System) -> FloatArray:
    """Return the points (stations, 3) in m: x along the train, y across it for branches; shafts have their length."""
    bars, unit = system.train.bars, UNIT
    if bars:
        width = system.train.parts[bars[0].part].symbol.width
        unit = sum(bar.length for bar in bars) / len(bars) / width
    places = layout(system, {bar.part: bar.length / unit for bar in bars})
    return unit * np.column_stack([places.x, -places.row, np.zeros(places.x.size)])
