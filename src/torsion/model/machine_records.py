"""What machines leave on their parts: what they drive or absorb, and the blades of those that have them."""

from dataclasses import dataclass

from torsion.model.drive_law import DriveLaw
from torsion.model.load_law import LoadLaw


@dataclass(frozen=True)
class MachineRecord:
    """A machine that drives or absorbs: its power as the file gives it, its law of load, how its damping was given."""

    is_driver: bool
    power: float | None = None  # W at `speed`
    torque: float | None = None  # N m there, in place of the power
    speed: float | None = None  # rad/s of its own shaft; None: at the rated point of the train
    load: LoadLaw | None = None  # None: the file gives none
    usual_load: LoadLaw | None = None  # of its kind; None: that of the operation
    is_held: bool = False
    drive: DriveLaw | None = None  # of a machine that drives; None: the file gives none
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
