"""Trains with so many stations that nothing may be made for each of them one by one."""

import math

import numpy as np
import pytest

from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.model.disc import Disc
from torsion.model.shafts.shaft import Shaft
from torsion.train import train

COUNT = 20  # modes
NUMBER = 8  # bytes
SHAPES = 2 * COUNT * NUMBER  # of a station: its angle and its torque in every mode


def _shaft(first: Disc, last: Disc, segments: int) -> System:
    line = [first, Shaft(name="s", length=1000.0, diameter=(0.3,), segments=segments), last]
    return assemble(train(line))


ENDS = {
    "free": (lambda: Disc(inertia=0.0), lambda: Disc(inertia=0.0), 1.0, 0.0),
    "held at one end": (lambda: Disc(held=True), lambda: Disc(inertia=0.0), 1.0, 0.5),
    "held at the other end": (lambda: Disc(inertia=0.0), lambda: Disc(held=True), 1.0, 0.5),
    "held at both ends": (lambda: Disc(held=True), lambda: Disc(held=True), 1.0, 0.0),
}


@pytest.mark.parametrize("ends", ENDS)
def test_modes_of_a_uniform_shaft_in_very_many_segments_are_those_of_the_uniform_chain(ends):
    first, last, step, less = ENDS[ends]
    segments = 4_000
    system = _shaft(first(), last(), segments)
    found = modes(system, COUNT)
    mode = step * np.arange(1, COUNT + 1) - less
    h, inertia = system.flexibility[0], system.inertia[-1]
    exact = np.sin(mode * math.pi / (2 * segments)) / (math.pi * math.sqrt(h * inertia))
    np.testing.assert_allclose(found.frequency, exact, rtol=1e-12)
    assert found.certified
    assert (found.lower <= exact * (1 + 1e-15)).all()
    assert (found.upper >= exact * (1 - 1e-15)).all()
    held = sum(math.isinf(j) for j in system.inertia[:2])
    assert found.nodes.tolist() == [k + (1 if held == 0 else 0) for k in range(COUNT)]
    along = np.arange(segments + 1) * math.pi / segments
    order = [0, *range(2, segments + 1), 1]
    wave = (
        np.sin(mode * along[:, None])
        if math.isinf(system.inertia[0])
        else np.cos(mode * along[:, None])
    )
    shape = found.shape[order] / np.abs(found.shape).max(axis=0)
    np.testing.assert_allclose(shape * np.sign(shape[1] * wave[1]), wave, atol=1e-9)
    torque = np.diff(found.shape[order], axis=0) / -h
    np.testing.assert_allclose(found.torque, torque, atol=1e-8 * np.abs(torque).max())


def test_shares_of_energy_of_very_many_stations_sum_to_one():
    found = modes(_shaft(Disc(inertia=10.0), Disc(inertia=20.0), 4_000), COUNT)
    np.testing.assert_allclose(found.kinetic.sum(axis=0), 1.0, rtol=1e-12)
    np.testing.assert_allclose(found.elastic.sum(axis=0), 1.0, rtol=1e-12)
