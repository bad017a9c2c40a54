"""How a figure of the file varies: by a law about its value, over a range, through a list or a catalogue."""

import re
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema

from torsion import fields, units
from torsion.arrays import BoolArray, FloatArray
from torsion.fields import Declared, exclusive, given, needs, refuse, shown, together

MOST_STEPS = 10_000_000
WAYS = ("values", "first", "catalogue")  # of a figure to vary in place of the file's value
ONE_WAY = "a list, a range from `from` to `to`, or a catalogue"
# As the file writes it.
Amount = Annotated[Any, BeforeValidator(lambda value: value, float | str)]


def _without_sign(value: Any) -> Any:
    """ "+-15 %" and "± 15 %" as "15 %"."""
    return re.sub(r"^\s*(\+-|\+/-|±)\s*", "", value) if isinstance(value, str) else value


def _share(example: str) -> WithJsonSchema:
    """The schema of a share as a number or as text."""
    text = {"type": "string", "description": f"a share, {example}"}
    return WithJsonSchema({"anyOf": [{"type": "number"}, text]})


Width = Annotated[
    float,
    fields.Quantity("1", above=0, below=1, usual="deviation of a law"),
    BeforeValidator(_without_sign),
    _share("+-15 % or 15 %"),
]
Share = Annotated[
    float,
    fields.Quantity("1", above=0, usual="share of a value"),
    BeforeValidator(_without_sign),
    _share("70 %"),
]


def _amount(value: Any, key: str) -> tuple[Fraction, str]:
    """A number and its unit as the file writes them; empty for a bare number."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise refuse(f"{shown(value)} is not a number with a unit", "such as 55 mm", key)
    try:
        return units.amount(value) if isinstance(value, str) else (Fraction(repr(value)), "")
    except (ValueError, OverflowError) as fault:
        raise refuse(str(fault), "a number with its unit, such as 55 mm", key) from None


class Choice(Declared):
    """Values of one figure in place of that of the file: a list, a range, or the rows of a catalogue."""

    laws: ClassVar[tuple[str, ...]] = ()  # keys of laws about the value of the file
    clashes = (
        *together("first", "last"),
        exclusive(*WAYS, hint=ONE_WAY, needed=True),
        exclusive("steps", "step"),
        *(needs(key, "first", hint="it is of a range") for key in ("steps", "step")),
    )

    values: Annotated[tuple[Any, ...], Field(min_length=2)] | None = given(
        "alternatives, each written as the file would: [56 mm, 60 mm, 65 mm]"
    )
    first: Amount | None = given("minimum of a range, with its unit", alias="from")
    last: Amount | None = given("maximum, in the same unit", alias="to")
    steps: Annotated[int, Field(ge=2, le=MOST_STEPS)] | None = given(
        "how many values from one end to the other"
    )
    step: Amount | None = given("distance of the values, in the same unit, in place of `steps`")
    catalogue: str | None = given(
        "CSV file whose rows are alternatives of the component; a column a key, with `name`"
    )

    def refuse_clashes(self) -> None:
        """Values each once, and a range in one unit."""
        values = self.values or ()
        for position, value in enumerate(values):
            if value in values[:position]:
                message = f"the value {shown(value)} is listed twice"
                raise refuse(message, "each value once", ("values", position))
        if self.first is None:
            return
        (low, unit), (high, unit_of_last) = _amount(self.first, "from"), _amount(self.last, "to")
        first, last, step = shown(self.first), shown(self.last), shown(self.step)
        if unit != unit_of_last:
            raise refuse(f"{first} and {last} are in different units", "one unit", "to")
        if low >= high:
            raise refuse(f"`from` {first} is not below `to` {last}", "exchange them", "from")
        if self.step is not None:
            distance, unit_of_step = _amount(self.step, "step")
            fits = 0 < distance <= high - low <= MOST_STEPS * distance
            if unit_of_step != unit or not fits:
                hint = f"in {unit or 'the same unit'}, above 0 and at most the range"
                raise refuse(f"`step` {step} does not divide the range", hint, "step")

    @property
    def is_relative(self) -> bool:
        """A law about the value of the file."""
        return any(getattr(self, law) is not None for law in self.laws)

    @property
    def unit(self) -> str:
        """In which a range is written; empty where it is in SI, or none."""
        return "" if self.first is None else _amount(self.first, "from")[1]

    @property
    def ends(self) -> tuple[float, float]:
        """Of a range, in its unit."""
        return float(_amount(self.first, "from")[0]), float(_amount(self.last, "to")[0])

    @property
    def places(self) -> int | None:
        """How many values a range has; None where every value within it is meant."""
        if self.step is not None:
            (low, high), step = self.ends, float(_amount(self.step, "step")[0])
            return int((high - low) / step * (1.0 + 1e-12)) + 1
        return self.steps

    @property
    def words(self) -> str:
        """How the figure varies, in the words of the report."""
        if self.values is not None:
            return f"one of {len(self.values)} values"
        if self.catalogue is not None:
            return f"a row of {self.catalogue}"
        places = self.places
        return f"{self.first} to {self.last}" + (f", {places} values" if places else "")


class Law(Choice):
    """How one figure varies: one of four laws relative to the value of the file, or values in place of it."""

    laws: ClassVar = ("uniform", "normal", "lognormal", "triangular")
    clashes = (
        *(clash for clash in Choice.clashes if clash.rule != "one"),
        exclusive(*laws, *WAYS, hint=f"a law, {ONE_WAY}", needed=True),
        needs("within", "normal", hint="{normal: 5 %, within: 15 %}"),
    )

    uniform: Width | None = given("any value within this of the file's is as likely: +-15 %")
    normal: Width | None = given("standard deviation, the mean being the file's value: 5 %")
    lognormal: Width | None = given(
        "standard deviation of the logarithm, the median being the file's value"
    )
    triangular: Annotated[tuple[Share, ...], fields.OneOrMany] | None = given(
        "half width: most likely at the file's value, zero at this distance. Or minimum, mode and maximum relative "
        "to the file's value: [70 %, 80 %, 100 %]"
    )
    within: Width | None = given(
        "for `normal`: largest distance from the file's value (default: 3 deviations)"
    )

    def refuse_clashes(self) -> None:
        """A triangle that rises, and `within` beyond the deviation of a normal law."""
        super().refuse_clashes()
        if self.triangular is not None and len(self.triangular) not in (1, 3):
            message = f"{len(self.triangular)} shares are no triangle"
            raise refuse(message, "one, or three: [70 %, 80 %, 100 %]", "triangular")
        low, middle, high = self.corners
        if not low > 0.0:
            message = "the share of a symmetric triangle is below 100 %"
            raise refuse(message, "such as +-15 %", "triangular")
        if not low <= middle <= high or low == high:
            hint = "minimum, mode and maximum relative to the file's value: [70 %, 80 %, 100 %]"
            raise refuse(f"{low:g}, {middle:g} and {high:g} do not rise", hint, "triangular")
        if self.normal is not None and self.within is not None and self.within <= self.normal:
            message = "`within` cuts a normal law at more than its deviation"
            raise refuse(message, "{normal: 5 %, within: 15 %}", "within")
        if self.normal is not None and self.within is None and 3.0 * self.normal >= 1.0:
            message = "three deviations take the figure to 0"
            raise refuse(message, "`within: 90 %`, or lognormal", "normal")

    @property
    def corners(self) -> tuple[float, float, float]:
        """Of a triangular law: least, likeliest and greatest over the file's value."""
        shares = self.triangular or (0.5,)
        return shares if len(shares) == 3 else (1.0 - shares[0], 1.0, 1.0 + shares[0])

    @property
    def words(self) -> str:
        """How the figure varies, in the words of the report."""
        if not self.is_relative:
            return super().words
        if self.triangular is not None and len(self.triangular) == 3:
            low, middle, high = (f"{100.0 * share:.6g} %" for share in self.triangular)
            return f"triangular {low} to {high}, likeliest {middle}"
        name = next(law for law in self.laws if getattr(self, law) is not None)
        width = self.triangular[0] if self.triangular is not None else getattr(self, name)
        words = f"{name} {'±' if name in ('uniform', 'triangular') else ''}{100.0 * width:.6g} %"
        return words + ("" if self.within is None else f" within ±{100.0 * self.within:.6g} %")


SCRAMBLES = 8  # of Sobol's sequence, whose spread is the error of their mean
LEVEL = 0.95
FEW = 10  # failing, or keeping: with fewer the spread of sequences covers 89 % of counts of Poisson (measured)


@lru_cache(maxsize=2)
def uniform_samples(count: int, figures: int, method: str, seed: int) -> FloatArray:
    """(count, figures) evenly distributed within 0 and 1; of sobol the scrambled sequences one after another."""
    if method == "random":
        return np.random.default_rng(seed).random((count, figures))
    from scipy.stats import qmc

    if method == "latin":
        return qmc.LatinHypercube(figures, rng=seed).random(count)
    return np.concatenate(
        [
            qmc.Sobol(figures, rng=np.random.default_rng([seed, k])).random(count // SCRAMBLES)
            for k in range(SCRAMBLES)
        ]
    )


def drawn(figures: Sequence[Any], unit: FloatArray) -> FloatArray:
    """Values (count, figures) of figures at samples (count, columns) evenly distributed within 0 and 1."""
    return np.stack([figure.at(unit[:, figure.column]) for figure in figures], axis=1)


def factors(law: Law, unit: FloatArray) -> FloatArray:
    """The figure over that of the file, by the inverse of the law's distribution at `unit` (0 to 1)."""
    from scipy.special import ndtr, ndtri

    if law.uniform is not None:
        return 1.0 + law.uniform * (2.0 * unit - 1.0)
    if law.triangular is not None:
        low, middle, high = law.corners
        wide = high - low
        rising = low + np.sqrt(unit * wide * (middle - low))
        falling = high - np.sqrt((1.0 - unit) * wide * (high - middle))
        return np.where(unit * wide < middle - low, rising, falling)
    if law.normal is not None:
        cut = ndtr(-(3.0 if law.within is None else law.within / law.normal))
        return 1.0 + law.normal * ndtri(cut + unit * (1.0 - 2.0 * cut))
    inside = np.clip(unit, 1e-15, 1.0 - 1e-15)
    return np.exp((law.lognormal or 0.0) * ndtri(inside))


def probability(happens: BoolArray, method: str) -> tuple[float, float, float]:
    """Share of the samples (count,) in which something happens, and the ends of its 95 % interval.

    Of sobol by Student's t over its sequences, else by Wilson, and so where fewer than ten samples, or all but as few,
    say so: a probability is never 0 or 1 with certainty.

    >>> [round(end, 4) for end in probability(np.arange(100) < 5, "random")]
    [0.05, 0.0215, 0.1118]
    """
    from scipy.special import ndtri, stdtrit

    count, size, share = int(happens.sum()), happens.size, float(happens.mean())
    if method == "sobol" and FEW <= count <= size - FEW:
        shares = happens.reshape(SCRAMBLES, -1).mean(axis=1)
        half = float(
            stdtrit(SCRAMBLES - 1, 0.5 + LEVEL / 2.0) * shares.std(ddof=1) / np.sqrt(SCRAMBLES)
        )
        if half > 0.0:
            return share, max(share - half, 0.0), min(share + half, 1.0)
    z = float(ndtri(0.5 + LEVEL / 2.0))
    extra = z * z / size
    middle = (share + extra / 2.0) / (1.0 + extra)
    half = z / (1.0 + extra) * float(np.sqrt(share * (1.0 - share) / size + extra / size / 4.0))
    low, high = middle - half, middle + half
    return share, low if count else 0.0, high if count < size else 1.0
