"""Section of a motion over time: its torques by orders of a shaft, largest amplitudes and a waterfall."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.motion.order_tracking import TURNS, OrderTracking, TrackedTorque
from torsion.output.blocks import Block, Paragraph, table
from torsion.output.figures import orders_over_speed
from torsion.output.figures.figure import Axis
from torsion.output.numbers import RPM, counted, degrees, given, number, rpm, scale

MEAN = 2  # orders from 0 on in which, by the Hann window, the mean torque stands


def orders(found: OrderTracking | None, name: str) -> Iterator[Block]:
    """What the tracking says; `name` is that of the motion."""
    if found is None:
        return
    if found.turns < TURNS:
        text = f"{found.reference} makes {number(found.turns, 3)} revolutions; below {TURNS} no order is reported."
        yield Paragraph(text, "note")
        return
    left = (
        f" {counted(found.left_out, 'window')} omitted: the samples do not resolve the motion."
        * bool(found.left_out)
    )
    yield Paragraph(
        f"Order analysis of the torques at equal angles of {found.reference}, in {len(found.time)} windows of {TURNS} "
        f"revolutions (Hann); order resolution 1/{TURNS}. With half as many samples no amplitude changes by more than "
        f"{number(found.aliased, 2)} of the maximum.{left}"
    )
    rows = [row for one in found.each for row in _largest(found, one)]
    if rows:
        unit = scale("N m", [row[2] for row in rows])
        titles = f"< Component | Order of {found.reference} | Maximum amplitude [{unit.unit}] | at [rpm] | at [s] | "
        titles += "Phase [°]"
        cells = [(element, order, unit.text(size), *more) for element, order, size, *more in rows]
        yield table(
            titles, cells, "Orders: maximum amplitude and phase against the angle of the reference"
        )
    for one in found.each:
        yield from _figures(found, one, name)


def _largest(
    found: OrderTracking, one: TrackedTorque
) -> Iterator[tuple[str, str, float, str, str, str]]:
    for k, (order, window) in enumerate(
        zip(found.order.tolist(), one.window.tolist(), strict=True)
    ):
        turn = float(np.angle(one.torque[window, k]))
        at = rpm(float(found.speed[window])), number(float(found.time[window]))
        yield one.element, number(order), float(one.largest[k]), *at, degrees(turn, 3)


def _figures(found: OrderTracking, one: TrackedTorque, name: str) -> Iterator[Block]:
    """Amplitudes over the speed, or over the time where the speed does not go one way."""
    if len(found.time) < 2:
        return
    at, over = found.speed * RPM, Axis(f"speed of {found.reference}", "rpm")
    if not ((np.diff(at) > 0.0).all() or (np.diff(at) < 0.0).all()):
        at, over = found.time, Axis("time", "s")
    sort = np.argsort(at)
    amplitude = one.waterfall[sort, MEAN:]
    unit = scale("N m", amplitude.max(axis=1))
    mark, of = f"{name} {one.element}".lstrip(), f"{one.element}" + (f", {name}" if name else "")
    sizes = np.abs(one.torque[sort]) * unit.factor
    lines = [(f"order {given(order)}", sizes[:, k]) for k, order in enumerate(found.order.tolist())]
    if lines:
        yield orders_over_speed.orders(
            f"orders {mark}",
            f"Orders of the torque in {of}",
            over=over,
            x=at[sort],
            lines=lines,
            unit=unit.unit,
        )
    every = np.arange(float(MEAN), one.waterfall.shape[1]) * found.resolution
    yield orders_over_speed.waterfall(
        f"waterfall {mark}",
        f"Waterfall of the torque in {of}, without its mean: the darker the larger",
        over=over,
        y=at[sort],
        order=every,
        amplitude=amplitude * unit.factor,
        reference=found.reference,
        unit=unit.unit,
    )
