"""What the file says within an engine: geometry, masses, journals, and the gas torque of a cylinder."""

import cmath
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema

from torsion import fields, units
from torsion.errors import Refusal
from torsion.fields import (
    Declared,
    Mass,
    OneOrMany,
    Quantity,
    exclusive,
    given,
    or_value,
    read_item,
    refuse,
    required,
    shown,
    together,
)
from torsion.kernels.round_sections import section_modulus
from torsion.model.engine.crankshaft import check_rod

Length = Annotated[float, Quantity("m", above=0, usual="size of an engine")]
Pressure = Annotated[float, Quantity("Pa", above=0, usual="pressure of a gas")]
Pressures = Annotated[tuple[Pressure, ...], OneOrMany]  # one value, or one a load
Crankcase = Annotated[float, Quantity("Pa", at_least=0, usual="pressure of a gas")]
Turned = Annotated[float, Quantity("rad", above=0, usual="crank angle of an event")]
Ratio = Annotated[float, Quantity("1", above=1, usual="compression ratio")]
Share = Annotated[float, Quantity("1", at_least=0, usual="share of a cylinder")]
ROW = "[order, amplitude, phase], for example [1.5, 420 N*m, -80 deg], or {order: 1.5, a: 70 N*m, b: 410 N*m}"
FORMS = ("table", "tables", "diagram", "cycle")
MOST_ORDER = 48  # of the crankshaft
Row = tuple[
    Fraction, complex, str
]  # order; amplitude in N m of one cylinder, or Pa; which of the two


Number = Annotated[int, Field(ge=1, le=100)]
Numbers = Annotated[tuple[Number, ...], OneOrMany]


def _misfire(value: Any) -> Any:
    """Read the word `worst`, or the numbers of cylinders."""
    if value == "worst":
        return value
    numbers = value if isinstance(value, list | tuple) else (value,)
    if not all(type(number) is int and number >= 1 for number in numbers):
        raise refuse(
            f"{shown(value)} names no cylinders", "a number from 1 on, a list of them, or worst"
        )
    return tuple(numbers)


Misfire = Annotated[
    Any,
    BeforeValidator(
        _misfire, json_schema_input_type=Number | tuple[Number, ...] | Literal["worst"]
    ),
]
Phase = Annotated[
    Any,
    BeforeValidator(
        lambda value: value if value == "worst" else Quantity("rad").read(value),
        json_schema_input_type=fields.Angle | Literal["worst"],
    ),
]
Throws = tuple[
    Annotated[
        tuple[Number, ...],
        BeforeValidator(
            lambda value: (value,) if type(value) is int else value, Number | tuple[Number, ...]
        ),
    ],
    ...,
]


class Geometry(Declared):
    """The crank mechanism of a cylinder."""

    bore: Length = required("diameter of the cylinder")
    stroke: Length = required("way of the piston")
    rod_length: Length = required("connecting rod, between the centres of its eyes")
    offset: Annotated[float, Quantity("m", usual="offset of a crank")] = given(
        "offset of the cylinder's axis, positive to the side to which the pin moves first", 0.0
    )

    def refuse_clashes(self) -> None:
        check_rod(self.rod_length, self.stroke, self.offset)


class RodMasses(Declared):
    """A connecting rod."""

    mass: Mass = required("mass")
    centre: Length = required("centre of mass, from the centre of the big end")
    inertia: fields.Inertia = required("about its centre of mass")


class Masses(Declared):
    """Moving masses of one cylinder."""

    clashes = (
        exclusive("reciprocating", "piston", hint="masses: {reciprocating: 2.5 kg}", needed=True),
        *together("piston", "rod", hint="`reciprocating` holds both shares in one figure"),
    )

    reciprocating: Mass | None = given("piston, pin and the rod's share")
    piston: Mass | None = given(
        "piston with pin and rings, in place of `reciprocating`, with `rod`"
    )
    rod: RodMasses | None = given("{mass, centre, inertia} of the connecting rod")


class Journal(Declared):
    """A journal or pin of the crankshaft, for its nominal stress."""

    diameter: fields.Across = required("outer diameter")
    bore: fields.Bore = given("diameter of its bore", 0.0)
    length: Length | None = given("length, for an estimate of the stiffness of a throw, with `web`")

    def refuse_clashes(self) -> None:
        if self.bore >= self.diameter:
            raise refuse("the bore is not smaller than the diameter", "both are diameters", "bore")

    @property
    def modulus(self) -> float:
        """m3, torque over the largest nominal stress."""
        return float(section_modulus(self.diameter, self.bore))


class Web(Declared):
    """A web of a throw, as a rectangle."""

    thickness: Length = required("along the shaft")
    width: Length = required("across")


def _amount(value: object) -> tuple[float, str]:
    """A torque (N m) or a tangential pressure (Pa), and which."""
    if not isinstance(value, str):
        return Quantity("N*m").read(value), "N*m"
    for unit in ("N*m", "Pa"):
        with suppress(Refusal):
            return units.to_si(value, unit), unit
    message = f"{shown(value)} is neither a torque nor a pressure"
    raise refuse(message, "an amplitude of a cylinder is in N*m or `bar`")


def _order(value: object) -> Fraction:
    order = fields.read_exact(value)
    if order > MOST_ORDER:
        raise refuse(
            f"order {order} is above {MOST_ORDER}", "orders count by revolution of the crankshaft"
        )
    return order


def _row(value: object) -> Row:
    """Read one order of a table of harmonics; a row that is read stays."""
    if isinstance(value, tuple) and len(value) == 3 and isinstance(value[1], complex):
        return value
    if isinstance(value, dict):
        if set(value) != {"order", "a", "b"}:
            raise refuse("a row by cosine and sine has the keys `order`, `a` and `b`", ROW)
        (a, unit), (b, unit_of_b) = (read_item(value, key, _amount) for key in ("a", "b"))
        if unit != unit_of_b:
            raise refuse("`a` and `b` are of one unit", ROW)
        return read_item(value, "order", _order), complex(a, -b), unit
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise refuse(f"{shown(value)} is not a row of harmonics", ROW)
    size, unit = read_item(value, 1, _amount)
    if size < 0:
        raise refuse("an amplitude is not negative", "turn its phase by 180 deg", (1,))
    phase = read_item(value, 2, Quantity("rad").read)
    return read_item(value, 0, _order), cmath.rect(size, phase), unit


def _rows(value: Any) -> tuple[Row, ...]:
    if not isinstance(value, list | tuple) or not value:
        raise refuse(f"{shown(value)} is not a table of harmonics", f"rows {ROW}")
    rows = tuple(read_item(value, number, _row) for number in range(len(value)))
    orders = [order for order, _, _ in rows]
    for number, order in enumerate(orders):
        if order in orders[:number]:
            raise refuse(f"the table lists order {order} twice", "one row an order", (number,))
    return rows


_TABLE = {
    "anyOf": [
        {"type": "string", "description": "name of a CSV file"},
        {
            "type": "array",
            "minItems": 1,
            "items": {
                "anyOf": [
                    {"type": "array", "minItems": 3, "maxItems": 3},
                    {"type": "object", "required": ["order", "a", "b"]},
                ]
            },
        },
    ]
}
Rows = Annotated[tuple[Any, ...], BeforeValidator(_rows), WithJsonSchema(_TABLE)]


class Stated(Declared):
    """The load that a table is for."""

    clashes = (exclusive("imep", "torque", hint="at: {imep: 18 bar}", needed=True),)

    imep: Pressure | None = given("indicated mean effective pressure; needs `geometry`")
    torque: fields.PositiveTorque | None = given("mean torque of the engine")


class TableAt(Stated):
    """A table of harmonics at a load or speed."""

    clashes = (
        exclusive("imep", "torque", "speed", hint="{imep: 5 bar, rows: [...]}", needed=True),
    )

    speed: fields.Speed | None = given("speed of the engine; the table then includes the load")
    rows: Rows = required(f"rows {ROW}")

    @property
    def key(self) -> str:
        """The key at which the table stands: a load or a speed."""
        return self.keys_given("imep", "torque", "speed")[0]


class DiagramFile(Declared):
    """A measured or computed pressure over the crank angle."""

    file: str = required(
        "text file of two columns, for example `angle [deg], pressure [bar]` in its first line",
        min_length=1,
    )
    speed: fields.Speed | None = given(
        "speed at which it was taken; needed by every one of several over speed"
    )


# One file, or several over load or speed.
Diagrams = Annotated[
    tuple[Annotated[DiagramFile, or_value(DiagramFile, "file", str)], ...], OneOrMany
]


class Gas(Declared):
    """The gas torque of a cylinder: one of `table`, `tables`, `diagram` and `cycle`."""

    clashes = (exclusive(*FORMS, hint="one of them states the gas torque", needed=True),)

    table: Rows | None = given(
        f"harmonics of one cylinder by order of the crankshaft: rows {ROW}; phases of a cosine "
        "that counts from firing top dead centre; torques, or tangential pressures"
    )
    at: Stated | None = given(
        "load of the `table`: {imep} or {torque}; without it the same at every load"
    )
    motored: Rows | None = given(
        "rows of a cylinder without fuel, of `table` and `tables`; needed for a misfire"
    )
    tables: tuple[TableAt, ...] = given(
        "list of {imep | torque | speed, rows}, interpolated as complex numbers; or a "
        "CSV file with a column of that",
        (),
    )
    diagram: Diagrams = given(
        "file of the pressure over the crank angle, {file, speed}, or a list of them", ()
    )
    tdc: fields.Angle | None = given(
        "angle in the file at which the cylinder is at firing top dead centre"
    )
    absolute: bool | None = given(
        "true: pressures of the file are absolute; false: gauge pressures"
    )
    cycle: Literal["wiebe"] | None = given(
        "closed cycle computed from the figures below, heat by a Wiebe function"
    )
    compression_ratio: (
        Annotated[float, Quantity("1", above=1, usual="compression ratio")] | None
    ) = given("of the `cycle`")
    charge: Pressures = given(
        "absolute pressure when compression begins, and of the intake; one value, or by load", ()
    )
    exhaust: Pressures = given(
        "absolute pressure of the exhaust stroke (four strokes); one value, or by load", ()
    )
    imep: Pressures = given(
        "indicated mean effective pressure of the `cycle`, one or a rising list of loads; with "
        "a `diagram`, a value to compare with",
        (),
    )
    p_max: Pressures = given("peak pressure, absolute; one value, or by load", ())
    gamma: Annotated[float, Quantity("1", above=1, usual="ratio of heats")] = given(
        "ratio of heats", 1.35
    )
    shape: Annotated[float, Quantity("1", at_least=0, usual="shape of a heat release")] = given(
        "m of the Wiebe function: 0.5 to 1.2 of diesel engines, 2 to 3 of spark ignition (to be verified)",
        1.0,
    )
    duration: Turned | None = given(
        "of the heat release: 50 to 80 deg of diesel engines (to be verified)"
    )
    exhaust_opens: Turned | None = given(
        "after top dead centre (two strokes); it closes as long before it"
    )
    scavenge_opens: Turned | None = given("after top dead centre (two strokes)")
    crankcase: Crankcase = given("absolute pressure under the piston", 101325.0)

    def refuse_clashes(self) -> None:
        kind = self.keys_given(*FORMS)[0]
        suitable, needed = OF_EACH[kind]
        for key in (key for keys, _ in OF_EACH.values() for key in keys):
            if key not in suitable and key in self.model_fields_set:
                hint = f"with it go {', '.join(suitable)}"
                raise refuse(f"`{key}` does not go with `{kind}`", hint, key)
        # Keys of which any will do stand in one text: the exhaust of four strokes, or of two.
        if missing := [keys for keys in needed if not self.keys_given(*keys.split())]:
            words = ", ".join(" or ".join(f"`{key}`" for key in keys.split()) for keys in missing)
            keys = " ".join(missing).split()
            meanings = "; ".join(type(self).model_fields[key].description or "" for key in keys)
            raise refuse(f"{words} {'is' if len(missing) == 1 else 'are'} missing", meanings)
        loads = len(self.imep) if self.cycle else 1
        for key in ("charge", "exhaust", "imep", "p_max"):
            if (count := len(getattr(self, key))) not in (0, 1, loads):
                message = f"`{key}` has {count} values, and `imep` {loads}"
                raise refuse(message, "one value, or one a load", key)
        if any(before >= after for before, after in pairwise(self.imep)):
            raise refuse("the loads of `imep` do not rise", "lowest first", "imep")
        # Several tables or diagrams are of one kind, in rising order.
        if self.tables and (len(self.tables) < 2 or len({table.key for table in self.tables}) > 1):
            message = "`tables` are two or more, all by one of `imep`, `torque` and `speed`"
            raise refuse(message, "", "tables")
        speeds = [diagram.speed for diagram in self.diagram]
        given_speeds = [speed for speed in speeds if speed is not None]
        if len(speeds) == 1 and given_speeds:
            message = "one diagram stands for every speed"
            raise refuse(message, "leave its `speed` out, or give several", "diagram")
        if len(speeds) > 1 and self.imep:
            message = "`imep` is compared with the value of one diagram, and there are several"
            raise refuse(message, "leave it out", "imep")
        if 0 < len(given_speeds) < len(speeds):
            message = "of several diagrams all have a speed, or none"
            raise refuse(message, "over speed, or over load", "diagram")
        values = [getattr(table, table.key) for table in self.tables] or given_speeds
        if any(before >= after for before, after in pairwise(values)):
            key = "tables" if self.tables else "diagram"
            raise refuse("list several tables or diagrams in rising order", "", key)


OF_CYCLE = ("compression_ratio", "charge", "imep", "p_max", "duration")
OF_EACH: dict[
    str, tuple[tuple[str, ...], tuple[str, ...]]
] = {  # keys that go with it, that it needs
    "table": (("at", "motored"), ()),
    "tables": (("motored",), ()),
    "diagram": (("tdc", "absolute", "imep", "crankcase"), ("tdc", "absolute")),
    "cycle": (
        (*OF_CYCLE, "exhaust", "gamma", "shape", "exhaust_opens", "scavenge_opens", "crankcase"),
        (*OF_CYCLE, "exhaust exhaust_opens"),
    ),
}
