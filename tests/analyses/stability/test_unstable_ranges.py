"""Unstable ranges: the greatest growth is that of the whole range, and what is not known is no end of a range."""

from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.stability.floquet_exponents import Search, growth_search
from torsion.analyses.stability.stability_over_speed import stability
from torsion.analyses.stability.straight_modes import Basis
from torsion.analyses.stability.unstable_ranges import (
    UnstableRange,
    candidates,
    unstable_ranges,
)
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.joint import Joint
from torsion.model.machine import Motor
from torsion.study import Operation, Study
from torsion.train import train

RPM = 30.0 / np.pi
LOWER, UPPER = 0.967624109955, 1.029949152988  # rad/s: the zone of `swing`, published


def made(line: list, torque: float | None = None) -> tuple[Study, System]:
    built = train(line)
    load = {} if torque is None else {"load": [["1 rad/s", torque], ["1000 rad/s", torque]]}
    return Study("test", built, operation=Operation(**load)), assemble(built)


def swing() -> tuple[Study, System]:
    """Constant speed, a spring, a joint of 20 deg and an inertia behind it; natural frequency 1 rad/s, no damping."""
    return made(
        [Disc(held=True), Coupling(stiffness=1.0), Joint(angle="20 deg"), Disc(inertia=1.0)]
    )


def six_stations(torque: float = 300.0) -> tuple[Study, System]:
    return made(
        [
            Motor(inertia=2.0, damping=0.5),
            Coupling(stiffness=2e4, viscous=0.4),
            Joint(angle="20 deg", inertia=(0.02, 0.02)),
            Coupling(stiffness=1.5e4, viscous=0.3),
            Joint(angle="20 deg", inertia=(0.02, 0.02)),
            Coupling(stiffness=3e4, viscous=0.6),
            Disc(inertia=0.8, damping=1.5),
        ],
        torque,
    )


class Gap(Search):
    """A search that meets no periodic motion between two speeds (rad/s)."""

    gap = (np.inf, np.inf)

    def __call__(self, speed: float):
        if self.gap[0] <= speed <= self.gap[1]:
            self.known[speed] = None
        return super().__call__(speed)


def known(speeds: list[float], gap: tuple[float, float] = (np.inf, np.inf)) -> Search:
    """The swing, requested at some speeds, without a periodic motion between two."""
    whole = growth_search(*swing())
    ask = Gap(whole.mechanism, whole.shapes, whole.reduced, whole.method, {})
    ask.gap = gap
    for speed in speeds:
        ask(speed)
    return ask


def ranges(ask: Search) -> tuple[UnstableRange, ...]:
    return unstable_ranges(ask, lambda what, share: None)


@pytest.mark.parametrize("steps", [2, 5])
def test_no_speed_of_a_range_grows_faster_than_its_greatest_growth(steps):
    study, system = six_stations()
    found = stability(study, system, np.linspace(980.0, 1060.0, steps) / RPM)
    (only,) = found.ranges
    inside = (found.speed >= only.first) & (found.speed <= only.last)
    ask = growth_search(study, system)
    fine = [ask.growth(float(speed)) for speed in np.linspace(only.first, only.last, 21)]
    assert only.growth == found.growth[inside].max()
    assert only.growth >= max(fine)
    assert only.growth == pytest.approx(max(fine), rel=5e-3)
    assert only.first < only.at < only.last


def test_growth_of_a_wide_range_is_asked_in_all_its_parts():
    found = stability(*swing(), np.array([0.9, 1.1]))
    (only,) = found.ranges
    inside = found.speed[(found.speed >= only.first) & (found.speed <= only.last)]
    assert np.diff(inside).max() <= (only.last - only.first) / 8.0 * (1.0 + 1e-9)


def test_combinations_of_two_modes_and_of_a_mode_with_the_rigid_motion_are_candidates():
    """Of 10 and 30 rad/s: 20 = 2 w1 = w2 - w1, 40 = w1 + w2, 60 = 2 w2, and 10 and 30; over 2 and 4; ends are none."""
    shapes = Basis(np.array([0.0, 10.0, 30.0]), np.eye(3), np.ones(3), np.zeros((3, 3)), 3)
    speeds = candidates(shapes, (Fraction(2),), 2.5, 30.0)
    assert speeds == pytest.approx([5.0, 7.5, 10.0, 15.0, 20.0])


def test_speed_without_a_periodic_motion_parts_a_range_and_is_told():
    below, above = ranges(known([0.9, 0.98, 1.0, 1.01, 1.1], (0.999, 1.001)))
    assert below.first == pytest.approx(LOWER, rel=1e-10)
    assert (below.last, below.unknown, below.is_open) == (0.98, (None, 1.01), (False, False))
    assert (above.first, above.unknown, above.is_open) == (1.01, (0.98, None), (False, False))
    assert above.last == pytest.approx(UPPER, rel=1e-10)
    assert below.growth > 0 < above.growth


def test_range_whose_rest_is_unknown_is_no_range_that_goes_on():
    (only,) = ranges(known([0.9, 0.98, 1.0, 1.1], (0.999, 1.2)))
    assert (only.last, only.unknown, only.is_open) == (0.98, (None, 1.1), (False, False))
    assert only.grows_at_end == (False, True)
    (other,) = ranges(known([0.9, 0.98, 1.0]))
    assert (other.last, other.unknown, other.is_open) == (1.0, (None, None), (False, True))
    assert other.grows_at_end == (False, True)


def test_gap_that_is_met_only_in_the_search_for_a_boundary_ends_the_range():
    (only,) = ranges(known([0.9, 1.0, 1.1], (1.02, 1.06)))  # the first bisection meets it
    assert only.first == pytest.approx(LOWER, rel=1e-10)
    assert (only.last, only.unknown) == (1.0, (None, 1.1))


def test_gap_that_is_met_only_in_the_search_for_the_greatest_growth_parts_the_range():
    below, above = ranges(known([0.9, 0.97, 1.02, 1.1], (0.99, 0.996)))
    assert (below.unknown, above.unknown) == ((None, above.first), (below.last, None))
    assert below.last < 0.99
    assert above.first > 0.996
    assert above.last == pytest.approx(UPPER, rel=1e-10)


@pytest.mark.parametrize(
    ("ends", "is_open", "unknown", "speeds", "meets"),
    [
        ((80, 100), (False, False), (None, None), (100, 200), False),
        ((80, 100), (False, True), (None, None), (100, 200), True),
        ((80, 100), (False, False), (None, 120), (100, 200), True),
        ((200, 230), (False, False), (None, None), (100, 200), False),
        ((200, 230), (False, False), (180, None), (100, 200), True),
        ((200, 200), (False, True), (180, None), (100, 200), True),
        ((150, 151), (False, False), (None, None), (100, 200), True),
        ((201, 230), (True, True), (None, None), (100, 200), False),
    ],
)
def test_range_meets_speeds_with_what_is_unstable_of_it(ends, is_open, unknown, speeds, meets):
    one = UnstableRange("principal", (1,), 1, *ends, is_open, 1.0, float(ends[0]), unknown)
    assert one.meets(*speeds) == meets
