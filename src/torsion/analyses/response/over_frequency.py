"""Forced response over frequency: the torques that act at every frequency, at one operating point."""

import math
from functools import partial

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response import grid
from torsion.analyses.response.amplitudes import (
    Components,
    FrequencyResponse,
    refuse_too_large,
)
from torsion.analyses.response.harmonic_components import Sources, sources, sweeping
from torsion.analyses.response.over_speed import solve_components
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly import resolving
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.study import FrequencyRange, Study

PATH = ("analyses", "response", "frequencies")


def frequency_response(
    study: Study,
    system: System,
    *,
    damped: DampedModes | None = None,
    modes: Modes | None = None,
    frequencies: FloatArray | None = None,
    speed: float | None = None,
    refine: bool = True,
) -> FrequencyResponse:
    """Return the response over `frequencies` (Hz), else over those of the analysis, to torques at every frequency.

    Damping and mean torque are those at `speed` (rad/s), else at the rated, else at the highest speed. Raises
    InputError where nothing acts at every frequency, or frequencies lack. The system is refined as by `response`.
    """
    if frequencies is None:
        steps: FrequencyRange | None = getattr(study.analyses.get("response"), "frequencies", None)
        if steps is None:
            message = "a response over frequency needs the frequencies"
            hint = "for example `frequencies: {from: 1, to: 200}`"
            raise InputError([Fault(PATH[:2], message, hint)])
        requested = steps.values()
    else:
        requested = np.unique(np.asarray(frequencies, dtype=np.float64))
    highest = float(requested[-1])
    system = resolving(system, highest, excited=highest, refine=refine)
    excitation = sweeping(system)
    if not excitation.torques:
        hint = "give an excitation neither `order` nor `frequency`"
        raise InputError([Fault(PATH, "no torque acts at every frequency", hint)])
    speeds = np.array([(study.operation.speed or 0.0) if speed is None else speed])
    mean = steady_if_known(study, system, speeds) if speeds[0] > 0 else None
    torque = np.zeros((len(system.spans), 1)) if mean is None else mean.torque
    ground = ground_damping(system, speeds, mean)
    force = sources(system, excitation, speeds, mean).force

    def solve(hertz: FloatArray) -> FrequencyResponse:
        columns = (1, len(hertz))
        w = 2.0 * math.pi * hertz
        acting = [[Sources(np.tile(force, columns), None)]]
        around = np.tile(ground, columns), np.tile(torque, columns), np.tile(speeds, len(hertz))
        components = Components([None], [w], acting, *around)
        answers, balance, following = solve_components(system, components)
        return FrequencyResponse(
            frequency=hertz,
            requested=np.zeros(len(hertz), dtype=bool),
            sources=excitation.line.sources,
            speed=float(speeds[0]),
            **vars(next(answers)),
            system=system,
            balanced=balance,
            following=following,
        )

    # A frequency in Hz is as a speed of the order 2 pi: its grid is that of a response over speed.
    places = grid.resonances(
        system,
        np.array([2.0 * math.pi]),
        requested[0],
        requested[-1],
        lambda hertz: np.tile(ground, (1, len(hertz))),
        modes,
        damped,
    )
    points, remark = grid.refined(requested, *places)
    refuse = partial(refuse_too_large, system, 1, study.memory, PATH, "frequencies")
    return grid.with_peaks(solve, requested, points, remark, refuse, (1.0, "Hz"))


def run(work: Work) -> None:
    """Put the response over the frequencies that the file names."""
    with work.log.step("response over frequency", "requested") as step:
        modes = work.get(Modes)
        damped = work.get(DampedModes)
        result = frequency_response(work.study, work.system, modes=modes, damped=damped)
        step.method = "two-sided elimination"
        step.size = f"{result.frequency.size} frequencies"
    work.put(frequency_response=result)
