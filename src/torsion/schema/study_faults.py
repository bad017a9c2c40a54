"""What the sections of a file need of each other."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator

from torsion.assembly.fixed_points import fixed_point_faults
from torsion.errors import Fault
from torsion.rules import lacking, needed
from torsion.study import Study

_SPEEDS = "`operation: {speeds: {from: 300 rpm, to: 1800 rpm}}`"
_RATED = "`operation: {rated: {speed: 1500 rpm, power: 100 kW}}`"


def study_faults(study: Study, faulty: Collection[str] = ()) -> list[Fault]:
    """Faults between sections: speeds, frequencies, mean torque and what the rules need.

    faulty: sections that have faults of their own; what reads one of them is not judged.
    """
    return [fault for check, reads in _CHECKS if not set(reads) & set(faulty) for fault in check(study)]


def _model_faults(study: Study) -> Iterator[Fault]:
    """The models of shafts with distributed inertia take no closed loops."""
    closed = any(part.path[0] == "links" for part in study.train.parts)
    if study.model != "lumped" and closed and any(bar.density > 0 for bar in study.train.bars):
        message = f"the model {study.model} takes no closed loops, and `links` closes one"
        yield Fault(("analyses", "model"), message, "model: lumped")


def _check_faults(study: Study) -> list[Fault]:
    """Trains of which there is no exact model to compare the others with."""
    if "check" not in study.analyses:
        return []
    from torsion.analyses.compare.candidates import loop_faults

    return loop_faults(study, ("analyses", "check"))


def _joint_faults(study: Study) -> list[Fault]:
    """Joints that the settings of `joints` name, and any joint at all."""
    requested = study.analyses.get("joints")
    if requested is None:
        return []
    from torsion.analyses.joints.joint_analysis import JointsSettings, settings_faults

    return settings_faults(study.train, requested) if isinstance(requested, JointsSettings) else []


def _motion_faults(study: Study) -> list[Fault]:
    """Trains of which there is no exact motion, where it is requested."""
    exact = getattr(study.analyses.get("response"), "method", None) == "harmonic-balance"
    if not exact and "stability" not in study.analyses:
        return []
    from torsion.analyses.motion.stability_settings import requested_motion_faults

    found = requested_motion_faults(study)
    lumps = any(0.0 < lump.inertia < math.inf for lump in study.train.inertias)
    if "stability" in study.analyses and not (lumps or any(bar.density > 0 for bar in study.train.bars)):
        message = "the train has no component with an inertia, and without one nothing can grow"
        found.append(Fault(("analyses", "stability"), message, "leave it out, or give an inertia"))
    return found


def _transient_faults(study: Study) -> list[Fault]:
    """Events that the train cannot have."""
    if "transient" not in study.analyses:
        return []
    from torsion.analyses.transient.transient_motion import transient_faults

    return transient_faults(study)


def _lateral_faults(study: Study) -> list[Fault]:
    """Supports beside their shafts, materials that cannot bend, and shafts that nothing holds."""
    if "lateral" not in study.analyses and not study.has_supports:
        return []
    from torsion.analyses.lateral.shaft_bending import LateralSettings, lateral_faults

    requested = study.analyses.get("lateral")
    return lateral_faults(study.train, requested if isinstance(requested, LateralSettings) else None)


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
    yield from _speed_faults(study, speeds=speeds or requested is not None or ruled, frequencies=frequencies)
    if speeds and not study.operation.has_mean_torque:
        yield from _mean_torque_faults(study)


def _order_faults(study: Study) -> list[Fault]:
    """Orders that the settings of `response` name and nothing excites."""
    if "response" not in study.analyses:
        return []
    from torsion.analyses.response.over_speed import order_faults

    return order_faults(study)


def _speed_faults(study: Study, *, speeds: bool, frequencies: bool) -> Iterator[Fault]:
    """A torque at every frequency needs frequencies; all others need speeds, which is said once."""
    for torque in study.train.torques:
        if torque.order is None and torque.frequency is None:
            if not frequencies:
                hint = "give it `order` or `frequency`, or `analyses: {response: {frequencies: {from: 1, to: 200}}}`"
                yield Fault(torque.path, "this torque acts at every frequency, and no frequencies are requested", hint)
        elif not speeds:
            yield Fault(torque.path, "this excitation needs the speeds at which the train runs", _SPEEDS)
            speeds = True


def _mean_torque_faults(study: Study) -> Iterator[Fault]:
    """The first value that needs the mean torque, where it is not known."""
    needs = [torque.path for torque in study.train.torques if torque.of_mean]
    parts, stations = study.train.parts, study.train.stations
    needs += [(*parts[stations[d.station].part].path, "damping") for d in study.train.dampers if d.torque_factor]
    if needs:
        yield Fault(needs[0], "this needs the mean torque, and the rated power is not given", _RATED)


def _power_faults(study: Study) -> list[Fault]:
    """A mean torque that finds no way through the train, or whose table does not cover the speeds."""
    if not study.operation.has_mean_torque:
        return []
    from torsion.analyses.steady import power_faults

    return power_faults(study)


_CHECKS: tuple[tuple[Callable[[Study], Iterable[Fault]], tuple[str, ...]], ...] = (  # with the sections that each reads
    (lambda study: fixed_point_faults(study.train), ("train", "links")),
    (_model_faults, ("train", "links", "analyses")),
    (_check_faults, ("train", "links", "analyses")),
    (_response_faults, ("train", "operation", "analyses", "rules")),
    (_order_faults, ("train", "excitations", "analyses")),
    (_power_faults, ("train", "operation")),
    (_joint_faults, ("train", "analyses")),
    (_motion_faults, ("train", "links", "operation", "analyses")),
    (_transient_faults, ("train", "operation", "analyses")),
    (_lateral_faults, ("train", "materials", "operation", "analyses")),
    (lacking, ("train", "links", "materials", "operation", "analyses", "rules", "excitations")),
)
