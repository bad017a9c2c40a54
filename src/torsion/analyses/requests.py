"""What a study requests of its analyses, and what that needs."""

import math

import numpy as np

from torsion.analyses.response.harmonic_components import excitations
from torsion.analyses.undamped_modes import ModesSettings
from torsion.assembly.system import System
from torsion.study import Study

Ruled = frozenset[str]  # analyses that the rules of a study read


def modes_settings(study: Study, ruled: Ruled) -> ModesSettings | None:
    """Settings of the modes that are computed; None where none are."""
    settings = study.analyses.get("modes")
    if isinstance(settings, ModesSettings):
        return settings
    return None if study.analyses and "modes" not in ruled else ModesSettings()


def highest_excited(study: Study, system: System, ruled: Ruled) -> float:
    """The highest frequency (Hz) of the response that is requested; 0 where none is."""
    if not response_is_requested(study, ruled):
        return 0.0
    frequencies = getattr(study.analyses.get("response"), "frequencies", None)
    highest = frequencies.last if frequencies is not None else 0.0
    speeds = study.operation.speeds
    for excitation in excitations(system):
        if excitation.line.frequency is not None:
            highest = max(highest, excitation.line.frequency)
        elif excitation.line.order is not None and speeds is not None:
            highest = max(highest, float(excitation.line.order) * speeds.last / (2.0 * math.pi))
    return float(highest)


def response_is_requested(study: Study, ruled: Ruled) -> bool:
    """The file names a response, or a rule reads it, or something excites and no analysis is named."""
    if "response" in study.analyses or "response" in ruled:
        return True
    return (study.excites or bool(study.train.torques)) and not study.analyses


def no_response(study: Study, system: System, ruled: Ruled) -> str:
    """Why there is no response over speed; empty where there is one."""
    if not study.excites:
        return "nothing excites"
    if not response_is_requested(study, ruled):
        return "it is not asked"
    if not has_inertia(system):
        return "no component has an inertia"
    return "" if study.operation.speeds is not None else "`operation` has no speeds"


def has_inertia(system: System) -> bool:
    """Something can vibrate."""
    if any(bar.density > 0 for bar in system.train.bars):
        return True
    return bool(np.any(np.isfinite(system.inertia) & (system.inertia > 0)))
