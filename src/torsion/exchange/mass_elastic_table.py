"""A mass-elastic table, as engine makers print it, as a model file: one mass a row, with the shaft to the next mass.

Columns go by their titles in any order, with the unit in brackets. `ratio` is the speed of the mass over that of the
first mass; a gear stands between two rows with different ratios.
"""

import json
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from torsion import units
from torsion.errors import Fault, refusal
from torsion.schema.fault_text import input_error
from torsion.schema.yaml_source import is_number
from torsion.tables import Cell, Table, head_of, table_text, unit_fault
from torsion.user_files import Source, printable, without_controls

# fmt: off
TITLES = {  # what a column states: its titles in small letters
    "no": "no, nr, nr., no., #, mass, station",
    "name": "name, description, designation, benennung, component",
    "inertia": "j, inertia, moment of inertia, theta, θ, massenträgheitsmoment",
    "gd2": "gd2, gd^2, gd²",
    "wr2": "wr2, wk2",
    "stiffness": "k, c, stiffness, torsional stiffness, drehsteifigkeit",
    "flexibility": "flexibility, compliance",
    "viscous": "d, damping, viscous",
    "psi": "psi, ψ",
    "loss_factor": "loss factor, loss_factor, eta",
    "magnifier": "magnifier",
    "ground": "ground, external damping, mass damping",
    "ratio": "ratio, speed ratio",
}
COLUMNS = {title: key for key, titles in TITLES.items() for title in titles.split(", ")}
UNITS = {  # column: SI unit
    "inertia": "kg*m**2", "gd2": "kg*m**2", "wr2": "kg*m**2", "stiffness": "N*m/rad", "flexibility": "rad/(N*m)",
    "viscous": "N*m*s/rad", "ground": "N*m*s/rad",
}
SPELLINGS = {  # as makers print it: as the model file has it
    "rad/Nm": "rad/(N*m)", "rad/N m": "rad/(N*m)", "in-lb/rad": "lbf*in/rad", "in lb/rad": "lbf*in/rad",
    "lb-in/rad": "lbf*in/rad", "ft-lb/rad": "lbf*ft/rad", "lb-ft/rad": "lbf*ft/rad",
    "kgfm2": "kgf*m**2", "kpm2": "kgf*m**2", "kpm²": "kgf*m**2",
}
# fmt: on
LINK = ("stiffness", "flexibility", "viscous", "psi", "loss_factor", "magnifier")
EDITOR_KEYS = {  # of openTorsion-Editor: type of an element, its keys and their columns
    "Disk": {"inertia": "inertia", "damping": "ground"},
    "ShaftDiscrete": {"stiffness": "stiffness", "damping": "viscous"},
}
EMPTY = ("", "-", "–", "—")
TEMPLATE = """\
no;name;J [kg m2];k [kN m/rad];d [N m s/rad];psi;ground [N m s/rad];ratio
1;flywheel;6.4;12;;0.9;;1
2;gear wheel;0.32;;;;;1
3;pinion;0.05;310;;;;23/71
4;propeller;5.8;;;;12;23/71
"""


@dataclass(frozen=True)
class Mass:
    """One row: values as text with their units, by column."""

    name: str
    line: int
    values: dict[str, str]
    ratio: Fraction = Fraction(1)
    unread: tuple[str, ...] = ()  # columns that the model file has no key for, with their values


def import_table(path: str | Path, *, referred: bool = False) -> str:
    """Return the model file of a table (CSV) or of an openTorsion-Editor file (JSON); raises InputError.

    `referred`: all values are referred to the speed of the first mass.
    """
    path = Path(path)
    try:
        text, fault = table_text(path)
    except OSError as error:
        raise refusal(f"{printable(str(path))} cannot be read: {error.strerror}") from None
    source = Source(without_controls(str(path)), text)
    if fault is not None:
        raise input_error([fault], source)
    masses = _editor_masses(source) if path.suffix.lower() == ".json" else _table_masses(source)
    return _model_file(masses, f"Imported from {path.name}", referred=referred)


def _table_masses(source: Source) -> list[Mass]:
    """Read the rows of a CSV table; every fault of the table at once."""
    table = Table(source.text)
    rows = table.rows
    if len(rows) < 2:
        first_cell = rows[0][0] if rows else Cell("", 1, 1)
        hint = "write a row of titles, then a row for each mass"
        table.fault(first_cell, "the table has no masses", hint)
        raise input_error(table.faults, source)
    columns = [_column(cell, table) for cell in rows[0]]
    table.read_signs(cell for row in rows[1:] for cell in row)
    masses = [_mass(row, columns, table) for row in rows[1:]]

    # Masses that nothing connects to the next, a stiffness after the last, and inertias stated twice.
    for mass, following, row in zip(masses, [*masses[1:], None], rows[1:], strict=True):
        elastic, name = {"stiffness", "flexibility"} & mass.values.keys(), f"'{mass.name}'"
        if len(elastic) > 1:
            message = f"{name} has a stiffness and a flexibility"
            table.fault(row[0], message, "leave one of them empty")
        if following is None and not mass.values.keys().isdisjoint(LINK):
            message = f"{name} is the last mass and has a shaft to the next"
            table.fault(row[0], message, "leave its cells empty")
        if following is not None and not elastic and following.ratio == mass.ratio:
            hint = "write it, or 0 in a column `flexibility` for a rigid connection"
            table.fault(row[0], f"{name} has no stiffness to the next mass", hint)
        if len({"inertia", "gd2", "wr2"} & mass.values.keys()) > 1:
            table.fault(row[0], f"{name} states its inertia twice", "leave one of the cells empty")
    if table.faults:
        raise input_error(table.faults, source)
    return masses


def _column(cell: Cell, table: Table) -> tuple[str, str, str]:
    """Return the key of a column ('' for one that is not read), its unit as text, and its title."""
    title, unit = head_of(cell.text)
    key = COLUMNS.get(title.casefold(), "")
    spelled = SPELLINGS.get(unit, unit)
    if key in UNITS:
        fault = unit_fault(spelled, UNITS[key]) if spelled else None
        weight = spelled.replace("kgf", "kg").replace(
            "kp", "kg"
        )  # GD2 of kgf m2: the same number in kg m2
        if fault is not None and key == "gd2" and unit_fault(weight, UNITS[key]) is None:
            fault, spelled = None, weight
        if fault is not None:
            table.fault(cell, fault.message, fault.hint)
    elif key in ("psi", "loss_factor", "magnifier", "ratio") and spelled not in ("", "1", "%"):
        table.fault(cell, f"`{title}` has no unit", f"write `{title}`")
    return key, spelled or UNITS.get(key, ""), title


def _mass(row: list[Cell], columns: list[tuple[str, str, str]], table: Table) -> Mass:
    """Read one row; its faults are noted in the table."""
    values, unread, ratio = dict[str, str](), list[str](), Fraction(1)
    if len(row) > len(columns) and any(cell.text for cell in row[len(columns) :]):
        table.fault(row[len(columns)], "the row has more cells than there are titles")
    for cell, (key, unit, title) in zip(row, columns, strict=False):
        text = table.plain(cell.text)
        if cell.text in EMPTY:
            continue
        if key in ("no", "name"):
            values[key] = cell.text
        elif not key:
            unread.append(f"{title or 'column without title'}: {cell.text}")
        elif key == "ratio":
            try:  # `23/71`, `0.324` or `1`
                ratio = Fraction(text.replace(" ", ""))
            except (ValueError, ZeroDivisionError):
                ratio = Fraction(0)
            if ratio <= 0:
                hint = "write speed of the mass / speed of the first: 23/71"
                table.fault(cell, f"`{cell.text}` is not a speed ratio", hint)
                ratio = Fraction(1)
        elif not is_number(text):
            hint = "write a number, or leave the cell empty"
            table.fault(cell, f"`{cell.text}` is not a number", hint)
        else:
            values[key] = f"{text} {unit}".strip()
    number = values.pop("no", "")
    name = values.pop("name", "") or (number and f"mass {number}")
    if not name:
        hint = "add a column `name` or `no`"
        table.fault(row[0], "the row has neither a name nor a number", hint)
    return Mass(name, row[0].line, values, ratio, tuple(unread))


def _editor_masses(source: Source) -> list[Mass]:
    """Read the disks and discrete shafts of an openTorsion-Editor file in their order."""
    try:
        data = json.loads(source.text)
        kinds = [
            (f"{part['name']}.{element['name']}", element["type"], element)
            for part in data["components"]
            for element in part["elements"]
        ]
    except (ValueError, KeyError, TypeError, RecursionError):
        hint = "expected: components: [{name, elements: [{name, type: Disk, inertia: 1.0}, ...]}]"
        fault = Fault((), "this is not an openTorsion-Editor file", hint, line=1, column=1)
        raise input_error([fault], source) from None
    masses, faults = list[Mass](), list[Fault]()
    for name, kind, element in kinds:
        if kind not in EDITOR_KEYS or (kind != "Disk" and not masses):
            hint = "elements that are read: Disk, and ShaftDiscrete after a Disk"
            faults.append(Fault((), f"'{name}' of type {kind} is not read", hint, line=1, column=1))
            continue
        keys = EDITOR_KEYS[kind]
        values = {  # with their SI units; zero damping is left out
            column: f"{element[key]!r} {UNITS[column]}"
            for key, column in keys.items()
            if isinstance(element.get(key), int | float) and (element[key] or column == "inertia")
        }
        if kind == "Disk":
            unread = (
                f"{key}: {json.dumps(value)}"
                for key, value in element.items()
                if key not in ("name", "type", *keys) and value
            )
            masses.append(Mass(name, 1, values, unread=tuple(unread)))
        else:
            masses[-1].values.update(values)
    if not masses:
        faults.append(Fault((), "the file has no Disk", line=1, column=1))
    if faults:
        raise input_error(faults, source)
    return masses


def _model_file(masses: list[Mass], title: str, *, referred: bool) -> str:
    """Write the model file: a disc a mass, a coupling or a gear between two."""
    lines = [f"name: {json.dumps(title, ensure_ascii=False)}", "train:"]

    def add(kind: str, name: str, **values: str | None) -> None:
        keys = [f"{key}: {value}" for key, value in values.items() if value is not None]
        body = ", ".join([f"name: {json.dumps(name, ensure_ascii=False)}", *keys])
        lines.append(f"  - {kind}: {{{body}}}")

    names = list[str]()
    for mass in masses:
        names.append(mass.name if mass.name not in names else f"{mass.name} (line {mass.line})")
    for number, (mass, name) in enumerate(zip(masses, names, strict=True)):
        lines += [f"  # not read of {name}: {words}" for words in mass.unread]
        values = mass.values
        # GD2 of technical tables is four times J, WR2 is J.
        inertia = values.get("inertia") or values.get("wr2") or f"0 {UNITS['inertia']}"
        if "gd2" in values:
            amount, unit = units.amount(values["gd2"])
            inertia = f"{float(amount / 4)!r} {unit}"
        add("disc", name, inertia=inertia, damping=values.get("ground"))
        if number + 1 == len(masses):
            break
        following = names[number + 1]
        if "stiffness" in values or "flexibility" in values:
            add("coupling", f"{name} to {following}", **{key: values.get(key) for key in LINK})
        ratio = mass.ratio / masses[number + 1].ratio
        if ratio != 1:
            extra = "true" if referred else None
            add("gear", f"gear before {following}", ratio=str(ratio), referred=extra)
    return "\n".join(lines) + "\n"
