"""What couplings and dampers with tables have at each mode, what the modes lose, and what takes no table."""

import math

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly.tabled_spans import WORDS
from torsion.errors import Fault
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Study

HINT = "give a `stiffness` at a frequency that you choose in its place"
WHAT = {"": "pendulum", "silicone": "silicone damper"}  # by the key that gives it; else a table


@reported
class Table:
    """A table of a coupling or damper, and the certificate that it leaves each mode one frequency."""

    coupling: str = result("name of the coupling or damper")
    over: str = result(
        "what the table is over: frequency, mean or vibratory torque of the coupling"
    )
    at: FloatArray = result("", "point", "its points, Hz or N m")
    stiffness: FloatArray = result(
        "N*m/rad", "point", "dynamic stiffness at each, at the coupling's own speed"
    )
    loss_factor: FloatArray = result("1", "point", "loss factor of hysteresis at each")
    viscous: FloatArray = result("N*m*s/rad", "point", "viscous damping at each")
    holds: bool = result("the values at its ends hold beyond them", key="holds_beyond")
    law: str | None = result("law that the points stand for; null: linear between them")
    steepest: float = result(
        "1",
        "largest d ln k/d ln x on any piece, of a law a bound on it; over frequency below 2: each mode has "
        "exactly one frequency",
    )
    is_complex: bool = False  # it holds at every complex s


@reported
class AtMode:
    """A coupling or damper with a table at one mode."""

    coupling: str = result("its name")
    mode: int = result("counted from 1")
    frequency: float = result("Hz", "natural frequency")
    stiffness: float = result(
        "N*m/rad", "dynamic stiffness at the mode, at the coupling's own speed"
    )
    loss_factor: float = result("1", "loss factor at the mode, of hysteresis and viscous damping")
    share: float = result("1", "share of the elastic energy of the mode", key="elastic_share")


@reported
class CouplingTables:
    """The couplings and dampers with tables."""

    tables: tuple[Table, ...] = result("tables as given")
    speed: float | None = result(
        "rad/s",
        "reference speed whose mean torque the modes take; null without a table over mean torque",
    )
    at_modes: tuple[AtMode, ...] = result("couplings and dampers at the modes")
    modal_loss_factor: FloatArray = result(
        "1",
        "mode",
        "sum over all couplings and shafts of share of the elastic energy times loss factor there",
    )


def run(work: Work) -> None:
    """Put the tables at the modes, each at its own stiffness, where modes were computed."""
    modes = work.get(Modes)
    if modes is None:
        work.log.without("couplings by table at the modes", "no modes")
        return
    system = modes.system
    w = 2.0 * math.pi * modes.frequency

    def stiffness_and_loss(span: int) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and loss factor eta + w c/k (modes,) of an elastic span."""
        stiffness, loss = (np.broadcast_to(values, w.shape) for values in system.elastic(span, w))
        return stiffness, loss / stiffness

    is_lossy = (system.loss_factor > 0) | (system.viscous > 0)
    is_lossy[list(system.tables)] = True
    is_elastic = np.isfinite(system.flexibility) & (system.flexibility > 0.0)
    modal = np.zeros(len(w))
    for span in np.flatnonzero(is_lossy & is_elastic).tolist():
        modal += modes.elastic[span] * stiffness_and_loss(span)[1]

    tables = []
    at_modes = []
    for span, table in sorted(system.tables.items()):
        if table.over == "speed":
            continue  # of a pendulum, which has results of its own
        name = system.spans[span].name
        points = np.array(table.printed or table.at)
        values = points / WORDS[table.over][1], *table.values(points)
        traits = table.holds, table.words or None, table.steepest, table.is_complex
        tables.append(Table(name, table.over, *values, *traits))
        columns = modes.frequency, *stiffness_and_loss(span), modes.elastic[span]
        rows = np.transpose(columns).tolist()
        at_modes += [AtMode(name, mode, *row) for mode, row in enumerate(rows, 1)]
    # The reference speed at which mean torque was taken.
    speed = work.study.operation.speed if system.tables_over("mean torque") else None
    result = CouplingTables(tuple(tables), speed, tuple(at_modes), modal)
    work.put(coupling_tables=result)


def table_faults(study: Study) -> list[Fault]:
    """Return what a train with tables has no answer for, at the first table of its kind; and what it lacks."""
    train = study.train
    operation = study.operation
    tabled = [
        (spring, spring.table) for spring in reversed(train.springs) if spring.table is not None
    ]
    if not tabled:
        return []
    paths = {
        table.over: (*train.parts[spring.part].path, *([table.key] if table.key else []))
        for spring, table in tabled
    }
    path = min(paths.values(), key=len)
    what = WHAT.get(tabled[-1][1].key, "table")
    faults = []
    links = (spring for spring in train.springs if not train.parts[spring.part].is_point)
    method = study.setting("analyses", "response", "method")
    is_transient = "transient" in study.analyses
    by_vibration = "vibratory torque"
    supports = "only a response over speed supports a stiffness that follows the vibratory torque"
    lacks_torque = not study.has_mean_torque or operation.speed is None
    for over, is_fault, message, hint in (
        # Of a table over anything.
        (
            "",
            train.has_loops and any(spring.table for spring in links),
            f"a train with closed loops does not support a {what}",
            HINT,
        ),
        (
            "",
            train.modal_damping,
            f"damping by mode is a sum over modes of one stiffness, and a {what} has many",
            HINT,
        ),
        (
            "",
            train.has_nonlinear_couplings,
            f"the exact motion of couplings with backlash, friction or stages does not support a {what}",
            HINT,
        ),
        (
            "",
            method == "harmonic-balance",
            f"the exact periodic response does not support a {what}",
            HINT,
        ),
        ("", "stability" in study.analyses, f"stability takes no {what}", HINT),
        ("", "check" in study.analyses, f"the comparison of the models takes no {what}", HINT),
        (
            "frequency",
            is_transient,
            "the transient response does not support a stiffness that follows the frequency",
            HINT,
        ),
        (
            "speed",
            is_transient,
            "the transient response does not support a pendulum, which is linear only about one speed",
            "leave the pendulum out of the case with `transient`",
        ),
        (
            "speed",
            operation.speed is None,
            "the frequencies of a train with a pendulum follow the speed",
            "for example `operation: {speeds: {from: 600 rpm, to: 1800 rpm}}`",
        ),
        (by_vibration, is_transient, f"motion over time: {supports}", HINT),
        (by_vibration, study.has_joints, f"joints: {supports}", HINT),
        (
            "mean torque",
            lacks_torque,
            "a stiffness over mean torque needs the mean torque, which is not known",
            "for example `operation: {rated: {speed: 1500 rpm, power: 100 kW}}`",
        ),
        (
            "mean torque",
            study.has_joints,
            "joints are placed by the mean twist of the train, which a stiffness over mean torque changes",
            HINT,
        ),
    ):
        if is_fault and (not over or over in paths):
            faults.append(Fault(paths.get(over, path), message, hint))
    return faults
