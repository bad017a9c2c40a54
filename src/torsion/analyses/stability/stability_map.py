"""Map of the growth rate over speed and one more quantity: joint angle, damping or mean torque.

Every value of the second quantity is a train of its own, whose growth rates are computed over the speeds on the modes
that matter, as `stability` does for one train.
"""

from dataclasses import replace
from typing import Literal

import numpy as np

from torsion.analyses.stability.floquet_exponents import Search, damped, modes_that_matter
from torsion.analyses.stability.mechanism_loads import Scene, scene
from torsion.analyses.stability.periodic_orbits import harmonics_at_least, orbit
from torsion.analyses.stability.straight_modes import basis
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress, silent
from torsion.kernels.joints.cross import unevenness
from torsion.processes import shared_out
from torsion.results import reported, result
from torsion.study import Study

Over = Literal["angle", "damping", "torque"]
FEWEST_VALUES = 6  # for which processes are begun
STAGES = 4  # order 7: growth rates of a map need no more
CHECKED = 9  # points at which the unreduced train is computed too


@reported
class StabilityMap:
    """Growth rates; NaN where no periodic motion was found."""

    over: Over = result("", "angle, damping or torque")
    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    value: FloatArray = result("", ("value",), "joint angles in rad, or factors")
    growth: FloatArray = result("1/s", ("speed", "value"), "null if no periodic motion was found")
    modes: int = result("", "elastic modes kept")
    of_modes: int = result("", "of so many")
    error: float = result("1/s", "largest difference to the whole train at the points checked")
    checked: int = result("", "points checked")
    elsewhere: int = result("", "points checked at which the whole train settled in another motion")


def vary_scene(mechanism: Scene, over: Over, value: float) -> Scene:
    """Return the scene with another angle (rad) of its cross joints, or a factor on damping or mean torque."""
    layout = mechanism.layout
    if over == "angle":
        steps = tuple(
            step
            if step.joint.series
            # The inverse of a joint, which a fixed station makes, stays an inverse.
            else replace(
                step,
                joint=replace(
                    step.joint,
                    unevenness=float(np.copysign(unevenness(value), step.joint.unevenness)),
                ),
            )
            for step in layout.steps
        )
        return replace(mechanism, layout=replace(layout, steps=steps))
    if over == "damping":
        dampers = replace(layout.dampers, size=layout.dampers.size * value)
        layout = replace(
            layout,
            viscous=layout.viscous * value,
            hysteretic=layout.hysteretic * value,
            dampers=dampers,
        )
        return replace(mechanism, layout=layout, damping=value)
    return replace(mechanism, mean=value)


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
    """Return growth rates at ascending speeds (speeds,) rad/s and values (values,): angles in rad, or factors.

    Raises SolveError where the train has no joint, or takes more harmonics than are possible.
    """
    mechanism = replace(scene(study, system, vibratory=False), laws="negative")
    if not mechanism.layout.steps:
        raise SolveError("a stability map needs a joint; only joints depend on the angle")
    harmonics_at_least(mechanism)  # raises SolveError before anything is computed
    speeds = np.asarray(speeds, dtype=float)
    shapes = basis(mechanism.layout)
    reduced = modes_that_matter(mechanism, shapes, float(speeds.max()), modes)
    lossy = damped(mechanism, reduced)
    unreduced_scene = damped(mechanism, shapes)

    searches = [
        Search(vary_scene(lossy, over, value), shapes, reduced, stages=STAGES)
        for value in values.tolist()
    ]
    columns = shared_out(
        lambda search: [search.growth(speed) for speed in speeds.tolist()],
        searches,
        fewest=FEWEST_VALUES,
    )
    growth = np.empty((len(speeds), len(values)))
    for column, rates in enumerate(columns):
        progress("stability map", column / len(values))
        growth[:, column] = rates

    # Checked are the fastest growing points, those nearest to a boundary, and some between.
    errors = list[float]()
    elsewhere = 0
    points = np.flatnonzero(np.isfinite(growth.ravel()))
    rates_of = growth.ravel()[points]
    third = CHECKED // 3
    spread = np.linspace(0, len(points) - 1, third + 2).astype(int)[1:-1]
    ranks = [np.argsort(rates_of)[-third:], np.argsort(np.abs(rates_of))[:third], spread]
    checked = np.unique(points[np.concatenate(ranks)]) if points.size else points
    for row, column in np.transpose(np.unravel_index(checked, growth.shape)).tolist():
        solved = searches[column](float(speeds[row]))
        value = float(values[column])
        assert solved is not None  # its growth rate is known
        unreduced = Search(vary_scene(unreduced_scene, over, value), shapes, None)
        try:
            motion = orbit(unreduced.mechanism, float(speeds[row]), solved[0])
        except SolveError:
            elsewhere += 1
            continue
        exact = unreduced.exponents(motion, unreduced.method).growth
        errors.append(abs(exact - float(growth[row, column])))
    return StabilityMap(
        over,
        speeds,
        values,
        growth,
        reduced.modes - reduced.rigid,
        len(shapes.frequency) - shapes.rigid,
        max(errors, default=0.0 if elsewhere else np.nan),
        len(errors),
        elsewhere,
    )
