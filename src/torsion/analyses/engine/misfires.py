"""Every cylinder of an engine motored in turn: the torque amplitudes of all elements, by superposition.

The train is linear: to the known response comes that to what the torques of the cylinders change by. The response to
1 N m is computed once for every throw and order.
"""

from dataclasses import replace

import numpy as np

from torsion.analyses.engine.engine_results import MisfireFound
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.response.solver import answers, ground_damping
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.steady import steady_if_known
from torsion.arrays import FloatArray, IntArray
from torsion.kernels.engine.gas_law import CylinderOrder, State
from torsion.model.engine.record import EngineRecord
from torsion.study import Study

MOST_SPEEDS = 101  # of those requested; to them come the peaks of every order in every element
STATED = "`misfire: worst` solves the train for every cylinder"
SAME_PEAK = 3e-3  # relative: nearer peaks stand for each other


def misfires(study: Study, response: Response, engine: EngineRecord) -> list[MisfireFound]:
    """Return the engine with no cylinder motored, then each alone.

    Empty where the motored torque is unknown or nothing excites.
    """
    is_known = engine.gas is not None and engine.gas.motored is not None
    if not is_known or not response.lines or without_answer(response):
        return []
    speeds = _chosen_speeds(response)
    half_range = _half_ranges(study, response, engine, speeds)
    # All speeds between the neighbours of that with the largest value of a case and span.
    largest = np.unique(np.nan_to_num(half_range, posinf=0.0).argmax(axis=1))
    first, last = (speeds[np.clip(largest + step, 0, len(speeds) - 1)] for step in (-1, 1))
    near = [np.arange(*ends) for ends in zip(first.tolist(), last.tolist(), strict=True)]
    added = np.setdiff1d(np.concatenate(near), speeds)
    added_half_range = _half_ranges(study, response, engine, added)
    half_range = np.concatenate([half_range, added_half_range], axis=1)
    speeds = np.append(speeds, added)
    order = np.argsort(speeds)
    return [
        MisfireFound(number, response.speed[speeds[order]], values[order])
        for number, values in enumerate(half_range)
    ]


def without_answer(response: Response) -> str:
    """Return why nothing can be superposed; empty where it can."""
    if response.balanced is not None or response.following is not None:
        return f"the train is not linear; {STATED}"
    if response.by_magnitude:
        return f"phases of engines to each other are any; {STATED}"
    if response.system.tables_over("mean torque"):
        return f"a misfire takes mean torque, and with it the stiffness of a coupling changes; {STATED}"
    return ""


def _half_ranges(
    study: Study, response: Response, engine: EngineRecord, speeds: IntArray
) -> FloatArray:
    """Return the amplitudes (cases, speeds, spans) N m at some positions of speeds, the first with all firing."""
    system = response.system
    speed = response.speed[speeds]
    steady = steady_if_known(study, system, speed)
    line_of = {line.order: k for k, line in enumerate(response.lines)}
    # The torques of an engine stand in the order of its cylinders.
    of_engine = [
        torque
        for torque in system.train.torques
        if isinstance(torque.cylinder, CylinderOrder) and torque.cylinder.engine == engine.part
    ]
    count = len(of_engine) // max(len(engine.cylinders), 1)
    harmonics = [
        (line_of[order], engine.cylinders[position // count].number, torque)
        for position, torque in enumerate(of_engine)
        if torque.order is not None
        and (order := torque.order * system.stations[torque.station].ratio) in line_of
    ]

    # The response to 1 N m at every throw, by line and station.
    ground = ground_damping(system, speed, steady)
    size = system.condensed.tree.size
    node = system.condensed.node
    pairs = sorted({(torque.station, line) for line, _, torque in harmonics})
    sources = []
    for station, _ in pairs:
        force = np.zeros((size, 1), dtype=np.complex128)
        force[node[station]] = system.speed_ratio[station]
        sources.append(Sources(np.broadcast_to(force, (size, len(speed))), None))
    w = [response.lines[line].circular_frequency(speed) for _, line in pairs]
    units = answers(system, w, sources, ground, mean=response.mean[speeds].T, speed=speed)
    unit_torque = {pair: unit.torque for pair, unit in zip(pairs, units, strict=True)}

    half_ranges = []
    for case in range(len(engine.cylinders) + 1):
        torque = response.torque[speeds]
        for line, number, source in harmonics:
            law = source.cylinder
            state: State = "motored" if number == case else "firing"
            if law is None or (law.state == state and (law.share == 1.0 or state == "motored")):
                continue
            own_speed = speed * float(system.speed_ratio[source.station])
            mean = None if steady is None else steady.applied[law.station]
            changed = replace(law, state=state, share=1.0)
            change = changed.amplitude(own_speed, mean) - law.amplitude(own_speed, mean)
            torque[:, line] += change[:, None] * unit_torque[source.station, line]
        mean_torque = response.mean[speeds]
        status = response.status[speeds]
        changed_response = replace(response, torque=torque, mean=mean_torque, status=status)
        half_ranges.append(synthesis(changed_response).half_range)
    return np.array(half_ranges)


def _chosen_speeds(response: Response) -> IntArray:
    """Return positions of the requested speeds, thinned, of the peaks, and of the speeds with the largest sums."""
    requested = np.flatnonzero(response.requested)
    count = min(len(requested), MOST_SPEEDS)
    thinned = requested[np.linspace(0, len(requested) - 1, count).round().astype(int)]
    size = np.nan_to_num(np.abs(response.torque))
    chosen = np.unique(np.append(thinned, size.sum(axis=1).argmax(axis=0))).tolist()
    for peak in np.unique(size.argmax(axis=0)).tolist():
        if np.abs(response.speed[chosen] / response.speed[peak] - 1.0).min() > SAME_PEAK:
            chosen.append(peak)
    return np.sort(np.array(chosen, dtype=np.int64))
