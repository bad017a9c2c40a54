"""Map of the growth rate over speed and one more quantity: joint angle, damping or mean torque.

The train is reduced to the modes that matter: deviation = rigid motion of the joints + modes of the straight train. All
values of the second quantity are solved side by side at one speed, each started from its solution at the speed before.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from torsion.analyses.stability.equations_of_motion import scaled
from torsion.analyses.stability.floquet_exponents import Search, damped, modes_that_matter
from torsion.analyses.stability.mechanism import JointStep
from torsion.analyses.stability.mechanism_loads import Scene, scene
from torsion.analyses.stability.periodic_orbits import harmonics_at_least
from torsion.analyses.stability.straight_modes import Basis, basis
from torsion.analyses.stability.variant_stack import Stack, growths, half_range, solve_stack
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress, silent
from torsion.kernels.joints.cross import unevenness
from torsion.kernels.periodic.harmonic_balance import motion_of, points_in_time
from torsion.results import reported, result
from torsion.study import Study

Over = Literal["angle", "damping", "torque"]
SIDE_BY_SIDE = 25  # values solved at a time, to stay within the caches
SAME_MOTION = 0.02  # relative: periodic motions that differ by more are not the same
CHECKED = 9  # points at which the unreduced train is computed too
MOST_ALONE = 1000  # points that are solved one by one where they found no solution side by side


@reported
class StabilityMap:
    """Growth rates; NaN where no periodic motion was found."""

    over: Over = result("", (), "angle, damping or torque")
    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    value: FloatArray = result("", ("value",), "joint angles in rad, or factors")
    growth: FloatArray = result("1/s", ("speed", "value"), "null if no periodic motion was found")
    modes: int = result("", (), "elastic modes kept")
    of_modes: int = result("", (), "of so many")
    error: float = result("1/s", (), "largest difference to the whole train at the points checked")
    checked: int = result("", (), "points checked")
    elsewhere: int = result(
        "", (), "points checked at which the whole train settled in another motion"
    )


def varied(at: Scene, over: Over, value: float | FloatArray) -> Scene:
    """The scene with another joint angle (rad), or factor on damping or mean torque; arrays lie along the time."""
    whole = at.layout
    if over == "angle":
        uneven, steps = unevenness(value), list[JointStep]()
        for step in whole.steps:  # of cross joints; the inverse of one stays an inverse
            bent = replace(step.joint, unevenness=np.copysign(uneven, step.joint.unevenness))  # type: ignore[arg-type]
            steps.append(step if step.joint.series else replace(step, joint=bent))
        return replace(at, layout=replace(whole, steps=tuple(steps)))
    if over == "damping":
        dampers = replace(whole.dampers, size=scaled(whole.dampers.size, value))
        hysteretic = scaled(whole.hysteretic, value)
        more = replace(
            whole, viscous=scaled(whole.viscous, value), hysteretic=hysteretic, dampers=dampers
        )
        return replace(at, layout=more, damping=value)  # type: ignore[arg-type]
    return replace(at, mean=value)  # type: ignore[arg-type]


def stability_map(
    study: Study,
    system: System,
    speeds: FloatArray,
    over: Over,
    values: FloatArray,
    *,
    modes: int | None = None,
    progress: Progress = silent,
) -> StabilityMap:
    """Growth rates at ascending reference speeds (speeds,) rad/s and values (values,): angles in rad, or factors."""
    at = replace(scene(study, system, vibratory=False), laws="negative")
    if not at.layout.steps:
        raise SolveError("a stability map needs a joint; only joints depend on the angle")
    harmonics_at_least(at)  # raises SolveError before anything is computed
    shapes = basis(at.layout)
    fewer = modes_that_matter(at, shapes, float(np.max(speeds)), modes)
    lossy = damped(at, fewer)
    growth, amplitude = np.full((2, len(speeds), len(values)), np.nan)
    for first in range(0, len(values), SIDE_BY_SIDE):
        some = values[first : first + SIDE_BY_SIDE]
        most = varied(at, over, float(some.max())).layout.steps
        uneven = max(abs(float(step.joint.unevenness)) for step in most)
        stack = Stack(lossy, fewer, lambda value: varied(lossy, over, value), some, uneven)
        solution = None
        for k, speed in enumerate(np.asarray(speeds, dtype=float).tolist()):
            progress("stability map", (first + len(some) * k / len(speeds)) / len(values))
            solution = solve_stack(stack, speed, solution)
            growth[k, first : first + len(some)] = growths(stack, solution)
            amplitude[k, first : first + len(some)] = solution.amplitude
    whole = _Whole(at, shapes, over, np.asarray(speeds, dtype=float), values)
    for k, column in np.argwhere(np.isnan(growth))[:MOST_ALONE].tolist():
        growth[k, column], amplitude[k, column] = whole(k, column)
    error, checked, elsewhere = whole.check(growth, amplitude)
    counts = fewer.modes - fewer.rigid, len(shapes.frequency) - shapes.rigid
    return StabilityMap(over, whole.speeds, values, growth, *counts, error, checked, elsewhere)


@dataclass(frozen=True)
class _Whole:
    """The unreduced train at single points of the map."""

    at: Scene
    shapes: Basis
    over: Over
    speeds: FloatArray
    values: FloatArray

    def __call__(self, k: int, column: int) -> tuple[float, float]:
        """Growth (1/s) and amplitude (rad) at a point; NaN where there is no periodic motion."""
        there = varied(self.at, self.over, float(self.values[column]))
        shapes = basis(there.layout) if self.over == "damping" else self.shapes
        found = Search(damped(there, shapes), shapes, None)(float(self.speeds[k]))
        if found is None:
            return np.nan, np.nan
        motion = motion_of(found[0].found.harmonic, 1.0, points_in_time(found[0].found.count))
        return found[1].growth, float(half_range(motion.deviation))

    def check(self, growth: FloatArray, amplitude: FloatArray) -> tuple[float, int, int]:
        """Largest difference (1/s) at the fastest growing points, those nearest to a boundary, and some spread out.

        Where several periodic motions exist, only the same one is compared. Returns how many points were, and how many
        were not.
        """
        known = np.flatnonzero(np.isfinite(growth.ravel()))
        if not known.size:
            return np.nan, 0, 0
        value = growth.ravel()[known]
        third = CHECKED // 3
        spread = known[np.linspace(0, len(known) - 1, third + 2).astype(int)[1:-1]]
        chosen = {
            *known[np.argsort(value)][-third:],
            *known[np.argsort(np.abs(value))][:third],
            *spread,
        }
        worst, same, other = 0.0, 0, 0
        for point in sorted(int(one) for one in chosen):
            k, column = divmod(point, growth.shape[1])
            grows, reached = self(k, column)
            if abs(reached - amplitude[k, column]) <= SAME_MOTION * reached:
                worst, same = max(worst, abs(grows - float(growth[k, column]))), same + 1
            else:
                other += 1
        return worst, same, other
