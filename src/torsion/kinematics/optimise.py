"""The best phases, planes or joint angle of a line: closed form for two joints, scipy's least squares for more.

The line is of constant velocity where B of its disk map vanishes (line.residue); |B| = sinh(rapidity/2) is what the
search makes small, as the two numbers Re B and Im B. Two joints are best with phase = plane, and the greater rapidity
less the other then remains (Ma 2011 finds the same by search).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from torsion.arrays import FloatArray
from torsion.kinematics.cross import rapidity
from torsion.kinematics.line import Line, Resultant, residue, resultant

Variable = Literal["phase", "plane", "angle"]
_STARTS = 8  # spread starts besides the line as it is; polygons bent back on themselves are saddles
_LIMIT = np.radians(89.99)  # of a joint's angle


@dataclass(frozen=True, slots=True)
class Optimum:
    """The best line found and what it gains."""

    line: Line
    before: Resultant
    after: Resultant
    sensitivity: FloatArray  # (free,) index of fluctuation if that joint is `assembly_error` off, worse of both senses


def optimise(
    line: Line,
    variable: Variable = "phase",
    joints: Sequence[int] | None = None,
    *,
    assembly_error: float = np.pi / 180.0,
) -> Optimum:
    """The line of least fluctuation over the `variable` of the given joints (of all but the first, if not given).

    Phases and planes of a first joint change nothing, so they are refused. Angles are sought in [0, 89.99 degrees].
    """
    free = tuple(range(1, line.angle.size)) if joints is None else tuple(joints)
    if not free or (variable != "angle" and 0 in free):
        raise ValueError(f"a line of {line.angle.size} joints has no {variable} to choose at joints {free}")
    best = _pair(line, variable, free[0]) if line.angle.size == 2 and len(free) == 1 else _search(line, variable, free)
    return Optimum(best, resultant(line), resultant(best), _sensitivity(best, variable, free, assembly_error))


def index_over(line: Line, variable: Variable, joint: int, values: FloatArray) -> FloatArray:
    """Index of fluctuation of the line, shape (values,), as one joint's phase, plane or angle takes the values, rad."""
    many = Line(*(np.tile(each, (values.size, 1)) for each in (line.angle, line.plane, line.phase)))
    getattr(many, variable)[:, joint] = values
    return resultant(many).index


def _pair(line: Line, variable: Variable, joint: int) -> Line:
    """Two joints: misphase 0 (modulo 180 degrees, nearest to the given), or tanh a = tanh b cos 2 misphase."""
    misphase = line.phase[1] - line.plane[1]
    if variable == "angle":
        other = np.sin(line.angle[1 - joint]) ** 2  # tanh of its rapidity is other/(2 - other)
        tangent = max(0.0, float(other / (2.0 - other) * np.cos(2.0 * misphase)))
        return _with(line, variable, (joint,), np.arctan2(np.sqrt([2.0 * tangent]), np.sqrt(1.0 - tangent)))
    nearest = misphase - np.pi * np.round(misphase / np.pi)
    value = line.phase[1] - nearest if variable == "phase" else line.plane[1] + nearest
    return _with(line, variable, (joint,), np.array([value]))


def _search(line: Line, variable: Variable, free: tuple[int, ...]) -> Line:
    """Least squares of (Re B, Im B) from the line as it is and from spread starts; the first of the least wins."""
    from scipy.optimize import least_squares

    def lack(values: FloatArray) -> FloatArray:
        closing = residue(_with(line, variable, free, values))
        return np.array([closing.real, closing.imag])

    def slope(values: FloatArray) -> FloatArray:  # B holds exp(+-i phase) only: its derivative is B at pi/2 more
        return np.stack([lack(values + quarter) for quarter in np.pi / 2.0 * np.eye(len(free))], axis=1)

    bounds = (0.0, _LIMIT) if variable == "angle" else (-np.inf, np.inf)
    sizes = rapidity(line.angle)  # of phases or planes the least is that of the polygon that does not close
    bound = float(np.sinh(max(0.0, 2.0 * sizes.max() - sizes.sum()) / 2.0)) if variable != "angle" else 0.0
    rounding = 4.0 * np.finfo(float).eps * line.angle.size * float(np.exp(sizes.sum() / 2.0))
    spread = np.random.default_rng(0).uniform(0.0, np.pi / 2.0, (_STARTS, len(free)))
    found: list[tuple[float, FloatArray]] = []
    for start in (getattr(line, variable)[list(free)], *spread):
        answer = least_squares(
            lack, start, "3-point" if variable == "angle" else slope, bounds, xtol=1e-15, ftol=1e-15, gtol=None
        )
        found.append((float(np.hypot(*answer.fun)), np.asarray(answer.x, dtype=float)))
        if found[-1][0] <= bound + rounding:
            break
    return _with(line, variable, free, min(found, key=lambda pair: pair[0])[1])


def _sensitivity(line: Line, variable: Variable, free: tuple[int, ...], error: float) -> FloatArray:
    """Index with one free joint off by +-error, the worse sense; (free,)."""
    worst = []
    for joint in free:
        value = float(getattr(line, variable)[joint])
        below = abs(value - error) if variable == "angle" else value - error
        worst.append(float(index_over(line, variable, joint, np.array([below, value + error])).max()))
    return np.array(worst)


def _with(line: Line, variable: Variable, joints: tuple[int, ...], values: FloatArray) -> Line:
    """The line with other values at some joints."""
    changed = np.array(getattr(line, variable))
    changed[list(joints)] = values
    return Line(**{"angle": line.angle, "plane": line.plane, "phase": line.phase, variable: changed})
