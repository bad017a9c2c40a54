"""Settings of the motion over time, and what a file says wrongly in them."""

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from torsion.analyses.transient.events import Event
from torsion.analyses.transient.following_events import Length
from torsion.errors import Fault, Path
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.study import Study
from torsion.train import name_fault

PATH = ("analyses", "transient")
MOST_SAMPLES = 1_000_000
PER_PERIOD = 20  # samples of the shortest period, unless that makes too many
DEFAULT_MOST = 20_000  # samples where the file names no number


def _read_initial(value: Any) -> Any:
    if value in ("rest", "steady"):
        return value
    if isinstance(value, dict) and set(value) == {"speed"}:
        return {"speed": Quantity("rad/s", at_least=0).read(value["speed"])}
    if isinstance(value, dict) and set(value) == {"torque"} and isinstance(value["torque"], dict):
        return {"torque": {str(name): Quantity("N*m").read(torque) for name, torque in value["torque"].items()}}
    raise refuse("this is no initial state", "rest, steady, {speed: 1500 rpm} or {torque: {coupling-1: 100 N*m}}")


Initial = Annotated[Any, BeforeValidator(_read_initial, json_schema_input_type=str | dict[str, Any])]


class TransientSettings(Declared):
    """Settings of `transient`."""

    duration: Length = required("how long the motion is computed")
    initial: Initial = given(
        "rest, steady (mean and periodic torques of the operating speed), {speed: rpm}, or a static twist that is "
        "released, {torque: {span: N*m}} (default: steady where the operation has a speed, else rest)"
    )
    events: tuple[Event, ...] = given(
        "what happens, each at a point: [{at: motor-1, step: {torque: 100 N*m}}, ...]", ()
    )
    samples: Annotated[int, Field(ge=100, le=MOST_SAMPLES)] | None = given(
        "samples of the curves; peaks are found between them, and nothing else depends on them "
        f"(default: {PER_PERIOD} of the shortest period, at most {DEFAULT_MOST})"
    )
    tolerance: Annotated[float, Quantity("1", at_least=1e-12, at_most=1e-2)] = given(
        "of torques that follow the motion: largest term of a step that is left in their series, of the largest torque",
        1e-6,
    )


def transient_faults(study: Study) -> list[Fault]:
    """Events at what is no point, or after the end; nothing that moves the train."""
    settings = study.analyses.get("transient")
    if not isinstance(settings, TransientSettings):
        return []
    twisted = isinstance(settings.initial, dict) and "torque" in settings.initial
    found = []
    if not settings.events and not twisted:
        hint = "give `events`, or `initial: {torque: {coupling-1: 100 N*m}}`"
        found.append(Fault(PATH, "nothing moves the train: no event, and no twist that is released", hint))
    known = {part.name: (part.kind, part.is_point) for part in study.train.parts}
    for number, event in enumerate(settings.events):
        path = (*PATH, "events", number)
        if (fault := name_fault(event.at, (*path, "at"), known)) is not None:
            found.append(fault)
        if event.time >= settings.duration:
            hint = f"within {settings.duration:g} s, or a longer `duration`"
            found.append(Fault((*path, "time"), "the event begins after the end of the motion", hint))
        elif fault is None:
            found += _faults_of_fixed_points(study, event, (*path, event.kind))
    return found


def _faults_of_fixed_points(study: Study, event: Event, path: Path) -> list[Fault]:
    """A program of speed where nothing is fixed or more is, a torque at a fixed point, a start that cannot turn."""
    train = study.train
    held = {one.station for one in train.inertias if math.isinf(one.inertia)}
    here = train.part(event.at).stations[0]
    if event.speed is not None:
        if here in held and len(held) == 1:
            return []
        message = f"the speed of '{event.at}' is prescribed, and " + (
            "others are fixed" if here in held else "it turns freely"
        )
        return [Fault(path, message, "`held: true` there, and nowhere else")]
    if here in held:
        return [Fault(path, f"a torque at '{event.at}', which is fixed, does nothing", "name a point that can turn")]
    if event.start is not None and held:
        names = ", ".join(train.parts[train.stations[one].part].name for one in sorted(held))
        return [Fault(path, f"a start turns the train, and it is fixed at {names}", "leave `held` out")]
    return []
