"""Stations and spans of shafts in segments."""

import numpy as np
import pytest

from torsion.assembly import assemble
from torsion.assembly.segments import BLOCK, bar_segments
from torsion.assembly.system import System
from torsion.errors import InputError
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.shafts.shaft import Shaft
from torsion.train import train


@pytest.fixture
def geared() -> System:
    """Two shafts, in 4 segments and in 1, with a gear between them."""
    line = [
        Disc(name="a", inertia=1.0),
        Shaft(name="long", length=2.0, diameter=(0.1,), segments=4),
        Gear(name="gear", teeth=(20, 30)),
        Shaft(name="short", length=1.0, diameter=(0.1, 0.2), segments=1),
        Disc(name="b", inertia=3.0),
    ]
    return assemble(train(line))


def test_arrays_say_of_every_station_and_span_what_reading_them_one_by_one_says(geared):
    stations, spans = list(geared.stations), list(geared.spans)
    assert (len(stations), len(spans)) == (len(geared.inertia), len(geared.flexibility))
    np.testing.assert_array_equal(geared.driving, [span.driving for span in spans])
    np.testing.assert_array_equal(geared.driven, [span.driven for span in spans])
    np.testing.assert_array_equal(geared.span_part, [span.part for span in spans])
    np.testing.assert_array_equal(geared.station_part, [station.part for station in stations])
    np.testing.assert_array_equal(
        geared.speed_ratio, [float(station.ratio) for station in stations]
    )
    assert [stations[k] for k in range(len(stations))] == [
        geared.stations[k] for k in range(len(stations))
    ]
    assert geared.spans[-3:] == tuple(spans[-3:])


def test_segments_lead_from_the_driving_to_the_driven_station_under_their_names(geared):
    row = [span for span in geared.spans if span.name.startswith("long")]
    assert [span.name for span in row] == [f"long [{k}]" for k in (1, 2, 3, 4)]
    assert [geared.stations[span.driven].name for span in row[:-1]] == [
        "long 1/4",
        "long 2/4",
        "long 3/4",
    ]
    assert [span.driving for span in row[1:]] == [span.driven for span in row[:-1]]
    ends = geared.train["long"].stations
    assert (row[0].driving, row[-1].driven) == (ends[0], ends[-1])
    assert [span.name for span in geared.spans if span.name.startswith("short")] == ["short"]


def test_a_uniform_shaft_and_a_cone_of_more_pieces_than_a_block_keep_flexibility_and_inertia():
    for diameter in ((0.3,), (0.2, 0.4)):
        built = train([Disc(inertia=1.0), Shaft(length=5.0, diameter=diameter), Disc(inertia=1.0)])
        few, many = (bar_segments(built.bars[0], number) for number in (4, BLOCK + 5))
        assert [values.sum() for values in many] == pytest.approx(
            [values.sum() for values in few], rel=1e-13
        )
        ratio = (built.bars[0].outer[0] / built.bars[0].outer[1]) ** 4
        assert many[0][-1] / many[0][0] == pytest.approx(ratio, rel=1e-3)
        assert many[1][0] / many[1][-1] == pytest.approx(ratio, rel=1e-3)


def test_more_stations_than_are_computed_are_refused_in_words():
    line = [Disc(inertia=1.0), Shaft(name="s", length=1.0, diameter=(0.3,), segments=19_999)]
    assert len(assemble(train([*line, Disc(inertia=1.0)])).stations) == 20_000
    line.append(Shaft(name="t", length=1.0, diameter=(0.3,), segments=1))
    with pytest.raises(InputError, match="the train has 20001 stations; at most 20000") as raised:
        assemble(train([*line, Disc(inertia=1.0)]))
    assert "fewer segments" in str(raised.value)
