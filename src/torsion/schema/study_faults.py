"""What the sections of a file need of each other."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator
from importlib import import_module
from typing import Any

from torsion.errors import Fault
from torsion.rules import lacking, needed
from torsion.study import Study
from torsion.train import fixed_point_faults

_SPEEDS = "`operation: {speeds: {from: 300 rpm, to: 1800 rpm}}`"
_RATED = "`operation: {rated: {speed: 1500 rpm, power: 100 kW}}`"
Check = Callable[[Study], Iterable[Fault]]


def study_faults(study: Study, faulty: Collection[str] = ()) -> list[Fault]:
    """Faults between sections: speeds, frequencies, mean torque and what the rules need.

    faulty: sections that have faults of their own; what reads one of them is not judged.
    """
    return [
        fault for check, reads in _CHECKS if not set(reads) & set(faulty) for fault in check(study)
    ]


def _model_faults(study: Study) -> Iterator[Fault]:
    """The models of shafts with distributed inertia take no closed loops."""
    if study.model != "lumped" and study.train.has_loops and study.train.has_shafts:
        message = f"the model {study.model} does not support closed loops, and `links` closes one"
        yield Fault(("analyses", "model"), message, "model: lumped")


def _damping_faults(study: Study) -> Iterator[Fault]:
    """Damping by mode beside that of components, or for what is not a sum of modes."""
    if not study.train.modal_damping:
        return
    if name := study.train.damping_of_components:
        message = (
            f"damping by mode replaces the damping of the components, and '{name}' has damping"
        )
        yield Fault(("damping",), message, "leave one of them out")
    if study.model != "lumped" and study.train.has_shafts:
        yield Fault(
            ("analyses", "model"),
            f"damping by mode is not for the model {study.model}",
            "model: lumped",
        )
    for name in ("stability", "check"):
        if name in study.analyses:
            yield Fault(
                ("damping",),
                f"`{name}` does not support damping by mode",
                "give the components their damping",
            )
    if study.train.has_nonlinear_couplings and len(study.train.modal_damping) > 1:
        message = "a clutch, backlash or friction changes the modes, so that a list of ratios by mode has no meaning"
        yield Fault(
            ("damping",), message, "one ratio for all, or give the components their damping"
        )
    limited = [
        part.name
        for part in study.train.parts
        if part.ratings is not None and part.ratings.limit_heat
    ]
    if limited and any(rule == "coupling-maker" for rule, _ in study.rules):
        message = (
            f"coupling-maker judges the heat of '{limited[0]}', which damping by mode does not say"
        )
        yield Fault(
            ("damping",), message, "give the components their damping, or leave `heat_limit` out"
        )
    if any(torque.mesh for torque in study.train.torques):
        yield Fault(
            ("damping",),
            "a mesh that excites does not support damping by mode",
            "give the components their damping",
        )
    if study.has_joints:
        yield Fault(
            ("damping",),
            "a train with joints does not support damping by mode",
            "give the components their damping",
        )


def _growth_faults(study: Study) -> Iterator[Fault]:
    """Stability of a train in which nothing has an inertia."""
    lumps = any(0.0 < lump.inertia < math.inf for lump in study.train.inertias)
    if "stability" in study.analyses and not (lumps or study.train.has_shafts):
        message = "the train has no component with an inertia, and without one nothing can grow"
        yield Fault(("analyses", "stability"), message, "leave it out, or give an inertia")


def _response_faults(study: Study) -> Iterator[Fault]:
    """A response runs when it or a rule about it is requested or, where no analysis is named, when a torque excites."""
    ruled = "response" in needed(study)
    requested = study.analyses.get("response")
    if not ruled and requested is None and (study.analyses or not study.train.torques):
        return
    speeds = study.operation.speeds is not None
    frequencies = getattr(requested, "frequencies", None) is not None
    if requested is not None and not speeds and not frequencies:
        hint = f"{_SPEEDS}, or `response: {{frequencies: {{from: 1, to: 200}}}}`"
        yield Fault(("analyses", "response"), "a response needs speeds or frequencies", hint)
    if any(torque.table for torque in study.train.torques):
        from torsion.analyses.steady import table_faults

        yield from table_faults(study)
    yield from _speed_faults(
        study, speeds=speeds or requested is not None or ruled, frequencies=frequencies
    )
    if speeds and not study.has_mean_torque:
        yield from _mean_torque_faults(study)


def _speed_faults(study: Study, *, speeds: bool, frequencies: bool) -> Iterator[Fault]:
    """A torque at every frequency needs frequencies; all others need speeds, which is said once."""
    for torque in study.train.torques:
        if torque.order is None and torque.frequency is None:
            if not frequencies:
                hint = "give it `order` or `frequency`, or `analyses: {response: {frequencies: {from: 1, to: 200}}}`"
                yield Fault(
                    torque.path,
                    "this torque acts at every frequency, and no frequencies are requested",
                    hint,
                )
        elif not speeds:
            yield Fault(
                torque.path, "this excitation needs the speeds at which the train runs", _SPEEDS
            )
            speeds = True


def _mean_torque_faults(study: Study) -> Iterator[Fault]:
    """The first value that needs the mean torque, where it is not known."""
    needs = [torque.path for torque in study.train.torques if torque.of_mean]
    parts, stations = study.train.parts, study.train.stations
    needs += [
        (*parts[stations[d.station].part].path, "damping")
        for d in study.train.dampers
        if d.needs_torque
    ]
    if needs:
        yield Fault(
            needs[0], "this needs the mean torque, and the rated power is not given", _RATED
        )


def _of_analysis(
    place: str,
    applies: Callable[[Study], bool],
    arguments: Callable[[Study], tuple[Any, ...]] = lambda study: (study,),
) -> Check:
    """What a function of an analysis (module:name) finds where it applies; it is imported then."""

    def check(study: Study) -> Iterable[Fault]:
        if not applies(study):
            return ()
        module, name = place.split(":")
        found: Iterable[Fault] = getattr(import_module(f"torsion.{module}"), name)(
            *arguments(study)
        )
        return found

    return check


_order_faults = _of_analysis(
    "analyses.response.over_speed:order_faults", lambda study: "response" in study.analyses
)
_power_faults = _of_analysis("analyses.steady:power_faults", lambda study: study.has_mean_torque)
_drive_faults = _of_analysis(
    "analyses.law_slopes:drive_faults",
    lambda study: any(part.machine and part.machine.drive for part in study.train.parts),
)
_check_faults = _of_analysis(
    "analyses.compare.shaft_divisions:loop_faults",
    lambda study: "check" in study.analyses,
    lambda study: (study, ("analyses", "check")),
)
_joint_faults = _of_analysis(
    "analyses.joints.joint_analysis:settings_faults",
    lambda study: "joints" in study.analyses,
    lambda study: (study.train, study.analyses["joints"]),
)
_motion_faults = _of_analysis(
    "analyses.stability.requested_motion:requested_motion_faults",
    lambda study: (
        "stability" in study.analyses
        or study.setting("analyses", "response", "method") == "harmonic-balance"
    ),
)
_engine_faults = _of_analysis(
    "analyses.engine.engine_analysis:engine_faults",
    lambda study: any(part.engine is not None for part in study.train.parts),
)
_transient_faults = _of_analysis(
    "analyses.motion.transient_settings:transient_faults",
    lambda study: "transient" in study.analyses,
)
_fit_faults = _of_analysis(
    "what_if.fit.fit_faults:fit_faults", lambda study: "fit" in study.analyses
)
_lateral_faults = _of_analysis(
    "analyses.lateral.shaft_bending:lateral_faults",
    lambda study: "lateral" in study.analyses or study.has_supports,
    lambda study: (study.train, study.analyses.get("lateral")),
)
_table_faults = _of_analysis(
    "analyses.modes.coupling_tables:table_faults", lambda study: study.train.has_tables
)
_CHECKS: tuple[tuple[Check, tuple[str, ...]], ...] = (  # with the sections that each reads
    (lambda study: fixed_point_faults(study.train), ("train", "links")),
    (_model_faults, ("train", "links", "analyses")),
    (_damping_faults, ("train", "links", "damping", "materials", "analyses", "rules")),
    (_check_faults, ("train", "links", "analyses")),
    (_response_faults, ("train", "operation", "analyses", "rules")),
    (_order_faults, ("train", "excitations", "analyses")),
    (_power_faults, ("train", "operation")),
    (_drive_faults, ("train", "operation", "analyses")),
    (_joint_faults, ("train", "analyses")),
    (_motion_faults, ("train", "links", "operation", "analyses")),
    (_table_faults, ("train", "links", "operation", "analyses", "damping")),
    (_growth_faults, ("train", "links", "operation", "analyses")),
    (_engine_faults, ("train", "operation")),
    (_transient_faults, ("train", "operation", "analyses")),
    (_fit_faults, ("train", "operation", "analyses", "excitations")),
    (_lateral_faults, ("train", "materials", "operation", "analyses")),
    (lacking, ("train", "links", "materials", "operation", "analyses", "rules", "excitations")),
)
