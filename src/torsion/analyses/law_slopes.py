"""Slopes of the laws of load and drive: what their mean torques answer to a change of the mean speed.

A slope is -dT/dω of a drive and +dT/dω of a load, at own speed; a positive one damps.
"""

import numpy as np

from torsion.analyses.power_balance import interpolated, power_balance, uncovered
from torsion.analyses.steady import driven_by_law, rated_point, slopes_of_laws
from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.study import Study

SAME_TORQUE = 0.01  # relative: what the table of a drive may miss of the balance at the rated speed


def rows_of_tables(study: Study) -> FloatArray:
    """Return (rows,) rad/s of the reference, ascending: where tables of loads and drives bend; empty without mean torque."""
    if not study.has_mean_torque:
        return np.empty(0)
    rows = power_balance(study.train, study.operation).corners
    for part, law in driven_by_law(study.train):
        rows += [speed / abs(float(part.ratio)) for speed, _ in law.torque or ()]
    return np.unique(rows)


def mean_speed_slopes(study: Study) -> dict[str, str]:
    """Return who drives or absorbs by a slope that acts on the mean speed alone, each with the key that it lacks."""
    lacking = {
        part.name: "lag"
        for part, law in driven_by_law(study.train)
        if law.law is None and law.lag is None
    }
    if not study.has_mean_torque:
        return lacking
    damped = {damper.station for damper in study.train.dampers}
    for load in power_balance(study.train, study.operation).loads:
        has_slope = load.law.exponent != 0
        if load.law.table:
            has_slope = len({torque for _, torque in load.law.table}) > 1
        for station, _ in load.stations:
            if has_slope and station not in damped:
                part = study.train.parts[study.train.stations[station].part]
                lacking[part.name] = "damping: law"
    return lacking


def drive_faults(study: Study) -> list[Fault]:
    """Return why a law of drive contradicts the speeds and the balance of power of the file."""
    faults = list[Fault]()
    operation = study.operation
    if not study.has_mean_torque:
        message = "the law of a drive needs the mean torque"
        hint = "give the rated power, or the power of the loads"
        return [
            Fault((*part.path, "drive"), message, hint)
            for part, law in driven_by_law(study.train)
            if not law.law
        ]
    try:
        balance = power_balance(study.train, operation)
    except InputError:  # which the faults of the power report
        return []
    for part, law in driven_by_law(study.train):
        try:
            _, torque = rated_point(part, operation, balance)
        except InputError as error:
            faults += error.faults
            continue
        kloss = law.rated_torque()
        if law.torque is not None:
            about = Fault(
                (*part.path, "drive", "torque"), f"the table of the drive of '{part.name}'"
            )
            ratio = abs(float(part.ratio))
            points = np.array([] if operation.rated is None else [operation.rated.speed])
            if operation.speeds is not None:
                points = np.append(points, [operation.speeds.first, operation.speeds.last])
            lacking = uncovered(law.torque, points * ratio, about)
            faults += lacking
            if lacking or operation.rated is None:
                continue
            needed = float(balance.applied(part.stations[0], points[:1])[0]) / ratio
            given = float(interpolated(law.torque, points[:1] * ratio, about)[0])
            if abs(given - needed) > SAME_TORQUE * abs(needed):
                message = f"{about.message} gives {given:.6g} N m at the rated speed"
                hint = "correct the table or the loads; they have to agree within 1 %"
                message += f", the loads take {needed:.6g} N m"
                faults.append(Fault(about.path, message, hint))
        elif kloss is not None and abs(kloss - torque) > SAME_TORQUE * abs(torque):
            message = f"the law of the drive of '{part.name}' gives {kloss:.6g} N m at its slip at the rated speed"
            message += f", the loads take {torque:.6g} N m"
            hint = "correct slip, pull-out torque or the loads; they have to agree within 1 %"
            faults.append(Fault((*part.path, "drive", "slip"), message, hint))
    if study.setting("analyses", "transient") is None:
        return faults
    for part, law in driven_by_law(study.train):
        if law.law != "torque":
            message = f"the `drive` of '{part.name}' follows the mean speed and does not act in a transient response"
            hint = "an event `start` with its torque over speed follows the vibration too; else leave `drive` out"
            faults.append(Fault((*part.path, "drive"), message, hint))
    return faults


def run(work: Work) -> None:
    """Note every machine whose stated law has a slope that does not act in vibration, with it and the key it lacks."""
    study, operation = work.study, work.study.operation
    if work.results.get("mean") is None or operation.speed is None:
        return
    lacking = mean_speed_slopes(study)
    balance = power_balance(study.train, operation)
    speed = np.array([operation.speed])
    ratio = np.array([float(station.ratio) for station in study.train.stations])
    loads, drives = slopes_of_laws(study.train, operation, balance, ratio, speed)
    for part in study.train.parts:
        is_stated = part.machine and (part.machine.drive or part.machine.load)
        if not is_stated or part.name not in lacking:
            continue
        if slope := float((loads + drives)[part.stations[0], 0]):
            why = f"its {slope:.6g} N m s/rad act on the mean speed alone"
            why += f"; `{lacking[part.name]}` lets it damp vibration too"
            work.log.without(f"slope of '{part.name}' in vibration", why)
