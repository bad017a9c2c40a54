"""Places of the sketch."""

import numpy as np

from torsion.findings import Findings
from torsion.output.chapters.forced_response import local_maxima
from torsion.output.selection import elements
from torsion.output.station_layout import layout


def test_the_main_line_runs_to_the_right_and_branches_stand_beside_it(train: Findings) -> None:
    place, stations = layout(train.system), [s.name for s in train.system.stations]
    assert np.isfinite(place.x).all()
    main = [stations.index(name) for name in ("motor-1", "propeller-1")]
    assert place.x[main[0]] < place.x[main[1]]
    assert place.row[main].tolist() == [0, 0]
    pump, generator = (place.row[stations.index(name)] for name in ("pump", "generator"))
    assert pump != 0
    assert generator != 0


def test_no_two_points_stand_on_each_other(train: Findings) -> None:
    place = layout(train.system)
    points = [p.stations[0] for p in train.system.train.parts if p.is_point]
    assert len({(round(float(place.x[s]), 6), float(place.row[s])) for s in points}) == len(points)


def test_segments_of_a_shaft_are_one_element(train: Findings) -> None:
    names = [element.name for element in elements(train.system)]
    assert len(names) == len(set(names))
    spans = [span for element in elements(train.system) for span in element.spans]
    assert sorted(spans) == list(range(len(train.system.spans)))


def test_a_maximum_needs_reliable_neighbours() -> None:
    nan = np.nan
    assert local_maxima(np.array([0.0, 1, 0, 2, nan, 2, 0, 3, 3, 1])) == [1, 7]
