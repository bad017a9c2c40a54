"""What every kind of event is: how it is named in a file, and its torque by time or by how its point turns."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar, get_args

from torsion.fields import Declared, Quantity
from torsion.kernels.motion.collocation import Law
from torsion.kernels.motion.torque_history import Piece
from torsion.model.machine_records import PropellerRecord

Time = Annotated[float, Quantity("s", at_least=0)]
Length = Annotated[float, Quantity("s", above=0)]


@dataclass(frozen=True)
class Point:
    """Where an event acts, as the train is when it begins."""

    name: str = ""
    speed: float = 0.0  # rad/s of its own shaft
    mean: float = 0.0  # N m that drives it (positive) or that it absorbs, at that speed
    rated: float = 0.0  # N m, rated torque; 0 where it is not known
    blades: int = 0
    folder: Path = Path()  # of the study's file
    rated_speed: float = 0.0  # rad/s of its own shaft; 0 where it is not known
    turns: bool = False  # torques follow the motion: events, joints
    is_clutch: bool = False
    propeller: PropellerRecord | None = None


Lack = tuple[str, str] | None  # what is wrong, and what would be right


class Kind(Declared):
    """What happens at a point; one class a kind of event."""

    key: ClassVar[str]  # in the file
    meaning: ClassVar[str]
    drives: ClassVar[bool] = False  # it changes the speed by itself

    @property
    def by_angle(self) -> bool:
        """It follows the angle of its point, where the speed changes."""
        return False

    def pieces(self, begin: float, at: Point) -> Iterator[Piece]:
        """Its torque over time, N m at the point's own speed, positive in the sense of rotation."""
        return iter(())

    def laws(self, begin: float, at: Point) -> Iterator[Law]:
        """What of its torque follows the motion, at interface 0."""
        return iter(())

    def corners(self, at: Point) -> tuple[float, ...]:
        """Times (s) after its begin, which rise, between which its torque has one law."""
        return ()

    def lacks(self, at: Point) -> Lack:
        """What the train lacks for it, and what would be right."""
        return None


def settings_in_words(settings: Declared) -> str:
    """Those that are not left at their defaults, with their units; speeds in rpm."""
    said = list[str]()
    for name, field in type(settings).model_fields.items():
        if name not in settings.model_fields_set:
            continue
        value = getattr(settings, name)
        within = [
            *field.metadata,
            *(item for one in get_args(field.annotation) for item in get_args(one)),
        ]
        unit = next((item.unit for item in within if isinstance(item, Quantity)), "1")
        text = str(value)
        if isinstance(value, Declared):
            text = f"({settings_in_words(value)})"
        elif isinstance(value, tuple):
            text = (
                f"{len(value)} pairs"
                if isinstance(value[0], tuple)
                else ", ".join(f"{one:.6g}" for one in value)
            )
        elif isinstance(value, float):
            shown = {
                "rad/s": (f"{value * 30.0 / math.pi:.6g}", "rpm"),
                "rad": (f"{math.degrees(value):.6g}", "deg"),
            }
            number, unit = shown.get(
                unit, (f"{value:.6g}", "" if unit == "1" else unit.replace("*", " "))
            )
            text = f"{number} {unit}".rstrip()
        said.append(f"{name.replace('_', ' ')} {text}")
    return ", ".join(said)
