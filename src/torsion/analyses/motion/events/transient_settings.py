"""Settings of the motion over time, and what a file says wrongly in them."""

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.analyses.motion.events.event_kind import Length, Point
from torsion.analyses.motion.events.events import Clutch, Event, Stop, Table
from torsion.analyses.motion.events.machine_events import (
    ELECTRICAL,
    ShortCircuit,
    SpeedProgram,
    Start,
)
from torsion.errors import Fault, Path
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.study import Several, Study, mesh_faults
from torsion.train import name_fault

PATH = ("analyses", "transient")
MOST_SAMPLES = 1_000_000
DEFAULT_PER_PERIOD = 20  # samples of the shortest period, unless that makes too many
ROUNDING = 1e-9  # of shares that are summed, and of times that are one
DEFAULT_MOST = 20_000  # samples where the file names no number
HIGHEST = 12.0  # order of a waterfall, where no higher one is tracked
ABOVE = 2.0  # orders beyond the highest that is tracked
Order = Annotated[float, Quantity("1", above=0, at_most=200)]


def _read_initial(value: Any) -> Any:
    if value in ("rest", "steady"):
        return value
    quantities = {"speed": Quantity("rad/s", at_least=0), "torque": Quantity("N*m")}
    if isinstance(value, dict) and len(value) == 1 and quantities.keys() >= value.keys():
        ((key, content),) = value.items()
        quantity = quantities[key]
        if isinstance(content, dict):
            return {key: {str(name): quantity.read(text) for name, text in content.items()}}
        if key == "speed":
            return {key: quantity.read(content)}
    hint = "rest, steady, {speed: 1500 rpm} or {torque: {coupling-1: 100 N*m}}"
    raise refuse("this is no initial state", hint)


def _read_torques(value: Any) -> Any:
    """The names of components whose periodic torques act; none of them for `none`."""
    if value == "none" or value is None:
        return () if value else None
    if not isinstance(value, list | tuple) or not all(isinstance(name, str) for name in value):
        hint = "torques: none, or torques: [engine]"
        raise refuse("`torques` is `none` or a list of names", hint)
    if not value:
        hint = "`torques: none`, or leave it out: then all periodic torques act"
        raise refuse("`torques` names nothing", hint)
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
    if value == "all" or (isinstance(value, int) and not isinstance(value, bool) and value >= 1):
        return value
    raise refuse("`modes` is `all` or the number of lowest modes", "all, or for example 50")


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
            message = "`mean: goodman` and `ultimate` belong together"
            raise refuse(message, "give both, or none", "mean")
        if self.amplitude == 0.0 or self.ultimate == 0.0:
            hint = "give the torque of the maker or of a test"
            raise refuse("a torque of 0 bears no cycle", hint, "amplitude")


class OrderSettings(Declared):
    """Settings of `orders`."""

    at: Annotated[tuple[str, ...], OneOrMany] = given(
        "couplings, shafts or gears whose torque is tracked (default: the components of `plot`, else the largest "
        "torque)",
        (),
    )
    reference: str | None = given(
        "point whose angle is the reference (default: the point of `operation.at`, else the first)"
    )
    track: Annotated[tuple[Order, ...], OneOrMany] = given(
        "orders of the reference that are tracked (default: those that excite the train)", ()
    )
    highest: Order | None = given(
        f"highest order of the waterfall (default: {HIGHEST:g}, or {ABOVE:g} above the highest that is tracked)"
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
    def changes_speed(self) -> bool:
        """An event changes the speed by itself: dampers to ground then count from the motion as one."""
        return any(event.body.drives for event in self.events)

    @property
    def has_damping_loads(self) -> bool:
        """The law of a load damps its point."""
        return any(event.body.damps for event in self.events)

    @property
    def is_rare(self) -> bool:
        """No motion of normal operation; where the file does not say it, in doubt it is one."""
        faults = [isinstance(event.body, ShortCircuit) for event in self.events]
        return self.duty == "rare" or (self.duty is None and bool(faults) and all(faults))


def cases(study: Study) -> list[tuple[TransientSettings, Path]]:
    """Every motion that the file names, and where it stands there."""
    named = study.analyses.get("transient")
    is_list = isinstance(named, Several)
    motions = named.each if isinstance(named, Several) else (named,)
    return [
        (settings, (*PATH, number) if is_list else PATH)
        for number, settings in enumerate(motions)
        if isinstance(settings, TransientSettings)
    ]


def transient_faults(study: Study) -> list[Fault]:
    """Motions without a name, events at what is no point or after the end, files, and nothing that moves the train."""
    faults, names, motions = list[Fault](), set[str](), cases(study)
    meshes = {torque.mesh[0] for torque in study.train.torques if torque.mesh}
    acting = [settings.torques for settings, _ in motions]
    if any(torques is None or meshes.intersection(torques) for torques in acting):
        faults += mesh_faults(study, "motion over time")
    if not motions:
        hint = "`- {name: start, duration: 2 s, events: [...]}`"
        faults.append(Fault(PATH, "the list of motions is empty", hint))
    if motions and study.model == "exact" and study.train.has_shafts:
        message = (
            "the transient response supports lumped or finite-element shafts, not the model exact"
        )
        faults.append(Fault(("analyses", "model"), message, "model: lumped"))
    for settings, path in motions:
        name = settings.name
        if len(motions) > 1 and (not name or name in names):
            what = f"two motions are called '{name}'" if name else "a motion in a list needs a name"
            name_path = (*path, "name") if name else path
            faults.append(Fault(name_path, what, "`name: start`, each another"))
        names.add(name)
        faults += _faults(study, settings, path)
    return faults


def _faults(study: Study, settings: TransientSettings, path: Path) -> Iterator[Fault]:
    """What is wrong in one motion."""
    initial, train = settings.initial, study.train
    given = initial if isinstance(initial, dict) else {}
    speed = study.operation.speed if initial in (None, "steady") else given.get("speed")
    speeds = speed if isinstance(speed, dict) else {}
    is_shaken = train.periodic_torques if settings.torques is None else settings.torques
    is_twisted = any(given.get("torque", {}).values())
    if not (settings.events or speeds or is_twisted or is_shaken or (study.has_joints and speed)):
        hint = "give `events`, `initial: {torque: {coupling-1: 100 N*m}}`, or `excitations`"
        message = "nothing moves the train: no event, no periodic torque, no twist that is released"
        yield Fault(path, message, hint)
    kinds = {part.name: (part.kind, part.is_point) for part in train.parts}
    named = [name_fault(name, (*path, "initial", "speed", name), kinds) for name in speeds]
    yield from (fault for fault in named if fault is not None)
    if speeds and not train.has_nonlinear_couplings:
        message = "speeds of several points need a clutch or a clearance between them"
        yield Fault((*path, "initial"), message, "initial: {speed: 1500 rpm}")
    for name in settings.torques or ():
        if name not in train.periodic_torques:
            hint = ", ".join(train.periodic_torques) or "leave `torques` out"
            yield Fault((*path, "torques"), f"no periodic torque acts at '{name}'", hint)
    for number, event in enumerate(settings.events):
        yield from _event_faults(study, settings, event, (*path, "events", number), kinds)
    yield from _stopped_twice(settings, path)
    yield from _given_twice(settings, path)
    yield from _names_and_orders(study, settings, path, kinds)


def _event_faults(
    study: Study,
    settings: TransientSettings,
    event: Event,
    path: Path,
    kinds: Mapping[str, tuple[str, bool]],
) -> Iterator[Fault]:
    """What is wrong in one event; kinds: of every component its kind, and whether it is a point."""
    body, files = event.body, Point(folder=FilePath(study.file).parent)
    is_clutch = isinstance(body, Clutch)
    if (fault := name_fault(event.at, (*path, "at"), kinds, point=not is_clutch)) is not None:
        yield fault
    elif is_clutch and not study.train[event.at].is_clutch:
        yield Fault((*path, "at"), f"'{event.at}' is no clutch", "name a coupling with `capacity`")
    elif isinstance(body, ShortCircuit) and kinds[event.at][0] not in ELECTRICAL:
        hint = f"make '{event.at}' a `generator`; its load then leaves there"
        yield Fault((*path, "at"), "a short circuit acts in an electrical machine", hint)
    if event.time >= settings.duration:
        hint = f"within {settings.duration:g} s, or a longer `duration`"
        yield Fault((*path, "time"), "the event begins after the end of the motion", hint)
    if isinstance(body, Table) and (lack := body.lacks(files)) is not None:
        yield Fault((*path, "table", "file"), *lack)
        return
    corners = [event.time + late for late in body.changes(files)]
    if any(a >= b for a, b in pairwise(corners)):
        message = (
            f"times of the event fall together: near {event.time:g} s numbers do not resolve them"
        )
        hint = f"at least {4.0 * math.ulp(event.time):.1g} s between them"
        yield Fault((*path, body.key), message, hint)
    again = body.reclose if isinstance(body, ShortCircuit) else None
    if again is not None and event.time < settings.duration <= event.time + again[1]:
        message = (
            f"the short circuit begins again at {event.time + again[1]:g} s, after the end of the "
            "transient response"
        )
        hint = f"a `reclose` below {settings.duration - event.time:g} s, or a longer `duration`"
        yield Fault((*path, "short-circuit", "reclose"), message, hint)


def _names_and_orders(
    study: Study, settings: TransientSettings, path: Path, kinds: Mapping[str, tuple[str, bool]]
) -> Iterator[Fault]:
    """Names in `plot`, `fatigue` and `orders` that no component has, or a point; orders above the highest."""
    named = [((*path, "plot"), settings.plot)]
    for key in ("fatigue", "orders"):
        if (part := getattr(settings, key)) is not None:
            named.append(((*path, key, "at"), part.at))
    for key_path, names in named:
        for name in names:
            if name not in kinds:
                yield Fault(key_path, f"no component is called '{name}'", ", ".join(kinds))
            elif key_path[-1] == "at" and kinds[name][1]:
                links = ", ".join(link for link, (_, is_point) in kinds.items() if not is_point)
                message = f"'{name}' is a {kinds[name][0]}, and no torque goes through it"
                yield Fault(key_path, message, links)
    orders, path = settings.orders, (*path, "orders")
    if orders is None:
        return
    if orders.reference is not None:
        fault = name_fault(orders.reference, (*path, "reference"), kinds)
        if fault is not None:
            yield fault
    largest = max(orders.track, default=0.0)
    if orders.highest is not None and largest > orders.highest:
        message = f"order {largest:g} is tracked, and the waterfall ends at {orders.highest:g}"
        yield Fault((*path, "highest"), message, f"{largest:g} or more, or leave it out")
    if study.train.has_nonlinear_couplings:
        message = "orders of a transient response with backlash, friction, stages or a capacity are not supported yet"
        yield Fault(path, message, "leave it out, or make the couplings linear")


def _stopped_twice(settings: TransientSettings, path: Path) -> Iterator[Fault]:
    """Stops at a point that together take more than its mean torque; judged where a share of one is at its end."""
    stops = [
        (number, event, event.body)
        for number, event in enumerate(settings.events)
        if isinstance(event.body, Stop)
    ]
    near = ROUNDING * settings.duration
    for number, event, body in stops:
        others = [(other.time, stop) for _, other, stop in stops if other.at == event.at]
        full = event.time + body.ramp
        ends = [full + near, *([] if math.isinf(body.lasts) else [full + body.lasts - near])]
        share = max(sum(stop.taken(end - time) for time, stop in others) for end in ends)
        if share > 1.0 + ROUNDING:
            message = (
                f"the stops at '{event.at}' together end {100.0 * share:.4g} % of its mean torque"
            )
            hint = "a `share` each, of 100 % together"
            yield Fault((*path, "events", number, "stop"), message, hint)
            return


def _given_twice(settings: TransientSettings, path: Path) -> Iterator[Fault]:
    """A second program of speed at a point, and a start there while an earlier one is on; two at one time add."""
    for number, event in enumerate(settings.events):
        body, event_path = event.body, (*path, "events", number, event.body.key)
        at_point = [(other, other.body) for other in settings.events if other.at == event.at]
        if isinstance(body, SpeedProgram):
            programs = [other for other, program in at_point if isinstance(program, SpeedProgram)]
            if programs[0] is not event:
                message = f"the speed of '{event.at}' is prescribed twice"
                yield Fault(event_path, message, "one `program` with all its rows")
        if isinstance(body, Start):
            begins = [
                other.time
                for other, start in at_point
                if isinstance(start, Start)
                and other.time < event.time < other.time + (start.off or math.inf)
            ]
            if begins:
                message = f"'{event.at}' is switched on at {begins[0]:g} s already"
                hint = f"end that start by its `off`, at most {event.time - begins[0]:g} s"
                yield Fault(event_path, message, hint)
