"""What the response over speed means for gear meshes (reversal of load) and couplings (torque and heat).

The rule of the makers of couplings judges the same heat. Each value is the largest over the speed range.
"""

import math

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Results, Work
from torsion.kernels.tree_response import Status
from torsion.results import reported, result

Largest = tuple[float | None, float | None]  # value and reference speed (rad/s); None where unknown


@reported
class MeshLoad:
    """Vibratory against mean torque in one gear mesh."""

    mesh: str = result("", "its name")
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
        "rad/s",
        "first and last reference speed at which the load reverses; empty if it does not",
    )
    reverses_everywhere: bool = result("", "the load reverses at every speed computed")


@reported
class CouplingLoad:
    """Torque and heat of one coupling."""

    coupling: str = result("", "its name")
    torque: float | None = result("N*m", "largest amplitude of all orders; null if unreliable")
    speed: float | None = result("rad/s", "reference speed of that")
    mean: float | None = result("N*m", "largest mean torque; null if unknown")
    peak: float | None = result(
        "N*m", "largest magnitude of mean and vibratory torque; null if unreliable"
    )
    heat: float | None = result("W", "largest power loss, all orders together; null if unreliable")
    heat_speed: float | None = result("rad/s", "reference speed of that")


@reported
class ComponentLoads:
    """Loads of gear meshes and couplings under the response."""

    meshes: tuple[MeshLoad, ...] = result("", "gear meshes, in the order of the train")
    couplings: tuple[CouplingLoad, ...] = result(
        "", "couplings with damping or limits of their maker"
    )


def heat(response: Response, system: System, spans: IntArray) -> FloatArray:
    """Return the mean power (speeds,) W that spans turn into heat, all lines together."""
    return np.asarray(np.sum(harmonic_heat(response, system, spans), axis=1))


def harmonic_heat(response: Response, system: System, spans: IntArray) -> FloatArray:
    """Return the mean power (speeds, lines) W that spans turn into heat.

    Of each line omega Im K |twist|^2/2 with twist = torque/K and K = k (1 + i eta) + i omega c, of a coupling with
    play, friction or stages as harmonic balance has it; with damping by hysteresis alone it is
    psi omega T_el^2/(4 pi k) of the elastic torque T_el. A rigid span loses nothing.
    """
    omega, power = 2.0 * math.pi * response.frequency, np.zeros(response.frequency.shape)
    added = {} if response.balanced is None else response.balanced.added
    for span in spans[np.all(system.flexibility[spans].reshape(len(spans), -1) > 0, axis=1)]:
        carried, speed = response.carried(span), response.speed[:, None]
        stiffness, loss = system.elastic(span, omega, carried, speed)
        if span in added:
            balance = added[span]
            loss = balance.share[:, None] * loss + balance.extra.imag[:, None]
            stiffness = balance.share[:, None] * stiffness + balance.extra.real[:, None]
        size, dynamic = np.abs(response.torque[:, :, span]), np.hypot(stiffness, loss)
        twist = np.divide(size, dynamic, out=np.zeros_like(omega), where=loss > 0)
        power += 0.5 * omega * loss * twist**2
    return power


def raised_heat(evidence: Results, spans: IntArray) -> FloatArray:
    """Return the heat (speeds, lines) W of the spans, raised as exact motions raise the torque of harmonic balance."""
    power = harmonic_heat(evidence.need(Response), evidence.system, spans)
    return raised(evidence, spans, power, power=2)


def raised(evidence: Results, spans: IntArray, values: FloatArray, power: int = 1) -> FloatArray:
    """Return values (speeds, ...) of a torque to that power, as large as exact motions of nonlinear couplings have them.

    Infinite where such a motion is needed and none is known.
    """
    if not evidence.study.train.has_nonlinear_couplings:
        return values
    from torsion.analyses.motion.raised_synthesis import surplus

    shape = (-1, *(1,) * (values.ndim - 1))
    is_known = np.isfinite(evidence.need(Synthesis).half_range[:, spans[0]])
    factor = surplus(evidence)[0][:, spans].max(axis=1) ** power
    return np.where(is_known.reshape(shape), values * factor.reshape(shape), np.inf)


def component_loads(evidence: Results) -> ComponentLoads:
    """Return the loads of meshes and couplings of a train with a response and its synthesis."""
    response, total = evidence.need(Response), evidence.need(Synthesis)
    system, steady, speed = evidence.system, evidence.get(Steady), response.speed
    unreliable = np.any(response.status != Status.OK, axis=1)

    def largest(values: FloatArray) -> Largest:
        """Return the largest value and its speed; None where any value is not reliable."""
        if unreliable.any() or not np.isfinite(values).all():
            return None, None
        place = int(np.argmax(values))
        return float(values[place]), float(speed[place])

    spans_of: dict[tuple[int, str], list[int]] = {}
    for position, span in enumerate(system.own_spans):
        spans_of.setdefault((span.part, span.name), []).append(position)

    meshes, couplings = list[MeshLoad](), list[CouplingLoad]()
    for (number, name), positions in sorted(spans_of.items(), key=lambda item: item[0][0]):
        part, spans = system.train.parts[number], np.array(positions)
        torque = total.half_range[:, spans].max(axis=1)
        value, at_speed = largest(torque)
        if part.kind == "gear":
            mean = None
            if value is not None and steady is not None:
                mean = np.abs(response.mean[:, spans[0]])
            meshes.append(_mesh_load(name, speed, torque, mean, (value, at_speed)))
            continue
        limits, table = part.ratings, system.tables.get(positions[0])
        is_damped = (
            table.damps if table else (system.loss_factor + system.viscous)[positions[0]] > 0
        )
        if limits is None or not (is_damped or limits.limit_anything):
            continue
        with np.errstate(all="ignore"):
            power = raised_heat(evidence, spans).sum(axis=1)
        mean_torque = None if steady is None else float(np.abs(steady.torque[spans]).max())
        peak, _ = largest(total.peak[:, spans].max(axis=1))
        load = CouplingLoad(name, value, at_speed, mean_torque, peak, *largest(power))
        couplings.append(load)
    return ComponentLoads(tuple(meshes), tuple(couplings))


def _mesh_load(
    name: str, speed: FloatArray, torque: FloatArray, mean: FloatArray | None, largest: Largest
) -> MeshLoad:
    """Return the load of a mesh; mean: magnitudes (speeds,) N m, None where not known."""
    if mean is None:
        return MeshLoad(name, *largest, None, None, None, (), False)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(torque == 0, 0.0, torque / mean)
    place, reversing = int(np.argmax(ratio)), speed[ratio > 1.0]
    return MeshLoad(
        mesh=name,
        torque=largest[0],
        speed=largest[1],
        mean=float(mean[int(np.argmax(torque))]),
        ratio=float(ratio[place]),
        ratio_speed=None if np.isinf(ratio[place]) else float(speed[place]),
        reversal=tuple(reversing[[0, -1]].tolist()) if reversing.size else (),
        reverses_everywhere=reversing.size == speed.size,
    )


def run(work: Work) -> None:
    """Put the loads where something excites a response over speed."""
    response = work.get(Response)
    if response is not None and response.lines and work.get(Synthesis) is not None:
        work.put(component_loads=component_loads(work))
