"""The speeds that verdicts stand on: bounds of the limits, corners of tables, and the worst between two of them."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response import grid
from torsion.arrays import FloatArray
from torsion.fields import Declared
from torsion.findings import Results
from torsion.rules import of_study
from torsion.rules.judgement import vibration
from torsion.rules.verdict_line import Rule
from torsion.study import Study

FEWEST_JUDGED = 201  # evenly spaced over the range, as many as a file has that names no number


def judged_speeds(study: Study) -> FloatArray:
    """(speeds,) rad/s, ascending, in the range of the operation: what its rules need beyond the speeds requested."""
    speeds = study.operation.speeds
    if speeds is None:
        return np.empty(0)
    named = [speed for one, settings in _vibration_rules(study) for speed in one.speeds(study, settings)]
    found = np.unique([*named, *_corners(study)])
    even = np.linspace(speeds.first, speeds.last, FEWEST_JUDGED)
    if speeds.steps < FEWEST_JUDGED:
        found = np.union1d(found, grid.apart(found, even)) if found.size else even
    return np.asarray(found[(found >= speeds.first) & (found <= speeds.last)])


def speeds_between(evidence: Results) -> FloatArray:
    """(speeds,) rad/s, ascending, not yet computed, at which a rule may find more than at those beside them."""
    response, _ = vibration(evidence)
    found = [one.speeds_between(evidence, settings) for one, settings in _vibration_rules(evidence.study)]
    more = np.unique(np.concatenate([np.empty(0), *found]))
    inside = (more > response.speed[0]) & (more < response.speed[-1])
    return grid.apart(response.speed, more[inside])


def _vibration_rules(study: Study) -> Iterator[tuple[Rule, Declared]]:
    """The study's rules that read the response over speed, with their settings."""
    return ((one, settings) for one, settings in of_study(study) if "response" in one.needs)


def _corners(study: Study) -> list[float]:
    """rad/s of the reference station at the rows of every table of torque, between which it is straight."""
    train, load = study.train, study.operation.load
    own = [row[0] / float(train.stations[torque.station].ratio) for torque in train.torques for row in torque.table]
    return own if isinstance(load, str) else [*own, *(row[0] for row in load)]
