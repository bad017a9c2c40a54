"""A clutch that opens on a ramp carries at most its capacity, also where it has stuck before with a constant one."""

import numpy as np

import torsion

SCENE = """
name: clutch that opens beside a spring
train:
- disc: {name: e, inertia: 2}
- coupling: {name: cl, stiffness: 50 kN*m/rad, capacity: 400 N*m}
- disc: {name: d, inertia: 0.05}
- coupling: {name: c, stiffness: 20 kN*m/rad}
- disc: {name: z, inertia: 1}
analyses:
  transient:
    duration: 0.3 s
    samples: 30000
    events:
    - {at: e, time: 0.02 s, step: {torque: 250 N*m}}
    - {at: cl, time: 0.1 s, clutch: {open: 0.1 s}}
"""


def test_torque_of_an_opening_clutch_stays_below_its_falling_capacity() -> None:
    motion = torsion.run(torsion.parse(SCENE))["transient"].each[0]
    capacity = 400.0 * np.clip(1.0 - (motion.time_s - 0.1) / 0.1, 0.0, 1.0)
    torque = np.abs(motion["cl"])
    assert torque.max() > 150.0
    assert (torque <= capacity + 1e-9 * 400.0).all()
