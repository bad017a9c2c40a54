"""Where the train has arrived while its components are lowered, and what each leaves on its part for others."""

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args

from torsion.errors import Fault, Path, nearest
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.model.material import Material
from torsion.primitives import Inertia, Primitive, Spring, Station
from torsion.results import one_line

if TYPE_CHECKING:
    from torsion.kernels.warming import Warming
    from torsion.model.compressor.record import CompressorRecord
    from torsion.model.coupling_limits import HeatInMisfire, OverFrequency
    from torsion.model.engine.record import EngineRecord
    from torsion.model.machine_records import ImpellerRecord, MachineRecord, PropellerRecord
    from torsion.model.shaft_details import Hub, Notch, Step

Role = Literal["intermediate", "thrust", "propeller", "crank", "generator"]
ROLES: tuple[Role, ...] = get_args(Role)
Distance = Annotated[float, Quantity("m", at_least=0)]
LateralStiffness = Annotated[float, Quantity("N/m", at_least=0)]
LateralDamping = Annotated[float, Quantity("N*s/m", at_least=0)]
Mass = Annotated[float, Quantity("kg", at_least=0)]


class Support(Declared):
    """A bearing on springs: y lies along the normal of the joint's plane, z in the plane, square to the shaft."""

    at: Distance = required("distance along this shaft from its end that faces the joint")
    stiffness: Annotated[tuple[LateralStiffness, ...], OneOrMany] = required(
        "stiffness, one or [y, z]"
    )
    damping: Annotated[tuple[LateralDamping, ...], OneOrMany] = given(
        "damping, one or [y, z]", (0.0,)
    )
    mass: Mass = given("mass that moves with the shaft there", 0.0)
    source: str | None = given("source of the data: manufacturer, drawing, estimate")

    def refuse_clashes(self) -> None:
        for key in ("stiffness", "damping"):
            if len(getattr(self, key)) not in (1, 2):
                hint = "y: along the normal of the joint's plane"
                raise refuse(f"`{key}` is one value or [y, z]", hint, key)
        if not any(self.stiffness):
            message = "a support of no stiffness holds nothing"
            raise refuse(message, "give a stiffness above 0", "stiffness")

    @property
    def stiffness_of_planes(self) -> tuple[float, float]:
        """Stiffness (N/m) in y and in z."""
        return self.stiffness[0], self.stiffness[-1]

    @property
    def damping_of_planes(self) -> tuple[float, float]:
        """Damping (N s/m) in y and in z."""
        return self.damping[0], self.damping[-1]


@dataclass(frozen=True)
class CouplingRatings:
    """Limits of a coupling's maker; None where the file gives none."""

    rated_torque: float | None = None  # N m, T_KN
    vibratory_torque: float | None = None  # N m, T_KW, half range
    max_torque: float | None = None  # N m, T_Kmax, or T_Kmax1 of normal operation
    heat_limit: float | None = None  # W, P_KW
    tolerance: float | None = None  # of the stiffness
    max_torque_rare: float | None = None  # N m, T_Kmax2
    max_torque_range: float | None = None  # N m, dT_max
    temperature_rise: float | None = (
        None  # K, from the surroundings to the highest permissible temperature
    )
    vibratory_over_frequency: "OverFrequency | None" = None  # T_KW in place of `vibratory_torque`
    heat_over_frequency: "OverFrequency | None" = None  # P_KW in place of `heat_limit`
    heat_in_misfire: "HeatInMisfire | None" = None  # while a cylinder does not fire

    def times(self, factor: float) -> "CouplingRatings":
        """Return the limits of `factor` equal couplings side by side."""
        limits = {
            name: limit.times(factor) if hasattr(limit, "times") else factor * limit
            for name, limit in vars(self).items()
            if limit is not None and name not in ("tolerance", "temperature_rise")
        }
        return replace(self, **limits)

    @property
    def limit_heat(self) -> bool:
        """The maker states a limit of the power loss."""
        return any((self.heat_limit, self.heat_over_frequency, self.heat_in_misfire))

    @property
    def limit_vibration(self) -> bool:
        """There is a limit of the vibratory or the greatest torque, of the heat, or of the temperature."""
        limits = (
            self.vibratory_torque,
            self.vibratory_over_frequency,
            self.max_torque,
            self.temperature_rise,
        )
        return self.limit_heat or any(limit is not None for limit in limits)

    @property
    def limit_anything(self) -> bool:
        """The maker states at least one limit."""
        return self.rated_torque is not None or self.limit_vibration


@dataclass(frozen=True)
class NonlinearRecord:
    """The nonlinear parts of a coupling, of its own speed."""

    stiffness: float  # N m/rad beyond the play, of the first stage, of a clutch that is stuck; infinite: rigid
    play: float = 0.0  # rad, half of it
    viscous: float = 0.0  # N m s/rad of the contact
    friction: tuple[tuple[float, float], ...] = ()  # N m, N m/rad
    stages: tuple[
        tuple[float, float, tuple[float, float]], ...
    ] = ()  # rad, N m/rad, friction of it
    capacity: float | None = None  # N m, of a clutch

    @property
    def interrupts(self) -> bool:
        """Nothing linear is left of the coupling."""
        return bool(self.play) or self.capacity is not None

    @property
    def words(self) -> str:
        """How modes take it; the response takes all but a clutch by harmonic balance."""
        simplifications = {
            "its play closed": self.play,
            "without its friction": self.friction,
            "in its first stage": self.stages,
            "as a clutch that is stuck": self.capacity is not None,
        }
        return ", ".join(words for words, applies in simplifications.items() if applies)


@dataclass(frozen=True)
class ShaftRecord:
    """What a shaft is for the class rules, what it is made of, and its bearings (its dimensions are on its `Bar`)."""

    material: str  # name of one of the train's materials
    role: Role | None
    features: tuple[str, ...]
    support: tuple[Support, ...]
    endurance: float | None = None  # Pa, amplitude of shear that it endures at a fillet
    journal: tuple[float, float] | None = (
        None  # m, diameter and bore of a crank span, which has no `Bar`
    )
    step: "Step | None" = None  # to the shaft after it; None: as `steps` of the train says
    notches: "tuple[Notch, ...]" = ()
    hubs: "tuple[Hub, ...]" = ()


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
class PendulumRecord:
    """A centrifugal pendulum."""

    order: float  # of its own shaft, to which it is tuned
    exact: Fraction | None  # the same where the file gives it
    inertia: float  # kg m2, mass of all bobs times the square of their distance from the axis
    lever: float  # (R + l)/l, angle of a bob about its pivot / twist of the span that stands for it


@dataclass(frozen=True, repr=False)
class Part:
    """A component as placed in the train, and what analyses, rules and reports need to know of it."""

    name: str
    kind: str  # its key in the file: disc, shaft, coupling, ...
    is_point: bool  # else a link between points, or a branch
    path: Path  # where it stands in the file
    stations: tuple[int, ...] = ()  # the stations it made or took
    ratio: Fraction = Fraction(
        1
    )  # its speed (of a gear: of the driving side) / the reference speed
    depth: int = 0  # 0 on the main line, 1 on a branch, 2 on a branch of a branch
    referred_to: Fraction | None = (
        None  # ratio of the speed at which its figures are given; None: its own
    )
    is_named: bool = False  # by the file, not by its kind and number
    note: str | None = None
    source: str | None = None  # where its figures come from
    damping: tuple[str, float] | None = (
        None  # key and value of its internal damping as given in the file
    )
    machine: "MachineRecord | None" = None  # what it drives or absorbs; of an engine too
    application_factor: float | None = None  # K_A, of a gear
    max_torque: float | None = None  # N m, greatest of a gear, at its driving side
    ratings: CouplingRatings | None = None
    inertia_tolerance: float | None = None  # relative, of all its inertias
    shaft: ShaftRecord | None = None
    joint: JointRecord | None = None
    impeller: "ImpellerRecord | None" = None
    propeller: "PropellerRecord | None" = None
    nonlinear: NonlinearRecord | None = None  # of a coupling that modes take as linear
    pendulum: PendulumRecord | None = None
    engine: "EngineRecord | None" = None
    compressor: "CompressorRecord | None" = None
    warming: "Warming | None" = None  # of a coupling whose temperature is computed
    remark: str = ""  # what it stands for, where that is not what the file says alone
    is_opposed: bool = False  # of the motion of two equal halves against each other

    def __repr__(self) -> str:
        return one_line(f"Part {self.name}: {self.kind}")

    @property
    def whole(self) -> str:
        """The name of the shaft, `line`, of a section `line [2]`; the own name of any other part."""
        section = re.fullmatch(r"(.*) \[\d+\]", self.name) if self.kind == "shaft" else None
        return section[1] if section else self.name

    def greatest_torque(self, *, is_rare: bool) -> tuple[str, float] | None:
        """What its maker calls the greatest torque of a motion that is rare or not, and that (N m); None: no limit."""
        if self.max_torque is not None:
            return "T_max", self.max_torque
        if self.ratings is None or self.ratings.max_torque is None:
            return None
        normal, rare = self.ratings.max_torque, self.ratings.max_torque_rare
        if rare is None:
            return "T_Kmax", normal
        return ("T_Kmax2", rare) if is_rare else ("T_Kmax1", normal)

    @property
    def stiffness_tolerance(self) -> float:
        """Relative tolerance of the stiffness of a coupling; 0 where the file gives none."""
        return 0.0 if self.ratings is None else self.ratings.tolerance or 0.0

    @property
    def line(self) -> Path:
        """The list of components in which it stands; of halves that move against each other one of their own."""
        return (*self.path[:-2], "opposed") if self.is_opposed else self.path[:-2]

    @property
    def is_bar(self) -> bool:
        """A shaft by its own dimensions: not a crank span, which has a stiffness and a journal."""
        return self.shaft is not None and self.shaft.journal is None

    @property
    def is_clutch(self) -> bool:
        """A coupling that slips beyond its capacity."""
        return self.nonlinear is not None and self.nonlinear.capacity is not None


@dataclass(frozen=True)
class Arrival:
    """The state of the walk; a branch starts from a copy of it."""

    station: int | None = None  # the last one
    is_open: bool = False  # no point has taken that station yet
    ratio: Fraction = Fraction(1)
    sense: int = 1
    referred_to: Fraction | None = (
        None  # the ratio of the speed at which figures that follow are given; None: own
    )
    yoke: float | None = (
        None  # rad from its plane of the last joint's driven yoke at angle zero; None behind a gear
    )
    joint: int | None = None  # part of that joint
    depth: int = 0

    @property
    def scale(self) -> float:
        """(Own speed / speed at which figures are given)^2, by which those of the component are to be divided."""
        return 1.0 if self.referred_to is None else float((self.ratio / self.referred_to) ** 2)


@dataclass
class Lowering:
    """Collects parts, stations and primitives. Components call `point` or `link`, then `add`."""

    materials: Mapping[str, Material]
    parts: list[Part] = field(default_factory=list)
    stations: list[Station] = field(default_factory=list)
    primitives: list[Primitive] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    arrival: Arrival = field(default_factory=Arrival)
    number: Counter[str] = field(default_factory=Counter)  # of components of a kind that were met
    folder: str = "."  # from which paths of files count

    @property
    def part(self) -> int:
        """Position of the component that is being lowered."""
        return len(self.parts) - 1

    @property
    def name(self) -> str:
        """Name of the component that is being lowered."""
        return self.parts[-1].name

    def member(self, owner: Part, name: str, kind: str, *, is_point: bool) -> None:
        """Begin a piece of a component that is itself a point or a link, as every other component is."""
        self.parts.append(
            replace(
                owner,
                name=f"{owner.name} {name}",
                kind=kind,
                is_point=is_point,
                stations=(),
                is_named=False,
                note=None,
                ratio=self.arrival.ratio,
            )
        )

    def material(self, name: str, *keys: str | int) -> Material | None:
        """The material of that name; None, with a fault at `material` behind these keys, where there is none."""
        material = self.materials.get(name)
        if material is None:
            near = nearest(name, self.materials)
            example = "{shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa}"
            hint = f"declare it with its figures, as `materials: {{{name}: {example}}}`; there is {', '.join(self.materials)}"
            hint = f"did you mean '{near}'?" if near else hint
            self.fault(f"no material is called '{name}'", hint, *keys, "material")
        return material

    def record(self, **facts: Any) -> None:
        """Leave facts on the part of the component that is being lowered, by the fields of `Part`."""
        self.parts[-1] = replace(self.parts[-1], **facts)

    def station(self, name: str, *, is_ground: bool = False, part: int | None = None) -> int:
        """A new station at the speed of where the train has arrived."""
        owner = self.part if part is None else part
        self.stations.append(
            Station(name, owner, self.arrival.ratio, self.arrival.sense, is_ground)
        )
        return len(self.stations) - 1

    def point(self) -> int:
        """The station of a point: the open end of the link before it, or a new one rigidly joined to the last point."""
        before = self.arrival.station
        if before is not None and self.arrival.is_open:
            point = before
            self.stations[point] = replace(self.stations[point], name=self.name, part=self.part)
        else:
            point = self.station(self.name)
            if before is not None:
                self.add(Spring(f"{self.name} rigid", self.part, before, point, 0.0))
        self.arrival = replace(self.arrival, station=point, is_open=False)
        self.record(stations=(point,))
        return point

    def link(
        self,
        ratio: Fraction = Fraction(1),
        sense: int = 1,
        halves: tuple[float, float] | None = None,
        half: str = "half",
        **behind: Any,
    ) -> tuple[int, int]:
        """The driving and the driven station of a link with the inertias of its `halves`; a point may take the driven.

        behind: what changes of the arrival, beside speed and sense.
        """
        driving = (
            self.arrival.station
            if self.arrival.station is not None
            else self.station(f"{self.name} start")
        )
        at_driving, at_driven = halves or (0.0, 0.0)
        self.inertia(driving, at_driving, f"driving {half}")
        self.arrival = replace(
            self.arrival,
            ratio=self.arrival.ratio * ratio,
            sense=self.arrival.sense * sense,
            **behind,
        )
        driven = self.station(f"{self.name} end")
        self.inertia(driven, at_driven, f"driven {half}")
        self.arrival = replace(self.arrival, station=driven, is_open=True)
        self.record(stations=(driving, driven))
        return driving, driven

    def add(self, *primitives: Primitive) -> None:
        """Collect primitives in the order in which components add them."""
        self.primitives.extend(primitives)

    def inertia(self, station: int, given: float, what: str = "", part: int | None = None) -> None:
        """Collect an inertia (kg m2) as the component gives it; nothing is left out."""
        if given:
            self.add(
                Inertia(
                    station,
                    self.to_own_speed(given),
                    self.part if part is None else part,
                    what,
                    given,
                )
            )

    def to_own_speed(self, value: float) -> float:
        """An inertia, stiffness or damping as given, brought to the station's own speed (`gear: referred`)."""
        return value / self.arrival.scale

    def fault(self, message: str, hint: str = "", *keys: str | int) -> None:
        """Note that the component being lowered cannot stand where or as it stands."""
        self.faults.append(Fault((*self.parts[-1].path, *keys), message, hint))
