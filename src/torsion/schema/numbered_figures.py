"""Lists and catalogues that vary, as the numbers that their rows state: rows with the same keys are one group."""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.errors import Path
from torsion.schema.overlay import in_words
from torsion.schema.varied_figure import Figure, amount_of
from torsion.what_if.variants.laws import Choice

WORDS = "source", "note"  # keys that no result depends on


@dataclass(frozen=True)
class Numbered:
    """One figure with rows: of each row the kind, and its numbers."""

    figure: Figure

    @cached_property
    def _stated(self) -> list[tuple[Hashable, Mapping[tuple[Path, str], float]]]:
        """Of every row what is no number, with where numbers stand; and these."""
        found = list[tuple[Hashable, Mapping[tuple[Path, str], float]]]()
        for row in self.figure.rows:
            numbers, other = dict[tuple[Path, str], float](), list[Hashable]()
            for path, node in row.puts:
                amount = amount_of(node.value)
                if amount is not None and amount[0] > 0.0:
                    numbers[path, amount[1]] = amount[0]
                    other.append((path, amount[1]))
                elif path[-1] not in WORDS:
                    other.append((path, in_words(node.value), str(node.value)))
            found.append((tuple(other), numbers))
        return found

    @cached_property
    def kinds(self) -> IntArray:
        """(rows,) rows of one number differ in their numbers alone."""
        known: dict[Hashable, int] = {}
        return np.array([known.setdefault(kind, len(known)) for kind, _ in self._stated])

    @cached_property
    def _known(self) -> dict[int, tuple[list[Figure], FloatArray]]:
        return {}

    def numbers(self, kind: int) -> tuple[list[Figure], FloatArray]:
        """The figures of a kind, those that are not the same in all its rows; and (rows, figures) their values."""
        if kind not in self._known:
            self._known[kind] = self._numbers(np.flatnonzero(self.kinds == kind))
        return self._known[kind]

    def _numbers(self, of_kind: IntArray) -> tuple[list[Figure], FloatArray]:
        keys = list(self._stated[of_kind[0]][1])
        values = np.array(
            [[one.get(key, np.nan) for key in keys] for _, one in self._stated]
        ).reshape(len(self.kinds), len(keys))
        low, high = (
            values[of_kind].min(axis=0, initial=np.inf),
            values[of_kind].max(axis=0, initial=0.0),
        )
        varied = np.flatnonzero(high > low)
        return [self._figure(keys[k], low[k], high[k]) for k in varied.tolist()], values[:, varied]

    def _figure(self, key: tuple[Path, str], low: float, high: float) -> Figure:
        path, unit = key
        law = Choice.model_validate(
            {"from": f"{float(low)!r} {unit}".strip(), "to": f"{float(high)!r} {unit}".strip()}
        )
        own = [one for one, _ in self.figure.paths]
        name = self.figure.name if own else ".".join([self.figure.name, str(path[-1])])
        return Figure(
            name, law, ((path, 1),), 0, float(low), layer=self.figure.layer - 1
        )  # as the rows: before laws
