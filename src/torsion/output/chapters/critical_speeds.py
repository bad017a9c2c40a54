"""Chapter: critical speeds, order by mode, and the Campbell diagram."""

from fractions import Fraction

from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Figure, Heading, Paragraph, Table, head
from torsion.output.numbers import NONE, RPM, given_rpm, number, order, rpm
from torsion.output.reported_values import barred_rpm, rated, rated_rpm, reference

MOST_ORDERS = 12  # in the figure
MOST_ROWS = 60


def chapter(findings: Findings) -> list[Block]:
    """Nothing where no order excites or no speed range is given."""
    speeds = findings.study.operation.speeds
    if findings.get(Modes) is None or not findings.need(CriticalSpeeds).crossings or speeds is None:
        return []
    inside = [c for c in findings.need(CriticalSpeeds).crossings if c.is_inside]
    text = (
        f"A speed of {reference(findings)} is critical where an order that is excited meets a natural frequency. "
        f"{_inside(len(inside), len(findings.need(CriticalSpeeds).crossings))} in the speed range "
        f"{given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm."
    )
    return [
        Heading("Critical speeds"), Paragraph(text), _matrix(findings), _list(findings),
        Figure("campbell", "Campbell diagram", "campbell", _diagram(findings)),
    ]  # fmt: skip


def _inside(inside: int, total: int) -> str:
    """How many of the critical speeds lie in the range, as the subject and the verb of a sentence."""
    if total == 1:
        return "The only such speed lies" if inside else "The only such speed does not lie"
    return f"Of {total} such speeds {inside if inside else 'none'} {'lie' if inside > 1 else 'lies'}"


def _orders(findings: Findings) -> list[Fraction]:
    return sorted({c.order for c in findings.need(CriticalSpeeds).crossings})


def _matrix(findings: Findings) -> Table:
    """Order by mode."""
    modes = sorted({c.mode for c in findings.need(CriticalSpeeds).crossings})
    at = {(c.order, c.mode): c for c in findings.need(CriticalSpeeds).crossings}
    columns = (Column("Order"), *(Column(f"Mode {mode}", "rpm") for mode in modes))
    rows = []
    for value in _orders(findings):
        cells = [at.get((value, mode)) for mode in modes]
        rows.append(
            (order(value), *(NONE if c is None else rpm(c.speed) + (" *" if c.is_inside else "") for c in cells))
        )
    return Table(columns, tuple(rows), "Critical speeds, order by mode (* in the speed range)")


def _list(findings: Findings) -> Table:
    """The critical speeds in the range, and how far they lie from the rated speed."""
    speed = rated(findings)
    columns = [
        *head("Critical speed [rpm] -> rpm | Order -> | Mode -> | Frequency [Hz]"),
        *([Column("Distance from rated", "%")] if speed else []),
        *head("< Sources -> excited by"),
    ]  # fmt: skip
    inside = sorted((c for c in findings.need(CriticalSpeeds).crossings if c.is_inside), key=lambda c: c.speed)
    rows = []
    for c in inside[:MOST_ROWS]:
        own = [number(100 * (c.speed / speed - 1), 3)] if speed else []
        rows.append((rpm(c.speed), order(c.order), str(c.mode), number(c.frequency), *own, ", ".join(c.sources)))
    rest = f" (the lowest {MOST_ROWS} of {len(inside)})" if len(inside) > MOST_ROWS else ""
    title = "Critical speeds in the speed range"
    return Table(tuple(columns), tuple(rows), title + rest, short=title)


def _diagram(findings: Findings) -> dict[str, object]:
    speeds, modes = findings.study.operation.speeds, findings.get(Modes)
    if speeds is None or modes is None:
        return {}
    orders = _orders(findings)
    met = {c.order for c in findings.need(CriticalSpeeds).crossings if c.is_inside}
    shown = sorted([*[o for o in orders if o in met], *[o for o in orders if o not in met]][:MOST_ORDERS])
    return {
        "frequencies": modes.frequency.tolist(),
        "orders": [(float(o), f"order {order(o)}") for o in shown],
        "crossings": [
            (c.speed * RPM, c.frequency, c.is_inside)
            for c in findings.need(CriticalSpeeds).crossings
            if c.order in shown
        ],
        "speeds": (speeds.first * RPM, speeds.last * RPM),
        "rated": rated_rpm(findings),
        "barred": barred_rpm(findings),
    }
