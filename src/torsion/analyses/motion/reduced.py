"""Stability on the modes that matter: a large train is reduced, and keeping more modes tells what that costs."""

from dataclasses import replace

import numpy as np

from torsion.analyses.motion.asked import StabilitySettings
from torsion.analyses.motion.loading import Scene, scene
from torsion.analyses.motion.modes import Basis, basis, reduced
from torsion.analyses.motion.stability import Stability, search, stability
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.findings import Progress
from torsion.study import Study

WHOLE = 20  # coordinates up to which no mode is left out; beyond, the highest modes make the steps in time many
HIGHEST = 3.0  # times the highest order of a joint times the highest speed: modes up to there are kept
FEWEST_MODES, MOST_MODES = 3, 12  # elastic ones
MORE = 2  # times the modes kept: how many the estimate of the error keeps


def modes_that_matter(at: Scene, shapes: Basis, fastest: float, asked: int | None = None) -> Basis:
    """The rigid motions and as many elastic modes as asked for.

    Else the modes up to three times the highest order of a joint at the fastest speed (rad/s): 3 to 12 elastic ones.
    """
    elastic = shapes.frequency[shapes.rigid :]
    highest = HIGHEST * float(max(at.layout.orders, default=at.order)) * fastest
    number = int(np.count_nonzero(elastic <= highest))
    number = min(max(number, FEWEST_MODES), MOST_MODES) if asked is None else asked
    return reduced(at.layout, shapes, shapes.rigid + min(number, len(elastic)))


def stability_asked(
    study: Study, system: System, asked: StabilitySettings, speeds: FloatArray, *, progress: Progress | None = None
) -> Stability:
    """Stability at reference speeds (speeds,) rad/s, on as many modes as are asked for, else those that matter."""
    at = scene(study, system, vibratory=False)
    shapes = basis(at.layout)
    elastic, modes = len(shapes.frequency) - shapes.rigid, asked.modes
    if modes is None and at.layout.free > WHOLE:
        fewer = modes_that_matter(at, shapes, float(np.max(speeds)))
        modes = fewer.modes - fewer.rigid
    if modes is not None and modes >= elastic:
        modes = None
    found = stability(study, system, speeds, method=asked.method, modes=modes, progress=progress)
    if modes is None:
        return found
    return replace(found, kept=modes, left_out=_left_out(study, system, found, min(MORE * modes, elastic)))


def _left_out(study: Study, system: System, found: Stability, more: int) -> float:
    """1/s: largest change of the growth rate with more modes, at the fastest growth and at both ends."""
    ask = search(study, system, modes=more)
    known = np.flatnonzero(np.isfinite(found.growth))
    if not known.size:
        return np.nan
    places = {int(known[0]), int(known[-1]), int(known[np.argmax(found.growth[known])])}
    return float(np.nanmax([abs(ask.growth(float(found.speed[k])) - found.growth[k]) for k in sorted(places)]))
