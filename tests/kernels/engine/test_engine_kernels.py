"""Crank, gas torque, cycle and phasors against series, closed forms, and vectors made by other programs."""

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from torsion.kernels.engine.crank_slider import (
    CrankSlider,
    Throw,
    carter,
    ker_wilson,
    rod_as_masses,
)
from torsion.kernels.engine.gas_torque import (
    Cylinder,
    CylinderOrder,
    Diagram,
    GasLaw,
    harmonics,
)
from torsion.kernels.engine.pressure_cycles import Cycle, UnreachablePressure, fitted, timed

ORACLES = json.loads((Path(__file__).parent / "oracles.json").read_text(encoding="utf-8"))
RADIUS, ROD, OFFSET = (ORACLES["offset_crank"][key] for key in ("r", "l", "e"))


def series(ratio: float) -> list[float]:
    """t_1 .. t_6 of T/(m r^2 w^2) = sum t_k sin k angle, exact polynomials up to the 7th power of the ratio."""
    p = [ratio**k for k in range(8)]
    return [
        p[1] / 4 + p[3] / 16 + 15 * p[5] / 512 + 35 * p[7] / 2048,
        -0.5 - p[4] / 32 - p[6] / 32,
        -3 * p[1] / 4 - 9 * p[3] / 32 - 81 * p[5] / 512 - 105 * p[7] / 1024,
        -p[2] / 4 - p[4] / 8 - p[6] / 16,
        5 * p[3] / 32 + 75 * p[5] / 512,
        3 * p[4] / 32 + 3 * p[6] / 32,
    ]


@pytest.mark.parametrize("ratio", [0.02, 0.05, 0.1])
def test_inertia_torque_is_its_series_in_the_ratio_of_crank_and_rod(ratio: float) -> None:
    found = CrankSlider(0.3 * ratio, 0.3).inertia_torque(6, 2.0) / (2.0 * (0.3 * ratio) ** 2)
    np.testing.assert_allclose(-found.imag[1:], series(ratio), atol=ratio**7 + 1e-15)
    np.testing.assert_allclose(found.real, 0.0, atol=1e-15)


@pytest.mark.parametrize(("ratio", "key"), [(0.25, "0.25"), (0.0685 / 0.207, "0.330917874396")])
def test_inertia_torque_has_all_digits_of_the_vector(ratio: float, key: str) -> None:
    crank, known = CrankSlider(ratio, 1.0), ORACLES["inertia_series"]
    found = crank.inertia_torque(8, 1.0) / ratio**2
    wanted = next(
        values for name, values in known.items() if name.startswith(f"exact lambda {key}")
    )
    np.testing.assert_allclose(-found.imag[1:], wanted, rtol=0, atol=1e-12)
    mean = crank.inertia_harmonics(0, 1.0)[0].real / ratio**2
    assert mean == pytest.approx(known["mean inertia/(m r^2)"][key], rel=1e-14)


def test_offset_crank_has_the_dead_centres_stroke_and_motion_of_the_vector() -> None:
    known, crank = ORACLES["offset_crank"], CrankSlider(RADIUS, ROD, OFFSET)
    assert math.degrees(crank.top) == pytest.approx(known["tdc_deg"], rel=1e-14)
    assert math.degrees(crank.top + crank.bottom) == pytest.approx(known["bdc_deg"], rel=1e-14)
    assert crank.stroke == pytest.approx(known["stroke"], rel=1e-14)
    for degrees, values in known["th_deg: x, x1, x2"].items():
        np.testing.assert_allclose(
            crank.piston(math.radians(float(degrees)) - crank.top), values, rtol=1e-13
        )
    turned = np.exp(-1j * crank.top * np.arange(5)) * crank.inertia_torque(4, 1.0)
    for order, a, b in known["inertia torque per m w^2: k, a, b"]:
        assert turned[order] == pytest.approx(complex(a, -b), rel=1e-7)


@pytest.mark.parametrize("offset", [0.0, 0.01, -0.02])
def test_a_stroke_gives_back_its_crank_radius(offset: float) -> None:
    crank = CrankSlider(0.05, 0.15, offset)
    assert CrankSlider.of_stroke(crank.stroke, 0.15, offset).radius == pytest.approx(
        0.05, rel=1e-13
    )


def test_a_small_offset_changes_nothing_but_by_its_own_size() -> None:
    plain, moved = (CrankSlider(0.05, 0.15, e).inertia_torque(4, 1.0) for e in (0.0, 1e-9))
    np.testing.assert_allclose(moved, plain, atol=1e-9 * np.abs(plain).max())


def test_derivatives_of_the_piston_are_those_of_its_way() -> None:
    crank, angle, step = CrankSlider(RADIUS, ROD, OFFSET), np.linspace(0.0, 6.0, 25), 1e-5
    later, before = (crank.piston(angle + way) for way in (step, -step))
    for k in (0, 1):
        slope = (later[k] - before[k]) / (2 * step)
        np.testing.assert_allclose(crank.piston(angle)[k + 1], slope, atol=1e-9)


def test_a_rod_no_longer_than_crank_and_offset_is_refused() -> None:
    with pytest.raises(ValueError, match="not longer"):
        CrankSlider(0.1, 0.12, 0.02)
    with pytest.raises(ValueError, match="not longer"):
        CrankSlider.of_stroke(0.3, 0.12)


def test_rod_adds_the_inertia_of_the_published_engine() -> None:
    known = ORACLES["rod"]
    crank = CrankSlider(known["r"], known["l"])
    rod = known["rod_mass"], known["cg_from_big_end"], known["I_cg"]
    rotating, reciprocating, correction = rod_as_masses(crank.rod, *rod)
    assert rotating == pytest.approx(known["rotating_share"], rel=1e-14)
    assert reciprocating == pytest.approx(known["reciprocating_share"], rel=1e-14)
    assert correction == pytest.approx(known["J_c"], rel=1e-13)
    turning, mass = rotating * crank.radius**2, known["piston"] + reciprocating
    found = crank.inertia_harmonics(4, mass, correction)
    assert found[0].real + turning == pytest.approx(known["mean_equivalent_inertia"], rel=1e-13)
    without = crank.inertia_harmonics(0, mass)[0].real + turning
    assert without == pytest.approx(known["without_J_c"], rel=1e-13)
    np.testing.assert_allclose(found[1:].real, known["J(th) cos harmonics 1..4"], rtol=1e-12)


def test_the_kinetic_energy_of_the_rod_is_that_of_a_rigid_body() -> None:
    crank, angle, step = CrankSlider(0.0685, 0.207), np.linspace(0.0, 6.2, 40), 1e-5
    mass, centre, own = 1.8, 0.06, 0.014
    rotating, *moving = rod_as_masses(crank.rod, mass, centre, own)
    series = crank.inertia_harmonics(60, *moving)
    inertia = rotating * crank.radius**2  # 2 x kinetic energy / speed^2
    inertia += (series * np.exp(1j * np.outer(angle, np.arange(61)))).real.sum(axis=1)

    def place(a):
        lean = np.arcsin(crank.radius * np.sin(a) / crank.rod)
        along = crank.radius * np.cos(a) + centre * np.cos(lean)
        return np.array([along, (crank.rod - centre) * np.sin(lean), lean])

    speed = (place(angle + step) - place(angle - step)) / (2 * step)
    np.testing.assert_allclose(
        inertia, mass * (speed[:2] ** 2).sum(axis=0) + own * speed[2] ** 2, rtol=1e-8
    )


def test_estimates_of_a_throw_are_those_of_the_vector() -> None:
    known = ORACLES["crank_throw"]
    sizes = {key: known[key] for key in ("D_j", "D_p", "L_j", "L_p", "R", "G")}
    web = known["web thickness"], known["web width"]
    throw = Throw(
        (sizes["D_j"], 0.0, sizes["L_j"]), (sizes["D_p"], 0.0, sizes["L_p"]), web, sizes["R"]
    )
    assert carter(throw, sizes["G"]) == pytest.approx(known["Carter L_e mm, k"][1], rel=1e-13)
    assert ker_wilson(throw, sizes["G"]) == pytest.approx(known["Ker Wilson"][1], rel=1e-13)


def marine() -> Cycle:
    """The cycle of the worked vector: bore 320, stroke 400 mm, l/r 4."""
    cylinder = Cylinder(CrankSlider(0.2, 0.8), math.pi / 4 * 0.32**2, 2)
    return Cycle(cylinder, 14.0, 3e5, 2.5e5, 1.35, 1.0, math.radians(60.0))


def test_the_wiebe_cycle_has_all_digits_of_the_worked_vector() -> None:
    known, found = ORACLES["wiebe_four_stroke"], fitted(marine(), 20e5, 160e5)
    assert math.degrees(found.start) == pytest.approx(known["start_deg"], abs=1e-6)
    assert found.heat == pytest.approx(known["heat_J"], rel=2e-8)
    assert found.peak == pytest.approx(160e5, rel=1e-12)
    same = timed(marine(), 20e5, math.radians(-9.481288987))
    for degrees, pressure in known["p_bar at deg"].items():
        assert float(same.pressure(np.array(math.radians(float(degrees))))) == pytest.approx(
            1e5 * pressure, abs=0.2
        )
    rows = np.array(
        known["order, a, b, amplitude, phase deg, motored a, motored b (bar; torque = A r t)"]
    )
    for cycle, a, b in ((same, 1, 2), (same.motored, 5, 6)):
        found_rows = cycle.torque(24)[1:] / cycle.cylinder.tangential / 1e5
        np.testing.assert_allclose(
            found_rows, rows[:, a] - 1j * rows[:, b], rtol=5e-8, atol=6e-8
        )  # 8 digits, 3e-8
    motored = found.cylinder.imep(found.motored.torque(0)[0].real)
    assert motored == pytest.approx(0.5e5, rel=1e-12)  # by charge exchange alone: 3.0 - 2.5


def test_the_pressure_of_a_cycle_solves_its_differential_equation() -> None:
    cycle, step = timed(marine(), 20e5, math.radians(-9.5)), 1e-6
    angle = np.radians([-5.0, 3.0, 20.0, 45.0])
    slope = (cycle.closed(angle + step) - cycle.closed(angle - step)) / (2 * step)
    volume = cycle.cylinder.volume(angle, cycle.ratio)
    grows = (
        cycle.cylinder.volume(angle + step, 14.0) - cycle.cylinder.volume(angle - step, 14.0)
    ) / (2 * step)
    y = (angle - cycle.start) / cycle.duration
    heat = (
        cycle.heat * 2 * 6.908 / cycle.duration * y * np.exp(-6.908 * y**2) / (1 - math.exp(-6.908))
    )
    wanted = ((cycle.gamma - 1) * heat - cycle.gamma * cycle.closed(angle) * grows) / volume
    np.testing.assert_allclose(slope, wanted, rtol=1e-7)


def test_a_lossless_motored_cycle_has_no_cosine_terms_but_for_the_exchange_of_charge() -> None:
    even = Cycle(marine().cylinder, 14.0, 3e5, 3e5, 1.35, 1.0, 1.0).torque(24)
    assert np.abs(even.real).max() < 1e-12 * np.abs(even).max()


def test_a_peak_out_of_reach_is_refused_with_what_can_be_reached() -> None:
    with pytest.raises(UnreachablePressure) as caught:
        fitted(marine(), 20e5, 500e5)
    assert 160e5 < caught.value.highest < 500e5
    assert fitted(marine(), 20e5, 0.99 * caught.value.highest).peak == pytest.approx(
        0.99 * caught.value.highest
    )


def test_a_two_stroke_cycle_keeps_its_work_and_ends_where_it_begins() -> None:
    cylinder = Cylinder(CrankSlider(1.0, 2.2), 0.2, 1)
    ports = math.radians(110.0), math.radians(130.0)
    plain = Cycle(cylinder, 16.0, 3.5e5, 3.5e5, 1.36, 1.0, math.radians(70.0), *ports)
    cycle = fitted(plain, 18e5, 165e5)
    ends = cycle.pressure(np.array([cycle.closes, cycle.closes + 2 * math.pi]))
    np.testing.assert_allclose(ends, 3.5e5, rtol=1e-12)
    work = quad(
        lambda a: float(cycle.pressure(np.array(a)) * cylinder.lever(np.array(a))),
        cycle.closes,
        cycle.closes + 2 * math.pi,
        points=cycle.corners[1:-1].tolist(),
        limit=400,
        epsabs=0,
        epsrel=1e-12,
    )[0]
    assert work / cylinder.swept == pytest.approx(18e5, rel=1e-10)


@pytest.mark.parametrize("revolutions", [1, 2])
def test_mean_tangential_pressure_is_imep_over_the_angle_of_a_cycle(revolutions: int) -> None:
    """t_0 = imep/(2 pi) of four strokes, imep/pi of two, for random diagrams; the work by adaptive quadrature in V."""
    random = np.random.default_rng(revolutions)
    cylinder = Cylinder(CrankSlider(0.07, 0.21, 0.004), 0.01, revolutions)
    inner = np.sort(random.uniform(-math.pi, cylinder.period - math.pi, 30))
    angle = np.array([-math.pi, *inner, cylinder.period - math.pi])
    pressure = random.uniform(1e5, 9e6, 32)
    pressure[-1] = pressure[0]
    found = Diagram(angle, pressure).torque(cylinder, 4)
    work = sum(
        quad(
            lambda a: float(np.interp(a, angle, pressure) * cylinder.lever(np.array(a))),
            low,
            high,
            epsrel=1e-13,
        )[0]
        for low, high in pairwise(angle.tolist())
    )
    t_0 = found[0].real / (cylinder.area * cylinder.crank.stroke / 2.0)
    imep = work / (cylinder.area * cylinder.crank.stroke)
    assert t_0 == pytest.approx(imep / (math.pi * revolutions), rel=1e-12)
    assert cylinder.mean_torque(cylinder.imep(found[0].real)) == pytest.approx(
        found[0].real, rel=1e-15
    )


def test_harmonics_are_those_of_a_long_fast_transform() -> None:
    cylinder = Cylinder(CrankSlider(0.07, 0.21), 0.01, 2)
    angle = np.linspace(-math.pi, 3 * math.pi, 721)
    pressure = 1e5 * (2.0 + 40.0 * np.exp(-(((angle - 0.2) / 0.5) ** 2)))
    pressure[-1] = pressure[0]
    diagram, number = Diagram(angle, pressure), 2**18
    at = -math.pi + 4 * math.pi / number * np.arange(number)
    samples = np.interp(at, angle, pressure) * cylinder.lever(at)
    wanted = 2.0 * np.fft.rfft(samples)[:25] / number * np.exp(1j * math.pi * np.arange(25) / 2.0)
    np.testing.assert_allclose(
        diagram.torque(cylinder, 24)[1:], wanted[1:], atol=1e-9 * np.abs(wanted).max()
    )


def test_quadrature_of_single_harmonics_is_exact() -> None:
    corners = np.array([-1.0, 0.3, 4 * math.pi - 1.0])
    found = harmonics(lambda a: 3.0 + 2.0 * np.cos(1.5 * a - 0.4), corners, 2, 6)
    np.testing.assert_allclose(found, [3.0, 0, 0, 2.0 * np.exp(-0.4j), 0, 0, 0], atol=1e-13)


LAW = GasLaw(
    "load",
    np.array([4.0, 100.0]),
    np.array([[4.0, 1 + 2j], [100.0, 5 - 8j]]),
    np.array([[4.0, 1 + 2j]]),
    True,
)


def test_a_misfiring_cylinder_is_motored_and_one_cut_out_has_no_gas_torque() -> None:
    speed, load = np.array([10.0, 20.0]), np.array([50.0, 100.0])
    np.testing.assert_allclose(LAW.harmonic(1, load, speed, state="motored"), [1 + 2j, 1 + 2j])
    np.testing.assert_allclose(LAW.harmonic(1, load, speed, state="cut out"), 0.0)
    whole, some = (LAW.harmonic(1, load, speed, share=share) for share in (1.0, 0.5))
    np.testing.assert_allclose(some, (whole + (1 + 2j)) / 2.0, rtol=1e-15)
    np.testing.assert_allclose(
        LAW.harmonic(0, 2 * load, speed).real, 2 * load
    )  # straight beyond its end


def test_the_torque_of_moving_masses_goes_on_while_a_cylinder_does_not_fire() -> None:
    order = CylinderOrder(LAW, 1, 0.5j, np.exp(-0.5j * 3.0), 0, 1.0, "cut out")
    speed = np.array([10.0])
    np.testing.assert_allclose(
        order.amplitude(speed, np.array([50.0])), np.exp(-1.5j) * 0.5j * 100.0, rtol=1e-15
    )


def test_a_diagram_mirrored_is_symmetric_while_the_cylinder_expands() -> None:
    cylinder = Cylinder(CrankSlider(0.07, 0.21), 0.01, 2)
    cycle = timed(
        Cycle(cylinder, 16.0, 2e5, 2e5, 1.35, 1.0, math.radians(60.0)), 15e5, math.radians(2.0)
    )
    angle = np.linspace(cycle.closes, cycle.closes + 4 * math.pi, 7201)
    mirrored = Diagram(angle, cycle.pressure(angle)).mirrored(cylinder).torque(cylinder, 24)
    motored = cycle.motored.torque(
        24
    )  # heat begins behind top dead centre: the compression says all
    np.testing.assert_allclose(mirrored, motored, atol=2e-5 * np.abs(motored).max())
