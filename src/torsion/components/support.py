"""A support of a shaft: an elastic bearing that holds it sideways, for the bending side of a Cardan line."""

from typing import Annotated

from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required

Distance = Annotated[float, Quantity("m", at_least=0)]
LateralStiffness = Annotated[float, Quantity("N/m", at_least=0)]
LateralDamping = Annotated[float, Quantity("N*s/m", at_least=0)]
Mass = Annotated[float, Quantity("kg", at_least=0)]


class Support(Declared):
    """A bearing on springs: y lies along the normal of the joint's plane, z in the plane, square to the shaft."""

    at: Distance = required("distance along this shaft from its end that faces the joint")
    stiffness: Annotated[tuple[LateralStiffness, ...], OneOrMany] = required("stiffness, one or [y, z]")
    damping: Annotated[tuple[LateralDamping, ...], OneOrMany] = given("damping, one or [y, z]", (0.0,))
    mass: Mass = given("mass that moves with the shaft there", 0.0)
    source: str | None = given("where the figures come from: maker, drawing, estimate")

    def refuse_clashes(self) -> None:
        for key in ("stiffness", "damping"):
            if len(getattr(self, key)) not in (1, 2):
                raise refuse(f"`{key}` is one value or [y, z]", "y: along the normal of the joint's plane", key)
        if not any(self.stiffness):
            raise refuse("a support of no stiffness holds nothing", "give a stiffness above 0", "stiffness")

    @property
    def stiffness_of_planes(self) -> tuple[float, float]:
        """N/m in y and z."""
        return self.stiffness[0], self.stiffness[-1]

    @property
    def damping_of_planes(self) -> tuple[float, float]:
        """N s/m in y and z."""
        return self.damping[0], self.damping[-1]


def fits(support: Support, length: float) -> bool:
    """The support stands on the shaft of that length (m)."""
    return support.at <= length
