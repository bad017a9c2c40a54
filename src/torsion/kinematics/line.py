"""Lines of cross joints: any number of joints in any planes and phases, and the one joint that turns like all of them.

`plane` is the angle from the previous joint's plane to this one's about the shaft between them (gamma of Ma 2011),
`phase` the angle from the previous joint's driven yoke to this joint's driving yoke (phi of Ma 2011); of the first
joint, the angle from the plane of its shafts to its driving yoke at angle zero (convention P). So Ma 2011, eq. (3):
x_2 = x_1 + error_1 + 90 degrees + phase_2 - plane_2. On z = exp(2 i x) a joint is the disk map (z - q)/(1 - q z) and a
shaft a rotation; their product is again one such map: every line turns as a single joint does.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import ComplexArray, FloatArray
from torsion.kinematics.cross import Transfer, behind, rapidity, transfer


@dataclass(frozen=True, slots=True)
class Line:
    """Joints in the direction of power flow; arrays (..., joints), rad; leading axes are lines side by side."""

    angle: FloatArray
    plane: FloatArray  # 0 of the first joint
    phase: FloatArray

    @property
    def offset(self) -> FloatArray:
        """Added to an angle on its way from joint to joint, to count it in convention P; (..., joints), rad."""
        shift = self.phase - self.plane
        shift[..., 1:] += np.pi / 2.0
        return shift


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion of the shaft behind each joint; arrays of shape (joints, *driving.shape)."""

    error: FloatArray  # shaft's angle minus driving angle, rad
    speed: FloatArray  # rad/s, or a ratio if the driving speed was 1
    acceleration: FloatArray  # rad/s^2
    yoke: FloatArray  # rad: this joint's driving yoke from this joint's plane (x of convention P)


@dataclass(frozen=True, slots=True)
class Resultant:
    """The single joint that turns as the line does; arrays of shape (..., joints) for the line up to each joint.

    The shaft behind runs at cosh/sinh of `rapidity`: greatest ratio exp(rapidity), least exp(-rapidity).
    """

    rapidity: FloatArray
    phase: FloatArray  # rad, convention P: the greatest speed stands at driving angle -phase (modulo pi)
    lead: FloatArray  # rad: mean over the driving angle of the shaft's angle minus the driving angle

    @property
    def unevenness(self) -> FloatArray:
        """q of the equivalent joint: order-2 amplitude of the line's transmission error, rad."""
        return np.tanh(self.rapidity / 2.0)

    @property
    def angle(self) -> FloatArray:
        """Angle of the equivalent joint, rad."""
        return 2.0 * np.arctan(np.sqrt(self.unevenness))

    @property
    def greatest(self) -> FloatArray:
        """Greatest speed ratio."""
        return np.exp(self.rapidity)

    @property
    def least(self) -> FloatArray:
        """Least speed ratio."""
        return np.exp(-self.rapidity)

    @property
    def index(self) -> FloatArray:
        """Index of fluctuation, (greatest - least)/mean speed at constant driving speed (Ma 2011, eq. 6)."""
        return 2.0 * np.sinh(self.rapidity)

    @property
    def greatest_at(self) -> FloatArray:
        """Driving angle of the greatest speed, rad, 0 <= angle < pi; the least stands 90 degrees from it."""
        return np.mod(-self.phase, np.pi)


def line_of(angle: ArrayLike, plane: ArrayLike = 0.0, phase: ArrayLike = 0.0) -> Line:
    """A line from angles, planes and phases, rad, broadcast against each other to shape (..., joints)."""
    given = (np.asarray(angle, dtype=float), np.asarray(plane, dtype=float), np.asarray(phase, dtype=float))
    angles, planes, phases = (np.array(each) for each in np.broadcast_arrays(*given))
    if np.any(planes[..., 0] != 0.0):
        raise ValueError("the first joint of a line defines the plane; its own `plane` must be 0")
    return Line(angles, planes, phases)


def motion(driving: ArrayLike, line: Line, speed: ArrayLike = 1.0, acceleration: ArrayLike = 0.0) -> Motion:
    """Angle, speed and acceleration behind each joint of one line, driven at `speed` and `acceleration`."""
    turned = np.asarray(driving, dtype=float)
    shape = np.broadcast_shapes(turned.shape, np.shape(speed), np.shape(acceleration))
    before = Transfer(np.zeros(shape), np.broadcast_to(speed, shape), np.broadcast_to(acceleration, shape))
    result = np.empty((4, line.angle.size, *shape))
    for rank, (angle, offset) in enumerate(zip(line.angle, np.cumsum(line.offset), strict=True)):
        yoke = turned + (before.error + offset)
        before = behind(before, transfer(yoke, angle))
        result[:, rank] = before.error, before.ratio, before.curvature, yoke
    return Motion(*result)


def resultants(line: Line) -> Resultant:
    """The single joint that turns as the line does, up to each joint."""
    first, second, lead = _products(line)
    return Resultant(2.0 * np.arcsinh(np.abs(second)), -np.angle(-second * np.conj(first)) / 2.0, lead)


def resultant(line: Line) -> Resultant:
    """The single joint that turns as the whole line does; arrays of shape (...)."""
    every = resultants(line)
    return Resultant(every.rapidity[..., -1], every.phase[..., -1], every.lead[..., -1])


def residue(line: Line) -> ComplexArray:
    """B of the line's disk map, shape (...): |B| = sinh(rapidity/2), and B = 0 for a line of constant velocity."""
    return _products(line)[1][..., -1]


def _products(line: Line) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """A, B of the disk maps (A z + B)/(B* z + A*), |A|^2 - |B|^2 = 1, up to each joint, and their mean lead, rad.

    The lead of a joint is the mean of its error over the line's own driving angle: the value at z = 0, for the error
    is the imaginary part of a function analytic in the disk.
    """
    scale = np.sqrt(np.cos(line.angle))
    less, more = np.sin(line.angle / 2.0) ** 2 / scale, np.cos(line.angle / 2.0) ** 2 / scale  # sinh, cosh rapidity/2
    turn, shift = np.exp(1j * line.offset), np.empty(line.angle.shape)
    first, second = np.empty(line.angle.shape, dtype=complex), np.empty(line.angle.shape, dtype=complex)
    ahead: ComplexArray = turn[..., 0]
    aside: ComplexArray = np.zeros_like(ahead)
    for rank in range(line.angle.shape[-1]):
        if rank:
            ahead, aside = turn[..., rank] * first[..., rank - 1], turn[..., rank] * second[..., rank - 1]
        small, large = less[..., rank], more[..., rank]
        shift[..., rank] = np.angle(1.0 - small / large * np.conj(aside) / ahead)
        first[..., rank] = large * ahead - small * np.conj(aside)
        second[..., rank] = large * aside - small * np.conj(ahead)
    return first, second, np.cumsum(shift, axis=-1)


def classical_angle(line: Line) -> FloatArray:
    """Resulting joint angle of the handbooks, sqrt|sum angle^2 exp(2 i gamma)| for small angles, rad, shape (...)."""
    gamma = np.cumsum(line.offset, axis=-1)
    total: FloatArray = np.abs(np.sum(line.angle**2 * np.exp(2j * gamma), axis=-1))
    return np.sqrt(total)


def rapidity_bound(line: Line) -> FloatArray:
    """Least rapidity that phases or planes alone can reach, shape (...): that of the polygon that does not close."""
    sizes = rapidity(line.angle)
    excess: FloatArray = 2.0 * sizes.max(axis=-1) - sizes.sum(axis=-1)
    return np.maximum(0.0, excess)
