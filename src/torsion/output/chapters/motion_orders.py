"""Section of a motion over time: its torques by orders of a shaft, largest amplitudes and a waterfall."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.motion.order_tracking import TURNS, OrderTracking, TrackedTorque
from torsion.output.blocks import Block, Paragraph, table
from torsion.output.figures import orders_over_speed
from torsion.output.figures.figure import Axis
from torsion.output.numbers import RPM, counted, degrees, given, number, scale

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
    rows = [
        (
            torque.element,
            order,
            float(torque.largest[k]),
            float(tracking.speed[window]),
            float(tracking.time[window]),
            degrees(float(np.angle(torque.torque[window, k])), 3),
        )
        for torque in tracking.each
        for k, (order, window) in enumerate(
            zip(tracking.order.tolist(), torque.window.tolist(), strict=True)
        )
    ]
    if rows:
        titles = f"< Component | Order of {reference} | Maximum amplitude [~N m] | at [rpm] | at [s] | Phase [°]"
        text = "Orders: maximum amplitude and phase against the angle of the reference"
        yield table(titles, rows, text)
    for torque in tracking.each:
        yield from _figures(tracking, torque, name)


def _figures(tracking: OrderTracking, tracked: TrackedTorque, name: str) -> Iterator[Block]:
    """Amplitudes over the speed, or over the time where the speed does not go one way."""
    if len(tracking.time) < 2:
        return
    position, over = tracking.speed * RPM, Axis(f"speed of {tracking.reference}", "rpm")
    steps = np.diff(position)
    if not ((steps > 0.0).all() or (steps < 0.0).all()):
        position, over = tracking.time, Axis("time", "s")
    sort = np.argsort(position)
    amplitude = tracked.waterfall[sort, MEAN:]
    unit = scale("N m", amplitude.max(axis=1))
    element = tracked.element
    mark, words = f"{name} {element}".lstrip(), element + (f", {name}" if name else "")
    sizes = np.abs(tracked.torque[sort]) * unit.factor
    numbers = tracking.order.tolist()
    lines = [(f"order {given(order)}", sizes[:, k]) for k, order in enumerate(numbers)]
    if lines:
        yield orders_over_speed.orders(
            f"orders {mark}",
            f"Orders of the torque in {words}",
            over=over,
            x=position[sort],
            lines=lines,
            unit=unit.unit,
        )
    multiples = np.arange(float(MEAN), tracked.waterfall.shape[1]) * tracking.resolution
    yield orders_over_speed.waterfall(
        f"waterfall {mark}",
        f"Waterfall of the torque in {words}, without its mean: the darker the larger",
        over=over,
        y=position[sort],
        order=multiples,
        amplitude=amplitude * unit.factor,
        reference=tracking.reference,
        unit=unit.unit,
    )
