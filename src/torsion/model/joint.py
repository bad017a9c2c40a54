"""A universal joint: a link whose speed ratio depends on its angle."""

import math
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from torsion import fields
from torsion.errors import SolveError
from torsion.fields import Quantity, given, refuse, required
from torsion.kernels.joints import cross, tripod
from torsion.model.component import Component, Lowering
from torsion.model.coupling import Pair
from torsion.model.parts import JointRecord, Symbol
from torsion.primitives import Constraint


class Joint(Component, keyword="joint", sort="link", symbol=Symbol(width=0.8)):
    """A joint joins two shafts at an angle: a cross (Cardan, Hooke), tripod or constant-velocity joint."""

    title = "universal joint, cardan shaft, tripod, constant-velocity joint"
    example = """\
- joint: {angle: 5 deg, phase: 90 deg}
- joint: {kind: tripod, angle: 10 deg, radius: 30 mm, arm: 600 mm}"""

    kind: Literal["cross", "tripod", "cv"] = given(
        "cross (order 2), tripod (order 3), or cv: constant velocity", "cross"
    )
    angle: fields.JointAngle = required("angle between the two shafts")
    plane: fields.Angle | None = given(
        "from the plane of the previous joint to this one's, about the shaft between them (default: 0 deg)"
    )
    phase: fields.Angle | None = given(
        "from the previous joint's driven yoke to this driving yoke (first joint: from the plane of its shafts; "
        "default: 0 deg)"
    )
    inertia: Pair | None = given("[driving, driven] yokes")
    radius: fields.Across | None = given(
        "of a tripod: from the driving shaft's axis to its three bearings' lines"
    )
    arm: Annotated[float, Quantity("m", above=0, usual="distance of bearings")] | None = given(
        "of a tripod: from the joint to the point about which its driven shaft pivots"
    )
    bearing: Literal["single", "twin"] | None = given(
        "of a tripod: single (default) moves the end of its driven shaft, twin is of constant velocity"
    )

    def refuse_clashes(self) -> None:
        if self.kind != "tripod":
            for key in self.keys_given("radius", "arm", "bearing"):
                message = f"a joint of kind {self.kind} has no `{key}`"
                raise refuse(message, "leave it out, or `kind: tripod`", key)
            return
        for key in ("radius", "arm"):
            if not self.keys_given(key):
                hint = "for example `radius: 30 mm, arm: 600 mm`"
                raise refuse(f"a tripod needs `{key}`", hint)
        if self.bearing != "twin":
            third = np.linspace(0.0, 2.0 * math.pi / 3.0, 25)  # of a revolution; then all repeats
            try:
                tripod.exact_motion(third, self.angle, self.radius or 0.0, self.arm or 1.0)
            except SolveError:
                message = "the end of this tripod's driven shaft finds no way around"
                hint = "make the angle or the radius smaller, or the arm longer"
                raise refuse(message, hint, "angle") from None

    @property
    def order(self) -> int:
        """Order of its transmission error over its driving shaft; 0 of a joint of constant velocity."""
        return {"cross": 2, "tripod": 0 if self.bearing == "twin" else 3, "cv": 0}[self.kind]

    def lower(self, build: Lowering) -> None:
        before = build.arrival.yoke
        if before is None and self.plane is not None:
            hint = "remove `plane`; the first joint (also after a gear) defines the plane"
            message = "`plane` counts from a previous joint, and there is none on this shaft"
            build.fault(message, hint, "plane")
        if before is None and self.phase is not None and build.arrival.depth > 0:
            hint = "leave `phase` out; it counts from a joint before this one, or on the main line from the plane"
            message = "`phase` on a first joint of a branch has nothing to count from"
            build.fault(message, hint, "phase")
        after = None if before is None else build.arrival.joint
        plane, phase = self.plane or 0.0, self.phase or 0.0
        yoke = phase if before is None else before + phase - plane
        angles = self.angle, plane, phase, yoke
        build.record(JointRecord(self.kind, *angles, self.order, self.radius, self.arm))
        driving, driven = build.link(halves=self.inertia)
        # The yokes of a cross stand square to each other. Behind a tripod or a cv joint the arm (or a mark) that stood
        # with the driving side's is counted from, so nothing is added.
        driven_yoke = yoke + math.pi / 2 if self.kind == "cross" else yoke
        # The transmission error (order, rad) over the driving shaft's angle, to first order; that of a tripod counts from
        # the normal of the plane, as its theory does.
        error: tuple[tuple[int, complex], ...] = ()
        if self.angle and self.kind == "cross":
            error = ((2, cross.error_amplitude(self.angle, yoke)),)
        elif self.angle and self.order:
            size = self.radius or 0.0, self.arm or 1.0
            error = ((3, tripod.error_amplitude(self.angle, yoke + math.pi / 2, *size)),)
        build.arrival = replace(build.arrival, yoke=driven_yoke, joint=build.part)
        build.add(Constraint(build.name, build.part, driving, driven, error=error, after=after))
