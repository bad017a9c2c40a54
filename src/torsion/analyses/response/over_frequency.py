"""Forced response over frequency: the torques that act at every frequency, at one operating point."""

import math
from dataclasses import replace

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response import grid
from torsion.analyses.response.amplitudes import FrequencyResponse, merged
from torsion.analyses.response.harmonic_components import Sources, sources, sweeping
from torsion.analyses.response.size import refuse_too_large
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly import resolving
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.findings import Work
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
    refine: bool = True,
) -> FrequencyResponse:
    """The response over `frequencies` (Hz), else over those of the analysis, to torques without order and frequency.

    Damping and mean torque are those at `speed` (rad/s), else at the rated, else at the highest speed. Raises
    InputError where nothing acts at every frequency, or frequencies lack. The system is refined as by `response`.
    """
    asked = _asked_frequencies(study, frequencies)
    system = resolving(system, float(asked[-1]), refine=refine)
    excitation = sweeping(system)
    if not excitation.torques:
        hint = "give an excitation neither `order` nor `frequency`"
        path = ("analyses", "response", "frequencies")
        raise InputError([Fault(path, "no torque acts at every frequency", hint)])
    at = np.array([(study.operation.speed or 0.0) if speed is None else speed])
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
            hertz, flags, names, float(at[0]), found.angle, found.torque, found.residual, found.status, system
        )

    known = grid.resonances(system, 2.0 * math.pi * float(asked[-1]), modes, damped)
    where = grid.places(known, np.array([2.0 * math.pi]), float(asked[0]), float(asked[-1]))
    ratio = grid.damping_ratios(known, where, np.tile(ground, (1, len(where.at))))
    hertz, remark = grid.refined(asked, where, ratio)
    path = ("analyses", "response", "frequencies")
    most = len(hertz) + min(len(hertz), grid.ROUNDS_FOR_PEAKS * grid.MOST_PEAKS)
    refuse_too_large(system, most, 1, study.memory, path, "frequencies")
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


def run(work: Work) -> None:
    """The response over the frequencies that the file names."""
    with work.log.step("response over frequency", "asked") as step:
        found = frequency_response(work.study, work.system, modes=work.get(Modes), damped=work.get(DampedModes))
        step.method = "two-sided elimination"
        step.size = f"{found.frequency.size} frequencies"
    work.put(frequency_response=found)
