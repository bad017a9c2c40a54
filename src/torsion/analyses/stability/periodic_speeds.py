"""The speeds at which the exact periodic response is computed: a few everywhere, more around its peaks.

Harmonic balance costs far more than a first-order line, so that the speeds are counted out by the size of the train.
"""

from dataclasses import replace

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.stability.floquet_exponents import Search, damped, modes_that_matter
from torsion.analyses.stability.mechanism_loads import Scene, scene
from torsion.analyses.stability.periodic_orbits import (
    Orbit,
    PeriodicResponse,
    continued,
    further_motions,
    harmonics_at_least,
    orbit,
    response_of,
)
from torsion.analyses.stability.straight_modes import basis
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Progress, silent
from torsion.study import Study

WORK = 2400  # speeds times coordinates, with few harmonics: about 10 s on one slow core
FEW = 20  # harmonics; more take time in proportion
PATIENCE = 60  # harmonics at least: a longer common period is left alone unless it is requested
FEWEST, MOST = 24, 201  # speeds
EVERYWHERE = 0.5  # of the speeds: spread over the range; the others are for peaks
AT_PEAKS = 0.25  # of the speeds: at the peaks of the first order
RESOLVED = 0.02  # of a peak: how far its neighbours may lie below it
WORTH = 0.02  # of the largest amplitude of its span: lower peaks are not followed
CLOSEST = 1e-5  # relative distance of two speeds
MOST_SOUGHT, SPEEDS_PER_SOUGHT = (
    3,
    40,
)  # speeds at which other motions are sought: at most, and one for so many
EDGE = 1e-3  # the same next to a speed without a periodic motion


def too_long(study: Study, system: System) -> str:
    """Return why the exact response takes too long to be computed unrequested; empty where it does not."""
    mechanism = scene(study, system)
    try:
        harmonics = harmonics_at_least(mechanism)
    except SolveError as fault:
        return str(fault)
    if harmonics <= PATIENCE:
        return ""
    return (
        f"joints and torques repeat together only every {float(1 / mechanism.order):.6g} revolutions of the reference shaft, "
        f"which takes {harmonics} harmonics or more; request it with `response: {{method: harmonic-balance}}`"
    )


def periodic_over_speed(
    study: Study, system: System, first_order: Response, *, progress: Progress = silent
) -> PeriodicResponse:
    """Return the exact periodic response over the range of a first-order one, at as many speeds as it is worth.

    Every speed is started from the nearest that is solved.
    """
    mechanism = scene(study, system)
    work = max(1.0, mechanism.layout.free * max(1.0, harmonics_at_least(mechanism) / FEW))
    number = int(np.clip(WORK // work, FEWEST, MOST))
    solutions: dict[float, tuple[Orbit | None, str]] = {}

    def solve(speeds: FloatArray) -> PeriodicResponse:
        for speed in speeds.tolist():
            if speed not in solutions:
                progress("harmonic balance", len(solutions) / number)
                solved = (orbit for orbit, _ in solutions.values() if orbit is not None)
                solutions[speed] = continued(mechanism, speed, solved)
        orbits, why = zip(*(solutions[speed] for speed in sorted(solutions)), strict=True)
        return response_of(mechanism, orbits, np.array(sorted(solutions)), why)

    # To begin with: some of the speeds requested, the rated one, and the highest peaks of the first order.
    requested = first_order.speed[first_order.requested]
    few = max(2, int(EVERYWHERE * number))
    rows = np.linspace(0, len(requested) - 1, min(few, len(requested))).round().astype(int)
    size = np.where((first_order.status == 0)[:, :, None], np.abs(first_order.torque), np.nan)
    peak_rows = list(dict.fromkeys(row for row, _, _ in _peaks(size)))
    begun = [requested[rows], first_order.speed[peak_rows[: int(AT_PEAKS * number)]]]
    rated = study.operation.rated
    if rated is not None and requested[0] <= rated.speed <= requested[-1]:
        begun.append(np.array([rated.speed]))
    response = solve(np.unique(np.concatenate(begun)))
    while len(solutions) < number:
        more = around_peaks(response)[: number - len(solutions)]
        if not more.size:
            break
        response = solve(np.sort(more))
    progress("stability of the periodic motion", 1.0)
    growth = growths(mechanism, response)
    response = replace(response, growth=growth)
    progress("other periodic motions", 1.0)
    # At the highest peaks, else at the largest torque; and where the motion is least stable.
    size = np.abs(response.torque)
    largest = np.nan_to_num(size).max(axis=(1, 2), initial=0.0)
    number_sought = max(1, min(MOST_SOUGHT, number // SPEEDS_PER_SOUGHT))
    peak_rows = list(dict.fromkeys(row for row, _, _ in _peaks(size)))
    motion_rows = (peak_rows or [int(largest.argmax())])[:number_sought]
    if response.is_unstable.any():
        motion_rows.append(int(np.nanargmax(growth)))
    further = further_motions(mechanism, response, list(dict.fromkeys(motion_rows)))
    if further is not None:
        further = replace(further, growth=growths(mechanism, further))
    return replace(response, others=further)


def growths(mechanism: Scene, response: PeriodicResponse) -> FloatArray:
    """Return the growth (speeds,) 1/s of small deviations from each periodic motion; NaN where there is none.

    It is computed on the lowest modes. With loss factors it is that of the motion near it that dampers in their place
    make (`straight_modes.viscous`): of any other motion the free turning, which neither grows nor dies out, would seem
    to do either.
    """
    shapes = basis(mechanism.layout)
    fewer = modes_that_matter(mechanism, shapes, float(response.speed[-1]))
    lossy = damped(mechanism, fewer)
    search = Search(lossy, shapes, fewer)
    growth = np.full(len(response.speed), np.nan)
    for row, motion in enumerate(response.orbits):
        if motion is None:
            continue
        damped_motion = motion
        try:
            if lossy.layout is not mechanism.layout:
                damped_motion = orbit(lossy, motion.operation.loading.speed, motion)
        except SolveError:
            continue
        growth[row] = search.exponents(damped_motion, "monodromy").growth
    return growth


def around_peaks(response: PeriodicResponse) -> FloatArray:
    """Return (speeds,) rad/s half way to the neighbours of every peak that they do not resolve, the worst first."""
    size = np.abs(response.torque)
    worst: dict[float, float] = {}
    for row, line, span in _peaks(size):
        for neighbour in (row - 1, row + 1):
            drop = 1.0 - size[neighbour, line, span] / size[row, line, span]
            speed = float(response.speed[row])
            next_speed = float(response.speed[neighbour])
            closest = EDGE if np.isnan(drop) else CLOSEST
            if not drop <= RESOLVED and abs(next_speed - speed) > closest * speed:
                middle = (speed + next_speed) / 2.0
                worst[middle] = max(worst.get(middle, 0.0), 1.0 if np.isnan(drop) else drop)
    return np.array(sorted(worst, key=lambda speed: -worst[speed]))


def _peaks(size: FloatArray) -> list[tuple[int, int, int]]:
    """Inner maxima over the first axis of (speeds, orders, spans), the largest of its span first.

    A neighbour without a value is no obstacle.
    """
    filled = np.where(np.isnan(size), -np.inf, size)
    highest = np.max(filled, axis=(0, 1), initial=0.0)
    middle = filled[1:-1]
    inner = (middle >= filled[:-2]) & (middle >= filled[2:]) & (middle > WORTH * highest)
    places = np.argwhere(inner) + np.array([1, 0, 0])
    share = filled[tuple(places.T)] / highest[places[:, 2]]
    return [tuple(peak) for peak in places[np.argsort(-share, kind="stable")].tolist()]
