"""Settings of the stability of a train with joints."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo

from torsion.errors import Fault, Path
from torsion.fields import Declared, Quantity, given, required
from torsion.study import Range, SpeedRange, Study

Method = Literal["hill", "monodromy"]
Over = Literal["angle", "damping", "torque"]
SPEEDS = "`speeds: {from: 300 rpm, to: 1800 rpm}`, here or in `operation`"


def _read_value(value: Any, info: ValidationInfo) -> float:
    """An angle below 90 degrees with its unit, or a factor; which, `over` says."""
    if info.data.get("over") == "angle":
        return Quantity("rad", at_least=0, below=np.pi / 2.0).read(value)
    return Quantity("1", at_least=0).read(value) if "over" in info.data else 0.0


Value = Annotated[float, BeforeValidator(_read_value, json_schema_input_type=float | str)]


class MapSettings(Range):
    """Settings of `map` in `stability`."""

    over: Over = required("angle (of all cross joints), damping or torque (factors on what the file says)")
    first: Value = required("lowest value: an angle with its unit, or a factor", alias="from")
    last: Value = required("highest value", alias="to")
    steps: Annotated[int, Field(ge=2, le=2000)] = given("number of values", 101)
    modes: Annotated[int, Field(ge=1, le=60)] | None = given("elastic modes kept (default: those that matter)")


class StabilitySettings(Declared):
    """Settings of `stability`."""

    speeds: SpeedRange | None = given("speeds (default: those of the operation)")
    method: Method = given("`monodromy` in steps of time, or `hill`: the eigenvalues of Hill's matrix", "monodromy")
    modes: Annotated[int, Field(ge=1, le=1000)] | None = given(
        "reduce to so many elastic modes (default: all of a train of at most 20 coordinates, else those that matter)"
    )
    map: MapSettings | None = given("growth over speed and one more quantity")


def motion_faults(study: Study, path: Path) -> list[Fault]:
    """Why a train has no exact motion: its model of shafts, or its closed loops; at the place that requests it."""
    if study.model != "lumped" and study.train.has_shafts:
        message = f"the exact motion of joints is built for the model lumped, and this is {study.model}"
        return [Fault(path, message, "model: lumped")]
    if study.train.has_loops:
        return [
            Fault(path, "the exact motion of joints takes no closed loops, and `links` closes one", "leave one out")
        ]
    return []


def requested_motion_faults(study: Study) -> list[Fault]:
    """Faults of a file that requests the exact response or stability."""
    found: list[Fault] = []
    if getattr(study.analyses.get("response"), "method", None) == "harmonic-balance":
        found += motion_faults(study, ("analyses", "response", "method"))
    requested = study.analyses.get("stability")
    if requested is None:
        return found
    path: Path = ("analyses", "stability")
    if not study.has_joints:
        hint = "leave it out; the damped modes show what damps"
        found.append(Fault(path, "the train has no joint, and without one nothing grows", hint))
    if getattr(requested, "speeds", None) is None and study.operation.speeds is None:
        found.append(Fault(path, "stability needs speeds", SPEEDS))
    over = getattr(getattr(requested, "map", None), "over", None)
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
