"""Quantities as an engineer writes them ('20 kN*m/rad', '1500 rpm') turned into numbers in SI units.

The angle is a dimension of its own, so that a torque is refused for a stiffness and a frequency for a speed. Arithmetic
is in exact fractions and rounded once. The commonest spellings need no unit library; all others are resolved by pint
with the definitions of units.txt.

The usual range of every quantity stands in one table: a value outside is a slip, or said to be meant. A range is wider
than all that is built. A quantity names its row; one that names none has that of its unit.
"""

import math
import re
from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsion.errors import Refusal, nearest
from torsion.user_files import printable

if TYPE_CHECKING:
    from pint import UnitRegistry
    from pint.util import UnitsContainer

_HIGHEST = 12  # power of one unit; bounds the size of exact fractions
_TRADE = "kN MN kg mm km MPa GPa kW MW kHz Nm kNm MNm Nms"  # often misspelled
_LONGEST = 100  # characters of a quantity; no sensible one is longer
_PI = Fraction("3.14159265358979323846264338327950288419716939937510")
QUANTITIES = """\
1 | a number without a unit | 25 % | 1/100 %
rad | an angle | 5 deg | pi/180 deg, 1/1000 mrad
rad/s | a speed | 1500 rpm | pi/30 rpm, pi/30 1/min, pi/30 min**-1
Hz | a frequency | 35 Hz | 1e3 kHz, 1 1/s
s | a time | 5 s | 1/1000 ms, 60 min
K | a difference of temperature | 70 K |
degC | a temperature | 40 degC |
N*m/rad | a stiffness | 20 kN*m/rad | 1 Nm/rad, 1e3 kN*m/rad, 1e3 kNm/rad, 1e6 MN*m/rad, 1e6 MNm/rad
rad/(N*m) | a flexibility | 5.1e-7 rad/(N*m) |
N*m*s/rad | a damping | 12 N*m*s/rad | 1 Nms/rad, 1e3 kN*m*s/rad, 1e3 kNms/rad
kg*m**2 | an inertia | 1.2 kg*m**2 | 1 kgm**2
N*m | a torque or energy | 1.5 kN*m | 1 Nm, 1e3 kN*m, 1e3 kNm, 1e6 MN*m, 1e6 MNm
W | a power | 100 kW | 1e3 kW, 1e6 MW
m | a length | 60 mm | 1/1000 mm, 1/100 cm
m**2 | an area | 20 cm**2 |
m**3 | a volume or shape factor | 5 m**3 |
m/s | a velocity | 3 m/s |
m**2/s | a kinematic viscosity | 0.15 m**2/s |
rad/s**2 | an angular acceleration | 10 rad/s**2 |
kg | a mass | 35 kg |
kg/m**3 | a density | 7850 kg/m**3 |
N | a force | 10 kN |
N/m | a lateral stiffness | 50 MN/m |
N*s/m | a lateral damping | 20 kN*s/m |
Pa | a pressure, stress or modulus | 79.3 GPa | 1e6 MPa, 1e9 GPa, 1e6 N/mm**2, 1e5 bar
N*m*s | an angular momentum | 12 N*m*s |
"""  # SI unit | what it measures | an example to follow | sizes in that unit of common spellings
_ROWS = [[cell.strip() for cell in line.split("|")] for line in QUANTITIES.splitlines()]
_KINDS = {unit: (what, example) for unit, what, example, _ in _ROWS}
_COMMON = {
    unit: {
        spelling: _PI / int(size[3:]) if size[:3] == "pi/" else Fraction(size)
        for size, spelling in (pair.split() for pair in sizes.split(",") if pair)
    }
    for unit, _, _, sizes in _ROWS
}

_DIGITS = r"[0-9]+(?:_[0-9]+)*"
_NUMBER = re.compile(rf"[+-]?(?:{_DIGITS}(?:\.(?:{_DIGITS})?)?|\.{_DIGITS})(?:[eE]([+-]?[0-9]+))?")
_TOKEN = re.compile(r"\s*(\*\*[+-]?[0-9]{1,2}(?![0-9])|[*/()]|1(?![0-9.])|[^\W\d_]+|%)\s*")
_GLUED = re.compile(
    r"([kMGmu]?N|kgf|lbf)(mm|cm|m|in|ft)(s?)|([kMGmu]?N|[kMGm]?W|[kM]?Pa)(s)|(kg|g|lb)(mm|cm|m|in|ft)"
)
_MARKED = re.compile(  # groups: the whole part, its mark, what follows a decimal point
    r"([-+]?[0-9]{1,3}(?:(['\u2019\s])[0-9]{3}(?:\s?\2?[0-9]{3})*|(?:\.[0-9]{3}){2,}))(?![0-9/])((?:\.[0-9]+)?)"
)
_DATE = re.compile(
    r"[0-9]{1,4}([./-])[0-9]{1,2}\1[0-9]{1,4}|"
    r"[0-9]{1,2}[. -]+(?:jan|feb|mar|mär|apr|ma[iy]|jun|jul|aug|sep|o[ck]t|nov|de[cz])[^\W\d_]*\.?(?:[ -]?[0-9]+)?",
    re.IGNORECASE,
)
_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻", "0123456789+-")
_SIGNS = str.maketrans(
    dict.fromkeys("·⋅∙•×", "*") | {"µ": "u", "μ": "u", "−": "-", "^": "**", "℃": "degC"}
)
_RAISED = re.compile(r"[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")
_REWRITES = (  # towards one spelling: pattern, replacement
    (re.compile(r"°"), "deg"),
    (re.compile(r"hp\(metric\)"), "PS"),
    (re.compile(r"\s+"), " "),
    (re.compile(r" ?(\*\*|[*/()]) ?"), r"\1"),
    (re.compile(r"\*\*\(([+-]?[0-9]+)\)"), r"**\1"),
    (re.compile(r"(?<=[A-Za-z])-(?=[A-Za-z])"), "*"),
    (re.compile(r"(?<=[A-Za-z])(-?[0-9]+)"), r"**\1"),
    (re.compile(r"^\*(?=[^*])"), ""),
)


def to_si(text: str, unit: str) -> float:
    """The quantity `text` as a number in the SI unit `unit`, correctly rounded; raises Refusal."""
    number, written = amount(text)
    if not written and needs_unit(unit):
        example = _KINDS[unit][1].split()[1]
        hint = f"write '{text.strip()} {example}' or '{text.strip()} {unit}'"
        raise Refusal(f"{_quoted(text)} has no unit, {_expected(unit)} is expected", hint)
    if written not in ("", unit):
        scale = _COMMON.get(unit, {}).get(written)
        number = number * scale if scale else _converted(number, written, unit, text)
    try:
        value = float(number)
    except OverflowError:
        raise Refusal(f"{_quoted(text)} is too large for a number") from None
    if number and not value:
        raise Refusal(f"{_quoted(text)} is too small for a number other than 0")
    return value


def written(text: str, unit: str) -> tuple[str, float]:
    """The unit that the quantity `text` is written in and its size in `unit`; `unit` itself where it is no common one.

    Raises Refusal.
    """
    spelled = amount(text)[1]
    size = _COMMON.get(unit, {}).get(spelled)
    return (unit, 1.0) if size is None else (spelled, float(size))


def needs_unit(unit: str) -> bool:
    """A bare number in this unit could be read in two ways: degrees or radians, rpm or rad/s."""
    return unit in {"rad", "rad/s"}


def speak(unit: str) -> str:
    """What is measured in the SI unit `unit`, in words: 'a stiffness'."""
    return _KINDS[unit][0] if unit in _KINDS else "a quantity"


def example(unit: str) -> str:
    """A quantity in the SI unit `unit`, as it is written: '20 kN*m/rad'."""
    return _KINDS[unit][1]


def _expected(unit: str) -> str:
    return speak(unit) if unit == "1" else f"{speak(unit)} in {unit}"


def _quoted(text: str) -> str:
    return f"'{printable(text.strip(), 40)}'"


@lru_cache(maxsize=4096)  # a file is read again for each of its variants
def amount(text: str) -> tuple[Fraction, str]:
    """The number in front, exact, and the unit behind it in one spelling (empty if there is none); raises Refusal.

    >>> amount("1.5 kN*m")
    (Fraction(3, 2), 'kN*m')
    """
    spelled = text.strip()[: _LONGEST + 1].translate(_SIGNS)
    spelled = _RAISED.sub(lambda raised: "**" + raised[0].translate(_SUPERSCRIPTS), spelled)
    number = _NUMBER.match(spelled)
    if not number:
        if spelled.lstrip("+-.").casefold() in {"nan", "inf", "infinity"}:
            raise Refusal(f"{_quoted(text)} is not a finite number")
        raise Refusal(
            f"{_quoted(text)} does not begin with a number", "write a number, a space and a unit"
        )
    if len(spelled) > _LONGEST:
        raise Refusal(f"{_quoted(text)} is too long for a quantity")
    written = spelled[number.end() :].strip()
    if mark := _MARKED.match(spelled):
        right = f"write {re.sub(r'[^-+0-9]', '', mark[1])}{mark[3]}"
        raise Refusal(f"{_quoted(text)} has a mark between its thousands", right)
    if _DATE.fullmatch(spelled):
        cause = "a spreadsheet makes dates of cells that are not formatted as numbers"
        raise Refusal(f"{_quoted(text)} looks like a date", f"write the number; {cause}")
    if re.match(r",\s*[0-9]", written):
        hint = "write a decimal point, and no mark between thousands"
        raise Refusal(f"{_quoted(text)} has a comma in its number", hint)
    if number[1] and len(number[1].lstrip("+-0")) > 3:
        raise Refusal(f"{_quoted(text)} is outside the range of numbers")
    for pattern, replacement in _REWRITES:
        written = pattern.sub(replacement, written)
    unit = f"1{written}" if written.startswith("/") else written
    return Fraction(number[0].replace("_", "")), unit


@cache
def _registry() -> "UnitRegistry[Any]":
    from pint import UnitRegistry

    return UnitRegistry(
        Path(__file__).with_name("units.txt"), non_int_type=Fraction, cache_folder=None
    )


@cache
def _container(written: str) -> "UnitsContainer":
    """The unit as powers of the names of units.txt; raises Refusal."""
    from pint.errors import PintError

    usual = "units are written like kN*m/rad, kg*m**2, rpm"
    tokens, end = list[str](), 0
    while token := _TOKEN.match(written, end):
        tokens.insert(0, token[1])
        end = token.end()
    try:
        named = _product(tokens)
        if tokens or end < len(written):
            raise LookupError
    except LookupError:
        raise Refusal(f"the unit {_quoted(written)} cannot be read", usual) from None
    registry, powers = _registry(), Counter[str]()
    for name, power in named.items():
        try:
            powers[registry.get_name("percent" if name == "%" else name)] += (
                power  # '' for dimensionless
            )
        except PintError:
            near = nearest(name, _spelled())
            hint = f"did you mean '{near}'?" if near else usual
            raise Refusal(f"'{name}' is not a known unit", hint) from None
    if any(abs(power) > _HIGHEST for power in powers.values()):
        raise Refusal(f"'{written}' has a power that no quantity has")
    return registry.UnitsContainer(
        {name: power for name, power in powers.items() if name and power}
    )


def _converted(number: Fraction, written: str, unit: str, text: str) -> Fraction:
    from pint.errors import PintError

    container, expected = _container(written), _container(unit)
    dimension, measured = _registry().get_dimensionality, ""
    if unit == "rad/s" and container == _container("1/min"):
        container = _container("rpm")
    if dimension(container) != dimension(expected):
        kinds = (kind for kind in _KINDS if dimension(_container(kind)) == dimension(container))
        measured = next((_KINDS[kind][0] for kind in kinds), f"in {written}")
    elif unit == "K" and container in (_container("degC"), _container("degF")):
        measured = "a temperature"
    if measured:
        # What to write instead: the same with or without '/rad' if that is all that is wrong.
        missing, plain = dimension(expected / container), " ".join(text.split())
        hint = f"for example '{_KINDS[unit][1]}'" if unit in _KINDS else ""
        if unit.endswith("/rad") and missing == dimension(_container("1/rad")):
            hint = f"try '{plain}/rad'"
        elif plain.endswith("/rad") and missing == dimension(_container("rad")):
            hint = f"try '{plain.removesuffix('/rad')}'"
        raise Refusal(f"{_quoted(text)} is {measured}, {_expected(unit)} is expected", hint)
    try:
        return Fraction(_registry().convert(number, container, expected))
    except PintError:
        message = f"{_quoted(text)} mixes a temperature scale with other units"
        raise Refusal(message, "write K") from None


@cache
def _spelled() -> tuple[str, ...]:
    """The names of units that others are compared with."""
    registry = _registry()
    plain = (
        name for name in registry if name.isalpha() and not registry.parse_unit_name(name)[0][0]
    )
    return (*plain, *_TRADE.split())


def _product(tokens: list[str]) -> Counter[str]:
    """The names in a product of units with their powers: 'kNm/rad' is kN 1, m 1, rad -1.

    tokens: from the last to the first; what the product does not take stays. Raises LookupError.
    """
    total, sign = Counter[str](), 1
    while True:
        # One unit, several glued together ('kNm') or a product in brackets, raised to the power that follows.
        token, raised = tokens.pop(), list[str]()
        powers = Counter[str]()
        if token == "(":
            powers = _product(tokens)
            raised = list(powers)
            if tokens.pop() != ")":
                raise LookupError
        elif token == "%" or token.isalpha():
            glued = _GLUED.fullmatch(token)
            names = [name for name in glued.groups() if name] if glued else [token]
            powers, raised = Counter(names), names[-1:]
        elif token != "1":
            raise LookupError
        if tokens and tokens[-1].startswith("**"):
            exponent = int(tokens.pop()[2:])
            powers.update({name: powers[name] * (exponent - 1) for name in raised})
        for name, power in powers.items():
            total[name] += sign * power
        if not tokens or tokens[-1] == ")":
            return total
        sign = -1 if tokens[-1] == "/" else 1
        if tokens[-1] in "*/":
            tokens.pop()


@dataclass(frozen=True)
class UsualRange:
    """From `low` to `high` in SI; of the size alone, whatever the sign, where `low` is above 0; 0 is never unusual.

    The units of `slip` are those that a writer may have had in mind; `below` and `above` name another quantity that a
    value beyond that end may have been meant for.
    """

    low: float = -math.inf
    high: float = math.inf
    slip: tuple[str, ...] = ()
    below: str = ""
    above: str = ""

    def holds(self, number: float) -> bool:
        """Return whether a number (SI) is usual."""
        size = abs(number) if self.low > 0.0 else number
        return number == 0 or self.low <= size <= self.high

    @property
    def ends(self) -> list[float | None]:
        """Both ends; None where the range is open."""
        return [end if math.isfinite(end) else None for end in (self.low, self.high)]

    def words(self, size: float = 1.0) -> str:
        """The range in words, in a unit of that size."""
        low, high = self.low / size, self.high / size
        if math.isinf(low):
            return f"at most {high:.5g}"
        return f"at least {low:.5g}" if math.isinf(high) else f"{low:.5g} to {high:.5g}"


def _read_table() -> dict[str, UsualRange]:
    """Read usual_ranges.txt: a row by the SI unit that it holds for, or by the name that a quantity gives."""
    ranges, file = {}, Path(__file__).with_name("usual_ranges.txt")
    for line in file.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            name, low, high, *words = (cell.strip() for cell in line.split("|"))
            slip, below, above = (*words, "", "", "")[:3]
            ends = float(low or -math.inf), float(high or math.inf)
            ranges[name] = UsualRange(*ends, tuple(slip.split()), below, above)
    return ranges


USUAL = _read_table()
WIDEST = USUAL["diameter of a shaft"].high  # m; the shafts of the largest water turbines
