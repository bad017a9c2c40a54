"""A universal joint: a link whose speed ratio depends on its angle."""

import math
from dataclasses import replace
from typing import ClassVar, Literal, Self

from pydantic import model_validator

from torsion import fields
from torsion.components.base import Component
from torsion.components.coupling import Pair
from torsion.components.lowering import Lowering
from torsion.fields import given, refuse, required
from torsion.kinematics.cross import error_amplitude
from torsion.primitives import Constraint, Inertia


class Joint(Component):
    """A cross (Cardan, Hooke) joint."""

    keyword: ClassVar[str] = "joint"
    sort: ClassVar[Literal["point", "link", "none"]] = "link"
    unbuilt: ClassVar[tuple[str, ...]] = ("radius", "arm", "bearing")

    kind: Literal["cross", "tripod", "cv"] = given("cross; tripod and cv are not built yet", "cross")
    angle: fields.JointAngle = required("angle between the two shafts")
    plane: fields.Angle | None = given(
        "from the plane of the previous joint to this one's, about the shaft between them"
    )
    phase: fields.Angle = given(
        "from the previous joint's driven yoke to this driving yoke; of a first joint, from the plane of its shafts",
        0.0,
    )  # fmt: skip
    inertia: Pair | None = given("[driving, driven] yokes")

    @model_validator(mode="after")
    def _is_built(self) -> Self:
        if self.kind != "cross":
            raise refuse(f"a joint of kind {self.kind} is part of the format but not built yet", "kind: cross", "kind")
        return self

    def lower(self, build: Lowering) -> None:
        before = build.at.yoke
        if before is None and self.plane is not None:
            hint = "leave `plane` out; the first joint (also behind a gear) defines the plane"
            build.fault("`plane` counts from a previous joint, and there is none on this shaft", hint, "plane")
        yoke = self.phase if before is None else before + math.pi / 2 + self.phase - (self.plane or 0.0)
        driving, driven = build.link()
        build.at = replace(build.at, yoke=yoke)
        at_driving, at_driven = self.inertia or (0.0, 0.0)
        build.add(Inertia(driving, build.own(at_driving)), Inertia(driven, build.own(at_driven)))
        error = ((2, error_amplitude(self.angle, yoke)),) if self.angle > 0 else ()
        build.add(Constraint(build.name, build.part, driving, driven, error=error))
