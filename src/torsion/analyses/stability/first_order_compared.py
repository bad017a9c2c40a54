"""The largest torques of a train with joints by both methods: the first-order and the exact periodic response."""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import rounding
from torsion.analyses.response.synthesis import half_range_of
from torsion.analyses.stability.periodic_orbits import Found, PeriodicResponse
from torsion.arrays import FloatArray
from torsion.assembly.elements import Element, elements
from torsion.findings import Results
from torsion.results import derived, reported, result

SMALLEST = 0.01  # of an element's largest torque: smaller orders are not compared


@reported
class ComparedTorque:
    """The largest torque of an element over the speed by both methods, of one order or of all together."""

    component: str = result("name of the element")
    order: Fraction | None = result("of the reference, exact; null: the total of all orders")
    first: float | None = result("N*m", "of the first order; null without a reliable value")
    first_speed: float | None = result("rad/s", "reference speed of that")
    exact: float = result("N*m", "of the exact periodic response")
    exact_speed: float = result("rad/s", "reference speed of that")
    is_coarse: bool = result("the periodic motion there lacks harmonics")
    is_unstable: bool = result("the train does not settle in the periodic motion there")

    @derived("1", "(exact - first order) / first order; null where that is missing or 0")
    def excess(self) -> float:
        return self.exact / self.first - 1.0 if self.first else math.nan


@reported
class FirstOrderCompared:
    """Every element that carries torque, each in the orders that matter."""

    each: tuple[ComparedTorque, ...] = result("largest torques by both methods", key="")


def compare_first_order(evidence: Results) -> FirstOrderCompared:
    """Return all orders together (where no torque has a fixed frequency), then each, of every element with torque."""
    response = evidence.need(Response)
    periodic = evidence.need(PeriodicResponse)
    orders = [line.order for line in response.lines]
    all_nothing = rounding(evidence)

    def compare(
        element: Element, order: Fraction | None, first: FloatArray | None, exact: FloatArray
    ) -> ComparedTorque:
        # Below that a torque (N m) is rounding and reported as 0.
        nothing = all_nothing[list(element.spans)].min()
        largest = speed = None
        if first is not None:
            values = np.where(first < nothing, 0.0, first)
            place = int(np.argmax(values))  # the first value that is not known, where there is one
            if np.isfinite(values[place]):
                largest, speed = float(values[place]), float(response.speed[place])
        # Of the speeds with a periodic motion.
        values = np.where(exact < nothing, 0.0, exact)
        place = int(np.nanargmax(values))
        return ComparedTorque(
            element.name,
            order,
            largest,
            speed,
            float(values[place]),
            float(periodic.speed[place]),
            bool(periodic.status[place] != Found.OK),
            bool(periodic.is_unstable[place]),
        )

    rows = []
    for element in elements(evidence.system):
        first = response.amplitude(element.spans)
        exact = element.largest(np.abs(periodic.torque))
        if (top := np.nanmax(exact, initial=0.0)) == 0.0:
            continue
        if None not in orders:
            total = element.largest(evidence.need(Synthesis).half_range)
            total = np.where(response.unreliable | ~np.isfinite(total), np.nan, total)
            rows.append(compare(element, None, total, exact_half_range(periodic, element.spans)))
        for k, order in enumerate(periodic.orders):
            of_order = first[:, orders.index(order)] if order in orders else None
            compared = compare(element, order, of_order, exact[:, k])
            if max(compared.first or 0.0, compared.exact) >= SMALLEST * top:
                rows.append(compared)
    return FirstOrderCompared(tuple(rows))


def exact_half_range(periodic: PeriodicResponse, spans: Sequence[int]) -> FloatArray:
    """Return (speeds,) N m: largest half range of all orders together, true to phase; NaN where nothing was found."""
    is_known = periodic.status != Found.NONE
    torque = periodic.torque[is_known][:, :, list(spans)].swapaxes(1, 2)
    rows = torque.reshape(torque.shape[0] * len(spans), len(periodic.orders))
    half = np.full(len(periodic.speed), np.nan)
    half[is_known] = half_range_of(periodic.orders, rows).reshape(-1, len(spans)).max(axis=1)
    return half
