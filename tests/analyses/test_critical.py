"""Crossings of the Campbell diagram."""

import math
from fractions import Fraction

import pytest

from torsion.analyses.critical import critical_speeds
from torsion.analyses.response.harmonic_components import Line, lines
from torsion.analyses.undamped_modes import modes
from torsion.components.coupling import Coupling
from torsion.components.disc import Disc
from torsion.components.harmonic_torques import Excitation
from torsion.study import Operation

LINES = (Line(Fraction(2), None, ("joint",)), Line(Fraction(4), None, ("propeller",)), Line(None, 3.0, ("hum",)))


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
    _, system = build([Disc(inertia=2.0), Coupling(stiffness=120.0), Disc(inertia=3.0)], excitations=excite)
    assert [line.order for line in lines(system)] == [Fraction(1), Fraction(21, 8), Fraction(4)]
