"""What acts on the mechanism at one mean speed: loads, vibratory torques, damping, and the drive that holds the speed.

A train that nothing holds needs its drive's mean torque as an unknown: joints lose and gain with the motion, and only
one mean torque keeps the mean speed. With it goes one condition, the mean angle at the reference station.
"""

from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Literal

import numpy as np

from torsion.analyses.response.harmonic_components import amplitude, excitations
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.response.synthesis import common_order
from torsion.analyses.stability.equations_of_motion import Loading, turning
from torsion.analyses.stability.mechanism import Layout, layout
from torsion.analyses.steady import reference_station, steady_if_known
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.periodic.harmonic_balance import Factors
from torsion.primitives import Torque
from torsion.study import Study

MOST_INVERSIONS = 60  # of Newton's method on a joint's map, which is monotone


@dataclass(frozen=True)
class Scene:
    """A study as a mechanism."""

    study: Study
    system: System
    layout: Layout
    order: Fraction  # of the common period
    torques: tuple[
        tuple[Fraction, Torque], ...
    ]  # vibratory torques with their orders of the reference station
    mean: float = 1.0  # factor on the mean torque
    damping: float = (
        1.0  # factor on the damping to ground; that of the springs stands in the layout
    )
    slopes: FloatArray = field(
        default_factory=lambda: np.zeros(1)
    )  # (stations,) N m s/rad at the reference, added
    laws: Literal["none", "negative", "all"] = (
        "none"  # which slopes of the laws of drive and load act too
    )
    factors: Factors = field(default_factory=Factors)  # of the last orbit


def scene(study: Study, system: System, *, vibratory: bool = True) -> Scene:
    """Return the mechanism with the torques that have an order; those at fixed frequencies share no period and are left out.

    vibratory: False leaves out all of them, so that the joints alone excite, and lets slopes of drive and load act.
    """
    train_layout = layout(system)
    torques = [
        (excitation.line.order, torque)
        for excitation in excitations(system)
        if excitation.line.order is not None and vibratory
        for torque in excitation.torques
    ]
    if any(torque.mesh for _, torque in torques):
        raise SolveError(
            "a mesh that excites is not built in the exact motion", "leave it out of this file"
        )
    order = common_order([*(order for order, _ in torques), *train_layout.orders]) or Fraction(1)
    still = np.zeros(len(system.stations))
    laws: Literal["none", "all"] = "none" if vibratory else "all"
    return Scene(study, system, train_layout, order, tuple(torques), slopes=still, laws=laws)


@dataclass(frozen=True)
class Operating:
    """The loading at one speed with a first guess of the unknown loads, and the static twist of the bodies."""

    loading: Loading  # on the bodies
    stations: Loading  # the same on the stations, at one speed too
    load: FloatArray  # (unknown loads,) N m at the reference speed
    twist: FloatArray  # (bodies,) rad, against the reference station
    on_mean_speed: float = 0.0  # N m s/rad at the reference: what the mean speed sees beside the damping of the loading


def operating(mechanism: Scene, speed: float) -> Operating:
    """Return what acts at a reference speed (rad/s)."""
    system = mechanism.system
    layout = mechanism.layout
    speeds = np.array([speed])
    steady_state = steady_if_known(mechanism.study, system, speeds)
    ratio = system.speed_ratio
    ground = mechanism.damping * ground_damping(system, speeds, steady_state)[:, 0] * ratio**2
    on_mean_speed = 0.0
    damping = ground + mechanism.slopes
    if mechanism.laws != "none" and steady_state is not None:
        # A damping of the file acts in vibration in place of the slope; on the mean speed a machine acts by its law.
        stated = np.isin(np.arange(len(ratio)), [damper.station for damper in system.dampers])
        load = steady_state.load_slope[:, 0] * ratio**2
        for slope in (np.where(stated, 0.0, load), steady_state.drive_slope[:, 0] * ratio**2):
            damping += slope if mechanism.laws == "all" else np.minimum(slope, 0.0)
        absorbing = [
            part.stations[0]
            for part in system.train.parts
            if part.machine is not None and not part.machine.is_driver
        ]
        stated &= np.isin(np.arange(len(ratio)), absorbing)
        on_mean_speed = float((load - ground)[stated].sum())
    applied = np.zeros(len(ratio))
    twist = np.zeros(len(layout.inertia))
    if steady_state is not None:
        applied = mechanism.mean * steady_state.applied[:, 0] * ratio
        twist[layout.body] = mechanism.mean * steady_state.twist[:, 0] / ratio
    orders = sorted({order for order, _ in mechanism.torques})
    vibratory = np.zeros((len(ratio), len(orders)), dtype=np.complex128)
    for order, torque in mechanism.torques:
        at_station = ratio[torque.station] * amplitude(system, torque, speeds, steady_state)[0]
        vibratory[torque.station, orders.index(order)] += at_station
    multiple = np.array([int(order / mechanism.order) for order in orders], dtype=np.int64)
    constant, drive, steady, load = _drive(mechanism, applied)
    stations = Loading(
        speed, damping, constant, multiple, vibratory, drive, steady, float(mechanism.order)
    )
    onto = 1.0 * (layout.body == np.arange(len(layout.inertia))[:, None])  # (bodies, stations)
    bodies = replace(
        stations,
        damping=onto @ damping,
        torque=onto @ constant,
        vibratory=onto @ vibratory,
        drive=drive @ onto.T,
    )
    return Operating(bodies, stations, load, twist, on_mean_speed)


def _drive(
    mechanism: Scene, applied: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray, FloatArray]:
    """Known torques, unknown loads on the stations with the coordinates they keep, and a first guess of the loads."""
    layout = mechanism.layout
    reference = reference_station(mechanism.study.train, mechanism.study.operation)
    share = np.maximum(applied, 0.0)
    if not share.any():
        share[reference] = 1.0
    known_torque = applied.copy()
    steady = np.array([group[0] for group in layout.floating], dtype=np.int64)
    drive = np.zeros((len(steady), len(applied)))
    guess = np.zeros(len(steady))
    coordinate, at_reference = (
        int(layout.coordinate[layout.body[station]])
        for station in (int(np.argmax(share)), reference)
    )
    for row, group in enumerate(layout.floating):
        if coordinate in group:
            drive[row] = share / share.sum()
            steady[row] = at_reference if at_reference in group else group[0]
            guess[row] = applied[applied > 0].sum()
            known_torque = np.minimum(applied, 0.0)
        else:
            drive[row, np.flatnonzero(layout.body == layout.root[group[0]])[0]] = 1.0
    return known_torque, drive, steady, guess


def rigid_deviation(
    layout: Layout, steady: IntArray, twist: FloatArray, turned: FloatArray
) -> FloatArray:
    """Return (free, times) rad of the train turning without any elasticity but its static twist (bodies, 1 or times).

    steady: coordinates that turn evenly, from which the motion is followed on; turned: (times,) rad.
    """
    deviation = np.zeros((len(layout.root), len(turned)))
    known = [*range(layout.free, len(layout.root)), *steady.tolist()]
    is_reached = np.isin(layout.coordinate, known)
    ends = list(zip(layout.driving.tolist(), layout.driven.tolist(), strict=True))
    ends += [(b, a) for a, b in ends]
    while link := next(((a, b) for a, b in ends if is_reached[a] and not is_reached[b]), None):
        a, b = link
        coordinate = layout.coordinate[b]
        target = turning(layout, deviation, turned).deviation[a] + (twist[b] - twist[a])
        deviation[coordinate] = target
        for _ in range(MOST_INVERSIONS):
            moving = turning(layout, deviation, turned)
            miss = moving.deviation[b] - target
            if np.abs(miss).max() < 1e-13:
                break
            deviation[coordinate] -= miss / moving.first[b]
        is_reached |= layout.coordinate == coordinate
    return deviation[: layout.free]
