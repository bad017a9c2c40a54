"""Chapter: the response over a frequency range."""

from collections.abc import Callable

import numpy as np

from torsion.analyses.response.amplitudes import FrequencyResponse
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Block, Column, Figure, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import elements
from torsion.output.numbers import NONE, Scale, degrees, number
from torsion.output.selection import NO_VALUE, largest, strongest, torques

MOST_LINES = 10
DEGREES = Scale("deg", 180.0 / np.pi)
Shown = Callable[[float], str]


def chapter(findings: Findings) -> list[Block]:
    """Nothing where no frequencies were requested."""
    sweep = findings.get(FrequencyResponse)
    if sweep is None:
        return []
    bad, found = sweep.status != Status.OK, elements(findings.system)
    stations = [(k, s.name) for k, s in enumerate(findings.study.train.stations) if not s.is_ground]
    torque = {e.name: np.where(bad, np.nan, e.largest(np.abs(sweep.torque))) for e in found}
    angle = {name: np.where(bad, np.nan, np.abs(sweep.angle[:, k])) for k, name in stations}
    unit = torques(torque.values())
    text = "The torques that act at every frequency, without regard to the speed; amplitudes are half ranges."
    blocks: list[Block] = [Heading("Response over the frequency range"), Paragraph(text)]
    if bad.any():
        at = ", ".join(dict.fromkeys(number(f, 5) for f in sweep.frequency[bad].tolist()))
        text = (
            f"At {at} Hz the response has no reliable finite value (undamped resonance). No amplitude is stated there, "
            "nor a largest one of the range; give the damping of the train."
        )
        blocks.append(Paragraph(text, "note"))
    if found:
        columns = head(f"< Element | Amplitude [{unit.unit}] | At frequency [Hz]")
        blocks.append(_table("Largest torque amplitude", columns, sweep.frequency, torque, (unit.text,)))
        blocks.append(_figure(findings, "torque", torque, unit))
    columns = head("< Station | Amplitude [rad] | Amplitude [deg] | At frequency [Hz]")
    table = _table("Largest angular amplitude", columns, sweep.frequency, angle, (number, degrees))
    return [*blocks, table, _figure(findings, "angle", angle, DEGREES)]


def _figure(findings: Findings, what: str, curves: dict[str, FloatArray], unit: Scale) -> Figure:
    sweep, modes = findings.need(FrequencyResponse), findings.get(Modes)
    name = {"torque": "torque amplitude", "angle": "angular amplitude"}[what]
    values, names = np.array(list(curves.values())).reshape(len(curves), -1), list(curves)
    drawn = {
        "frequency": sweep.frequency, "bad": sweep.status != Status.OK,
        "natural": [] if modes is None else modes.frequency.tolist(), "quantity": f"{name}, {unit.unit}",
        "lines": [(names[k], values[k] * unit.factor) for k in strongest(values.T, MOST_LINES)],
    }  # fmt: skip
    return Figure(f"sweep-{what}", f"{name.capitalize()} over the frequency", "frequency", drawn)


def _table(
    caption: str,
    columns: tuple[Column, ...],
    frequency: FloatArray,
    curves: dict[str, FloatArray],
    shown: tuple[Shown, ...],
) -> Table:
    """The largest of every curve, in each of the units that are shown, and its frequency."""
    rows = []
    for name, values in curves.items():
        at = largest(values)
        if at is None:
            rows.append((name, NO_VALUE, *[NONE] * len(shown)))
        else:
            rows.append((name, *(one(float(values[at])) for one in shown), number(float(frequency[at]))))
    return Table(columns, tuple(rows), caption)
