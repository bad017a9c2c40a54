"""Forced response over frequency: the torques that act at every frequency, at one operating point."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response import grid
from torsion.analyses.response.amplitudes import (
    Components,
    FrequencyResponse,
    refuse_too_large,
    with_balance,
)
from torsion.analyses.response.balanced_couplings import balanced
from torsion.analyses.response.harmonic_components import Sources, sources, sweeping
from torsion.analyses.response.solver import answer, ground_damping, tabled_stiffness
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly import resolving
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.kernels.tree_response import Status
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
    """The response over `frequencies` (Hz), else over those of the analysis, to torques without order and frequency.

    Damping and mean torque are those at `speed` (rad/s), else at the rated, else at the highest speed. Raises
    InputError where nothing acts at every frequency, or frequencies lack. The system is refined as by `response`.
    """
    requested = _requested_frequencies(study, frequencies)
    system = resolving(system, float(requested[-1]), refine=refine)
    excitation = sweeping(system)
    if not excitation.torques:
        hint = "give an excitation neither `order` nor `frequency`"
        raise InputError([Fault(PATH, "no torque acts at every frequency", hint)])
    at = np.array([(study.operation.speed or 0.0) if speed is None else speed])
    mean = steady_if_known(study, system, at) if at[0] > 0 else None
    ground = ground_damping(system, at, mean)
    drive = sources(system, excitation, at, mean)

    def solved(hertz: FloatArray) -> FrequencyResponse:
        columns = (1, len(hertz))
        force, w, tiled = (
            Sources(np.tile(drive.force, columns), None),
            2.0 * math.pi * hertz,
            np.tile(ground, columns),
        )
        carried = (
            np.zeros((len(system.spans), len(w))) if mean is None else np.tile(mean.torque, columns)
        )
        following = None
        if study.train.has_tables_over("vibratory torque"):
            from torsion.analyses.response.vibratory_couplings import settled

            following = settled(
                system,
                Components([None], [w], [[force]], tiled, carried, np.broadcast_to(at, w.shape)),
                0,
            )
        stiffness = tabled_stiffness(
            system, w, carried, at, None if following is None else following.by_span
        )
        solve = partial(answer, system, w, force, tiled, stiffness=stiffness)
        balance = balanced(system, [w], carried, lambda added: [solve(added)])
        found = solve({} if balance is None else balance.added)
        status = (
            found.status
            if balance is None
            else np.where(balance.settled, found.status, Status.SINGULAR)
        )
        status = (
            status if following is None else np.where(following.settled, status, Status.SINGULAR)
        )
        flags = np.zeros(len(hertz), dtype=bool)
        names = excitation.line.sources
        return FrequencyResponse(
            hertz,
            flags,
            names,
            float(at[0]),
            found.angle,
            found.torque,
            found.residual,
            status,
            system,
            balanced=balance,
            following=following,
        )

    known = grid.resonances(system, 2.0 * math.pi * float(requested[-1]), modes, damped)
    where = known, system, np.array([2.0 * math.pi]), requested[0], requested[-1]
    points, remark = grid.refined(
        requested, *grid.places(*where, lambda hertz: np.tile(ground, (1, len(hertz))))
    )
    refuse = partial(refuse_too_large, system, 1, study.memory, PATH, "frequencies")
    found = grid.with_peaks(solved, requested, points, remark, refuse)
    return replace(found, remark=with_balance(found, 1.0, "Hz"))


def _requested_frequencies(study: Study, frequencies: FloatArray | None) -> FloatArray:
    """(frequencies,) Hz, ascending."""
    if frequencies is not None:
        return np.unique(np.asarray(frequencies, dtype=np.float64))
    requested: FrequencyRange | None = getattr(study.analyses.get("response"), "frequencies", None)
    if requested is None:
        hint = "for example `frequencies: {from: 1, to: 200}`"
        raise InputError([Fault(PATH[:2], "a response over frequency needs the frequencies", hint)])
    return requested.values()


def run(work: Work) -> None:
    """The response over the frequencies that the file names."""
    with work.log.step("response over frequency", "requested") as step:
        found = frequency_response(
            work.study, work.system, modes=work.get(Modes), damped=work.get(DampedModes)
        )
        step.method = "two-sided elimination"
        step.size = f"{found.frequency.size} frequencies"
    work.put(frequency_response=found)
