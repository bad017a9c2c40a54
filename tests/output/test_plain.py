"""Values of results as plain data."""

import math
from enum import Enum
from fractions import Fraction

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.kernels.trees.tree_response import Status
from torsion.output.stored.results_json import finite, numbers, plain
from torsion.output.stored.scene import Selection

TRAIN = "name: x\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"


class Way(Enum):
    UP_HILL = "up"


@pytest.fixture(scope="module")
def chosen() -> Selection:
    return Selection(torsion.assemble(torsion.parse(TRAIN).train))


@for_all(
    ("value", "data"),
    [
        (1.5 - 2.5j, [1.5, -2.5]),
        (np.complex128(3 + 4j), [3.0, 4.0]),
        (complex(math.nan, 1.0), [None, None]),
        (complex(1.0, math.nan), [None, None]),
        (2.5, 2.5),
        (np.float64(0.5), 0.5),
        (math.inf, None),
        (math.nan, None),
        (np.int64(3), 3),
        (True, True),
        (np.bool_(False), False),
        ("word", "word"),
        (None, None),
        (Fraction(3, 8), "3/8"),
        (Way.UP_HILL, "up-hill"),
        (Status.NEAR_SINGULAR, "near-singular"),
        ({"at": (Status.OK, 2.5, math.inf)}, {"at": ["ok", 2.5, None]}),
        ([1j], [[0.0, 1.0]]),
    ],
)
def test_a_value_is_data_by_its_type(value: object, data: object, chosen: Selection) -> None:
    found = plain(value, chosen)
    assert found == data
    assert type(found) is type(data)


def test_a_number_is_finite_or_none() -> None:
    assert [finite(value) for value in (0.0, -2.5, math.inf, -math.inf, math.nan, None)] == [
        0.0,
        -2.5,
        *[None] * 4,
    ]


def test_an_array_of_complex_numbers_is_one_of_pairs_that_are_known_or_not_together() -> None:
    nan = math.nan
    pairs = numbers(np.array([[1 + 2j, complex(nan, 3.0)], [complex(4.0, nan), -1j]]))
    np.testing.assert_array_equal(pairs, [[[1.0, 2.0], [nan, nan]], [[nan, nan], [0.0, -1.0]]])
    real = np.array([1.0, nan])
    assert numbers(real) is real
