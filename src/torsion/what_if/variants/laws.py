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
from torsion.fields import Declared, given, refuse, shown

MOST_STEPS = 10_000_000
Amount = Annotated[Any, WithJsonSchema({"type": ["number", "string"]})]


def _without_sign(value: Any) -> Any:
    """ "+-15 %" and "± 15 %" as "15 %"."""
    return re.sub(r"^\s*(\+-|\+/-|±)\s*", "", value) if isinstance(value, str) else value


Width = Annotated[
    float,
    fields.Quantity("1", above=0, below=1, usual="deviation of a law"),
    BeforeValidator(_without_sign),
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "number"},
                {"type": "string", "description": "a share, +-15 % or 15 %"},
            ]
        }
    ),
]
Share = Annotated[
    float,
    fields.Quantity("1", above=0, usual="share of a value"),
    BeforeValidator(_without_sign),
    WithJsonSchema(
        {"anyOf": [{"type": "number"}, {"type": "string", "description": "a share, 70 %"}]}
    ),
]


def _amount(value: Any, key: str) -> tuple[Fraction, str]:
    """A number and its unit as the file writes them; empty for a bare number."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise refuse(f"{shown(value)} is not a number with a unit", "such as 55 mm", key)
    try:
        return units.amount(value) if isinstance(value, str) else (Fraction(repr(value)), "")
    except (units.UnitFault, ValueError, OverflowError) as fault:
        raise refuse(str(fault), "a number with its unit, such as 55 mm", key) from None


class Choice(Declared):
    """Values of one figure in place of that of the file: a list, a range, or the rows of a catalogue."""

    laws: ClassVar[tuple[str, ...]] = ()  # keys of laws about the value of the file

    values: tuple[Any, ...] | None = given(
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
        """One way, and a range with both ends in one unit."""
        ends = [key for key, end in (("from", self.first), ("to", self.last)) if end is not None]
        listed = (*self.laws, "values", "catalogue")
        ways = [key for key in listed if getattr(self, key) is not None] + ends[:1]
        if len(ways) != 1:
            message = f"{' and '.join(ways)} exclude each other"
            known = ", ".join((*self.laws, "values", "from and to", "catalogue"))
            raise refuse(
                message if ways else "nothing says how the figure varies",
                f"one of {known}",
                key=ways[-1] if ways else "",
            )
        if self.values is not None and len(self.values) < 2:
            raise refuse("a list of values needs two at least", "give alternatives", "values")
        for position, value in enumerate(self.values or ()):
            if value in (self.values or ())[:position]:
                raise refuse(
                    f"the value {shown(value)} is listed twice",
                    "each value once",
                    ("values", position),
                )
        if ways[0] != "from":
            extra = next((key for key in ("steps", "step") if getattr(self, key) is not None), None)
            if extra is not None:
                raise refuse(f"`{extra}` is of a range, `from` and `to`", "leave it out", extra)
            return
        if self.first is None or self.last is None:
            missing, present = ("from", "to") if self.first is None else ("to", "from")
            raise refuse(
                f"a range without `{missing}`", f"give both `{present}` and `{missing}`", present
            )
        first, last = (
            _amount(value, key) for value, key in ((self.first, "from"), (self.last, "to"))
        )
        if first[1] != last[1]:
            raise refuse(
                f"{shown(self.first)} and {shown(self.last)} are in different units",
                "one unit",
                "to",
            )
        if first[0] >= last[0]:
            raise refuse(
                f"`from` {shown(self.first)} is not below `to` {shown(self.last)}",
                "exchange them",
                "from",
            )
        if self.step is not None:
            step = _amount(self.step, "step")
            if self.steps is not None:
                raise refuse("`steps` and `step` exclude each other", "leave one out", "step")
            if (
                step[1] != first[1]
                or not 0 < step[0] <= last[0] - first[0]
                or (last[0] - first[0]) / step[0] > MOST_STEPS
            ):
                hint = f"in {first[1] or 'the same unit'}, above 0 and at most the range"
                raise refuse(f"`step` {shown(self.step)} does not divide the range", hint, "step")

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
    def width(self) -> float:
        """From one end to the other."""
        low, high = self.ends
        return high - low

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
        """One way alone, and `within` with a normal law."""
        super().refuse_clashes()
        if self.triangular is not None and len(self.triangular) not in (1, 3):
            raise refuse(
                f"{len(self.triangular)} shares are no triangle",
                "one, or three: [70 %, 80 %, 100 %]",
                "triangular",
            )
        low, middle, high = self.corners
        if not low > 0.0:
            raise refuse(
                "the share of a symmetric triangle is below 100 %", "such as +-15 %", "triangular"
            )
        if not low <= middle <= high or low == high:
            hint = "minimum, mode and maximum relative to the file's value: [70 %, 80 %, 100 %]"
            raise refuse(f"{low:g}, {middle:g} and {high:g} do not rise", hint, "triangular")
        if self.within is not None and (self.normal is None or self.within <= self.normal):
            raise refuse(
                "`within` cuts a normal law at more than its deviation",
                "{normal: 5 %, within: 15 %}",
                "within",
            )
        if self.normal is not None and self.within is None and 3.0 * self.normal >= 1.0:
            raise refuse(
                "three deviations take the figure to 0", "`within: 90 %`, or lognormal", "normal"
            )

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
        return np.where(
            unit * wide < middle - low,
            rising,
            high - np.sqrt((1.0 - unit) * wide * (high - middle)),
        )
    if law.normal is not None:
        cut = ndtr(-(3.0 if law.within is None else law.within / law.normal))
        return 1.0 + law.normal * ndtri(cut + unit * (1.0 - 2.0 * cut))
    inside = np.clip(unit, 1e-15, 1.0 - 1e-15)
    return np.exp((law.lognormal or 0.0) * ndtri(inside))


def probability(happens: BoolArray, method: str) -> tuple[float, float, float]:
    """Share of the samples (count,) in which something happens, and the ends of its 95 % interval.

    Of sobol by Student's t over its sequences, else by Wilson, and so where fewer than ten samples, or all but as few,
    say so: a probability is never 0 or 1 with certainty.
    """
    share = float(happens.mean())
    low, high = _wilson(int(happens.sum()), happens.size)
    if method == "sobol" and FEW <= happens.sum() <= happens.size - FEW:
        from scipy.special import stdtrit

        shares = happens.reshape(SCRAMBLES, -1).mean(axis=1)
        half = float(
            stdtrit(SCRAMBLES - 1, 0.5 + LEVEL / 2.0) * shares.std(ddof=1) / np.sqrt(SCRAMBLES)
        )
        if half > 0.0:
            low, high = max(share - half, 0.0), min(share + half, 1.0)
    return share, low, high


def _wilson(count: int, size: int) -> tuple[float, float]:
    """The 95 % interval of `count` of `size` independent samples.

    >>> [round(end, 4) for end in _wilson(5, 100)]
    [0.0215, 0.1118]
    """
    from scipy.special import ndtri

    z = float(ndtri(0.5 + LEVEL / 2.0))
    share, extra = count / size, z * z / size
    middle = (share + extra / 2.0) / (1.0 + extra)
    half = z / (1.0 + extra) * float(np.sqrt(share * (1.0 - share) / size + extra / size / 4.0))
    return (0.0 if count == 0 else middle - half), (1.0 if count == size else middle + half)
