"""What the sections of a file need of each other."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator
from pkgutil import resolve_name
from typing import Any

from torsion.errors import Fault
from torsion.rules import lacking, needed
from torsion.study import Study
from torsion.train import fixed_point_faults

_SPEEDS = "`operation: {speeds: {from: 300 rpm, to: 1800 rpm}}`"
_RATED = "`operation: {rated: {speed: 1500 rpm, power: 100 kW}}`"


def study_faults(study: Study, faulty: Collection[str] = ()) -> list[Fault]:
    """Faults between sections: speeds, frequencies, mean torque and what the rules need.

    faulty: sections that have faults of their own; what reads one of them is not judged.
    """
    faults = list[Fault]()
    for reads, applies, check in _CHECKS:
        is_named = applies in ("", *study.analyses) if isinstance(applies, str) else applies(study)
        if is_named and not set(reads.split()) & set(faulty):
            faults += (resolve_name(check) if isinstance(check, str) else check)(study)
    return faults


def _damping_faults(study: Study) -> Iterator[Fault]:
    """Damping by mode beside that of components, or for what is not a sum of modes."""
    train = study.train
    if not train.modal_damping:
        return

    def refuse(message: str, hint: str = "give the components their damping") -> Fault:
        return Fault(("damping",), message, hint)

    damping = [spring.name for spring in train.springs if spring.damps]
    damping += [bar.name for bar in train.bars if bar.loss_factor > 0]
    damping += [train.parts[train.stations[damper.station].part].name for damper in train.dampers]
    for name in damping[:1]:
        message = (
            f"damping by mode replaces the damping of the components, and '{name}' has damping"
        )
        yield refuse(message, "leave one of them out")
    if study.model != "lumped" and train.has_shafts:
        message = f"damping by mode is not for the model {study.model}"
        yield Fault(("analyses", "model"), message, "model: lumped")
    for name in ("stability", "check"):
        if name in study.analyses:
            yield refuse(f"`{name}` does not support damping by mode")
    if train.has_nonlinear_couplings and len(train.modal_damping) > 1:
        message = "a clutch, backlash or friction changes the modes, so that a list of ratios by mode has no meaning"
        yield refuse(message, "one ratio for all, or give the components their damping")
    if any(rule == "coupling-maker" for rule, _ in study.rules):
        limited = [part.name for part in train.parts if part.ratings and part.ratings.limit_heat]
        for name in limited[:1]:
            message = (
                f"coupling-maker judges the heat of '{name}', which damping by mode does not say"
            )
            yield refuse(message, "give the components their damping, or leave `heat_limit` out")
    if any(torque.mesh for torque in train.torques):
        yield refuse("a mesh that excites does not support damping by mode")
    if study.has_joints:
        yield refuse("a train with joints does not support damping by mode")


def _response_faults(study: Study) -> Iterator[Fault]:
    """A response runs when it or a rule about it is requested or, where no analysis is named, when a torque excites."""
    ruled, train = "response" in needed(study), study.train
    requested = study.analyses.get("response")
    if not ruled and requested is None and (study.analyses or not train.torques):
        return
    speeds = study.operation.speeds is not None
    frequencies = getattr(requested, "frequencies", None) is not None
    if requested is not None and not speeds and not frequencies:
        hint = f"{_SPEEDS}, or `response: {{frequencies: {{from: 1, to: 200}}}}`"
        yield Fault(("analyses", "response"), "a response needs speeds or frequencies", hint)
    if any(torque.table for torque in train.torques):
        from torsion.analyses.steady import table_faults

        yield from table_faults(study)
    # A torque at every frequency needs frequencies; all others need speeds, which is said once.
    lacks_speeds = not (speeds or requested is not None or ruled)
    for torque in train.torques:
        if torque.order is None and torque.frequency is None:
            if not frequencies:
                hint = "give it `order` or `frequency`, or `analyses: {response: {frequencies: {from: 1, to: 200}}}`"
                message = "this torque acts at every frequency, and no frequencies are requested"
                yield Fault(torque.path, message, hint)
        elif lacks_speeds:
            message = "this excitation needs the speeds at which the train runs"
            yield Fault(torque.path, message, _SPEEDS)
            lacks_speeds = False
    if speeds and not study.has_mean_torque:
        needs = [torque.path for torque in train.torques if torque.of_mean]
        needs += [
            (*train.parts[train.stations[damper.station].part].path, "damping")
            for damper in train.dampers
            if damper.needs_torque
        ]
        for path in needs[:1]:
            message = "this needs the mean torque, and the rated power is not given"
            yield Fault(path, message, _RATED)


Check = Callable[[Study], Iterable[Fault]]
# Sections that a check reads; an analysis that the file names for it (empty: any), or what holds; and the check,
# by its name where it is imported only as it applies.
_CHECKS: tuple[tuple[str, str | Callable[[Study], Any], str | Check], ...] = (
    ("train links", "", lambda study: fixed_point_faults(study.train)),
    (  # the models of shafts with distributed inertia take no closed loops
        "train links analyses",
        lambda study: study.model != "lumped" and study.train.has_loops and study.train.has_shafts,
        lambda study: [
            Fault(
                ("analyses", "model"),
                f"the model {study.model} does not support closed loops, and `links` closes one",
                "model: lumped",
            )
        ],
    ),
    ("train links damping materials analyses rules", "", _damping_faults),
    (
        "train links analyses",
        "check",
        lambda study: resolve_name("torsion.analyses.compare.model_errors:loop_faults")(
            study, ("analyses", "check")
        ),
    ),
    ("train operation analyses rules", "", _response_faults),
    ("train excitations analyses", "response", "torsion.analyses.response.over_speed:order_faults"),
    (
        "train operation",
        lambda study: study.has_mean_torque,
        "torsion.analyses.steady:power_faults",
    ),
    (
        "train operation analyses",
        lambda study: any(part.machine and part.machine.drive for part in study.train.parts),
        "torsion.analyses.law_slopes:drive_faults",
    ),
    (
        "train analyses",
        "joints",
        lambda study: resolve_name("torsion.analyses.joints.joint_analysis:settings_faults")(
            study.train, study.analyses["joints"]
        ),
    ),
    (
        "train links operation analyses",
        lambda study: (
            "stability" in study.analyses
            or study.setting("analyses", "response", "method") == "harmonic-balance"
        ),
        "torsion.analyses.stability.requested_motion:requested_motion_faults",
    ),
    (
        "train links operation analyses damping",
        lambda study: any(spring.table is not None for spring in study.train.springs),
        "torsion.analyses.modes.coupling_tables:table_faults",
    ),
    (
        "train links operation analyses",
        lambda study: (
            "stability" in study.analyses
            and not study.train.has_shafts
            and not any(0.0 < lump.inertia < math.inf for lump in study.train.inertias)
        ),
        lambda study: [
            Fault(
                ("analyses", "stability"),
                "the train has no component with an inertia, and without one nothing can grow",
                "leave it out, or give an inertia",
            )
        ],
    ),
    (
        "train operation",
        lambda study: any(part.engine for part in study.train.parts),
        "torsion.analyses.engine.engine_analysis:engine_faults",
    ),
    (
        "train operation analyses",
        "transient",
        "torsion.analyses.motion.events.transient_settings:transient_faults",
    ),
    ("train operation analyses excitations", "fit", "torsion.what_if.fit.measurements:fit_faults"),
    (
        "train materials operation analyses",
        lambda study: "lateral" in study.analyses or study.has_supports,
        lambda study: resolve_name("torsion.analyses.lateral.shaft_bending:lateral_faults")(
            study.train, study.analyses.get("lateral")
        ),
    ),
    ("train links materials operation analyses rules excitations", "", lacking),
)
