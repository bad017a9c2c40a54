"""Holzer tables of every scene, computed again from their printed digits alone, and the sums of inertias.

Every figure stands for all the values that are rounded to it; what follows from it is the interval of all results. So
the check is as tight as the digits allow.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from tests.contracts.frozen import SCENES, solved
from tests.contracts.printed import NOTHING, Interval, Row, printed, rows, value, with_cell
from tests.for_all import for_all

import torsion
from torsion.analyses.system_data import SystemData
from torsion.output.blocks import Block, Table
from torsion.output.chapters.modes import natural_frequencies
from torsion.output.chapters.modes.natural_frequencies import HOLZER, SQUARE
from torsion.output.numbers import number

MODELS = ("lumped", "fem", "exact")
SHAFTED = ("usv", "haixun_06402", "tilting_tail")


@lru_cache(maxsize=2)
def blocks(scene: str, model: str) -> tuple[Block, ...]:
    """Tables of modes of a scene, in its own model or another."""
    if model:
        study = torsion.read(SCENES[scene])
        kept = {name: given for name, given in study.analyses.items() if name == "modes"}
        study = replace(study, analyses=kept, rules=(), model=model, fem=type(study.fem)())
        found = torsion.run(study, only=("modes",))
    else:
        found = solved(scene)
    modes = (
        chapter(found) for chapter in (natural_frequencies.appendix, natural_frequencies.all_modes)
    )
    return tuple(block for blocks_of_modes in modes for block in blocks_of_modes)


def tables(made: Iterable[Block], words: str) -> list[Table]:
    return [one for one in made if isinstance(one, Table) and one.caption.startswith(words)]


def holzer_faults(table: Table, constants: Table | None) -> Iterator[str]:
    """The rows that do not follow from the figures before them."""
    heading = re.search(r"ω² = (\S+) rad²/s²", table.caption)
    assert heading is not None
    square, every = printed(heading[1], SQUARE), rows(table)
    shafts = {} if constants is None else {row["Shaft"]: row for row in rows(constants)}
    left = [NOTHING] * len(every)
    for at, row in enumerate(every):
        angle, home = printed(row["Angle"], HOLZER), at
        if row["Station"].endswith(", closing a loop"):
            home = next(
                k for k, one in enumerate(every) if one["Station"] == row["Station"].split(",")[0]
            )
            if every[home]["Angle"] != row["Angle"]:
                yield f"row {at + 1}: the angle differs"
        elif row["J referred"] != "∞":
            moved = printed(row["ω² J × angle"], HOLZER)
            left[home] += moved
            if not moved.meets(square * printed(row["J referred"], HOLZER) * angle):
                yield f"row {at + 1}: ω² J × angle"
        if row["Through"] != "–":
            before = int(row["From no."]) - 1
            left[home] += printed(row["Torque out"], HOLZER)
            left[before] -= printed(row["Torque in"], HOLZER)
            for what in link_faults(row, printed(every[before]["Angle"], HOLZER), angle, shafts):
                yield f"row {at + 1}: {what}"
    for at, row in enumerate(every):
        if row["J referred"] not in ("∞", "–") and not left[at].meets(NOTHING):
            yield f"row {at + 1}: equilibrium"
    if value(table.caption.rpartition(" ")[2]) > 1e-9:
        yield "residual"


def link_faults(
    row: Row, above: Interval, angle: Interval, shafts: dict[str, Row]
) -> Iterator[str]:
    """Angle, twist and torque at both ends of what leads to a row, in figures."""
    enters, leaves, twist = (
        printed(row[title], HOLZER) for title in ("Torque in", "Torque out", "Twist")
    )
    if not angle.meets(above - twist):
        yield "angle"
    if row["Through"] in shafts:
        a, h, b, d = (printed(shafts[row["Through"]][title], HOLZER) for title in "AHBD")
        if not angle.meets(a * above - h * enters):
            yield "angle of the shaft"
        if not leaves.meets(b * above + d * enters):
            yield "torque of the shaft"
        if not (a * d + b * h).meets(Interval(1.0, 1.0)):
            yield "constants of the shaft"
        return
    if row["Torque in"] != row["Torque out"]:
        yield "torque"
    flexibility = printed(row["Flexibility"], HOLZER)
    if not twist.meets(flexibility * enters):
        yield "twist"


def every_row_of_a_holzer_table_follows_from_the_row_before_it(scene: str, model: str = "") -> None:
    made = blocks(scene, model)
    constants = {one.caption.split()[-1]: one for one in tables(made, "Constants of the shafts")}
    for table in tables(made, "Holzer table"):
        mode = table.caption.split(",")[0].split()[-1]
        assert list(holzer_faults(table, constants.get(mode))) == [], table.caption


@pytest.mark.parametrize("scene", ["usv", "friswell_geared_t"])
def test_no_figure_of_a_holzer_table_could_be_another(scene: str) -> None:
    """Changed by 1e-3 of itself every single one is found; by 3e-5 nearly all, those that nothing cancels."""
    made = blocks(scene, "")
    table, shafts = (
        tables(made, "Holzer table")[0],
        next(iter(tables(made, "Constants of the shafts")), None),
    )
    cells = [
        (row, column)
        for row in range(len(table.rows))
        for column in (2, 3, 4, 7, 8, 9, 10)
        if re.match(r"[−\d]", table.rows[row][column])
        and value(table.rows[row][column])
        and table.rows[row][{2: 3, 8: 7}.get(column, column)]
        != "0"  # nothing shows the inertia of what stands still
    ]
    for by, most in ((1e-3, 0.0), (3e-5, 0.15)):
        changed = [
            with_cell(table, *cell, number(value(table.rows[cell[0]][cell[1]]) * (1 + by), HOLZER))
            for cell in cells
        ]
        assert sum(not list(holzer_faults(one, shafts)) for one in changed) <= most * len(cells)


def inertias_refer_with_the_square_of_the_ratio_and_add_up(scene: str, model: str = "") -> None:
    found = solved(scene)
    data, system = found.need(SystemData), found.system
    for row in data.inertias:
        assert row.referred == pytest.approx(row.inertia * float(row.ratio) ** 2, rel=1e-14)
    for row in data.elements:
        if row.given is not None:
            assert row.given * float(row.given_ratio) ** 2 == pytest.approx(row.referred, rel=1e-14)
    whole = system.inertia * system.speed_ratio**2
    if not np.isinf(whole).any():  # a fixed station takes the inertia of its shafts
        assert data.total == pytest.approx(whole.sum(), rel=1e-12)


LAWS = (
    every_row_of_a_holzer_table_follows_from_the_row_before_it,
    inertias_refer_with_the_square_of_the_ratio_and_add_up,
)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("scene", SHAFTED)
@for_all("law", LAWS)
def test_tables_of_every_model_of_a_shaft_follow_from_their_digits(
    law: Callable[..., None], scene: str, model: str
) -> None:
    law(scene, model)
