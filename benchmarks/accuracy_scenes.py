"""Shaft lines of the study of accuracy, and what each program is given: a scene file, nodes and elements."""

import json
from dataclasses import dataclass, replace
from typing import Any

STEEL = (79.3e9, 7850.0)


@dataclass(frozen=True)
class Disc:
    """A lumped inertia with a damper to ground."""

    inertia: float  # kg m2
    damping: float = 0.0  # N m s/rad


@dataclass(frozen=True)
class Coupling:
    """A spring without inertia."""

    stiffness: float  # N m/rad


@dataclass(frozen=True)
class Shaft:
    """A shaft, uniform or conical; the bore of a conical one is 0."""

    length: float  # m
    diameter: tuple[float, float]  # m
    bore: float = 0.0  # m
    shear_modulus: float = STEEL[0]  # Pa
    density: float = STEEL[1]  # kg/m3


@dataclass(frozen=True)
class Gear:
    """Two wheels in mesh."""

    teeth: tuple[int, int]
    inertia: tuple[float, float]  # kg m2


Item = Disc | Coupling | Shaft | Gear


@dataclass(frozen=True)
class Line:
    """A free line that begins and ends with a disc; the torque of a response acts on the first."""

    name: str
    items: tuple[Item, ...]
    highest: float  # rad/s, above its tenth mode

    @property
    def shafts(self) -> tuple[Shaft, ...]:
        """The shafts in their order."""
        return tuple(item for item in self.items if isinstance(item, Shaft))


def halved(line: Line) -> Line:
    """The line with every shaft in two that meet at its middle."""
    items = list[Item]()
    for item in line.items:
        if isinstance(item, Shaft):
            first, last = item.diameter
            middle = (first + last) / 2
            ends = (first, middle), (middle, last)
            items += [replace(item, length=item.length / 2, diameter=diameter) for diameter in ends]
        else:
            items.append(item)
    return replace(line, items=tuple(items))


DRILL_STRING = Line(
    "drill string",
    (Disc(200.0), Shaft(800.0, (0.78, 0.78), 0.65, 75e9, 8000.0), Disc(10.0, 2e4)),
    130.0,
)
MARINE = Line(
    "stepped marine line with a gear",
    (
        Disc(90.0),
        Coupling(1.5e6),
        Disc(12.0),
        Shaft(1.2, (0.14, 0.14)),
        Gear((23, 71), (0.6, 38.0)),
        Shaft(2.5, (0.26, 0.26)),
        Shaft(6.0, (0.24, 0.24)),
        Shaft(4.0, (0.28, 0.28), 0.1),
        Disc(420.0, 900.0),
    ),
    12000.0,
)
CONE = Line("conical shaft", (Disc(5.0), Shaft(2.0, (0.2, 0.08)), Disc(0.5, 3.0)), 60000.0)
STEPPED = Line(
    "stepped shaft with three discs",
    (
        Disc(4.0),
        Shaft(0.8, (0.1, 0.1)),
        Shaft(0.5, (0.14, 0.14)),
        Disc(2.5),
        Shaft(1.1, (0.12, 0.12)),
        Shaft(0.6, (0.09, 0.09), 0.03),
        Shaft(0.9, (0.11, 0.11)),
        Disc(6.0),
    ),
    60000.0,
)
LINES = (DRILL_STRING, MARINE, CONE)


def scene(line: Line) -> str:
    """The text of a scene file, in which 1 N m of order 1 acts on the first disc; JSON is YAML."""
    materials: dict[str, dict[str, float]] = {}
    train = [_component(item, f"item {place}", materials) for place, item in enumerate(line.items)]
    excited = [{"at": "item 0", "order": 1, "torque": 1.0}]
    speeds = {"speeds": {"from": "1 rad/s", "to": "2 rad/s"}}  # which who solves it chooses
    parts = {"materials": materials, "train": train, "operation": speeds, "excitations": excited}
    return json.dumps({"name": line.name, **parts})


def _component(item: Item, called: str, materials: dict[str, dict[str, float]]) -> dict[str, Any]:
    match item:
        case Disc():
            return {"disc": {"name": called, "inertia": item.inertia, "damping": item.damping}}
        case Coupling():
            return {"coupling": {"stiffness": item.stiffness}}
        case Gear():
            return {"gear": {"teeth": list(item.teeth), "inertia": list(item.inertia)}}
    name = f"G {item.shear_modulus:g} rho {item.density:g}"
    materials[name] = {"shear_modulus": item.shear_modulus, "density": item.density}
    shaft: dict[str, Any] = {
        "name": called,
        "length": item.length,
        "diameter": list(item.diameter),
        "material": name,
    }
    return {"shaft": shaft | ({"bore": item.bore} if item.bore else {})}
