"""Error against run time of the methods of integration, for the motions over time that a file names."""

import math
from functools import partial

import numpy as np

from torsion.analyses.compare.timing import Candidate, Effort, TimedQuantity, timed
from torsion.analyses.discretisation import assembled
from torsion.analyses.transient.compared_methods import (
    COMPARED,
    March,
    errors_of,
    linear_curves,
    marched,
    solved,
)
from torsion.analyses.transient.energy_balance import residual
from torsion.analyses.transient.torque_curves import Curves
from torsion.analyses.transient.transient_settings import SOLVED, TransientSettings, cases
from torsion.assembly.system import System
from torsion.errors import InputError, Path, SolveError
from torsion.findings import Progress
from torsion.kernels.transient.integrator_methods import METHODS, TITLES
from torsion.study import Study

FIRST, FINER, ROWS = 100, 4, 6  # steps of the coarsest row, how many times more the next has, rows
TOLERANCES = (1e-4, 1e-7, 1e-10)
EXACT = "modes, exact"
MEANING = (
    "The error is the largest difference of a torque at about 200 times, relative to the largest torque of its span; "
    "the worst of all spans counts. Step-by-step methods take a torque as straight within a step. Modes, mean torques "
    "and steady vibration, which all methods need, are counted as assembly."
)
REFERENCE = (
    "Reference: the exact motion, whose error is given as 0 for that reason; its bound is the error of its balance of "
    "energy."
)


def timed_motions(
    study: Study, highest: float, effort: Effort, progress: Progress
) -> tuple[list[TimedQuantity], list[str]]:
    """Of every linear motion; and why others are not compared. highest: Hz, for which shafts are divided."""
    found, remarks = list[TimedQuantity](), list[str]()
    system = assembled(study, highest)
    for number, (settings, place) in enumerate(cases(study)):
        title = f"Motion over time {settings.name}".rstrip()
        try:
            found.append(
                _timed(
                    study,
                    system,
                    settings,
                    place,
                    effort,
                    progress,
                    title=title,
                    key=f"motion-{number + 1}",
                )
            )
        except InputError as error:
            remarks.append(
                f"{title} is not compared: {'; '.join(fault.message for fault in error.faults)}."
            )
        except SolveError as error:
            remarks.append(f"{title} is not compared: {error}.")
    return found, remarks


def _timed(
    study: Study,
    system: System,
    settings: TransientSettings,
    place: Path,
    effort: Effort,
    progress: Progress,
    *,
    title: str,
    key: str,
) -> TimedQuantity:
    made = partial(linear_curves, study, system, settings, place)
    curves, duration = made(), settings.duration

    def errors(march: March) -> tuple[float, ...]:
        return tuple(errors_of(curves, march).tolist())

    rows = [FIRST * FINER**k for k in range(ROWS)]
    named = partial(Candidate, assemble=made, errors=errors)
    exact = [
        named(EXACT, f"{n} samples", n, solve=partial(_exact, duration=duration, number=n))
        for n in rows
    ]
    every = [exact]
    for name in METHODS:
        own = [(n, duration / n) for n in rows]
        every.append(
            [
                named(
                    TITLES[name],
                    f"{h:.3g} s",
                    n,
                    solve=partial(_marched, method=name, step=h, duration=duration),
                )
                for n, h in own
            ]
        )
    for name, word in SOLVED.items():
        every.append(
            [
                named(
                    word,
                    f"tolerance {t:g}",
                    n,
                    solve=partial(_solved, method=name, tolerance=t, duration=duration),
                )
                for n, t in enumerate(TOLERANCES, start=1)
            ]
        )
    found, remarks = timed(every, effort, title, progress)
    fastest = curves.fastest / (2.0 * math.pi)
    about = f"{title}, {duration:g} s, {len(curves.found.frequency)} elastic modes up to {fastest:.5g} Hz. {MEANING}"
    bound = max(
        residual(curves.motion, np.linspace(0.0, duration, COMPARED)), float(np.finfo(float).eps)
    )
    names = tuple(span.name for span in system.spans)
    return TimedQuantity(key, title, about, REFERENCE, bound, fastest, names, found, remarks)


def _exact(curves: Curves, duration: float, number: int) -> March:
    """The torques of every sample; of them those that are compared."""
    time = np.linspace(0.0, duration, number + 1)
    _, _, (place, speed) = curves.torque(time)
    chosen = slice(None, None, max(1, number // COMPARED))
    return March(time[chosen], place[:, chosen], speed[:, chosen])


def _marched(curves: Curves, method: str, step: float, duration: float) -> March:
    return marched(curves.motion, method, step, duration)


def _solved(curves: Curves, method: str, tolerance: float, duration: float) -> March:
    return solved(curves.motion, method, tolerance, duration)
