"""Dry friction over time: a torque against the rotation that does not depend on its speed, and holds while it suffices.

Stations that turn as one, whatever their ratios, slip and stand together, and one law has their frictions.
"""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.collocation import AT_LIMIT, Conditions, Points
from torsion.kernels.motion.torque_laws import Window

BACKWARD, STANDS, FORWARD, FREE = range(4)  # FREE: none of it acts
STANDING = 1e-9  # of the speed scale: what the accuracy of a step may leave of the speed of a station that stands
MORE = (
    1e-9  # of the friction: a torque that exceeds it by less breaks nothing away, as rounding may
)
RETURN = 1e3  # 1/s, rate at which that is taken back


@dataclass(frozen=True)
class DryFriction:
    """Friction at the stations of its interfaces.

    While they stand, the acceleration of the first is 0, and each carries its share, as of the friction.
    """

    at: tuple[int, ...]
    torque: tuple[float, ...]  # N m of each
    scale: float  # rad/s of the first
    windows: tuple[Window, ...] = (Window(),)
    ratio: tuple[float, ...] = (1.0,)  # speed of each by that of the first
    inertia: float = 1.0  # kg m2 of the first, that makes a torque of its acceleration
    beside: tuple[int, ...] = ()  # interfaces of other laws at these stations

    @property
    def cuts(self) -> tuple[float, ...]:
        return tuple(cut for window in self.windows for cut in window.cuts)

    def first(self, points: Points) -> int:
        speed = float(points.speed[0, 0])
        if not self._acting(points.time).any():
            return FREE
        return (
            STANDS if abs(speed) <= STANDING * self.scale else FORWARD if speed > 0.0 else BACKWARD
        )

    def conditions(self, regime: int, points: Points) -> Conditions:
        ratio, acting = np.array(self.ratio), self._acting(points.time)
        forward = np.sign(ratio)[:, None] * acting
        if regime != STANDS:
            sense = 0 if regime == FREE else BACKWARD + 1 - regime
            return Conditions(sense * forward - points.torque)
        number = len(ratio)
        net, whole = ratio @ points.torque, np.abs(ratio) @ acting
        share = forward / whole
        lack = share * net - points.torque
        by_torque = share[:, None] * ratio[:, None] - np.eye(number)[:, :, None]
        by_speed, by_acceleration = np.zeros((2, number, number, len(points.time)))
        by_torque[0], by_speed[0, 0], by_acceleration[0, 0] = (
            0.0,
            -RETURN * self.inertia,
            -self.inertia,
        )
        lack[0] = -self.inertia * (points.acceleration[0] + RETURN * points.speed[0])
        return Conditions(lack, by_torque, by_speed=by_speed, by_acceleration=by_acceleration)

    def limits(self, regime: int, points: Points) -> list[tuple[FloatArray, int]]:
        if regime == FREE:
            return []
        if regime != STANDS:
            share = points.speed[0] * (AT_LIMIT / (STANDING * self.scale))
            return [(share if regime == FORWARD else -share, STANDS)]
        ratio = np.array(self.ratio)
        whole = np.abs(ratio) @ self._acting(points.time)
        share = (ratio @ points.torque) / np.where(
            whole > 0.0, whole, np.inf
        )  # nothing acts at its very end
        return [
            ((1.0 + share) * (AT_LIMIT / MORE), FORWARD),
            ((1.0 - share) * (AT_LIMIT / MORE), BACKWARD),
        ]

    def still(self, regime: int) -> tuple[int, ...]:
        return self.beside if regime == STANDS else ()

    def _acting(self, time: FloatArray) -> FloatArray:
        """(interfaces, times) N m."""
        return np.array(
            [
                size * window.holds(time)
                for size, window in zip(self.torque, self.windows, strict=True)
            ]
        )
