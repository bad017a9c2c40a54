"""A study to its findings: only what is asked, and what that needs, is computed."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.division import assembled, divided_modes, told_division, told_method, told_model
from torsion.analyses.modes import Modes
from torsion.asked import has_inertia, highest_excited, modes_asked, operating_speed
from torsion.assembly.system import System
from torsion.errors import InputError
from torsion.plan import Log, Plan, versions
from torsion.steps import motion
from torsion.steps.bending import bending as bend
from torsion.steps.response import Known, over_speed
from torsion.steps.sections import sections
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.compare.side_by_side import Compared
    from torsion.analyses.critical import CriticalSpeed
    from torsion.analyses.damped import DampedModes
    from torsion.analyses.joints.joints import Joints
    from torsion.analyses.lateral.bending import Lateral
    from torsion.analyses.motion.map import StabilityMap
    from torsion.analyses.motion.periodic import PeriodicResponse
    from torsion.analyses.motion.stability import Stability
    from torsion.analyses.response.over_speed import FrequencyResponse, Response
    from torsion.analyses.response.synthesis import Synthesis
    from torsion.analyses.steady import Steady
    from torsion.rules.check import Check

Progress = Callable[[str, float], None]  # (what, share done 0..1)


@dataclass(frozen=True)
class Findings:
    """Everything a study asks; what it does not ask is None or empty."""

    study: Study
    system: System
    plan: Plan
    modes: Modes | None = None
    damped: "DampedModes | None" = None
    steady: "Steady | None" = None
    critical: "tuple[CriticalSpeed, ...]" = ()
    response: "Response | None" = None
    synthesis: "Synthesis | None" = None
    sweep: "FrequencyResponse | None" = None
    joints: "Joints | None" = None
    lateral: "Lateral | None" = None
    checks: "tuple[Check, ...]" = ()
    check: "Compared | None" = None
    periodic: "PeriodicResponse | None" = None
    stability: "Stability | None" = None
    stability_map: "StabilityMap | None" = None

    @property
    def failed(self) -> bool:
        """A rule, or a model of the shafts, does not keep its limit."""
        models = () if self.check is None else self.check.failed
        return bool(models) or any(check.verdict == "fail" for check in self.checks)


def run(study: Study, *, progress: Progress | None = None, bending: bool = True) -> Findings:
    """Compute everything that the study asks. Raises InputError (located in the study's file) and SolveError.

    bending False leaves out the bending of the shafts, though the study asks it.
    """
    try:
        return _run(study, progress or _silent, bending)
    except InputError as error:
        from torsion.schema.read import located

        raise located(error, study) from None


def _silent(what: str, share: float) -> None:
    """No progress is shown."""


def _run(study: Study, progress: Progress, bending: bool) -> Findings:
    log = Log()
    sections(study, log)
    system, found = _system_and_modes(study, log, progress)
    damped = _damped(study, system, log)
    steady = _steady(study, system, log)
    response, synthesis = over_speed(study, system, Known(found, damped, steady), log, progress)
    moved = motion.exact(study, system, response, log, progress)
    sweep = _sweep(study, system, found, damped, log)
    critical = _critical(study, system, found, log)
    joints = _joints(study, steady, log)
    bent, held = bend(study, log, progress) if bending and study.bends else (None, ())
    checks = (*moved.checks, *held, *_checks(study, system, (found, steady, response, synthesis, joints), log))
    compared = compared_models(study, log, progress)
    plan = Plan(tuple(log.lines), tuple(log.left_out), versions(system, bent is not None))
    return Findings(
        study, system, plan, found, damped, steady, critical, response, synthesis, sweep, joints, bent, checks,
        compared, moved.periodic, moved.stability, moved.stability_map,
    )  # fmt: skip


def _system_and_modes(study: Study, log: Log, progress: Progress) -> tuple[System, Modes | None]:
    """The train divided finely enough for the highest frequency asked for, and its modes if they are asked."""
    asked = modes_asked(study)
    with log.step("assembly", "everything stands on it") as step:
        system = assembled(study)
        highest = highest_excited(study, system)
        if highest:
            system = assembled(study, highest)
        step.method = told_model(system)
        step.size = _size(system)
    if not has_inertia(system):
        log.without("natural frequencies", "no component has an inertia")
        return system, None
    if asked is None:
        log.without("natural frequencies", "`analyses` does not name modes")
        return system, None
    with log.step("natural frequencies", "asked" if "modes" in study.analyses else "the default") as step:
        system, found = divided_modes(
            study, system, highest, asked.count, progress=lambda done, of: progress("natural frequencies", done / of)
        )
        step.method = told_method(system, found)
        step.size = f"{found.frequency.size} of {_size(system)}; {told_division(system)}"
    return system, found


def _size(system: System) -> str:
    return f"{len(system.stations)} stations, {len(system.spans)} spans"


def _damped(study: Study, system: System, log: Log) -> "DampedModes | None":
    asked = modes_asked(study)
    if asked is None:
        return None
    if asked.damped is False or not system.damps:
        log.without("damped modes", "`damped: false`" if asked.damped is False else "nothing in the train damps")
        return None
    if system.bars is not None:
        log.without("damped modes", f"they are built for `model: lumped`; the response of {system.model} is damped")
        return None
    if system.folded.extra.size:
        why = "the train has closed loops, or rigid spans hold it at several points"
        log.without("damped modes", f"{why}; its response is damped all the same")
        return None
    from torsion.analyses.steady import has_mean_torque, steady

    speed = operating_speed(study.operation)
    needs_speed = any(damper.torque_factor or damper.speed_factor for damper in system.dampers)
    needs_torque = any(damper.torque_factor for damper in system.dampers)
    if (needs_speed and speed is None) or (needs_torque and not has_mean_torque(study.operation)):
        log.without("damped modes", "the damping depends on speed and mean torque; give `operation: rated`")
        return None
    from torsion.analyses.damped import damped

    mean = None
    if needs_torque and speed is not None:
        mean = steady(study.train, system, study.operation, np.array([speed]))
    with log.step("damped modes", "something damps") as step:
        found = damped(system, speed=speed or 0.0, steady=mean, count=asked.count)
        step.method = "Newton with two-sided vectors on the quadratic problem"
        step.size = f"{found.frequency.size} modes" + ("" if speed is None else f" at {speed * 30 / math.pi:.6g} rpm")
    return found


def _sweep(
    study: Study, system: System, found: Modes | None, damped: "DampedModes | None", log: Log
) -> "FrequencyResponse | None":
    asked = study.analyses.get("response")
    if getattr(asked, "frequencies", None) is None:
        return None
    from torsion.analyses.response.over_frequency import frequency_response

    with log.step("response over frequency", "asked") as step:
        answer = frequency_response(study, system, modes=found, damped=damped)
        step.method = "two-sided elimination"
        step.size = f"{answer.frequency.size} frequencies"
    return answer


def _steady(study: Study, system: System, log: Log) -> "Steady | None":
    from torsion.analyses.steady import has_mean_torque, steady

    if not has_mean_torque(study.operation):
        log.without("mean torque", "`operation` says no rated power and no table of the load")
        return None
    speeds, speed = study.operation.speeds, operating_speed(study.operation)
    grid = speeds.values() if speeds is not None else np.array([speed] if speed is not None else [])
    if speed is not None and study.operation.rated is not None:
        grid = np.union1d(grid, [speed])
    if speeds is not None and not isinstance(study.operation.load, str):
        corners = [row[0] for row in study.operation.load if speeds.first <= row[0] <= speeds.last]
        grid = np.union1d(grid, corners)
    if not grid.size:
        log.without("mean torque", "`operation` says no speed")
        return None
    with log.step("mean torque", "`operation` says the load") as step:
        found = steady(study.train, system, study.operation, grid)
        step.method = "sums over the tree"
        step.size = f"{grid.size} speeds"
    return found


def _critical(study: Study, system: System, found: Modes | None, log: Log) -> "tuple[CriticalSpeed, ...]":
    from torsion.analyses.response.excitation import excitations

    lines = tuple(excitation.line for excitation in excitations(system))
    if found is None or not any(line.order is not None for line in lines):
        log.without("critical speeds", "no modes" if found is None else "no order excites")
        return ()
    from torsion.analyses.critical import critical_speeds

    return critical_speeds(found, lines, study.operation)


def _joints(study: Study, steady: "Steady | None", log: Log) -> "Joints | None":
    asked = study.analyses.get("joints")
    if asked is None and all(part.component.keyword != "joint" for part in study.train.parts):
        return None
    from torsion.analyses.joints.joints import Asked, joints

    with log.step("universal joints", "the train has joints" if asked is None else "asked") as step:
        found = joints(study.train, study.operation, asked if isinstance(asked, Asked) else None, steady)
        step.method = "exact kinematics of rigid shafts, each line as one joint"
        step.size = f"{len(found.joints)} joints on {len(found.lines)} lines, {found.angle.size} angles"
    for remark in found.remarks:
        log.without("universal joints, in part", remark)
    return found


def compared_models(study: Study, log: Log, progress: Progress, *, always: bool = False) -> "Compared | None":
    """The models of the shafts side by side, where the study asks that, or `always`."""
    asked = study.analyses.get("check")
    if asked is None and not always:
        return None
    from torsion.analyses.compare.side_by_side import Asked, check

    with log.step("comparison of the models", "asked") as step:
        found = check(study, asked if isinstance(asked, Asked) else None, progress=progress)
        models = [] if found.exact is None else [found.exact, *found.models]
        step.method = ", ".join(model.model for model in models) or "all models are the same"
        step.size = "; ".join(f"{model.model}: {model.division}" for model in models)
    if found.no_torques:
        log.without("comparison of response torques", found.no_torques)
    return found


def _checks(
    study: Study,
    system: System,
    results: "tuple[Modes | None, Steady | None, Response | None, Synthesis | None, Joints | None]",
    log: Log,
) -> "tuple[Check, ...]":
    if not study.rules:
        log.without("rules", "the file names none")
        return ()
    from torsion.rules import not_judged, verdicts
    from torsion.rules.evidence import Evidence

    with log.step("rules", "the file names them") as step:
        checks = verdicts(Evidence(study, system, *results))
        step.method = ", ".join(name for name, _ in study.rules)
        step.size = f"{len(checks)} checks"
    for what, why in not_judged(study):
        log.without(what, why)
    return checks
