"""Words stay clear of each other, inside their rectangle and, where there is room, beside the curves."""

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from torsion.output.drawing.words import GROWTH, SIZE, Room, width

PLOT = (0.0, 0.0, 500.0, 200.0)
NOTHING = np.zeros((0, 2))


def apart(one: tuple, other: tuple) -> bool:
    return one[0] >= other[2] or other[0] >= one[2] or one[1] >= other[3] or other[1] >= one[3]


@given(
    places=st.lists(
        st.tuples(
            st.floats(0, 500), st.floats(0, 200), st.text("12345 order", min_size=1, max_size=12)
        ),
        max_size=40,
    ),
    seed=st.integers(0, 99),
)
def test_no_two_words_overlap_and_none_leaves_the_plot(places: list, seed: int) -> None:
    curve = np.random.default_rng(seed).random((300, 2)) * [500.0, 200.0]
    room = Room(PLOT, curve)
    found = [room.place(text, np.array([[x, y]])) for x, y, text in places]
    boxes = [one.box for one in found if one is not None]
    assert boxes == room.taken
    for one, other in itertools.combinations(boxes, 2):
        assert apart(one, other)
    for left, top, right, foot in boxes:
        assert left >= 0 <= top
        assert right <= 500 >= foot <= 200
    for (_, _, text), one in zip(places, found, strict=True):
        if one is not None:  # a box has room for letters a quarter larger
            assert one.box[2] - one.box[0] >= GROWTH * width(text)
            assert one.box[3] - one.box[1] >= GROWTH * SIZE * 0.999


def test_words_avoid_a_curve_where_there_is_room_beside_it() -> None:
    x = np.linspace(0.0, 500.0, 400)
    curve = np.column_stack([x, 100.0 - 60.0 * np.exp(-(((x - 250.0) / 20.0) ** 2))])
    word = Room(PLOT, curve).place("order 2", np.array([[250.0, 40.0]]))
    left, top, right, foot = word.box
    assert not (
        (curve[:, 0] > left) & (curve[:, 0] < right) & (curve[:, 1] > top) & (curve[:, 1] < foot)
    ).any()
    assert word.foot is None  # it stands at its point
    assert foot <= 40.0


def test_words_that_stand_apart_point_to_their_place() -> None:
    room = Room(PLOT, NOTHING)
    words = [room.place("a long name", np.array([[250.0, 100.0]]), ways=(0,)) for _ in range(4)]
    assert [one.foot for one in words] == [None, *[(250.0, 100.0)] * 3]
    assert room.place("x" * 200, np.array([[250.0, 100.0]])) is None


def test_widths_are_those_of_the_letters() -> None:
    assert width("W", 1000.0) == 944
    assert width("i" * 10) < width("m" * 10)
    assert width("弹性") > width("ab")
