"""Rows of a CSV catalogue as alternatives of one component: what each puts in the file, and what else it states."""

from collections.abc import Iterator
from dataclasses import replace

from torsion import units
from torsion.errors import Fault
from torsion.model.parts import Part
from torsion.schema.fault_text import Source
from torsion.schema.table_rows import CATALOGUE, LABEL, STATED, Reading, Rows
from torsion.schema.varied_figure import Row


def alternatives(name: str, part: Part, source: Source, faults: list[Fault]) -> Iterator[Row]:
    """Every row of a catalogue of a component, with mass and cost; the reader of the source has opened the table."""
    reading = Reading(source, None, dict(source.tables), [])
    for row in Rows(reading.tables[name], CATALOGUE + part.kind).nodes(reading):
        label, stated = str(row.value[LABEL]), {}
        for key in STATED.keys() & row.parts.keys():
            try:
                stated[key] = _number(row.parts[key].value, key)
                if stated[key] < 0.0:
                    raise units.UnitFault(
                        f"a {key} of {row.parts[key].value} is below 0", "0 or more"
                    )
            except units.UnitFault as fault:
                cell = row.parts[key]
                reading.faults.append(
                    Fault(
                        (),
                        fault.message,
                        fault.hint,
                        line=cell.line,
                        column=cell.column,
                        file=reading.tables[name].name,
                    )
                )
        changes = {key: node for key, node in row.parts.items() if key not in (LABEL, *STATED)}
        origin = row.parts.get("source", row.parts[LABEL])
        changes["source"] = replace(
            origin, value=f"{name}, {label}" + (f": {origin.value}" if "source" in changes else "")
        )
        yield Row(label, tuple(((*part.path, key), node) for key, node in changes.items()), stated)
    faults += reading.faults


def _number(value: object, key: str) -> float:
    """A mass in kg, or a cost in whatever it is counted."""
    if STATED[key]:
        return units.to_si(str(value), STATED[key][0])
    return float(units.amount(str(value).partition(" ")[0])[0])
