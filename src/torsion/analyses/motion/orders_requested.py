"""Whose orders are tracked in a motion over time, and over whose angle: as the file says, or what its speed sweeps."""

import numpy as np

from torsion.analyses.motion.order_tracking import ABOVE, HIGHEST, Tracked
from torsion.analyses.motion.resonances_passed import mean_speed
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.analyses.response.harmonic_components import excitations
from torsion.analyses.steady import reference_station
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path
from torsion.study import Study

SWEPT = 0.05  # of the largest speed: by how much it changes where orders are tracked unrequested


def orders_requested(
    study: Study,
    system: System,
    settings: TransientSettings,
    place: Path,
    *,
    peak: FloatArray,
    turning: FloatArray,
    follows: bool,
) -> Tracked | None:
    """None where none are; peak: (spans,) N m; turning: (stations, times) rad/s; follows: torques follow the motion.

    Raises InputError for a reference between a joint and its elastic neighbour, whose angle is no coordinate.
    """
    given = settings.orders
    name = (given.reference if given else None) or study.operation.at or study.train.parts[0].name
    is_point = given is not None and given.reference is not None
    station = (
        study.train.part(name).stations[0]
        if is_point
        else reference_station(study.train, study.operation)
    )
    orders = np.array(given.track if given else (), dtype=float)
    if not orders.size:
        orders = _exciting(study, system, settings) / abs(float(system.speed_ratio[station]))
    sweeps = follows and orders.size > 0 and _sweeps(mean_speed(system, turning))
    if not peak.size or (given is None and not sweeps):
        return None
    if (
        given is not None
        and study.has_joints
        and not (system.lumped_inertia[station] or system.held[station])
    ):
        message = (
            f"the angle of '{name}', a point without inertia, is not a coordinate of the motion"
        )
        raise InputError(
            [Fault((*place, "orders", "reference"), message, "name a point with an inertia")]
        )
    named = (given.at if given else ()) or settings.plot
    names = [study.train.parts[number].name for number in system.span_part.tolist()]
    chosen = dict[str, int]()
    for part in map(study.train.part, named):
        own = [k for k, one in enumerate(names) if one == part.name]
        if own and not part.is_point:
            chosen[part.name] = max(own, key=peak.__getitem__)
    if not chosen:
        most = int((peak * system.span_ratio).argmax())
        chosen[names[most]] = most
    highest = (given.highest if given else None) or max(
        HIGHEST, float(np.ceil(orders.max(initial=0.0) + ABOVE))
    )
    return Tracked(name, station, orders, highest, tuple(chosen.items()))


def _exciting(study: Study, system: System, settings: TransientSettings) -> FloatArray:
    """(orders,) of the reference station of the train, ascending: of the file's torques, of joints and of events."""
    found = {one.line.order for one in excitations(system) if one.line.order is not None}
    for event in settings.events:
        if event.body.by_angle:
            part = study.train.part(event.at)
            own = getattr(event.body, "order", None) or (
                part.propeller.blades if part.propeller else None
            )
            found |= {own * abs(system.speed_ratio[part.stations[0]])} if own else set()
    return np.array(sorted(map(float, found)))


def _sweeps(speed: FloatArray) -> bool:
    return float(np.ptp(speed)) > SWEPT * float(np.abs(speed).max())
