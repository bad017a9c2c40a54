"""A column takes part in arithmetic as a number does, and is refused aloud where it cannot."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest

from torsion.columns import Column, NotInColumns, copied, joined, picker
from torsion.fields import Declared


def column(*values: float) -> Column:
    return Column(np.array(values))


def test_arithmetic_of_a_column_is_that_of_each_of_its_values() -> None:
    made = 2.0 * column(1.0, 3.0) ** 2 - 1.0 / column(2.0, 4.0)
    assert made.values.tolist() == [2.0 - 0.5, 18.0 - 0.25]


@pytest.mark.parametrize("take", [float, math.sqrt, np.asarray, np.sqrt, "{:g}".format])
def test_what_takes_no_column_raises(take) -> None:
    with pytest.raises(TypeError):
        take(column(1.0, 2.0))


def test_a_comparison_that_variants_answer_differently_is_refused() -> None:
    assert column(1.0, 2.0) > 0.5
    with pytest.raises(NotInColumns):
        assert column(1.0, 2.0) > 1.5


class Shaft(Declared):
    length: float

    @cached_property
    def double(self) -> float:
        return 2.0 * self.length


def test_a_copy_forgets_what_was_computed_of_the_old_values() -> None:
    shaft = Shaft(length=1.0)
    assert shaft.double == 2.0
    assert copied(shaft, length=3.0).double == 6.0


@dataclass(frozen=True)
class Part:
    size: float
    name: str


def test_alternatives_that_differ_in_words_are_not_joined() -> None:
    one, two, other = Part(1.0, "a"), Part(2.0, "a"), Part(2.0, "b")
    train = joined([one, two], lambda numbers: numbers[[1, 0, 1]])
    pick = picker(train)
    assert pick is not None
    assert [pick(variant) for variant in range(3)] == [two, one, two]
    with pytest.raises(NotInColumns):
        joined([one, other], lambda numbers: numbers)
