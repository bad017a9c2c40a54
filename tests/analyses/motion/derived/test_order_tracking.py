"""Orders of torques while the speed changes, against given motions and the steady response."""

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.motion.derived.order_tracking import (
    MOST_WINDOWS,
    TURNS,
    Tracked,
    one_sense,
    order_tracking,
    windows,
)
from torsion.analyses.motion.transient_motion import OrderTracking, Transients
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.over_speed import response
from torsion.arrays import FloatArray
from torsion.errors import InputError
from torsion.kernels.motion.order_spectrum import hann
from torsion.output.blocks import Figure, Paragraph, Table
from torsion.output.chapters.motion_over_time import chapter


class Given:
    """A shaft that speeds up and vibrates, and a torque of known orders."""

    def __init__(self, speed: float, gain: float, *, sense: float = 1.0, hum: float = 0.0) -> None:
        self.speed, self.gain, self.sense, self.hum = speed, gain, sense, hum

    def turned(self, station: int, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        angle = self.speed * time + self.gain * time**2 / 2.0 + 0.01 * np.sin(90.0 * time)
        speed = self.speed + self.gain * time + 0.9 * np.cos(90.0 * time)
        return self.sense * angle, self.sense * speed

    def orders(self) -> OrderTracking:
        return order_tracking(self, WHAT, (TIME, *self.turned(0, TIME)), 2)

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, None]:
        angle = self.sense * self.turned(0, time)[0]
        value = 40.0 + 12.0 * np.cos(2.0 * angle + 0.7) + 3.0 * np.cos(4.5 * angle - 1.0)
        value = value + self.hum * np.cos(2.0 * np.pi * 900.0 * time)
        return np.array([0.0 * value, value]), np.zeros((2, len(time))), None


TIME = np.linspace(0.0, 6.0, 4001)
WHAT = Tracked("shaft", 0, np.array([2.0, 4.5]), 12.0, (("coupling", 1),))


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_orders_of_a_torque_are_its_own_however_the_shaft_speeds_up_and_vibrates(
    sense: float,
) -> None:
    found = Given(30.0, 25.0, sense=sense).orders()
    assert found.turns == pytest.approx(
        (30.0 * 6.0 + 25.0 * 18.0 + 0.01 * np.sin(540.0)) / (2.0 * np.pi)
    )
    assert found.left_out == 0
    assert 1 < len(found.time) <= MOST_WINDOWS
    (one,) = found.each
    wanted = np.array([12.0 * np.exp(0.7j), 3.0 * np.exp(-1.0j)])
    assert np.abs(one.torque - wanted).max() < 1e-9
    assert one.waterfall[:, [0, 16, 36]] == pytest.approx(
        np.tile([40.0, 12.0, 3.0], (len(found.time), 1)), abs=1e-9
    )
    empty = np.delete(one.waterfall, [0, 1, 15, 16, 17, 35, 36, 37], axis=1)
    assert empty.max() < 1e-9
    middle = (
        30.0 + 25.0 * found.time
    )  # of the window's angle; the mean of a speed that rises is a little below
    assert found.speed == pytest.approx(middle, rel=0.02)


def test_what_is_faster_than_the_samples_is_left_out_and_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert Given(30.0, 25.0, hum=5.0).orders().left_out == 0  # finer samples resolve it
    monkeypatch.setattr("torsion.analyses.motion.derived.order_tracking.MOST_POINTS", 1)
    found = Given(30.0, 25.0, hum=5.0).orders()
    assert found.left_out > 0
    assert found.aliased <= 0.01


def test_the_longest_piece_of_one_sense_is_tracked() -> None:
    angle = np.array([0.0, -1.0, -2.0, -1.0, 3.0, 9.0, 8.0, 4.0])
    speed = np.array([-1.0, -1.0, 0.0, 1.0, 1.0, 1.0, -1.0, -1.0])
    assert one_sense(angle, speed) == (slice(2, 6), 1.0)
    assert one_sense(-angle, -speed) == (slice(2, 6), -1.0)
    assert one_sense(np.zeros(5), np.zeros(5))[0] == slice(0, 2)


def test_windows_reach_from_end_to_end() -> None:
    first = windows(1000 * 64, 64)
    assert len(first) == MOST_WINDOWS
    assert (first[0], first[-1]) == (0, (1000 - TURNS) * 64)
    assert windows(TURNS * 64, 64).tolist() == [0]


SCENE = """name: sweep
operation: {{speeds: {{from: 300 rpm, to: 900 rpm, steps: 2}}}}
train:
- disc: {{name: drive, held: true}}
- coupling: {{name: rubber, stiffness: 1.5e4, viscous: 60}}
- disc: {{name: screw, inertia: 1}}
excitations:
- {{at: screw, order: 2, torque: 0.1 N*m, phase: 30 deg}}
analyses:
  transient:
    duration: {duration} s
    initial: {{speed: 300 rpm}}
    tolerance: 1e-8
    {orders}
    events: [{{at: drive, speed: {{program: [[0 s, 300 rpm], [{duration} s, 900 rpm]]}}}}]
"""


def against_steady(duration: float) -> float:
    """Largest difference of order 2 from the steady response of the window's speeds, of the largest amplitude."""
    found = torsion.run(torsion.parse(SCENE.format(duration=duration, orders="")))
    tracking = found.need(Transients).each[0].orders
    assert tracking is not None
    gain, begin = 20.0 * np.pi / duration, 10.0 * np.pi
    angle = begin * tracking.time + gain * tracking.time**2 / 2.0
    around = angle[:, None] + np.linspace(-TURNS, TURNS, 512, endpoint=False) * np.pi
    speed = np.sqrt(begin**2 + 2.0 * gain * around)
    grid = np.linspace(0.99 * begin, 3.01 * begin, 4000)
    steady: Response = response(found.study, found.system, speeds=grid, refine=False)
    every = np.interp(speed, steady.speed, steady.torque[:, 0, 0])
    wanted = every @ hann(512) / 512
    error = np.abs(tracking.each[0].torque[:, 0] - wanted)[tracking.time > 0.1 * duration]
    return float(error.max() / np.abs(wanted).max())


def test_a_slow_sweep_has_the_steady_response_averaged_over_the_window() -> None:
    quick, slow = against_steady(4.0), against_steady(8.0)
    assert slow < 0.05  # that the speed changes while the train answers
    assert slow == pytest.approx(quick / 2.0, rel=0.1)


def test_what_is_requested_is_tracked_and_reported() -> None:
    asked = "orders: {at: rubber, reference: screw, track: [1, 2], highest: 4}"
    found = torsion.run(torsion.parse(SCENE.format(duration=4.0, orders=asked)))
    tracking = found.need(Transients).each[0].orders
    assert tracking is not None
    assert (tracking.reference, tracking.order.tolist(), tracking.each[0].waterfall.shape[1]) == (
        "screw",
        [1, 2],
        33,
    )
    blocks = list(chapter(found))
    drawn = {one.name: one for one in blocks if isinstance(one, Figure)}
    lines, (map_,) = drawn["orders rubber"].lines, drawn["waterfall rubber"].plots
    assert list(lines) == ["order 1", "order 2"]
    assert [line.y.max() for line in lines.values()] == pytest.approx(
        tracking.each[0].largest, rel=1e-15
    )
    assert map_.cells is not None
    assert (map_.cells.x[0], map_.cells.x[-1], map_.cells.values.shape) == (
        0.25,
        4.0,
        (len(tracking.time), 31),
    )
    assert map_.cells.largest == pytest.approx(tracking.each[0].waterfall[:, 2:].max(), rel=1e-15)
    (largest,) = [
        one for one in blocks if isinstance(one, Table) and one.caption.startswith("Orders")
    ]
    assert [row[:2] for row in largest.rows] == [("rubber", "1"), ("rubber", "2")]


def test_below_8_revolutions_no_order_is_reported() -> None:
    found = torsion.run(torsion.parse(SCENE.format(duration=0.7, orders="orders: {track: 2}")))
    tracking = found.need(Transients).each[0].orders
    assert tracking is not None
    assert tracking.turns == pytest.approx(7.0)
    assert tracking.each == ()
    assert any("makes 7" in one.text for one in chapter(found) if isinstance(one, Paragraph))


@for_all(
    ("orders", "words"),
    [
        ("orders: {at: screw}", "no torque goes through it"),
        ("orders: {at: wheel}", "no component is called 'wheel'"),
        ("orders: {reference: wheel}", "no component is called 'wheel'"),
        ("orders: {reference: rubber}", "not a point"),
        ("orders: {track: 9, highest: 4}", "order 9 is tracked"),
        ("orders: {track: 0}", "more than 0"),
    ],
)
def test_orders_that_cannot_be_tracked_are_refused(orders: str, words: str) -> None:
    with pytest.raises(InputError) as raised:
        torsion.run(torsion.parse(SCENE.format(duration=4.0, orders=orders)))
    assert words in str(raised.value)
