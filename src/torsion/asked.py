"""What a study asks for, and what that needs: from here the plan follows."""

import math

import numpy as np

from torsion.analyses.modes import Asked as ModesAsked
from torsion.assembly.system import System
from torsion.study import Operation, Study


def modes_asked(study: Study) -> ModesAsked | None:
    """Settings of the modes that are computed; None where none are."""
    asked = study.analyses.get("modes")
    if isinstance(asked, ModesAsked):
        return asked
    return None if study.analyses and not rules_need(study, "modes") else ModesAsked()


def rules_need(study: Study, what: str) -> bool:
    """Whether a rule of the study reads an analysis."""
    if not study.rules:
        return False
    from torsion.rules import needed

    return what in needed(study)


def highest_excited(study: Study, system: System) -> float:
    """The highest frequency (Hz) of the response that is asked for; 0 where none is."""
    if not response_is_asked(study):
        return 0.0
    from torsion.analyses.response.excitation import excitations

    frequencies = getattr(study.analyses.get("response"), "frequencies", None)
    highest = frequencies.last if frequencies is not None else 0.0
    speeds = study.operation.speeds
    for excitation in excitations(system):
        if excitation.line.frequency is not None:
            highest = max(highest, excitation.line.frequency)
        elif excitation.line.order is not None and speeds is not None:
            highest = max(highest, float(excitation.line.order) * speeds.last / (2.0 * math.pi))
    return float(highest)


def response_is_asked(study: Study) -> bool:
    """The file names a response, or a rule reads it, or something excites and no analysis is named."""
    if "response" in study.analyses or rules_need(study, "response"):
        return True
    excites = bool(study.train.torques) or any(mesh.error for mesh in study.train.constraints)
    return excites and not study.analyses


def operating_speed(operation: Operation) -> float | None:
    """The speed (rad/s) at which damping that depends on speed is taken: rated, else the highest."""
    if operation.rated is not None:
        return operation.rated.speed
    return None if operation.speeds is None else operation.speeds.last


def no_response(study: Study, system: System, excites: bool) -> str:
    """Why there is no response over speed; empty where there is one."""
    if not excites:
        return "nothing excites"
    if not response_is_asked(study):
        return "it is not asked"
    if not has_inertia(system):
        return "no component has an inertia"
    return "" if study.operation.speeds is not None else "`operation` has no speeds"


def has_inertia(system: System) -> bool:
    """Something can vibrate."""
    if any(bar.density > 0 for bar in system.train.bars):
        return True
    return bool(np.any(np.isfinite(system.inertia) & (system.inertia > 0)))
