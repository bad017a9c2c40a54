"""Grooves of a shaft that have no room in it are refused, each for its own reason."""

from math import pi

import numpy as np
import pytest

from torsion.model.engine.gas_laws import GasFault, over_cycle
from torsion.model.shafts.shaft_details import Keyway, Splines

OUTER = 0.1  # m


@pytest.mark.parametrize(
    ("root", "width", "fillet", "bore", "words"),
    [
        (0.090, 0.008, 0.001, 0.0, ""),
        (0.100, 0.008, 0.001, 0.0, "the root is not smaller than the shaft"),
        (0.101, 0.008, 0.001, 0.0, "the root is not smaller than the shaft"),
        (0.090, 0.008, 0.001, 0.0899, "the root is too close to the bore"),
        (0.090, 0.014, 0.001, 0.0, "the fillets do not fit between the teeth"),
        (0.098, 0.008, 0.002, 0.0, "the fillet is higher than the teeth"),
    ],
)
def test_splines_have_room_or_the_reason_is_stated(
    root: float, width: float, fillet: float, bore: float, words: str
) -> None:
    assert Splines(teeth=20, root=root, width=width, fillet=fillet).lacks(OUTER, bore) == words


@pytest.mark.parametrize(
    ("width", "depth", "number", "bore", "words"),
    [
        (0.028, 0.010, 1, 0.0, ""),
        (0.100, 0.010, 1, 0.0, "its flanks end below its fillets"),
        (0.028, 0.010, 1, 0.0799, "it is too deep, or too wide, for what is left below it"),
        (0.028, 0.010, 8, 0.0, "its number is too large for its width"),
    ],
)
def test_a_keyway_has_room_or_the_reason_is_stated(
    width: float, depth: float, number: int, bore: float, words: str
) -> None:
    keyway = Keyway(width=width, depth=depth, fillet=0.0005, number=number)
    assert keyway.lacks(OUTER, bore) == words


def test_a_measured_cycle_ends_within_a_hundredth_of_its_largest_pressure() -> None:
    angle, pressure = np.linspace(0.0, 4 * pi, 5), np.array([2e5, 5e5, 1e7, 4e5, 2e5 + 0.99e5])
    assert over_cycle("p.csv", angle, pressure, 4 * pi, "cycle").angle[-1] == 4 * pi
    pressure[-1] = 2e5 + 1.01e5
    with pytest.raises(GasFault, match=r"begins and ends with other pressures, 2 and 3\.01 `bar`"):
        over_cycle("p.csv", angle, pressure, 4 * pi, "cycle")
