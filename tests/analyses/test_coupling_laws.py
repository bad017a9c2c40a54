"""Prony and fractional springs against matrices with states of their own, many digits, and closed forms."""

import math

import mpmath as mp
import numpy as np
import pytest
import scipy.linalg

import torsion
from torsion.analyses.damped_modes import DampedModes, damped
from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.kernels.stiffness_laws import fractional, prony
from torsion.study import Study

PRONY = "prony: {stiffness: 15e3, terms: [[6e3, 50 ms], [9e3, 0.005 s]]}"
TAU = 1.0 / (20.0 * math.pi)
FRACTIONAL = f"fractional: {{stiffness: 10e3, k1: 6e3, tau: {TAU!r} s, exponent: 0.35}}"
SCENE = """name: law
train:
  - disc: {{name: a, inertia: 10}}
  - coupling: {{name: c, {coupling}}}
  - disc: {{name: b, inertia: 40}}
{more}
"""
REST = """  - coupling: {stiffness: 2e5, viscous: 40}
  - gear: {ratio: 2, inertia: [2, 3]}
  - coupling: {name: d, prony: {stiffness: 4e4, terms: [[3e4, 0.01 s]]}}
  - disc: {inertia: 5}
"""


def study(coupling: str, more: str = "") -> Study:
    return torsion.parse(SCENE.format(coupling=coupling, more=more))


def of(coupling: str, more: str = "") -> DampedModes:
    return damped(assemble(study(coupling, more).train), speed=0.0, count=None)


def with_states(
    inertia: list[float], springs: list[tuple[int, int, float, float, list[tuple[float, float]]]]
) -> np.ndarray:
    """Eigenvalues of the equations of motion with one twist of a damper as state for each term.

    springs: two stations, static stiffness, viscous damping, terms. The spring k of a term carries k (u - z), its
    damper k tau z', so that z' = (u - z)/tau.
    """
    n, terms = len(inertia), sum(len(one[4]) for one in springs)
    matrix, at = np.zeros((2 * n + terms, 2 * n + terms)), 2 * n
    matrix[:n, n : 2 * n] = np.eye(n)
    for first, second, static, viscous, each in springs:
        twist = np.zeros(2 * n + terms)
        twist[[first, second]] = 1.0, -1.0
        torque = static * twist + viscous * np.roll(twist, n)
        for k, tau in each:
            torque += k * twist
            torque[at] -= k
            matrix[at] = twist / tau
            matrix[at, at] -= 1.0 / tau
            at += 1
        matrix[n + first] -= torque / inertia[first]
        matrix[n + second] += torque / inertia[second]
    return scipy.linalg.eigvals(matrix)


def test_two_masses_with_relaxing_springs_have_the_published_roots() -> None:
    """reference, prototype D: eigenvalues of the four states of the relative motion, by numpy."""
    found = of(PRONY)
    assert found.eigenvalue == pytest.approx([-5.426384539181755 + 51.19354811127413j], rel=1e-13)
    assert found.overdamped == pytest.approx([-14.541995079381227, -194.6052358422554], rel=1e-13)


def test_roots_are_those_of_a_matrix_with_a_state_for_every_term() -> None:
    """Behind a gear that halves the speed inertias and stiffnesses are a quarter, seen from before it."""
    found = of(PRONY, REST)
    expected = with_states(
        [10, 40, 2 + 3 / 4, 5 / 4],
        [
            (0, 1, 15e3, 0.0, [(6e3, 0.05), (9e3, 0.005)]),
            (1, 2, 2e5, 40.0, []),
            (2, 3, 1e4, 0.0, [(7.5e3, 0.01)]),
        ],
    )
    rising = np.sort_complex(expected[expected.imag > 1.0])
    assert found.eigenvalue[np.argsort(found.eigenvalue.real)] == pytest.approx(rising, rel=1e-12)
    real = np.sort(expected[(np.abs(expected.imag) < 1e-6) & (np.abs(expected) > 1.0)].real)[::-1]
    assert found.overdamped == pytest.approx(real, rel=1e-11)


@pytest.mark.parametrize("seed", range(6))
def test_roots_of_random_trains_are_those_of_the_states(seed: int) -> None:
    draw = np.random.default_rng(seed)
    inertia, springs, text = (10.0 ** draw.uniform(0, 2, 5)).tolist(), [], ""
    for k in range(4):
        static, viscous = 10.0 ** draw.uniform(4, 6), 10.0 ** draw.uniform(0, 2)
        terms = [
            (static * 10.0 ** draw.uniform(-1, 1), 10.0 ** draw.uniform(-4, 0))
            for _ in range(k % 3)
        ]
        springs.append((k, k + 1, static, 0.0 if terms else viscous, terms))
        rows = ", ".join(f"[{a!r}, {b!r} s]" for a, b in terms)
        own = (
            f"prony: {{stiffness: {static!r}, terms: [{rows}]}}"
            if terms
            else (f"stiffness: {static!r}, viscous: {viscous!r}")
        )
        text += f"  - coupling: {{{own}}}\n  - disc: {{inertia: {inertia[k + 1]!r}}}\n"
    scene = torsion.parse(f"name: r\ntrain:\n  - disc: {{inertia: {inertia[0]!r}}}\n{text}")
    found = damped(assemble(scene.train), speed=0.0, count=None)
    expected = with_states(inertia, springs)
    rising = expected[expected.imag > 1e-3]
    assert len(found.eigenvalue) == len(rising)
    for root in rising:
        assert np.abs(found.eigenvalue / root - 1.0).min() < 1e-11


def test_shapes_and_torques_satisfy_the_equations_of_motion() -> None:
    scene = study(PRONY, REST)
    system = assemble(scene.train)
    found, law = damped(system, speed=0.0, count=None), system.tables[0]
    s = found.eigenvalue
    twist = found.shape[0] - found.shape[1]
    assert found.torque[0] == pytest.approx(law.at_root(s)[0] * twist, rel=1e-10)
    assert found.torque[0] == pytest.approx(-10.0 * s**2 * found.shape[0], rel=1e-10)


def test_modes_of_a_power_of_the_frequency_are_roots_to_many_digits() -> None:
    """m s^2 + k0 + k1 (s tau)^a = 0 with the principal branch, by mpmath; reference, prototype E."""
    found = of(FRACTIONAL)
    with mp.workdps(40):
        exact = mp.findroot(
            lambda s: 8 * s**2 + 10000 + 6000 * (s * mp.mpf(TAU)) ** mp.mpf(0.35),
            mp.mpc(-4.2, 42.6),
            tol=1e-60,
        )
    assert found.eigenvalue == pytest.approx([complex(exact)], rel=1e-14)
    assert complex(exact) == pytest.approx(-4.24713713628618 + 42.60187946230709j, rel=1e-13)
    assert abs(mp.arg(exact)) < mp.pi


@pytest.mark.parametrize("exponent", [0.05, 0.5, 0.95])
def test_three_masses_with_a_power_beside_other_damping_have_the_roots_of_their_determinant(
    exponent: float,
) -> None:
    law = f"fractional: {{stiffness: 10e3, k1: 9e3, tau: 0.02 s, exponent: {exponent}}}"
    found = of(law, "  - coupling: {stiffness: 2e5, viscous: 60}\n  - disc: {inertia: 30}\n")
    assert len(found.eigenvalue) == 2
    for root in found.eigenvalue:
        with mp.workdps(40):

            def determinant(s: mp.mpc) -> mp.mpc:
                k, c = 10000 + 9000 * (s * mp.mpf(0.02)) ** mp.mpf(exponent), 200000 + 60 * s
                return mp.det(
                    mp.matrix(
                        [
                            [10 * s**2 + k, -k, 0],
                            [-k, 40 * s**2 + k + c, -c],
                            [0, -c, 30 * s**2 + c],
                        ]
                    )
                )

            exact = complex(mp.findroot(determinant, mp.mpc(root), tol=1e-40))
        assert root == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize("coupling", [PRONY, FRACTIONAL])
def test_real_mode_is_the_certified_root_at_its_own_stiffness(coupling: str) -> None:
    found = modes(assemble(study(coupling).train))
    with mp.workdps(40):

        def excess(w: mp.mpf) -> mp.mpf:
            s = mp.mpc(0, w)
            relaxing = 15000 + 6000 * s * mp.mpf(0.05) / (1 + s * mp.mpf(0.05))
            relaxing += 9000 * s * mp.mpf(0.005) / (1 + s * mp.mpf(0.005))
            power = 10000 + 6000 * (s * mp.mpf(TAU)) ** mp.mpf(0.35)
            return 8 * w**2 - mp.re(relaxing if coupling == PRONY else power)

        exact = mp.findroot(excess, 2 * mp.pi * float(found.frequency[0])) / (2 * mp.pi)
    assert found.certified
    assert mp.mpf(float(found.lower[0])) < exact < mp.mpf(float(found.upper[0]))
    assert found.upper[0] - found.lower[0] < 1e-13 * found.frequency[0]


@pytest.mark.parametrize("coupling", [PRONY, FRACTIONAL])
def test_response_has_the_stiffness_of_the_law_at_every_frequency(coupling: str) -> None:
    rest = "excitations: [{at: a, order: 1, torque: 100}]\nanalyses: {response: }\n"
    scene = study(coupling, "operation: {speeds: {from: 60 rpm, to: 3000 rpm, steps: 9}}\n" + rest)
    found = torsion.response(scene, assemble(scene.train))
    s = 1j * found.speed
    k = 15e3 + 6e3 * s * 0.05 / (1 + s * 0.05) + 9e3 * s * 0.005 / (1 + s * 0.005)
    if coupling == FRACTIONAL:
        k = 10e3 + 6e3 * (s * TAU) ** 0.35
    assert found.torque[:, 0, 0] == pytest.approx(
        100.0 * k * 40.0 / (k * 50.0 + s**2 * 400.0), rel=1e-12
    )


def test_slope_of_relaxing_springs_has_a_bound_below_two_that_one_term_reaches() -> None:
    w = np.geomspace(1e-3, 1e6, 20_001)
    for terms in (
        ((6e3, 0.05),),
        ((6e3, 0.05), (9e3, 0.005)),
        ((1e6, 0.1), (2e6, 1e-4), (5e5, 1e-2)),
    ):
        law = prony(15e3, terms)
        largest = max(law.slope(float(one)) for one in w)
        assert largest <= law.steepest < 2.0
        if len(terms) == 1:
            assert largest == pytest.approx(law.steepest, rel=1e-6)
    law = fractional(10e3, 6e3, 0.01, 0.35)
    assert max(law.slope(float(one)) for one in w) < law.steepest


def test_derivative_of_a_law_is_that_of_its_series() -> None:
    for law in (prony(15e3, ((6e3, 0.05), (9e3, 0.005))), fractional(10e3, 6e3, 0.01, 0.35)):
        s = np.array([3.0 + 40j, -5.0 + 20j])
        step = 1e-6
        ahead, behind = law.at_root(s + step)[0], law.at_root(s - step)[0]
        assert law.at_root(s)[1] == pytest.approx((ahead - behind) / (2 * step), rel=1e-7)


@pytest.mark.parametrize(
    "coupling",
    [
        PRONY,
        FRACTIONAL,
        "table: {over: frequency, at: [5, 40], stiffness: [20e3, 36 kN*m/rad], psi: [1, 1], beyond: hold}",
        "table: {over: vibratory torque, at: [0, 40], stiffness: [30e3, 22e3], psi: [1, 1], beyond: hold}",
    ],
)
def test_the_tolerance_of_a_coupling_is_that_of_all_stiffnesses_of_its_law(coupling: str) -> None:
    """Soft and stiff have both ends of it at every point, and the same loss factor."""
    scene = study(f"{coupling}, tolerance: 20 %", "cases: {from: tolerances}\n")
    (given,) = assemble(scene.train).tables.values()
    for name, factor in (("soft", 0.8), ("stiff", 1.2)):
        (varied,) = assemble(scene.cases[name].train).tables.values()
        at = np.array(given.at)
        assert varied.values(at)[0] == pytest.approx(factor * given.values(at)[0], rel=1e-14)
        assert varied.values(at)[1] == pytest.approx(given.values(at)[1], rel=1e-14)
