"""Methods of integration compared with the exact motion of a linear train: the step-by-step ones, DOP853 and Radau.

All of them march the certified modes, which for a linear method is the same motion as that of the assembled angles, and
sees less rounding. Torques are then read as those of the exact motion are.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from torsion.analyses.transient.acting_torques import acting_torques, without_excluded_torques
from torsion.analyses.transient.direct_torques import direct_torques
from torsion.analyses.transient.following_torques import carrier_of, torques_follow
from torsion.analyses.transient.known_loads import known_loads
from torsion.analyses.transient.modal_train import (
    kept_modes,
    modal_train,
    shapes,
    slowed_torques,
    start,
)
from torsion.analyses.transient.state_before import points_of_events, state_before
from torsion.analyses.transient.torque_curves import Curves
from torsion.analyses.transient.transient_settings import SOLVED, TransientSettings
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.kernels.transient.damped_motion import Motion, motion
from torsion.kernels.transient.integrator_methods import METHODS, marching, moved, started
from torsion.results import reported, result
from torsion.study import Study

COMPARED = 200  # times at which torques are compared, about
MOST_VALUES = 2e8  # numbers of a march that are kept
HOPELESS = 1e6  # relative error from which a method has no answer
NOTHING = 1e-9  # of the largest torque of the train: a span that carries less is not compared


@reported
class ComparedMethod:
    """A method beside the exact motion."""

    method: str = result("", (), "as the file names it")
    step: float | None = result("s", (), "its step; null if `tolerance` controls the steps")
    error: float | None = result(
        "1",
        (),
        "largest error of a torque, relative to the largest torque of its span; null if the method failed",
    )
    seconds: float = result("s", (), "run time of the march", key="run_time_s")


def linear_curves(study: Study, system: System, settings: TransientSettings, place: Path) -> Curves:
    """The exact motion of a train that is linear.

    Raises InputError, at the `method`, where torques follow the motion or a coupling is nonlinear.
    """
    study, system = without_excluded_torques(study, system, settings)
    events = settings.events
    if study.train.has_nonlinear_couplings or torques_follow(study, system, events):
        message = "methods are compared on linear motions, without backlash, friction, starts, loads, joints or sweeps"
        orders = [
            words
            for words in acting_torques(study, settings).acting
            if words.endswith("by its angle)")
        ]
        if orders:
            message = (
                f"methods are compared on linear motions, not together with {', '.join(orders)}"
            )
        raise InputError(
            [
                Fault(
                    (*place, "method"),
                    message,
                    "method: exact" + "; or `torques: none`" * bool(orders),
                )
            ]
        )
    before, modes = (
        state_before(study, system, settings, place),
        kept_modes(system, settings.modes, place)[0],
    )
    points, shape = (
        points_of_events(study, system, events, before, place, turns=False),
        shapes(system, modes),
    )
    train = modal_train(study, system, modes, shape, before)
    vibrates = bool(before.frequency.size)
    loads, acting = known_loads(study, system, events, points, None, before, vibrates=vibrates)
    exact = motion(train, shape.T @ acting, loads, *start(system, modes, before, shape))
    direct = direct_torques(
        system, modes, acting, is_band=system.bars is not None or settings.modes != "all"
    )
    slowed, carrier = (
        slowed_torques(study, system, modes, shape, before),
        carrier_of(study, system, events, before),
    )
    return Curves(system, modes, before, shape, exact, slowed, direct, carrier)


@dataclass(frozen=True)
class March:
    """Places and speeds (rigid motions + modes, times) of a method at some times (s)."""

    time: FloatArray
    place: FloatArray
    speed: FloatArray


def marched(exact: Motion, method: str, step: float, duration: float) -> March:
    """By a step-by-step method, from time 0 on; every step sees the torques at both of its ends, also where they jump.

    Raises SolveError where it would keep too much.
    """
    n, steps = len(exact.force), max(1, math.ceil(duration / step * (1.0 - 1e-12)))
    if 3.0 * n * steps > MOST_VALUES:
        message = f"{steps} steps of {n} motions need {24e-9 * n * steps:.2g} GB"
        raise SolveError(message, "a longer `step`, or a shorter `duration`")
    time, inertia = np.arange(steps + 1, dtype=np.float64) * step, np.eye(n)
    after = (exact.force @ exact.loads_at(np.nextafter(time[1:], 0.0))).T
    march = marching(
        METHODS[method], inertia, exact.train.damping, np.diag(exact.train.w_of_all**2), step
    )
    place, speed = exact.at(time[:1])
    gained = exact.acceleration(time[:1], place, speed)
    begin = started(METHODS[method], place[:, 0], speed[:, 0], gained[:, 0], step)
    states = march.histories(exact.force_at(time[:-1]).T, after, begin)
    chosen = np.arange(0, steps + 1, max(1, steps // COMPARED))
    with np.errstate(all="ignore"):
        places, speeds = moved(METHODS[method], states, step)
    return March(time[chosen], places[chosen].T, speeds[chosen].T)


def solved(exact: Motion, method: str, tolerance: float, duration: float) -> March:
    """By DOP853 or Radau of scipy, anew at every time at which a torque begins, ends or has a kink.

    Raises SolveError where it finds no motion.
    """
    from scipy.integrate import solve_ivp

    solve: Any = solve_ivp
    n, w2 = len(exact.force), exact.train.w_of_all**2
    damping = exact.train.damping
    matrix = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(w2), -damping]])
    every = np.linspace(0.0, duration, COMPARED + 1)
    edges = [0.0, *(one for one in exact.cuts.tolist() if 0.0 < one < duration), duration]
    state = np.concatenate([one[:, 0] for one in exact.at(np.zeros(1))])
    found = np.empty((2 * n, len(every)))
    found[:, 0] = state
    size = np.concatenate([np.abs(one).max(axis=1) for one in exact.at(every)])
    floor = tolerance * np.maximum(
        size, NOTHING * float(size.max(initial=0.0)) + np.finfo(float).tiny
    )
    more = {"jac": matrix} if method == "radau" else {}
    for begin, end in pairwise(edges):
        last = np.nextafter(end, 0.0)

        def rate(at: float, x: FloatArray, last: float = last) -> FloatArray:
            force = exact.force_at(np.array([min(at, last)]))[:, 0]
            return np.asarray(matrix @ x + np.concatenate([np.zeros(n), force]))

        here = (every > begin) & (every <= end)
        wanted = np.unique([*every[here].tolist(), end])
        run = solve(
            rate,
            (begin, end),
            state,
            method=SOLVED[method],
            t_eval=wanted,
            rtol=max(tolerance, 1e-13),
            atol=floor,
            **more,
        )
        if not run.success:
            raise SolveError(f"{SOLVED[method]} finds no motion: {run.message}", "method: exact")
        found[:, here], state = run.y[:, np.isin(wanted, every[here])], run.y[:, -1]
    return March(every, found[:n], found[n:])


def errors_of(curves: Curves, march: March) -> FloatArray:
    """(spans,) largest error of every torque, of its own largest; 0 for one of nothing, infinite without an answer."""
    exact = curves.torque(march.time)[0]
    peak = np.abs(exact).max(axis=1)
    with np.errstate(all="ignore"):
        difference = np.abs(curves.carried(march.time, march.place, march.speed) - exact).max(
            axis=1
        )
        found = np.where(
            peak > NOTHING * peak.max(initial=0.0),
            difference / np.where(peak > 0.0, peak, 1.0),
            0.0,
        )
    return np.asarray(np.where(found < HOPELESS, found, np.inf))


def compared(
    study: Study, system: System, settings: TransientSettings, place: Path
) -> ComparedMethod:
    """The method that the settings name, which is not the exact one, beside it."""
    curves = linear_curves(study, system, settings, place)
    begin = time.perf_counter()
    march = method_of(curves, settings.method, settings.step, settings.tolerance)(settings.duration)
    seconds = time.perf_counter() - begin
    error = float(errors_of(curves, march).max(initial=0.0))
    return ComparedMethod(
        settings.method, settings.step, error if math.isfinite(error) else None, seconds
    )


def method_of(
    curves: Curves, method: str, step: float | None, tolerance: float
) -> Callable[[float], March]:
    """What marches for a duration."""
    if method in SOLVED:
        return lambda duration: solved(curves.motion, method, tolerance, duration)
    return lambda duration: marched(curves.motion, method, step or duration, duration)
