"""Lines of cross joints in any planes and phases, the one joint that turns like all of a line, and their best choice.

`plane` is the angle from the previous joint's plane to this one's about the shaft between them (gamma of Ma 2011),
`phase` the angle from the previous joint's driven yoke to this joint's driving yoke (phi of Ma 2011); of the first
joint, the angle from the plane of its shafts to its driving yoke at angle zero (convention P). So Ma 2011, eq. (3):
x_2 = x_1 + error_1 + 90 degrees + phase_2 - plane_2. On z = exp(2 i x) a joint is the disk map (z - q)/(1 - q z) and a
shaft a rotation; their product is again one such map: every line turns as a single joint does.

The line is of constant velocity where B of its disk map vanishes; |B| = sinh(rapidity/2) is what the search for the
best phases, planes or angle makes small, as the two numbers Re B and Im B. Two joints are best with phase = plane, and
the greater rapidity less the other then remains (Ma 2011 finds the same by search).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.joints.cross import Transfer, behind, rapidity, transfer
from torsion.sources import source

Variable = Literal["phase", "angle", "plane"]
_STARTS = 8  # spread starts besides the line as it is; polygons bent back on themselves are saddles
_LIMIT = np.radians(89.99)  # of a joint's angle


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
    def angle(self) -> FloatArray:
        """Angle of the equivalent joint, rad, by its unevenness q = tanh(rapidity/2)."""
        return 2.0 * np.arctan(np.sqrt(np.tanh(self.rapidity / 2.0)))

    @property
    def greatest(self) -> FloatArray:
        """Greatest speed of the last shaft / speed of the first."""
        return np.exp(self.rapidity)

    @property
    def least(self) -> FloatArray:
        """Least speed of the last shaft / speed of the first."""
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
    """Return a line from angles, planes and phases, rad, broadcast against each other to shape (..., joints)."""
    given = np.broadcast_arrays(angle, plane, phase)
    angles, planes, phases = (np.array(values, dtype=float) for values in given)
    if np.any(planes[..., 0] != 0.0):
        raise ValueError("the first joint of a line defines the plane; its own `plane` must be 0")
    return Line(angles, planes, phases)


def motion(driving: ArrayLike, line: Line) -> Transfer:
    """Return what one line does to its driving angle up to behind each joint; arrays of shape (joints, *driving.shape)."""
    turned = np.asarray(driving, dtype=float)
    transfers = [Transfer(np.zeros_like(turned), np.ones_like(turned), np.zeros_like(turned))]
    for angle, offset in zip(line.angle, np.cumsum(line.offset), strict=True):
        transfers.append(
            behind(transfers[-1], transfer(turned + (transfers[-1].error + offset), angle))
        )
    return Transfer(
        *np.stack([(part.error, part.ratio, part.curvature) for part in transfers[1:]], axis=1)
    )


@source("Ma2011", "eq. 3, 6")
def resultant(line: Line) -> Resultant:
    """Return the single joint that turns as the whole line does."""
    first, second = _disk_map(line)
    return Resultant(2.0 * np.arcsinh(np.abs(second)), -np.angle(-second * np.conj(first)) / 2.0)


def _disk_map(line: Line) -> tuple[ComplexArray, ComplexArray]:
    """A, B of the line's disk map (A z + B)/(B* z + A*), |A|^2 - |B|^2 = 1; shape (...)."""
    scale, turn = np.sqrt(np.cos(line.angle)), np.exp(1j * line.offset)
    half = line.angle / 2.0
    sinh_half, cosh_half = np.sin(half) ** 2 / scale, np.cos(half) ** 2 / scale  # of rapidity/2
    first = np.ones(line.angle.shape[:-1], dtype=complex)
    second = np.zeros_like(first)
    for rank in range(line.angle.shape[-1]):
        small, large = sinh_half[..., rank], cosh_half[..., rank]
        ahead, aside = turn[..., rank] * first, turn[..., rank] * second
        first = large * ahead - small * np.conj(aside)
        second = large * aside - small * np.conj(ahead)
    return first, second


def classical_angle(line: Line) -> FloatArray:
    """Return the resulting angle of the handbooks, sqrt|sum angle^2 exp(2 i gamma)| for small angles, rad, shape (...)."""
    gamma = np.cumsum(line.offset, axis=-1)
    total: FloatArray = np.abs(np.sum(line.angle**2 * np.exp(2j * gamma), axis=-1))
    return np.sqrt(total)


@dataclass(frozen=True, slots=True)
class Optimum:
    """The best line found and what it gains."""

    line: Line
    before: Resultant
    after: Resultant
    sensitivity: FloatArray  # (free,) index of fluctuation if that joint is 1 degree off, worse of both senses


def optimise(
    line: Line, variable: Variable = "phase", joints: Sequence[int] | None = None
) -> Optimum:
    """Return the line of least fluctuation over the `variable` of the given joints (of all but the first, if not given).

    Phases and planes of a first joint change nothing, so they are refused. Angles are sought in [0, 89.99 degrees].
    """
    free = tuple(range(1, line.angle.size)) if joints is None else tuple(joints)
    if not free or (variable != "angle" and 0 in free):
        raise ValueError(
            f"a line of {line.angle.size} joints has no {variable} to choose at joints {free}"
        )
    if line.angle.size > 2 or len(free) > 1:
        best = _search(line, variable, free)
    else:
        # Two joints: misphase 0 (modulo 180 degrees, nearest to the given), or tanh a = tanh b cos 2 misphase.
        misphase = line.phase[1] - line.plane[1]
        nearest = misphase - np.pi * np.round(misphase / np.pi)
        value = line.phase[1] - nearest if variable == "phase" else line.plane[1] + nearest
        if variable == "angle":
            square_sine = np.sin(line.angle[1 - free[0]]) ** 2
            tangent = square_sine / (2.0 - square_sine) * np.cos(2.0 * misphase)
            tangent = max(0.0, float(tangent))
            value = np.arctan2(np.sqrt(2.0 * tangent), np.sqrt(1.0 - tangent))
        best = _changed(line, variable, free, np.array([value]))
    worst, error = [], np.pi / 180.0
    for joint in free:
        value = float(getattr(best, variable)[joint])
        below = abs(value - error) if variable == "angle" else value - error
        indices = index_over(best, variable, joint, np.array([below, value + error]))
        worst.append(float(indices.max()))
    return Optimum(best, resultant(line), resultant(best), np.array(worst))


def index_over(line: Line, variable: Variable, joint: int, values: FloatArray) -> FloatArray:
    """Return the index of fluctuation (values,) of a line as one joint's phase, plane or angle takes the values, rad."""
    many = Line(
        *(np.tile(angles, (values.size, 1)) for angles in (line.angle, line.plane, line.phase))
    )
    getattr(many, variable)[:, joint] = values
    return resultant(many).index


def _search(line: Line, variable: Variable, free: tuple[int, ...]) -> Line:
    """Least squares of (Re B, Im B) from the line as it is and from spread starts; the first of the least wins."""
    from scipy.optimize import least_squares

    def lack(values: FloatArray) -> FloatArray:
        _, closing = _disk_map(_changed(line, variable, free, values))
        return np.array([closing.real, closing.imag])

    def slope(values: FloatArray) -> FloatArray:
        """Return the derivative: B holds exp(+-i phase) only, so that it is B at pi/2 more."""
        quarters = np.pi / 2.0 * np.eye(len(free))
        return np.stack([lack(values + quarter) for quarter in quarters], axis=1)

    # Of phases or planes the least is that of the polygon that does not close.
    sizes = rapidity(line.angle)
    bounds, bound = (0.0, _LIMIT), 0.0
    derivative: Any = "3-point"
    if variable != "angle":
        bounds, derivative = (-np.inf, np.inf), slope
        bound = float(np.sinh(max(0.0, 2.0 * sizes.max() - sizes.sum()) / 2.0))
    rounding = 4.0 * np.finfo(float).eps * line.angle.size * float(np.exp(sizes.sum() / 2.0))
    spread = np.random.default_rng(0).uniform(0.0, np.pi / 2.0, (_STARTS, len(free)))
    answers: list[tuple[float, FloatArray]] = []
    for start in (getattr(line, variable)[list(free)], *spread):
        answer = least_squares(lack, start, derivative, bounds, xtol=1e-15, ftol=1e-15, gtol=None)
        answers.append((float(np.hypot(*answer.fun)), np.asarray(answer.x, dtype=float)))
        if answers[-1][0] <= bound + rounding:
            break
    return _changed(line, variable, free, min(answers, key=lambda pair: pair[0])[1])


def _changed(line: Line, variable: Variable, joints: tuple[int, ...], values: FloatArray) -> Line:
    """The line with other values at some joints."""
    changed = np.array(getattr(line, variable))
    changed[list(joints)] = values
    return replace(line, **{variable: changed})
