"""A figure of a file that varies: its law, where it stands, and what the file says at a value of it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion import units
from torsion.arrays import FloatArray
from torsion.errors import Path
from torsion.schema.fault_text import Node, Source
from torsion.schema.overlay import multiplied, node_at
from torsion.what_if.variants.laws import Choice, Law
from torsion.what_if.variants.sampling import factors

ENDS = np.array([1e-4, 1.0 - 1e-4])  # of a law without ends, where the file is read as a trial


@dataclass(frozen=True)
class Row:
    """One alternative of a list or a catalogue."""

    label: str
    puts: tuple[tuple[Path, Node], ...]
    amounts: Mapping[str, float]  # what else it states, such as mass and cost


@dataclass(frozen=True)
class Figure:
    """One figure that varies.

    A value of it is, of a law, the factor of what the file gives; of a range, a number in its unit; of a list or a
    catalogue, the number of the row, from 0.
    """

    name: str  # as the file names it
    law: Choice
    paths: tuple[
        tuple[Path, int], ...
    ]  # of its values, and the power of the factor that each takes
    column: int  # of the samples; figures that vary together share one
    nominal: float  # its value in the file as it stands; NaN where the file's is none of the alternatives
    rows: tuple[Row, ...] = ()
    key: str = ""  # of the settings that names it; empty where its tolerance does
    layer: int = 0  # figures of a higher one are about what those of a lower one put in the file

    @property
    def stage(self) -> tuple[int, bool]:
        """When it is put in the file: in a layer rows of lists before all else, as laws are about what those state."""
        return self.layer, not self.rows

    def at(self, unit: FloatArray) -> FloatArray:
        """The values at samples (count,) evenly distributed within 0 and 1."""
        if isinstance(self.law, Law) and self.law.is_relative:
            return factors(self.law, unit)
        if not self.places:
            low, high = self.law.ends
            return np.asarray(low + unit * (high - low))
        return self.all_values()[np.minimum((unit * self.places).astype(np.intp), self.places - 1)]

    @property
    def all_paths(self) -> tuple[Path, ...]:
        """Every place of the file that a value of it may change."""
        return tuple(
            path for path, _ in (*self.paths, *(put for row in self.rows for put in row.puts))
        )

    @property
    def places(self) -> int:
        """How many values it takes; 0 where any within its range, or by its law."""
        return len(self.rows) or (0 if self.law.first is None else self.law.places or 0)

    def all_values(self) -> FloatArray:
        """Return all values of a list, a catalogue or a range in steps."""
        if self.rows:
            return np.arange(float(len(self.rows)))
        (low, high), step = self.law.ends, self.law.step
        if step is not None:
            high = low + float(units.amount(str(step))[0]) * (self.places - 1)
        return np.linspace(low, high, self.places)

    @property
    def ends(self) -> FloatArray:
        """Its lowest and its highest value."""
        is_endless = isinstance(self.law, Law) and self.law.lognormal is not None
        return self.at(ENDS if is_endless else np.array([0.0, 1.0]))

    @property
    def numbers(self) -> tuple[FloatArray, str]:
        """Its values as numbers, and their unit; NaN where they are no numbers of one unit."""
        if not self.rows:
            return self.all_values(), self.law.unit
        stated = [
            amount_of(row.puts[0][1].value) if len(row.puts) == 1 else None for row in self.rows
        ]
        units_of = {amount[1] for amount in stated if amount is not None}
        if None in stated or len(units_of) != 1:
            return np.full(len(self.rows), np.nan), ""
        return np.array([amount[0] for amount in stated if amount is not None]), units_of.pop()

    @property
    def in_file(self) -> float:
        """What the file gives, in the unit of its numbers; NaN where that is not known."""
        if not self.rows:
            return self.nominal
        return float(self.numbers[0][int(self.nominal)]) if self.nominal == self.nominal else np.nan

    def words(self, value: float) -> str:
        """A value of it as the file would state it."""
        if self.rows:
            return self.rows[int(value)].label
        return (
            f"{value:.6g} {self.law.unit}".strip()
            if self.law.first is not None
            else f"times {value:.6g}"
        )

    def puts(self, value: float, source: Source) -> Iterator[tuple[Path, Node]]:
        """What stands in the file with a value of it."""
        if self.rows:
            yield from self.rows[int(value)].puts
            return
        exact = Fraction(repr(float(value)))
        for path, power in self.paths:
            given = node_at(source.root, path) or Node(None, 1, 1)
            if self.law.first is not None:
                new: object = (
                    f"{repr(value).removesuffix('.0')} {self.law.unit}" if self.law.unit else value
                )
                if new == value and value.is_integer():  # of teeth, say
                    new = int(value)
            else:
                new = multiplied(given.value, exact if power > 0 else 1 / exact)
            yield path, Node(new, given.line, given.column)


def amount_of(value: object) -> tuple[float, str] | None:
    """A number of the file and its unit; None of anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        amount, unit = units.amount(value) if isinstance(value, str) else (value, "")
    except units.UnitFault:
        return None
    return float(amount), unit
