"""What every kind of event is: how it is named in a file, and its torque by time or by how its point turns."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args

from pydantic import BeforeValidator

from torsion.fields import Declared, Quantity, refuse
from torsion.kernels.motion.loaded_modes import Piece
from torsion.model.parts import PropellerRecord

if TYPE_CHECKING:
    from torsion.kernels.motion.collocation import Law

Time = Annotated[float, Quantity("s", at_least=0)]
Length = Annotated[float, Quantity("s", above=0)]
Pairs = tuple[tuple[float, float], ...]


def rows_over_time(second: Quantity, title: str, example: str) -> BeforeValidator:
    """The reader of a table [[time, value], ...] whose times rise; title: 'a table over time'."""

    def read(value: Any) -> Pairs:
        is_list = isinstance(value, list | tuple)
        if not is_list or not all(isinstance(row, list | tuple) and len(row) == 2 for row in value):
            raise refuse(f"{title} is a list of pairs that begin with a time", example)
        time = Quantity("s", at_least=0)
        rows = tuple((time.read(row[0]), second.read(row[1])) for row in value)
        if len(rows) < 2 or any(a[0] >= b[0] for a, b in pairwise(rows)):
            raise refuse(f"{title} needs two rows or more with rising times")
        return rows

    shown = tuple[tuple[float | str, float | str], ...]
    return BeforeValidator(read, json_schema_input_type=shown)


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

    @classmethod
    def field(cls) -> str:
        """Name of its field in an event."""
        return cls.key.replace("-", "_")

    @property
    def damps(self) -> bool:
        """Its torque changes with the speed, and takes the place of a damping there."""
        return False

    @property
    def leaves_open(self) -> bool:
        """Its phase, sense or time is open, and the worst of them is judged."""
        return False

    def changes(self, point: Point) -> list[float]:
        """Times (s) after its begin, rising, between which its torque has one law."""
        return [0.0]

    def pieces(self, begin: float, point: Point) -> Iterator[Piece]:
        """Its torque over time, N m at the point's own speed, positive in the sense of rotation."""
        return iter(())

    def laws(self, begin: float, point: Point) -> "Iterator[Law]":
        """What of its torque follows the motion, at interface 0."""
        return iter(())

    def lacks(self, point: Point) -> Lack:
        """What the train lacks for it, and what would be right."""
        return None


def settings_in_words(settings: Declared) -> str:
    """Those that are not left at their defaults, with their units; speeds in rpm."""
    words = list[str]()
    for name, field in type(settings).model_fields.items():
        if name not in settings.model_fields_set:
            continue
        value = getattr(settings, name)
        optional = (item for argument in get_args(field.annotation) for item in get_args(argument))
        quantities = (item for item in (*field.metadata, *optional) if isinstance(item, Quantity))
        unit = next((quantity.unit for quantity in quantities), "1")
        text = str(value)
        if isinstance(value, Declared):
            text = f"({settings_in_words(value)})"
        elif isinstance(value, tuple) and isinstance(value[0], tuple):
            text = f"{len(value)} pairs"
        elif isinstance(value, tuple):
            text = ", ".join(f"{item:.6g}" for item in value)
        elif isinstance(value, float):
            factor, unit = {"rad/s": (30.0 / math.pi, "rpm"), "rad": (180.0 / math.pi, "deg")}.get(
                unit, (1.0, "" if unit == "1" else unit.replace("*", " "))
            )
            text = f"{value * factor:.6g} {unit}".rstrip()
        words.append(f"{name.replace('_', ' ')} {text}")
    return ", ".join(words)
