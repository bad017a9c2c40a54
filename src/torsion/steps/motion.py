"""Steps: the exact periodic response of a train with joints, its stability, and the map of it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.plan import Log
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.motion.asked import Asked
    from torsion.analyses.motion.map import StabilityMap
    from torsion.analyses.motion.periodic import PeriodicResponse
    from torsion.analyses.motion.stability import Stability
    from torsion.analyses.response.over_speed import Response
    from torsion.rules.check import Check

Progress = Callable[[str, float], None]  # (what, share done 0..1)
PERIODIC = "exact periodic response"
SMALL = "no joint is bent by more than 10 degrees, and the first order estimates its error below 1 %"


@dataclass(frozen=True)
class ExactMotion:
    """What the exact equations of motion say."""

    periodic: "PeriodicResponse | None"
    stability: "Stability | None"
    stability_map: "StabilityMap | None"
    checks: "tuple[Check, ...]"


def exact(study: Study, system: System, first_order: "Response | None", log: Log, progress: Progress) -> ExactMotion:
    """All of it that the study asks for or needs."""
    found = periodic(study, system.whole, first_order, log, progress)
    if found is not None and system.groups is not None:
        found = found.condensed(system.groups)
    stable, mapped = stability(study, system.whole, log, progress)
    if stable is None:
        return ExactMotion(found, None, None, ())
    from torsion.rules.stability import stability_check

    return ExactMotion(found, stable, mapped, (stability_check(stable, study.operation),))


def periodic(
    study: Study, system: System, first_order: "Response | None", log: Log, progress: Progress
) -> "PeriodicResponse | None":
    """The exact periodic response beside the first-order one, where the file or the size of the angles asks for it."""
    method = getattr(study.analyses.get("response"), "method", None)
    asked = method == "harmonic-balance"
    if not exciting_joints(system):
        if asked:
            log.without(PERIODIC, "no joint of the train excites: the response over speed is exact as it is")
        return None
    if first_order is None or method == "first-order":
        if asked or first_order is not None:
            log.without(PERIODIC, "`method: first-order`" if first_order is not None else "no response over speed")
        return None
    from torsion.analyses.motion.periodic import is_advised

    if not asked and not is_advised(system, first_order.joint_error):
        log.without(PERIODIC, SMALL)
        return None
    why = "asked" if asked else "a joint beyond 10 degrees, or a first-order estimate of error beyond 1 %"
    return _periodic(study, system, first_order, why, (log, progress), must=asked)


def _periodic(
    study: Study, system: System, first_order: "Response", why: str, tell: tuple[Log, Progress], *, must: bool
) -> "PeriodicResponse | None":
    """must: there is no answer without it."""
    from torsion.analyses.motion.faults import motion_faults
    from torsion.analyses.motion.periodic import Found
    from torsion.analyses.motion.speeds import periodic_over_speed, too_long

    log, progress = tell
    refused = "; ".join(fault.message for fault in motion_faults(study, ()))
    if not refused and not must:
        refused = too_long(study, system)
    if refused:
        log.without(PERIODIC, refused)
        return None
    try:
        with log.step(PERIODIC, why) as step:
            found = periodic_over_speed(study, system, first_order, progress=progress)
            step.method = "harmonic balance, Newton's method with Hill's matrix, continued over speed"
            harmonics = int(found.harmonics.max(initial=0))
            kept = f"up to {harmonics} harmonics of the common period" if harmonics else "no periodic motion found"
            step.size = f"{found.speed.size} speeds, {kept}"
    except SolveError as fault:
        if must:
            raise
        log.without(PERIODIC, str(fault))
        return None
    nothing = found.status == Found.NONE
    if nothing.any():
        reasons = "; ".join(dict.fromkeys(one for one in found.why if one))
        log.without(f"{PERIODIC} at {int(nothing.sum())} of {nothing.size} speeds", f"none was found: {reasons}")
    if (found.status == Found.COARSE).any():
        log.without(f"{PERIODIC}, in part", "at some speeds the harmonics left out exceed 1e-10 of the largest")
    if any(line.order is None for line in first_order.lines):
        log.without(f"{PERIODIC}, torques of fixed frequency", "they share no common period with the joints")
    return found


def exciting_joints(system: System) -> bool:
    """A joint of the train turns unevenly."""
    parts = system.train.parts
    return any(span.error and parts[span.part].component.keyword == "joint" for span in system.spans)


def stability(
    study: Study, system: System, log: Log, progress: Progress
) -> "tuple[Stability | None, StabilityMap | None]":
    """Stability over speed and its map, where they are asked for."""
    settings = study.analyses.get("stability")
    if settings is None:
        return None, None
    from torsion.analyses.motion.asked import Asked
    from torsion.analyses.motion.loading import scene
    from torsion.analyses.motion.periodic import harmonics_at_least
    from torsion.analyses.motion.reduced import stability_asked

    asked = settings if isinstance(settings, Asked) else Asked()
    speeds = asked.speeds or study.operation.speeds
    if not exciting_joints(system) or speeds is None:
        log.without("stability", "no joint excites, so that nothing varies with the angle" if speeds else "no speeds")
        return None, None
    harmonics_at_least(scene(study, system))  # refused before anything is computed
    with log.step("stability", "asked") as step:
        found = stability_asked(study, system, asked, speeds.values(), progress=progress)
        step.method = _METHODS[asked.method]
        added = int((~found.asked).sum())
        modes = found.modes.size
        kept = "all modes" if found.kept is None else f"{found.kept} of {modes} elastic modes"
        step.size = f"{int(found.asked.sum())} speeds asked, {added} more around zones and boundaries; {kept}"
    if found.unsolved.size:
        number = found.unsolved.size
        log.without(f"stability at {number} speed{'' if number == 1 else 's'}", "no periodic motion was found there")
    log.without("vibratory torques, in the stability", "joints and mean torque alone make the periodic motion there")
    return found, _map(study, system, asked, log, progress)


_METHODS = {
    "monodromy": "Floquet multipliers by the monodromy matrix, checked by Hill's matrix",
    "hill": "Floquet exponents by Hill's matrix, checked by the monodromy matrix",
}


def _map(study: Study, system: System, asked: "Asked", log: Log, progress: Progress) -> "StabilityMap | None":
    speeds = asked.speeds or study.operation.speeds
    if asked.map is None or speeds is None:
        return None
    from torsion.analyses.motion.map import stability_map

    with log.step("stability map", "asked") as step:
        found = stability_map(
            study, system, speeds.values(), asked.map.over, asked.map.values(), modes=asked.map.modes, progress=progress
        )
        step.method = f"multipliers on {found.modes} of {found.of_modes} elastic modes, all values of a speed together"
        points = f"{found.speed.size} x {found.value.size} points"
        step.size = f"{points}, {found.checked} of them checked on the whole train"
    missing = int(np.isnan(found.growth).sum())
    if missing:
        log.without(f"stability map at {missing} points", "no periodic motion was found there")
    return found
