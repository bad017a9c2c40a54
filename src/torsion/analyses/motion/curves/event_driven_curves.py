"""Torques and speeds of a train with nonlinear couplings over time, and what its couplings did."""

from collections import Counter

import numpy as np

from torsion.analyses.motion.curves.torque_curves import Curves
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.train.built_train import build
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Path
from torsion.findings import Progress, silent
from torsion.kernels.motion.collocation import Marched
from torsion.kernels.motion.energy_balance import EnergyBalance, energy_balance
from torsion.results import reported, result
from torsion.study import Study

TOLERANCE = 1e-6  # of the peak of a span: two runs that differ by more are not the same motion
COMPARED = 2000  # times at which they are compared


@reported
class CouplingEvent:
    """A coupling passed from one regime to another."""

    time: float = result("s", (), "when")
    coupling: str = result("", (), "which")
    what: str = result("", (), "contact, separation, slip, stuck or open")


@reported
class CouplingWork:
    """What a nonlinear coupling did in the whole motion."""

    coupling: str = result("", (), "which")
    contacts: int = result("", (), "how often its faces met")
    separations: int = result("", (), "how often they parted")
    slips: int = result("", (), "how often it began to slip")
    heat: float = result("J", (), "heat of its friction and of the damping of its contact")


@reported
class Switching:
    """The events of a motion between the regimes of nonlinear couplings."""

    events: tuple[CouplingEvent, ...] = result(
        "", (), "every change of a regime, in the order of time"
    )
    couplings: tuple[CouplingWork, ...] = result("", (), "what every nonlinear coupling did")
    work: float = result("J", (), "work of all torques on the motion")
    damped: float = result("J", (), "energy that the damping of the linear train took")
    sensitive_after: float | None = result(
        "s",
        (),
        "time from which halved steps change a torque by more than 1e-6 of its peak: read statistics "
        "there, not single values; null if this never happens",
    )
    band_change: float = result(
        "1",
        (),
        "change of the torques, relative to their peak, with twice the band of modes; 0: all modes are included",
    )
    scatter: FloatArray | None = result(
        "N*m",
        ("span",),
        "difference of the maximum torque with halved steps, if the motion is sensitive. Maximum "
        "and minimum torques are over both step sizes, and verdicts add the difference",
        default=None,
    )


def event_driven_curves(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    damping_ratio: float | None = None,
    progress: Progress = silent,
) -> tuple[Curves, Curves, EnergyBalance, Switching, Marched | None]:
    """The motion of a train with nonlinear couplings, that with halved steps, its balance of energy and its events.

    Last stands how it was marched, where torques follow it.
    """
    built = build(study, system, settings, path, damping_ratio=damping_ratio)
    motion, marched = built.run(1.0, progress)
    curves = Curves(built, motion)
    balance = energy_balance(motion)
    time = np.linspace(0.0, settings.duration, COMPARED)
    fine = Curves(built, built.run(0.5, progress)[0])
    late = np.flatnonzero(_changes(curves, fine, time) > TOLERANCE)
    change = 0.0
    if built.is_band:
        half = build(study, system, settings, path, damping_ratio=damping_ratio, halved=True)
        half_curves = Curves(half, half.run()[0])
        change = float(_changes(curves, half_curves, time).max())

    couplings = [stand.coupling for stand in built.standing]
    names = [coupling.part.name for coupling in built.couplings]
    counts = Counter((couplings[event.element], event.word) for event in motion.events)
    heat = np.zeros(len(names))
    np.add.at(heat, couplings, balance.heat)
    works = tuple(
        CouplingWork(
            name,
            counts[number, "contact"],
            counts[number, "separation"],
            counts[number, "slip"],
            float(heat[number]),
        )
        for number, name in enumerate(names)
    )
    events = tuple(
        CouplingEvent(event.time, names[couplings[event.element]], event.word)
        for event in motion.events
    )
    sensitive = float(time[late[0]]) if late.size else None
    switching = Switching(events, works, balance.work, balance.damped, sensitive, change)
    return curves, fine, balance, switching, marched


def _changes(curves: Curves, finer: Curves, time: FloatArray) -> FloatArray:
    """(times,) largest difference of a torque, of the peak of its span."""
    first, second = (motion.torque(time)[0] for motion in (curves, finer))
    peak = np.maximum(np.abs(first).max(axis=1), 1e-9 * np.abs(first).max())
    scale = np.where(peak > 0.0, peak, 1.0)[:, None]
    return np.asarray((np.abs(first - second) / scale).max(axis=0))
