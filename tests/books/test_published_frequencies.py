"""Every scene of a published or closed-form case, solved against its numbers."""

import math
from pathlib import Path

import numpy as np
import pytest

import torsion

SCENES = Path(__file__).parents[2] / "shafting_specs"
TURN = 2.0 * math.pi
REFERENCE = {  # Hz at 40 digits, rounded as printed here; half a unit of the last digit is the tolerance
    "two_discs": ["176.076747"],
    "friswell_9_7_1": ["81.207629", "141.214071", "378.952954", "536.363283"],
    "friswell_geared_t": ["425.359477", "634.07276", "3247.19235"],
    "haixun_06402": ["21.4181", "35.6279", "383.4036", "424.6482", "619.7428", "2382.44"],
    "six_cylinder": [
        "216.5836",
        "592.7405",
        "984.9230",
        "1171.017",
        "1415.995",
        "1660.044",
        "1794.388",
        "2993.474",
    ],
    "motorcycle_crank": ["1168.90761", "2084.56541", "2618.70295", "14913.6919", "15634.4075"],
}
CLOSED = {  # rad/s
    "rao": [500.0 * math.sqrt(2.0), 500.0 * math.sqrt(6.0)],
    "opposed_torques": [10.0],
    # two inertias on a spring: w^2 = k (1/J1 + 1/J2)
    "two_discs": [math.sqrt(9.775e6 * (1.0 / 211.4 + 1.0 / 8.3))],
    # k/J symmetric functions: J1 J2 J3 w^4 - w^2 [k1 (J1 + J2) J3 + k2 (J2 + J3) J1] + k1 k2 (J1 + J2 + J3) = 0
    "three_discs": [
        math.sqrt((19.0 - math.sqrt(73.0)) / 12.0),
        math.sqrt((19.0 + math.sqrt(73.0)) / 12.0),
    ],
}
PUBLISHED = {  # what the source prints, Hz
    "friswell_9_7_1": ["81.21", "141.21", "378.95", "536.36"],
    "friswell_geared_t": ["425.4", "634.1", "3247.2"],
    "haixun_06402": ["21.42", "35.63", "383.4", "424.65", "619.74"],
}


def _frequencies(scene: str) -> np.ndarray:
    study = torsion.read(SCENES / f"{scene}.yaml")
    return torsion.modes(torsion.assemble(study.train, model=study.model), count=None).frequency


def _half_unit(text: str) -> float:
    return 0.5000001 * 10.0 ** -len(text.partition(".")[2])


@pytest.mark.parametrize("scene", REFERENCE)
def test_every_frequency_to_the_last_digit_of_the_reference(scene: str) -> None:
    found = _frequencies(scene)
    assert len(found) >= len(REFERENCE[scene])
    for value, text in zip(found, REFERENCE[scene], strict=False):
        assert abs(value - float(text)) <= _half_unit(text)


@pytest.mark.parametrize("scene", CLOSED)
def test_closed_forms_to_rounding(scene: str) -> None:
    found = _frequencies(scene) * TURN
    np.testing.assert_allclose(found, CLOSED[scene], rtol=2e-15 * 4, atol=0)


@pytest.mark.parametrize("scene", PUBLISHED)
def test_what_the_source_prints(scene: str) -> None:
    for value, text in zip(_frequencies(scene), PUBLISHED[scene], strict=False):
        assert abs(value - float(text)) <= _half_unit(text)


def test_wind_turbine_in_radians_per_second() -> None:
    found = _frequencies("wind_turbine") * TURN
    assert abs(found[0] - 58.3401619) <= 0.5000001e-7
    assert abs(found[1] - 1034.11472) <= 0.5000001e-5


def test_three_discs_per_minute() -> None:
    found = _frequencies("three_discs") * 60.0
    assert abs(found[0] - 8.91381197) <= 0.5000001e-8
    assert abs(found[1] - 14.4675267) <= 0.5000001e-7
