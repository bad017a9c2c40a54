"""Parametric stability of a driven shaft on bearings: its joint's couple follows the tilt of the shaft.

The shaft is taken for rigid, as Zhu and Wang do: it turns about the centre of the joint that drives it, on its
supports. Where it bends about as easily as it tilts, that is said and nothing is computed.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import accumulate
from operator import itemgetter
from typing import ClassVar

import numpy as np

from torsion.analyses.joints.joint_lines import Placed
from torsion.analyses.lateral.beam_matrices import Beam, gauss
from torsion.analyses.lateral.bending_shafts import BendingShaft, JointAt
from torsion.analyses.lateral.misaligned_shaft import (
    EXACT,
    NEUTRAL,
    MisalignedShaft,
    Model,
    growth,
    small_angle_part,
)
from torsion.arrays import FloatArray
from torsion.kernels.bracketed_search import find_minimum, find_root
from torsion.results import derived, reported, result

Torques = Callable[
    [FloatArray], FloatArray
]  # (speeds,) rad/s -> (joints, speeds) N m of their driving shafts
Bending = tuple[FloatArray, FloatArray]
RIGID = 0.1  # a lowest frequency that bending lowers by a larger share is not that of a rigid shaft
POINTS, LOOKED_AT = (
    201,
    400,
)  # speeds of the curve of growth, and of the search, beside those around resonances
SPAN = 0.05  # rad/s / the sum of both frequencies: how far around a resonance points are added
PERIODS = 3  # whole multiples of twice the speed that are looked at for a zone's name
EVEN = 1e-6  # imaginary / real part: a multiplier that is real
EXACTLY = 1e-15  # relative, of a boundary
MEAN = "mean couple"
KIND_NAMES = {MEAN: "excited by the mean couple", "several": "several resonances together"}
OF_MEAN = Model(lambda turned, tilt: small_angle_part(turned, sine=0.0, cosine=0.0, constant=1.0))


@reported
class TiltRange:
    """Speeds between which a small tilting motion grows."""

    first: float = result(
        "rad/s", "reference speed at which an unstable range begins", key="from_rad_per_s"
    )
    last: float = result("rad/s", "and ends", key="to_rad_per_s")
    is_open: tuple[bool, bool] = result("[from, to] the range continues beyond the computed speeds")
    # "principal of 2", "sum of 1 and 2", "difference of 2 and 1", "/n" behind where n is not 1
    kind: str = result("principal, sum, difference, several, or mean couple", key="type")
    at: float = result("rad/s", "reference speed of the fastest growth", key="at_rad_per_s")
    growth: float = result("1/s", "fastest growth in the range", key="growth_per_s")
    unknown: ClassVar = (None, None)  # there is a motion at every speed

    @property
    def name(self) -> str:
        """The kind as the report prints it."""
        return KIND_NAMES.get(self.kind, self.kind)

    def meets(self, first: float, last: float) -> bool:
        """Return whether some unstable speed of it lies between two speeds (rad/s); a boundary is none."""
        return self.first < last and self.last > first


@reported
class Tilting:
    """How fast small tilting motions of a rigid shaft grow over speed."""

    joint: str = result("that drives the shaft")
    shaft: MisalignedShaft  # `length` 1 m and `torque` 1 N m: stiffness N m/rad, load N m
    frequency: dict[str, float] = result(
        "Hz", "of the tilt at rest", key="frequency_Hz"
    )  # of y and of z
    speed: FloatArray = result("rad/s", "speed", "reference speeds")
    growth: FloatArray = result("1/s", "speed", "of the fastest small motion; positive: unstable")
    zones: tuple[TiltRange, ...] = result("unstable ranges", key="unstable")

    @derived("kg*m**2", "about the centre of the joint")
    def transverse_inertia(self) -> float:
        """Transverse inertia of the rigid shaft, kg m2."""
        return self.shaft.inertia

    @derived("kg*m**2", "of the same body")
    def polar_inertia(self) -> float:
        """Polar inertia of the rigid shaft, kg m2."""
        return self.shaft.polar * self.shaft.inertia

    @derived("1/s", "[y, z] decay rate of the tilt at rest")
    def decay_rate(self) -> tuple[float, float]:
        """Half the damping over the inertia, of y and of z."""
        z, y = self.shaft.decay
        return y / 2.0, z / 2.0


def _torque_of_joint(torque: Torques, ratio: float, number: int, speeds: FloatArray) -> FloatArray:
    """Return a joint's torque, N m, at speeds of its shaft, rad/s; results with it are copied to other processes."""
    return np.asarray(torque(speeds / ratio)[number])


def tilting(
    shaft: BendingShaft,
    placed: Sequence[Placed],
    torque: Torques,
    speeds: FloatArray,
    bending: Bending,
) -> tuple[Tilting | None, str]:
    """Return the growth and unstable ranges of the tilt, and why there are none; torque, speeds (rad/s) are of the reference.

    bending: (modes,) Hz of y and of z at rest, of the same shaft as it bends.
    """
    if len(shaft.joints) != 1 or not any(max(point.stiffness) for point in shaft.beam.points):
        return None, ""
    if shaft.joints[0].shaft == "driving":
        return (
            None,
            "it drives its joint; the parametric terms of its tilt are built for driven shafts",
        )
    number, joint = next(
        (k, joint_at) for k, joint_at in enumerate(placed) if joint_at.part == shaft.joints[0].part
    )
    if joint.record.kind != "cross":
        return None, "the parametric terms of its tilt are built for cross joints"
    ratio = float(joint.ratio)
    last = float(speeds[-1]) * ratio
    first = max(float(speeds[0]) * ratio, last / POINTS)
    load = partial(_torque_of_joint, torque, ratio, number)
    rigid = _rigid(shaft.beam, shaft.joints[0], joint.record.angle, load)
    z, y = (
        np.sqrt(rigid.square) / (2.0 * np.pi)
    ).tolist()  # the angle about y moves the shaft along z
    for plane, hertz, soft in zip("yz", (y, z), bending, strict=True):
        if soft.size and soft[0] < (1.0 - RIGID) * hertz:
            return None, (
                f"it bends too easily to be taken for rigid (lowest frequency in {plane} {soft[0]:.4g} Hz, rigid "
                f"{hertz:.4g} Hz); the parametric stability of its tilt is not computed"
            )
    unstable = []
    more_speeds = [*resonances(rigid).values()]
    for zone in zones(rigid, first, last, EXACT):
        # A zone that the mean part of the couple alone makes as strongly has its name.
        alone = _rate(rigid, OF_MEAN, zone.at)
        unstable.append(replace(zone, kind=MEAN) if alone > 0.5 * zone.growth else zone)
        # Speeds in it, as far again on both sides, and its own.
        wide = zone.last - zone.first
        more_speeds += [zone.first, zone.at, zone.last]
        more_speeds += np.linspace(zone.first - wide, zone.last + wide, 37).tolist()
    inner = [speed for speed in more_speeds if first < speed < last]
    grid = np.union1d(np.linspace(first, last, POINTS), inner)
    of_train = tuple(
        replace(zone, first=zone.first / ratio, last=zone.last / ratio, at=zone.at / ratio)
        for zone in unstable
    )
    return Tilting(
        joint.name, rigid, {"y": y, "z": z}, grid / ratio, growth(rigid, grid).rate, of_train
    ), ""


def _rigid(
    beam: Beam, joint: JointAt, tilt: float, torque: Callable[[FloatArray], FloatArray]
) -> MisalignedShaft:
    """The whole beam as one body about the centre of its joint."""
    centre = beam.points[joint.point].at
    transverse = sum(
        point.mass * (point.at - centre) ** 2 + point.diametral for point in beam.points
    )
    polar = sum(point.polar for point in beam.points)
    share, weight = gauss(5)  # exact for the sixth degree of a cone
    # And the end.
    starts = accumulate((segment.length for segment in beam.segments), initial=-centre)
    for segment, start in zip(beam.segments, starts, strict=False):
        slices = weight * segment.length * segment.density
        second = segment.moment(share)
        position = start + segment.length * share
        transverse += float(slices @ (segment.area(share) * position**2 + second))
        polar += float(slices @ (2.0 * second))
    arms = np.array([(point.at - centre) ** 2 for point in beam.points])
    stiffness, damping = (
        arms @ np.array([getattr(p, what) for p in beam.points])
        for what in ("stiffness", "damping")
    )
    return MisalignedShaft(
        transverse,
        polar / transverse,
        1.0,
        tuple(stiffness.tolist()),
        tuple(damping.tolist()),
        1.0,
        tilt,
        torque,
    )


def zones(
    shaft: MisalignedShaft, first: float, last: float, model: Model = EXACT, points: int = LOOKED_AT
) -> tuple[TiltRange, ...]:
    """Return every unstable range between two positive speeds, ascending.

    Growth is sampled evenly and more densely where the frequencies meet; each local greatest value is sought out, so
    that a zone narrower than the spacing is still found where its growth has a slope that leads to it.
    """
    speed, rate = _sampled(shaft, first, last, model, points)
    high = rate > NEUTRAL * speed
    bounds = [first] if high[0] else []
    for k in np.flatnonzero(high[1:] != high[:-1]):
        # The speed of no growth; beside a range without growth or decay, of growth beyond rounding.
        level = 0.0 if rate[k : k + 2].min() < -NEUTRAL * speed[k + 1] else NEUTRAL

        def above(speed: float, level: float = level) -> float:
            return _rate(shaft, model, speed) - level * speed

        ends = float(speed[k]), float(speed[k + 1])
        root = find_root(above, *ends, tolerance=EXACTLY * ends[1], relative=4 * EXACTLY)
        bounds.append(float(root))
    bounds += [last] if high[-1] else []

    out = []
    by_name = resonances(shaft)
    for low, up in zip(bounds[::2], bounds[1::2], strict=True):
        inside = (speed >= low) & (speed <= up)
        worst = float(speed[inside][rate[inside].argmax()])
        near = (up - low) / 8
        worst, fastest = _greatest(
            shaft, model, worst, max(low, worst - near), min(up, worst + near)
        )
        # The resonance nearest to the worst speed among those whose multipliers are of its sort.
        kind = "several"
        if sum(low < speed < up for name, speed in by_name.items() if "/" not in name) <= 1:
            frequency = float(growth(shaft, np.array([worst]), model).frequency[0])
            is_real = abs(np.sin(np.pi * frequency / worst)) < EVEN
            fitting = [name for name in by_name if name.startswith("principal") == is_real]
            kind = min(fitting, key=lambda name: abs(by_name[name] - worst))
        is_open = low == first and bool(high[0]), up == last and bool(high[-1])
        out.append(TiltRange(low, up, is_open, kind, worst, fastest))
    return tuple(out)


def _rate(shaft: MisalignedShaft, model: Model, speed: float) -> float:
    """1/s, the fastest growth at one speed."""
    return float(growth(shaft, np.array([speed]), model).rate[0])


def resonances(shaft: MisalignedShaft) -> dict[str, float]:
    """Return the speeds (rad/s) at which 2 n times the speed is twice a frequency, their sum or difference, by name."""
    lower, two = shaft.frequency
    parts = {
        "principal of 1": 2.0 * lower,
        "principal of 2": 2.0 * two,
        "sum of 1 and 2": lower + two,
        "difference of 2 and 1": two - lower,
    }
    return {
        name + (f" /{n}" if n > 1 else ""): float(total) / (2.0 * n)
        for name, total in parts.items()
        for n in range(1, PERIODS + 1)
    }


def _sampled(
    shaft: MisalignedShaft, first: float, last: float, model: Model, points: int
) -> tuple[FloatArray, FloatArray]:
    """Speeds and growth: an even grid, points around every resonance, and every local greatest value below zero."""
    by_name = np.array(list(resonances(shaft).values()))
    width = SPAN * float(shaft.frequency.sum())
    near = (by_name[:, None] + width * np.linspace(-1.0, 1.0, 41) ** 3).ravel()
    speed = np.unique(
        np.concatenate([np.linspace(first, last, points), near[(near > first) & (near < last)]])
    )
    rate = growth(shaft, speed, model).rate
    inner = rate[1:-1]
    peak = np.flatnonzero((inner > rate[:-2]) & (inner >= rate[2:]) & (inner <= 0.0)) + 1
    peaks = [_greatest(shaft, model, speed[k], speed[k - 1], speed[k + 1]) for k in peak]
    rows = np.array([*zip(speed, rate, strict=True), *peaks])
    sampled_speed, sampled_rate = rows[np.argsort(rows[:, 0])].T
    return sampled_speed, sampled_rate


def _greatest(
    shaft: MisalignedShaft, model: Model, start: float, low: float, up: float
) -> tuple[float, float]:
    """Speed and rate of the fastest growth between two speeds; `start` where nothing better is found."""
    place, negative = find_minimum(
        lambda speed: -_rate(shaft, model, speed), low, up, tolerance=1e-9 * up, most=40
    )
    choices = (start, _rate(shaft, model, start)), (float(place), -float(negative))
    return max(choices, key=itemgetter(1))
