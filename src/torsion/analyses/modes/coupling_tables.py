"""What couplings and dampers with tables have at each mode, what the modes lose, and what takes no table."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import WORDS, table_path
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Study

HINT = "give a `stiffness` at a frequency that you choose in its place"
WHAT = {"": "pendulum", "silicone": "silicone damper"}  # by the key that gives it; else a table


@reported
class Table:
    """A table of a coupling or damper, and the certificate that it leaves each mode one frequency."""

    coupling: str = result("", (), "name of the coupling or damper")
    over: str = result(
        "", (), "what the table is over: frequency, mean or vibratory torque of the coupling"
    )
    at: FloatArray = result("", ("point",), "its points, Hz or N m")
    stiffness: FloatArray = result(
        "N*m/rad", ("point",), "dynamic stiffness at each, at the coupling's own speed"
    )
    loss_factor: FloatArray = result("1", ("point",), "loss factor of hysteresis at each")
    viscous: FloatArray = result("N*m*s/rad", ("point",), "viscous damping at each")
    holds: bool = result("", (), "the values at its ends hold beyond them", key="holds_beyond")
    law: str | None = result("", (), "law that the points stand for; null: linear between them")
    steepest: float = result(
        "1",
        (),
        "largest d ln k/d ln x on any piece, of a law a bound on it; over frequency below 2: each mode has "
        "exactly one frequency",
    )
    is_complex: bool = False  # it holds at every complex s


@reported
class AtMode:
    """A coupling or damper with a table at one mode."""

    coupling: str = result("", (), "its name")
    mode: int = result("", (), "counted from 1")
    frequency: float = result("Hz", (), "natural frequency")
    stiffness: float = result(
        "N*m/rad", (), "dynamic stiffness at the mode, at the coupling's own speed"
    )
    loss_factor: float = result(
        "1", (), "loss factor at the mode, of hysteresis and viscous damping"
    )
    share: float = result("1", (), "share of the elastic energy of the mode", key="elastic_share")


@reported
class CouplingTables:
    """The couplings and dampers with tables."""

    tables: tuple[Table, ...] = result("", (), "tables as given")
    speed: float | None = result(
        "rad/s",
        (),
        "reference speed whose mean torque the modes take; null without a table over mean torque",
    )
    at_modes: tuple[AtMode, ...] = result("", (), "couplings and dampers at the modes")
    modal_loss_factor: FloatArray = result(
        "1",
        ("mode",),
        "sum over all couplings and shafts of share of the elastic energy times loss factor there",
    )


def loss_factors(system: System, span: int, w: FloatArray) -> FloatArray:
    """(modes,) eta + w c/k of a span at circular frequencies w (rad/s); 0 of a rigid one."""
    if not 0.0 < system.flexibility[span] < math.inf:
        return np.zeros(len(w))
    k, loss = system.elastic(span, w)
    return np.asarray(loss / k)


def coupling_tables(modes: Modes, speed: float | None) -> CouplingTables:
    """Of the modes found, each at its own stiffness; speed: rad/s at which mean torque was taken."""
    system, w = modes.system, 2.0 * math.pi * modes.frequency
    lossy = np.flatnonzero((system.loss_factor > 0) | (system.viscous > 0)).tolist()
    total = np.zeros(len(w))
    for span in {*lossy, *system.tables}:
        total += modes.elastic[span] * loss_factors(system, span, w)
    tables, rows = [], []
    for span, table in sorted(system.tables.items()):
        if table.over == "speed":
            continue  # of a pendulum, which has results of its own
        name, at = system.spans[span].name, np.array(table.points)
        printed = at / WORDS[table.over][1], *table.values(at)
        tables.append(
            Table(
                name,
                table.over,
                *printed,
                table.holds,
                table.words or None,
                table.steepest,
                table.is_complex,
            )
        )
        k, lost = (
            np.broadcast_to(system.elastic(span, w)[0], w.shape),
            loss_factors(system, span, w),
        )
        each = zip(
            modes.frequency.tolist(),
            k.tolist(),
            lost.tolist(),
            modes.elastic[span].tolist(),
            strict=True,
        )
        rows += [AtMode(name, mode, *values) for mode, values in enumerate(each, 1)]
    by_torque = any(table.over == "mean torque" for table in system.tables.values())
    return CouplingTables(tuple(tables), speed if by_torque else None, tuple(rows), total)


def run(work: Work) -> None:
    """Where modes were found."""
    modes = work.get(Modes)
    if modes is None:
        work.log.without("couplings by table at the modes", "no modes")
        return
    work.put(coupling_tables=coupling_tables(modes, work.study.operation.speed))


def refuse_loops(system: System) -> None:
    """Raise InputError where a coupling by table stands in a train with closed loops, or grounded at several points.

    Rings of dampers and pendulums close no loop.
    """
    links = [
        span for span in system.tables if not system.train.parts[system.spans[span].part].is_point
    ]
    if links and system.condensed.extra.size:
        path = table_path(system, min(links))
        message = "a train with closed loops, or grounded through rigid spans at several points, does not support a table"
        raise InputError([Fault(path, message, HINT)])


def table_faults(study: Study) -> list[Fault]:
    """What a train with tables has no answer for, at the first table of its kind; and what it lacks."""
    train, operation = study.train, study.operation
    tabled = [
        (spring, spring.table) for spring in reversed(train.springs) if spring.table is not None
    ]
    if not tabled:
        return []
    paths = {
        table.over: (*train.parts[spring.part].path, *([table.key] if table.key else []))
        for spring, table in tabled
    }
    path, what = min(paths.values(), key=len), WHAT.get(tabled[-1][1].key, "table")
    every = [Fault(path, why, HINT) for why in _without_table(study, what)]
    if "frequency" in paths and "transient" in study.analyses:
        message = "the transient response does not support a stiffness that follows the frequency"
        every.append(Fault(paths["frequency"], message, HINT))
    if "speed" in paths and "transient" in study.analyses:
        message = "the transient response does not support a pendulum, which is linear only about one speed"
        every.append(
            Fault(paths["speed"], message, "leave the pendulum out of the case with `transient`")
        )
    if "speed" in paths and operation.speed is None:
        hint = "for example `operation: {speeds: {from: 600 rpm, to: 1800 rpm}}`"
        every.append(
            Fault(
                paths["speed"], "the frequencies of a train with a pendulum follow the speed", hint
            )
        )
    if "vibratory torque" in paths:
        path = paths["vibratory torque"]
        for what, is_there in (
            ("motion over time", "transient" in study.analyses),
            ("joints", study.has_joints),
        ):
            if is_there:
                message = f"{what}: only a response over speed supports a stiffness that follows the vibratory torque"
                every.append(Fault(path, message, HINT))
    if "mean torque" in paths:
        path = paths["mean torque"]
        if not study.has_mean_torque or operation.speed is None:
            hint = "for example `operation: {rated: {speed: 1500 rpm, power: 100 kW}}`"
            every.append(
                Fault(
                    path,
                    "a stiffness over mean torque needs the mean torque, which is not known",
                    hint,
                )
            )
        if study.has_joints:
            message = "joints are placed by the mean twist of the train, which a stiffness over mean torque changes"
            every.append(Fault(path, message, HINT))
    return every


def _without_table(study: Study, what: str) -> Iterator[str]:
    """Why a table of any kind does not go with the rest of the file."""
    parts = study.train.parts
    if study.train.has_loops and any(
        not parts[one.part].is_point for one in study.train.springs if one.table
    ):
        yield f"a train with closed loops does not support a {what}"
    if study.train.modal_damping:
        yield f"damping by mode is a sum over modes of one stiffness, and a {what} has many"
    if study.train.has_nonlinear_couplings:
        yield f"the exact motion of couplings with backlash, friction or stages does not support a {what}"
    if study.setting("analyses", "response", "method") == "harmonic-balance":
        yield f"the exact periodic response does not support a {what}"
    for name, takes in (
        ("stability", "stability takes"),
        ("check", "the comparison of the models takes"),
    ):
        if name in study.analyses:
            yield f"{takes} no {what}"
