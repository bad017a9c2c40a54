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
    harmonics_at_least,
    nearest,
    orbit,
    others,
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
MOST_SOUGHT, EACH = (
    3,
    40,
)  # speeds at which other motions are sought: at most, and one for so many speeds
EDGE = 1e-3  # the same beside a speed without a periodic motion


def too_long(study: Study, system: System) -> str:
    """Why the exact response takes too long to be computed unrequested; empty where it does not."""
    at = scene(study, system)
    try:
        harmonics = harmonics_at_least(at)
    except SolveError as fault:
        return str(fault)
    if harmonics <= PATIENCE:
        return ""
    return (
        f"joints and torques repeat together only every {float(1 / at.order):.6g} revolutions of the reference shaft, "
        f"which takes {harmonics} harmonics or more; request it with `response: {{method: harmonic-balance}}`"
    )


def periodic_over_speed(
    study: Study, system: System, first_order: Response, *, progress: Progress = silent
) -> PeriodicResponse:
    """The exact periodic response over the range of a first-order response, at as many speeds as it is worth.

    Every speed is started from the nearest that is solved.
    """
    at = scene(study, system)
    each = max(1.0, at.layout.free * max(1.0, harmonics_at_least(at) / FEW))
    number = int(np.clip(WORK // each, FEWEST, MOST))
    known: dict[float, tuple[Orbit | None, str]] = {}

    def solve(speeds: FloatArray) -> PeriodicResponse:
        for speed in speeds.tolist():
            if speed not in known:
                progress("harmonic balance", len(known) / number)
                solved = (one for one, _ in known.values() if one is not None)
                known[speed] = continued(at, speed, nearest(speed, solved))
        order = sorted(known)
        orbits = [known[speed][0] for speed in order]
        return response_of(at, orbits, np.array(order), tuple(known[speed][1] for speed in order))

    found = solve(start(study, first_order, number))
    while len(known) < number:
        more = around_peaks(found)[: number - len(known)]
        if not more.size:
            break
        found = solve(np.sort(more))
    progress("stability of the periodic motion", 1.0)
    found = replace(found, growth=growths(at, found))
    progress("other periodic motions", 1.0)
    further = others(at, found, worth_another_look(found, max(1, min(MOST_SOUGHT, number // EACH))))
    if further is not None:
        further = replace(further, growth=growths(at, further))
    return replace(found, others=further)


def worth_another_look(found: PeriodicResponse, most: int) -> list[int]:
    """Rows of the highest peaks, else of the largest torque; and the one whose motion is least stable."""
    size = np.abs(found.torque)
    largest = np.nan_to_num(size).max(axis=(1, 2), initial=0.0)
    rows = (list(dict.fromkeys(row for row, _, _ in _peaks(size))) or [int(largest.argmax())])[
        :most
    ]
    if found.growth is not None and found.is_unstable.any():
        rows.append(int(np.nanargmax(found.growth)))
    return list(dict.fromkeys(rows))


def growths(at: Scene, found: PeriodicResponse) -> FloatArray:
    """(speeds,) 1/s of small deviations from each periodic motion, on the lowest modes; NaN where there is none.

    With loss factors it is that of the motion beside it that dampers in their place make (`straight_modes.viscous`):
    of any other motion the free turning, which neither grows nor dies out, would seem to do either.
    """
    shapes = basis(at.layout)
    fewer = modes_that_matter(at, shapes, float(found.speed[-1]))
    there = damped(at, fewer)
    search = Search(there, shapes, fewer)

    def growth(own: Orbit | None) -> float:
        if own is None:
            return np.nan
        try:
            beside = own if there.layout is at.layout else orbit(there, own.now.loading.speed, own)
        except SolveError:
            return np.nan
        return search.exponents(beside, "monodromy").growth

    return np.array([growth(own) for own in found.orbits])


def start(study: Study, first_order: Response, number: int) -> FloatArray:
    """(speeds,) rad/s to begin with: of those requested, the rated one, and the highest peaks of the first order."""
    requested = first_order.speed[first_order.requested]
    few = max(2, int(EVERYWHERE * number))
    spread = (
        requested
        if len(requested) <= few
        else requested[np.linspace(0, len(requested) - 1, few).round().astype(int)]
    )
    size = np.where((first_order.status == 0)[:, :, None], np.abs(first_order.torque), np.nan)
    highest = first_order.speed[
        list(dict.fromkeys(row for row, _, _ in _peaks(size)))[: int(AT_PEAKS * number)]
    ]
    rated = study.operation.rated
    inside = (
        [] if rated is None or not requested[0] <= rated.speed <= requested[-1] else [rated.speed]
    )
    return np.unique(np.concatenate([spread, highest, inside]))


def around_peaks(found: PeriodicResponse) -> FloatArray:
    """(speeds,) rad/s half way to the neighbours of every peak that they do not resolve, the worst resolved first."""
    size = np.abs(found.torque)
    worst: dict[float, float] = {}
    for row, line, span in _peaks(size):
        for beside in (row - 1, row + 1):
            drop = 1.0 - size[beside, line, span] / size[row, line, span]
            here, there = float(found.speed[row]), float(found.speed[beside])
            closest = EDGE if np.isnan(drop) else CLOSEST
            if not drop <= RESOLVED and abs(there - here) > closest * here:
                middle = (here + there) / 2.0
                worst[middle] = max(worst.get(middle, 0.0), 1.0 if np.isnan(drop) else drop)
    return np.array(sorted(worst, key=lambda speed: -worst[speed]))


def _peaks(size: FloatArray) -> list[tuple[int, int, int]]:
    """Inner maxima over the first axis of (speeds, orders, spans), the largest of its span first.

    A neighbour without a value is no obstacle.
    """
    filled = np.where(np.isnan(size), -np.inf, size)
    highest = np.max(filled, axis=(0, 1), initial=0.0)
    inner = (
        (filled[1:-1] >= filled[:-2])
        & (filled[1:-1] >= filled[2:])
        & (filled[1:-1] > WORTH * highest)
    )
    row, line, span = np.nonzero(inner)
    order = np.argsort(-filled[row + 1, line, span] / highest[span], kind="stable")
    return list(
        zip((row + 1)[order].tolist(), line[order].tolist(), span[order].tolist(), strict=True)
    )
