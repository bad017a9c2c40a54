"""What the columns of a CSV table may be: the keys of the entries that its rows stand for, from their declarations."""

from dataclasses import dataclass
from functools import cache
from pkgutil import resolve_name

from pydantic import BaseModel

from torsion.components import KINDS, component
from torsion.fields import Amount, Quantity
from torsion.schema.declaration_reader import items_of, keys_of

MAPPINGS = {  # lists of mappings: key, what may declare an entry
    "excitations": ("torsion.components.harmonic_torques:Excitation",),
    "ripple": ("torsion.components.harmonic_torques:Ripple",),
    "excitation": (
        "torsion.components.propeller:BladeTorque",
        "torsion.components.harmonic_torques:Ripple",
    ),
    "sections": ("torsion.components.shaft:Shaft",),
}
PAIRS = ("load", "torque")  # lists of [speed, torque]
SPEED_AND_TORQUE = {"speed": ("rad/s",), "torque": ("N*m", "1")}
LIBRARY = "coupling"  # the kind that libraries have
CATALOGUE = "catalogue of "  # and a kind: alternatives of one component
LABEL, SAID = (
    "name",
    {"mass": ("kg",), "cost": ()},
)  # of a row of a catalogue beside keys: its name, what it states
BY_POLAR, BY_PARTS = ("order", "amplitude", "phase"), ("order", "a", "b")  # of a harmonic
HARMONIC = {
    "order": ("1",),
    "amplitude": ("N*m", "Pa"),
    "phase": ("rad",),
    "a": ("N*m", "Pa"),
    "b": ("N*m", "Pa"),
}
LOADS = {
    "imep": ("Pa",),
    "torque": ("N*m",),
    "speed": ("rad/s",),
}  # at which a table of harmonics stands
HARMONICS, BY_LOAD = "harmonics", "harmonics by load"
TORSIOGRAM = "torsiogram"  # a list of mappings, measured
TORSIOGRAM_NEEDS: tuple[str, ...] = ("speed", "amplitude")
OF_SPEED = {"speed": ("rad/s",), "amplitude": ("rad", "rad/s", "N*m"), "phase": ("rad",)}
FIGURES: dict[
    str, dict[str, tuple[str, ...]]
] = {  # of lists without a declaration: columns with their units
    **dict.fromkeys(PAIRS, SPEED_AND_TORQUE),
    HARMONICS: HARMONIC,
    BY_LOAD: HARMONIC | LOADS,
    TORSIOGRAM: OF_SPEED,
}


@dataclass(frozen=True)
class Stated:
    """What the declaration of a key says of its column."""

    units: tuple[str, ...]
    is_text: bool


@cache
def columns_of(key: str) -> dict[tuple[str, str], Stated]:
    """Every key of the entries of a list, with the kind of component that it is of."""
    if key in FIGURES:
        return {("", name): Stated(expected, False) for name, expected in FIGURES[key].items()}
    if key == LIBRARY:
        found = {
            ("", name): one for name, one in _declared(component(key)).items() if name != "from"
        }
        return found | {("", "size"): Stated((), True)}
    if key.startswith(CATALOGUE):
        own = _declared(component(key.removeprefix(CATALOGUE)))
        found = {("", name): one for name, one in own.items() if name not in ("from", "size")}
        return found | {("", name): Stated(units, False) for name, units in SAID.items()}
    if key in MAPPINGS:
        entries = [_declared(resolve_name(entry)) for entry in MAPPINGS[key]]
        return {("", name): found for entry in entries for name, found in entry.items()}
    return {
        (kind, name): found for kind in KINDS for name, found in _declared(component(kind)).items()
    }


def _declared(kind: type[BaseModel]) -> dict[str, Stated]:
    found = {}
    for key, field in keys_of(kind).items():
        items = list(items_of(field))
        expected = {item.unit for item in items if isinstance(item, Quantity)}
        expected |= {"N*m", "1"} if Amount in items else set()
        is_mapping = any(isinstance(one, type) and issubclass(one, BaseModel) for one in items)
        is_text = str in items and not expected and float not in items and not is_mapping
        found[key] = Stated(tuple(sorted(expected)), is_text)
    return found
