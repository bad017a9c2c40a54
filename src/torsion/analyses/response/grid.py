"""Speeds and frequencies at which a response is computed: those requested, and more around every resonance."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.power_balance import SAME_SPEED
from torsion.analyses.response.amplitudes import (
    FrequencyResponse,
    Response,
    blocks,
    merged,
    with_balance,
)
from torsion.analyses.undamped_modes import Modes, modes_as_discretised, undamped_tree
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.kernels.trees.tree_response import Status

Answered = TypeVar("Answered", bound=Response | FrequencyResponse)
POINTS = 21  # around a resonance; odd, so that the resonance itself is one of them
FEWEST_POINTS = 5
MOST_ADDED = 4000  # points added around resonances
MOST_VALUES = 4_000_000  # complex values at these points; beyond, every resonance has FEWEST_POINTS
BROAD = 0.3  # damping ratio from which a resonance needs no points of its own
SHIFT = (
    0.5  # of damping ratio * frequency, by which a damped mode stands apart from an undamped one
)
UNDAMPED = 1e-9  # damping ratio below which a resonance is approached in decades
DECADES = np.concatenate([-np.logspace(-2, -6, 9), [0.0], np.logspace(-6, -2, 9)])
GAIN = (
    2e-4  # relative: a peak that stands higher above its highest point is computed at its own place
)
SMALL = 1e-3  # of the largest torque of a span: lower peaks are not searched for
ROUNDS_FOR_PEAKS = (
    2  # of looking for peaks between the points: the first finds them, the second sharpens them
)
MOST_PEAKS = 500  # added in one round
FEWEST_PEAKS = 100  # the same of a train so large that more of them exceed an eighth of MOST_VALUES
ROUNDS_FOR_JUMPS, MOST_JUMPS = (
    3,
    12,
)  # of narrowing the places at which the largest of several solutions ends
JUMP_POINTS = 7  # in each of them
NARROW = 1e-5  # of a point: such a place is narrow enough
SAME_PLACE = (
    0.02  # of the distance between the neighbouring points: peaks that near are computed once
)


def resonances(
    system: System,
    orders: FloatArray,
    first: float,
    last: float,
    ground: Callable[[FloatArray], FloatArray],
    known: Modes | None = None,
    damped: DampedModes | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return the points (places,) between two at which an order meets a mode, and the damping ratio (places,) there.

    A point times one of `orders`, ascending, is a circular frequency (rad/s). ground: (points,) to (stations, points)
    N m s/rad of damping to ground. `known` modes of this very system are used as far as they go.

    Damping ratios are those of first order: power lost / (4 pi energy) of the undamped shape. The `damped` modes that
    heavy damping has moved from every undamped one by more than SHIFT of their width are added.
    """
    modes = modes_reaching(system, float(orders[-1] * last), known)
    w = 2.0 * math.pi * modes.frequency
    # The loss in the spans is (sum c twist^2 / w + sum eta share of elastic energy)/2.
    twist = system.twist(modes.shape / system.speed_ratio[:, None])
    by_frequency = system.tables_over("frequency")
    viscous = system.viscous.copy()
    loss = system.loss_factor.copy()
    viscous[list(by_frequency)] = loss[list(by_frequency)] = 0.0
    lost = viscous @ twist**2 / w + loss @ modes.elastic
    for span, table in by_frequency.items():
        stiffness = table.complex_stiffness(w, w)
        lost += stiffness.imag / stiffness.real * modes.elastic[span]
    ratio = lost / 2.0 + system.modal_ratios(len(w))
    shape = modes.shape
    if damped is not None:
        size = np.abs(damped.eigenvalue)
        moved = (np.abs(size - w[:, None]) > SHIFT * damped.damping_ratio * size).all(axis=0)
        w = np.concatenate([w, size[moved]])
        ratio = np.concatenate([ratio, damped.damping_ratio[moved]])
        # The ratio of a damped mode says all.
        shape = np.pad(shape, ((0, 0), (0, int(moved.sum()))))
    crossings = w[:, None] / orders
    inside = (crossings >= first) & (crossings <= last)
    resonant = crossings[inside]
    mode = np.nonzero(inside)[0]
    zeta = ratio[mode]
    for part in blocks(len(resonant), len(system.stations)):
        lost = np.einsum("sp,sp->p", ground(resonant[part]), shape[:, mode[part]] ** 2)
        zeta[part] += lost / (2.0 * w[mode[part]])
    return resonant, zeta


def modes_reaching(system: System, highest: float, known: Modes | None) -> Modes:
    """Return the modes whose frequency does not exceed the highest (rad/s), and perhaps more."""
    modes = known if known is not None and known.system is system else None
    if modes is not None and modes.frequency.size and 2.0 * math.pi * modes.frequency[-1] > highest:
        return modes
    if tables := system.tables_over("frequency"):
        from torsion.assembly.tabled_spans import taken_at
        from torsion.kernels.stiffness_laws import STEEPEST

        # They only place points, so that the ends of tables hold. Where a table is too steep for one frequency a mode,
        # they are those at the stiffness of the highest.
        modes = modes_reaching(taken_at(system, highest), highest, None)
        if any(table.steepest >= STEEPEST for table in tables.values()) or not modes.frequency.size:
            return modes
        held = {span: replace(table, holds=True) for span, table in tables.items()}
        system = replace(system, tables={**system.tables, **held})
        return modes_as_discretised(system, modes.frequency.size)
    if system.condensed.extra.size:
        return modes_as_discretised(system, None)
    from torsion.analyses.modes.mode_nodes import reach

    return modes_as_discretised(system, max(reach(undamped_tree(system), highest).count, 1))


def refined(
    requested: FloatArray, resonant: FloatArray, ratio: FloatArray, values: int = 1
) -> tuple[FloatArray, str]:
    """Return the points requested and those around each resonance, ascending; and what had to be left out, in words.

    resonant, ratio: (places,) of the resonances and their damping ratios; values: complex ones of the response at a point, of
    which a large train has so many that each resonance has fewer points. Around one at x they stand at
    x (1 + zeta tan t) with t evenly spaced: equal steps of phase of a single mode, by sqrt(1 - 2 zeta^2) and its
    inverse (the peaks of angle and of acceleration of one degree of freedom).
    """
    narrow = ratio < BROAD
    resonant = resonant[narrow]
    zeta = ratio[narrow]
    points = POINTS
    remark = ""
    if len(resonant) * points * values > MOST_VALUES:
        odd = (MOST_VALUES // (len(resonant) * values) - 1) // 2 * 2 + 1
        points = min(max(odd, FEWEST_POINTS), POINTS)
        remark = f"each of {len(resonant)} resonances has {points} points in place of {POINTS}, as the train is large"
    if len(resonant) * points > MOST_ADDED:
        points = max(FEWEST_POINTS, (MOST_ADDED // len(resonant) - 1) // 2 * 2 + 1)
        resonant = resonant[: MOST_ADDED // points]
        zeta = zeta[: MOST_ADDED // points]
        remark = f"{np.count_nonzero(narrow)} resonances lie in the range; {len(resonant)} of them have {points} points each"
    added = [requested]
    step = np.tan(np.linspace(-0.5, 0.5, points + 2)[1:-1] * math.pi)
    for x, z in zip(resonant.tolist(), zeta.tolist(), strict=True):
        if z < UNDAMPED:
            added.append(x * (1.0 + DECADES))
            continue
        peak = math.sqrt(1.0 - 2.0 * z * z)
        added.append(np.concatenate([x * (1.0 + z * step), [x * peak, x / peak]]))
    grid = np.unique(np.concatenate(added))
    return grid[(grid >= requested[0]) & (grid <= requested[-1])], remark


def with_peaks(
    solve: Callable[[FloatArray], Answered],
    requested: FloatArray,
    points: FloatArray,
    remark: str,
    refuse_too_many: Callable[[int], None],
    unit: tuple[float, str],
) -> Answered:
    """Return the response at the points and wherever a peak shows between two of them; `remark` says what was left out.

    solve: the response at points, ascending. refuse_too_many: raises InputError where so many points are too many.
    unit: factor and name with which the remark shows points.
    """
    refuse_too_many(len(points) + min(len(points), ROUNDS_FOR_PEAKS * MOST_PEAKS))
    response = solve(points)
    for _ in range(ROUNDS_FOR_PEAKS):
        # A peak may be of another solution.
        solutions: tuple[Answered, ...] = (response, *getattr(response, "others", ()))
        axis = -2 if response.torque.ndim == 3 else -1
        torque = np.concatenate([solution.torque for solution in solutions], axis=axis)
        sound = np.concatenate([solution.status for solution in solutions], axis=-1) == Status.OK
        if sound.ndim == 1:
            sound, torque = sound[:, None], torque[:, None]
        missed, left_out = missed_peaks(response.points, torque, sound)
        remark = left_out or remark
        if missed.size == 0:
            break
        response = merged(response, solve(missed), response.points, missed)
    # Between two points that have other numbers of solutions by harmonic balance the largest ends.
    share = np.linspace(0.0, 1.0, JUMP_POINTS + 2)[1:-1]
    for _ in range(ROUNDS_FOR_JUMPS):
        several = response.balanced if response.following is None else response.following
        if several is None:
            break
        left = np.flatnonzero((np.diff(several.number, axis=0) != 0).any(axis=1))[:MOST_JUMPS]
        begin, end = response.points[left], response.points[left + 1]
        begin, width = (ends[end - begin > NARROW * end] for ends in (begin, end - begin))
        jumps = (begin[:, None] + width[:, None] * share).ravel()
        if jumps.size == 0:
            break
        response = merged(response, solve(jumps), response.points, jumps)
    response = replace(response, requested=np.isin(response.points, requested), remark=remark)
    return replace(response, remark=with_balance(response, *unit))


def apart(points: FloatArray, added: FloatArray) -> FloatArray:
    """Return those of `added` that differ from all `points`, ascending, by more than rounding."""
    after = np.clip(np.searchsorted(points, added), 1, max(len(points) - 1, 1))
    neighbours = points[[after - 1, np.minimum(after, len(points) - 1)]]
    near = np.abs(added - neighbours).min(axis=0)
    return np.asarray(added[near > SAME_SPEED * np.abs(added)])


def missed_peaks(
    x: FloatArray, torque: ComplexArray | FloatArray, sound: np.ndarray
) -> tuple[FloatArray, str]:
    """Return places of peaks that stand higher than the highest computed point near them; and what was left out.

    x: (points,) ascending. torque: (points, lines, spans). sound: (points, lines) bool, where the answer is ok.
    The inverse square of a resonance curve is a parabola over the frequency, so its lowest point is the peak.
    """
    if len(x) < 3 or torque.size == 0:
        return np.empty(0), ""
    size = np.where(sound[:, :, None], np.abs(torque), np.nan)
    largest = np.nanmax(np.where(np.isfinite(size), size, 0.0), axis=(0, 1))
    point, line, span = np.nonzero(
        (size[1:-1] >= size[:-2]) & (size[1:-1] >= size[2:]) & (size[1:-1] > SMALL * largest)
    )
    left = x[point] - x[point + 1]
    right = x[point + 2] - x[point + 1]
    # The parabola through three points, from the middle one: where it is lowest, and by how much a peak there is
    # higher.
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        y0, y1, y2 = (size[point + k, line, span] ** -2 for k in range(3))
        slope0 = (y0 - y1) / left
        slope2 = (y2 - y1) / right
        bend = (slope2 - slope0) / (right - left)
        slope = slope0 - bend * left
        move = -slope / (2.0 * bend)
        gain = np.sqrt(y1 / (y1 + slope * move / 2.0)) - 1.0
    inner = (bend > 0) & (move > left) & (move < right) & ~(gain <= GAIN) & (move != 0)
    # Peaks of several spans or lines at the same place are one, as prominent as the most prominent.
    step = SAME_PLACE * (right - left)[inner]
    rounded = x[point[inner] + 1] + np.round(move[inner] / step) * step
    finite_gain = np.where(np.isfinite(gain[inner]), gain[inner], np.inf)
    highest_first = np.argsort(-finite_gain, kind="stable")
    peaks, first = np.unique(rounded[highest_first], return_index=True)
    count = min(MOST_PEAKS, max(FEWEST_PEAKS, MOST_VALUES // (8 * torque[0].size)))
    if len(peaks) <= count:
        return peaks, ""
    remark = f"{len(peaks)} peaks lie between the points; the {count} most prominent were computed"
    return np.sort(peaks[np.argsort(first, kind="stable")[:count]]), remark
