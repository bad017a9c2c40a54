"""Settings of the motion over time, and what a file says wrongly in them."""

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.analyses.motion.event_kind import Length, Point
from torsion.analyses.motion.events import Event, Stop
from torsion.analyses.motion.following_events import SpeedProgram, Start
from torsion.analyses.motion.order_tracking import OrderSettings
from torsion.analyses.motion.short_circuit import ELECTRICAL, ShortCircuit
from torsion.errors import Fault, Path
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.study import Several, Study, mesh_faults
from torsion.train import name_fault

PATH = ("analyses", "transient")
MOST_SAMPLES = 1_000_000
DEFAULT_PER_PERIOD = 20  # samples of the shortest period, unless that makes too many
ROUNDING = 1e-9  # of shares that are summed, and of times that are one
DEFAULT_MOST = 20_000  # samples where the file names no number


def _read_initial(value: Any) -> Any:
    if value in ("rest", "steady"):
        return value
    if isinstance(value, dict) and set(value) == {"speed"}:
        speed, each = Quantity("rad/s", at_least=0), value["speed"]
        if isinstance(each, dict):
            return {"speed": {str(name): speed.read(one) for name, one in each.items()}}
        return {"speed": speed.read(each)}
    if isinstance(value, dict) and set(value) == {"torque"} and isinstance(value["torque"], dict):
        return {
            "torque": {
                str(name): Quantity("N*m").read(torque) for name, torque in value["torque"].items()
            }
        }
    raise refuse(
        "this is no initial state",
        "rest, steady, {speed: 1500 rpm} or {torque: {coupling-1: 100 N*m}}",
    )


def _read_torques(value: Any) -> Any:
    """The names of components whose periodic torques act; none of them for `none`."""
    if value == "none" or value is None:
        return () if value else None
    if not isinstance(value, list | tuple) or not all(isinstance(name, str) for name in value):
        raise refuse(
            "`torques` is `none` or a list of names", "torques: none, or torques: [engine]"
        )
    if not value:
        raise refuse(
            "`torques` names nothing",
            "`torques: none`, or leave it out: then all periodic torques act",
        )
    return tuple(dict.fromkeys(value))


Initial = Annotated[
    Any, BeforeValidator(_read_initial, json_schema_input_type=str | dict[str, Any])
]


def _read_method(value: Any) -> Any:
    """Only the exact method: those of the textbooks are compared in benchmarks/integrators.py."""
    if value == "exact":
        return value
    message = f"the transient response has no method '{value}': it is exact for every train"
    raise refuse(message, "leave it out; reports/integrators.md compares other methods")


def _read_band(value: Any) -> Any:
    if value == "all":
        return value
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise refuse("`modes` is `all` or the number of lowest modes", "all, or for example 50")
    return value


class Fatigue(Declared):
    """Cycles counted by rainflow, their damage summed after Miner: each is (amplitude/`amplitude`)**slope / cycles."""

    amplitude: fields.Torque = required("torque amplitude (zero to peak) borne for `cycles` cycles")
    cycles: fields.Number = required("number of cycles at that amplitude")
    slope: fields.Number = required("exponent m of the line amplitude**m * cycles = constant")
    at: Annotated[tuple[str, ...], OneOrMany] = given(
        "names of the couplings, shafts or gears (default: all)", ()
    )
    mean: Literal["none", "goodman"] = given(
        "how a mean torque counts: not, or by a greater amplitude", "none"
    )
    ultimate: fields.Torque | None = given("torque at which it breaks, for `goodman`")

    def refuse_clashes(self) -> None:
        if (self.mean == "goodman") != (self.ultimate is not None):
            raise refuse(
                "`mean: goodman` and `ultimate` belong together", "give both, or none", "mean"
            )
        if self.amplitude == 0.0 or self.ultimate == 0.0:
            raise refuse(
                "a torque of 0 bears no cycle",
                "give the torque of the maker or of a test",
                "amplitude",
            )


class TransientSettings(Declared):
    """Settings of `transient`: of one motion, or of each in a list of them."""

    name: str = given("name of the transient response, if there are several", "")
    duration: Length = required("how long the motion is computed")
    initial: Initial = given(
        "rest; steady (mean and periodic torques of the operating speed); {speed: rpm}; {speed: {point: rpm}} for "
        "parts at different speeds (others: at rest); or {torque: {span: N*m}}, a static twist that is released. "
        "Default: steady if the operation has a speed, else rest"
    )
    events: tuple[Event, ...] = given(
        "what happens, each at a point: [{at: motor-1, step: {torque: 100 N*m}}, ...]", ()
    )
    torques: Annotated[
        tuple[str, ...] | None,
        BeforeValidator(_read_torques, json_schema_input_type=Literal["none"] | tuple[str, ...]),
    ] = given(
        "[names] of the components whose periodic torques act, by the angle of their shaft: ripple, excitations, "
        "orders of engines, propellers and compressors. none: no periodic torque (default: all of the file)"
    )
    samples: Annotated[int, Field(ge=100, le=MOST_SAMPLES)] | None = given(
        "samples of the curves; the program finds peaks between them, and other results do not depend on them "
        f"(default: {DEFAULT_PER_PERIOD} of the shortest period, at most {DEFAULT_MOST})"
    )
    tolerance: Annotated[float, Quantity("1", at_least=1e-12, at_most=1e-2)] = given(
        "for torques that follow the motion: largest remaining term of their series over a step, relative to the "
        "largest torque; a tenth of it with nonlinear couplings",
        1e-6,
    )
    method: Annotated[
        Literal["exact"], BeforeValidator(_read_method, json_schema_input_type=Literal["exact"])
    ] = given("exact, the only method", "exact")
    modes: Annotated[
        Any, BeforeValidator(_read_band, json_schema_input_type=int | Literal["all"])
    ] = given(
        "all, or the number of lowest elastic modes; then the change with twice as many is reported",
        "all",
    )
    plot: Annotated[tuple[str, ...], OneOrMany] = given(
        "names of elements whose torque, and points whose speed is drawn (default: the largest torques, both ends)",
        (),
    )
    export: Literal["npz", "csv"] | None = given(
        "also write all samples: motion.npz, or motion.csv of each motion"
    )
    orders: OrderSettings | None = given(
        "{at, reference, track, highest}: torques by orders of a shaft, if the speed changes by 8 revolutions or "
        "more. Default: if orders excite the train and its speed changes freely or by a program; none with "
        "backlash, friction, stages or clutches"
    )
    duty: Literal["normal", "rare"] | None = given(
        "normal, or rare: a short circuit, an emergency, a misoperation, for which couplings have `max_torque_rare` "
        "(default: rare where every event is a short circuit)"
    )
    fatigue: Fatigue | None = given(
        "{amplitude, cycles, slope, at, mean, ultimate}: rainflow count and Miner's sum"
    )

    @property
    def is_rare(self) -> bool:
        """No motion of normal operation; where the file does not say it, in doubt it is one."""
        faults = [isinstance(event.body, ShortCircuit) for event in self.events]
        return self.duty == "rare" or (self.duty is None and bool(faults) and all(faults))


def cases(study: Study) -> list[tuple[TransientSettings, Path]]:
    """Every motion that the file names, and where it stands there."""
    named = study.analyses.get("transient")
    each = named.each if isinstance(named, Several) else () if named is None else (named,)
    is_list = isinstance(named, Several)
    return [
        (one, (*PATH, place) if is_list else PATH)
        for place, one in enumerate(each)
        if isinstance(one, TransientSettings)
    ]


def transient_faults(study: Study) -> list[Fault]:
    """Motions without a name, events at what is no point or after the end, files, and nothing that moves the train."""
    found, seen, every = list[Fault](), set[str](), cases(study)
    meshes = {torque.mesh[0] for torque in study.train.torques if torque.mesh}
    if any(
        settings.torques is None or meshes.intersection(settings.torques) for settings, _ in every
    ):
        found += mesh_faults(study, "motion over time")
    if not every:
        found.append(
            Fault(
                PATH,
                "the list of motions is empty",
                "`- {name: start, duration: 2 s, events: [...]}`",
            )
        )
    if every and study.model == "exact" and study.train.has_shafts:
        message = (
            "the transient response supports lumped or finite-element shafts, not the model exact"
        )
        found.append(Fault(("analyses", "model"), message, "model: lumped"))
    for settings, path in every:
        if len(every) > 1 and (not settings.name or settings.name in seen):
            what = (
                f"two motions are called '{settings.name}'"
                if settings.name
                else "a motion in a list needs a name"
            )
            found.append(
                Fault(
                    (*path, "name") if settings.name else path, what, "`name: start`, each another"
                )
            )
        seen.add(settings.name)
        found += _faults(study, settings, path)
    return found


def _faults(study: Study, settings: TransientSettings, path: Path) -> Iterator[Fault]:
    """Of one motion."""
    each = settings.initial.get("speed") if isinstance(settings.initial, dict) else None
    apart = each if isinstance(each, dict) else {}
    twists = settings.initial.get("torque", {}) if isinstance(settings.initial, dict) else {}
    if not (settings.events or apart or any(twists.values()) or _is_shaken(study, settings)):
        hint = "give `events`, `initial: {torque: {coupling-1: 100 N*m}}`, or `excitations`"
        message = "nothing moves the train: no event, no periodic torque, no twist that is released"
        yield Fault(path, message, hint)
    known = {part.name: (part.kind, part.is_point) for part in study.train.parts}
    named = [name_fault(name, (*path, "initial", "speed", name), known) for name in apart]
    yield from (fault for fault in named if fault is not None)
    if apart and not study.train.has_nonlinear_couplings:
        message = "speeds of several points need a clutch or a clearance between them"
        yield Fault((*path, "initial"), message, "initial: {speed: 1500 rpm}")
    for name in settings.torques or ():
        if name not in study.train.periodic_torques:
            hint = ", ".join(study.train.periodic_torques) or "leave `torques` out"
            yield Fault((*path, "torques"), f"no periodic torque acts at '{name}'", hint)
    here = Point(folder=FilePath(study.file).parent)
    for number, event in enumerate(settings.events):
        place = (*path, "events", number)
        is_clutch = getattr(event, "clutch", None) is not None
        if (fault := name_fault(event.at, (*place, "at"), known, point=not is_clutch)) is not None:
            yield fault
        elif is_clutch and not study.train.part(event.at).is_clutch:
            yield Fault(
                (*place, "at"), f"'{event.at}' is no clutch", "name a coupling with `capacity`"
            )
        elif isinstance(event.body, ShortCircuit) and known[event.at][0] not in ELECTRICAL:
            hint = f"make '{event.at}' a `generator`; its load then leaves there"
            yield Fault((*place, "at"), "a short circuit acts in an electrical machine", hint)
        if event.time >= settings.duration:
            hint = f"within {settings.duration:g} s, or a longer `duration`"
            yield Fault((*place, "time"), "the event begins after the end of the motion", hint)
        table = getattr(event, "table", None)
        if table is not None and table.file is not None:
            lack = table.lacks(here)
            if lack is not None:
                yield Fault((*place, "table", "file"), *lack)
                continue
        corners = [event.time + late for late in event.body.corners(here)]
        if any(a >= b for a, b in pairwise(corners)):
            message = f"times of the event fall together: near {event.time:g} s numbers do not resolve them"
            yield Fault(
                (*place, event.body.key),
                message,
                f"at least {4.0 * math.ulp(event.time):.1g} s between them",
            )
    yield from _reclosed_late(settings, path)
    yield from _stopped_twice(settings, path)
    yield from _given_twice(settings, path)
    yield from _names(settings, path, known)
    yield from _order_faults(study, settings, path, known)


def _is_shaken(study: Study, settings: TransientSettings) -> bool:
    """Without events: periodic torques act, or joints turn unevenly at a speed."""
    if study.train.periodic_torques if settings.torques is None else settings.torques:
        return True
    if settings.initial in (None, "steady"):
        return bool(study.operation.speed) and study.has_joints
    return (
        study.has_joints
        and isinstance(settings.initial, dict)
        and bool(settings.initial.get("speed"))
    )


def _names(
    settings: TransientSettings, path: Path, known: Mapping[str, tuple[str, bool]]
) -> Iterator[Fault]:
    """Of `plot`, `fatigue` and `orders`; known: of every component its kind, and whether it is a point."""
    named = [("plot", settings.plot)]
    named += [
        (key, one.at)
        for key in ("fatigue", "orders")
        if (one := getattr(settings, key)) is not None
    ]
    for key, names in named:
        for word in names:
            where = (*path, key) if key == "plot" else (*path, key, "at")
            if key != "plot" and word in known and known[word][1]:
                links = ", ".join(name for name, (_, is_point) in known.items() if not is_point)
                yield Fault(
                    where, f"'{word}' is a {known[word][0]}, and no torque goes through it", links
                )
            elif word not in known:
                yield Fault(where, f"no component is called '{word}'", ", ".join(known))


def _reclosed_late(settings: TransientSettings, path: Path) -> Iterator[Fault]:
    """Faults of machines that would begin anew after the end."""
    for number, event in enumerate(settings.events):
        again = event.body.reclose if isinstance(event.body, ShortCircuit) else None
        if again is not None and event.time < settings.duration <= event.time + again[1]:
            message = (
                f"the short circuit begins again at {event.time + again[1]:g} s, after the end of the "
                "transient response"
            )
            hint = f"a `reclose` below {settings.duration - event.time:g} s, or a longer `duration`"
            yield Fault((*path, "events", number, "short-circuit", "reclose"), message, hint)


def _stopped_twice(settings: TransientSettings, path: Path) -> Iterator[Fault]:
    """Stops at a point that together take more than its mean torque; judged where a share of one is at its end."""
    stops = [
        (number, event, event.body)
        for number, event in enumerate(settings.events)
        if isinstance(event.body, Stop)
    ]
    near = ROUNDING * settings.duration
    for number, event, body in stops:
        there = [(one.time, other) for _, one, other in stops if one.at == event.at]
        full = event.time + body.ramp
        ends = [full + near, *([] if math.isinf(body.lasts) else [full + body.lasts - near])]
        share = max(sum(other.taken(at - time) for time, other in there) for at in ends)
        if share > 1.0 + ROUNDING:
            message = (
                f"the stops at '{event.at}' together end {100.0 * share:.4g} % of its mean torque"
            )
            yield Fault(
                (*path, "events", number, "stop"), message, "a `share` each, of 100 % together"
            )
            return


def _order_faults(
    study: Study, settings: TransientSettings, path: Path, known: Mapping[str, tuple[str, bool]]
) -> Iterator[Fault]:
    """Of the reference of `orders`, and of orders above the highest."""
    given_orders = settings.orders
    if given_orders is None:
        return
    if given_orders.reference is not None:
        fault = name_fault(given_orders.reference, (*path, "orders", "reference"), known)
        if fault is not None:
            yield fault
    highest = given_orders.highest
    if highest is not None and max(given_orders.track, default=0.0) > highest:
        message = (
            f"order {max(given_orders.track):g} is tracked, and the waterfall ends at {highest:g}"
        )
        yield Fault(
            (*path, "orders", "highest"),
            message,
            f"{max(given_orders.track):g} or more, or leave it out",
        )
    if study.train.has_nonlinear_couplings:
        message = "orders of a transient response with backlash, friction, stages or a capacity are not supported yet"
        yield Fault((*path, "orders"), message, "leave it out, or make the couplings linear")


def _given_twice(settings: TransientSettings, path: Path) -> Iterator[Fault]:
    """A second program of speed at a point, and a start there while an earlier one is on; two at one time add."""
    for number, event in enumerate(settings.events):
        body, place = event.body, (*path, "events", number, event.body.key)
        earlier = [
            one
            for one in settings.events[:number]
            if one.at == event.at and type(one.body) is type(body)
        ]
        if isinstance(body, SpeedProgram) and earlier:
            yield Fault(
                place,
                f"the speed of '{event.at}' is prescribed twice",
                "one `program` with all its rows",
            )
        others = [(one.time, one.body) for one in settings.events if one.at == event.at]
        on = [
            begin
            for begin, other in others
            if isinstance(other, Start) and begin < event.time < begin + (other.off or math.inf)
        ]
        if isinstance(body, Start) and on:
            message = f"'{event.at}' is switched on at {on[0]:g} s already"
            yield Fault(
                place, message, f"end that start by its `off`, at most {event.time - on[0]:g} s"
            )
