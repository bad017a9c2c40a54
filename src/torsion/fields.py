"""A quantity declared once: the unit, the limits and the reading of one value of the input file."""

import math
import operator
import re
from collections.abc import Callable
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    GetPydanticSchema,
    ModelWrapValidatorHandler,
    WithJsonSchema,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import core_schema

from torsion.errors import Refusal
from torsion.units import USUAL, UsualRange, example, needs_unit, speak, to_si, written
from torsion.user_files import printable

# In SI, of any number but 0: squares and cubes of these are numbers too.
SMALLEST, LARGEST = 1e-60, 1e60


@dataclass(frozen=True)
class Clash:
    """Keys that exclude each other, or of which the first says nothing without the others; what to do instead."""

    keys: tuple[str, ...]
    hint: str
    rule: Literal["one at most", "one", "first alone", "first with all"]

    def check(self, declaration: "Declared") -> None:
        """Raise the fault of keys that are given together, or of one that is missing."""
        fields, given_names = type(declaration).model_fields, declaration.keys_given(*self.keys)
        first, *_ = names = [fields[name].alias or name for name in self.keys]
        keys = [key for key, name in zip(names, self.keys, strict=True) if name in given_names]
        missing = [f"`{key}`" for key in names if key not in keys]
        if self.rule == "first with all":
            if first in keys and missing:
                raise refuse(f"`{first}` needs {' and '.join(missing)}", self.hint, first)
        elif self.rule == "one" and not keys:
            raise refuse(f"{' or '.join(missing)} is missing", self.hint)
        elif len(keys) > 1 and (keys[0] == first or self.rule != "first alone"):
            raise refuse(f"`{keys[0]}` and `{keys[1]}` exclude each other", self.hint, keys[1])


def exclusive(*keys: str, hint: str = "keep one of them", needed: bool = False) -> Clash:
    """Keys of which at most one may be given, or exactly one if it is `needed`."""
    return Clash(keys, hint, "one" if needed else "one at most")


def excludes(key: str, *others: str, hint: str = "keep one of them") -> Clash:
    """A key that excludes each of the others."""
    return Clash((key, *others), hint, "first alone")


def needs(*keys: str, hint: str = "give both, or none") -> Clash:
    """A key that needs each of the others."""
    return Clash(keys, hint, "first with all")


def together(first: str, second: str, hint: str = "give both, or none") -> tuple[Clash, Clash]:
    """Two keys of which none says anything alone."""
    return needs(first, second, hint=hint), needs(second, first, hint=hint)


class Declared(BaseModel):
    """Base of everything that is read from a file: frozen, and no key is accepted that was not declared."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)
    clashes: ClassVar[tuple[Clash, ...]] = ()

    @model_validator(mode="after")
    def _as_a_whole(self) -> Self:
        for clash in self.clashes:
            clash.check(self)
        self.refuse_clashes()
        return self

    def keys_given(self, *keys: str) -> list[str]:
        """Return those of these keys, by the names of their fields, that were given a value, in their order."""
        stated = self.model_fields_set
        return [key for key in keys if getattr(self, key) not in (None, ()) and key in stated]

    def refuse_clashes(self) -> None:
        """Refuse values that do not go together, each of which is possible by itself."""


def given(meaning: str, default: Any = None, **limits: Any) -> Any:
    """An optional key with its meaning; the manual and the editor's completion print the meaning."""
    return Field(default, description=meaning, **limits)


def required(meaning: str, **limits: Any) -> Any:
    """A key that must be present, with its meaning."""
    return Field(description=meaning, **limits)


refuse = Refusal  # what a reader of values raises


_READING: ContextVar[tuple[str, bool]] = ContextVar(
    "_READING", default=("", False)
)  # what is read; it is unusual


class Sized(Declared):
    """What has quantities of a usual range; everything declared within it is of the same piece."""

    unusual: bool = given("true: quantities outside their usual range are meant", False)

    def refuse_unusual(self, row: str, number: float, words: str, hint: str, key: str) -> None:
        """Refuse a number that several keys make together, outside its row of usual ranges.

        words: of what it is, with `{}` in the place of the number.
        """
        usual = USUAL[row]
        if not (self.unusual or usual.holds(number)):
            lifts = f"usual: {usual.words()}; if it is meant, `unusual: true` says so"
            message = f"{words.format(f'{number:.5g}')}, outside the usual range"
            raise refuse(message, f"{hint} {lifts}".strip(), key)

    @model_validator(mode="wrap")
    @classmethod
    def _with_its_ranges(cls, data: Any, read: ModelWrapValidatorHandler[Self]) -> Self:
        """The instance, its quantities judged by what its own key `unusual` says."""
        meant = isinstance(data, dict) and data.get("unusual") is True
        before = _READING.set((getattr(cls, "keyword", cls.__name__.lower()), meant))
        try:
            return read(data)
        finally:
            _READING.reset(before)


WITH_UNIT = {"type": "string", "pattern": r"^\s*[+−-]?\.?[0-9]"}  # for an editor


@dataclass(frozen=True)
class Quantity:
    """Reads a number in SI or text with a unit into a float in `unit`, within the limits.

    A value outside its usual range is refused as a slip, but where the component says `unusual: true`.
    """

    unit: str
    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None
    usual: str = ""  # row of the table of usual ranges; empty: that of the unit

    def read(self, value: object) -> float:
        """The value in `unit`; raises the located fault that the user sees."""
        try:
            if isinstance(value, str):
                return self._within(to_si(value, self.unit), *written(value, self.unit))
            if isinstance(value, bool) or not isinstance(value, int | float):
                unit = "" if self.unit == "1" else f" with a unit, {self.unit}"
                message = f"{shown(value)} is not {speak(self.unit)}"
                raise refuse(message, f"write a number{unit}")
            if needs_unit(self.unit):
                message = f"{shown(value)} has no unit; {speak(self.unit)} must carry one"
                raise refuse(message, "deg or rad" if self.unit == "rad" else "rpm or rad/s")
            return self._within(float(value), self.unit, 1.0)
        except OverflowError:
            raise refuse("the number is too large", "numbers up to 1e308 are possible") from None

    def _within(self, number: float, unit: str, size: float) -> float:
        """The number, where the limits allow it; they are stated in the unit it was written in, of that size."""
        if not math.isfinite(number):
            raise refuse(f"{number} is not a finite number")
        for words, limit, holds in self.limits:
            if not holds(number, limit):
                must = f"must be {words} {_with_unit(limit / size, unit)}"
                raise refuse(f"{_with_unit(number / size, unit)} is out of range", must)
        what, meant = _READING.get()
        if not (meant or self.range.holds(number)):
            lifts = f"; if it is meant, `unusual: true` on the {what} says so" if what else ""
            stated, usual = number / size, self.range

            # What is written with the first unit that makes it usual, as a question; else what it may be.
            likely = (
                _with_unit(stated, meant)
                for meant in usual.slip
                if (value := stated * to_si(f"1 {meant}", self.unit)) and usual.holds(value)
            )
            is_small = (abs(number) if usual.low > 0.0 else number) < usual.low
            guess = next(likely, usual.below if is_small else usual.above)
            hint = f"{guess + '? ' if guess else ''}usual: {self.usual_words(unit, size)}{lifts}"
            raise refuse(f"{_with_unit(stated, unit)} is outside the usual range", hint)
        if number and not SMALLEST <= abs(number) <= LARGEST:
            hint = f"in SI from {SMALLEST:g} to {LARGEST:g}, or 0"
            raise refuse(
                f"{_with_unit(number / size, unit)} is beyond all that can be computed with", hint
            )
        return number

    @property
    def range(self) -> UsualRange:
        """Its row of the table of usual ranges."""
        return USUAL[self.usual or self.unit]

    @property
    def limits(self) -> list[tuple[str, float, Callable[[float, float], bool]]]:
        """Every limit with the words for it and what must hold of a value and it."""
        limits = (
            ("more than", self.above, operator.gt),
            ("at least", self.at_least, operator.ge),
            ("less than", self.below, operator.lt),
            ("at most", self.at_most, operator.le),
        )
        return [(words, limit, holds) for words, limit, holds in limits if limit is not None]

    def usual_words(self, unit: str = "", size: float = 1.0) -> str:
        """The usual range in words, in a unit of that size."""
        words = _with_unit(self.range.words(size), unit)
        return words + (", or 0" if self.at_least == 0 and self.range.low > 0.0 else "")

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        meaning = f"a number with a unit; in SI: {self.unit}; usually {self.usual_words()}"
        text = {"description": meaning, "examples": [example(self.unit)]} | WITH_UNIT
        plain = text if needs_unit(self.unit) else {"anyOf": [{"type": "number"}, text]}
        return plain | {"x-usual": self.range.ends}


def _with_unit(amount: float | str, unit: str) -> str:
    shown = amount if isinstance(amount, str) else f"{amount:g}"
    return shown if unit in ("", "1") else f"{shown} {unit}"


def shown(value: object) -> str:
    """A value as it is quoted in a message."""
    if isinstance(value, dict | list | tuple):
        return "a mapping" if isinstance(value, dict) else "a list"
    if value is None:
        return "nothing"
    return f"'{printable(value)}'" if isinstance(value, str) else str(value).lower()[:60]


_EXACT = re.compile(
    r" *[+-]?[0-9]{0,20}(\.[0-9]{0,20}|/[0-9]{1,20})? *"
)  # no exponent: 1e999999 is beyond any memory
_DECIMAL = r"[0-9]{1,20}(?:\.[0-9]{1,20})?"


def read_exact(value: object) -> Fraction:
    """An exact positive ratio or order: 2, 0.5, '21/8' (decimal digits are taken as they are written)."""
    if isinstance(value, Fraction):
        return value
    written = value if isinstance(value, str) else repr(value)
    try:
        if isinstance(value, bool) or (isinstance(value, str) and not _EXACT.fullmatch(written)):
            raise ValueError
        exact = Fraction(written)
    except (ValueError, ZeroDivisionError):
        hint = "write 2, 0.5 or 21/8"
        # What to write for a quotient with decimals or a colon: 100/577 for '1/5.77', 5.77 for '5.77:1'.
        quotient = re.fullmatch(rf"\s*({_DECIMAL})\s*([/:])\s*({_DECIMAL})\s*", str(value))
        if quotient is not None and Fraction(quotient[1]) and Fraction(quotient[3]):
            above, sign, below = quotient.groups()
            rule = "a quotient has whole numbers: " if sign == "/" else ""
            hint = f"{rule}write {Fraction(above) / Fraction(below)}"
            if sign == ":" and Fraction(below) == 1:
                hint = f"write {above}"
        raise refuse(f"{shown(value)} is not a number", hint) from None
    if not 1e-9 < exact < 1e9:
        raise refuse(f"{shown(value)} is out of range", "must be a positive number")
    return exact


@dataclass(frozen=True, slots=True)
class Amount:
    """A torque amplitude: so many N m, and a share of the mean torque that acts there."""

    torque: float = 0.0  # N m
    of_mean: float = 0.0  # 1


SHARE_OF_MEAN = Quantity("1", at_least=0, usual="share of the mean torque")


def read_amount(value: object) -> Amount:
    """A torque amplitude: N m, text with %, or {of_mean: %}."""
    if isinstance(value, Amount):
        return value
    if isinstance(value, dict):
        if set(value) != {"of_mean"}:
            message = "a share of the mean torque has the key `of_mean` alone"
            raise refuse(message, "{of_mean: 10 %}")
        return Amount(of_mean=SHARE_OF_MEAN.read(value["of_mean"]))
    if isinstance(value, str) and value.strip().endswith("%"):
        return Amount(of_mean=SHARE_OF_MEAN.read(value))
    return Amount(torque=Quantity("N*m", at_least=0).read(value))


def _read_by(read: Callable[[Any], Any]) -> GetPydanticSchema:
    """A value that one function alone reads."""
    return GetPydanticSchema(lambda *_: core_schema.no_info_plain_validator_function(read))


Value = TypeVar("Value")
# A single value stands for a list of it.
OneOrMany = BeforeValidator(lambda value: value if isinstance(value, list | tuple) else (value,))


def or_value(kind: type[Declared], key: str, plain: Any = float | str) -> BeforeValidator:
    """Take a value of the type `plain` for the mapping that has it under `key`."""
    return BeforeValidator(
        lambda value: value if isinstance(value, dict | kind) else {key: value}, plain | kind
    )


def read_item(collection: Any, step: str | int, read: Callable[[Any], Value]) -> Value:
    """Read one item of a list or mapping; a fault is located at the item."""
    try:
        return read(collection[step])
    except Refusal as fault:
        raise refuse(fault.message, fault.hint, (step, *fault.key)) from None


Rows = tuple[tuple[float, float], ...]
WrittenRows = tuple[tuple[float | str, float | str], ...]


def read_rows(value: Any, quantities: tuple[Quantity, Quantity], over: str, hint: str) -> Rows:
    """Read a table of two columns in SI, the first rising; raises the located fault that the user sees."""
    if not isinstance(value, list | tuple) or not all(
        isinstance(row, list | tuple) and len(row) == 2 for row in value
    ):
        raise refuse(f"this is not a table over {over}", hint)

    first, second = quantities
    rows = tuple(
        read_item(
            value,
            number,
            lambda row: (read_item(row, 0, first.read), read_item(row, 1, second.read)),
        )
        for number in range(len(value))
    )
    if len(rows) < 2 or any(before[0] >= after[0] for before, after in pairwise(rows)):
        raise refuse(f"a table over {over} needs two rows or more, rising", hint)
    return rows


def table_over(over: str, first: Quantity, second: Quantity, hint: str) -> BeforeValidator:
    """Read rows of two quantities, for a key that has such a table."""
    return BeforeValidator(
        lambda value: read_rows(value, (first, second), over, hint),
        json_schema_input_type=tuple[tuple[Annotated[float, first], Annotated[float, second]], ...],
    )


Inertia = Annotated[float, Quantity("kg*m**2", at_least=0)]
Mass = Annotated[float, Quantity("kg", at_least=0)]
Stiffness = Annotated[float, Quantity("N*m/rad", above=0)]
GroundStiffness = Annotated[float, Quantity("N*m/rad", at_least=0)]
Flexibility = Annotated[float, Quantity("rad/(N*m)", at_least=0)]
Damping = Annotated[float, Quantity("N*m*s/rad", at_least=0)]
Across = Annotated[float, Quantity("m", above=0, usual="diameter of a shaft")]
Bore = Annotated[float, Quantity("m", at_least=0, usual="diameter of a shaft")]
Angle = Annotated[float, Quantity("rad")]
JointAngle = Annotated[float, Quantity("rad", at_least=0, below=math.pi / 2)]
Speed = Annotated[float, Quantity("rad/s", above=0)]
Frequency = Annotated[float, Quantity("Hz", above=0)]
Torque = Annotated[float, Quantity("N*m", at_least=0)]
PositiveTorque = Annotated[float, Quantity("N*m", above=0)]
Rating = Annotated[float, Quantity("N*m", above=0, usual="rating")]
Power = Annotated[float, Quantity("W", above=0)]
Modulus = Annotated[float, Quantity("Pa", above=0, usual="modulus")]
Tolerance = Annotated[float, Quantity("1", at_least=0, usual="tolerance")]
LossFactor = Annotated[float, Quantity("1", at_least=0, usual="loss factor")]
Number = Annotated[float, Quantity("1", above=0)]
_exact = {
    "anyOf": [
        {"type": "number", "exclusiveMinimum": 0},
        {"type": "string", "pattern": "^[0-9./]+$"},
    ]
}
_of_mean = {
    "type": "object",
    "required": ["of_mean"],
    "properties": {
        "of_mean": {
            "description": "share of the mean torque, %",
            "anyOf": [{"type": "number"}, WITH_UNIT],
            "x-usual": SHARE_OF_MEAN.range.ends,
        }
    },
}
_amount = {"anyOf": [{"type": "number"}, WITH_UNIT, _of_mean]}
Exact = Annotated[Fraction, _read_by(read_exact), WithJsonSchema(_exact)]
TorqueAmount = Annotated[Amount, _read_by(read_amount), WithJsonSchema(_amount)]
