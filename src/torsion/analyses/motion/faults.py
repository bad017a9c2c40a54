"""What the exact equations of motion do not take: told as faults of the file where they are asked for."""

from torsion.analyses.motion.asked import Over
from torsion.errors import Fault, Path
from torsion.study import Study

SPEEDS = "`speeds: {from: 300 rpm, to: 1800 rpm}`, here or in `operation`"


def motion_faults(study: Study, path: Path) -> list[Fault]:
    """Why a train has no exact motion: its model of shafts, or its closed loops; at the place that asks for it."""
    if study.model != "lumped" and any(bar.density > 0 for bar in study.train.bars):
        message = f"the exact motion of joints is built for the model lumped, and this is {study.model}"
        return [Fault(path, message, "model: lumped")]
    if any(part.path and part.path[0] == "links" for part in study.train.parts):
        return [
            Fault(path, "the exact motion of joints takes no closed loops, and `links` closes one", "leave one out")
        ]
    return []


def asked_faults(study: Study) -> list[Fault]:
    """Faults of a file that asks for the exact response or for stability."""
    found: list[Fault] = []
    if getattr(study.analyses.get("response"), "method", None) == "harmonic-balance":
        found += motion_faults(study, ("analyses", "response", "method"))
    asked = study.analyses.get("stability")
    if asked is None:
        return found
    path: Path = ("analyses", "stability")
    if not study.has_joints:
        hint = "leave it out; what damps, the damped modes tell"
        found.append(Fault(path, "the train has no joint, and without one nothing grows", hint))
    if getattr(asked, "speeds", None) is None and study.operation.speeds is None:
        found.append(Fault(path, "stability needs speeds", SPEEDS))
    over = getattr(getattr(asked, "map", None), "over", None)
    if over is not None:
        found += _map_faults(study, over, (*path, "map", "over"))
    return [*found, *motion_faults(study, path)]


def _map_faults(study: Study, over: Over, path: Path) -> list[Fault]:
    """Why a map has nothing to vary: a factor on nothing, or the angle of joints that the train does not have."""
    train, load = study.train, study.operation.load
    if over == "torque":
        flat = not isinstance(load, str) and not any(torque for _, torque in load)
        if flat or not study.operation.has_mean_torque:
            hint = "give it, for example `operation: {rated: {speed: 1500 rpm, power: 100 kW}}`, or a table of `load`"
            return [Fault(path, "the map varies the mean torque, and the train has none", hint)]
    if over == "damping":
        lossy = any(one.viscous > 0 or one.loss_factor > 0 for one in train.springs)
        if not (lossy or train.dampers or any(bar.loss_factor > 0 for bar in train.bars)):
            hint = "give the train its damping, for example `viscous` of a coupling or `damping` of a disc"
            return [Fault(path, "the map varies the damping, and nothing in the train damps", hint)]
    if over == "angle":
        joints = [part.joint for part in train.parts if part.joint is not None]
        if not any(joint.kind == "cross" and joint.angle > 0 for joint in joints):
            hint = "bend one, for example `joint: {angle: 5 deg}`; tripods and cv joints keep their angle in a map"
            return [Fault(path, "the map varies the angle of cross joints, and none of the train is bent", hint)]
    return []
