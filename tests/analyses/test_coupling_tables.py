"""Couplings by table against closed forms, many digits and the same train with a plain coupling."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

import torsion
from torsion.analyses.modes.coupling_tables import CouplingTables
from torsion.analyses.modes.tabled_modes import tabled_modes
from torsion.analyses.response.component_loads import harmonic_heat
from torsion.analyses.response.over_frequency import frequency_response
from torsion.analyses.undamped_modes import Modes, modes
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import taken_at
from torsion.errors import InputError, SolveError
from torsion.kernels.stiffness_laws import StiffnessTable
from torsion.study import Study

HERTZ = 2.0 * math.pi
F, K, ETA = (5.0, 10.0, 20.0, 40.0), (20e3, 24e3, 30e3, 36e3), (0.12, 0.14, 0.16, 0.18)
TABLE = (
    "{over: frequency, at: [5, 10 Hz, 20, 40], stiffness: [20e3, 24e3, 30 kN*m/rad, 36e3], "
    "loss_factor: [0.12, 14 %, 0.16, 0.18]}"
)
TWO = """name: test
train:
  - disc: {{name: a, inertia: 10}}
  - coupling: {{name: c, {coupling}}}
  - disc: {{name: b, inertia: 40}}
{rest}
"""
THREE = "  - coupling: {stiffness: 2e5}\n  - disc: {inertia: 30}\n"
EXCITED = """
operation: {speeds: {from: 300 rpm, to: 2400 rpm, steps: 3}}
excitations: [{at: a, order: 1, torque: 100}, {at: a, order: 1/2, torque: 30, phase: 40 deg}]
analyses: {modes: , response: }
"""
ONE_ORDER = EXCITED.replace(", {at: a, order: 1/2, torque: 30, phase: 40 deg}", "")


def study(coupling: str = f"table: {TABLE}", rest: str = "", more: str = "") -> Study:
    return torsion.parse(TWO.format(coupling=coupling, rest=more) + rest)


def two_masses(hertz: float, k: float, eta: float) -> tuple[complex, float]:
    """Torque (N m) of 100 N m on the first of two masses, and heat (W), in closed form."""
    w2, stiffness = (HERTZ * hertz) ** 2, k * (1 + 1j * eta)
    torque = 100.0 * stiffness * 40.0 / (stiffness * 50.0 - w2 * 400.0)
    return torque, 0.5 * HERTZ * hertz * k * eta * abs(torque / stiffness) ** 2


def test_every_harmonic_component_has_stiffness_and_loss_of_its_own_frequency() -> None:
    hertz = np.array([5.0, 7.5, 9.0, 15.0, 40.0])
    given = study(
        rest=ONE_ORDER,
        coupling=f"table: {TABLE[:-1]}, beyond: hold}}",
    )
    found = torsion.response(given, assemble(given.train), speeds=HERTZ * hertz)
    at = [int(np.argmin(abs(found.speed - HERTZ * one))) for one in hertz]
    expected = [two_masses(f, np.interp(f, F, K), np.interp(f, F, ETA)) for f in hertz]
    assert found.torque[at, 0, 0] == pytest.approx([one[0] for one in expected], rel=1e-12)
    assert harmonic_heat(found, found.system, np.array([0])).sum(axis=1)[at] == pytest.approx(
        [one[1] for one in expected], rel=1e-12
    )


def test_two_masses_have_the_published_torque_and_heat() -> None:
    """reference [coupling_frequency]: by numpy.linalg.solve of the two equations of motion."""
    given = study(rest=ONE_ORDER)
    found = torsion.response(
        given, assemble(given.train), speeds=HERTZ * np.array([5.0, 9.0, 40.0])
    )
    at = [int(np.argmin(abs(found.speed - HERTZ * one))) for one in (5.0, 9.0, 40.0)]
    torque, power = (
        found.torque[at, 0, 0],
        harmonic_heat(found, found.system, np.array([0])).sum(axis=1)[at],
    )
    assert np.abs(torque) == pytest.approx(
        [130.59033742850158, 473.7924557649227, 6.234513443549591], rel=1e-12
    )
    assert np.degrees(np.angle(torque)) == pytest.approx(
        [-4.372169579, -119.306227259, -169.004987971], abs=1e-9
    )
    assert power == pytest.approx([1.58446983285, 36.53089060087, 0.02365576537], abs=1e-10)


def test_response_over_frequency_reads_the_table_too() -> None:
    given = study(
        rest="excitations: [{at: a, torque: 100}]\nanalyses: {response: {frequencies: {from: 6, to: 12, steps: 3}}}"
    )
    found = frequency_response(given, assemble(given.train))
    expected = [two_masses(f, np.interp(f, F, K), np.interp(f, F, ETA))[0] for f in found.frequency]
    assert found.torque[:, 0] == pytest.approx(expected, rel=1e-11)


def test_mode_of_two_masses_is_the_root_of_a_quadratic() -> None:
    """k = 16000 + 800 f from 5 to 10 Hz: (2 pi f)^2 = (16000 + 800 f)/8."""
    a, b, c = mp.mpf(4) * mp.pi**2, mp.mpf(-100), mp.mpf(-2000)
    exact = (-b + mp.sqrt(b * b - 4 * a * c)) / (2 * a)
    found = modes(assemble(study().train))
    assert found.frequency[0] == pytest.approx(float(exact), rel=1e-15)
    assert found.frequency[0] == pytest.approx(8.495944340691366, rel=2e-16)
    assert mp.mpf(float(found.lower[0])) < exact < mp.mpf(float(found.upper[0]))
    assert found.upper[0] - found.lower[0] < 1e-13 * found.frequency[0]


def test_modes_of_three_masses_lie_within_their_bounds_and_share_their_energy() -> None:
    """Each root of the determinant at the stiffness of its own frequency, in 40 digits."""
    found = modes(assemble(study(more=THREE).train))
    assert found.frequency == pytest.approx([7.9412679306599765, 17.495931546702355], rel=1e-14)
    with mp.workdps(40):
        for mode, (left, rise, base) in enumerate([(5, 800, 20000), (10, 600, 24000)]):

            def determinant(f: mp.mpf, k0=base, slope=rise, begin=left) -> mp.mpf:
                s, k = (2 * mp.pi * f) ** 2, k0 + slope * (f - begin)
                upper, last = k - 10 * s, 200000 - 30 * s
                middle = k + 200000 - 40 * s
                return upper * (middle * last - mp.mpf(200000) ** 2) - k * k * last

            exact = mp.findroot(determinant, float(found.frequency[mode]))
            assert mp.mpf(float(found.lower[mode])) < exact < mp.mpf(float(found.upper[mode]))
    assert found.certified
    assert found.nodes.tolist() == [1, 2]
    assert found.elastic.sum(axis=0) == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize("model", ["lumped", "fem", "exact"])
def test_mode_equals_that_of_a_plain_coupling_of_its_stiffness_in_every_model_of_shafts(
    model: str,
) -> None:
    shaft = "  - shaft: {length: 2, diameter: 90 mm, loss_factor: 1 %}\n  - disc: {inertia: 30}\n"
    found = modes(
        assemble(study(more=shaft, coupling=f"table: {TABLE[:-1]}, beyond: hold}}").train, model), 3
    )
    for mode, hertz in enumerate(found.frequency):
        k = float(np.interp(hertz, F, K))
        plain = modes(assemble(study(more=shaft, coupling=f"stiffness: {k!r}").train, model), 3)
        assert hertz == pytest.approx(plain.frequency[mode], rel=1e-13)
        assert found.elastic[:, mode].sum() == pytest.approx(1.0, rel=1e-12)


def test_table_of_one_stiffness_gives_the_results_of_a_plain_coupling() -> None:
    """Behind a gear whose figures are referred; at orders, heat, modes and shares."""
    gear = "  - gear: {ratio: 2.5, referred: true}\n  - disc: {name: g, inertia: 3}\n"
    gear += "  - coupling: {name: e, %s}\n  - disc: {inertia: 2}\n"
    plain = study("stiffness: 24e3, loss_factor: 0.1", EXCITED, gear % "stiffness: 9e3, psi: 0.9")
    flat = "table: {over: frequency, at: [1, 100], stiffness: [%s, %s], %s: [%s, %s], beyond: hold}"
    tabled = study(
        flat % ("24e3", "24e3", "loss_factor", 0.1, 0.1),
        EXCITED,
        gear % (flat % ("9e3", "9e3", "psi", 0.9, 0.9)),
    )
    one, other = torsion.run(plain), torsion.run(tabled)
    first, second = one.results["modes"], other.results["modes"]
    assert second.frequency == pytest.approx(first.frequency, rel=1e-14)
    assert second.elastic == pytest.approx(first.elastic, rel=1e-10)
    by_speed = [
        torsion.response(given, assemble(given.train), speeds=np.linspace(40.0, 200.0, 5))
        for given in (plain, tabled)
    ]
    speeds = [found.speed for found in by_speed]
    both = np.intersect1d(*speeds)
    torque = [found.torque[np.isin(found.speed, both)] for found in by_speed]
    assert np.abs(torque[1] - torque[0]).max() <= 1e-13 * np.abs(torque[0]).max()


def test_modal_loss_factor_is_the_damping_ratio_of_the_complex_root_doubled() -> None:
    """Of a light hysteresis in a table of one stiffness: eta_modal/2 = zeta to second order."""
    light = (
        "table: {over: frequency, at: [1, 100], stiffness: [24e3, 24e3], loss_factor: [1e-5, 1e-5]}"
    )
    rest = "analyses: {modes: }"
    found = torsion.run(study(light, rest, THREE)).need(CouplingTables)
    plain = torsion.run(study("stiffness: 24e3, loss_factor: 1e-5", rest, THREE)).results[
        "damped_modes"
    ]
    assert found.modal_loss_factor / 2.0 == pytest.approx(plain.damping_ratio, rel=1e-8)


def test_viscous_damping_of_a_table_is_linear_over_the_frequency() -> None:
    table = StiffnessTable("frequency", (10.0, 20.0), (100.0, 300.0), (0.0, 0.0), (1.0, 3.0))
    w = np.array([10.0, 15.0, 20.0])
    assert table.complex_stiffness(w, w) == pytest.approx(
        np.array([100 + 10j, 200 + 30j, 300 + 60j]), rel=1e-15
    )
    assert table.slopes == pytest.approx(np.array([[2.0], [4.0 / 3.0]]), rel=1e-15)


def test_held_ends_give_modes_beyond_them_those_of_their_stiffness() -> None:
    """At 1 to 2 Hz the table ends far below the modes, at 100 to 200 Hz it begins far above them."""
    for at in ("[1, 2]", "[100, 200]"):
        held = f"table: {{over: frequency, at: {at}, stiffness: [20e3, 30e3], beyond: hold}}"
        plain = f"stiffness: {30e3 if at == '[1, 2]' else 20e3}"
        found, expected = (modes(assemble(study(one, more=THREE).train)) for one in (held, plain))
        assert found.frequency == pytest.approx(expected.frequency, rel=1e-15)
        assert (found.lower < expected.frequency).all()
        assert (expected.frequency < found.upper).all()


@pytest.mark.parametrize("last", [20e3, 160e3])
def test_bounds_are_wider_by_the_steepest_slope_of_the_stiffness(last: float) -> None:
    """(2 - d ln k/d ln w) d ln w = d ln lambda, of bounds of 1e-6 of each frequency; linear, steepest at its end."""
    given = study(f"table: {{over: frequency, at: [5, 40], stiffness: [20e3, {last}]}}")

    def solve(system: System, count: int | None) -> Modes:
        exact = modes(system, count)
        return replace(exact, lower=exact.lower * (1 - 1e-6), upper=exact.upper * (1 + 1e-6))

    found = tabled_modes(assemble(given.train), None, solve)
    steepest = (last - 20e3) / 35.0 * 40.0 / last
    width = 2e-6 / (2.0 - steepest)
    assert found.upper / found.frequency - 1.0 == pytest.approx([width], rel=1e-5)
    assert 1.0 - found.lower / found.frequency == pytest.approx([width], rel=1e-5)


def test_modes_above_a_table_that_ends_are_left_out_and_said_so() -> None:
    short = "table: {over: frequency, at: [5, 10], stiffness: [20e3, 24e3]}"
    found = torsion.run(study(short, "analyses: {modes: {count: 2}}", THREE))
    assert found.results["modes"].frequency == pytest.approx([7.9412679306599765], rel=1e-14)
    assert [what for what, _ in found.plan.left_out if what.startswith("modes above")] == [
        "modes above 10 Hz"
    ]


def test_mode_below_a_table_is_refused_at_the_table() -> None:
    late = study(
        "table: {over: frequency, at: [20, 40], stiffness: [20e3, 24e3]}", "analyses: {modes: }"
    )
    with pytest.raises(
        SolveError, match="mode 1 lies below 20 Hz, where the table of 'c' begins"
    ) as caught:
        torsion.run(late)
    assert ":4:" in str(caught.value.located)


def test_mode_below_two_tables_is_refused_at_the_one_that_begins_last() -> None:
    law = "table: {{over: frequency, at: [{}, 60], stiffness: [20e3, 24e3]}}"
    second = f"  - coupling: {{name: d, {law.format(30)}}}\n  - disc: {{inertia: 30}}\n"
    with pytest.raises(SolveError, match="mode 1 lies below 30 Hz, where the table of 'd' begins"):
        modes(assemble(study(law.format(20), more=second).train))


def test_stiffness_that_rises_faster_than_the_square_of_the_frequency_is_refused_for_modes_alone() -> (
    None
):
    """From 10 to 11 Hz it trebles: k = (2 pi f)^2 8 has roots below, between and above."""
    steep = "table: {over: frequency, at: [5, 10, 11, 40], stiffness: [20e3, 20e3, 60e3, 61e3], beyond: hold}"
    given = study(steep, EXCITED)
    with pytest.raises(
        SolveError, match="faster than the square of the frequency from 10 to 11 Hz"
    ):
        modes(assemble(given.train))
    found = torsion.run(given)
    assert "response" in found.results
    assert [one.analysis for one in found.plan.unanswered] == ["modes"]


def test_response_beyond_a_table_is_refused_at_the_table() -> None:
    given = study("table: {over: frequency, at: [5, 30], stiffness: [20e3, 24e3]}", EXCITED)
    with pytest.raises(InputError, match=r"covers 5 to 30 Hz; .* Hz is needed"):
        torsion.response(given, assemble(given.train))


def test_system_taken_at_a_frequency_has_the_tree_of_one_assembled_so() -> None:
    system = assemble(study(more="  - gear: {ratio: 2}\n  - disc: {inertia: 1}\n" + THREE).train)
    found = taken_at(system, HERTZ * 7.5)
    k = float(np.interp(7.5, F, K))
    plain = assemble(
        study(
            f"stiffness: {k!r}", more="  - gear: {ratio: 2}\n  - disc: {inertia: 1}\n" + THREE
        ).train
    )
    assert found.condensed.tree.flexibility == pytest.approx(
        plain.condensed.tree.flexibility, rel=1e-15
    )
    assert not found.tables


@pytest.mark.parametrize(
    ("rest", "words"),
    [
        (
            "analyses: {transient: {duration: 1}}",
            "the transient response does not support a stiffness that follows the frequency",
        ),
        ("damping: {modal: 2 %}", "damping by mode is a sum over modes of one stiffness"),
        ("analyses: {check: }", "the comparison of the models takes no table"),
        (
            "links: [{between: [a, b], coupling: {stiffness: 1e3}}]",
            "a train with closed loops does not support a table",
        ),
    ],
)
def test_what_takes_no_table_is_refused_at_the_table(rest: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        torsion.parse(TWO.format(coupling=f"table: {TABLE}", rest="") + rest)
    assert any(words in fault.message and fault.line == 4 for fault in caught.value.faults)
