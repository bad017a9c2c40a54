"""Angles of all stations and torques of all spans, rigid ones and joints among them, in a periodic motion."""

from dataclasses import dataclass

import numpy as np

from torsion.analyses.motion.equations import mean_angle, spring_torques, state, torques
from torsion.analyses.motion.loading import Operating, Scene
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.kernels.periodic.harmonic_balance import Balance, motion_of, points_in_time


@dataclass(frozen=True)
class Course:
    """A periodic motion over the common period, at evenly spaced times."""

    time: FloatArray  # (times,) s
    angle: FloatArray  # (stations, times) rad at own speed, deviation from the mean motion
    speed: FloatArray  # (stations, times) rad/s at own speed, deviation from the mean speed
    torque: FloatArray  # (spans, times) N m at the driving station's speed, positive when the driving side pushes


def course(at: Scene, now: Operating, found: Balance, times: int | None = None) -> Course:
    """The motion of every station and the torque of every span."""
    whole, system, loading = at.layout, at.system, now.stations
    times = points_in_time(found.count) if times is None else times
    turned = mean_angle(loading, times)
    moving = state(whole, now.loading, motion_of(found.harmonic, loading.w0, times), found.load, turned)
    ratio = system.speed_ratio[:, None]
    deviation, slip = moving.turning.deviation[whole.body], moving.slip[whole.body]
    inertia = np.where(system.held, 0.0, system.inertia)[:, None] * ratio**2
    need = inertia * moving.acceleration[whole.body] + loading.damping[:, None] * slip
    need -= torques(loading, turned, found.load)
    torque = np.zeros((len(system.spans), times))
    torque[whole.spring] = spring_torques(whole, moving.turning.deviation, moving.slip)
    np.add.at(need, system.driving[whole.spring], torque[whole.spring])
    np.subtract.at(need, system.driven[whole.spring], torque[whole.spring])
    _rigid_torques(system, torque, need, moving.turning.first[whole.body])
    return Course(turned / loading.speed, deviation * ratio, slip * ratio, torque / system.span_ratio[:, None])


def _rigid_torques(system: System, torque: FloatArray, need: FloatArray, first: FloatArray) -> None:
    """Fill in the torques (spans, times) of the rigid spans and joints, from the leaves of the tree inward.

    need: (stations, times) N m that a station needs from its rigid spans; summed up here on the way. A joint takes
    power through: torque on either side times the speed there is the same, and the speeds go as `first`. Told is the
    torque on its driven side.
    """
    folded = system.folded
    above = np.full(folded.tree.size, -1)
    above[folded.span[folded.span >= 0]] = np.flatnonzero(folded.span >= 0)
    station = np.full(folded.tree.size, -1)
    station[folded.node] = np.arange(len(folded.node))
    for node in range(folded.tree.size - 1, -1, -1):
        span, parent = int(above[node]), int(folded.tree.parent[node])
        if span < 0 or system.flexibility[span] != 0:
            continue
        driving, driven = int(system.driving[span]), int(system.driven[span])
        here = station[node] if station[node] >= 0 else (driven if folded.sign[span] > 0 else driving)
        inward = station[parent] if station[parent] >= 0 else (driving if here == driven else driven)
        passed = need[here] * (first[here] / first[inward])
        torque[span] = need[here] if here == driven else -passed
        need[inward] = need[inward] + passed
