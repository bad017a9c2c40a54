"""What the response over speed means for components: torque, stress, angle, peaks, reversal of load, heat.

The rule of the makers of couplings judges the same heat. Each value is the largest over the speed range.
"""

import math
from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.elements import elements
from torsion.assembly.section.solved_sections import span_moduli, stress_modulus
from torsion.assembly.system import NOTHING, System
from torsion.findings import Results, Work
from torsion.kernels.trees.tree_response import Status
from torsion.primitives import Bar
from torsion.results import derived, reported, result

SMALLEST = 0.02  # of the element's largest amplitude of one order; a lower peak is not listed
SAME = 0.03  # relative distance of a peak from its natural frequency, or twice the damping ratio (half-power width)
TINY = 1e-12  # of the largest angle: less may be rounding
Largest = tuple[float | None, float | None]  # value and reference speed (rad/s); None where unknown


@reported
class MeshLoad:
    """Vibratory against mean torque in one gear mesh."""

    mesh: str = result("its name")
    torque: float | None = result(
        "N*m", "largest amplitude of all orders, at its driving wheel; null if unreliable"
    )
    speed: float | None = result("rad/s", "reference speed of that")
    mean: float | None = result("N*m", "magnitude of the mean torque there; null if unknown")
    ratio: float | None = result(
        "1", "largest vibratory / mean torque; infinite without mean torque, null if unknown"
    )
    ratio_speed: float | None = result(
        "rad/s", "reference speed of that ratio; null if it is infinite"
    )
    reversal: tuple[float, ...] = result(
        "rad/s", "first and last reference speed at which the load reverses; empty if it does not"
    )
    reverses_everywhere: bool = result("the load reverses at every speed computed")

    @derived("whether the load reverses: yes, no, or not known")
    def reverses(self) -> str:
        if self.ratio is None:
            return "not known"
        return ("yes, everywhere" if self.reverses_everywhere else "yes") if self.reversal else "no"


@reported
class CouplingLoad:
    """Torque and heat of one coupling."""

    coupling: str = result("its name")
    torque: float | None = result("N*m", "largest amplitude of all orders; null if unreliable")
    speed: float | None = result("rad/s", "reference speed of that")
    mean: float | None = result("N*m", "largest mean torque; null if unknown")
    peak: float | None = result(
        "N*m", "largest magnitude of mean and vibratory torque; null if unreliable"
    )
    heat: float | None = result("W", "largest power loss, all orders together; null if unreliable")
    heat_speed: float | None = result("rad/s", "reference speed of that")
    vibratory_limit: float | None = result("N*m", "T_KW of its maker, or null")
    rated_torque: float | None = result("N*m", "T_KN of its maker, or null")
    max_torque: float | None = result("N*m", "T_Kmax of its maker, or null")
    heat_limit: float | None = result("W", "P_KW of its maker, or null")


@reported
class ElementLoad:
    """Vibratory torque in one elastic element, at the speed at which the total is largest."""

    component: str = result("its name")
    torque: float | None = result("N*m", "amplitude of all orders together; null if unreliable")
    speed: float | None = result("rad/s", "reference speed of that")
    order: str | None = result("name of the order with the largest amplitude there")
    order_torque: float | None = result("N*m", "amplitude of that order")
    rms: float | None = result("N*m", "RMS value of the vibratory torque")
    bound: float | None = result("N*m", "sum of the magnitudes of all orders")
    mean: float | None = result("N*m", "mean torque there")


@reported
class Peak:
    """A resonance peak of one order in one element, not below SMALLEST of the element's largest amplitude."""

    component: str = result("name of the element")
    order: str = result("name of the order")
    torque: float = result("N*m", "amplitude")
    referred: float = result("N*m", "the same, referred to the reference speed")
    speed: float = result("rad/s", "reference speed")
    frequency: float = result("Hz", "frequency of the order there")
    mode: int | None = result("mode with the nearest frequency; null if none is near")


@reported
class ShaftLoad:
    """Nominal shear stress of one shaft."""

    shaft: str = result("its name")
    role: str | None = result("its role for class rules, or null")
    stress: float | None = result(
        "Pa", "largest amplitude of all orders, of the plain section; null if unreliable"
    )
    speed: float | None = result("rad/s", "reference speed of that")


@reported
class StationLoad:
    """Largest angular amplitude of a single order at one station."""

    station: str = result("its name")
    angle: float | None = result("rad", "at its own speed; null if unreliable")
    order: str | None = result("name of the order")
    speed: float | None = result("rad/s", "reference speed")
    rate: float | None = result("rad/s", "amplitude of its speed")


@reported
class JointLoad:
    """Torque in one joint, of the order that it excites."""

    joint: str = result("its name")
    order: Fraction = result("per revolution of the reference, exact")
    torque: float | None = result("N*m", "largest amplitude; null if unreliable")
    speed: float | None = result("rad/s", "reference speed of that")
    model_error: float | None = result("1", "estimated relative error of the joint model there")


@reported
class ComponentLoads:
    """Loads of the components under the response."""

    elements: tuple[ElementLoad, ...] = result("elastic elements that carry a torque")
    peaks: tuple[Peak, ...] = result("resonance peaks, the largest of each element first")
    shafts: tuple[ShaftLoad, ...] = result("shafts")
    stations: tuple[StationLoad, ...] = result("stations that are not the ground")
    meshes: tuple[MeshLoad, ...] = result("gear meshes, in the order of the train")
    couplings: tuple[CouplingLoad, ...] = result("couplings with damping or limits of their maker")
    joints: tuple[JointLoad, ...] = result("joints that excite", default=())


def harmonic_heat(response: Response, system: System, spans: IntArray) -> FloatArray:
    """Return the mean power (speeds, lines) W that spans turn into heat.

    Of each line omega Im K |twist|^2/2 with twist = torque/K and K = k (1 + i eta) + i omega c, of a coupling with
    play, friction or stages as harmonic balance has it; with damping by hysteresis alone it is
    psi omega T_el^2/(4 pi k) of the elastic torque T_el. A rigid span loses nothing.
    """
    omega = 2.0 * math.pi * response.frequency
    power = np.zeros(response.frequency.shape)
    added = {} if response.balanced is None else response.balanced.added
    vibratory = dict[int, FloatArray]()
    if (following := response.following) is not None:
        vibratory = dict(zip(following.spans, following.torque.T, strict=True))
    speed = response.speed[:, None]
    for span in spans[np.all(system.flexibility[spans].reshape(len(spans), -1) > 0, axis=1)]:
        # Its table may be over the vibratory torque, else over the mean torque.
        carried = vibratory.get(span, response.mean[:, span])[:, None]
        stiffness, loss = system.elastic(span, omega, carried, speed)
        if span in added:
            balance = added[span]
            loss = balance.share[:, None] * loss + balance.extra.imag[:, None]
            stiffness = balance.share[:, None] * stiffness + balance.extra.real[:, None]
        size = np.abs(response.torque[:, :, span])
        dynamic = np.hypot(stiffness, loss)
        twist = np.divide(size, dynamic, out=np.zeros_like(omega), where=loss > 0)
        power += 0.5 * omega * loss * twist**2
    return power


def raised(evidence: Results, spans: IntArray, values: FloatArray, power: int = 1) -> FloatArray:
    """Return values (speeds, ...) of a torque to that power, as large as exact motions of nonlinear couplings have them.

    Infinite where such a motion is needed and none is known.
    """
    if not evidence.study.train.has_nonlinear_couplings:
        return values
    from torsion.analyses.motion.derived.raised_synthesis import surplus

    shape = (-1, *(1,) * (values.ndim - 1))
    is_known = np.isfinite(evidence.need(Synthesis).half_range[:, spans[0]])
    factor = surplus(evidence)[0][:, spans].max(axis=1) ** power
    return np.where(is_known.reshape(shape), values * factor.reshape(shape), np.inf)


def nearest_mode(evidence: Results, frequency: float) -> int | None:
    """Return the mode (from 1), damped if known, whose frequency is nearest to a frequency (Hz); None if not near."""
    damped = evidence.get(DampedModes)
    undamped = evidence.get(Modes)
    source = undamped if damped is None else damped
    if source is None or len(source.frequency) == 0:
        return None
    distance = np.abs(source.frequency / frequency - 1.0)
    nearest = int(np.argmin(distance))
    ratio = 0.0 if damped is None else float(damped.damping_ratio[nearest])
    return nearest + 1 if distance[nearest] <= max(SAME, 2.0 * ratio) else None


def rounding(evidence: Results) -> FloatArray:
    """Return (spans,) N m below which a vibratory torque is rounding of the train's largest torque, stated as 0."""
    response = evidence.get(Response)
    ratio = evidence.system.span_ratio
    if response is None or not response.lines:
        return np.zeros(len(ratio))
    size = np.abs(np.nan_to_num(response.mean)).max(axis=0, initial=0.0)
    for speed, is_known in enumerate(response.status == Status.OK):
        np.maximum(
            size, np.abs(response.torque[speed, is_known]).max(axis=0, initial=0.0), out=size
        )
    return NOTHING * float((size * ratio).max(initial=0.0)) / ratio


def local_maxima(values: FloatArray) -> list[int]:
    """Return inner places where the values exceed both sides; a place without a value is no neighbour."""
    filled = np.where(np.isfinite(values), values, np.inf)
    inner = (filled[1:-1] > filled[:-2]) & (filled[1:-1] >= filled[2:]) & np.isfinite(values[1:-1])
    return (np.flatnonzero(inner) + 1).tolist()


def stress_of(bar: Bar, system: System, torque: FloatArray) -> FloatArray:
    """Return the nominal shear stress (speeds, ...) Pa of a shaft under torques (speeds, ..., spans) N m."""
    spans = np.flatnonzero(system.span_part == bar.part)
    modulus = np.full(len(spans), stress_modulus(bar))
    if bar.section is None:
        ends = (bar.outer[0], bar.bore[0]), (bar.outer[1], bar.bore[1])
        modulus = span_moduli(ends, len(spans))
    return np.asarray((torque[..., spans] / modulus).max(axis=-1))


def _largest(response: Response, values: FloatArray) -> Largest:
    """Return the largest value (speeds,) and its speed; None where any of the response is not reliable."""
    if response.unreliable.any() or not np.isfinite(values).all():
        return None, None
    worst = int(np.argmax(values))
    return float(values[worst]), float(response.speed[worst])


def component_loads(evidence: Results) -> ComponentLoads:
    """Return the loads of the components of a train with a response and its synthesis."""
    response = evidence.need(Response)
    total = evidence.need(Synthesis)
    steady = evidence.get(Steady)
    system = evidence.system
    spans_of: dict[tuple[int, str], list[int]] = {}
    for position, span in enumerate(system.own_spans):
        spans_of.setdefault((span.part, span.name), []).append(position)
    meshes = []
    couplings = []
    for (number, name), spans in sorted(spans_of.items(), key=lambda item: item[0][0]):
        part = system.train.parts[number]
        limits = part.ratings
        if part.kind == "gear":
            meshes.append(_mesh_load(evidence, name, spans))
        elif limits is not None:
            table = system.tables.get(spans[0])
            damping = system.loss_factor[spans[0]] + system.viscous[spans[0]]
            # A coupling without limits and damping has nothing to be compared with, and no heat.
            if not (limits.limit_anything or (table.damps if table else damping > 0)):
                continue
            mean = None if steady is None else float(np.abs(steady.torque[spans]).max())
            with np.errstate(all="ignore"):
                heat = harmonic_heat(response, system, np.array(spans))
                power = raised(evidence, np.array(spans), heat, power=2).sum(axis=1)
            load = CouplingLoad(
                name,
                *_largest(response, total.half_range[:, spans].max(axis=1)),
                mean,
                _largest(response, total.peak[:, spans].max(axis=1))[0],
                *_largest(response, power),
                limits.vibratory_torque,
                limits.rated_torque,
                limits.max_torque,
                limits.heat_limit,
            )
            couplings.append(load)
    shafts = []
    for bar in system.train.bars:
        shaft = system.train.parts[bar.part].shaft
        stress = _largest(response, stress_of(bar, system, total.half_range))
        shafts.append(ShaftLoad(bar.name, None if shaft is None else shaft.role, *stress))
    return ComponentLoads(
        *_element_loads(evidence),
        tuple(shafts),
        tuple(_station_loads(evidence)),
        tuple(meshes),
        tuple(couplings),
        tuple(_joint_loads(evidence)),
    )


def _mesh_load(evidence: Results, name: str, spans: list[int]) -> MeshLoad:
    """Return the load of a mesh, compared with the magnitude of its mean torque where that is known."""
    response = evidence.need(Response)
    torque = evidence.need(Synthesis).half_range[:, spans].max(axis=1)
    value, at_speed = _largest(response, torque)
    if value is None or evidence.get(Steady) is None:
        return MeshLoad(name, value, at_speed, None, None, None, (), False)
    mean = np.abs(response.mean[:, spans[0]])
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(torque == 0, 0.0, torque / mean)
    worst = int(np.argmax(ratio))
    reversing = response.speed[ratio > 1.0]
    return MeshLoad(
        name,
        value,
        at_speed,
        mean=float(mean[int(np.argmax(torque))]),
        ratio=float(ratio[worst]),
        ratio_speed=None if np.isinf(ratio[worst]) else float(response.speed[worst]),
        reversal=tuple(reversing[[0, -1]].tolist()) if reversing.size else (),
        reverses_everywhere=reversing.size == response.speed.size,
    )


def _element_loads(evidence: Results) -> tuple[tuple[ElementLoad, ...], tuple[Peak, ...]]:
    """Return the largest total of every element that carries a torque, and the peaks of its orders."""
    response = evidence.need(Response)
    total = evidence.need(Synthesis)
    is_reliable = response.status == Status.OK
    nothing = rounding(evidence)
    names = [line.named(evidence.study.reference) for line in response.lines]
    loads = []
    peaks = []
    for element in elements(evidence.system):
        spans = list(element.spans)
        size = np.abs(response.torque[:, :, spans]).max(axis=2)
        if not (size > 0).any():
            continue
        orders = np.where(is_reliable, size, np.nan)
        smallest = SMALLEST * np.nanmax(np.append(orders, 0.0))
        # The peaks of each order, without those that no reader would look for.
        listed = []
        for line, values in enumerate(orders.T):
            for speed in local_maxima(values):
                if (value := float(values[speed])) >= smallest:
                    hertz = float(response.frequency[speed, line])
                    sizes = value, value * element.ratio, float(response.speed[speed]), hertz
                    mode = nearest_mode(evidence, hertz)
                    listed.append(Peak(element.name, names[line], *sizes, mode))
        peaks += sorted(listed, key=lambda peak: -peak.torque)

        torque = element.largest(total.half_range)
        # What may be rounding of the largest torque of the train is none.
        torque = np.where(torque < nothing[spans].min(), 0.0, torque)
        if not (is_reliable.all() and np.isfinite(torque).all()):
            loads.append(ElementLoad(element.name, *[None] * 7))
            continue
        speed = int(np.argmax(torque))
        span = spans[int(np.argmax(total.half_range[speed, spans]))]
        mean = float(response.mean[speed, span])
        if torque[speed] == 0.0:
            loads.append(ElementLoad(element.name, 0.0, None, None, 0.0, 0.0, 0.0, mean))
            continue
        line = int(np.argmax(orders[speed]))
        largest = float(torque[speed]), float(response.speed[speed])
        of_order = names[line], float(orders[speed, line])
        others = float(total.rms[speed, span]), float(total.bound[speed, span])
        loads.append(ElementLoad(element.name, *largest, *of_order, *others, mean))
    return tuple(loads), tuple(peaks)


def _station_loads(evidence: Results) -> Iterator[StationLoad]:
    """Yield the largest angle of every station; 0 for what may be rounding of the largest of the train."""
    response = evidence.need(Response)
    ratio = evidence.system.speed_ratio
    sizes = np.abs(response.angle)
    top = float((sizes / ratio[: sizes.shape[2]]).max(initial=0.0))
    for position, station in enumerate(evidence.study.train.stations):
        if station.is_ground:
            continue
        if response.unreliable.any():
            yield StationLoad(station.name, *[None] * 4)
            continue
        speed, line = divmod(int(np.argmax(sizes[:, :, position])), sizes.shape[1])
        angle = float(sizes[speed, line, position])
        angle = 0.0 if angle < TINY * top * float(ratio[position]) else angle
        rate = 2.0 * math.pi * angle * float(response.frequency[speed, line])
        name = response.lines[line].named(evidence.study.reference)
        yield StationLoad(station.name, angle, name, float(response.speed[speed]), rate)


def _joint_loads(evidence: Results) -> Iterator[JointLoad]:
    """Yield the largest torque of every joint at its own order, where the response has this order."""
    response = evidence.need(Response)
    system = evidence.system
    line_of = {line.order: k for k, line in enumerate(response.lines)}
    for span in (span for span in system.spans if span.error and span.error[0][1]):
        order = span.error[0][0] * system.stations[span.driving].ratio
        if (line := line_of.get(order)) is None:
            continue
        name = system.train.parts[span.part].name
        if (response.status[:, line] != Status.OK).any():
            yield JointLoad(name, order, None, None, None)
            continue
        spans = np.flatnonzero(system.span_part == span.part)
        size = np.abs(response.torque[:, line, spans]).max(axis=1)
        speed = int(np.argmax(size))
        torque = float(size[speed]), float(response.speed[speed])
        yield JointLoad(name, order, *torque, float(response.joint_error[speed, line]))


def run(work: Work) -> None:
    """Put the loads where something excites a response over speed."""
    response = work.get(Response)
    if response is not None and response.lines and work.get(Synthesis) is not None:
        work.put(component_loads=component_loads(work))
