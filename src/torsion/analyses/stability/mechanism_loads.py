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
from torsion.analyses.stability.common_period import common_order
from torsion.analyses.stability.equations_of_motion import Loading
from torsion.analyses.stability.mechanism import (
    Layout,
    Turning,
    at_rest,
    beyond,
    layout,
)
from torsion.analyses.steady import reference_station, steady_if_known
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
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


def scene(study: Study, system: System, *, vibratory: bool = True) -> Scene:
    """The mechanism with the torques that have an order; those at fixed frequencies share no period and are left out.

    vibratory: False leaves out all of them, so that the joints alone excite, and lets slopes of drive and load act.
    """
    whole = layout(system)
    found = [
        (one.line.order, torque)
        for one in excitations(system)
        if one.line.order is not None and vibratory
        for torque in one.torques
    ]
    if any(torque.mesh for _, torque in found):
        raise SolveError(
            "a mesh that excites is not built in the exact motion", "leave it out of this file"
        )
    order = common_order([*(order for order, _ in found), *whole.orders]) or Fraction(1)
    still = np.zeros(len(system.stations))
    laws: Literal["none", "all"] = "none" if vibratory else "all"
    return Scene(study, system, whole, order, tuple(found), slopes=still, laws=laws)


@dataclass(frozen=True)
class Operating:
    """The loading at one speed with a first guess of the unknown loads, and the static twist of the bodies."""

    loading: Loading  # on the bodies
    stations: Loading  # the same on the stations, at one speed too
    load: FloatArray  # (unknown loads,) N m at the reference speed
    twist: FloatArray  # (bodies,) rad, against the reference station
    beside: float = 0.0  # N m s/rad at the reference: what the mean speed sees beside the damping of the loading


def operating(at: Scene, speed: float) -> Operating:
    """What acts at a reference speed (rad/s)."""
    system, whole = at.system, at.layout
    speeds = np.array([speed])
    known = steady_if_known(at.study, system, speeds)
    ratio = system.speed_ratio
    ground, beside = at.damping * ground_damping(system, speeds, known)[:, 0] * ratio**2, 0.0
    damping = ground + at.slopes
    if (
        at.laws != "none"
        and known is not None
        and known.load_slope is not None
        and known.drive_slope is not None
    ):
        # A damping of the file acts in vibration in place of the slope; on the mean speed a machine acts by its law.
        stated = np.isin(np.arange(len(ratio)), [damper.station for damper in system.dampers])
        load = known.load_slope[:, 0] * ratio**2
        for slope in (np.where(stated, 0.0, load), known.drive_slope[:, 0] * ratio**2):
            damping += slope if at.laws == "all" else np.minimum(slope, 0.0)
        beside = float((load - ground)[stated & _absorbing(at)].sum())
    applied, twist = np.zeros(len(ratio)), np.zeros(whole.bodies)
    if known is not None:
        applied = at.mean * known.applied[:, 0] * ratio
        twist[whole.body] = at.mean * known.twist[:, 0] / ratio
    orders = sorted({order for order, _ in at.torques})
    vibratory = np.zeros((len(ratio), len(orders)), dtype=np.complex128)
    for order, torque in at.torques:
        here = torque.station
        vibratory[here, orders.index(order)] += (
            ratio[here] * amplitude(system, torque, speeds, known)[0]
        )
    multiple = np.array([int(order / at.order) for order in orders], dtype=np.int64)
    constant, drive, steady, load = _drive(at, applied)
    stations = Loading(
        speed, damping, constant, multiple, vibratory, drive, steady, float(at.order)
    )
    bodies = replace(
        stations,
        damping=_on_bodies(whole, damping),
        torque=_on_bodies(whole, constant),
        vibratory=_on_bodies(whole, vibratory),
        drive=_on_bodies(whole, drive.T).T,
    )
    return Operating(bodies, stations, load, twist, beside)


def _absorbing(at: Scene) -> BoolArray:
    """(stations,) where a machine absorbs power by its law of load."""
    parts = (
        part
        for part in at.system.train.parts
        if part.machine is not None and not part.machine.is_driver
    )
    return np.isin(np.arange(len(at.system.stations)), [part.stations[0] for part in parts])


def _on_bodies(whole: Layout, of_stations: np.ndarray) -> np.ndarray:
    """(bodies, ...) sums of (stations, ...)."""
    out = np.zeros((whole.bodies, *of_stations.shape[1:]), dtype=of_stations.dtype)
    np.add.at(out, whole.body, of_stations)
    return out


def _drive(at: Scene, applied: FloatArray) -> tuple[FloatArray, FloatArray, IntArray, FloatArray]:
    """Known torques, unknown loads on the stations with the coordinates they keep, and a first guess of the loads."""
    whole, number = at.layout, len(applied)
    reference = reference_station(at.study.train, at.study.operation)
    share = np.maximum(applied, 0.0)
    if not share.any():
        share[reference] = 1.0
    known, rows, steady, guess = applied.copy(), list[FloatArray](), list[int](), list[float]()
    own = whole.coordinate[whole.body[int(np.argmax(share))]]
    for group in whole.floating:
        if own in group:
            rows.append(share / share.sum())
            at_reference = int(whole.coordinate[whole.body[reference]])
            steady.append(at_reference if at_reference in group else group[0])
            guess.append(float(applied[applied > 0].sum()))
            known = np.minimum(applied, 0.0)
        else:
            slipping = np.zeros(number)
            slipping[int(np.flatnonzero(whole.body == whole.root[group[0]])[0])] = 1.0
            rows.append(slipping)
            steady.append(group[0])
            guess.append(0.0)
    return (
        known,
        np.array(rows).reshape(-1, number),
        np.array(steady, dtype=np.int64),
        np.array(guess),
    )


def rigid_deviation(
    whole: Layout, steady: IntArray, twist: FloatArray, turned: FloatArray
) -> FloatArray:
    """(free, times) rad of the train turning without any elasticity but its static twist (bodies, 1 or times).

    steady: coordinates that turn evenly, from which the motion is followed on; turned: (times,) rad.
    """
    deviation = np.zeros((len(whole.root), len(turned)))
    bodies: dict[int, FloatArray] = {}

    def follow(own: int, angle: FloatArray) -> dict[int, Turning]:
        met = {int(whole.root[own]): at_rest(angle)}
        for step in whole.steps:
            if step.inner in met:
                met[step.outer] = beyond(met[step.inner], step.joint, turned)
        return met

    def reach(own: int, body: int, target: FloatArray) -> None:
        angle = target
        for _ in range(MOST_INVERSIONS):
            met = follow(own, angle)
            miss = met[body].deviation - target
            if np.abs(miss).max() < 1e-13:
                break
            angle = angle - miss / met[body].first
        deviation[own] = angle
        bodies.update({one: turning.deviation for one, turning in met.items()})

    known = [*range(whole.free, len(whole.root)), *steady.tolist()]
    for own in known:
        reach(own, int(whole.root[own]), np.zeros(len(turned)))
    ends = list(zip(whole.driving.tolist(), whole.driven.tolist(), strict=True))
    while True:
        found = [
            (a, b)
            for a, b in [*ends, *((b, a) for a, b in ends)]
            if a in bodies and b not in bodies
        ]
        if not found:
            return deviation[: whole.free]
        a, b = found[0]
        reach(int(whole.coordinate[b]), b, bodies[a] + (twist[b] - twist[a]))
