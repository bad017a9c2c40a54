"""What a sweep finds."""

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.results import reported, result

ROUNDING = 1e-9  # relative: a share this near to the permissible one is at it


@reported
class VariedFigure:
    """A figure of the file that varies."""

    name: str = result("component and key")
    law: str = result("how it varies about the value of the file")
    together: int = result("figures with the same number vary as one")
    # Of values in place of the file's, of lists the row; None of a law about the file's.
    unit: str | None = None


@reported
class SweptCheck:
    """One check of one component over all variants."""

    rule: str = result("name of the rule")
    clause: str = result("its clause")
    where: str = result("component")
    what: str = result("what was compared")
    failing: int = result("variants that exceed the limit, are not judged, or failed")
    probability: float = result("1", "share of the variants that fail")
    lower: float | None = result(
        "1", "lower end of its 95 % interval; null for a grid, which is not a sample"
    )
    upper: float | None = result("1", "upper end")
    median: float | None = result("1", "median utilisation; null if unknown")
    best: float | None = result("1", "minimum utilisation")
    worst: float | None = result("1", "maximum utilisation")
    decides: str = result(
        "parameter that correlates most with the utilisation (by rank); empty without a correlation",
    )
    correlation: float | None = result(
        "1", "rank correlation with that parameter, -1 to 1; null if unknown"
    )
    utilisation: FloatArray  # (variants,), NaN where unknown
    fails: BoolArray  # (variants,)


@reported
class GridAxis:
    """Figures that take their values one after another, as one where they vary together."""

    figures: tuple[str, ...] = result("their names")
    words: tuple[str, ...] = result("", "value", "the values as the file would state them")
    number: FloatArray = result(
        "", "value", "of the first parameter, in `unit`; null without such numbers"
    )
    unit: str = result("of the numbers")
    in_file: float | None = result("value of the file in that unit; null without a value in it")

    @property
    def is_numeric(self) -> bool:
        """Its values are numbers of one unit, one after another."""
        return bool(np.all(np.diff(self.number) > 0.0))

    @property
    def name(self) -> str:
        """Names of its figures, with commas between."""
        return ", ".join(self.figures)


@reported
class Turn:
    """Where, along the one figure of a curve, a check begins or ceases to fail."""

    check: int = result("its place among the checks, from 0")
    kept: float = result("value that meets the limit, in the unit of the parameter")
    failing: float = result("the neighbouring value that exceeds the limit")
    between: float | None = result(
        "where the limit is reached, the share of it being taken as linear between both; null if unknown",
    )


@reported
class Grid:
    """All combinations of the values of some figures; of variants the last figure changes first."""

    axes: tuple[GridAxis, ...] = result("the figures")
    frequency: FloatArray = result(
        "Hz", ("mode", "variant"), "natural frequencies; null if unknown"
    )
    utilisation: FloatArray = result(
        "1", ("check", "variant"), "utilisation, of the checks of the sweep"
    )
    greatest: FloatArray = result(
        "1", "variant", "maximum utilisation of all checks; null if unknown"
    )
    decisive: IntArray = result("", "variant", "the check with the maximum, from 0; -1 if unknown")
    fails: BoolArray = result("", "variant", "a check fails, or the variant failed")
    turns: tuple[Turn, ...] = result("of a curve, where checks begin or cease to fail")
    why: tuple[tuple[int, str], ...] = ()  # variant without an answer, and its fault

    @property
    def shape(self) -> tuple[int, ...]:
        """How many values each axis has."""
        return tuple(len(axis.words) for axis in self.axes)

    def words(self, variant: int) -> tuple[str, ...]:
        """The values of a variant, an axis each."""
        return tuple(
            axis.words[int(position)]
            for axis, position in zip(self.axes, np.unravel_index(variant, self.shape), strict=True)
        )


@reported
class SobolIndex:
    """The share of the spread of one answer that is due to one figure (Sobol 1993)."""

    of: str = result("mode, or check and component")
    figure: str = result("figure, or those that vary as one with it")
    first: float = result("1", "share of the variance due to only this parameter")
    first_error: float = result("1", "half of its 95 % interval")
    total: float = result("1", "share of the variance that would go if the figure were known")
    total_error: float = result("1", "half of its 95 % interval")


@reported
class Sweep:
    """Frequencies and verdicts where figures of the file vary."""

    figures: tuple[VariedFigure, ...] = result("figures that vary")
    samples: int = result("number of variants")
    method: str = result("how they are made: sobol, latin, random or grid")
    seed: int = result("of the samples")
    unsolved: int = result("variants that failed; each counts as a failed check")
    faults: tuple[str, ...] = result("why, each cause once")
    nominal: FloatArray = result("Hz", "mode", "natural frequencies of the nominal case")
    mean: FloatArray = result("Hz", "mode", "mean natural frequency")
    deviation: FloatArray = result("Hz", "mode", "standard deviation")
    low: FloatArray = result("Hz", "mode", "2.5 % of the variants lie below")
    high: FloatArray = result("Hz", "mode", "2.5 % of the variants lie above")
    least: FloatArray = result("Hz", "mode", "least frequency of any variant")
    greatest: FloatArray = result("Hz", "mode", "greatest frequency of any variant")
    checks: tuple[SweptCheck, ...] = result("every check, the likeliest to fail first")
    any_fails: SweptCheck | None = result("at least one check fails; null if nothing is judged")
    indices: tuple[SobolIndex, ...] = result("Sobol's indices, if requested")
    grid: Grid | None = result(
        "of a grid what every variant answers; null of samples and of large grids"
    )
    factor: FloatArray  # (variants, figures) over the figure of the file; of ranges the value, of lists the row
    frequency: FloatArray  # (modes, variants) Hz, NaN where unknown
    fail_at_most: float | None = result(
        "1",
        "share of the variants that may fail a check; null without `permitted`",
        default=None,
    )

    @property
    def share_failing(self) -> float:
        """Share of the variants that fail a check or have no answer; 0 where none is judged."""
        return 0.0 if self.any_fails is None else self.any_fails.probability

    @property
    def fails(self) -> bool:
        """More variants fail than the file permits."""
        return self.fail_at_most is not None and self.share_failing > self.fail_at_most * (
            1.0 + ROUNDING
        )

    @property
    def is_partial(self) -> bool:
        """Variants fail, and the file says nothing of how many may."""
        return self.fail_at_most is None and self.share_failing > 0.0
