"""Dry friction over time: a torque against the rotation that does not depend on its speed, and holds while it suffices.

Stations that turn as one, whatever their ratios, slip and stand together, and one law has their frictions.
"""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.collocation import AT_LIMIT, Conditions, Law, Limits, Points
from torsion.kernels.motion.torques.torque_laws import Window

BACKWARD, STANDS, FORWARD, FREE = range(4)  # FREE: none of it acts
# of the speed scale: what the accuracy of a step may leave of the speed of a station that stands
STANDING = 1e-9
# of the friction: a torque that exceeds it by less breaks nothing away, as rounding may
MORE = 1e-9
RETURN = 1e3  # 1/s, rate at which that is taken back


@dataclass(frozen=True)
class DryFriction(Law):
    """Friction at the stations of its interfaces.

    While they stand, the acceleration of the first is 0, and each carries its share, as of the friction.
    """

    interface: int  # of the first station
    torque: tuple[float, ...]  # N m of each
    scale: float  # rad/s of the first
    windows: tuple[Window, ...] = (Window(),)
    ratio: tuple[float, ...] = (1.0,)  # speed of each by that of the first
    inertia: float = 1.0  # kg m2 of the first, that makes a torque of its acceleration
    neighbours: tuple[int, ...] = ()  # interfaces of other laws at these stations

    @property
    def count(self) -> int:
        return len(self.torque)

    @property
    def cuts(self) -> tuple[float, ...]:
        return tuple(cut for window in self.windows for cut in window.cuts)

    def first(self, points: Points) -> int:
        speed = float(points.speed[0, 0])
        if not self._acting(points.time).any():
            return FREE
        if abs(speed) <= STANDING * self.scale:
            return STANDS
        return FORWARD if speed > 0.0 else BACKWARD

    def conditions(self, regime: int, points: Points) -> Conditions:
        ratio, acting = np.array(self.ratio), self._acting(points.time)
        forward = np.sign(ratio)[:, None] * acting
        if regime != STANDS:
            sense = 0 if regime == FREE else BACKWARD + 1 - regime
            return Conditions(sense * forward - points.torque)
        number = len(ratio)
        share = forward / (np.abs(ratio) @ acting)
        lack = share * (ratio @ points.torque) - points.torque
        by_torque = share[:, None] * ratio[:, None] - np.eye(number)[:, :, None]
        by_speed, by_acceleration = np.zeros((2, number, number, len(points.time)))
        by_torque[0] = 0.0
        by_speed[0, 0], by_acceleration[0, 0] = -RETURN * self.inertia, -self.inertia
        lack[0] = -self.inertia * (points.acceleration[0] + RETURN * points.speed[0])
        return Conditions(lack, by_torque, by_speed=by_speed, by_acceleration=by_acceleration)

    def limits(self, regime: int, points: Points) -> Limits:
        if regime == FREE:
            return []
        if regime != STANDS:
            share = points.speed[0] * (AT_LIMIT / (STANDING * self.scale))
            return [(share if regime == FORWARD else -share, STANDS)]
        ratio = np.array(self.ratio)
        friction = np.abs(ratio) @ self._acting(points.time)
        # Nothing acts at the very end of a window.
        share = (ratio @ points.torque) / np.where(friction > 0.0, friction, np.inf)
        factor = AT_LIMIT / MORE
        return [((1.0 + share) * factor, FORWARD), ((1.0 - share) * factor, BACKWARD)]

    def still(self, regime: int) -> tuple[int, ...]:
        return self.neighbours if regime == STANDS else ()

    def _acting(self, time: FloatArray) -> FloatArray:
        """Friction that acts at each interface, (interfaces, times) N m."""
        pairs = zip(self.torque, self.windows, strict=True)
        return np.array([torque * window.holds(time) for torque, window in pairs])
