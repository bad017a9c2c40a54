"""Every number that is reported of two discs and a coupling, found by the title of its column or its key in the JSON.

Expected values are those of the 2 x 2 equations, solved densely on a grid of speeds of our own.
"""

import io
import math
import re
from typing import Any

import numpy as np
import pytest
from rich.console import Console

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Table
from torsion.output.chapters import chapters
from torsion.output.document import document
from torsion.output.pages.terminal import show
from torsion.output.stored.results_json import results

J1, J2, STIFFNESS, VISCOUS = 2.0, 3.0, 120.0, 0.8
SPEED = np.linspace(3.0, 15.0, 12_001)  # rad/s
RPM = 30.0 / math.pi
FIXED = 0.4  # Hz
TEXT = """
name: two discs
operation: {speeds: {from: 3 rad/s, to: 15 rad/s, steps: 25}, rated: {speed: 12 rad/s, power: 120 W}}
train:
- motor: {name: drive, inertia: 2}
- coupling:
    {name: ring, stiffness: 120, viscous: 0.8, rated_torque: 30, vibratory_torque: 40, max_torque: 90, heat_limit: 50 W}
- propeller: {name: screw, inertia: 3, blades: 4}
excitations:
- {at: screw, order: 1, torque: 2}
- {at: screw, order: 2, torque: 1, phase: 40 deg}
- {at: drive, frequency: 0.4, torque: 0.5}
rules: [coupling-maker]
"""


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def rows_of(findings: Findings, caption: str) -> list[dict[str, str]]:
    """The rows of the table with that caption, by title; a title that comes again is `title (2)`."""
    table = next(
        block
        for block in chapters(findings, is_full=True)
        if isinstance(block, Table) and caption in block.caption
    )
    titles: list[str] = []
    for column in table.columns:
        again = sum(title.split(" (")[0] == column.title for title in titles)
        titles.append(f"{column.title} ({again + 1})" if again else column.title)
    return [dict(zip(titles, row, strict=True)) for row in table.rows]


def value(text: str) -> float:
    """A cell as a number."""
    mantissa, _, power = text.replace("−", "-").partition("·10")
    return float(mantissa) * 10.0 ** int(
        power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0
    )


def answer(w: np.ndarray, at_drive: complex, at_screw: complex) -> tuple[np.ndarray, np.ndarray]:
    """(speeds, 2) rad, and (speeds,) N m in the coupling."""
    k = STIFFNESS + 1j * w * VISCOUS
    matrix = np.array([[k - w**2 * J1, -k], [-k, k - w**2 * J2]]).transpose(2, 0, 1)
    angle = np.linalg.solve(matrix, np.array([at_drive, at_screw], dtype=complex)[:, None])[:, :, 0]
    return angle, k * (angle[:, 0] - angle[:, 1])


def lines() -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Of order 1, order 2 and the fixed frequency: rad/s, angles and torque."""
    fixed = np.full_like(SPEED, 2.0 * math.pi * FIXED)
    each = [
        (SPEED, 0.0, 2.0),
        (2.0 * SPEED, 0.0, np.exp(1j * math.radians(40.0))),
        (fixed, 0.5, 0.0),
    ]
    return [(w, *answer(w, a, b)) for w, a, b in each]


def together() -> tuple[np.ndarray, np.ndarray]:
    """(speeds,) largest and smallest of both orders together and the fixed frequency added by magnitude."""
    one, two, fixed = (torque for _, _, torque in lines())
    turn = np.exp(1j * np.linspace(0.0, 2.0 * math.pi, 1441))
    wave = (one[:, None] * turn + two[:, None] * turn**2).real
    return wave.max(axis=1) + np.abs(fixed), wave.min(axis=1) - np.abs(fixed)


def mean() -> np.ndarray:
    """(speeds,) N m by the law of a propeller, 120 W at 12 rad/s."""
    return 10.0 * (SPEED / 12.0) ** 2


def test_frequencies_and_their_bounds_in_json(found: Findings) -> None:
    modes = results(found)["modes"]
    exact = 10.0 / (2.0 * math.pi)
    assert modes["frequency_Hz"] == pytest.approx([exact], rel=1e-15)
    assert modes["lower_Hz"][0] <= exact <= modes["upper_Hz"][0]
    assert modes["lower_Hz"][0] < modes["upper_Hz"][0]
    assert modes["nodes"] == [1]
    assert modes["rigid_motions"] == 1
    ratio = modes["shape_rad"][0][0] / modes["shape_rad"][0][1]
    assert ratio == pytest.approx(-J2 / J1, rel=1e-13)
    assert modes["kinetic_share"][0] == pytest.approx([0.6, 0.4], rel=1e-13)
    assert modes["elastic_share"][0] == pytest.approx([1.0], rel=1e-13)
    assert modes["torque_Nm"][0][0] == pytest.approx(
        STIFFNESS * (modes["shape_rad"][0][0] - modes["shape_rad"][0][1]), rel=1e-13
    )


def test_bounds_of_a_frequency_in_its_table(found: Findings) -> None:
    (row,) = rows_of(found, "Natural frequencies of the undamped train")
    assert value(row["Frequency"]) == pytest.approx(10.0 / (2.0 * math.pi), rel=1e-6)
    assert value(row["Per minute"]) == pytest.approx(10.0 * RPM, rel=1e-6)
    assert value(row["Lower bound"]) <= value(row["Upper bound"])
    assert (row["Mode"], row["Nodes"]) == ("1", "1")


def test_damped_mode_in_json_and_in_its_table(found: Findings) -> None:
    reduced = J1 * J2 / (J1 + J2)
    ratio = VISCOUS / (2.0 * math.sqrt(STIFFNESS * reduced))
    damped = 10.0 * math.sqrt(1.0 - ratio**2) / (2.0 * math.pi)
    stated = results(found)["damped_modes"]
    assert stated["damping_ratio"] == pytest.approx([ratio], rel=1e-12)
    assert stated["frequency_Hz"] == pytest.approx([damped], rel=1e-12)
    assert stated["speed_rad_per_s"] == 12.0
    assert stated["eigenvalue_per_s"][0] == pytest.approx(
        [-10.0 * ratio, 2.0 * math.pi * damped], rel=1e-12
    )
    (row,) = rows_of(found, "Damped natural frequencies")
    assert value(row["Damping ratio"]) == pytest.approx(100.0 * ratio, rel=1e-3)
    assert value(row["Frequency"]) == pytest.approx(damped, rel=1e-5)


def test_critical_speeds_in_json_and_in_their_table(found: Findings) -> None:
    stated = {line["order"]: line for line in results(found)["critical_speeds"]}
    assert {order: line["speed_rad_per_s"] for order, line in stated.items()} == pytest.approx(
        {"1": 10.0, "2": 5.0}
    )
    assert [line["is_in_range"] for line in stated.values()] == [True, True]
    assert stated["2"]["margin"] == pytest.approx(5.0 / 12.0 - 1.0)
    rows = {row["Order"]: row for row in rows_of(found, "Critical speeds in the speed range")}
    for order, speed in (("1", 10.0), ("2", 5.0)):
        assert value(rows[order]["Critical speed"]) == pytest.approx(speed * RPM, rel=1e-4)
        assert value(rows[order]["Distance from rated"]) == pytest.approx(
            100.0 * (speed / 12.0 - 1.0), abs=0.06
        )
        assert value(rows[order]["Frequency"]) == pytest.approx(10.0 / (2.0 * math.pi), rel=1e-4)
        assert rows[order]["Mode"] == "1"


def test_response_in_json(found: Findings) -> None:
    stated = results(found)["response"]
    speed = np.array(stated["speed_rad_per_s"])
    assert speed[np.array(stated["is_asked"])] == pytest.approx(np.linspace(3.0, 15.0, 25))
    assert stated["station"] == [0, 1]
    forces = {"1": (0.0, 2.0), "2": (0.0, np.exp(1j * math.radians(40.0))), None: (0.5, 0.0)}
    for line in stated["lines"]:
        order = line["order"]
        w = speed * int(order) if order else np.full_like(speed, 2.0 * math.pi * FIXED)
        angle, torque = answer(w, *forces[order])
        np.testing.assert_allclose(line["frequency_Hz"], w / (2.0 * math.pi), rtol=1e-14)
        np.testing.assert_allclose(complex_of(line["angle_rad"]), angle, rtol=1e-10)
        np.testing.assert_allclose(complex_of(line["torque_Nm"])[:, 0], torque, rtol=1e-10)
        assert set(line["status"]) == {"ok"}
        assert max(line["residual"]) < 1e-13
    assert np.array(stated["mean_torque_Nm"])[:, 0] == pytest.approx(10.0 * (speed / 12.0) ** 2)


def complex_of(pairs: list[Any]) -> np.ndarray:
    values = np.array(pairs)
    return values[..., 0] + 1j * values[..., 1]


def at_speeds(speed: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.interp(speed, SPEED, values)


def test_synthesis_in_json(found: Findings) -> None:
    stated, speed = (
        results(found)["synthesis"],
        np.array(results(found)["response"]["speed_rad_per_s"]),
    )
    high, low = together()
    size = [np.abs(torque) for _, _, torque in lines()]
    assert stated["element"] == ["ring"]
    assert stated["common_cycle_turns"] == "1"
    wanted = {
        "half_range_Nm": (high - low) / 2.0,
        "peak_Nm": np.maximum(np.abs(mean() + high), np.abs(mean() + low)),
        "rms_Nm": np.sqrt(sum(one**2 for one in size) / 2.0),
        "bound_Nm": sum(size),
    }
    for key, values in wanted.items():
        np.testing.assert_allclose(stated[key][0], at_speeds(speed, values), rtol=2e-5, err_msg=key)


def test_largest_vibratory_torque_by_title(found: Findings) -> None:
    (row,) = rows_of(found, "Maximum vibratory torque of every component")
    high, low = together()
    half, size = (high - low) / 2.0, [np.abs(torque) for _, _, torque in lines()]
    at = int(np.argmax(half))
    wanted = {
        "Total vibratory torque": half[at],
        "Speed": SPEED[at] * RPM,
        "Torque of this order": size[0][at],
        "RMS": math.sqrt(sum(one[at] ** 2 for one in size) / 2.0),
        "Sum of magnitudes": sum(one[at] for one in size),
        "Mean": mean()[at],
    }
    assert {title: value(row[title]) for title in wanted} == pytest.approx(wanted, rel=2e-3)
    assert value(row["Total vibratory torque"]) == pytest.approx(half[at], rel=5e-5)
    assert (row["Component"], row["Largest order"]) == ("ring", "1 × screw")


def test_peaks_by_title(found: Findings) -> None:
    rows = {row["Order"]: row for row in rows_of(found, "Resonance peaks")}
    assert set(rows) == {"1 × screw", "2 × screw"}
    for name, (w, _, torque) in zip(("1 × screw", "2 × screw"), lines(), strict=False):
        at = int(np.argmax(np.abs(torque)))
        assert value(rows[name]["Torque amplitude"]) == pytest.approx(abs(torque[at]), rel=5e-5)
        assert value(rows[name]["Speed"]) == pytest.approx(SPEED[at] * RPM, rel=5e-4)
        assert value(rows[name]["Frequency"]) == pytest.approx(w[at] / (2.0 * math.pi), rel=5e-4)
        assert (rows[name]["Component"], rows[name]["Mode"]) == ("ring", "1")


def test_angles_by_title(found: Findings) -> None:
    """The largest amplitude of any one order with its speed, of each disc."""
    rows = {row["Station"]: row for row in rows_of(found, "Maximum angular amplitude")}
    for station, name in enumerate(("drive", "screw")):
        size = np.array([np.abs(angle[:, station]) for _, angle, _ in lines()])
        line, at = np.unravel_index(int(np.argmax(size)), size.shape)
        hertz = lines()[line][0][at] / (2.0 * math.pi)
        row = rows[name]
        assert value(row["Amplitude"]) == pytest.approx(size[line, at], rel=3e-4)
        assert value(row["Maximum amplitude"]) == pytest.approx(
            math.degrees(size[line, at]), rel=3e-4
        )
        assert value(row["Speed"]) == pytest.approx(SPEED[at] * RPM, rel=1e-3)
        assert value(row["Speed amplitude"]) == pytest.approx(
            60.0 * hertz * size[line, at], rel=1e-3
        )
        assert row["Order"] == "1 × screw"


def test_couplings_by_title(found: Findings) -> None:
    (row,) = rows_of(found, "Torque and power loss of the couplings")
    high, low = together()
    half, peak = (high - low) / 2.0, np.maximum(np.abs(mean() + high), np.abs(mean() + low))
    heat = sum(
        VISCOUS * np.abs(w * (angle[:, 0] - angle[:, 1])) ** 2 / 2.0 for w, angle, _ in lines()
    )
    wanted = {
        "Vibratory torque": half.max(),
        "T_{KW}": 40.0,
        "Mean torque": mean().max(),
        "T_{KN}": 30.0,
        "Peak torque": peak.max(),
        "T_{Kmax}": 90.0,
        "Power loss": heat.max(),
        "P_{KW}": 50.0,
    }
    assert {title: value(row[title]) for title in wanted} == pytest.approx(wanted, rel=1e-4)
    assert value(row["Speed"]) == pytest.approx(SPEED[half.argmax()] * RPM, rel=1e-3)
    assert value(row["Speed (2)"]) == pytest.approx(SPEED[heat.argmax()] * RPM, rel=1e-3)


def test_mean_torque_by_title_and_in_json(found: Findings) -> None:
    (row,) = rows_of(found, "Mean torque, each")
    wanted = {
        "Speed of the component": 12.0 * RPM,
        "Mean torque": 10.0,
        "Power": 0.12,
        "Maximum over the speed range": mean()[-1],
    }
    assert {title: value(row[title]) for title in wanted} == pytest.approx(wanted, rel=1e-4)
    stated = results(found)["mean"]
    assert np.array(stated["torque_Nm"])[0] == pytest.approx(
        10.0 * (np.array(stated["speed_rad_per_s"]) / 12.0) ** 2
    )
    np.testing.assert_allclose(np.array(stated["applied_Nm"]).sum(axis=0), 0.0, atol=1e-12)


def test_checks_of_the_coupling_in_json(found: Findings) -> None:
    stated = {check["clause"]: check for check in results(found)["checks"]}
    high, low = together()
    peak = np.maximum(np.abs(mean() + high), np.abs(mean() + low))
    heat = sum(
        VISCOUS * np.abs(w * (angle[:, 0] - angle[:, 1])) ** 2 / 2.0 for w, angle, _ in lines()
    )
    wanted = {
        "T_KN": (mean(), 30.0, "N m"),
        "T_KW": ((high - low) / 2.0, 40.0, "N m"),
        "P_KW": (heat, 50.0, "W"),
        "T_Kmax": (peak, 90.0, "N m"),
    }
    assert set(stated) == set(wanted)
    for clause, (values, limit, unit) in wanted.items():
        line = stated[clause]
        assert line["value"] == pytest.approx(values.max(), rel=1e-4)
        assert line["speed_rad_per_s"] == pytest.approx(SPEED[values.argmax()], rel=1e-3)
        assert (line["limit"], line["unit"], line["verdict"], line["where"]) == (
            limit,
            unit,
            "pass",
            "ring",
        )


def test_the_terminal_shows_the_same_numbers(found: Findings) -> None:
    stream = io.StringIO()
    show(document(found), None, Console(file=stream, width=120, color_system=None))
    text = stream.getvalue()
    high, low = together()
    half = (high - low) / 2.0
    (free,) = re.findall(r"^\D*1 +(\S+) +(\S+) +(\S+)\s*$", text, re.MULTILINE)[:1]
    damped = re.search(r"Damped.*?^\D*1 +(\S+) +(\S+)\s*$", text, re.MULTILINE | re.DOTALL).groups()
    ratio = VISCOUS / 24.0
    lower = 10.0 * math.sqrt(1 - ratio**2)
    assert [float(cell) for cell in free] == pytest.approx(
        [10.0 / (2.0 * math.pi), 10.0 * RPM, 1], rel=1e-6
    )
    assert [float(cell) for cell in damped] == pytest.approx(
        [lower / (2.0 * math.pi), 100 * ratio], rel=2e-3
    )
    torque = re.search(r"^\s*ring +(\S+) +(\S+)\s*$", text, re.MULTILINE)
    assert float(torque[1]) == pytest.approx(half.max(), rel=5e-5)
    assert float(torque[2]) == pytest.approx(SPEED[half.argmax()] * RPM, rel=1e-3)
    critical = re.findall(r"^\s*(\d+\.\d+) +([12]) +1 +\2 × screw\s*$", text, re.MULTILINE)
    assert [(float(n), order) for n, order in critical] == [
        (pytest.approx(5.0 * RPM, rel=1e-4), "2"),
        (pytest.approx(10.0 * RPM, rel=1e-4), "1"),
    ]


def test_a_peak_names_the_mode_it_belongs_to() -> None:
    """Three equal discs on two equal springs: 10 and 10 sqrt(3) rad/s."""
    text = """
name: three discs
operation: {speeds: {from: 5 rad/s, to: 25 rad/s, steps: 41}}
train:
- disc: {name: a, inertia: 1}
- coupling: {name: first, stiffness: 100, psi: 0.2}
- disc: {name: b, inertia: 1}
- coupling: {name: second, stiffness: 100, psi: 0.2}
- disc: {name: c, inertia: 1}
excitations: [{at: a, order: 1, torque: 1}]
"""
    rows = rows_of(torsion.run(torsion.parse(text)), "Resonance peaks")
    found = {
        (row["Component"], round(value(row["Speed"]) / RPM / 10.0, 1)): row["Mode"] for row in rows
    }
    assert found == {
        ("first", 1.0): "1",
        ("first", 1.7): "2",
        ("second", 1.0): "1",
        ("second", 1.7): "2",
    }


def test_schwanecke_damps_with_the_speed() -> None:
    """One disc on a held spring: damping ratio c/(2 sqrt(k J)), c = 0.0231 rho D^5 (P/D)^2 EAR n/pi, n in rad/s."""
    text = """
name: a propeller on a spring
operation: {rated: {speed: 12 rad/s}}
train:
- disc: {held: true}
- coupling: {stiffness: 4 kN*m/rad}
- propeller:
    {name: screw, inertia: 40, diameter: 1.5 m, pitch_ratio: 0.9, area_ratio: 0.6, damping: {model: schwanecke}}
"""
    damping = 0.0231 * 1025.0 * 1.5**5 * 0.9**2 * 0.6 * 12.0 / math.pi
    found = results(torsion.run(torsion.parse(text)))["damped_modes"]
    assert found["damping_ratio"] == pytest.approx(
        [damping / (2.0 * math.sqrt(4000.0 * 40.0))], rel=1e-12
    )
