"""The tutorial of two discs: every number is computed again, in closed form and by the program."""

import re
import runpy
from fractions import Fraction
from math import degrees, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.holzer import holzer
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings

TUTORIALS = Path(__file__).parents[1] / "docs" / "tutorials"
PAGE = (TUTORIALS / "two-discs-by-hand.md").read_text(encoding="utf-8")
PROSE = re.sub(r"^```.*?^```$", "", PAGE, flags=re.M | re.S)
SCENES = re.findall(r"^```yaml\n(.*?)^```", PAGE, re.M | re.S)
J1, J2, K, ETA, F = 0.8, 0.2, 14400.0, 0.1, 25.0
W0 = sqrt(K * (1 / J1 + 1 / J2))
DIAMETER = (32 * K * 1.0 / 80e9 / pi) ** 0.25
STATIC = -F * J1 / (J1 + J2)
RESONANT = STATIC * (1 - 1j / ETA)


def _torque(w: float) -> complex:
    """(A2) solved as two complex equations, without (A7)."""
    k = K * (1 + 1j * ETA)
    angle = np.linalg.solve(
        np.array([[k - w**2 * J1, -k], [-k, k - w**2 * J2]]), np.array([0.0, F])
    )
    return complex(k * (angle[0] - angle[1]))


def _holzer(w: float) -> tuple[float, float]:
    """Angle of the propeller and remainder."""
    angle = 1 - w**2 * J1 / K
    return angle, w**2 * (J1 + J2 * angle)


def _stiffness(w: float) -> tuple[float, float, float]:
    """z2, 1/k + 1/z2 and z1 of the paragraph on counting."""
    z = -(w**2) * J2
    h = 1 / K + 1 / z
    return z, h, 1 / h - w**2 * J1


LAMBDA = 1j * W0 * np.sqrt(1 + 1j * ETA)
PHASE = degrees(np.angle(RESONANT))
STATED = {
    "k = {:.0f} N m/rad": K,
    "{:.1f} mm": 1000 * DIAMETER,
    "ω₀² = {:.0f} 1/s²": W0**2,
    "ω₀ = {:.0f} rad/s": W0,
    "= {:.3f} Hz or": W0 / 2 / pi,
    "{:.1f} per minute": 30 * W0 / pi,
    "θ₂/θ₁ = {:.0f}": -J1 / J2,
    "at {:.1f} of the spring": J2 / (J1 + J2),
    "angles are {:.1f} and": 1 / sqrt(J1 + J2 * (J1 / J2) ** 2),
    "and {:.0f} rad, ": -J1 / J2 / sqrt(J1 + J2 * (J1 / J2) ** 2),
    "is {:.0f} N m.": K * (1 + J1 / J2) / sqrt(J1 + J2 * (J1 / J2) ** 2),
    "| motor | 0.8 | {0:.0f} | 1 | {0:.0f} | {0:.0f} |": W0**2 * J1,
    "| {:.0f} |\n": W0**2 * J1 / K,
    "| propeller | 0.2 | {:.0f} |": W0**2 * J2,
    "| {:.0f} | −72000 |": _holzer(W0)[0],
    "| {:.0f} | 0 | |": W0**2 * J2 * _holzer(W0)[0],
    "it is {:.0f} N m,": _holzer(200.0)[1],
    "320 rad/s {:.0f} N m;": _holzer(320.0)[1],
    "z₂ = {:.0f}, 1/k + 1/z₂ = −": _stiffness(200.0)[0],
    "= {:.4e} and": _stiffness(200.0)[1],
    "and z₁ = {:.0f}. By": _stiffness(200.0)[2],
    "z₂ = {:.0f}, 1/k + 1/z₂ = 2": _stiffness(320.0)[0],
    "1/z₂ = {:.4e} and": _stiffness(320.0)[1],
    "and z₁ = {:.0f}. Two freq": _stiffness(320.0)[2],
    "{:.1f} rpm of order 1": 30 * W0 / pi,
    "{:.1f} of order 2": 15 * W0 / pi,
    "{:.1f} of order 3": 10 * W0 / pi,
    "{:.1f} of order 4": 7.5 * W0 / pi,
    "(ψ = {:.3f})": 2 * pi * ETA,
    "static response is {:.0f} N m": STATIC,
    "the factor {:.2f}": sqrt(1 + ETA**-2),
    "t = {:.0f} + ": RESONANT.real,
    " + {:.0f}i N m": RESONANT.imag,
    "amplitude {:.1f} N m": abs(RESONANT),
    "phase {:.1f}°": PHASE,
    "carries {:.0f} N m": RESONANT.real,
    "= {:.0f} N m. The": (1j * RESONANT).real,
    "{:.1f} N/mm²": abs(RESONANT) * DIAMETER / (2 * pi * DIAMETER**4 / 32) / 1e6,
    "gives {:.1f} N m": abs(_torque(100 * pi)),
    "ratio {:.4f},": -LAMBDA.real / abs(LAMBDA),
    "at {:.3f} Hz (T22)": LAMBDA.imag / 2 / pi,
    "shaft has {:.0f} N m/rad": 4 * K,
    "{:.1f} N m.\n": 2 * abs(RESONANT),
    "branches of {:.0f} N m/rad": K / 2,
    "{:.2f} rad/s": sqrt(7200 / 0.1),
    "or {:.3f} Hz.": sqrt(7200 / 0.1) / 2 / pi,
    "At {:.1f} rpm t": 15 * W0 / pi,
    "critical at {:.1f} rpm": 15 * W0 / pi,
    "frequency is again {:.3f} Hz": W0 / 2 / pi,
    "inertia: {:.3f} Hz again": W0 / 2 / pi,
    "are {:.0f} N m/rad, 0.2": K,
    "inertia is {:.1f} kg m². It": J2 / 0.5**2,
}
GIVEN = set(
    re.findall(r"\S+", "0 0.1 0.2 0.8 1 2 3 4 25 50 60 80 200 300 320 1500 1800")
)  # data of the tutorial


def _words(text: str) -> str:
    return text.replace("-", "−").replace("e−0", "e-0")


@for_all("form", STATED)
def test_a_number_of_the_tutorial_is_that_of_the_closed_form(form: str) -> None:
    words = re.sub(r"−(?=\d)", "-", form).format(STATED[form])
    pattern = r"\s+".join(map(re.escape, _words(words).split(" ")))
    assert re.search(pattern, _words(PROSE)), words


def test_every_number_of_the_tutorial_is_computed_or_given() -> None:
    text = re.sub(r"\((?:A|T)\d+\)|\]\([^)]*\)|^    .*$", "", PROSE, flags=re.M)
    numbers = re.findall(r"(?<![\w./₀-₉])−?\d+(?:\.\d+)?(?:e-\d+)?", _words(text))
    known = {
        one
        for form, value in STATED.items()
        for one in re.findall(r"−?\d[\d.e-]*", _words(form.format(value)))
    }
    known = {one.rstrip(".") for one in known} | GIVEN
    assert len(numbers) > 80
    assert set(numbers) <= known, sorted(set(numbers) - known)


def _run(place: int) -> Findings:
    return torsion.run(torsion.parse(SCENES[place]))


@pytest.mark.parametrize("place", [0, 1], ids=["direct", "geared"])
def test_the_program_finds_mode_and_response_of_the_tutorial(place: int) -> None:
    study = torsion.parse(SCENES[place])
    findings = torsion.run(study)
    assert findings.need(Modes).frequency[0] == pytest.approx(W0 / 2 / pi, rel=1e-14)
    speeds = np.array([W0 / 2, 50 * pi])
    response = torsion.response(study, findings.system, speeds=speeds)
    slow = int(
        np.argmax(np.abs(response.torque[0, 0]))
    )  # of gear and shaft the shaft behind it: twice the torque
    rows = [int(np.argmin(np.abs(response.speed - one))) for one in speeds]
    spans = response.torque[rows, 0, slow] * (0.5 if place else 1.0)
    assert spans[0] == pytest.approx(RESONANT, rel=1e-12)
    assert spans[1] == pytest.approx(_torque(100 * pi), rel=1e-12)
    assert response.lines[0].order == Fraction(2)
    assert findings.need(CriticalSpeeds).crossings[0].speed == pytest.approx(W0 / 2, rel=1e-12)
    assert findings.need(DampedModes).frequency[0] == pytest.approx(LAMBDA.imag / 2 / pi, rel=1e-12)
    assert findings.need(DampedModes).damping_ratio[0] == pytest.approx(
        -LAMBDA.real / abs(LAMBDA), rel=1e-10
    )


def test_the_program_finds_the_shape_and_the_table_of_the_tutorial() -> None:
    findings = _run(0)
    assert findings.need(Modes).shape[:, 0] == pytest.approx([-0.5, 2.0], rel=1e-14)
    assert findings.need(Modes).torque[0, 0] == pytest.approx(-36000.0, rel=1e-14)
    table = holzer(findings.system, findings.need(Modes), 0)
    assert table.angle == pytest.approx([1.0, -4.0], rel=1e-14)
    assert table.inertia_torque == pytest.approx([72000.0, -72000.0], rel=1e-14)
    assert table.torque_in[1] == table.torque_out[1] == pytest.approx(72000.0, rel=1e-14)
    assert table.twist[1] == pytest.approx(5.0, rel=1e-14)


def test_the_program_finds_both_modes_of_equal_branches() -> None:
    findings = _run(2)
    expected = [sqrt(72000.0) / 2 / pi, W0 / 2 / pi]
    assert findings.need(Modes).frequency == pytest.approx(expected, rel=1e-14)
    assert findings.need(Modes).shape[0, 0] == pytest.approx(0.0, abs=1e-12)


def test_the_inertia_of_the_shaft_is_below_one_percent_of_the_smaller_disc() -> None:
    assert 7850 * pi * DIAMETER**4 / 32 < 0.01 * J2


def test_equations_of_the_tutorial_are_numbered_without_gaps() -> None:
    numbers = [int(one) for one in re.findall(r"\S +\(A(\d+)\)$", PAGE, re.M)]
    assert numbers == list(range(1, len(numbers) + 1))


def test_the_figure_is_the_one_that_its_script_draws() -> None:
    script = runpy.run_path(str(TUTORIALS / "two_discs.py"))
    assert (TUTORIALS / "two_discs.svg").read_text(encoding="utf-8") == script["figure"]()
    for speed in (400.0, 15 * W0 / pi, 1500.0):
        assert script["spring_torque"](speed) == pytest.approx(
            abs(_torque(speed * pi / 15)), rel=1e-12
        )
