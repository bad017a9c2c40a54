"""The exact periodic response of a train with joints, its stability, and the map of it, as a study requests them."""

import numpy as np

from torsion.analyses.motion.stability_settings import StabilitySettings
from torsion.analyses.response.amplitudes import Response
from torsion.assembly.system import System
from torsion.findings import Work

PERIODIC = "exact periodic response"
SMALL = "no joint is bent by more than 10 degrees, and the first order estimates its error below 1 %"


def run_periodic(work: Work) -> None:
    """The exact periodic response beside the first-order one, where the file or the size of the angles calls for it."""
    system, log, first_order = work.system, work.log, work.get(Response)
    method = getattr(work.study.analyses.get("response"), "method", None)
    requested = method == "harmonic-balance"
    if not exciting_joints(system):
        if requested:
            log.without(PERIODIC, "no joint of the train excites: the response over speed is exact as it is")
        return
    if first_order is None or method == "first-order":
        if requested or first_order is not None:
            log.without(PERIODIC, "`method: first-order`" if first_order is not None else "no response over speed")
        return
    from torsion.analyses.motion.periodic_orbits import is_advised

    if not requested and not is_advised(system, first_order.joint_error):
        log.without(PERIODIC, SMALL)
        return
    why = "requested" if requested else "a joint beyond 10 degrees, or a first-order estimate of error beyond 1 %"
    _periodic(work, first_order, why, patient=requested)


def _periodic(work: Work, first_order: Response, why: str, *, patient: bool) -> None:
    """patient: it may take long."""
    from torsion.analyses.motion.periodic_orbits import Found
    from torsion.analyses.motion.periodic_speeds import periodic_over_speed, too_long
    from torsion.analyses.motion.stability_settings import motion_faults

    study, system, log = work.study, work.system.whole, work.log
    refused = "; ".join(fault.message for fault in motion_faults(study, ()))
    if not refused and not patient:
        refused = too_long(study, system)
    if refused:
        log.without(PERIODIC, refused)
        return
    with log.step(PERIODIC, why) as step:
        found = periodic_over_speed(study, system, first_order, progress=work.progress)
        step.method = "harmonic balance, Newton's method with Hill's matrix, continued over speed"
        harmonics = int(found.harmonics.max(initial=0))
        kept = f"up to {harmonics} harmonics of the common period" if harmonics else "no periodic motion found"
        step.size = f"{found.speed.size} speeds, {kept}"
    nothing = found.status == Found.NONE
    if nothing.any():
        reasons = "; ".join(dict.fromkeys(one for one in found.why if one))
        log.without(f"{PERIODIC} at {int(nothing.sum())} of {nothing.size} speeds", f"none was found: {reasons}")
    if (found.status == Found.COARSE).any():
        log.without(f"{PERIODIC}, in part", "at some speeds the harmonics left out exceed 1e-10 of the largest")
    if any(line.order is None for line in first_order.lines):
        log.without(f"{PERIODIC}, torques of fixed frequency", "they share no common period with the joints")
    groups = work.system.groups
    work.put(periodic=found if groups is None else found.condensed(groups))


def exciting_joints(system: System) -> bool:
    """A joint of the train turns unevenly."""
    parts = system.train.parts
    return any(span.error and parts[span.part].joint is not None for span in system.spans)


def run_stability(work: Work) -> None:
    """Stability over speed and its map, where they are requested."""
    from torsion.analyses.motion.mechanism_loads import scene
    from torsion.analyses.motion.periodic_orbits import harmonics_at_least
    from torsion.analyses.motion.stability_over_speed import stability

    study, system, log = work.study, work.system.whole, work.log
    settings = work.settings("stability", StabilitySettings)
    speeds = settings.speeds or study.operation.speeds
    if not exciting_joints(system) or speeds is None:
        log.without("stability", "no joint excites, so that nothing varies with the angle" if speeds else "no speeds")
        return
    harmonics_at_least(scene(study, system, vibratory=False))  # refused before anything is computed
    with log.step("stability", "requested") as step:
        found = stability(
            study, system, speeds.values(), method=settings.method, modes=settings.modes, progress=work.progress
        )
        step.method = _METHODS[settings.method]
        added = int((~found.requested).sum())
        modes = found.modes.size
        kept = "all modes" if found.kept is None else f"{found.kept} of {modes} elastic modes"
        step.size = f"{int(found.requested.sum())} speeds requested, {added} more around zones and boundaries; {kept}"
    if found.unsolved.size:
        number = found.unsolved.size
        log.without(f"stability at {number} speed{'' if number == 1 else 's'}", "no periodic motion was found there")
    log.without("vibratory torques, in the stability", "joints and mean torque alone make the periodic motion there")
    work.put(stability=found)


_METHODS = {
    "monodromy": "Floquet multipliers by the monodromy matrix, checked by Hill's matrix",
    "hill": "Floquet exponents by Hill's matrix, checked by the monodromy matrix",
}


def run_map(work: Work) -> None:
    """Growth over speed and one more quantity, where it is requested."""
    stability = work.settings("stability", StabilitySettings)
    settings, speeds = stability.map, stability.speeds or work.study.operation.speeds
    if settings is None or speeds is None or not exciting_joints(work.system):
        return
    from torsion.analyses.motion.mechanism_loads import scene
    from torsion.analyses.motion.periodic_orbits import harmonics_at_least
    from torsion.analyses.motion.stability_map import stability_map

    harmonics_at_least(scene(work.study, work.system.whole, vibratory=False))
    with work.log.step("stability map", "requested") as step:
        found = stability_map(
            work.study, work.system.whole, speeds.values(), settings.over, settings.values(), modes=settings.modes,
            progress=work.progress,
        )  # fmt: skip
        step.method = f"multipliers on {found.modes} of {found.of_modes} elastic modes, all values of a speed together"
        points = f"{found.speed.size} x {found.value.size} points"
        step.size = f"{points}, {found.checked} of them checked on the whole train"
    missing = int(np.isnan(found.growth).sum())
    if missing:
        work.log.without(f"stability map at {missing} points", "no periodic motion was found there")
    work.put(stability_map=found)
