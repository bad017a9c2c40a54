"""A line of joints as one joint: resultant, extremes, and the best choice of its phases, planes or angles."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from torsion.analyses.joints.found import Extreme, LineFound, OptimumFound
from torsion.analyses.joints.line import Placed, crosses, motions
from torsion.arrays import FloatArray
from torsion.kinematics.cross import extremes
from torsion.kinematics.line import Line, classical_angle, resultant
from torsion.kinematics.optimise import Variable, index_over, optimise

_SAMPLES = 1440  # of a turn, in which every extreme of speed or acceleration is first sought
_WIDEST = math.radians(45.0)  # of a joint's angle in the picture of the index


def line_found(joints: Sequence[Placed], path: tuple[int, ...], optimum: OptimumFound | None) -> LineFound:
    """The joints of one path as one: the resultant of its cross joints, the speeds of all."""
    chosen, line = crosses(joints, path)
    if not chosen:
        line = Line(*np.zeros((3, 1)))
    one = resultant(line)
    at = float(one.greatest_at)
    greatest = Extreme(float(one.greatest), at)
    least = Extreme(float(one.least), math.fmod(at + math.pi / 2.0, math.pi))
    index = float(one.index)
    if has_third_order(joints, path):
        greatest, least = _extreme(joints, path, 1.0), _extreme(joints, path, -1.0)
        index = greatest.speed_ratio - least.speed_ratio
    return LineFound(
        path, float(one.angle), float(one.phase), float(classical_angle(line)), index, greatest, least, optimum
    )


def has_third_order(joints: Sequence[Placed], path: Sequence[int]) -> bool:
    """A tripod on the path moves the end of its shaft: no single cross joint turns as the line does."""
    return any(joints[k].joint.order == 3 and joints[k].joint.angle > 0 for k in path)


def _extreme(joints: Sequence[Placed], path: tuple[int, ...], sense: float) -> Extreme:
    """The extreme of the sampled speed, refined to where the acceleration vanishes."""
    alone, step = _alone(joints, path), 2.0 * math.pi / _SAMPLES

    def acceleration(angle: float) -> float:
        return float(motions(alone, np.array([angle]))[-1].acceleration[0])

    turned = np.linspace(0.0, 2.0 * math.pi, _SAMPLES, endpoint=False)
    near = float(turned[int(np.argmax(sense * motions(alone, turned)[-1].speed))])
    if acceleration(near - step) * acceleration(near + step) < 0.0:
        near = float(brentq(acceleration, near - step, near + step, xtol=1e-15))
    return Extreme(float(motions(alone, np.array([near]))[-1].speed[0]), math.fmod(near + 2.0 * math.pi, 2.0 * math.pi))


def steepest(joints: Sequence[Placed], path: tuple[int, ...]) -> float:
    """Greatest magnitude of the acceleration behind the last joint of a path at speed 1, 1/rad."""
    chosen, line = crosses(joints, path)
    if not has_third_order(joints, path):
        return float(extremes(resultant(line).angle).curvature) if chosen else 0.0
    alone = _alone(joints, path)
    size = np.abs(motions(alone, np.linspace(0.0, 2.0 * math.pi, _SAMPLES, endpoint=False))[-1].acceleration)
    at = int(np.argmax(size))
    before, top, behind = size[at - 1], size[at], size[(at + 1) % _SAMPLES]
    bow = before - 2.0 * top + behind  # vertex of the parabola through the three
    return float(top if bow >= 0.0 else top - (behind - before) ** 2 / (8.0 * bow))


def _alone(joints: Sequence[Placed], path: tuple[int, ...]) -> tuple[Placed, ...]:
    """The joints of a path alone, counted anew."""
    return tuple(replace(joints[k], before=rank - 1 if rank else None) for rank, k in enumerate(path))


def optimum_found(
    joints: Sequence[Placed], path: tuple[int, ...], variable: Variable, free: Sequence[int] | None
) -> OptimumFound | None:
    """The best choice for the cross joints of a path, tripods left out; None where there is nothing to choose.

    free: positions in `joints` that may be changed, all cross joints but the first if None.
    """
    chosen, line = crosses(joints, path)
    ranks = range(1, len(chosen)) if free is None else [chosen.index(k) for k in free if k in chosen]
    ranks = [rank for rank in ranks if rank > 0 or variable == "angle"]
    if len(chosen) < 2 or not ranks:
        return None
    best = optimise(line, variable, ranks)
    before = [_own(joints[chosen[rank]], variable) for rank in ranks]
    changes = [float(getattr(best.line, variable)[rank] - getattr(line, variable)[rank]) for rank in ranks]
    if variable != "angle":
        changes = [math.remainder(change, math.pi) for change in changes]
    over, values = _range(line, variable, ranks[0], before[0], before[0] + changes[0])
    return OptimumFound(
        variable=variable,
        names=tuple(joints[chosen[rank]].name for rank in ranks),
        before=tuple(before),
        best=tuple(old + change for old, change in zip(before, changes, strict=True)),
        index_before=float(best.before.index),
        index_best=float(best.after.index),
        sensitivity=tuple(float(value) for value in best.sensitivity),
        over=over,
        index_over=index_over(line, variable, ranks[0], values),
    )


def _own(place: Placed, variable: Variable) -> float:
    """The value as the file gives it, rad."""
    joint = place.joint
    return {"phase": joint.phase, "plane": joint.plane, "angle": joint.angle}[variable]


def _range(line: Line, variable: Variable, rank: int, before: float, best: float) -> tuple[FloatArray, FloatArray]:
    """Values of a joint's variable to show, rad, and the same as the line counts them."""
    if variable == "angle":
        angles = np.linspace(0.0, max(_WIDEST, before, best), 361)
        return angles, angles
    around = np.linspace(0.0, 2.0 * math.pi, 361)
    return around, around + (float(getattr(line, variable)[rank]) - before)
