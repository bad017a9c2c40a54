"""How a train turns without any torque: evenly, or by a program of its speed."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray


@dataclass(frozen=True)
class Carrier:
    """How all stations turn without any torque: from where they stand, at their speeds, and as one is made to."""

    offset: FloatArray  # (stations,) rad, own shafts
    speed: FloatArray  # (stations,) rad/s at time 0
    ratio: FloatArray  # (stations,)
    rates: tuple[
        tuple[float, float, float], ...
    ] = ()  # begin and end (s) and rate (rad/s2) of the reference

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Angles, speeds and accelerations (stations, times)."""
        angle, speed, rate = np.zeros((3, len(time)))
        for begin, end, gain in self.rates:
            lasts = np.clip(time - begin, 0.0, end - begin)
            angle += gain * lasts * (lasts / 2.0 + np.maximum(time - end, 0.0))
            speed += gain * lasts
            rate += gain * ((time >= begin) & (time < end))
        turned = self.offset[:, None] + np.multiply.outer(self.speed, time)
        outer = np.multiply.outer
        return (
            turned + outer(self.ratio, angle),
            self.speed[:, None] + outer(self.ratio, speed),
            outer(self.ratio, rate),
        )
