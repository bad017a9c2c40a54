"""The exact motion of a train with joints as a study requests it: its response, its stability, and the map of that."""

from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, ValidationInfo

from torsion.analyses.response.amplitudes import Response
from torsion.assembly.system import System
from torsion.errors import Fault, Path
from torsion.fields import Declared, Quantity, given, required
from torsion.findings import Work
from torsion.model.parts import JointRecord
from torsion.study import Range, SpeedRange, Study, mesh_faults

PERIODIC = "exact periodic response"
SMALL = (
    "no joint is bent by more than 10 degrees, and the first order estimates its error below 1 %"
)
LARGE_ANGLE = np.radians(
    10.0
)  # joints beyond it are treated exactly unless the file says otherwise
LARGE_ERROR = 0.01  # of the first-order model, by its own estimate
SPEEDS = "`speeds: {from: 300 rpm, to: 1800 rpm}`, here or in `operation`"
METHODS = {
    "monodromy": "Floquet multipliers by the monodromy matrix, checked by Hill's matrix",
    "hill": "Floquet exponents by Hill's matrix, checked by the monodromy matrix",
}
Method = Literal["hill", "monodromy"]
Over = Literal["angle", "damping", "torque"]


def _read_value(value: Any, info: ValidationInfo) -> float:
    """An angle below 90 degrees with its unit, or a factor; which, `over` says."""
    if info.data.get("over") == "angle":
        return Quantity("rad", at_least=0, below=np.pi / 2.0).read(value)
    return Quantity("1", at_least=0).read(value) if "over" in info.data else 0.0


Value = Annotated[float, BeforeValidator(_read_value, json_schema_input_type=float | str)]


class MapSettings(Range):
    """Settings of `map` in `stability`."""

    over: Over = required(
        "angle (of all cross joints), damping or torque (factors on the values of the file)"
    )
    first: Value = required("lowest value: an angle with its unit, or a factor", alias="from")
    last: Value = required("highest value", alias="to")
    steps: Annotated[int, Field(ge=2, le=2000)] = given("number of values", 101)
    modes: Annotated[int, Field(ge=1, le=60)] | None = given(
        "number of elastic modes (default: the modes that matter)"
    )


class StabilitySettings(Declared):
    """Settings of `stability`."""

    speeds: SpeedRange | None = given("speeds (default: from `operation`)")
    method: Method = given(
        "`monodromy` in steps of time, or `hill`: the eigenvalues of Hill's matrix", "monodromy"
    )
    modes: Annotated[int, Field(ge=1, le=1000)] | None = given(
        "reduce to so many elastic modes (default: all of a short train, else those up to three times the highest "
        "order of a joint)"
    )
    map: MapSettings | None = given("growth over speed and one more quantity")


def motion_faults(study: Study, path: Path) -> list[Fault]:
    """Return why a train has no exact motion: its model of shafts, or its closed loops; at the place that requests it."""
    if study.model != "lumped" and study.train.has_shafts:
        message = (
            f"the exact motion of joints is built for the model lumped, and this is {study.model}"
        )
        return [Fault(path, message, "model: lumped")]
    if study.train.has_loops:
        message = "the exact motion of joints does not support closed loops, and `links` closes one"
        return [Fault(path, message, "leave one out")]
    return []


def requested_motion_faults(study: Study) -> list[Fault]:
    """Return the faults of a file that requests the exact response or stability."""
    faults: list[Fault] = []
    method = ("analyses", "response", "method")
    if study.setting(*method) == "harmonic-balance":
        faults += motion_faults(study, method) + mesh_faults(study, "the exact motion")
    path = ("analyses", "stability")
    if study.setting(*path) is None:
        return faults
    if not study.has_joints:
        message = "the train has no joint, and `stability` computes only growth by joints"
        hint = "leave it out; what a falling law of load feeds is judged with the response"
        faults.append(Fault(path, message, hint))
    if study.setting(*path, "speeds") is None and study.operation.speeds is None:
        faults.append(Fault(path, "stability needs speeds", SPEEDS))

    # A map needs a factor on something, or a joint whose angle changes the train.
    over = study.setting(*path, "map", "over")
    train, table = study.train, study.operation.load.table
    joints = [part.joint for part in train.parts if part.joint is not None]
    springs = [spring for spring in train.springs if spring.viscous > 0 or spring.loss_factor > 0]
    varies = {
        None: True,
        "torque": study.has_mean_torque and (not table or any(torque for _, torque in table)),
        "damping": springs or train.dampers or any(bar.loss_factor > 0 for bar in train.bars),
        "angle": any(joint.kind == "cross" and joint.angle > 0 for joint in joints),
    }
    if not varies[over]:
        message, hint = NOTHING_VARIES[over]
        faults.append(Fault((*path, "map", "over"), f"the map varies {message}", hint))
    return [*faults, *motion_faults(study, path)]


NOTHING_VARIES = {
    "torque": (
        "the mean torque, and the train has none",
        "give it, for example `operation: {rated: {speed: 1500 rpm, power: 100 kW}}`, or a table of `load`",
    ),
    "damping": (
        "the damping, and nothing in the train damps",
        "give the train its damping, for example `viscous` of a coupling or `damping` of a disc",
    ),
    "angle": (
        "the angle of cross joints, and none of the train is bent",
        "bend one, for example `joint: {angle: 5 deg}`; tripods and cv joints keep their angle in a map",
    ),
}


def run_periodic(work: Work) -> None:
    """The exact periodic response next to the first-order one, where the file or the size of the angles calls for it."""
    log = work.log
    reason, omitted = _reasons(work)
    if omitted:
        log.without(PERIODIC, omitted)
    if omitted or not reason:
        return
    from torsion.analyses.stability.first_order_compared import compare_first_order
    from torsion.analyses.stability.periodic_orbits import Found
    from torsion.analyses.stability.periodic_speeds import periodic_over_speed

    first_order = work.need(Response)
    with log.step(PERIODIC, reason) as step:
        response = periodic_over_speed(work.study, work.system, first_order, progress=work.progress)
        step.method = "harmonic balance, Newton's method with Hill's matrix, continued over speed"
        harmonics = int(response.harmonics.max(initial=0))
        kept = f"up to {harmonics} harmonics of the common period"
        step.size = (
            f"{response.speed.size} speeds, {kept if harmonics else 'no periodic motion found'}"
        )
    nothing = response.status == Found.NONE
    if nothing.any():
        reasons = "; ".join(dict.fromkeys(filter(None, response.why)))
        log.without(
            f"{PERIODIC} at {int(nothing.sum())} of {nothing.size} speeds",
            f"none was found: {reasons}",
        )
    if (response.status == Found.COARSE).any():
        why = "at some speeds the omitted harmonics exceed 1e-10 of the largest"
        log.without(f"{PERIODIC}, in part", why)
    if any(line.order is None for line in first_order.lines):
        why = "they share no common period with the joints"
        log.without(f"{PERIODIC}, torques of fixed frequency", why)
    work.put(periodic=response)
    work.put(first_order_compared=compare_first_order(work))


def _reasons(work: Work) -> tuple[str, str]:
    """Why the exact periodic response is computed, and else why not; both empty where nobody would expect it."""
    system = work.system
    first_order = work.get(Response)
    method = work.study.setting("analyses", "response", "method")
    joints = exciting_joints(system)
    requested = method == "harmonic-balance"
    if system.tables:
        return "", (
            "a coupling follows a table, which has no transient response; the results are of the first order"
        )
    if not joints:
        no_joint = "no joint of the train excites: the response over speed is exact as it is"
        return "", no_joint if requested else ""
    if first_order is None:
        return "", "no response over speed" if requested else ""
    if method == "first-order":
        return "", "`method: first-order`"
    refused = "; ".join(fault.message for fault in motion_faults(work.study, ()))
    if requested:
        return "requested", refused
    is_large = any(joint.angle > LARGE_ANGLE * (1.0 + 1e-12) for joint in joints)
    if not is_large and np.nanmax(first_order.joint_error, initial=0.0) <= LARGE_ERROR:
        return "", SMALL
    if not refused:
        from torsion.analyses.stability.periodic_speeds import too_long

        refused = too_long(work.study, system)
    return "a joint beyond 10 degrees, or a first-order estimate of error beyond 1 %", refused


def exciting_joints(system: System) -> list[JointRecord]:
    """Return the joints of the train that turn unevenly."""
    joints = (system.train.parts[span.part].joint for span in system.spans if span.error)
    return [joint for joint in joints if joint is not None]


def run_stability(work: Work) -> None:
    """Stability over speed, where it is requested."""
    from torsion.analyses.stability.stability_over_speed import stability

    study = work.study
    system = work.system
    log = work.log
    settings = work.settings("stability", StabilitySettings)
    speeds = settings.speeds or study.operation.speeds
    if not exciting_joints(system) or speeds is None:
        log.without(
            "stability",
            "no joint excites, so that nothing varies with the angle" if speeds else "no speeds",
        )
        return
    with log.step("stability", "requested") as step:
        result = stability(
            study,
            system,
            speeds.values(),
            method=settings.method,
            modes=settings.modes,
            progress=work.progress,
        )
        step.method = METHODS[settings.method]
        requested = int(result.requested.sum())
        more = f"{result.speed.size - requested} more around zones and boundaries"
        kept = f"{result.kept} of {result.modes.size} elastic" if result.kept is not None else "all"
        step.size = f"{requested} speeds requested, {more}; {kept} modes"
    if number := result.unsolved.size:
        log.without(
            f"stability at {number} speed{'' if number == 1 else 's'}",
            "no periodic motion was found there",
        )
    log.without(
        "vibratory torques, in the stability",
        "only joints and mean torque excite the periodic motion there",
    )
    work.put(stability=result)


def run_map(work: Work) -> None:
    """Growth over speed and one more quantity, where it is requested."""
    stability = work.settings("stability", StabilitySettings)
    settings = stability.map
    speeds = stability.speeds or work.study.operation.speeds
    if settings is None or speeds is None or not exciting_joints(work.system):
        return
    from torsion.analyses.stability.stability_over_speed import stability_map

    with work.log.step("stability map", "requested") as step:
        result = stability_map(
            work.study,
            work.system,
            speeds.values(),
            settings.over,
            settings.values(),
            modes=settings.modes,
            progress=work.progress,
        )
        step.method = f"multipliers on {result.modes} of {result.of_modes} elastic modes"
        step.size = f"{result.speed.size} x {result.value.size} points, {result.checked} of them checked on the whole train"
    if missing := int(np.isnan(result.growth).sum()):
        work.log.without(f"stability map at {missing} points", "no periodic motion was found there")
    work.put(stability_map=result)
