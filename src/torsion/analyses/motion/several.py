"""Other periodic motions at the speeds of the highest peaks: near resonance the equations may have several.

Newton's method finds one motion from one start. At the peaks it is started again from the rigid motion, and carried
there over speed from either side; what comes out different is another motion of the same train. None other being found
does not prove that there is none.
"""

from dataclasses import replace

import numpy as np

from torsion.analyses.motion.loading import Scene
from torsion.analyses.motion.periodic import Orbit, PeriodicResponse, orbit, told
from torsion.errors import SolveError

ASIDE = (-0.02, 0.02)  # of the speed: from so far away a motion is carried to it
STEPS = 4  # of the way
SAME = 1e-5  # of the largest amplitude: motions that differ by less are one


def others(at: Scene, found: PeriodicResponse, rows: list[int]) -> PeriodicResponse | None:
    """What else was found at the speeds of some rows of a response, told in its orders; None where nothing was.

    A speed stands once for every further motion.
    """
    speeds, orbits = list[float](), list[Orbit | None]()
    for row in rows:
        here = found.orbits[row]
        if here is None:
            continue
        known = [here]
        for start in _starts(at, found, row):
            other = _reached(at, float(found.speed[row]), start)
            if other is not None and all(_differ(at, one, other) for one in known):
                known.append(other)
        speeds += [float(found.speed[row])] * (len(known) - 1)
        orbits += known[1:]
    if not orbits:
        return None
    return _in_orders(told(at, np.array(speeds), orbits, ("",) * len(orbits)), found)


def _starts(at: Scene, found: PeriodicResponse, row: int) -> list[Orbit | None]:
    """The rigid motion (None), and motions a little slower and faster, found from the rigid one."""
    starts: list[Orbit | None] = [None]
    for share in ASIDE:
        aside = _reached(at, float(found.speed[row]) * (1.0 + share), None)
        if aside is not None:
            starts.append(aside)
    return starts


def _reached(at: Scene, speed: float, start: Orbit | None) -> Orbit | None:
    """A motion at the speed, carried there in steps from another one; None where the way breaks off."""
    try:
        if start is None:
            return orbit(at, speed)
        for ahead in np.linspace(start.now.loading.speed, speed, STEPS + 1)[1:].tolist():
            start = orbit(at, ahead, start)
    except SolveError:
        return None
    return start


def _differ(at: Scene, one: Orbit, other: Orbit) -> bool:
    """Two motions at one speed are not the same."""
    both = told(at, np.full(2, one.now.loading.speed), [one, other], ("", ""))
    size = np.abs(both.torque)
    return bool(np.abs(size[0] - size[1]).max(initial=0.0) > SAME * size.max(initial=0.0))


def _in_orders(other: PeriodicResponse, found: PeriodicResponse) -> PeriodicResponse:
    """The same response told in the orders of another one."""
    place = {order: k for k, order in enumerate(other.orders)}
    shape = (other.speed.size, len(found.orders))
    angle = np.zeros((*shape, other.angle.shape[2]), dtype=complex)
    torque = np.zeros((*shape, other.torque.shape[2]), dtype=complex)
    for k, order in enumerate(found.orders):
        if order in place:
            angle[:, k], torque[:, k] = other.angle[:, place[order]], other.torque[:, place[order]]
    return replace(other, orders=found.orders, angle=angle, torque=torque)
