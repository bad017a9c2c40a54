"""Rebuilding the house changes no digit: every bit, or 1e-13 of the sums where the order of a sum may change."""

import json

import pytest
from tests.contracts.frozen import FILE, SCENES, of_scene, of_trains

import torsion

KNOWN = json.loads(FILE.read_text(encoding="utf-8"))


def _equal(found: dict, known: dict) -> None:
    assert found.keys() == known.keys()
    for name, digits in found.items():
        if digits == known[name]:
            continue
        assert isinstance(digits[1], int), name
        assert digits[1] == known[name][1], name
        assert digits[2] == pytest.approx(known[name][2], rel=1e-13, abs=1e-13 * known[name][3]), name
        assert digits[3] == pytest.approx(known[name][3], rel=1e-13), name


@pytest.mark.parametrize("scene", SCENES)
def test_digits_of_a_scene_are_the_frozen_ones(scene: str) -> None:
    _equal(of_scene(torsion.run(torsion.read(SCENES[scene]))), KNOWN[scene])


def test_digits_of_random_trains_are_the_frozen_ones() -> None:
    _equal(of_trains(), KNOWN["random trains"])
