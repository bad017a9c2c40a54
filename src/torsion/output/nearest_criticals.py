"""The critical speeds that belong to a figure: of torsion, or of the bending of one shaft."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.findings import Findings
from torsion.output.figures.figure import Criticals, Figure
from torsion.output.numbers import RPM, order
from torsion.output.reported_values import rated_rpm

if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import ShaftFound
    from torsion.analyses.lateral.whirl import Critical


def of_torsion(findings: Findings, figure: Figure) -> Figure:
    """Return the figure with every critical speed of the train, in the speed range or not."""
    result = findings.get(CriticalSpeeds)
    crossings = () if result is None else result.crossings
    orders = {crossing.order: order(crossing.order) for crossing in crossings}
    return _with(figure, "critical speed", crossings, orders, rated_rpm(findings))


def of_bending(shaft: "ShaftFound", figure: Figure) -> Figure:
    """Return the figure with every critical speed of the bending of its shaft."""
    orders = {crossing.order: str(crossing.order) for crossing in shaft.critical}
    return _with(figure, f"critical speed of bending of {shaft.name}", shaft.critical, orders, None)


def _with(
    figure: Figure,
    of: str,
    crossings: "Sequence[CriticalSpeed | Critical]",
    orders: Mapping[Any, str],
    rated: float | None,
) -> Figure:
    if not crossings:
        return figure
    row_of = {order_value: k for k, order_value in enumerate(orders)}
    return replace(
        figure,
        criticals=Criticals(
            of,
            np.array([crossing.speed * RPM for crossing in crossings]),
            np.array([crossing.frequency for crossing in crossings]),
            np.array([crossing.mode for crossing in crossings]),
            np.array([row_of[crossing.order] for crossing in crossings]),
            tuple(f"order {words}" for words in orders.values()),
            rated,
        ),
    )
