"""The verdict on vibration that grows: a load whose torque falls with speed can feed it."""

import numpy as np

from torsion.analyses.damped_modes import damped
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import Steady, steady_if_known
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Results
from torsion.rules.demands import in_rpm
from torsion.rules.verdict_line import Check, Rule, RuleSettings, Verdict
from torsion.study import Study

WHOLE = "whole train"
SPEEDS = 41  # over the operation, at which the eigenvalues are computed
ROUNDING = 1e-9  # of an eigenvalue: a smaller growth is none


class StableVibration(Rule[RuleSettings]):
    """The rule on a train in which a damping to ground is negative."""

    def judge(self, evidence: Results) -> tuple[Check, ...]:
        """Return one check of the whole train; none where no damping is negative."""
        study, system = evidence.study, evidence.system
        operated, single = study.operation.speeds, study.operation.speed
        speeds = np.array([] if single is None else [single])
        if operated is not None:
            speeds = np.linspace(operated.first, operated.last, SPEEDS)
        steady = steady_if_known(study, system, speeds) if speeds.size else None
        if not any(damper.load_factor for damper in system.dampers) or steady is None:
            return ()
        damping = ground_damping(system, speeds, steady)
        if not np.any(damping < 0.0):
            return ()

        sources = ", ".join(
            system.stations[station].name
            for station in np.flatnonzero((damping < 0.0).any(axis=1)).tolist()
        )
        notes = [f"the slope of the load law of {sources} is negative: it feeds vibration"]
        try:
            growth, speed, frequency = largest_growth(study, system, speeds)
        except SolveError as error:
            notes.append(f"the damped modes are not known: {error.message}")
            return (_check(np.nan, None, "not judged", notes),)
        is_stable = growth <= ROUNDING * 2.0 * np.pi * frequency
        notes.append(f"mode at {frequency:.5g} Hz, at {in_rpm(speed)}")
        return (_check(growth, speed, "pass" if is_stable else "fail", notes),)


def largest_growth(study: Study, system: System, speeds: FloatArray) -> tuple[float, float, float]:
    """Return the largest growth rate (1/s) of an oscillating mode, its reference speed (rad/s) and frequency (Hz).

    Raises SolveError where the damped modes of the train are not built.
    """
    growth, at_speed, frequency = -np.inf, float(speeds[0]), 0.0
    for speed in speeds.tolist():
        steady: Steady | None = steady_if_known(study, system, np.array([speed]))
        modes = damped(system, speed=speed, steady=steady, count=None)
        worst = int(np.argmax(modes.eigenvalue.real)) if modes.eigenvalue.size else -1
        if worst >= 0 and modes.eigenvalue[worst].real > growth:
            growth, at_speed = float(modes.eigenvalue[worst].real), speed
            frequency = float(modes.frequency[worst])
    return growth, at_speed, frequency


def _check(growth: float, speed: float | None, verdict: Verdict, notes: list[str]) -> Check:
    return Check(
        "stability",
        "vibration",
        WHOLE,
        "Growth of small vibrations",
        growth,
        0.0,
        "1/s",
        verdict,
        "by definition",
        speed,
        note="; ".join(notes),
    )
