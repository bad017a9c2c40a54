"""The tables of a geared train by title: own and referred figures, order by order, against dense equations.

Four discs, referred to the first: 2, 0.5, 1.5/2.5^2 and 14/2.5^2 kg m2 on 300, 4000 and 800/2.5^2 N m/rad.
"""

import math
from fractions import Fraction

import numpy as np
import pytest

import torsion
from torsion.analyses.system_data import SystemData
from torsion.findings import Findings
from torsion.output.blocks import Table
from torsion.output.chapters import chapters

TEXT = """
name: four referred discs
operation: {speeds: {from: 5 rad/s, to: 40 rad/s, steps: 36}, rated: {speed: 30 rad/s, power: 1.2 kW}}
train:
- disc: {name: flywheel, inertia: 2}
- coupling: {name: soft, stiffness: 300, psi: 0.5}
- gear: {name: stage, ratio: 5/2, inertia: [0.5, 1.5], mesh_stiffness: 4 kN*m/rad}
- coupling: {name: stiff, stiffness: 800, loss_factor: 0.05, vibratory_torque: 500}
- propeller:
    {name: screw, inertia: 12, entrained: 2, blades: 4, damping: 3, excitation: [{blade_order: 1, torque: 5 %}]}
excitations: [{at: flywheel, order: 1/2, torque: 3, phase: 30 deg}]
"""
RPM = 30.0 / math.pi
RATIO = np.array([1.0, 1.0, 0.4, 0.4])  # speed of each disc
INERTIA = np.array([2.0, 0.5, 1.5, 14.0])
STIFFNESS = np.array([300.0, 4000.0, 800.0])  # at the speed of the driving side
ETA = np.array([0.5 / (2.0 * math.pi), 0.0, 0.05])
SPAN_RATIO = np.array([1.0, 1.0, 0.4])
B = np.array(
    [[1.0, -1.0, 0.0, 0.0], [0.0, 1.0, -1.0, 0.0], [0.0, 0.0, 1.0, -1.0]]
)  # twists, referred
SPEED = np.linspace(5.0, 40.0, 3_501)  # rad/s
SPANS, STATIONS = ("soft", "stage", "stiff"), ("flywheel", "soft end", "stage end", "screw")


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def rows_of(findings: Findings, caption: str) -> dict[str, dict[str, str]]:
    """The rows of the table with that caption, by title, under what their first column of words says."""
    table = next(
        block
        for block in chapters(findings)
        if isinstance(block, Table) and caption in block.caption
    )
    titles = [column.title for column in table.columns]
    name = 1 if titles[0] == "No." else 0
    return {row[name]: dict(reversed(list(zip(titles, row, strict=True)))) for row in table.rows}


def value(text: str) -> float:
    """A cell as a number; 0 where it is blank."""
    mantissa, _, power = (text or "0").replace("−", "-").removesuffix(" *").partition("·10")
    return float(mantissa) * 10.0 ** int(
        power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0
    )


def unit_of(findings: Findings, caption: str, title: str) -> float:
    """What a cell of the column is multiplied with."""
    table = next(
        block
        for block in chapters(findings)
        if isinstance(block, Table) and caption in block.caption
    )
    unit = next(column.unit for column in table.columns if column.title == title)
    return 1e3 if unit.startswith("kN") else 1.0


def referred() -> tuple[np.ndarray, np.ndarray]:
    """Inertia (4,) and stiffness (3,) at the speed of the flywheel."""
    return INERTIA * RATIO**2, STIFFNESS * SPAN_RATIO**2


def modes() -> tuple[np.ndarray, np.ndarray]:
    """(3,) rad/s and (4, 3) referred shapes."""
    inertia, stiffness = referred()
    root = np.sqrt(inertia)
    square, vector = np.linalg.eigh(B.T @ np.diag(stiffness) @ B / np.outer(root, root))
    return np.sqrt(square[1:]), (vector / root[:, None])[:, 1:]


def torques() -> np.ndarray:
    """(orders 1/2 and 8/5, speeds, spans) N m, each at its own speed."""
    inertia, stiffness = referred()
    complex_stiffness = B.T @ np.diag(stiffness * (1.0 + 1j * ETA)) @ B
    ground = np.diag([0.0, 0.0, 0.0, 3.0 * 0.4**2])
    mean = 100.0 * (SPEED / 30.0) ** 2  # 1.2 kW at 12 rad/s of the screw, law of a propeller
    each = []
    for order, at, force in (
        (0.5, 0, 3.0 * np.exp(1j * math.pi / 6.0)),
        (1.6, 3, 0.05 * mean * 0.4),
    ):
        w = (order * SPEED)[:, None, None]
        load = np.zeros((len(SPEED), 4, 1), dtype=complex)
        load[:, at, 0] = force
        q = np.linalg.solve(complex_stiffness - w**2 * np.diag(inertia) + 1j * w * ground, load)[
            :, :, 0
        ]
        each.append((q @ B.T) * SPAN_RATIO * STIFFNESS * (1.0 + 1j * ETA))
    return np.array(each)


def half_range() -> np.ndarray:
    """(speeds, spans) N m of both orders together: 5 and 16 per ten turns, which have all phases."""
    one, two = torques()
    turn = np.linspace(0.0, 2.0 * math.pi, 2001)
    both = np.empty(one.shape)
    for k in range(one.shape[1]):
        wave = np.real(one[:, k, None] * np.exp(5j * turn) + two[:, k, None] * np.exp(16j * turn))
        both[:, k] = (wave.max(axis=1) - wave.min(axis=1)) / 2.0
    return both


def test_inertias_and_stiffnesses_own_and_referred(found: Findings) -> None:
    inertia, stiffness = referred()
    discs, springs = found.need(SystemData).inertias, rows_of(found, "Elastic elements")
    kilo = (
        unit_of(found, "Elastic elements", "k own"),
        unit_of(found, "Elastic elements", "k referred"),
    )
    for k, name in enumerate(STATIONS):
        rows = [row for row in discs if row.station == name]
        assert sum(row.inertia for row in rows) == pytest.approx(INERTIA[k], rel=1e-14)
        assert sum(row.referred for row in rows) == pytest.approx(inertia[k], rel=1e-14)
        assert {row.ratio for row in rows} == {{1.0: 1, 0.4: Fraction(2, 5)}[RATIO[k]]}
    for k, name in enumerate(SPANS):
        row = springs[name]
        assert value(row["k own"]) * kilo[0] == pytest.approx(STIFFNESS[k], rel=1e-5)
        assert value(row["k referred"]) * kilo[1] == pytest.approx(stiffness[k], rel=1e-5)
        assert (row["From"], row["To"]) == (STATIONS[k], STATIONS[k + 1])
        assert row["i"] == {1.0: "1", 0.4: "2/5"}[SPAN_RATIO[k]]


def test_frequencies_shares_and_holzer_tables(found: Findings) -> None:
    w, shape = modes()
    inertia, stiffness = referred()
    kinetic = inertia[:, None] * shape**2
    elastic = stiffness[:, None] * (B @ shape) ** 2
    shares = rows_of(found, "Shares of the kinetic")
    for mode in range(3):
        row = rows_of(found, "Natural frequencies of the undamped train")[str(mode + 1)]
        assert value(row["Frequency"]) == pytest.approx(w[mode] / (2.0 * math.pi), rel=1e-6)
        assert int(row["Nodes"]) == mode + 1
        for what, names, energy in (("kinetic", STATIONS, kinetic), ("elastic", SPANS, elastic)):
            cells = [shares[f"{what}: {name}"][f"Mode {mode + 1}"] for name in names]
            stated = [0.0 if cell == "–" else value(cell) for cell in cells]
            wanted = 100.0 * energy[:, mode] / energy[:, mode].sum()
            wanted = np.where(wanted < 2.0, 0.0, wanted)
            assert stated == pytest.approx(wanted.tolist(), rel=1e-2)
    for mode in (0, 1):
        table = rows_of(found, f"Holzer table of mode {mode + 1}")
        angle = shape[:, mode] / shape[0, mode]
        twist = B @ angle
        for k, name in enumerate(STATIONS):
            row = table[name]
            assert value(row["J referred"]) == pytest.approx(inertia[k], rel=1e-4)
            assert value(row["Angle"]) == pytest.approx(angle[k], rel=1e-5)
            assert value(row["ω² J × angle"]) == pytest.approx(
                w[mode] ** 2 * inertia[k] * angle[k], rel=1e-4
            )
            if k:
                assert row["Through"] == SPANS[k - 1]
                assert row["Torque in"] == row["Torque out"]
                assert value(row["Torque in"]) == pytest.approx(
                    stiffness[k - 1] * twist[k - 1], rel=2e-4
                )
                assert value(row["Flexibility"]) == pytest.approx(1.0 / stiffness[k - 1], rel=1e-4)
                assert value(row["Twist"]) == pytest.approx(twist[k - 1], rel=2e-4)


def test_critical_speeds_by_order_and_mode(found: Findings) -> None:
    w, _ = modes()
    table = {
        row["Excited by"]: row for row in rows_of(found, "Critical speeds, order by mode").values()
    }
    inside = rows_of(found, "Critical speeds in the speed range")
    for text, order, source in (
        ("0.5", 0.5, "0.5 × flywheel"),
        ("1.6", 1.6, "4 × screw (1.6 of flywheel)"),
    ):
        name = table[source]
        assert name["Order"] == text
        for mode in range(3):
            cell, speed = name[f"Mode {mode + 1}"], w[mode] / order
            assert value(cell) == pytest.approx(speed * RPM, rel=1e-4)
            assert (cell in inside) == (5.0 <= speed <= 40.0)
            if cell in inside:
                row = inside[cell]
                assert (row["Order"], row["Mode"], row["Excited by"]) == (
                    text,
                    str(mode + 1),
                    source,
                )
                assert value(row["Distance from rated"]) == pytest.approx(
                    100.0 * (speed / 30.0 - 1.0), abs=0.06
                )


def test_what_excites_and_what_damps(found: Findings) -> None:
    torque = rows_of(found, "Harmonic torques")
    assert (torque["screw"]["Order, own shaft"], torque["screw"]["Order, reference"]) == (
        "4",
        "1.6",
    )
    assert (torque["flywheel"]["Order, reference"], torque["flywheel"]["Phase"]) == ("0.5", "30")
    assert value(torque["screw"]["Share of mean torque"]) == 5.0
    assert value(torque["flywheel"]["Amplitude"]) == 3.0
    springs = rows_of(found, "Elastic elements")
    for k, name in ((0, "soft"), (2, "stiff")):
        assert value(springs[name]["Loss factor η"]) == pytest.approx(ETA[k], rel=1e-4)


def test_mean_torques_at_rated_speed_and_their_largest(found: Findings) -> None:
    table = rows_of(found, "Mean torque, each")
    for name, ratio in zip(SPANS, SPAN_RATIO, strict=True):
        wanted = {
            "Speed of the component": 30.0 * ratio * RPM,
            "Mean torque": 40.0 / ratio,
            "Power": 1.2,
            "Maximum over the speed range": 40.0 / ratio * (40.0 / 30.0) ** 2,
        }
        assert {title: value(table[name][title]) for title in wanted} == pytest.approx(
            wanted, rel=1e-4
        )


def test_vibratory_torques_of_elements_meshes_and_couplings(found: Findings) -> None:
    half, parts = half_range(), np.abs(torques())
    worst = rows_of(found, "Maximum vibratory torque of every component")
    for k, name in enumerate(SPANS):
        at = int(half[:, k].argmax())
        mean = 40.0 / SPAN_RATIO[k] * (SPEED[at] / 30.0) ** 2
        row = worst[name]
        assert value(row["Total vibratory torque"]) == pytest.approx(half[at, k], rel=2e-4)
        size = parts[:, at, k]
        wanted = {
            "Speed": SPEED[at] * RPM,
            "Torque of this order": size[0],
            "Sum of magnitudes": size.sum(),
            "RMS": math.hypot(*size) / math.sqrt(2.0),
            "Mean": mean,
        }
        assert {title: value(row[title]) for title in wanted} == pytest.approx(wanted, rel=3e-3)
        assert row["Largest order"] == "0.5 × flywheel"
    mesh = rows_of(found, "mean torque in the meshes")["stage"]
    at, ratio = int(half[:, 1].argmax()), half[:, 1] / (40.0 * (SPEED / 30.0) ** 2)
    assert value(mesh["Maximum vibratory torque"]) == pytest.approx(half[at, 1], rel=2e-4)
    assert value(mesh["Mean torque"]) == pytest.approx(40.0 * (SPEED[at] / 30.0) ** 2, rel=3e-3)
    assert value(mesh["Maximum vibratory / mean"]) == pytest.approx(ratio.max(), rel=1e-3)
    reverses = SPEED[ratio > 1.0] * RPM
    assert [value(mesh["From"]), value(mesh["To"])] == pytest.approx(
        [reverses[0], reverses[-1]], rel=5e-3
    )
    heat = rows_of(found, "Torque and power loss of the couplings")
    for k, name in ((0, "soft"), (2, "stiff")):
        w = np.array([0.5, 1.6])[:, None] * SPEED
        lost = (w * ETA[k] * parts[:, :, k] ** 2 / (STIFFNESS[k] * (1.0 + ETA[k] ** 2)) / 2.0).sum(
            axis=0
        )
        assert value(heat[name]["Power loss"]) == pytest.approx(lost.max(), rel=3e-4)
        assert value(heat[name]["Vibratory torque"]) == pytest.approx(half[:, k].max(), rel=2e-4)
        assert value(heat[name]["Mean torque"]) == pytest.approx(
            40.0 / SPAN_RATIO[k] * (4.0 / 3.0) ** 2, rel=1e-4
        )
