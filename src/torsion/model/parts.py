"""The parts of a train: components as placed, with the records that they leave for analyses, rules and reports."""

import re
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import (
    TYPE_CHECKING,
    Any,
    ClassVar,
    Generic,
    Literal,
    TypeVar,
    cast,
    get_args,
)

from torsion.errors import Path
from torsion.results import one_line

if TYPE_CHECKING:
    from torsion.kernels.stiffness_laws import Warming
    from torsion.model.compressor.record import CompressorRecord
    from torsion.model.elastic_element import MisfireHeat, OverFrequency
    from torsion.model.engine.record import EngineRecord
    from torsion.model.machine_torques import DriveLaw, LoadLaw
    from torsion.model.shafts.shaft_details import Hub, Notch, Step, Support

Role = Literal["intermediate", "thrust", "propeller", "crank", "generator"]
ROLES: tuple[Role, ...] = get_args(Role)


@dataclass(frozen=True)
class GearRating:
    """The rating of a gear; None where the file gives none."""

    application_factor: float | None  # K_A
    max_torque: float | None  # N m, at its driving side

    def times(self, factor: float) -> "GearRating":
        """Return the rating of `factor` equal gears side by side."""
        torque = self.max_torque
        return replace(self, max_torque=None if torque is None else factor * torque)


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
    heat_in_misfire: "MisfireHeat | None" = None  # while a cylinder does not fire

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
        vibratory = self.vibratory_torque, self.vibratory_over_frequency
        limits = (*vibratory, self.max_torque, self.temperature_rise)
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
    support: "tuple[Support, ...]"
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


@dataclass(frozen=True)
class MachineRecord:
    """A machine that drives or absorbs: its power as the file gives it, its law of load, how its damping was given."""

    is_driver: bool
    power: float | None = None  # W at `speed`
    torque: float | None = None  # N m there, in place of the power
    speed: float | None = None  # rad/s of its own shaft; None: at the rated point of the train
    load: "LoadLaw | None" = None  # None: the file gives none
    usual_load: "LoadLaw | None" = None  # of its kind; None: that of the operation
    is_held: bool = False
    drive: "DriveLaw | None" = None  # of a machine that drives; None: the file gives none
    damping_model: str = "viscous"
    damping_factor: float | None = None

    @property
    def is_stated(self) -> bool:
        """The file states what it drives or absorbs: its power, its torque or a table of its load."""
        has_table = self.load is not None and bool(self.load.table)
        return has_table or self.power is not None or self.torque is not None

    def rated_torque(self, rated_speed: float) -> float | None:
        """Return the torque (N m) that the file states, None where it states none.

        rated_speed: own speed at the rated point of the train, for a power without a speed; 0 where it is not known.
        """
        if self.torque is not None:
            return self.torque
        speed = self.speed or rated_speed
        return None if self.power is None or not speed else self.power / speed


@dataclass(frozen=True)
class ImpellerRecord:
    """Blades in a fluid: their inertia in parts, their number and size."""

    inertia: float  # kg m2, dry
    water: float | None  # kg m2, entrained; None where the file gives none
    blades: int | None
    diameter: float | None  # m


@dataclass(frozen=True)
class PropellerRecord(ImpellerRecord):
    """A propeller: its inertia in parts and its size."""

    pitch_ratio: float | None
    area_ratio: float | None
    hub_ratio: float | None = None
    is_ducted: bool = False
    pitch: str | None = None  # fixed or controllable; None where the file does not state it


@dataclass(frozen=True)
class DataSheet:
    """What a component states of itself in the appendix of the report."""

    rows: tuple[tuple[str, str], ...]  # label, value with unit


@dataclass(frozen=True)
class Symbol:
    """How the sketch of the train draws a component."""

    role: Literal["", "driver", "load", "fluid", "absorber", "throw"] = ""  # colour of a point
    width: float = 1.0  # of a link, along the train


PLAIN = Symbol()
Kind = TypeVar("Kind")


@dataclass(frozen=True)
class Held(Generic[Kind]):
    """A record of a part as an attribute, by the name of its class; None where the part has none."""

    name: str

    def __get__(self, part: "Part | None", owner: type) -> Kind | None:
        return None if part is None else cast("Kind | None", part.records_by_name.get(self.name))


@dataclass(frozen=True, repr=False)
class Part:
    """A component as placed in the train, with the records that it left for analyses, rules and reports.

    A rule reads a record by its type: `part.get(CouplingRatings)`. Records that many rules read have a name too.
    """

    name: str
    kind: str  # its key in the file: disc, shaft, coupling, ...
    is_point: bool  # else a link between points, or a branch
    path: Path  # where it stands in the file
    stations: tuple[int, ...] = ()  # the stations it made or took
    ratio: Fraction = Fraction(1)  # its speed (of a gear: of the driving side) / reference speed
    depth: int = 0  # 0 on the main line, 1 on a branch, 2 on a branch of a branch
    # Ratio of the speed at which its figures are given; None: its own.
    referred_to: Fraction | None = None
    is_named: bool = False  # by the file, not by its kind and number
    note: str | None = None
    source: str | None = None  # where its figures come from
    damping: tuple[str, Any] | None = None  # key and value of its damping as the file gives it
    inertia_tolerance: float | None = None  # relative, of all its inertias
    remark: str = ""  # what it stands for, where that is not what the file says alone
    is_opposed: bool = False  # of the motion of two equal halves against each other
    symbol: Symbol = PLAIN
    records: tuple[Any, ...] = ()

    machine: ClassVar[Held[MachineRecord]] = Held(
        "MachineRecord"
    )  # what it drives or absorbs; of an engine too
    ratings: ClassVar[Held[CouplingRatings]] = Held("CouplingRatings")
    shaft: ClassVar[Held[ShaftRecord]] = Held("ShaftRecord")
    joint: ClassVar[Held[JointRecord]] = Held("JointRecord")
    impeller: ClassVar[Held[ImpellerRecord]] = Held("ImpellerRecord")
    propeller: ClassVar[Held[PropellerRecord]] = Held("PropellerRecord")
    nonlinear: ClassVar[Held[NonlinearRecord]] = Held("NonlinearRecord")
    pendulum: ClassVar[Held[PendulumRecord]] = Held("PendulumRecord")
    engine: ClassVar["Held[EngineRecord]"] = Held("EngineRecord")
    compressor: ClassVar["Held[CompressorRecord]"] = Held("CompressorRecord")
    warming: ClassVar["Held[Warming]"] = Held(
        "Warming"
    )  # of a coupling whose temperature is computed

    def __repr__(self) -> str:
        return one_line(f"Part {self.name}: {self.kind}")

    @cached_property
    def records_by_name(self) -> dict[str, Any]:
        """The first record of every class, and of the classes that they are of, by the name of the class."""
        return {
            kind.__name__: record
            for record in reversed(self.records)
            for kind in type(record).__mro__
        }

    def get(self, kind: type[Kind]) -> Kind | None:
        """Return its record of a type; None where it has none."""
        return next((record for record in self.records if isinstance(record, kind)), None)

    def with_records(self, *records: object) -> "Part":
        """Return the part with these records, each in place of one of its type."""
        kinds = tuple(map(type, records))
        others = (record for record in self.records if type(record) not in kinds)
        return replace(self, records=(*others, *records))

    def without(self, *kinds: type) -> "Part":
        """Return the part without its records of these types."""
        kept = (record for record in self.records if not isinstance(record, kinds))
        return replace(self, records=tuple(kept))

    @property
    def data_sheet(self) -> tuple[tuple[str, str], ...]:
        """Rows of its data sheet: label, value with unit."""
        sheet = self.get(DataSheet)
        return () if sheet is None else sheet.rows

    @property
    def whole(self) -> str:
        """The name of the shaft, `line`, of a section `line [2]`; the own name of any other part."""
        section = re.fullmatch(r"(.*) \[\d+\]", self.name) if self.kind == "shaft" else None
        return section[1] if section else self.name

    def greatest_torque(self, *, is_rare: bool) -> tuple[str, float] | None:
        """What its maker calls the greatest torque of a motion that is rare or not, and that (N m); None: no limit."""
        gear, ratings = self.get(GearRating), self.ratings
        if gear is not None:
            return None if gear.max_torque is None else ("T_max", gear.max_torque)
        if ratings is None or ratings.max_torque is None:
            return None
        if ratings.max_torque_rare is None:
            return "T_Kmax", ratings.max_torque
        return ("T_Kmax2", ratings.max_torque_rare) if is_rare else ("T_Kmax1", ratings.max_torque)

    @property
    def limits_torque(self) -> bool:
        """Its maker limits the torque of a motion, or the range of it."""
        has_range = self.ratings is not None and self.ratings.max_torque_range is not None
        return has_range or self.greatest_torque(is_rare=False) is not None

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
