"""Section of a motion over time: its torques by orders of a shaft, largest amplitudes and a waterfall."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.motion.derived.order_tracking import TURNS, OrderTracking, TrackedTorque
from torsion.output.blocks import Block, Paragraph, table
from torsion.output.figures.figure import Axis, Cells, Figure, Panel
from torsion.output.figures.ranges import amplitudes, span
from torsion.output.figures.ranges import orders as ordered_lines
from torsion.output.numbers import RPM, counted, given, number, scale
from torsion.output.records import Place, along

DECADES = 3.0  # below the largest amplitude that shades show
TORQUE = "torque amplitude"
MEAN = 2  # orders from 0 on in which, by the Hann window, the mean torque stands


def orders(tracking: OrderTracking | None, name: str) -> Iterator[Block]:
    """What the tracking says; `name` is that of the motion."""
    if tracking is None:
        return
    reference = tracking.reference
    if tracking.turns < TURNS:
        text = f"{reference} makes {number(tracking.turns, 3)} revolutions; below {TURNS} no order is reported."
        yield Paragraph(text, "note")
        return
    left = ""
    if tracking.left_out:
        omitted = counted(tracking.left_out, "window")
        left = f" {omitted} omitted: the samples do not resolve the motion."
    yield Paragraph(
        f"Order analysis of the torques at equal angles of {reference}, in {len(tracking.time)} windows of {TURNS} "
        f"revolutions (Hann); order resolution 1/{TURNS}. With half as many samples no amplitude changes by more than "
        f"{number(tracking.aliased, 2)} of the maximum.{left}"
    )
    windows = along(tracking, "window")
    rows = [
        (order, torque_at, windows[k], Place(torque_at, "window", k))
        for torque in tracking.each
        for order, torque_at, k in zip(
            along(tracking, "order"), along(torque, "order"), torque.window.tolist(), strict=True
        )
    ]
    if rows:
        titles = (
            f"element: < Component | 1.order: Order of {reference}:g | largest: Maximum amplitude [~N m] | "
            "speed: at [rpm] | time: at [s] | torque: Phase [deg]:3pg"
        )
        text = "Orders: maximum amplitude and phase against the angle of the reference"
        yield table(titles, rows, text)
    for torque in tracking.each:
        yield from _figures(tracking, torque, name)


def _figures(tracking: OrderTracking, tracked: TrackedTorque, name: str) -> Iterator[Block]:
    """Amplitudes over the speed, or over the time where the speed does not go one way, as curves and as a waterfall."""
    if len(tracking.time) < 2:
        return
    x, over = tracking.speed * RPM, Axis(f"speed of {tracking.reference}", "rpm")
    steps = np.diff(x)
    if not ((steps > 0.0).all() or (steps < 0.0).all()):
        x, over = tracking.time, Axis("time", "s")
    sort = np.argsort(x)
    x, amplitude = x[sort], tracked.waterfall[sort, MEAN:]
    unit, over = scale("N m", amplitude.max(axis=1)), span(over, x)
    mark = f"{name} {tracked.element}".lstrip()
    words = tracked.element + (f", {name}" if name else "")
    sizes = np.abs(tracked.torque[sort]) * unit.factor
    lines = [
        (f"order {given(order)}", sizes[:, k]) for k, order in enumerate(tracking.order.tolist())
    ]
    if lines:
        drawn = ordered_lines(x, lines, np.zeros(len(x), dtype=bool))
        panel = Panel(over, amplitudes(TORQUE, unit.unit, [sizes]), drawn)
        yield Figure(f"orders {mark}", f"Orders of the torque in {words}", (panel,))
    order = np.arange(float(MEAN), tracked.waterfall.shape[1]) * tracking.resolution
    size = amplitude * unit.factor
    cells = Cells(order, x, size, TORQUE, unit.unit, float(size.max()) or 1.0, DECADES)
    across = Axis(f"order of {tracking.reference}", "", 0.0, float(order[-1]))
    caption = f"Waterfall of the torque in {words}, without its mean: the darker the larger"
    yield Figure(f"waterfall {mark}", caption, (Panel(across, over, cells=cells, height=210.0),))
