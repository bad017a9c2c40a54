"""Chapter: centrifugal pendulums, the inertia that each order meets, and their deflection."""

import math
from collections.abc import Iterator

from torsion.analyses.response.pendulums import Pendulums
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.numbers import NONE, given, number, order, rpm

FAR = math.radians(
    30.0
)  # of deflection: beyond it a linear pendulum is off by more than 2 % of its order
WHAT = (
    "A pendulum of order q = sqrt(R/l) adds the inertia m (R + l)²/(1 − n²/q²) to its carrier at order n. The"
    " inertia is larger than the mass inertia below q and negative above; at n = q the carrier is fixed for "
    "this order. The restoring force is the centrifugal force, so that natural frequencies depend on the "
    "speed. Modes are for {} rpm. At rest the bobs add nothing."
)
LINEAR = (
    "Deflections are linear. On a circular path a deflection φ lowers the order by about φ²/16 (1.7 % at 30 "
    "degrees). Larger deflections: {}."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Each pendulum, then each by order."""
    found = findings.need(Pendulums)
    yield Heading("Pendulums")
    yield Paragraph(WHAT.format(NONE if found.speed is None else rpm(found.speed)))
    far = [
        one.pendulum for one in found.each if one.deflection is not None and one.deflection > FAR
    ]
    if far:
        yield Paragraph(LINEAR.format(", ".join(far)), "note")
    rows = [
        (
            one.pendulum,
            given(one.tuned, 8),
            number(one.inertia, 7),
            _degrees(one.deflection),
            _rpm(one.speed),
        )
        for one in found.each
    ]
    yield table(
        "< Pendulum -> | Tuned to order -> order | Inertia of the bobs [kg m²] | Maximum deflection [deg] -> deg | "
        "Speed [rpm] -> rpm",
        rows,
        "Pendulums, at the speed of their shaft",
    )
    by_order = [
        (
            one.pendulum,
            order(each.order),
            "fixed" if each.inertia is None else number(each.inertia, 7),
            _degrees(each.deflection),
            _rpm(each.speed),
        )
        for one in found.each
        for each in one.at_orders
    ]
    if by_order:
        titles = "< Pendulum -> | Order of the shaft -> order | Inertia [kg m²] | Deflection [deg] -> deg | "
        yield table(
            titles + "Speed [rpm] -> rpm", by_order, "Inertia and deflection of pendulums by order"
        )


def _degrees(angle: float | None) -> str | None:
    return None if angle is None else number(math.degrees(angle))


def _rpm(speed: float | None) -> str | None:
    return None if speed is None else rpm(speed)
