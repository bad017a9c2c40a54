"""Spans whose stiffness and damping follow a table: the system at one frequency, and complex stiffness over many."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path

if TYPE_CHECKING:
    from torsion.kernels.stiffness_laws import StiffnessTable

WORDS = {
    "frequency": ("Hz", 2.0 * np.pi),
    "mean torque": ("N m", 1.0),
    "vibratory torque": ("N m", 1.0),
    "speed": ("rpm", np.pi / 30.0),
}
NOTHING: Mapping[int, FloatArray] = {}
ROUNDING = 1e-9  # relative, beyond the ends of a table: a value written in another unit


def reach(system: System) -> tuple[float, float]:
    """rad/s between which every table that refuses to go further says something; where all hold, beyond all of them."""
    tables = system.tables_over("frequency").values()
    refusing = [table for table in tables if not table.holds]
    if refusing:
        return max(table.at[0] for table in refusing), min(table.at[-1] for table in refusing)
    return min(table.ends[0] for table in tables), max(table.ends[1] for table in tables)


def taken_at(
    system: System,
    w: float | None = None,
    *,
    mean: FloatArray | None = None,
    speed: float | None = None,
) -> System:
    """The system with the stiffness and damping of its tables at one point each, and no such table.

    w: rad/s, for tables over frequency; mean: (spans,) N m, for those over mean torque; speed: rad/s of the reference
    station. Other tables stay. The tree keeps its layout; values at the nearest end stand for those beyond a table.
    """
    values, tables = dict[int, tuple[float, float, float]](), dict(system.tables)
    for span, table in system.tables.items():
        x = w if table.over == "frequency" else None
        if table.over == "mean torque" and mean is not None:
            x = abs(float(mean[span]))
        elif table.over == "speed" and speed is not None:
            x = speed * float(system.span_ratio[span])
        if x is not None:
            k, loss, viscous = (float(value) for value in table.values(np.asarray(x)))
            values[span] = 1.0 / k, viscous, loss
            del tables[span]
    return with_springs(system, values, tables) if values else system


def with_springs(
    system: System,
    values: Mapping[int, tuple[float, float, float]],
    tables: "Mapping[int, StiffnessTable]",
) -> System:
    """The system with other flexibility (rad/(N m)), viscous damping and loss factor of some spans, and other tables.

    The tree keeps its layout, but where a span that closes a loop becomes rigid.
    """
    spans = list(values)
    taken = np.array(list(values.values())).reshape(-1, 3).T
    stated = np.array([system.flexibility, system.viscous, system.loss_factor])
    stated[:, spans] = taken
    flexibility, viscous, loss_factor = stated
    changed = replace(
        system, flexibility=flexibility, viscous=viscous, loss_factor=loss_factor, tables=tables
    )
    before, ratio2 = system.condensed, system.span_ratio[spans] ** 2
    node = before.span[spans]
    inside = node >= 0
    if (taken[0][~inside] == 0.0).any():
        return changed
    of_tree = np.array([before.tree.flexibility, before.viscous, before.loss_factor])
    referred = np.array([taken[0] / ratio2, taken[1] * ratio2, taken[2]])
    of_tree[:, node[inside]] = referred[:, inside]
    flexibility, viscous, loss_factor = of_tree
    tree = replace(before.tree, flexibility=flexibility)
    vars(changed)["condensed"] = replace(
        before, tree=tree, viscous=viscous, loss_factor=loss_factor
    )
    return changed


def complex_stiffness(
    system: System,
    w: FloatArray,
    mean: FloatArray | None = None,
    speed: FloatArray | None = None,
    vibratory: Mapping[int, FloatArray] = NOTHING,
) -> dict[int, ComplexArray]:
    """(frequencies,) N m/rad of every span with a table, at circular frequencies w (frequencies,) rad/s.

    mean: (spans, frequencies) N m mean torque; without it the tables over mean torque are left out. speed:
    (frequencies,) rad/s of the reference station; the same. vibratory: (frequencies,) N m of spans whose table is over
    it; others are left out. Raises InputError where a table does not cover them.
    """
    stiffness: dict[int, ComplexArray] = {}
    for span, table in system.tables.items():
        carried = (
            vibratory.get(span)
            if table.over == "vibratory torque"
            else None
            if mean is None
            else mean[span]
        )
        x = system.followed(span, w, carried, speed)
        if x is None:
            continue
        refuse_beyond(system, span, x)
        stiffness[span] = table.complex_stiffness(x, w)
    return stiffness


def refuse_beyond(system: System, span: int, x: FloatArray) -> None:
    """Raise InputError where the table of a span says nothing of x (rad/s, or N m)."""
    table, given = system.tables[span], np.ravel(x)
    low, high = table.at[0] * (1.0 - ROUNDING), table.at[-1] * (1.0 + ROUNDING)
    outside = given[(given < low) | (given > high)]
    if table.holds or not outside.size:
        return
    unit, size = WORDS[table.over]
    worst = outside[np.argmax(np.abs(outside - 0.5 * (table.at[0] + table.at[-1])))]
    ends = " to ".join(f"{end / size:.6g}" for end in (table.at[0], table.at[-1]))
    covers = f"the table of '{system.spans[span].name}' covers {ends} {unit}"
    message = f"{covers}; {worst / size:.6g} {unit} is needed"
    hint = "extend the table, narrow the speeds or orders, or `beyond: hold` to keep the values at its ends"
    raise InputError([Fault(table_path(system, span), message, hint)])


def table_path(system: System, span: int) -> Path:
    """The place of the table in the file."""
    key = system.tables[span].key
    return (*system.train.parts[system.spans[span].part].path, *([key] if key else []))
