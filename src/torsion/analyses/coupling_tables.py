"""What couplings with tables have at each mode, what the modes lose in the train, and what takes no table."""

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

HINT = "give the coupling a `stiffness` at a frequency that you choose"


@reported
class Table:
    """A table of a coupling, and the certificate that it leaves each mode one frequency."""

    coupling: str = result("", (), "its name")
    over: str = result("", (), "what the table is over: frequency, mean or vibratory torque of the coupling")
    at: FloatArray = result("", ("point",), "its points, Hz or N m")
    stiffness: FloatArray = result("N*m/rad", ("point",), "dynamic stiffness at each, at the coupling's own speed")
    loss_factor: FloatArray = result("1", ("point",), "loss factor of hysteresis at each")
    viscous: FloatArray = result("N*m*s/rad", ("point",), "viscous damping at each")
    holds: bool = result("", (), "the values at its ends hold beyond them", key="holds_beyond")
    steepest: float = result(
        "1", (), "largest d ln k/d ln x on any piece, of a law a bound on it; over frequency below 2: each mode has "
        "exactly one frequency"
    )  # fmt: skip
    law: str = result("", (), "table, or prony or fractional: the points are then samples of that law")
    words: str  # the law with its figures; empty of a table


@reported
class AtMode:
    """A coupling with a table at one mode."""

    coupling: str = result("", (), "its name")
    mode: int = result("", (), "counted from 1")
    frequency: float = result("Hz", (), "natural frequency")
    stiffness: float = result("N*m/rad", (), "dynamic stiffness at the mode, at the coupling's own speed")
    loss_factor: float = result("1", (), "loss factor at the mode, of hysteresis and viscous damping")
    share: float = result("1", (), "share of the elastic energy of the mode", key="elastic_share")


@reported
class CouplingTables:
    """The couplings with tables."""

    tables: tuple[Table, ...] = result("", (), "tables as given")
    speed: float | None = result(
        "rad/s", (), "reference speed whose mean torque the modes take; null without a table over mean torque"
    )
    at_modes: tuple[AtMode, ...] = result("", (), "couplings at the modes")
    modal_loss_factor: FloatArray = result(
        "1", ("mode",), "sum over all couplings and shafts of share of the elastic energy times loss factor there"
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
        name, size = system.spans[span].name, WORDS[table.over][1]
        at, stiffness, eta, viscous = map(np.array, (table.at, table.stiffness, table.loss_factor, table.viscous))
        values = at / size, stiffness, eta, viscous, table.holds, table.steepest
        tables.append(Table(name, table.over, *values, table.key, table.words))
        k, lost = np.broadcast_to(system.elastic(span, w)[0], w.shape), loss_factors(system, span, w)
        each = zip(modes.frequency.tolist(), k.tolist(), lost.tolist(), modes.elastic[span].tolist(), strict=True)
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
    """Raise InputError where a coupling by table stands in a train with closed loops, or grounded at several points."""
    if system.tables and system.condensed.extra.size:
        path = table_path(system, min(system.tables))
        message = "a train with closed loops, or grounded behind rigid spans at several points, takes no table"
        raise InputError([Fault(path, message, HINT)])


def table_faults(study: Study) -> list[Fault]:
    """What a train with tables has no answer for, at the first table of its kind; and a mean torque that lacks."""
    train = study.train
    paths = {
        spring.table.over: (*train.parts[spring.part].path, spring.table.key)
        for spring in reversed(train.springs) if spring.table is not None
    }  # fmt: skip
    if not paths:
        return []
    every = [Fault(min(paths.values(), key=len), why, HINT) for why in _without_table(study)]
    if "frequency" in paths and "transient" in study.analyses:
        message = "motion over time has no stiffness that follows the frequency"
        every.append(Fault(paths["frequency"], message, HINT))
    if "vibratory torque" in paths:
        path = paths["vibratory torque"]
        for what, is_there in (("motion over time", "transient" in study.analyses), ("joints", study.has_joints)):
            if is_there:
                message = f"{what}: a stiffness that follows the vibratory torque is of a response over speed alone"
                every.append(Fault(path, message, HINT))
    if "mean torque" in paths:
        path, operation = paths["mean torque"], study.operation
        if not operation.has_mean_torque or operation.speed is None:
            hint = "for example `operation: {rated: {speed: 1500 rpm, power: 100 kW}}`"
            every.append(Fault(path, "a stiffness over mean torque needs the mean torque, which is not known", hint))
        if study.has_joints:
            message = "joints are placed by the mean twist of the train, which a stiffness over mean torque changes"
            every.append(Fault(path, message, HINT))
    return every


def _without_table(study: Study) -> Iterator[str]:
    """Why a table of any kind does not go with the rest of the file."""
    if study.train.has_loops:
        yield "a train with closed loops takes no table"
    if study.train.modal_damping:
        yield "damping by mode is a sum over modes of one stiffness, and a table has many"
    if study.train.has_nonlinear_couplings:
        yield "the exact motion of couplings with play, friction or stages takes no table beside them"
    if study.setting("analyses", "response", "method") == "harmonic-balance":
        yield "the exact periodic response takes no table"
    for name, what in (("stability", "stability takes"), ("check", "the comparison of the models takes")):
        if name in study.analyses:
            yield f"{what} no table"
