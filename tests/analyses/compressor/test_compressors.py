"""Compressors: torque of their p-V diagrams, exactly, in a train that is solved beside by dense matrices; faults."""

import math
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import eigh
from scipy.optimize import brentq
from tests.contracts.frozen import solved as solved_scene
from tests.for_all import for_all

import torsion
from torsion.analyses.compressor.compressors import CompressorFound, Compressors
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.kernels.engine.crank_slider import CrankSlider
from torsion.kernels.engine.pressure_cycles import angle_of_travel

SCENE = Path(__file__).parents[3] / "shafting_specs" / "reciprocating_compressor.yaml"
STROKE, ROD, AROUND, ORDERS = 0.18, 0.43, 101325.0, 12
RPM = math.pi / 30.0


@dataclass(frozen=True)
class End:
    """One working side of a piston of the scene."""

    file: str
    bore: float
    rod: float
    clearance: float
    suction: float
    discharge: float
    sense: int  # 1: head end

    @property
    def area(self) -> float:
        return math.pi / 4.0 * (self.bore**2 - self.rod**2)

    @property
    def swept(self) -> float:
        return self.area * STROKE


STAGES = ((0.400, 1.0e5, 3.2e5), (0.235, 3.1e5, 10.2e5))
ENDS = [
    End(
        f"reciprocating_compressor_{stage}_{side}.csv",
        bore,
        rod,
        clearance,
        suction,
        discharge,
        sense,
    )
    for stage, (bore, suction, discharge) in enumerate(STAGES, 1)
    for side, rod, clearance, sense in (("head", 0.0, 0.10, 1), ("crank", 0.06, 0.12, -1))
]


def ideal(end: End, exponent: float = 1.35, points: int = 25) -> tuple[FloatArray, FloatArray]:
    """Volumes (m3) and pressures (Pa): polytropic re-expansion, suction, polytropic compression, discharge."""
    least, whole = end.clearance * end.swept, (1.0 + end.clearance) * end.swept
    ratio = (end.discharge / end.suction) ** (1.0 / exponent)
    out, back = (
        np.geomspace(least, least * ratio, points),
        np.geomspace(whole, whole / ratio, points),
    )
    expands, compresses = (
        end.discharge * (least / out) ** exponent,
        end.suction * (whole / back) ** exponent,
    )
    volume = np.concatenate([out, back, [least]])
    return volume, np.concatenate([expands, compresses, [end.discharge]])


def rows(end: End) -> FloatArray:
    """(rows, 2) of its file, m3 and Pa."""
    return np.loadtxt(SCENE.parent / end.file, delimiter=",", skiprows=1) * [1e-3, 1e5]


def away(angle: float) -> float:
    """m, travel of the piston from its outer dead centre: by the lengths of crank and rod, nothing of the program."""
    radius = STROKE / 2.0
    return (
        radius
        + ROD
        - (radius * math.cos(angle) + math.sqrt(ROD**2 - (radius * math.sin(angle)) ** 2))
    )


def lever(angle: float) -> float:
    """m, derivative of the travel by the angle."""
    radius = STROKE / 2.0
    along = math.sqrt(ROD**2 - (radius * math.sin(angle)) ** 2)
    return radius * math.sin(angle) * (1.0 + radius * math.cos(angle) / along)


def turned(travel: float, *, back: bool) -> float:
    """Crank angle of a travel, by bisection."""
    if travel <= 0 or travel >= STROKE:
        return (2.0 * math.pi if back else 0.0) if travel <= 0 else math.pi
    ends = (math.pi, 2.0 * math.pi) if back else (0.0, math.pi)
    return float(brentq(lambda angle: away(angle) - travel, *ends, xtol=1e-15, rtol=1e-15))


@cache
def pieces(end: End) -> tuple[tuple[float, float, float, float], ...]:
    """Straight pieces of the pressure of its file: from and to an angle (rad), from and to a pressure (Pa)."""
    volume, pressure = rows(end).T
    share = (volume - volume.min()) / (volume.max() - volume.min())
    turn = int(volume.argmax())
    travel = share * STROKE if end.sense > 0 else (1.0 - share) * STROKE
    found = []
    for place in range(len(volume)):
        rises = place <= turn
        back = (not rises) if end.sense > 0 else rises
        angle = turned(float(travel[place]), back=back)
        found.append((angle % (2.0 * math.pi), float(pressure[place])))
    found = sorted(found[:-1])
    first, last = found[0], found[-1]
    if first[0] > 0:
        share = (2.0 * math.pi - last[0]) / (first[0] + 2.0 * math.pi - last[0])
        found.insert(0, (0.0, last[1] + share * (first[1] - last[1])))
    found.append((2.0 * math.pi, found[0][1]))
    return tuple((a, b, p, q) for (a, p), (b, q) in pairwise(found))


@cache
def harmonic(end: End, order: int) -> complex:
    """N m of the gas of an end: C_n = (1/pi) int T exp(-i n angle), C_0 the mean; piece by piece, adaptively."""
    whole = 0j
    for a, b, p, q in pieces(end):

        def torque(angle: float, a: float = a, b: float = b, p: float = p, q: float = q) -> float:
            pressure = p + (q - p) * (angle - a) / (b - a) - AROUND
            return end.sense * pressure * end.area * lever(angle)

        for part, weight in ((math.cos, 1.0), (math.sin, -1j)):
            whole += (
                weight
                * quad(lambda angle: torque(angle) * part(order * angle), a, b, epsabs=1e-12)[0]  # noqa: B023
            )
    return whole / (2.0 * math.pi if order == 0 else math.pi)


@cache
def masses(order: int, mass: float) -> complex:
    """N m s2: of -m x' x'', by adaptive quadrature of -(m/2) d(x'^2)/dangle, integrated by parts."""
    square = (
        quad(lambda a: lever(a) ** 2 * math.cos(order * a), 0.0, 2.0 * math.pi, epsabs=1e-15)[0]
        / math.pi
    )
    return -0.5j * order * mass * square


@pytest.fixture(scope="module")
def found() -> Findings:
    return solved_scene("reciprocating_compressor")


@pytest.fixture(scope="module")
def compressor(found: Findings) -> CompressorFound:
    return found.need(Compressors).each[0]


@pytest.mark.parametrize("end", ENDS, ids=lambda end: end.file)
def test_the_files_are_the_ideal_cycle_to_their_digits(end: End) -> None:
    volume, pressure = ideal(end)
    np.testing.assert_allclose(rows(end)[:, 0], volume, atol=0.6e-9)
    np.testing.assert_allclose(rows(end)[:, 1], pressure, atol=0.06)


@pytest.mark.parametrize("throw", [0, 1])
def test_harmonics_of_a_throw_are_those_of_an_adaptive_quadrature(
    throw: int, compressor: CompressorFound
) -> None:
    own = compressor.throws[throw]
    wanted = np.array(
        [
            sum(harmonic(end, n) for end in ENDS[2 * throw : 2 * throw + 2])
            for n in range(ORDERS + 1)
        ]
    )
    largest = np.abs(wanted).max()
    np.testing.assert_allclose(own.mean_torque, -wanted[0].real, rtol=1e-10)
    np.testing.assert_allclose([one.gas for one in own.harmonics], wanted[1:], atol=1e-10 * largest)
    speed = 742.0 * RPM
    inertia = [masses(n, 128.0) * speed**2 for n in range(1, ORDERS + 1)]
    np.testing.assert_allclose(
        [one.masses for one in own.harmonics], inertia, atol=1e-10 * np.abs(inertia).max()
    )
    total = wanted[1:] + inertia
    np.testing.assert_allclose(
        [one.total for one in own.harmonics], total, atol=1e-10 * np.abs(total).max()
    )
    power = [-harmonic(end, 0).real * speed for end in ENDS[2 * throw : 2 * throw + 2]]
    np.testing.assert_allclose([one.power for one in own.ends], power, rtol=1e-9)


def test_the_torque_absorbed_is_the_work_of_the_ideal_cycle(compressor: CompressorFound) -> None:
    """W = n/(n - 1) p_s V_drawn (r^((n-1)/n) - 1); straight pieces over the angle are 2e-4 beside its curves."""
    for end, mine in zip(
        ENDS, [one for throw in compressor.throws for one in throw.ends], strict=True
    ):
        ratio, n = end.discharge / end.suction, 1.35
        drawn = end.swept * (1.0 + end.clearance - end.clearance * ratio ** (1.0 / n))
        work = n / (n - 1.0) * end.suction * drawn * (ratio ** ((n - 1.0) / n) - 1.0)
        assert mine.imep * end.swept == pytest.approx(work, rel=1e-3)
        assert mine.clearance == pytest.approx(end.clearance, rel=1e-6)


def dense(speed: float, stiffness: float = 16e3) -> tuple[ComplexArray, FloatArray]:
    """(orders, spans) N m at a speed of the scene by full matrices written out here, and natural frequencies (Hz)."""
    mean = (
        0.5
        * 128.0
        * 2.0
        * quad(lambda a: lever(a) ** 2, 0.0, 2.0 * math.pi, epsabs=1e-15)[0]
        / (2.0 * math.pi)
    )
    inertia = np.array([9.5 + 0.8, 0.8 + 12.0, 1.4 + mean, 1.4 + mean])
    springs, loss = np.array([stiffness, 6e6, 5e6]), np.array([1.0 / (2.0 * math.pi), 0.01, 0.01])
    between = np.array([[1.0, -1.0, 0, 0], [0, 1.0, -1.0, 0], [0, 0, 1.0, -1.0]])
    frequency = np.sqrt(
        np.abs(eigh(between.T @ np.diag(springs) @ between, np.diag(inertia))[0][1:])
    ) / (2 * math.pi)
    answers = []
    for n in range(1, ORDERS + 1):
        w = n * speed
        force = np.zeros(4, dtype=complex)
        for throw in (0, 1):
            gas = sum(harmonic(end, n) for end in ENDS[2 * throw : 2 * throw + 2])
            force[2 + throw] = gas + masses(n, 128.0) * speed**2
        matrix = between.T @ np.diag(springs * (1.0 + 1j * loss)) @ between - w**2 * np.diag(
            inertia
        )
        matrix = matrix + 1j * w * np.diag([0.0, 0.0, 4.0, 4.0])
        twist = between @ np.linalg.solve(matrix, force)
        answers.append(springs * (1.0 + 1j * loss) * twist)
    return np.array(answers), frequency


@pytest.mark.parametrize("rpm", [700.0, 742.0, 752.0])
def test_the_train_answers_as_dense_matrices(rpm: float, found: Findings) -> None:
    response = found.need(Response)
    at = int(np.argmin(np.abs(response.speed - rpm * RPM)))
    wanted, frequency = dense(float(response.speed[at]))
    assert response.speed[at] == pytest.approx(rpm * RPM, rel=1e-3)
    np.testing.assert_allclose(found.need(Modes).frequency, frequency, rtol=1e-9)
    np.testing.assert_allclose(response.torque[at], wanted, atol=1e-9 * np.abs(wanted).max())
    angle = np.linspace(0.0, 2.0 * math.pi, 20001)
    wave = np.real(np.exp(1j * np.outer(angle, np.arange(1, ORDERS + 1))) @ wanted)
    np.testing.assert_allclose(
        found.need(Synthesis).half_range[at], np.ptp(wave, axis=0) / 2.0, rtol=2e-5
    )


def test_the_mean_torque_leaves_at_the_throws_in_proportion_to_their_work(
    found: Findings, compressor: CompressorFound
) -> None:
    steady = found.need(Steady)
    motor = 140.6e3 / (742.0 * RPM)
    np.testing.assert_allclose(steady.torque[0], motor, rtol=1e-12)
    shares = np.array([throw.mean_torque for throw in compressor.throws]) / compressor.indicated
    np.testing.assert_allclose(steady.applied[2:, 0], -motor * shares, rtol=1e-12)
    assert compressor.mean_torque == pytest.approx(motor, rel=1e-12)
    assert compressor.needed == pytest.approx(compressor.indicated / 0.94, rel=1e-14)
    assert compressor.needed == pytest.approx(motor, rel=5e-4)


def test_half_load_takes_the_crank_ends_alone() -> None:
    case = torsion.read(SCENE).cases["half load"]
    own = torsion.run(case).need(Compressors).each[0]
    wanted = -sum(harmonic(end, 0).real for end in ENDS if end.sense < 0)
    assert own.indicated == pytest.approx(wanted, rel=1e-10)
    assert own.needed * 742.0 * RPM == pytest.approx(67.5e3, rel=2e-3)


def test_the_angle_of_a_travel_gives_the_travel_back() -> None:
    crank = CrankSlider(STROKE / 2.0, ROD)
    angle = np.concatenate([np.geomspace(1e-9, 1.0, 50), np.linspace(1.0, math.pi, 50), [0.0]])
    again = angle_of_travel(crank, np.array([exactly(one) for one in angle.tolist()]))
    np.testing.assert_allclose(again, angle, rtol=1e-13, atol=2e-8)


def exactly(angle: float) -> float:
    """m, the travel without the difference of two lengths."""
    radius, half = STROKE / 2.0, math.sin(angle / 2.0) ** 2
    across = (radius * math.sin(angle)) ** 2
    return 2.0 * radius * half + across / (ROD + math.sqrt(ROD**2 - across))


TRAIN = """
name: one throw
operation: {speeds: {from: 700 rpm, to: 750 rpm, steps: 2}, rated: {speed: 742 rpm, power: 35 kW}, load: constant}
train:
- motor: {name: motor, inertia: 9}
- coupling: {stiffness: 16 kN*m/rad, psi: 1}
- compressor:
    name: compressor
    stroke: 180 mm
    rod_length: 430 mm
    absolute: true
    inertia: 4
    KEYS
    throws: [{angle: 0 deg, bore: 400 mm, piston_rod: 60 mm, SIDES}]
analyses: {modes: , response: }
"""


def solved(
    folder: Path, sides: str, keys: str = "orders: 12", text: str = TRAIN
) -> CompressorFound:
    (folder / "scene.yaml").write_text(
        text.replace("SIDES", sides).replace("KEYS", keys), encoding="utf-8"
    )
    return torsion.run(torsion.read(folder / "scene.yaml")).need(Compressors).each[0]


def faults(folder: Path, sides: str, keys: str = "orders: 12", text: str = TRAIN) -> str:
    with pytest.raises(InputError) as error:
        solved(folder, sides, keys, text)
    return str(error.value)


def write(folder: Path, head: str, values: FloatArray, name: str = "p.csv") -> None:
    text = "\n".join([head, *(f"{a!r}, {p!r}" for a, p in values.tolist())])
    (folder / name).write_text(text + "\n", encoding="utf-8")


@pytest.mark.parametrize("end", ENDS[:2], ids=["head end", "crank end"])
def test_volume_travel_stroke_and_angle_say_the_same(end: End, tmp_path: Path) -> None:
    """Gauge pressures too, and rows that begin anywhere on the loop."""
    data = rows(end)
    share = (data[:, 0] - data[:, 0].min()) / np.ptp(data[:, 0])
    key = "head_end" if end.sense > 0 else "crank_end"
    rolled = np.roll(data[:-1], 20, axis=0)
    rolled = np.concatenate([rolled, rolled[:1]])
    tables = {
        "volume [m3], pressure [Pa]": data,
        "travel [mm], pressure [bar]": np.column_stack([share * 180.0, data[:, 1] / 1e5]),
        "stroke [%], pressure [bar]": np.column_stack([share * 100.0, data[:, 1] / 1e5]),
        "volume [dm3], p [MPa]": rolled * [1e3, 1e-6],
    }
    corners = np.array(
        [(a, p) for a, _, p, _ in pieces(end)] + [(2.0 * math.pi, pieces(end)[0][2])]
    )
    tables["angle [deg], pressure [bar]"] = corners * [180.0 / math.pi, 1e-5] + [90.0, 0.0]
    wanted = np.array([harmonic(end, n) for n in range(1, ORDERS + 1)])
    for head, values in tables.items():
        write(tmp_path, head, values, f"{len(head)}{key}.csv")
        own = solved(tmp_path, f"{key}: {len(head)}{key}.csv", "tdc: 90 deg").throws[0]
        gas = np.array([one.gas for one in own.harmonics])
        np.testing.assert_allclose(gas, wanted, atol=1e-9 * np.abs(wanted).max(), err_msg=head)
    write(tmp_path, "volume [m3], pressure [Pa]", data - [0.0, AROUND])
    own = solved(
        tmp_path, f"{key}: p.csv", text=TRAIN.replace("absolute: true", "absolute: false")
    ).throws[0]
    gas = np.array([one.gas for one in own.harmonics])
    np.testing.assert_allclose(gas, wanted, atol=1e-9 * np.abs(wanted).max())


@pytest.mark.parametrize(("more", "rod"), [("", 0.0), (", tail_rod: 120 mm", 0.12)])
def test_a_constant_pressure_takes_no_work_and_still_excites(
    more: str, rod: float, tmp_path: Path
) -> None:
    own = solved(tmp_path, f"head_end: 3 bar, reciprocating: 10{more}").throws[0]
    assert own.mean_torque == 0.0
    area = math.pi / 4.0 * (0.4**2 - rod**2)
    wanted = (
        quad(lambda a: (3e5 - AROUND) * area * lever(a) * math.sin(a), 0.0, 2.0 * math.pi)[0]
        / math.pi
    )
    assert own.harmonics[0].gas == pytest.approx(-1j * wanted, rel=1e-10)


LOOP = rows(ENDS[0])
WRONG = {
    "turned round": (LOOP[::-1], "drives the shaft"),
    "not closed": (LOOP[:27], "the loop is not closed"),
    "one branch": (np.concatenate([LOOP[:26], LOOP[:1]]), "do not form a loop of two branches"),
    "too long": (LOOP * [1.05, 1.0], "its volume spans"),
    "back": (np.insert(LOOP, 10, LOOP[5], axis=0), "turns back between its ends"),
    "two pressures": (
        np.insert(LOOP, 10, LOOP[9] * [1.0, 1.2], axis=0),
        "two pressures at one volume",
    ),
    "vacuum": (LOOP * [1.0, -1.0], "not above 0"),
    "open": (
        np.concatenate([LOOP[:-1], LOOP[-1:] * [1.0, 0.8]]),
        "another pressure than it begins with",
    ),
}


@for_all("what", WRONG)
def test_a_file_that_is_no_loop_is_refused_where_it_stands(what: str, tmp_path: Path) -> None:
    values, words = WRONG[what]
    write(tmp_path, "volume [m3], pressure [Pa]", values)
    found = faults(tmp_path, "head_end: p.csv")
    assert words in found
    assert "head_end: p.csv" in found


KEYS = {
    "head_end: missing.csv": "cannot be read",
    "head_end: -3 bar": "must be more than 0",
    "head_end: 3": "outside the usual range",
    "head_end: ''": "empty",
    "head_end: 3 bar, tail_rod: 500 mm": "not thinner than the bore",
    "": "nothing excites",
    "head_end: 3 bar, rod: 3": "rod",
}


@for_all("sides", KEYS)
def test_keys_of_a_throw_that_cannot_be_are_refused(sides: str, tmp_path: Path) -> None:
    assert KEYS[sides] in faults(tmp_path, sides)


def test_a_file_over_the_angle_needs_its_dead_centre(tmp_path: Path) -> None:
    write(
        tmp_path, "angle [deg], pressure [bar]", np.array([[0.0, 3.0], [180.0, 1.0], [360.0, 3.0]])
    )
    assert "`tdc` is missing" in faults(tmp_path, "head_end: p.csv")
    write(
        tmp_path, "angle [deg], pressure [bar]", np.array([[0.0, 3.0], [180.0, 1.0], [350.0, 3.0]])
    )
    assert "covers 350 deg" in faults(tmp_path, "head_end: p.csv", "tdc: 0 deg")
    write(
        tmp_path, "angle [deg], pressure [bar]", np.array([[0.0, 3.0], [180.0, 1.0], [360.0, 2.0]])
    )
    assert "other pressures" in faults(tmp_path, "head_end: p.csv", "tdc: 0 deg")
    write(tmp_path, "way [V], pressure [bar]", LOOP)
    assert "volume [dm3]" in faults(tmp_path, "head_end: p.csv")


@for_all(
    ("old", "new", "words"),
    [
        ("absolute: true", "", "`absolute` is missing"),
        ("inertia: 4", "", "`inertia` or `crank_inertia` is missing"),
        ("inertia: 4", "inertia: [4, 4]", "`inertia` has 2 values"),
        ("rod_length: 430 mm", "rod_length: 80 mm", "not longer than half the stroke"),
        (
            "throws: [",
            "throws: [{angle: 0 deg, bore: 0.4, reciprocating: 3}, ",
            "`stiffness` of the crank spans",
        ),
        (
            "analyses",
            "- coupling: {stiffness: 1e5}\n- propeller: {name: pump, inertia: 1}\nanalyses",
            "does not say how they divide",
        ),
    ],
)
def test_a_compressor_that_cannot_be_is_refused(
    old: str, new: str, words: str, tmp_path: Path
) -> None:
    assert words in faults(tmp_path, "head_end: 3 bar", text=TRAIN.replace(old, new))


def test_an_engine_drives_a_compressor(tmp_path: Path) -> None:
    """Their phases meet: one angle counts for both."""
    engine = (
        "- engine: {name: gas engine, cylinders: 1, strokes: 4, inertia: 3, geometry: {bore: 105 mm, stroke: 137 mm, "
        "rod_length: 207 mm}, masses: {reciprocating: 2.5}}"
    )
    write(tmp_path, "volume [m3], pressure [Pa]", LOOP)
    text = TRAIN.replace("- motor: {name: motor, inertia: 9}", engine)
    one = solved(tmp_path, "head_end: p.csv", text=text)
    assert one.mean_torque == pytest.approx(35e3 / (742.0 * RPM), rel=1e-12)


def test_gear_ratios_share_the_load_by_power(tmp_path: Path) -> None:
    """Two equal compressors, one at half the speed: its torque is that of the other, its power half."""
    branch = (
        "- gear: {name: g, ratio: 2, inertia: [1, 1], branches: [{ratio: 1, inertia: 1, train: [coupling: {stiffness: "
        "1e5}, COMPRESSOR]}]}\n- coupling: {stiffness: 1e5}\n"
    )
    body = (
        "{stroke: 180 mm, rod_length: 430 mm, absolute: true, inertia: 4, name: NAME, "
        "throws: [{angle: 0 deg, bore: 0.4, head_end: p.csv}]}"
    )
    start, _, end = TRAIN.partition("- compressor:")
    text = start + branch.replace("COMPRESSOR", "compressor: " + body.replace("NAME", "fast"))
    text += "- compressor: " + body.replace("NAME", "slow") + "\n" + end[end.index("analyses") :]
    write(tmp_path, "volume [m3], pressure [Pa]", LOOP)
    (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
    each = torsion.run(torsion.read(tmp_path / "scene.yaml")).need(Compressors).each
    torque = {one.name: one.mean_torque for one in each}
    whole = 35e3 / (742.0 * RPM)
    assert torque["fast"] == pytest.approx(torque["slow"], rel=1e-12)
    assert torque["fast"] + torque["slow"] / 2.0 == pytest.approx(whole, rel=1e-12)
