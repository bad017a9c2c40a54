"""Engines of the train: harmonics at the rated speed, sums of phasors by mode, varying inertia, misfires; faults."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.engine.engine_results import (
    CurveFound,
    CylinderFound,
    EngineFound,
    Engines,
    HarmonicFound,
    MisfireFound,
    VaryingInertia,
)
from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.response.solver import answers, ground_damping
from torsion.analyses.response.synthesis import synthesis
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.kernels.engine.gas_torque import CylinderOrder, State
from torsion.model.engine.record import EngineRecord
from torsion.model.parts import Part
from torsion.study import Study

MOST_SPEEDS = 101  # of those requested; to them come the peaks of every order in every element
STATED = "`misfire: worst` solves the train for every cylinder"
SAME_PEAK = 3e-3  # relative: nearer peaks stand for each other


def misfires(
    study: Study, response: Response, total: Synthesis, engine: EngineRecord
) -> list[MisfireFound]:
    """Return the engine with no cylinder motored, then each alone; total: the sum of all orders of the response.

    Empty where the motored torque is unknown or nothing excites.
    """
    if engine.gas is None or engine.gas.motored is None or not response.lines:
        return []
    # The requested speeds, thinned, the peaks, and the speeds with the largest sums.
    requested = np.flatnonzero(response.requested)
    count = min(len(requested), MOST_SPEEDS)
    thinned = requested[np.linspace(0, len(requested) - 1, count).round().astype(int)]
    size = np.nan_to_num(np.abs(response.torque))
    chosen = np.unique(np.append(thinned, size.sum(axis=1).argmax(axis=0))).tolist()
    for peak in np.unique(size.argmax(axis=0)).tolist():
        if np.abs(response.speed[chosen] / response.speed[peak] - 1.0).min() > SAME_PEAK:
            chosen.append(peak)
    speeds = np.sort(np.array(chosen, dtype=np.int64))
    half_range = _half_ranges(study, response, total, engine, speeds)
    # All speeds between the neighbours of that with the largest value of a case and span.
    largest = np.unique(np.nan_to_num(half_range, posinf=0.0).argmax(axis=1))
    first, last = (speeds[np.clip(largest + step, 0, len(speeds) - 1)] for step in (-1, 1))
    near = [np.arange(*ends) for ends in zip(first.tolist(), last.tolist(), strict=True)]
    added = np.setdiff1d(np.concatenate(near), speeds)
    added_half_range = _half_ranges(study, response, total, engine, added)
    half_range = np.concatenate([half_range, added_half_range], axis=1)
    speeds = np.append(speeds, added)
    order = np.argsort(speeds)
    return [
        MisfireFound(number, response.speed[speeds[order]], values[order])
        for number, values in enumerate(half_range)
    ]


def _half_ranges(
    study: Study, response: Response, total: Synthesis, engine: EngineRecord, speeds: IntArray
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
        is_changed = False
        for line, number, source in harmonics:
            law = source.cylinder
            state: State = "motored" if number == case else "firing"
            if law is None or (law.state == state and (law.share == 1.0 or state == "motored")):
                continue
            is_changed = True
            own_speed = speed * float(system.speed_ratio[source.station])
            mean = None if steady is None else steady.applied[law.station]
            changed = replace(law, state=state, share=1.0)
            change = changed.amplitude(own_speed, mean) - law.amplitude(own_speed, mean)
            torque[:, line] += change[:, None] * unit_torque[source.station, line]
        if not is_changed:
            half_ranges.append(total.half_range[speeds])
            continue
        mean_torque = response.mean[speeds]
        status = response.status[speeds]
        changed_response = replace(response, torque=torque, mean=mean_torque, status=status)
        half_ranges.append(synthesis(changed_response).half_range)
    return np.array(half_ranges)


MOST_MODES = 3  # of the sums of phasors: the lowest
VARYING = 4  # harmonics of the inertia that are considered


def run(work: Work) -> None:
    """Put the results of every engine."""
    with work.log.step("engines", "the train has one") as step:
        engines = tuple(
            _engine(work, part, part.engine)
            for part in work.study.train.parts
            if part.engine is not None
        )
        step.method = "harmonics by quadrature, sums of phasors, misfires by superposition"
        count = sum(len(engine.cylinders) for engine in engines)
        step.size = f"{len(engines)} with {count} cylinders"
        work.put(engines=Engines(engines))


def running_point(
    work: Work, part: Part, stations: Iterable[int]
) -> tuple[float | None, float | None]:
    """Return own speed (rad/s) at the rated, else at the highest speed, and mean torque (N m) that enters there.

    None for what the file does not say.
    """
    reference = work.study.operation.speed
    if reference is None:
        return None, None
    steady = steady_if_known(work.study, work.system, np.array([reference]))
    torque = None if steady is None else float(steady.applied[list(stations), 0].sum())
    return reference * abs(float(part.ratio)), torque


def _engine(work: Work, part: Part, engine: EngineRecord) -> EngineFound:
    speed, mean = running_point(work, part, dict(engine.drives))
    share = sum(share for _, share in engine.drives)
    balanced = gas_mean = None
    if mean is not None and share:
        balanced = mean / share
        gas_mean = balanced / len(engine.cylinders) / engine.efficiency
    # Only a gas torque of one load goes on at every load.
    law = engine.gas
    stated_torque = law.stated if law is not None and law.goes_on else None
    imep, stated = (
        None if torque is None or engine.cylinder is None else engine.cylinder.imep(torque)
        for torque in (gas_mean, stated_torque)
    )
    inertia = engine.inertia_over_angle[1 : VARYING + 1]
    orders = (np.arange(1, len(inertia) + 1) * engine.revolutions).tolist()
    inertias = [
        (cylinder.station, inertia * [cylinder.phasor(order) for order in orders])
        for cylinder in engine.cylinders
    ]
    return EngineFound(
        name=part.name,
        gas_words=engine.gas_words,
        speed=speed,
        mean_torque=mean,
        balanced_torque=balanced,
        gas_mean=gas_mean,
        imep=imep,
        stated=stated,
        efficiency=engine.efficiency,
        keeps_power=engine.keeps_power,
        cylinders=tuple(
            CylinderFound(
                cylinder.number,
                work.system.stations[cylinder.station].name,
                2.0 * math.pi * cylinder.revolutions * float(cylinder.cycle) + cylinder.phase,
                cylinder.state,
                cylinder.share if cylinder.state == "firing" else 0.0,
            )
            for cylinder in engine.cylinders
        ),
        harmonics=tuple(_harmonics(work, engine, speed or 0.0, gas_mean)),
        curves=tuple(_curves(engine)),
        inertia=float(engine.inertia_over_angle[0].real),
        inertia_harmonics=tuple(inertia.tolist()),
        varying=tuple(varying_inertia(work, inertias)),
        superposed=_misfires(work, engine),
        stress_modulus=engine.modulus,
        words=part.data_sheet,
        remarks=engine.remarks,
    )


def _harmonics(
    work: Work, engine: EngineRecord, speed: float, gas_mean: float | None
) -> Iterator[HarmonicFound]:
    """Yield the harmonics of a firing cylinder of the balanced engine, those that exist."""
    law, size = engine.gas, engine.cylinder
    load = None if gas_mean is None else np.array([gas_mean])
    numbers = [
        number
        for number in range(1, len(engine.inertia))
        if engine.inertia[number] or (law is not None and law.firing[:, number].any())
    ]
    phasors = np.array(
        [[cylinder.phasor(number) for cylinder in engine.cylinders] for number in numbers]
    )
    rigid = np.abs(phasors.sum(axis=1))
    modes = work.get(Modes)
    throws = [cylinder.station for cylinder in engine.cylinders]
    angles = [] if modes is None else [*modes.shape[throws, :MOST_MODES].T]
    by_mode = [np.abs(phasors @ (angle / np.abs(angle).max())) for angle in angles if angle.any()]
    for row, number in enumerate(numbers):
        at_point = number, load, np.array([speed])
        gas, motored = 0j, None
        if law is not None:
            gas = complex(law.harmonic(*at_point)[0])
            if law.motored is not None:
                motored = complex(law.harmonic(*at_point, state="motored")[0])
        masses = complex(engine.inertia[number]) * speed**2
        yield HarmonicFound(
            Fraction(number, engine.revolutions),
            gas,
            masses,
            motored,
            None if size is None else abs(gas + masses) / size.tangential,
            float(rigid[row]),
            tuple(float(sums[row]) for sums in by_mode),
        )


def _curves(engine: EngineRecord) -> Iterator[CurveFound]:
    for curve in engine.curves:
        tangential = np.zeros(len(curve.angle))
        if (size := engine.cylinder) is not None:
            lever = size.lever(curve.angle) / size.tangential
            tangential = (curve.pressure - curve.around) * lever
        pressures = curve.pressure, curve.motored, tangential
        yield CurveFound(curve.name, curve.angle, *pressures, curve.imep, curve.stated)


def varying_inertia(
    work: Work, cylinders: Sequence[tuple[int, ComplexArray]]
) -> Iterator[VaryingInertia]:
    """Yield every mode with the largest harmonic of its inertia over a revolution.

    cylinders: stations and (harmonics,) kg m2 of their inertia, phasors included. J_0 (1 + e cos k angle) is unstable
    about 2 w/k +- e/4 of that; with the damping ratio z of the mode it is stable for e < 4 z (first order in e).
    """
    modes = work.get(Modes)
    damped = work.get(DampedModes)
    inertia = np.array([harmonics for _, harmonics in cylinders]).T
    if modes is None or not inertia.any():
        return
    # The inertia of a mode is 1 kg m2: shapes are mass-normalised.
    square = modes.shape[[station for station, _ in cylinders]] ** 2
    ratios = () if damped is None else damped.damping_ratio.tolist()
    shares = np.abs(inertia @ square)
    for mode in range(min(modes.shape.shape[1], 2 * MOST_MODES)):
        harmonic = int(shares[:, mode].argmax()) + 1
        share = float(shares[harmonic - 1, mode])
        middle = 2.0 * 2.0 * math.pi * float(modes.frequency[mode]) / harmonic
        ends = middle * (1 - share / 4), middle * (1 + share / 4)
        ratio = ratios[mode] if len(ratios) > mode else None
        yield VaryingInertia(mode + 1, harmonic, share, *ends, ratio)


def _misfires(work: Work, engine: EngineRecord) -> Callable[[], Sequence[MisfireFound]]:
    """Return the function that computes the misfire of every cylinder in turn.

    It gives nothing without a response, and in all but the first of the runs of `misfire: worst`.
    """
    response, total = work.get(Response), work.get(Synthesis)
    name = work.study.train.parts[engine.part].name
    first = next(cylinder for cylinder in engine.cylinders if cylinder.state != "cut out")
    is_later_run = engine.tries_all and first.state != "motored"
    if response is None or total is None or len(engine.cylinders) == 1 or is_later_run:
        return tuple
    if work.study.case is not None and not engine.tries_all:
        work.log.without(
            f"misfire of each cylinder of {name} in addition to this case",
            f"the nominal case contains it; {STATED}, in a case `based_on` this one",
        )
        return tuple
    why = ""
    if response.balanced is not None or response.following is not None:
        why = "the train is not linear"
    elif response.by_magnitude:
        why = "phases of engines to each other are any"
    elif response.system.tables_over("mean torque"):
        why = "a misfire takes mean torque, and with it the stiffness of a coupling changes"
    if why:
        work.log.without(f"misfire of each cylinder of {name}", f"{why}; {STATED}")
        return tuple
    return partial(misfires, work.study, response, total, engine)


def engine_faults(study: Study) -> Iterator[Fault]:
    """Yield engines without a phase between them, and tables that do not cover the loads or speeds of the response."""
    engines = [(part, part.engine) for part in study.train.parts if part.engine is not None]
    lacking = [part for part, engine in engines if not engine.has_phase]
    for part in lacking[1:]:
        message = f"'{part.name}' and '{lacking[0].name}' have no `phase` between them"
        hint = "give the crank angle at which its first cylinder fires: `phase: 60 deg`"
        yield Fault(part.path, message, hint)
    by_chance = [part for part, engine in engines if engine.by_chance]
    is_transient = "transient" in study.analyses
    if by_chance and (is_transient or study.train.has_nonlinear_couplings):
        what = "a motion over time" if is_transient else "backlash, friction, stages or a clutch"
        message = f"`phase: worst` adds magnitudes, and {what} does not follow so"
        yield Fault((*by_chance[0].path, "phase"), message, "give the angle, in several cases")
    operation = study.operation
    if operation.speeds is None:
        return
    rated = [] if operation.rated is None else [operation.rated.speed]
    speed = np.append(operation.speeds.values(), rated)
    for part, engine in engines:
        law = engine.gas
        factor, unit = 30.0 / math.pi, "rpm"
        needed = speed * abs(float(part.ratio))
        if law is not None and law.over == "load" and study.has_mean_torque:
            station, of_mean = engine.load_says
            try:
                entering = power_balance(study.train, operation).applied(station, speed)
            except InputError:
                continue  # the mean torque is at fault, and reported as that
            needed = entering / float(study.train.stations[station].ratio) * of_mean
            factor, unit = 1.0, "N m of a cylinder"
            if engine.cylinder is not None:
                factor, unit = engine.cylinder.imep(1.0) * 1e-5, "`bar` imep"
        elif law is None or law.over != "speed":
            continue
        if not law.covers(needed):
            needs = f"{needed.min() * factor:.5g} to {needed.max() * factor:.5g}"
            covers = f"{law.at[0] * factor:.5g} to {law.at[-1] * factor:.5g} {unit}"
            message = f"the tables of '{part.name}' cover {covers}, the operation needs {needs}"
            hint = "add a table (`motored` rows are one of no load), or narrow the speeds; nothing is extrapolated"
            yield Fault((*part.path, "gas"), message, hint)
