"""Quantities as they are written, against factors taken from the definitions of the units."""

import math
import subprocess
import sys
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.for_all import for_all
from tests.texts import ANY_CHARACTER

from torsion import units
from torsion.errors import Refusal
from torsion.units import needs_unit, speak, to_si

TURN = 2 * math.pi
POUND_FORCE = 0.45359237 * 9.80665  # N, exact by definition of pound and standard gravity
INCH = 0.0254
FORCE = Fraction("0.45359237") * Fraction("9.80665")  # the pound force again, exactly

QUANTITIES = [
    ("20 kN*m/rad", "N*m/rad", 2e4),
    ("20 kNm/rad", "N*m/rad", 2e4),
    ("20kN·m/rad", "N*m/rad", 2e4),
    ("0.02 MNm / rad", "N*m/rad", 2e4),
    ("20_000", "N*m/rad", 2e4),
    ("20*kN*m/rad", "N*m/rad", 2e4),
    ("350 N*m/deg", "N*m/rad", 350 * 180 / math.pi),
    ("10 N*m/turn", "N*m/rad", 10 / TURN),
    ("3 lbf-in/rad", "N*m/rad", 3 * POUND_FORCE * INCH),
    ("1e6 lbf*ft/rad", "N*m/rad", 1e6 * POUND_FORCE * 12 * INCH),
    ("5.128e-7 rad/(N*m)", "rad/(N*m)", 5.128e-7),
    ("0.5 deg/kNm", "rad/(N*m)", 0.5e-3 * math.pi / 180),
    ("12 Nms/rad", "N*m*s/rad", 12),
    ("12 N m s rad^-1", "N*m*s/rad", 12),
    ("1.2 kg*m**2", "kg*m**2", 1.2),
    ("1.2 kgm2", "kg*m**2", 1.2),
    ("1.2 kg·m²", "kg*m**2", 1.2),
    ("1.2 kgm²", "kg*m**2", 1.2),
    ("1.2 kg m^2", "kg*m**2", 1.2),
    ("1.2e6 kg*mm**2", "kg*m**2", 1.2),
    ("11.9 lbf*in*s**2", "kg*m**2", 11.9 * POUND_FORCE * INCH),
    ("3 lb*ft**2", "kg*m**2", 3 * 0.45359237 * 0.3048**2),
    ("7 kgfcms2", "kg*m**2", 7 * 9.80665 * 0.01),
    ("1500 rpm", "rad/s", 1500 * TURN / 60),
    ("1_500 RPM", "rad/s", 1500 * TURN / 60),
    ("1500 1/min", "rad/s", 1500 * TURN / 60),
    ("1500 /min", "rad/s", 1500 * TURN / 60),
    ("1500 min-1", "rad/s", 1500 * TURN / 60),
    ("1500 min⁻¹", "rad/s", 1500 * TURN / 60),
    ("1500 r/min", "rad/s", 1500 * TURN / 60),
    ("1500 U/min", "rad/s", 1500 * TURN / 60),
    ("25 rev/s", "rad/s", 25 * TURN),
    ("90 deg/s", "rad/s", math.pi / 2),
    ("-5 deg", "rad", -5 * math.pi / 180),
    ("−5°", "rad", -5 * math.pi / 180),
    ("0.25 turn", "rad", math.pi / 2),
    ("3 mrad", "rad", 3e-3),
    ("35 Hz", "Hz", 35),
    ("120 1/min", "Hz", 2),
    ("35", "Hz", 35),
    ("2 min", "s", 120),
    ("1.5 hour", "s", 5400),
    ("250 ms", "s", 0.25),
    ("60 mm", "m", 0.06),
    ("3 µm", "m", 3e-6),
    ("3 μm", "m", 3e-6),
    ("8.5 in", "m", 8.5 * INCH),
    ("3 ft", "m", 0.9144),
    ("79.3 GPa", "Pa", 79.3e9),
    ("600 N/mm2", "Pa", 6e8),
    ("600 N/mm²", "Pa", 6e8),
    ("2 bar", "Pa", 2e5),
    ("30e6 psi", "Pa", 30e6 * POUND_FORCE / INCH**2),
    ("7850 kg/m3", "kg/m**3", 7850),
    ("7.85 g/cm^3", "kg/m**3", 7850),
    ("100 kW", "W", 1e5),
    ("100 PS", "W", 100 * 75 * 9.80665),
    ("100 ps", "W", 100 * 75 * 9.80665),
    ("100 hp(metric)", "W", 100 * 75 * 9.80665),
    ("100 hp", "W", 100 * 550 * 0.3048 * POUND_FORCE),
    ("5 kgf", "N", 5 * 9.80665),
    ("1.5 J", "N*m", 1.5),
    ("3 N*m*(ms*km)**2/(s*m)**2", "N*m", 3),
    ("1.5 kgfm", "N*m", 1.5 * 9.80665),
    ("25 %", "1", 0.25),
    ("25%", "1", 0.25),
    ("40 ppm", "1", 4e-5),
    ("0.25", "1", 0.25),
    ("1e3 m/km", "1", 1),
    ("40", "degC", 40),
    ("40 °C", "degC", 40),
    ("300 K", "degC", 26.85),
    ("212 degF", "degC", 100),
    ("36 km/hour", "m/s", 10),
]


@for_all(("text", "unit", "expected"), QUANTITIES)
def test_a_quantity_is_the_number_that_the_definitions_of_its_units_give(
    text: str, unit: str, expected: float
) -> None:
    assert to_si(text, unit) == pytest.approx(expected, rel=9e-16, abs=0)


@pytest.mark.parametrize(
    ("text", "unit", "exact"),
    [
        ("0.1 kN*m", "N*m", Fraction(100)),
        ("1.1 mm", "m", Fraction(11, 10_000)),
        ("2.3 lbf", "N", Fraction("2.3") * FORCE),
        ("4.7 lbf*in*s**2", "kg*m**2", Fraction("4.7") * FORCE * Fraction("0.0254")),
        ("71 degF", "degC", Fraction(39 * 5, 9)),
    ],
)
def test_a_conversion_is_rounded_once(text: str, unit: str, exact: Fraction) -> None:
    assert to_si(text, unit) == float(exact)


@for_all("unit", units._COMMON)
def test_the_short_way_gives_what_the_definitions_give(unit: str) -> None:
    for spelling in units._COMMON[unit]:
        number = Fraction("7.3")
        exact = units._converted(number, spelling, unit, f"7.3 {spelling}")
        assert to_si(f"7.3 {spelling}", unit) == float(exact)


@for_all("unit", units._KINDS)
def test_every_kind_has_words_and_an_example_that_can_be_read(unit: str) -> None:
    assert speak(unit).split()[0] in {"a", "an"}
    assert math.isfinite(to_si(units._KINDS[unit][1], unit))
    assert needs_unit(unit) or to_si("2.5", unit) == 2.5


@for_all(
    ("text", "unit", "message", "hint"),
    [
        (
            "20 kN*m",
            "N*m/rad",
            "'20 kN*m' is a torque or energy, a stiffness in N*m/rad is expected",
            "try '20 kN*m/rad'",
        ),
        (
            "20 Nm/rad",
            "N*m",
            "'20 Nm/rad' is a stiffness, a torque or energy in N*m is expected",
            "try '20 Nm'",
        ),
        ("3 N*m*s", "N*m*s/rad", "is an angular momentum, a damping", "try '3 N*m*s/rad'"),
        (
            "35 Hz",
            "rad/s",
            "'35 Hz' is a frequency, a speed in rad/s is expected",
            "for example '1500 rpm'",
        ),
        (
            "1500 rpm",
            "Hz",
            "'1500 rpm' is a speed, a frequency in Hz is expected",
            "for example '35 Hz'",
        ),
        ("5 1/s", "rad/s", "is a frequency, a speed", "rpm"),
        (
            "5 m",
            "1",
            "'5 m' is a length, a number without a unit is expected",
            "for example '25 %'",
        ),
        ("5 rad", "1", "is an angle, a number without a unit is expected", "25 %"),
        ("2 (N*m)**2", "N*m", "is in (N*m)**2, a torque", ""),
        ("5", "rad", "'5' has no unit, an angle in rad is expected", "write '5 deg' or '5 rad'"),
        ("1500", "rad/s", "'1500' has no unit, a speed", "write '1500 rpm' or '1500 rad/s'"),
        ("5 NM", "N*m", "'NM' is not a known unit", "did you mean 'Nm'?"),
        ("5 KN", "N", "'KN' is not a known unit", "did you mean 'kN'?"),
        ("5 rmp", "rad/s", "'rmp' is not a known unit", "did you mean 'rpm'?"),
        ("5 Ω", "m", "'Ω' is not a known unit", "units are written like"),
        ("1,5 kN", "N", "has a comma in its number", "decimal point"),
        ("kN", "N", "does not begin with a number", "write a number"),
        ("", "N", "'' does not begin with a number", "write a number"),
        ("nan", "N", "'nan' is not a finite number", ""),
        ("-.inf", "N", "is not a finite number", ""),
        ("1e400 m", "m", "is too large for a number", ""),
        ("1e305 Mm", "m", "is too large for a number", ""),
        ("1e-400", "m", "is too small for a number other than 0", ""),
        ("1e99999999999", "m", "is outside the range of numbers", ""),
        ("3 kN*m/", "N*m", "the unit 'kN*m/' cannot be read", ""),
        ("3 ((m)", "m", "the unit '((m)' cannot be read", ""),
        ("3 *", "1", "the unit '*' cannot be read", ""),
        ("3 **2 m", "m", "cannot be read", ""),
        ("3 m)", "m", "the unit 'm)' cannot be read", ""),
        ("3 2*m", "m", "the unit '2*m' cannot be read", ""),
        ("3 m**0.5", "m", "cannot be read", ""),
        ("3 m**123", "m", "cannot be read", ""),
        ("3 ((km**99)**99)**99", "m", "has a power that no quantity has", ""),
        (
            "20 °C",
            "K",
            "'20 °C' is a temperature, a difference of temperature in K is expected",
            "70 K",
        ),
        (
            "36 °F",
            "K",
            "'36 °F' is a temperature, a difference of temperature in K is expected",
            "70 K",
        ),
        ("3 degC*m", "K*m", "mixes a temperature scale with other units", "write K"),
        ("3 kdegC", "degC", "'kdegC' is not a known unit", ""),
        ("3 " + "(" * 90 + "m", "m", "cannot be read", ""),
        ("1" * 200, "m", "is too long for a quantity", ""),
    ],
)
def test_what_is_not_the_quantity_is_refused_in_words(
    text: str, unit: str, message: str, hint: str
) -> None:
    with pytest.raises(Refusal) as caught:
        to_si(text, unit)
    assert message in caught.value.message
    assert hint in caught.value.hint
    assert str(caught.value).startswith(caught.value.message)


def test_only_angles_and_speeds_need_a_unit() -> None:
    assert [unit for unit in units._KINDS if needs_unit(unit)] == ["rad", "rad/s"]


def test_a_unit_without_a_name_is_a_quantity() -> None:
    assert speak("W/K") == "a quantity"
    assert to_si("2 kW/K", "W/K") == 2000


@pytest.mark.parametrize(
    ("text", "value"), [("5", 5), (" -1_000.5e-3 ", -1.0005), (".5", 0.5), ("5.", 5), ("+7", 7)]
)
def test_a_number_without_a_unit(text: str, value: float) -> None:
    assert to_si(text, "1") == value


@for_all("text", ["5 m", "five", "1e400", "1__0", "0x1F"])
def test_text_that_is_not_a_number_is_refused(text: str) -> None:
    with pytest.raises(Refusal):
        to_si(text, "1")


def test_common_spellings_load_no_unit_library() -> None:
    lines = [
        f"to_si('2.5 {spelling}', {unit!r})"
        for unit in units._COMMON
        for spelling in (unit, *units._COMMON[unit])
        if spelling != "1"
    ]
    program = [
        "import sys",
        "from torsion.units import to_si",
        *lines,
        "sys.exit('pint' in sys.modules)",
    ]
    assert subprocess.run([sys.executable, "-c", "\n".join(program)], check=False).returncode == 0


PIECES = st.sampled_from(
    [
        "1",
        "5",
        "1e3",
        "e",
        ".",
        "-",
        "+",
        "_",
        " ",
        "*",
        "**",
        "/",
        "(",
        ")",
        "^",
        "²",
        "⁻",
        "·",
        "°",
        "µ",
        "%",
        "inf",
        "N",
        "m",
        "kN",
        "Nm",
        "kg",
        "rad",
        "deg",
        "rpm",
        "degC",
        "K",
        "pi",
        "min",
        "s",
        "dimensionless",
        "99",
        ",",
        "\n",
    ]
)
TEXTS = st.text(ANY_CHARACTER, max_size=30) | st.lists(PIECES, max_size=12).map("".join)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    text=TEXTS | TEXTS.map(lambda text: "2 " + text), unit=st.sampled_from([*units._KINDS, "W/K"])
)
def test_any_text_is_a_finite_number_or_a_unit_fault(text: str, unit: str) -> None:
    try:
        value, stated = to_si(text, unit), ""
    except Refusal as fault:
        value, stated = 0.0, str(fault)
    assert math.isfinite(value)
    assert stated.isprintable()


@settings(max_examples=80, deadline=None, derandomize=True)
@given(value=st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_read_as_python_reads_it(value: float) -> None:
    assert to_si(repr(value), "1") == value
    assert to_si(f"{value!r} N*m", "N*m") == value
