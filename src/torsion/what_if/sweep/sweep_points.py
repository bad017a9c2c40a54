"""Which variants a sweep has: samples of laws, all combinations of lists, or the sets of samples of Sobol's indices."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.study import Study
from torsion.what_if.sweep.sweep_settings import Method, SweepSettings
from torsion.what_if.variants.sampling import drawn, units


@dataclass(frozen=True)
class Points:
    """The variants that a sweep has of the figures that vary."""

    figures: Sequence[Any]  # torsion.schema.variation.Figure
    method: Method
    seed: int
    samples: int  # of each set; of a grid all combinations
    sets: int = 1  # of samples: of indices two, and one more for every figure

    @classmethod
    def from_settings(
        cls, study: Study, settings: SweepSettings, figures: Sequence[Any]
    ) -> "Points":
        """Return the variants that the settings of a file state."""
        method, columns = settings.drawn(figures), 1 + max(figure.column for figure in figures)
        shape = {figure.column: figure.places for figure in figures}
        count = math.prod(shape.values()) if method == "grid" else settings.samples_of(study)
        return cls(figures, method, settings.seed, count, columns + 2 if settings.indices else 1)

    @property
    def shape(self) -> tuple[int, ...]:
        """Of a grid, how many values each of its axes has."""
        return tuple(
            places
            for _, places in sorted(
                {figure.column: figure.places for figure in self.figures}.items()
            )
        )

    @property
    def words(self) -> str:
        """Number of variants, method and number of figures, for the plan."""
        sets = f", {self.samples:,} of each of {self.sets} sets" if self.sets > 1 else ""
        return f"{self.count:,} variants ({self.method}{sets}) of {len(self.figures)} figures"

    @property
    def count(self) -> int:
        """Number of variants of all sets of samples."""
        return self.samples * self.sets

    def values(self, part: slice) -> FloatArray:
        """(variants, figures); of a grid the last figure changes first.

        Of indices the sets A and B, and A with one column of B after another (Saltelli et al. 2010).
        """
        if self.method == "grid":
            positions = np.unravel_index(
                np.arange(part.start, min(part.stop, self.count)), self.shape
            )
            return np.stack(
                [figure.all_values()[positions[figure.column]] for figure in self.figures], axis=1
            )
        columns = len(self.shape)
        if self.sets == 1:
            unit = units(self.samples, columns, self.method, self.seed)[part]
        else:
            unit = units(self.samples, 2 * columns, self.method, self.seed)
            first, second = unit[:, :columns], unit[:, columns:]
            mixed = [
                np.where(np.arange(columns) == column, second, first) for column in range(columns)
            ]
            unit = np.concatenate([first, second, *mixed])[part]
        return drawn(self.figures, unit)
