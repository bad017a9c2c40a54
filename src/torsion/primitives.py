"""The primitives that every component lowers to; all that the mathematics needs to know of a train."""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

import numpy as np

from torsion.errors import Path

if TYPE_CHECKING:
    from torsion.kernels.engine.gas_torque import CylinderOrder
    from torsion.kernels.stiffness_laws import StiffnessTable

STEP = ", step"  # behind the name of the shaft before it, the name of its spring
StepForm = Literal["none", "sharp", "handbook"]  # of a step between shafts without a drawing


@dataclass(frozen=True, slots=True)
class Station:
    """A point of the train with an angle, counted positive in the station's own sense of rotation."""

    name: str
    part: int  # the component that made it, as a position in the train's parts
    ratio: Fraction  # its speed / the speed of the reference station
    sense: int = 1  # 1 turns as the reference station does, -1 the other way
    is_ground: bool = False  # the fixed end of a spring to ground


@dataclass(frozen=True, slots=True)
class Inertia:
    """An inertia at a station; infinite where the station turns at exactly its mean speed."""

    station: int
    inertia: float  # kg m2
    part: int = -1  # the component that gives it, as a position in the train's parts
    what: str = ""  # of the component: "driving half"; empty where it has one inertia
    given: float = math.nan  # kg m2, the figure of the file


@dataclass(frozen=True, slots=True)
class Spring:
    """An elastic or (flexibility 0) rigid piece between two stations of one speed."""

    name: str
    part: int
    driving: int
    driven: int
    flexibility: float  # rad/(N m)
    viscous: float = 0.0  # N m s/rad
    loss_factor: float = 0.0  # 1
    # What the three follow; they are then those at one point of it.
    table: "StiffnessTable | None" = None

    @property
    def damps(self) -> bool:
        """It takes energy out of a vibration."""
        return (
            self.viscous > 0
            or self.loss_factor > 0
            or (self.table is not None and self.table.damps)
        )


def tabled_spring(
    name: str, part: int, ends: tuple[int, int], table: "StiffnessTable", at: float | None = None
) -> Spring:
    """The spring of a table with its values at one point (rad/s, or N m), by default its first; of a law the static."""
    if at is None:
        at = 0.0 if table.is_complex else table.at[0]
    k, eta, c = (float(one) for one in table.values(np.array(at)))
    return Spring(name, part, *ends, 1.0 / k, c, eta, table)


@dataclass(frozen=True, slots=True)
class SectionMesh:
    """A cross-section as a file of triangles, yet to be solved."""

    file: str
    scale: float = 1.0  # m of one unit of the mesh
    widest: float = math.inf  # m; a wider one is refused, its unit forgotten


@dataclass(frozen=True, slots=True)
class Section:
    """Constants of a cross-section of any outline."""

    torsion_constant: float  # m4; stiffness of a length 1 = shear modulus * torsion constant
    # m4, about the axis of the shaft; inertia of a length 1 = density * polar moment.
    polar_moment: float
    stress_modulus: float  # m3, torque / largest shear stress; NaN where there is no largest one


@dataclass(frozen=True, slots=True)
class Bar:
    """A shaft with distributed inertia, from the driving to the driven station: uniform, conical or of any section.

    A section yet to be solved has no diameters (NaN). One that is solved has the diameter of the circle with its polar
    moment, and the shear modulus that gives that circle its stiffness: so every model of a shaft takes it as it is.
    """

    name: str
    part: int
    driving: int
    driven: int
    length: float  # m
    outer: tuple[float, float]  # m, diameters at the driving and the driven end
    bore: tuple[float, float]  # m
    shear_modulus: float  # Pa
    density: float  # kg/m3
    loss_factor: float = 0.0
    segments: int | None = None  # None: as many as the highest frequency requested needs
    section: SectionMesh | Section | None = None  # None: round, by its diameters


@dataclass(frozen=True, slots=True)
class Toothing:
    """The size of the teeth of a mesh, as far as its forces need it."""

    diameter: float  # m, pitch (reference) diameter of the driving wheel
    helix: float  # rad
    pressure_angle: float  # rad, normal
    module: float | None  # m, normal; None where the diameter is given


@dataclass(frozen=True, slots=True)
class Constraint:
    """Driven angle = driving angle * ratio + error: a gear mesh or a universal joint.

    The error is a Fourier sum over the driving station's own angle x: Re sum amplitude * exp(i order x).
    """

    name: str
    part: int
    driving: int
    driven: int
    ratio: Fraction = Fraction(1)  # speed of the driven / speed of the driving station
    # rad/(N m) at the driving station's speed (a mesh stiffness); 0 is rigid.
    flexibility: float = 0.0
    error: tuple[tuple[int, complex], ...] = ()  # (order, rad)
    after: int | None = None  # of a joint: the part of the joint before it on the same shaft line
    teeth: tuple[int, ...] = ()  # of a mesh: driving and driven; () where its ratio is given
    toothing: Toothing | None = None  # of a mesh whose pitch diameter is known
    meshings: Fraction = Fraction(
        0
    )  # of teeth per revolution of the driving station; 0 where that is not known
    wheel: Fraction = Fraction(
        1
    )  # speed of the wheel whose base radius is meant / speed of the driving station


@dataclass(frozen=True, slots=True)
class Damper:
    """A damping to ground of the deviation from the mean motion.

    damping = constant + torque_factor * mean torque / speed + speed_factor * speed + load_factor * slope of the law of
    load, all at the station's own speed.
    """

    station: int
    constant: float = 0.0  # N m s/rad
    torque_factor: float = 0.0  # 1
    speed_factor: float = 0.0  # N m s2/rad2
    load_factor: float = 0.0  # 1

    @property
    def needs_torque(self) -> bool:
        """It follows from the mean torque there."""
        return bool(self.torque_factor or self.load_factor)

    @property
    def may_drive(self) -> bool:
        """It can feed vibration: it follows the slope of a law, which may fall, or is negative itself."""
        negative = min(self.constant, self.torque_factor, self.speed_factor) < 0.0
        return negative or self.load_factor != 0.0


@dataclass(frozen=True, slots=True)
class Torque:
    """A harmonic torque at a station: by order of its own speed, at a fixed frequency, or at every frequency requested.

    Amplitude = torque + of_mean * mean torque there, or the table over the station's own speed, or that of a cylinder.
    Of a mesh it is a transmission error in place of a torque: the twist (rad at the driving station, driving - driven
    angle / ratio) that its teeth have without a torque.
    """

    name: str
    station: int
    order: Fraction | None = None
    frequency: float | None = None  # Hz
    torque: float = 0.0  # N m
    of_mean: float = 0.0  # 1
    table: tuple[tuple[float, float], ...] = ()  # (rad/s of the station's own speed, N m)
    phase: float = 0.0  # rad
    path: Path = ()  # where the file says it
    source: str | None = None  # where its figures come from; None where that is not stated
    cylinder: "CylinderOrder | None" = None  # in place of all amounts
    # In place of all amounts: a mesh, and its transmission error.
    mesh: tuple[str, float] | None = None


Primitive = Inertia | Spring | Bar | Constraint | Damper | Torque
