"""Curves as paths: nothing that can be seen is left out."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import torsion
from torsion.output.chapters.response.couplings import input_and_modes
from torsion.output.drawing.curves import MOST_POINTS, area, decimated, path
from torsion.output.drawing.frame import WIDTH
from torsion.output.figures.figure import Figure


def points(drawn: str) -> list[np.ndarray]:
    """(points, 2) of every piece of a path."""
    found = []
    for piece in re.findall(r"M[^M]*", drawn):
        start, _, steps = piece.rstrip("z").partition("l")
        place = [float(one) for one in re.findall(r"-?\d+", start.partition("h")[0])]
        moves = np.array([float(one) for one in re.findall(r"-?\d+", steps)]).reshape(-1, 2)
        found.append(np.vstack([place, place + moves.cumsum(axis=0)]))
    return found


@settings(max_examples=40)
@given(seed=st.integers(0, 10**6), columns=st.integers(2, 200))
def test_every_bin_keeps_its_least_and_its_greatest_value_and_its_ends(
    seed: int, columns: int
) -> None:
    rng = np.random.default_rng(seed)
    x = np.sort(rng.random(10 * columns + 800))
    y = rng.standard_normal(x.size).cumsum()
    kept = decimated(x, y, columns)
    assert kept.size <= MOST_POINTS * columns < x.size
    assert (kept[0], kept[-1]) == (0, x.size - 1)
    bins = np.minimum(((x - x[0]) / np.ptp(x) * columns).astype(int), columns - 1)
    for one in np.unique(bins):
        inside, mine = np.flatnonzero(bins == one), kept[bins[kept] == one]
        assert {inside[0], inside[-1]} <= set(mine.tolist())
        assert (y[mine].min(), y[mine].max()) == (y[inside].min(), y[inside].max())


def test_a_single_spike_among_a_hundred_thousand_points_is_drawn() -> None:
    x, y = np.linspace(0.0, 5000.0, 100_000), np.zeros(100_000)
    y[54_321] = 900.0
    (drawn,) = points(path(x, y, 500))
    assert drawn[:, 1].max() == 900.0
    assert len(drawn) < 10


def distances(places: np.ndarray, drawn: np.ndarray) -> np.ndarray:
    """(places,) least distances from the pieces of a line."""
    start, step = drawn[:-1], np.diff(drawn, axis=0)
    away = places[:, None] - start
    share = ((away * step).sum(axis=2) / (step**2).sum(axis=1)).clip(0.0, 1.0)
    return np.linalg.norm(away - share[..., None] * step, axis=2).min(axis=1)


def test_few_points_all_stand_on_the_path_to_a_tenth() -> None:
    rng = np.random.default_rng(1)
    x, y = np.sort(rng.random(200)) * 5000, rng.random(200) * 2000
    (drawn,) = points(path(x, y, 500))
    wanted = np.rint(np.column_stack([x, y]))
    assert {tuple(one) for one in wanted[[0, -1]].tolist()} <= {
        tuple(one) for one in drawn.tolist()
    }
    assert distances(wanted, drawn).max() <= 1.5
    assert len(drawn) > 150


def test_points_on_a_straight_line_are_its_two_ends_and_a_turning_point_is_kept() -> None:
    x = np.arange(0.0, 600.0, 10.0)
    for slope in (0.0, 0.37):
        (drawn,) = points(path(x, 7.0 + slope * x, 100))
        assert len(drawn) <= 3
    back = np.array([0.0, 100.0, 50.0])
    assert path(back, np.zeros(3), 100) == "M0 0l100 0-50 0"


def test_a_curve_is_drawn_to_a_fifth_of_a_px_with_a_part_of_its_points() -> None:
    x = np.linspace(0.0, 5000.0, 1500)
    y = 1000.0 + 800.0 * np.sin(x / 400.0)
    (drawn,) = points(path(x, y, 500))
    assert distances(np.column_stack([x, y]), drawn).max() <= 1.5
    assert len(drawn) < 200


def test_a_line_is_broken_where_there_is_no_value_and_a_lone_point_is_a_dash() -> None:
    y = np.array([1.0, 2.0, np.nan, 5.0, np.nan, np.inf, 8.0, 6.0])
    assert path(10.0 * np.arange(8), y, 100) == "M0 1l10 1M25 5h10M60 8l10-2"
    assert path(np.arange(2.0), np.full(2, np.nan), 100) == ""


def test_an_area_goes_along_the_line_and_back_along_its_base() -> None:
    assert (
        area(np.array([0.0, 10.0]), np.array([5.0, 6.0]), np.zeros(2), 100) == "M0 5l10 1 0-6-10 0z"
    )


@pytest.mark.parametrize("far", [1e9, -1e9])
def test_what_is_far_outside_stays_a_number_that_a_browser_can_draw(far: float) -> None:
    assert (
        max(
            abs(float(one))
            for one in re.findall(r"-?\d+", path(np.arange(2.0), np.array([0.0, far]), 9))
        )
        < 1e6
    )


def test_a_coupling_by_table_has_room_for_the_symbols_of_its_first_and_last_point() -> None:
    scene = (
        "name: x\ntrain: [motor: {inertia: 1}, coupling: {table: {over: mean torque, "
        "at: [0, 300, 1600], stiffness: [1e4, 1.2e4, 2e4], loss_factor: [0.1, 0.1, 0.2]}}, disc: {inertia: 2}]\n"
        "operation: {rated: {speed: 1000 rpm, power: 10 kW}}\n"
    )
    found = torsion.run(torsion.parse(scene))
    (figure,) = (block for block in input_and_modes(found) if isinstance(block, Figure))
    for panel in figure.plots:
        shown = (panel.x.high - panel.x.low) / WIDTH  # N m for each px, at most
        assert panel.x.low <= -4.0 * shown
        assert panel.x.high >= 1600.0 + 4.0 * shown
