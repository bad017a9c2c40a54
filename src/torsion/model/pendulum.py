"""A centrifugal pendulum: bobs on a carrier, tuned to an order of the shaft by their arm and length.

Linear about a constant speed a bob of mass m, pivoted at R from the axis, its length l, is a ring of inertia
m (R + l)^2 on a spring of that times (q w)^2, with q = sqrt(R/l) the order to which it is tuned and w the speed of the
shaft: at order n the ring's inertia seen from the carrier is m (R + l)^2/(1 - n^2/q^2). The deflection of
the bob from the radius is the twist of that spring times (R + l)/l.
"""

import math
from typing import Annotated

from pydantic import Field

from torsion import fields
from torsion.fields import Quantity, exclusive, given, required
from torsion.kernels.stiffness_laws import power_law
from torsion.model.component import Component, Lowering
from torsion.model.parts import CouplingRatings, PendulumRecord, Symbol
from torsion.primitives import tabled_spring

REACH = (1e-3, 1e6)  # rad/s of its shaft between which its stiffness follows the speed
Mass = Annotated[float, Quantity("kg", above=0)]
Length = Annotated[float, Quantity("m", above=0, usual="length of a pendulum")]


class Pendulum(Component, keyword="pendulum", sort="point", symbol=Symbol("absorber")):
    """A centrifugal pendulum absorber has bobs on a carrier that turns with the train.

    Give `length`, or the `order` of its own shaft to which it is tuned: order^2 = arm/length. Bobs are points, or
    bifilar, which turn as the carrier does; a bob that turns about its pivot has another law.
    """

    title = "centrifugal pendulum absorber"
    example = "- pendulum: {mass: 1.2 kg, number: 4, arm: 80 mm, order: 3, inertia: 0.02}"

    clashes = (exclusive("length", "order", hint="order^2 = arm/length", needed=True),)

    mass: Mass = required("mass of one bob")
    arm: Length = required(
        "R, from the axis of the shaft to the pivot (bifilar: to the centre of the bob's path)"
    )
    length: Length | None = given("l, from the pivot to the centre of the bob")
    order: fields.Exact | None = given(
        "order to which it is tuned, cycles per revolution of the shaft that carries it"
    )
    number: Annotated[int, Field(ge=1, le=100)] = given("how many bobs", 1)
    inertia: fields.Inertia = given(
        "of the carrier, and of bifilar bobs about their own centres", 0.0
    )
    damping: fields.Damping | None = given(
        "viscous damping at the pivot of one bob, of its deflection"
    )
    heat_limit: fields.Power | None = given("permissible power loss of all bobs")

    def lower(self, build: Lowering) -> None:
        square = self.arm / self.length if self.length is not None else float(self.order or 1) ** 2
        length, carrier = self.arm / square, build.point()
        bobs = self.number * self.mass * (self.arm + length) ** 2
        lever = (self.arm + length) / length
        build.record(
            PendulumRecord(math.sqrt(square), self.order, bobs, lever),
            CouplingRatings(heat_limit=self.heat_limit),
        )
        ring = build.station(f"{build.name} bobs")
        build.inertia(carrier, self.inertia, "carrier")
        build.inertia(ring, bobs, "bobs")
        stiffness, damping = (
            build.to_own_speed(bobs) * square,
            build.to_own_speed(self.number * (self.damping or 0.0)) * lever**2,
        )
        law = power_law("speed", REACH, (stiffness, 2.0), (damping, 0.0), key="")
        build.add(tabled_spring(f"{build.name} bobs", build.part, (carrier, ring), law, REACH[0]))
