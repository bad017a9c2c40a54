"""Chapter: the motion over time."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.transient.transient_motion import TransientMotion
from torsion.analyses.transient.transient_settings import TransientSettings
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, RPM, Scale, counted, number, rpm, scale
from torsion.output.selection import Element, elements

MOST_CURVES = 5  # in the figures: of the elements with the largest torque
COLUMNS = 1000  # of the figures: each shows the least and the greatest value of its samples
METHOD = (
    "Exact at every sample: every mode answers the events in closed form, and the torque of a span is the sum over the "
    "modes. Losses of material act as modal damping, by their share of the energy."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where no motion was requested."""
    found = findings.get(TransientMotion)
    settings = findings.study.analyses.get("transient")
    if found is None or not isinstance(settings, TransientSettings):
        return
    rows = _rows(findings, found)
    unit = scale("N m", [value for _, values, _ in rows for value in values[:4]])
    yield Heading("Motion over time")
    yield Paragraph(_introduction(found, settings))
    yield table(
        "< At | < Event | Begins at [s] | < Settings",
        [(event.at, event.kind, event.time, event.words()) for event in settings.events],
        "Events; torques at the point's own speed",
    )
    yield _peaks(rows, unit)
    if found.unresolved.any():
        text = (
            "Modes that have fewer than 4 samples in a period add at most what the last column says; verdicts add it "
            "to the peak. More `samples` resolve them."
        )
        yield Paragraph(text, "note")
    yield from _figures(findings, found, unit)


def _introduction(found: TransientMotion, settings: TransientSettings) -> str:
    before = f"at {rpm(found.speed_before)} rpm" if found.speed_before else "at rest"
    return (
        f"{number(settings.duration)} s from a train {before}, in {counted(len(found.time), 'sample')}, of "
        f"{counted(found.modes, 'elastic mode')}. {METHOD} The balance of energy holds to {number(found.residual, 2)} "
        "of the largest energy."
    )


def _rows(findings: Findings, found: TransientMotion) -> list[tuple[Element, tuple[float, ...], int]]:
    """Of every element: greatest and least torque with their times, mean torque before, bound; and its reversals."""
    rows = []
    for element in elements(findings.system):
        spans = np.array(list(element.spans))
        high, low = spans[found.greatest[spans].argmax()], spans[found.least[spans].argmin()]
        values = (
            found.greatest[high], found.least[low], found.before[spans[0]], found.unresolved[spans].max(),
            found.greatest_at[high], found.least_at[low],
        )  # fmt: skip
        rows.append((element, tuple(map(float, values)), int(found.reversals[spans].max())))
    return rows


def _peaks(rows: list[tuple[Element, tuple[float, ...], int]], unit: Scale) -> Table:
    titles = (
        f"< Element -> | Greatest torque [{unit.unit}] -> greatest | at [s] -> at "
        f"| Least torque [{unit.unit}] -> least | at [s] | Before [{unit.unit}] "
        f"| Largest / before -> times | Reversals -> | Not sampled [{unit.unit}]"
    )
    cells = [
        (element.name, unit.text(high), high_at, unit.text(low), low_at, unit.text(before),
         number(max(abs(high), abs(low)) / abs(before), 3) if before else NONE, reversals, unit.text(missed))
        for element, (high, low, before, missed, high_at, low_at), reversals in rows
    ]  # fmt: skip
    return table(titles, cells, "Torques of the motion, mean torque included", short="Motion over time")


def _figures(findings: Findings, found: TransientMotion, unit: Scale) -> Iterator[Block]:
    every = sorted(elements(findings.system), key=lambda one: -float(found.peak[list(one.spans)].max()))[:MOST_CURVES]
    curves = [
        (one.name, found.torque[max(one.spans, key=lambda span: found.peak[span])] * unit.factor) for one in every
    ]
    for name, values in curves:
        drawn = {**envelope(found.time, [(name, values)]), "quantity": f"torque, {unit.unit}"}
        yield Figure(f"motion {name}", f"Torque in {name} over time", "over time", drawn)
    stations = [(k, s.name) for k, s in enumerate(findings.study.train.stations) if not s.is_ground]
    ends = [stations[0], stations[-1]] if len(stations) > 1 else stations
    speeds = [(name, found.speed[k] * RPM) for k, name in ends]
    drawn = {**envelope(found.time, speeds), "quantity": "own speed, rpm"}
    yield Figure("motion speeds", "Speed of both ends of the train over time", "over time", drawn)


def envelope(time: np.ndarray, curves: list[tuple[str, np.ndarray]]) -> dict[str, object]:
    """The least and the greatest of the samples of each of COLUMNS equal parts of the time, for every curve."""
    if len(time) <= 2 * COLUMNS:
        return {"time": time, "lines": [(name, values, values) for name, values in curves]}
    edges = np.linspace(0, len(time) - 1, COLUMNS + 1).astype(int)[:-1]
    lines = [
        (name, *(np.asarray(function.reduceat(values, edges)) for function in (np.minimum, np.maximum)))
        for name, values in curves
    ]
    return {"time": time[edges], "lines": lines}
