"""Forced response over frequency: the torques that act at every frequency, at one operating point."""

import math
from dataclasses import replace

import numpy as np

from torsion.analyses.damped import DampedModes
from torsion.analyses.modes import Modes
from torsion.analyses.response import grid
from torsion.analyses.response.amplitudes import FrequencyResponse, merged
from torsion.analyses.response.excitation import Sources, sources, sweeping
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import operating_speed, steady_if_known
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.kernels.tree import FloatArray
from torsion.kernels.tree_response import Status
from torsion.study import FrequencyRange, Study


def frequency_response(
    study: Study,
    system: System,
    *,
    damped: DampedModes | None = None,
    modes: Modes | None = None,
    frequencies: FloatArray | None = None,
    speed: float | None = None,
) -> FrequencyResponse:
    """The response over `frequencies` (Hz), else over those of the analysis, to torques without order and frequency.

    Damping and mean torque are those at `speed` (rad/s), else at the rated, else at the highest speed. Raises
    InputError where nothing acts at every frequency, or frequencies lack.
    """
    asked = _asked_frequencies(study, frequencies)
    excitation = sweeping(system)
    if not excitation.torques:
        hint = "give an excitation neither `order` nor `frequency`"
        path = ("analyses", "response", "frequencies")
        raise InputError([Fault(path, "no torque acts at every frequency", hint)])
    at = np.array([operating_speed(study.operation) if speed is None else speed])
    mean = steady_if_known(study, system, at) if at[0] > 0 else None
    ground = ground_damping(system, at, mean)
    drive = sources(system, excitation, at, mean)

    def solved(hertz: FloatArray) -> FrequencyResponse:
        columns = (1, len(hertz))
        force = Sources(np.tile(drive.force, columns), None)
        found = answer(system, 2.0 * math.pi * hertz, force, np.tile(ground, columns))
        flags = np.zeros(len(hertz), dtype=bool)
        names = excitation.line.sources
        return FrequencyResponse(
            hertz, flags, names, float(at[0]), found.angle, found.torque, found.residual, found.status
        )

    known = grid.resonances(system, 2.0 * math.pi * float(asked[-1]), modes, damped)
    where = grid.places(known, np.array([2.0 * math.pi]), float(asked[0]), float(asked[-1]))
    ratio = grid.damping_ratios(known, where, np.tile(ground, (1, len(where.at))))
    hertz, remark = grid.refined(asked, where, ratio)
    result = solved(hertz)
    for _ in range(grid.ROUNDS_FOR_PEAKS):
        sound = result.status == Status.OK
        missed, left_out = grid.missed_peaks(result.frequency, result.torque[:, None], sound[:, None])
        remark = left_out or remark
        if missed.size == 0:
            break
        result = merged(result, solved(missed))
    return replace(result, asked=np.isin(result.frequency, asked), remark=remark)


def _asked_frequencies(study: Study, frequencies: FloatArray | None) -> FloatArray:
    """(frequencies,) Hz, ascending."""
    if frequencies is not None:
        return np.unique(np.asarray(frequencies, dtype=np.float64))
    asked: FrequencyRange | None = getattr(study.analyses.get("response"), "frequencies", None)
    if asked is None:
        path = ("analyses", "response")
        hint = "for example `frequencies: {from: 1, to: 200}`"
        raise InputError([Fault(path, "a response over frequency needs the frequencies", hint)])
    return asked.values()
