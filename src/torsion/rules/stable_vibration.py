"""The verdict on vibration that grows: a load whose torque falls with speed can feed it."""

from collections.abc import Iterable

import numpy as np

from torsion.analyses.damped_modes import damped
from torsion.analyses.law_slopes import rows_of_tables
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.errors import SolveError
from torsion.findings import Results
from torsion.rules.demands import in_rpm
from torsion.rules.verdict_line import Check, Rule, RuleSettings, Verdict

WHOLE = "whole train"
SPEEDS = 41  # over the operation, at which the eigenvalues are computed
BESIDE = 1e-6  # relative: just below and above a row of a table
ROUNDING = 1e-9  # of an eigenvalue: a smaller growth is none


class StableVibration(Rule[RuleSettings]):
    """The rule on a train in which a damping to ground is negative."""

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Yield one check of the whole train; none where no damping by the law of a load is negative."""
        study, system = evidence.study, evidence.system
        operated, single = study.operation.speeds, study.operation.speed
        speeds = np.array([] if single is None else [single])
        if operated is not None:
            speeds = np.linspace(operated.first, operated.last, SPEEDS)
        even = speeds.size
        if even:
            # A slope of a table holds between two rows of it, and may do so between two of these speeds.
            rows = rows_of_tables(study)
            further = [
                *(rows * (1.0 - BESIDE)),
                *(rows * (1.0 + BESIDE)),
                *(rows[1:] + rows[:-1]) / 2.0,
            ]
            inside = [speed for speed in further if speeds[0] <= speed <= speeds[-1]]
            speeds = np.concatenate([speeds, inside, [] if single is None else [single]])
        steady = steady_if_known(study, system, speeds) if even else None
        if steady is None:
            return
        damping = ground_damping(system, speeds, steady)
        if not np.any(damping < 0.0):
            return
        is_judged = (damping < 0.0).any(axis=0) | (np.arange(len(speeds)) < even)
        speeds, damping = speeds[is_judged], damping[:, is_judged]

        sources = ", ".join(
            system.stations[station].name
            for station in np.flatnonzero((damping < 0.0).any(axis=1)).tolist()
        )
        notes = [f"the slope of the load law of {sources} is negative: it feeds vibration"]
        # The largest growth rate of an oscillating mode, which is not known where damped modes are not built.
        verdict: Verdict = "not judged"
        growth, worst_speed, frequency = -np.inf, float(speeds[0]), 0.0
        try:
            for speed in speeds.tolist():
                steady = steady_if_known(study, system, np.array([speed]))
                modes = damped(system, speed=speed, steady=steady, count=None)
                for root, hertz in zip(modes.eigenvalue.real, modes.frequency, strict=True):
                    if root > growth:
                        growth, worst_speed, frequency = float(root), speed, float(hertz)
            verdict = "pass" if growth <= ROUNDING * 2.0 * np.pi * frequency else "fail"
            notes.append(f"mode at {frequency:.5g} Hz, at {in_rpm(worst_speed)}")
        except SolveError as error:
            growth = np.nan
            notes.append(f"the damped modes are not known: {error.message}")
        about = "stability", "vibration", WHOLE, "Growth of small vibrations"
        at_speed = None if np.isnan(growth) else worst_speed
        note = "; ".join(notes)
        yield Check(*about, growth, 0.0, "1/s", verdict, "by definition", at_speed, note=note)
