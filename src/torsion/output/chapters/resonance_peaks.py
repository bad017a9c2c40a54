"""The table of peaks: local maxima of every line in every element, with the critical speed they belong to."""

from dataclasses import dataclass

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Table, head
from torsion.output.elastic_elements import Element
from torsion.output.numbers import NONE, Scale, number, order, rpm
from torsion.output.reported_values import amplitude
from torsion.output.selection import highest

SMALLEST = 0.02  # of the element's largest torque of one line; a lower peak is not listed
MOST_ROWS = 40
SAME = 0.03  # relative distance of a peak from its natural frequency, or twice the damping ratio (half-power width)


@dataclass(frozen=True)
class Peak:
    """A local maximum of one line in one element."""

    element: Element
    line: int
    at: int  # position of the speed
    torque: float  # N m


def local_maxima(values: FloatArray) -> list[int]:
    """Inner places where the values are larger than on both sides; a place without a value is no neighbour."""
    filled = np.where(np.isfinite(values), values, np.inf)
    inner = (filled[1:-1] > filled[:-2]) & (filled[1:-1] >= filled[2:]) & np.isfinite(values[1:-1])
    return (np.flatnonzero(inner) + 1).tolist()


def found_peaks(findings: Findings, elements: list[Element]) -> list[Peak]:
    """All peaks worth listing, by element, the largest first."""
    found: list[Peak] = []
    for element in elements:
        parts = amplitude(findings, element.spans)
        top = highest(parts)
        mine = [
            Peak(element, line, at, float(parts[at, line]))
            for line in range(parts.shape[1])
            for at in local_maxima(parts[:, line])
            if parts[at, line] >= SMALLEST * top
        ]
        found.extend(sorted(mine, key=lambda peak: -peak.torque))
    return found


def peaks(findings: Findings, elements: list[Element], unit: Scale) -> Table:
    """The peaks as a table; where there are too many, the largest referred to one speed."""
    response = findings.need(Response)
    found = found_peaks(findings, elements)
    size = [-peak.torque * peak.element.ratio for peak in found]
    kept = sorted(sorted(range(len(found)), key=size.__getitem__)[:MOST_ROWS])
    columns = head(
        f"< Element | Line | Torque amplitude [{unit.unit}] | At speed [rpm] | Frequency [Hz] | Mode | < Sources"
    )
    rows = []
    for peak in (found[place] for place in kept):
        line, frequency = response.lines[peak.line], float(response.frequency[peak.at, peak.line])
        name = f"order {order(line.order)}" if line.order is not None else "fixed"
        rows.append((
            peak.element.name, name, unit.text(peak.torque), rpm(float(response.speed[peak.at])), number(frequency),
            _mode(findings, frequency), ", ".join(dict.fromkeys(line.sources)),
        ))  # fmt: skip
    rest = f"; the {len(kept)} largest of {len(found)}" if len(kept) < len(found) else ""
    caption = (
        f"Resonance peaks in the speed range (inner maxima of one line; below {100 * SMALLEST:g} % left out{rest})"
    )
    return Table(columns, tuple(rows), caption)


def _mode(findings: Findings, frequency: float) -> str:
    """The mode whose frequency is nearest, if it is near."""
    source = findings.get(DampedModes) if findings.get(DampedModes) is not None else findings.get(Modes)
    if source is None or len(source.frequency) == 0:
        return NONE
    distance = np.abs(source.frequency / frequency - 1.0)
    nearest = int(np.argmin(distance))
    ratio = float(findings.need(DampedModes).damping_ratio[nearest]) if findings.get(DampedModes) is not None else 0.0
    return str(nearest + 1) if distance[nearest] <= max(SAME, 2.0 * ratio) else NONE
