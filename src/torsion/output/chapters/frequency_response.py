"""Chapter: the response over a frequency range."""

import numpy as np

from torsion.analyses.response.amplitudes import FrequencyResponse
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Block, Column, Figure, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import elements
from torsion.output.numbers import NONE, degrees, number, scale
from torsion.output.reported_values import NO_VALUE, largest

MOST_LINES = 10


def chapter(findings: Findings) -> list[Block]:
    """Nothing where no frequencies were asked."""
    sweep = findings.get(FrequencyResponse)
    if sweep is None:
        return []
    bad = sweep.status != Status.OK
    natural = [] if findings.get(Modes) is None else findings.need(Modes).frequency.tolist()
    found = elements(findings.system)
    torque = np.array([np.where(bad, np.nan, e.largest(np.abs(sweep.torque))) for e in found])
    torque = torque.reshape(len(found), sweep.frequency.size)
    own = [k for k, s in enumerate(findings.study.train.stations) if not s.is_ground]
    angle = np.where(bad, np.nan, np.abs(sweep.angle[:, own]).T)
    unit = scale("N m", [float(np.nanmax(np.append(torque, 0.0)))])
    common = {"frequency": sweep.frequency, "bad": bad, "natural": natural}
    names = [e.name for e in found]
    stations = [findings.study.train.stations[k].name for k in own]
    blocks: list[Block] = [
        Heading("Response over the frequency range"),
        Paragraph("The torques that act at every frequency, without regard to the speed; amplitudes are half ranges."),
        *_unknown(sweep.frequency[bad]),
    ]
    if found:
        blocks += [
            _table("Largest torque amplitude", "Element", names, torque * unit.factor, unit.unit, sweep.frequency),
            Figure("sweep-torque", "Torque amplitude over the frequency", "frequency", {
                **common, "lines": _lines(names, torque * unit.factor), "quantity": f"torque amplitude, {unit.unit}"}),
        ]  # fmt: skip
    return [
        *blocks, _table("Largest angular amplitude", "Station", stations, angle, "rad", sweep.frequency),
        Figure("sweep-angle", "Angular amplitude over the frequency", "frequency",
               {**common, "lines": _lines(stations, np.degrees(angle)), "quantity": "angular amplitude, deg"}),
    ]  # fmt: skip


def _unknown(frequency: np.ndarray) -> list[Block]:
    """That no amplitude is stated at the frequencies without a reliable one; nothing where there is none."""
    if frequency.size == 0:
        return []
    text = (
        f"At {', '.join(dict.fromkeys(number(f, 5) for f in frequency.tolist()))} Hz the response has no reliable "
        "finite value (undamped resonance). No amplitude is stated there, nor a largest one of the range; give the "
        "damping of the train."
    )
    return [Paragraph(text, "note")]


def _lines(names: list[str], values: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """The largest of the lines, in their order."""
    size = np.nanmax(np.where(np.isfinite(values), values, 0.0), axis=1, initial=0.0)
    kept = sorted(np.argsort(-size, kind="stable")[:MOST_LINES].tolist())
    return [(names[k], values[k]) for k in kept if size[k] > 0]


def _table(caption: str, what: str, names: list[str], values: np.ndarray, unit: str, frequency: np.ndarray) -> Table:
    in_degrees = unit == "rad"
    columns = [
        Column(what, align="left"),
        *head(f"Amplitude [{unit}] | At frequency [Hz]"),
    ]
    if in_degrees:
        columns.insert(2, Column("Amplitude", "deg"))
    rows = []
    for name, row in zip(names, values, strict=True):
        at = largest(row)
        if at is None:
            rows.append((name, NO_VALUE, *[NONE] * (len(columns) - 2)))
            continue
        more = [degrees(float(row[at]))] if in_degrees else []
        rows.append((name, number(float(row[at])), *more, number(float(frequency[at]))))
    return Table(tuple(columns), tuple(rows), caption)
