"""Every cylinder of an engine without heat in turn: the half ranges of all elements, by superposition.

The train is linear: to the response that is known comes that to what the torques of the cylinders change by. Of every
throw and order the response to 1 N m is computed once.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.engine.engine_results import MisfireFound
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.response.solver import answers, ground_damping
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.steady import steady_if_known
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.engine.gas_law import CylinderOrder, State
from torsion.model.engine.record import EngineRecord
from torsion.primitives import Torque
from torsion.study import Study

MOST_SPEEDS = 101  # of those requested; to them come the peaks of every order in every element
STATED = "`misfire: worst` solves the train for every cylinder"
APART = 3e-3  # relative: nearer peaks stand for each other


def misfires(study: Study, found: Response, engine: EngineRecord) -> list[MisfireFound]:
    """With no cylinder motored, then each alone; empty where the motored torque is unknown or nothing excites."""
    if engine.gas is None or engine.gas.motored is None or not found.lines or without_answer(found):
        return []
    at = _speeds(found)
    each = _half_ranges(study, found, engine, at)
    more = _beside_largest(found, at, each)
    each = np.concatenate([each, _half_ranges(study, found, engine, more)], axis=1)
    at = np.concatenate([at, more])
    order = np.argsort(at)
    return [
        MisfireFound(number, found.speed[at[order]], own[order]) for number, own in enumerate(each)
    ]


def _half_ranges(study: Study, found: Response, engine: EngineRecord, at: IntArray) -> FloatArray:
    """(cases, speeds, spans) N m at the positions `at` of the speeds."""
    system, speed = found.system, found.speed[at]
    steady = steady_if_known(study, system, speed)
    own = _torques(found, engine)
    unit = _answers(study, found, at, own)
    made = []
    for number in range(len(engine.cylinders) + 1):
        torque = found.torque[at]
        for line, cylinder, one in own:
            state: State = "motored" if cylinder == number else "firing"
            order = one.cylinder
            if order is None or (
                order.state == state and (order.share == 1.0 or state == "motored")
            ):
                continue
            ratio = float(system.speed_ratio[one.station])
            mean = None if steady is None else steady.applied[order.station]
            wanted = replace(order, state=state, share=1.0)
            change = wanted.amplitude(speed * ratio, mean) - order.amplitude(speed * ratio, mean)
            torque[:, line] += change[:, None] * unit[line, one.station]
        case = replace(found, torque=torque, mean=found.mean[at], status=found.status[at])
        made.append(synthesis(case).half_range)
    return np.array(made)


def without_answer(found: Response) -> str:
    """Why nothing can be superposed; empty where it can."""
    if found.balanced is not None or found.following is not None:
        return f"the train is not linear; {STATED}"
    if found.by_magnitude:
        return f"phases of engines to each other are any; {STATED}"
    if found.system.tables_over("mean torque"):
        return f"a misfire takes mean torque, and with it the stiffness of a coupling changes; {STATED}"
    return ""


def _torques(found: Response, engine: EngineRecord) -> list[tuple[int, int, Torque]]:
    """Line, number of the cylinder and torque of every harmonic of the engine that the response has."""
    system = found.system
    lines = {line.order: place for place, line in enumerate(found.lines)}
    return [
        (lines[order], number, torque)
        for number, torque in by_cylinder(system.train.torques, engine)
        if torque.order is not None
        and (order := torque.order * system.stations[torque.station].ratio) in lines
    ]


def by_cylinder(torques: Sequence[Torque], engine: EngineRecord) -> Iterator[tuple[int, Torque]]:
    """The torques of an engine, each with the number of its cylinder: they follow one another as these do."""
    mine = [
        one
        for one in torques
        if isinstance(one.cylinder, CylinderOrder) and one.cylinder.engine == engine.part
    ]
    each = len(mine) // max(len(engine.cylinders), 1)
    return ((engine.cylinders[place // each].number, one) for place, one in enumerate(mine))


def _speeds(found: Response) -> IntArray:
    """Positions of some of the speeds of a response: those requested, thinned, the peaks, and that of the synthesis."""
    requested = np.flatnonzero(found.requested)
    thinned = requested[
        np.linspace(0, len(requested) - 1, min(len(requested), MOST_SPEEDS)).round().astype(int)
    ]
    size = np.nan_to_num(np.abs(found.torque))
    kept = np.unique(np.append(thinned, size.sum(axis=1).argmax(axis=0))).tolist()
    for peak in np.unique(size.argmax(axis=0)).tolist():
        if np.abs(found.speed[kept] / found.speed[peak] - 1.0).min() > APART:
            kept.append(peak)
    return np.sort(np.array(kept, dtype=np.int64))


def _beside_largest(found: Response, at: IntArray, each: FloatArray) -> IntArray:
    """Positions of all speeds between the neighbours of that with the largest half range of a case and span."""
    largest = np.unique(np.nan_to_num(each, posinf=0.0).argmax(axis=1))
    first, last = (at[np.clip(largest + step, 0, len(at) - 1)] for step in (-1, 1))
    near = [np.arange(*ends) for ends in zip(first.tolist(), last.tolist(), strict=True)]
    return np.setdiff1d(np.concatenate(near), at)


def _answers(
    study: Study, found: Response, at: IntArray, own: list[tuple[int, int, Torque]]
) -> dict[tuple[int, int], ComplexArray]:
    """(speeds, spans) N m to 1 N m at every throw, by line and station."""
    system, speed = found.system, found.speed[at]
    ground = ground_damping(system, speed, steady_if_known(study, system, speed))
    size, node = system.condensed.tree.size, system.condensed.node
    pairs = sorted({(torque.station, line) for line, _, torque in own})
    sources = []
    for station, _ in pairs:
        force = np.zeros((size, 1), dtype=np.complex128)
        force[node[station]] = system.speed_ratio[station]
        sources.append(Sources(np.broadcast_to(force, (size, len(speed))), None))
    w = [found.lines[line].circular_frequency(speed) for _, line in pairs]
    mean = found.mean[at].T
    every = zip(pairs, answers(system, w, sources, ground, mean=mean, speed=speed), strict=True)
    return {(line, station): one.torque for (station, line), one in every}
