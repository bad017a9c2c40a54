"""Damped natural frequencies and damping ratios."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import Steady, steady
from torsion.analyses.undamped_modes import (
    Modes,
    modes_as_discretised,
    modes_settings,
    span_torques,
)
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.spans import SegmentGroups
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Work
from torsion.results import reported, result

if TYPE_CHECKING:
    from torsion.kernels.spring_law import SpringLaw

MOST_STATIONS = (
    30_000  # rounding along more of them keeps the roots from settling to their accuracy
)
ONLY_REAL = "a table gives stiffness and damping only at real frequencies"
LARGEST_FOR_ALL = (
    150  # tree stations up to which all roots are found at once; beyond, those near undamped modes
)


@reported
class DampedModes:
    """Oscillating modes of the damped train at one operating point."""

    frequency: FloatArray = result("Hz", ("mode",), "imaginary part / 2 pi, ascending")
    damping_ratio: FloatArray = result("1", ("mode",), "share of critical damping")
    eigenvalue: ComplexArray = result("1/s", ("mode",), "complex")
    shape: ComplexArray  # (stations, modes) rad at own speed
    torque: ComplexArray  # (spans, modes) N m
    overdamped: FloatArray = result("1/s", ("root",), "real roots, which are not frequencies")
    speed: float = result("rad/s", (), "reference speed at which damping was taken")

    def condensed(self, groups: SegmentGroups) -> "DampedModes":
        """The same at the stations and spans that stand for segment groups."""
        return replace(self, shape=self.shape[groups.stations], torque=self.torque[groups.spans])


def damped(
    system: System, *, speed: float, steady: Steady | None = None, count: int | None = 6
) -> DampedModes:
    """The lowest `count` oscillating modes (None: all) at a reference speed (rad/s); `steady` holds that speed.

    Raises SolveError for a train with closed loops, shafts of distributed inertia or more than MOST_STATIONS stations,
    InputError where a damping needs a mean torque that is not known.
    """
    from torsion.kernels.damping.damped_tree_modes import damped_modes

    if system.bars is not None:
        message = f"damped modes of the model {system.model} are not built"
        raise SolveError(f"{message}; use the lumped model, the response is right with all of them")
    if system.train.modal_damping:
        return _by_mode(modes_as_discretised(system, count), speed)
    condensed = system.condensed
    if condensed.extra.size:
        message = "damped modes of a train with closed loops, or grounded through rigid spans at several points"
        raise SolveError(
            f"{message}, are not built; request `modes: {{damped: false}}`, the response is right"
        )
    if condensed.tree.size > MOST_STATIONS:
        raise SolveError(too_many_stations(system))
    own = ground_damping(system, np.array([speed]), steady)[:, 0]
    ground = np.zeros(condensed.tree.size)
    ground[condensed.node] = own * system.speed_ratio**2
    start, laws = None, _laws(system)
    if condensed.tree.size > LARGEST_FOR_ALL or any(
        law.exponent is not None for law in laws.values()
    ):
        start = 2.0 * math.pi * modes_as_discretised(system, count).frequency
    viscous, loss = condensed.viscous.copy(), condensed.loss_factor.copy()
    viscous[list(laws)], loss[list(laws)] = 0.0, 0.0
    found = damped_modes(
        condensed.tree,
        ground_damping=ground,
        viscous=viscous,
        loss_factor=loss,
        start=start,
        laws=laws,
    )
    keep = np.argsort(found.eigenvalue.imag, kind="stable")[:count]
    eigenvalue = found.eigenvalue[keep]
    return DampedModes(
        eigenvalue.imag / (2.0 * math.pi),
        -eigenvalue.real / np.abs(eigenvalue),
        eigenvalue,
        found.angle[condensed.node][:, keep] * system.speed_ratio[:, None],
        span_torques(system, found.torque[:, keep]),
        found.real_root,
        speed,
    )


def _laws(system: System) -> "dict[int, SpringLaw]":
    """The springs that follow a law, referred, by the tree station below them; raises SolveError beside a table."""
    laws = {}
    for span, table in system.tables_over("frequency").items():
        if not table.is_complex:
            raise SolveError(f"damped modes: {ONLY_REAL}")
        law = cast("SpringLaw", table)
        laws[int(system.condensed.span[span])] = law.times(float(system.span_ratio[span]) ** 2)
    return laws


def _by_mode(found: Modes, speed: float) -> DampedModes:
    """Modes with the damping ratios that the file gives them."""
    ratio, w = found.system.modal_ratios(len(found.frequency)), 2.0 * math.pi * found.frequency
    root = w * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
    shape, torque = found.shape.astype(complex), found.torque.astype(complex)
    return DampedModes(root.imag / (2.0 * math.pi), ratio, root, shape, torque, np.empty(0), speed)


def run(work: Work) -> None:
    """The damped modes at the operating speed, where modes are requested and something damps."""
    study, system = work.study, work.system
    settings = modes_settings(study, work.ruled)
    if settings is None:
        return
    speed = study.operation.speed
    needs_torque = any(damper.needs_torque for damper in system.dampers)
    needs_speed = needs_torque or any(damper.speed_factor for damper in system.dampers)
    why = ""
    if settings.damped is False or not system.damps:
        why = "`damped: false`" if settings.damped is False else "nothing in the train damps"
    elif any(not table.is_complex for table in system.tables_over("frequency").values()):
        why = f"{ONLY_REAL}; the modal loss factors stand for them"
    elif system.bars is not None:
        why = f"they are built for `model: lumped`; the response of {system.model} is damped"
    elif system.condensed.extra.size:
        why = "the train has closed loops, or rigid spans hold it at several points"
        why += "; its response is damped all the same"
    elif too_many := too_many_stations(system):
        why = too_many
    elif (needs_speed and speed is None) or (needs_torque and not study.has_mean_torque):
        why = "the damping depends on speed and mean torque; give `operation: rated`"
    if why and settings.damped and system.damps:
        raise SolveError(f"the damped modes are not found: {why}", "leave `damped: true` out")
    if why:
        work.log.without("damped modes", why)
        return
    mean = None
    if needs_torque and speed is not None:
        mean = steady(study.train, system, study.operation, np.array([speed]))
    with work.log.step("damped modes", "something damps") as step:
        found = damped(system, speed=speed or 0.0, steady=mean, count=settings.count)
        by_mode = bool(system.train.modal_damping)
        step.method = (
            "damping by mode"
            if by_mode
            else "Newton with two-sided vectors on the quadratic problem"
        )
        step.size = f"{found.frequency.size} modes" + (
            "" if speed is None else f" at {speed * 30 / math.pi:.6g} rpm"
        )
    work.put(damped_modes=found)


def too_many_stations(system: System) -> str:
    """Why the roots would not settle, and what to change; empty where they do."""
    size = system.condensed.tree.size
    if size <= MOST_STATIONS:
        return ""
    most = max(system.segments, key=lambda name: system.segments[name], default="")
    change = f"; give `{most}` fewer segments" if most else ""
    return f"{size} stations, and rounding along more than {MOST_STATIONS} keeps the roots from settling{change}"
