"""What the file says of a sweep: which figures vary, by which law, how many samples."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from torsion.arrays import FloatArray
from torsion.errors import Fault
from torsion.fields import Declared, Quantity, given, refuse
from torsion.study import Study
from torsion.what_if.variants.laws import Choice, Law, drawn, uniform_samples

FEWEST, MOST = 128, 1 << 22
MOST_COMBINATIONS = 10_000_000
# Samples where nothing else is said: judged, and of frequencies alone.
CHECKED, UNJUDGED = 512, 16384
Method = Literal["sobol", "latin", "random", "grid"]
Result = Literal["modes", "checks"]


class SweepSettings(Declared):
    """What the file states of `sweep`: figures that vary, samples and results."""

    # The word `tolerances` is the default.
    vary: Annotated[
        dict[str, Law], BeforeValidator(lambda value: {} if value == "tolerances" else value)
    ] = given(
        "figures by `component.key` and how they vary (default: uniformly within every tolerance of the file)",
        {},
    )
    together: tuple[Annotated[tuple[str, ...], Field(min_length=2)], ...] = given(
        "figures that vary as one, such as two couplings of one batch", ()
    )
    samples: Annotated[int, Field(ge=FEWEST, le=MOST)] | None = given(
        f"number of variants (default: {CHECKED} with checks, 16384 with only frequencies)"
    )
    method: Method | None = given(
        "sobol: eight scrambled sequences, a power of two of samples; latin hypercube; random; or grid, all "
        "combinations of lists and steps. Default: grid if every parameter has a list or steps and `samples` is "
        "missing, else sobol"
    )
    seed: Annotated[int, Field(ge=0)] = given(
        "of the samples; the same seed gives the same variants", 1
    )
    indices: bool = given(
        "with the share of the spread of every frequency and limit that each figure has (Sobol's indices), which takes "
        "as many variants again for every figure and twice more",
        False,
    )
    fail_at_most: (
        Annotated[float, Quantity("1", at_least=0, at_most=1, usual="tolerance")] | None
    ) = given(
        "share of the variants that may fail a check, for example 1 %; more is FAIL (default: any variant that fails "
        "restricts the verdict and makes the exit status 1)"
    )
    results: tuple[Result, ...] = given(
        "results of each variant (default: checks if the file has rules)", ()
    )

    def refuse_clashes(self) -> None:
        """Sobol's samples are a power of two, and a grid has none."""
        count = self.samples
        if count is not None and self.method == "grid":
            message = "a grid has all combinations and no samples"
            raise refuse(message, "leave `samples` out", "samples")
        if count is not None and self.method in (None, "sobol") and count & (count - 1):
            above = 1 << count.bit_length()
            message = f"{count} samples are not a power of two, which sobol needs"
            raise refuse(message, f"{above // 2} or {above}, or `method: random`", "samples")
        if self.indices and self.method not in (None, "sobol"):
            message = f"indices are of sobol's samples, and the method is {self.method}"
            raise refuse(message, "`method: sobol`", "indices")

    def judges(self, study: Study) -> bool:
        """Every variant is judged by the rules of the file."""
        return "checks" in self.results or (not self.results and bool(study.rules))

    def refused(self, study: Study, figures: Sequence[Any]) -> Iterator[Fault]:
        """A grid of what has no steps or too many, checks without rules, and more variants than there can be."""
        if self.fail_at_most is not None and not self.judges(study):
            hint = "name `rules`" if not study.rules else "`results: [checks]`"
            yield Fault(("fail_at_most",), "no variant can fail, as none is checked", hint)
        if "checks" in self.results and not study.rules:
            message = "no variant can be checked, because the file has no rules"
            yield Fault(("results",), message, "name `rules`")
        points = Points.from_settings(study, self, figures)
        if points.method != "grid":
            if self.indices and points.count > MOST:
                hint = f"`samples` of at most {1 << (MOST // points.sets).bit_length() - 1}"
                message = f"the indices of {len(points.shape)} figures take too many variants"
                yield Fault(("indices",), message, hint)
            return
        for figure in figures:
            if not figure.places:
                words = f"{figure.name} varies as {figure.law.words}"
                hint = "give it `values` or `steps`, or leave `method` out: all are drawn"
                yield Fault(("method",), f"{words}, and a grid takes lists and steps", hint)
        if points.samples > MOST_COMBINATIONS:
            largest = f"the {MOST_COMBINATIONS:,} of the largest grid"
            hint = "fewer steps, or `method: sobol`, which draws from them"
            message = f"{points.samples:,} combinations are more than {largest}"
            yield Fault(("vary",), message, hint, at_key=True)

    @property
    def varied(self) -> tuple[str, Mapping[str, Choice]]:
        """The key that names the figures, and how each varies."""
        return "vary", self.vary


@dataclass(frozen=True)
class Points:
    """The variants that a sweep has of the figures that vary."""

    figures: Sequence[Any]  # torsion.schema.variants.variation.Figure
    method: Method
    seed: int
    samples: int  # of each set; of a grid all combinations
    sets: int = 1  # of samples: of indices two, and one more for every figure

    @classmethod
    def from_settings(
        cls, study: Study, settings: SweepSettings, figures: Sequence[Any]
    ) -> "Points":
        """Return the variants that the settings of a file state."""
        shape = {figure.column: figure.places for figure in figures}
        count, by_default = settings.samples, settings.samples is None and not settings.indices
        is_grid = by_default and all(figure.places for figure in figures)
        method: Method = settings.method or ("grid" if is_grid else "sobol")
        if method == "grid":
            count = math.prod(shape.values())
        elif count is None:
            count = CHECKED if settings.judges(study) else UNJUDGED
        return cls(figures, method, settings.seed, count, len(shape) + 2 if settings.indices else 1)

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
            unit = uniform_samples(self.samples, columns, self.method, self.seed)[part]
        else:
            unit = uniform_samples(self.samples, 2 * columns, self.method, self.seed)
            first, second = unit[:, :columns], unit[:, columns:]
            mixed = [
                np.where(np.arange(columns) == column, second, first) for column in range(columns)
            ]
            unit = np.concatenate([first, second, *mixed])[part]
        return drawn(self.figures, unit)
