"""What a component leaves on its part when it lowers: facts that analyses, rules and reports need beside primitives."""

from dataclasses import dataclass
from typing import Annotated, Literal

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


@dataclass(frozen=True)
class CouplingRatings:
    """Limits of a coupling's maker; None where the file gives none."""

    rated_torque: float | None  # N m, T_KN
    vibratory_torque: float | None  # N m, T_KW, half range
    max_torque: float | None  # N m, T_Kmax
    heat_limit: float | None  # W, P_KW
    tolerance: float | None  # of the stiffness

    @property
    def limit_vibration(self) -> bool:
        """There is a limit of the vibratory or the greatest torque, or of the heat."""
        return any(limit is not None for limit in (self.vibratory_torque, self.max_torque, self.heat_limit))

    @property
    def limit_anything(self) -> bool:
        """There is a limit at all."""
        return self.rated_torque is not None or self.limit_vibration


@dataclass(frozen=True)
class ShaftRecord:
    """What a shaft is for the class rules, what it is made of, and its bearings (its dimensions are on its `Bar`)."""

    material: str  # name of one of the train's materials
    role: Literal["intermediate", "thrust", "propeller"] | None
    features: tuple[str, ...]
    support: tuple[Support, ...]


@dataclass(frozen=True)
class JointRecord:
    """A universal joint; angles in rad, plane and phase 0 where the file gives none."""

    kind: Literal["cross", "tripod", "cv"]
    angle: float
    plane: float
    phase: float
    yoke: float  # from its plane to its driving yoke at angle zero, every shaft before it standing undisturbed
    order: int  # of its transmission error over its driving shaft; 0: constant velocity
    radius: float | None  # m, of a tripod
    arm: float | None  # m, of a tripod


@dataclass(frozen=True)
class PropellerRecord:
    """A propeller: its inertia in parts, its size, and how its damping was given."""

    inertia: float  # kg m2, dry
    water: float | None  # kg m2, entrained; None where the file gives none
    blades: int | None
    diameter: float | None  # m
    damping_model: str
    damping_factor: float | None
