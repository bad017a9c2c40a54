"""Tables of the motion over time: what is rounding beside the largest torque of the train is printed as 0."""

from dataclasses import replace

import numpy as np

import torsion
from torsion.analyses.motion.transient_motion import Transients
from torsion.output.blocks import Table
from torsion.output.chapters.motion_over_time import chapter

TEXT = """
name: a step
train: [motor: {name: m, inertia: 2}, coupling: {name: soft, stiffness: 1e4, viscous: 5}, disc: {name: d, inertia: 3}]
analyses: {transient: {duration: 0.1 s, initial: rest, events: [{at: m, step: {torque: 100}}]}}
"""


def test_a_torque_of_rounding_is_0_and_a_small_one_is_not() -> None:
    found = torsion.run(torsion.parse(TEXT))
    (one,) = found.need(Transients).each
    largest = float(one.peak.max())
    for least, is_nothing in ((-3.8e-11, True), (-3.8e-9, False)):
        changed = replace(one, least=np.full_like(one.least, least * largest))
        tables = (
            one
            for one in chapter(found.having(transient=Transients((changed,))))
            if isinstance(one, Table)
        )
        made = next(one for one in tables if one.caption.startswith("Torques over time"))
        assert (made.rows[0][3] == "0") == is_nothing
