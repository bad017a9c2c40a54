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
    """The figure with every critical speed of the train, in the speed range or not."""
    known = findings.get(CriticalSpeeds)
    found = () if known is None else known.crossings
    orders = {one.order: order(one.order) for one in found}
    return _with(figure, "critical speed", found, orders, rated_rpm(findings))


def of_bending(shaft: "ShaftFound", figure: Figure) -> Figure:
    """The figure with every critical speed of the bending of its shaft."""
    orders = {one.order: str(one.order) for one in shaft.critical}
    return _with(figure, f"critical speed of bending of {shaft.name}", shaft.critical, orders, None)


def _with(
    figure: Figure,
    of: str,
    found: "Sequence[CriticalSpeed | Critical]",
    orders: Mapping[Any, str],
    rated: float | None,
) -> Figure:
    if not found:
        return figure
    place = {one: k for k, one in enumerate(orders)}
    return replace(
        figure,
        criticals=Criticals(
            of,
            np.array([one.speed * RPM for one in found]),
            np.array([one.frequency for one in found]),
            np.array([one.mode for one in found]),
            np.array([place[one.order] for one in found]),
            tuple(f"order {words}" for words in orders.values()),
            rated,
        ),
    )
