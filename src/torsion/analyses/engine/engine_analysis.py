"""Engines of the train: harmonics at the rated speed, sums of phasors by mode, varying inertia, misfires; faults."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
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
from torsion.analyses.engine.misfires import STATED, misfires, without_answer
from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import ComplexArray, FloatArray
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.model.engine.record import EngineRecord
from torsion.model.lowering import Part
from torsion.study import Study

MOST_MODES = 3  # of the sums of phasors: the lowest
VARYING = 4  # harmonics of the inertia that are looked at


@dataclass(frozen=True)
class Running:
    """An engine at one speed; N m, None where the load is not known."""

    speed: float  # rad/s, own
    applied: float | None  # mean torque of the station that says the load
    mean: float | None  # of the whole engine as it runs


def run(work: Work) -> None:
    """Every engine."""
    with work.log.step("engines", "the train has one") as step:
        found = tuple(
            _engine(work, part, part.engine)
            for part in work.study.train.parts
            if part.engine is not None
        )
        step.method = "harmonics by quadrature, sums of phasors, misfires by superposition"
        step.size = f"{len(found)} with {sum(len(one.cylinders) for one in found)} cylinders"
        work.put(engines=Engines(found))


def _engine(work: Work, part: Part, engine: EngineRecord) -> EngineFound:
    running = _running(work, part, engine)
    share = sum(own for _, own in engine.drives)
    balanced = (
        None if running is None or running.mean is None or not share else running.mean / share
    )
    gas_mean = None if balanced is None else balanced / len(engine.cylinders) / engine.efficiency
    size, law = engine.cylinder, engine.gas
    at_one = law is not None and law.goes_on  # load
    stated = (
        None
        if size is None or law is None or law.stated is None or not at_one
        else size.imep(law.stated)
    )
    return EngineFound(
        name=part.name,
        gas_words=engine.gas_words,
        speed=None if running is None else running.speed,
        mean_torque=None if running is None else running.mean,
        balanced_torque=balanced,
        gas_mean=gas_mean,
        imep=None if size is None or gas_mean is None else size.imep(gas_mean),
        stated=stated,
        efficiency=engine.efficiency,
        keeps_power=engine.keeps_power,
        cylinders=tuple(
            CylinderFound(
                one.number,
                work.system.stations[one.station].name,
                one.firing,
                one.state,
                one.share if one.state == "firing" else 0.0,
            )
            for one in engine.cylinders
        ),
        harmonics=tuple(_harmonics(work, engine, running, gas_mean)),
        curves=tuple(_curves(engine)),
        inertia=float(engine.inertia_over_angle[0].real),
        inertia_harmonics=tuple(engine.inertia_over_angle[1 : VARYING + 1].tolist()),
        varying=tuple(_varying(work, engine)),
        superposed=_misfires(work, engine),
        stress_modulus=engine.modulus,
        words=engine.words,
        remarks=engine.remarks,
    )


def _running(work: Work, part: Part, engine: EngineRecord) -> Running | None:
    """At the rated speed, else the highest; None where no speed is given."""
    speed = work.study.operation.speed
    if speed is None:
        return None
    own = speed * abs(float(part.ratio))
    steady = steady_if_known(work.study, work.system, np.array([speed]))
    if steady is None:
        return Running(own, None, None)
    applied = steady.applied[:, 0]
    return Running(own, None, float(sum(applied[station] for station in dict(engine.drives))))


def _harmonics(
    work: Work, engine: EngineRecord, running: Running | None, gas_mean: float | None
) -> Iterator[HarmonicFound]:
    """Those that are there, of a firing cylinder in balance."""
    speed = np.array([0.0 if running is None else running.speed])
    load = None if gas_mean is None else np.array([gas_mean])
    law, size = engine.gas, engine.cylinder
    numbers = [k for k in range(1, len(engine.inertia)) if _is_there(engine, k)]
    phasors = np.array([[one.phasor(number) for one in engine.cylinders] for number in numbers])
    rigid = np.abs(phasors.sum(axis=1))
    modes = [np.abs(phasors @ shape) for shape in _shapes(work, engine)]
    for place, number in enumerate(numbers):
        gas = 0j if law is None else complex(law.harmonic(number, load, speed)[0])
        known = law is not None and law.motored is not None
        motored = (
            complex(law.harmonic(number, load, speed, state="motored")[0])
            if law is not None and known
            else None
        )
        masses = complex(engine.inertia[number]) * float(speed[0]) ** 2
        tangential = None if size is None else abs(gas + masses) / size.tangential
        yield HarmonicFound(
            Fraction(number, engine.revolutions),
            gas,
            masses,
            motored,
            tangential,
            float(rigid[place]),
            tuple(float(mode[place]) for mode in modes),
        )


def _is_there(engine: EngineRecord, number: int) -> bool:
    return bool(
        engine.inertia[number] or (engine.gas is not None and engine.gas.firing[:, number].any())
    )


def _shapes(work: Work, engine: EngineRecord) -> list[FloatArray]:
    """Of the lowest modes the angle at the throw of every cylinder, relative to the largest of these."""
    modes = work.get(Modes)
    if modes is None:
        return []
    stations = [one.station for one in engine.cylinders]
    angle = modes.shape[stations, :MOST_MODES]
    largest = np.abs(angle).max(axis=0)
    return [angle[:, k] / largest[k] for k in range(angle.shape[1]) if largest[k] > 0]


def _curves(engine: EngineRecord) -> Iterator[CurveFound]:
    for curve in engine.curves:
        size = engine.cylinder
        lever = (
            np.zeros(len(curve.angle))
            if size is None
            else size.lever(curve.angle) / size.tangential
        )
        tangential = (curve.pressure - curve.around) * lever
        yield CurveFound(
            curve.name,
            curve.angle,
            curve.pressure,
            curve.motored,
            tangential,
            curve.imep,
            curve.stated,
        )


def _varying(work: Work, engine: EngineRecord) -> Iterator[VaryingInertia]:
    """Of all cylinders alike."""
    numbers = range(1, min(VARYING, len(engine.inertia_over_angle) - 1) + 1)
    over = engine.inertia_over_angle[1 : len(numbers) + 1]
    return varying_inertia(
        work,
        [
            (one.station, over * np.array([one.phasor(k * engine.revolutions) for k in numbers]))
            for one in engine.cylinders
        ],
    )


def varying_inertia(
    work: Work, cylinders: Sequence[tuple[int, ComplexArray]]
) -> Iterator[VaryingInertia]:
    """Of cylinders with their stations and (harmonics,) kg m2 of their inertia over a revolution, phasors included.

    Of every mode with its largest harmonic: J_0 (1 + e cos k angle) is unstable about 2 w/k +- e/4 of that.

    With the damping ratio z of the mode it is stable for e < 4 z (first order in e; an estimate).
    """
    modes, damped = work.get(Modes), work.get(DampedModes)
    over = np.array([own for _, own in cylinders]).T
    if modes is None or not over.any():
        return
    square = (
        modes.shape[[station for station, _ in cylinders]] ** 2
    )  # of 1 kg m2 of the mode: mass-normalised
    found = np.abs(over @ square)
    for mode in range(min(modes.shape.shape[1], 2 * MOST_MODES)):
        best = int(found[:, mode].argmax())
        share = float(found[best, mode])
        middle = 2.0 * 2.0 * math.pi * float(modes.frequency[mode]) / (best + 1)
        same = damped is not None and len(damped.damping_ratio) > mode
        ratio = float(damped.damping_ratio[mode]) if damped is not None and same else None
        yield VaryingInertia(
            mode + 1, best + 1, share, middle * (1 - share / 4), middle * (1 + share / 4), ratio
        )


def _misfires(work: Work, engine: EngineRecord) -> Callable[[], Sequence[MisfireFound]]:
    """What finds every cylinder in turn.

    It finds nothing without a response, and in all but the first of the runs of `misfire: worst`.
    """
    response = work.get(Response)
    if engine.tries_all and next(
        one.number for one in engine.cylinders if one.state != "cut out"
    ) not in (one.number for one in engine.cylinders if one.state == "motored"):
        return tuple
    if response is None or len(engine.cylinders) == 1:
        return tuple
    if work.study.case is not None and not engine.tries_all:
        what = f"misfire of each cylinder of {work.study.train.parts[engine.part].name} in addition to this case"
        work.log.without(
            what, f"the nominal case contains it; {STATED}, in a case `based_on` this one"
        )
        return tuple
    if why := without_answer(response):
        work.log.without(
            f"misfire of each cylinder of {work.study.train.parts[engine.part].name}", why
        )
    return partial(misfires, work.study, response, engine)


def engine_faults(study: Study) -> Iterator[Fault]:
    """Engines without a phase between them, and tables that do not cover the loads or speeds of the response."""
    parts = [part for part in study.train.parts if part.engine is not None]
    lacking = [part for part in parts if part.engine is not None and not part.engine.has_phase]
    for part in lacking[1:]:
        message = f"'{part.name}' and '{lacking[0].name}' have no `phase` between them"
        yield Fault(
            part.path,
            message,
            "give the crank angle at which its first cylinder fires: `phase: 60 deg`",
        )
    chance = [part for part in parts if part.engine is not None and part.engine.by_chance]
    if chance and (study.train.has_nonlinear_couplings or "transient" in study.analyses):
        what = (
            "a motion over time"
            if "transient" in study.analyses
            else "backlash, friction, stages or a clutch"
        )
        message = f"`phase: worst` adds magnitudes, and {what} does not follow so"
        yield Fault((*chance[0].path, "phase"), message, "give the angle, in several cases")
    for part in parts:
        if part.engine is not None:
            yield from _uncovered(study, part, part.engine)


def _uncovered(study: Study, part: Part, engine: EngineRecord) -> Iterator[Fault]:
    """The gas torque is not known at some load or speed."""
    law, operation = engine.gas, study.operation
    if law is None or operation.speeds is None:
        return
    rated = [] if operation.rated is None else [operation.rated.speed]
    speed = np.append(operation.speeds.values(), rated)
    if law.over == "speed":
        own = speed * abs(float(part.ratio))
        if not law.covers(own):
            yield _beyond(part, own * 30.0 / math.pi, law.at * 30.0 / math.pi, "rpm")
    elif law.over == "load" and study.has_mean_torque:
        station, of_mean = engine.load_says
        try:
            entering = power_balance(study.train, operation).applied(station, speed)
            each = entering / float(study.train.stations[station].ratio) * of_mean
        except InputError:
            return  # the mean torque is at fault, and reported as that
        if not law.covers(each):
            unit = 1.0 if engine.cylinder is None else engine.cylinder.imep(1.0) * 1e-5
            yield _beyond(
                part,
                unit * each,
                unit * law.at,
                "N m of a cylinder" if engine.cylinder is None else "`bar` imep",
            )


def _beyond(part: Part, wanted: FloatArray, known: FloatArray, unit: str) -> Fault:
    covers = f"cover {known[0]:.5g} to {known[-1]:.5g} {unit}"
    message = f"the tables of '{part.name}' {covers}, the operation needs {wanted.min():.5g} to {wanted.max():.5g}"
    hint = "add a table (`motored` rows are one of no load), or narrow the speeds; nothing is extrapolated"
    return Fault((*part.path, "gas"), message, hint)
