"""Stability of a train with joints over speed: growth rates, unstable ranges with their boundaries, and their names."""

from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from typing import Literal

import numpy as np

from torsion.analyses.law_slopes import rows_of_tables
from torsion.analyses.stability.floquet_exponents import (
    Method,
    Search,
    damped,
    growth_search,
    modes_that_matter,
)
from torsion.analyses.stability.mean_speed import (
    PEAK,
    SLOW,
    MeanSpeedDrift,
    drift_ends,
    mean_speed_damping,
    missing_slope,
)
from torsion.analyses.stability.mechanism_loads import Scene, scene
from torsion.analyses.stability.periodic_orbits import harmonics_at_least, orbit
from torsion.analyses.stability.straight_modes import basis
from torsion.analyses.stability.unstable_ranges import (
    UnstableRange,
    candidates,
    indicator,
    unstable_ranges,
)
from torsion.analyses.steady import steady_if_known
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress, silent
from torsion.kernels.bracketed_search import find_minimum
from torsion.kernels.joints.cross import unevenness
from torsion.model.machine_torques import DriveLaw
from torsion.processes import shared_out
from torsion.results import reported, result
from torsion.study import Study

MOST_SEEDS = 60  # combination resonances that are looked at between the speeds requested
LOOK_AROUND = 0.02  # relative: how far from a combination its zone is looked for, and
UNEVEN_AROUND = 2.0  # times the unevenness of the joints beside that
LOWEST = -1e9  # 1/s, where no drift is known
MOST_PEAKS = 3  # of the drift of the mean speed, that are refined
CHECKED = 3  # speeds at which the other method checks the growth rate
WHOLE = 20  # coordinates up to which no mode is left out, unless its highest mode
TURNED = 300.0  # rad: turns through more in a common period at the lowest speed, which makes the steps in time many
MORE = 2  # times the modes kept: how many the estimate of the error keeps
MOST_CHECKED = 600  # rows of Hill's matrix for that: beyond, its eigenvalues take far longer than the growth rate


@reported
class Stability:
    """Growth rates over speed; NaN where there is no periodic motion."""

    speed: FloatArray = result(
        "rad/s", "speed", "reference speeds, more of them in and around unstable ranges"
    )
    requested: np.ndarray = result(
        "", "speed", "the speed is one of those requested", key="is_asked"
    )
    growth: FloatArray = result(
        "1/s", "speed", "of the fastest growing small deviation; null without a periodic motion"
    )
    frequency: FloatArray = result(
        "rad/s", "speed", "of that motion, within half of the common frequency"
    )
    amplitude_growth: FloatArray = result(
        "1", "speed", "growth over a revolution of the reference", key="factor_per_turn"
    )
    ranges: tuple[UnstableRange, ...] = result("unstable ranges of speed")
    modes: FloatArray = result("rad/s", "mode", "elastic ones of the train with straight joints")
    method: str = result("monodromy or hill")
    check: float = result("1/s", "largest difference to the other method; null if too large")
    unsolved: FloatArray = result("rad/s", "unsolved", "speeds without a periodic motion")
    loses: bool = result(
        "the train is damped; without damping the best growth is 0", key="something_damps"
    )
    kept: int | None = result(
        "elastic modes that the train is reduced to; null for all",
        key="modes_kept",
        default=None,
    )
    drift: FloatArray | None = result(
        "1/s",
        "speed",
        "growth of a deviation of the mean speed; null if not distinguished",
        default=None,
    )
    drifts: tuple[MeanSpeedDrift, ...] = result(
        "where the mean speed drifts, at most one", default=()
    )
    doubtful: FloatArray | None = result(
        "rad/s",
        "doubtful",
        "speeds at which a drift of the mean speed and an instability were not distinguished",
        default=None,
    )
    left_out: float = result(
        "1/s",
        "largest change of the growth rate with twice as many, where that was tried",
        key="reduction_error_per_s",
        default=0.0,
    )

    @property
    def unknown(self) -> tuple[tuple[float, float], ...]:
        """Ranges of speed (rad/s) between neighbours with a periodic motion in which none was found."""
        bare = np.concatenate([[False], np.isnan(self.growth), [False]])
        first = np.maximum(np.flatnonzero(~bare[:-1] & bare[1:]) - 1, 0)
        last = np.minimum(np.flatnonzero(bare[:-1] & ~bare[1:]), len(self.speed) - 1)
        return tuple(zip(self.speed[first].tolist(), self.speed[last].tolist(), strict=True))


def stability(
    study: Study,
    system: System,
    speeds: FloatArray,
    *,
    method: Method = "monodromy",
    modes: int | None = None,
    progress: Progress = silent,
) -> Stability:
    """Return growth rates at reference speeds (speeds,) rad/s and everything unstable between the first and the last.

    Zones narrower than the steps are looked for around every combination of two modes. Vibratory torques are left out:
    they shift the orbit, not its stability, to first order. A long train is reduced to the modes that matter, and any
    train to as many elastic modes as `modes` says, where it has more.
    """
    search = growth_search(study, system, method=method)
    harmonics_at_least(search.mechanism)  # raises SolveError before anything is computed
    elastic = search.shapes.frequency[search.shapes.rigid :]
    longest = 2.0 * np.pi / (float(search.mechanism.order) * float(np.min(speeds)))
    is_long = search.mechanism.layout.free > WHOLE or search.shapes.highest * longest > TURNED
    if modes is None and is_long:
        fewer = modes_that_matter(search.mechanism, search.shapes, float(np.max(speeds)))
        modes = fewer.modes - fewer.rigid
    if modes is not None and modes < len(elastic):
        search = growth_search(study, system, method=method, modes=modes)
    else:
        modes = None
    requested = np.unique(np.asarray(speeds, dtype=float))
    for k, speed in enumerate(requested.tolist()):
        progress("stability", 0.6 * k / len(requested))
        search(speed)
    # A slope of a table holds between two rows of it, which may both lie between two of these speeds.
    rows = rows_of_tables(study)
    rows = rows[(rows >= requested[0]) & (rows <= requested[-1])]
    for low, high in pairwise(rows.tolist()):
        if not np.any((requested > low) & (requested < high)):
            search((low + high) / 2.0)
    _look_between(search, requested, progress)
    ranges = unstable_ranges(search, progress)
    drifts = _find_drifts(search)

    speed = np.array(sorted(search.known))
    solved = [search.known[w] for w in speed.tolist()]
    growth = np.array([np.nan if pair is None else pair[1].growth for pair in solved])
    exponents = [
        np.empty(0, dtype=complex) if pair is None else pair[1].exponent for pair in solved
    ]
    frequency = np.array(
        [next(iter(exponent), complex(0.0, np.nan)).imag for exponent in exponents]
    )
    with np.errstate(over="ignore"):
        factor = np.exp(growth * 2.0 * np.pi / speed)
    left_out = 0.0
    if modes is not None:
        # At the fastest growth and at both ends, with more modes.
        wide = growth_search(study, system, modes=min(MORE * modes, len(elastic)))
        known = np.flatnonzero(np.isfinite(growth))
        known = known[[0, int(growth[known].argmax()), -1]] if known.size else known
        changes = [abs(wide.growth(float(speed[row])) - growth[row]) for row in np.unique(known)]
        left_out = float(np.nanmax(changes)) if changes else np.nan
    return Stability(
        speed,
        np.isin(speed, requested),
        growth,
        frequency,
        factor,
        ranges,
        elastic,
        method,
        _compare_methods(search, requested),
        speed[np.isnan(growth)],
        search.loses,
        modes,
        drift=np.array([search.drift(w) for w in speed.tolist()]),
        drifts=drifts,
        doubtful=speed[[pair is not None and pair[1].is_doubtful for pair in solved]],
        left_out=left_out,
    )


def _look_between(search: Search, requested: FloatArray, report: Progress) -> None:
    """Search around each combination resonance for zones that fall between the speeds."""
    # Half of the amplitude by which a ratio varies: q of a cross joint, order times error / 2 of a series.
    joints = [step.joint for step in search.mechanism.layout.steps]
    strengths = [sum(order * abs(error) for order, error in joint.series) / 2.0 for joint in joints]
    uneven = max(np.add(strengths, [abs(joint.unevenness) for joint in joints]), default=0.0)
    if uneven == 0.0 or len(requested) < 2:
        return
    first = float(requested[0])
    last = float(requested[-1])
    seeds = candidates(search.shapes, search.mechanism.layout.orders, first, last)
    around = LOOK_AROUND * min(1.0, 20.0 * uneven) + UNEVEN_AROUND * uneven**2

    def height(speed: float) -> float:
        pair = search(speed)
        return np.inf if pair is None else -indicator(pair[1], loses=search.loses)

    for k, seed in enumerate(seeds[:MOST_SEEDS].tolist()):
        report("stability between the speeds", 0.6 + 0.2 * k / len(seeds))
        low = max(seed * (1.0 - around), first)
        high = min(seed * (1.0 + around), last)
        inside = [speed for speed in search.known if low <= speed <= high]
        if not any(search.is_unstable(speed) for speed in [*inside, seed]):
            find_minimum(height, low, high, tolerance=around * seed * 1e-2, most=10)


def _find_drifts(search: Search) -> tuple[MeanSpeedDrift, ...]:
    """Return where the mean speed drifts faster than SLOW, with the slope that the machine that drives lacks."""

    def height(speed: float) -> float:
        return -float(np.nan_to_num(search.drift(float(speed)), nan=-np.inf))

    # A narrow drift lies between the speeds: each high local maximum is refined.
    tried = np.array(sorted(search.known))
    rates = np.array([max(-height(speed), LOWEST) for speed in tried.tolist()])
    below = rates[1:-1] - rates[:-2]
    above = rates[1:-1] - rates[2:]
    inner = np.flatnonzero((np.minimum(below, above) >= 0) & (np.maximum(below, above) > SLOW)) + 1
    for row in inner[np.argsort(-rates[inner])][:MOST_PEAKS].tolist():
        low = float(tried[row - 1])
        high = float(tried[row + 1])
        find_minimum(height, low, high, tolerance=PEAK * (high - low))

    worst = min(search.known, key=height)
    start = search(worst)
    if start is None or not search.drift(worst) > SLOW:
        return ()
    speeds = np.array(sorted(search.known))
    drifts = np.array([search.drift(speed) for speed in speeds.tolist()])
    first, last = drift_ends(search.drift, speeds, drifts)
    # The greatest part of the mean torque enters there.
    station = int(start[0].operation.stations.drive[0].argmax())
    name = search.mechanism.system.stations[station].name
    ratio = float(search.mechanism.system.speed_ratio[station])
    limits = float(tried[0]), float(tried[-1])
    slope = missing_slope(search.mechanism, start[0], limits, station) / ratio**2
    given = mean_speed_damping(start[0]) / ratio**2
    # The slope that a slip of 1 % has there; NaN where no speed is rated.
    slip = np.nan
    study, system = search.mechanism.study, search.mechanism.system
    if (rated := study.operation.rated) is not None:
        steady = steady_if_known(study, system, np.array([rated.speed]))
        if steady is not None:
            torque, own_speed = float(steady.applied[station, 0]), rated.speed * ratio
            slip = DriveLaw(slip=0.01).slope_at_rated(torque, own_speed)
    return (MeanSpeedDrift(first, last, search.drift(worst), worst, slope, name, given, slip),)


def _compare_methods(search: Search, requested: FloatArray) -> float:
    """Return the largest difference (1/s) between the growth rates of both methods at a few speeds."""
    second_method: Method = "monodromy" if search.method == "hill" else "hill"
    pairs = map(search, requested.tolist()), search.known.values()
    solved = next(filter(None, ([*filter(None, some)] for some in pairs)), [])
    differences = []
    for row in set(np.linspace(0, len(solved) - 1, min(CHECKED, len(solved))).astype(int)):
        motion, multipliers = solved[row]
        with suppress(SolveError):
            growth = search.exponents(motion, second_method, MOST_CHECKED).growth
            differences.append(abs(growth - multipliers.growth))
    return max(differences, default=np.nan)


Over = Literal["angle", "damping", "torque"]
FEWEST_VALUES = 6  # for which processes are begun
STAGES = 4  # order 7: growth rates of a map need no more
POINTS_CHECKED = 9  # points at which the unreduced train is computed too


@reported
class StabilityMap:
    """Growth rates; NaN where no periodic motion was found."""

    over: Over = result("angle, damping or torque")
    speed: FloatArray = result("rad/s", "speed", "reference speeds")
    value: FloatArray = result("", "value", "joint angles in rad, or factors")
    growth: FloatArray = result("1/s", ("speed", "value"), "null if no periodic motion was found")
    modes: int = result("elastic modes kept")
    of_modes: int = result("of so many")
    error: float = result("1/s", "largest difference to the whole train at the points checked")
    checked: int = result("points checked")
    elsewhere: int = result("points checked at which the whole train settled in another motion")


def vary_scene(mechanism: Scene, over: Over, value: float) -> Scene:
    """Return the scene with another angle (rad) of its cross joints, or a factor on damping or mean torque."""
    layout = mechanism.layout
    if over == "angle":
        steps = list(layout.steps)
        for number, step in enumerate(steps):
            if not step.joint.series:
                # The inverse of a joint, which a fixed station makes, stays an inverse.
                uneven = float(np.copysign(unevenness(value), step.joint.unevenness))
                steps[number] = replace(step, joint=replace(step.joint, unevenness=uneven))
        return replace(mechanism, layout=replace(layout, steps=tuple(steps)))
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
    third = POINTS_CHECKED // 3
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
