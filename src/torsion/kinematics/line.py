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
from torsion.kinematics.cross import Transfer, behind, transfer


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
class Resultant:
    """The single joint that turns as the whole line does; arrays of shape (...).

    The shaft behind runs at cosh/sinh of `rapidity`: greatest ratio exp(rapidity), least exp(-rapidity).
    """

    rapidity: FloatArray
    phase: FloatArray  # rad, convention P: the greatest speed stands at driving angle -phase (modulo pi)

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


def motion(driving: ArrayLike, line: Line) -> Transfer:
    """What one line does to its driving angle up to behind each joint; arrays of shape (joints, *driving.shape)."""
    turned = np.asarray(driving, dtype=float)
    found = [Transfer(np.zeros_like(turned), np.ones_like(turned), np.zeros_like(turned))]
    for angle, offset in zip(line.angle, np.cumsum(line.offset), strict=True):
        found.append(behind(found[-1], transfer(turned + (found[-1].error + offset), angle)))
    return Transfer(*np.stack([(one.error, one.ratio, one.curvature) for one in found[1:]], axis=1))


def resultant(line: Line) -> Resultant:
    """The single joint that turns as the whole line does."""
    first, second = _disk_map(line)
    return Resultant(2.0 * np.arcsinh(np.abs(second)), -np.angle(-second * np.conj(first)) / 2.0)


def residue(line: Line) -> ComplexArray:
    """B of the line's disk map, shape (...): |B| = sinh(rapidity/2), and B = 0 for a line of constant velocity."""
    return _disk_map(line)[1]


def _disk_map(line: Line) -> tuple[ComplexArray, ComplexArray]:
    """A, B of the line's disk map (A z + B)/(B* z + A*), |A|^2 - |B|^2 = 1; shape (...)."""
    scale, turn = np.sqrt(np.cos(line.angle)), np.exp(1j * line.offset)
    less, more = np.sin(line.angle / 2.0) ** 2 / scale, np.cos(line.angle / 2.0) ** 2 / scale  # sinh, cosh rapidity/2
    first = np.ones(line.angle.shape[:-1], dtype=complex)
    second = np.zeros_like(first)
    for rank in range(line.angle.shape[-1]):
        small, large = less[..., rank], more[..., rank]
        ahead, aside = turn[..., rank] * first, turn[..., rank] * second
        first, second = large * ahead - small * np.conj(aside), large * aside - small * np.conj(ahead)
    return first, second


def classical_angle(line: Line) -> FloatArray:
    """Resulting joint angle of the handbooks, sqrt|sum angle^2 exp(2 i gamma)| for small angles, rad, shape (...)."""
    gamma = np.cumsum(line.offset, axis=-1)
    total: FloatArray = np.abs(np.sum(line.angle**2 * np.exp(2j * gamma), axis=-1))
    return np.sqrt(total)
