"""Damped natural frequencies and damping ratios."""

import math
from typing import TYPE_CHECKING, cast

import numpy as np

from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import Steady, steady
from torsion.analyses.undamped_modes import modes_as_discretised, modes_settings, span_torques
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.kernels.stiffness_laws import SpringLaw

MOST_STATIONS = 30_000  # rounding along more of them keeps the roots from settling
ONLY_REAL = "a table gives stiffness and damping only at real frequencies"
TAU = 2.0 * math.pi
LARGEST_FOR_ALL = 150  # tree stations up to which all roots are found at once


@reported
class DampedModes:
    """Oscillating modes of the damped train at one operating point."""

    frequency: FloatArray = result("Hz", "mode", "imaginary part / 2 pi, ascending")
    damping_ratio: FloatArray = result("1", "mode", "share of critical damping")
    eigenvalue: ComplexArray = result("1/s", "mode", "complex")
    shape: ComplexArray  # (stations, modes) rad at own speed
    torque: ComplexArray  # (spans, modes) N m
    overdamped: FloatArray = result("1/s", "root", "real roots, which are not frequencies")
    speed: float = result("rad/s", "reference speed at which damping was taken")


def damped(
    system: System, *, speed: float, steady: Steady | None = None, count: int | None = 6
) -> DampedModes:
    """Return the lowest `count` oscillating modes (None: all) at a reference speed (rad/s), which `steady` holds.

    Raises SolveError for a train with closed loops, shafts of distributed inertia or more than MOST_STATIONS stations,
    InputError where a damping needs a mean torque that is not known.
    """
    from torsion.kernels.modes.damped_tree_modes import damped_modes

    if system.bars is not None:
        message = f"damped modes of the model {system.model} are not built"
        raise SolveError(f"{message}; use the lumped model, the response is right with all of them")
    if system.train.modal_damping:
        modes = modes_as_discretised(system, count)
        ratio = system.modal_ratios(len(modes.frequency))
        root = TAU * modes.frequency * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
        shapes = modes.shape.astype(complex), modes.torque.astype(complex)
        return DampedModes(root.imag / TAU, ratio, root, *shapes, np.empty(0), speed)
    condensed = system.condensed
    if condensed.extra.size:
        message = "damped modes of a train with closed loops, or grounded through rigid spans at several points, are not"
        raise SolveError(
            f"{message} built; request `modes: {{damped: false}}`, the response is right"
        )
    if condensed.tree.size > MOST_STATIONS:
        raise SolveError(_too_many_stations(system))

    ground = np.zeros(condensed.tree.size)
    own_damping = ground_damping(system, np.array([speed]), steady)[:, 0]
    ground[condensed.node] = own_damping * system.speed_ratio**2
    start = None
    # Springs that follow a law, referred, by the tree station below.
    laws = dict[int, "SpringLaw"]()
    for span, table in system.tables_over("frequency").items():
        if not table.is_complex:
            raise SolveError(f"damped modes: {ONLY_REAL}")
        law = cast("SpringLaw", table)
        laws[int(condensed.span[span])] = law.times(float(system.span_ratio[span]) ** 2)
    has_power_law = any(law.exponent is not None for law in laws.values())
    if has_power_law or condensed.tree.size > LARGEST_FOR_ALL:
        start = TAU * modes_as_discretised(system, count).frequency
    viscous = condensed.viscous.copy()
    loss = condensed.loss_factor.copy()
    viscous[list(laws)] = 0.0
    loss[list(laws)] = 0.0
    roots = damped_modes(
        condensed.tree,
        ground_damping=ground,
        viscous=viscous,
        loss_factor=loss,
        start=start,
        laws=laws,
    )
    lowest = np.argsort(roots.eigenvalue.imag, kind="stable")[:count]
    eigenvalue = roots.eigenvalue[lowest]
    torque = roots.torque[:, lowest]
    return DampedModes(
        eigenvalue.imag / TAU,
        -eigenvalue.real / np.abs(eigenvalue),
        eigenvalue,
        roots.angle[condensed.node][:, lowest] * system.speed_ratio[:, None],
        span_torques(system, torque, torque),
        roots.real_root,
        speed,
    )


def _why_not(study: Study, system: System) -> str:
    """Return why there are no damped modes though they are wanted; empty where there are."""
    needs_torque = any(damper.needs_torque for damper in system.dampers)
    needs_speed = needs_torque or any(damper.speed_factor for damper in system.dampers)
    if any(not table.is_complex for table in system.tables_over("frequency").values()):
        return f"{ONLY_REAL}; the modal loss factors stand for them"
    if system.bars is not None:
        return f"they are built for `model: lumped`; the response of {system.model} is damped"
    if system.condensed.extra.size:
        reason = "the train has closed loops, or rigid spans hold it at several points"
        return f"{reason}; its response is damped all the same"
    if (needs_speed and study.operation.speed is None) or (
        needs_torque and not study.has_mean_torque
    ):
        reason = "the damping depends on speed and mean torque; give `operation: rated`"
        return _too_many_stations(system) or reason
    return _too_many_stations(system)


def run(work: Work) -> None:
    """Put the damped modes at the operating speed, where modes are requested and something damps."""
    study = work.study
    system = work.system
    speed = study.operation.speed
    settings = modes_settings(study, work.ruled)
    if settings is None:
        return
    if why := "`damped: false`" if settings.damped is False else _why_not(study, system):
        if settings.damped:
            hint = "leave `damped: true` out"
            raise SolveError(f"the damped modes are not found: {why}", hint)
        work.log.without("damped modes", why)
        return
    mean = None
    if speed is not None and any(damper.needs_torque for damper in system.dampers):
        mean = steady(study.train, system, study.operation, np.array([speed]))
    with work.log.step("damped modes", "something damps") as step:
        modes = damped(system, speed=speed or 0.0, steady=mean, count=settings.count)
        step.method = "Newton with two-sided vectors on the quadratic problem"
        if system.train.modal_damping:
            step.method = "damping by mode"
        step.size = f"{modes.frequency.size} modes"
        step.size += "" if speed is None else f" at {speed * 30 / math.pi:.6g} rpm"
    work.put(damped_modes=modes)


def _too_many_stations(system: System) -> str:
    """Return why the roots would not settle, and what to change; empty where they do."""
    size = system.condensed.tree.size
    if size <= MOST_STATIONS:
        return ""
    longest = max(system.segments, key=lambda name: system.segments[name], default="")
    change = f"; give `{longest}` fewer segments" if longest else ""
    return f"{size} stations, and rounding along more than {MOST_STATIONS} keeps the roots from settling{change}"
