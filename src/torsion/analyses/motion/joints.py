"""What a joint makes of an angle: its transmission error with three derivatives, and how joints in a row combine."""

from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.spans import Span
from torsion.assembly.system import System
from torsion.errors import SolveError


@dataclass(frozen=True)
class JointMap:
    """Driven angle = driving angle + error, at the own speeds of both sides.

    A cross joint is exact: error = -arg(1 - q exp(2 i (angle + yoke))), q = tan(joint angle/2)^2 (convention P); the
    map with -q undoes it. Any other joint is the Fourier sum of its constraint.
    """

    driving_ratio: float  # speed of the driving side / reference speed
    driven_ratio: float
    unevenness: float  # q; 0 where a series is used
    yoke: float  # rad
    series: tuple[tuple[int, complex], ...] = ()

    @property
    def strength(self) -> float:
        """Half of the amplitude by which the ratio varies: q of a cross joint, order times error / 2 of a series."""
        return abs(self.unevenness) + sum(order * abs(amplitude) for order, amplitude in self.series) / 2.0

    def undone(self) -> "JointMap":
        """The map from the driven side back; raises SolveError where only a series is known."""
        if self.series:
            raise SolveError("a tripod joint that is driven from its driven side by a held station is not built")
        return replace(self, unevenness=-self.unevenness)


def joint_map(system: System, span: Span) -> JointMap:
    """The map of a span with an error."""
    ratios = float(system.speed_ratio[span.driving]), float(system.speed_ratio[span.driven])
    joint = system.train.parts[span.part].joint
    if joint is None or joint.kind != "cross":
        return JointMap(*ratios, 0.0, 0.0, span.error)
    amplitude = span.error[0][1]
    return JointMap(*ratios, abs(amplitude), float(np.angle(1j * amplitude)) / 2.0)


def error(joint: JointMap, angle: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Transmission error (rad) and its derivatives over the driving angle, at driving angles at own speed.

    With w = q z/(1 - q z): e' = 2 Re w, e'' = -4 Im(w + w^2), e''' = -8 Re(w (1 + w)(1 + 2 w)).
    """
    if joint.series:
        sums = np.zeros((4, *angle.shape))
        for order, amplitude in joint.series:
            part = amplitude * np.exp(1j * order * angle)
            for k in range(4):
                sums[k] += ((1j * order) ** k * part).real
        return sums[0], sums[1], sums[2], sums[3]
    turned = joint.unevenness * np.exp(2j * (angle + joint.yoke))
    w = turned / (1.0 - turned)
    bent = w * (1.0 + w)
    return -np.angle(1.0 - turned), 2.0 * w.real, -4.0 * bent.imag, -8.0 * (bent * (1.0 + 2.0 * w)).real


@dataclass(frozen=True)
class Turning:
    """Deviation of a station's angle from the mean motion, and the derivatives of its angle over its coordinate.

    All at one speed (own angle / speed ratio).
    """

    deviation: FloatArray  # rad
    first: FloatArray
    second: FloatArray
    third: FloatArray


def beyond(before: Turning, joint: JointMap, turned: FloatArray) -> Turning:
    """The turning of the station behind a joint; `turned` is the mean angle of the reference station, rad."""
    r, s = joint.driving_ratio, joint.driven_ratio
    e0, e1, e2, e3 = error(joint, r * (turned + before.deviation))
    g1, g2, g3 = 1.0 + e1 * r / s, e2 * r * r / s, e3 * r**3 / s
    f1, f2, f3 = before.first, before.second, before.third
    return Turning(before.deviation + e0 / s, g1 * f1, g2 * f1**2 + g1 * f2, g3 * f1**3 + 3.0 * g2 * f1 * f2 + g1 * f3)


def at_rest(deviation: FloatArray) -> Turning:
    """The turning of the station that a coordinate is the angle of."""
    return Turning(deviation, np.ones_like(deviation), np.zeros_like(deviation), np.zeros_like(deviation))
