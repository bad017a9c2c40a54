"""Crossings of the Campbell diagram."""

import math
import re
from fractions import Fraction

import pytest

import torsion
from torsion.analyses.critical import critical_speeds
from torsion.analyses.response.harmonic_components import Line, lines
from torsion.analyses.undamped_modes import modes
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.machine_torques import Excitation
from torsion.study import Operation

LINES = (
    Line(Fraction(2), None, ("joint",)),
    Line(Fraction(4), None, ("propeller",)),
    Line(None, 3.0, ("hum",)),
)


def _modes(build):
    return modes(build([Disc(inertia=2.0), Coupling(stiffness=120.0), Disc(inertia=3.0)])[1])


def test_speed_times_order_is_the_natural_frequency(build, operation):
    found = critical_speeds(_modes(build), LINES, operation(2.0, 4.0))
    assert [(one.mode, one.order, one.is_inside) for one in found] == [(1, 4, True), (1, 2, False)]
    assert [one.speed for one in found] == pytest.approx([2.5, 5.0], rel=1e-15)
    assert found[0].frequency == pytest.approx(10.0 / (2 * math.pi), rel=1e-15)
    assert found[1].sources == ("joint",)


def test_margin_counts_from_the_rated_speed_else_from_the_nearest_end(build, operation):
    rated = critical_speeds(_modes(build), LINES, operation(2.0, 6.0, rated=(4.0, 1e3)))
    assert [one.margin for one in rated] == pytest.approx([-0.375, 0.25], rel=1e-14)
    ends = critical_speeds(_modes(build), LINES, operation(2.0, 4.0))
    assert [one.margin for one in ends] == pytest.approx([0.25, 0.25], rel=1e-14)
    assert critical_speeds(_modes(build), LINES, Operation())[0].margin is None


def test_lines_are_ordered_and_exact(build):
    excite = [Excitation(at="disc-1", order=k, torque=1.0) for k in ("4", "21/8", "1")]
    _, system = build(
        [Disc(inertia=2.0), Coupling(stiffness=120.0), Disc(inertia=3.0)], excitations=excite
    )
    assert [line.order for line in lines(system)] == [Fraction(1), Fraction(21, 8), Fraction(4)]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (Line(Fraction(40, 21), None, ("screw",), (Fraction(5),)), "5 × screw (40/21 of motor)"),
        (
            Line(Fraction(2), None, ("motor", "joint"), (Fraction(2), Fraction(2))),
            "2 × motor, joint",
        ),
        (
            Line(Fraction(2), None, ("motor", "pump"), (Fraction(2), Fraction(4))),
            "2 × motor, 4 × pump (2 of motor)",
        ),
        (
            Line(Fraction(1, 2), None, tuple(f"cylinder {k}" for k in range(1, 7))),
            "0.5 × cylinder 1–6",
        ),
        (Line(None, 12.5, ("a1", "a3", "a4", "b", "c")), "12.5 Hz (a1, a3, a4, b, c)"),
    ],
)
def test_a_harmonic_component_is_named_by_its_sources_first(line, words):
    assert line.named("motor") == words
    assert line.words == re.sub(r"\((\S+) of motor\)", r"(order \1)", words)


def test_lines_know_the_orders_of_their_sources_own_shafts():
    text = """
name: x
operation: {speeds: {from: 300 rpm, to: 600 rpm, steps: 2}, rated: {speed: 600 rpm, power: 1 kW}}
train: [motor: {name: m, inertia: 1, ripple: [{order: 2, torque: 1}]}, gear: {ratio: 5/2},
  propeller: {name: screw, inertia: 2, blades: 5, excitation: [{blade_order: 1, torque: 3}]}]
"""
    both = lines(torsion.assemble(torsion.parse(text).train))
    assert [(line.order, line.sources, line.own_orders) for line in both] == [
        (2, ("m", "screw"), (2, 5))
    ]
    assert both[0].named("m") == "2 × m, 5 × screw (2 of m)"
