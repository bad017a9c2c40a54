"""Parametric stability of a driven shaft on bearings: its joint's couple follows the tilt of the shaft.

The shaft is taken for rigid, as Zhu and Wang do: it turns about the centre of the joint that drives it, held by its
supports. Where it bends about as easily as it tilts, that is said and nothing is computed.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np

from torsion.analyses.joints.line import Placed
from torsion.analyses.lateral.misaligned import EXACT, MisalignedShaft, Model, growth
from torsion.analyses.lateral.misaligned_zones import Zone, resonances, zones
from torsion.arrays import FloatArray
from torsion.assembly.lateral.line import BendingShaft, JointAt
from torsion.assembly.lateral.shaft import Beam, Segment
from torsion.kernels.misaligned_joint import small_angle_part
from torsion.results import derived, reported, result

Torques = Callable[[FloatArray], FloatArray]  # speeds, rad/s -> N m of the joint's driving shaft
Bending = tuple[FloatArray, FloatArray]
RIGID = 0.1  # a lowest frequency that bending lowers by a larger share is not that of a rigid shaft
POINTS = 201  # speeds of the curve of growth, beside those around resonances
MEAN = "mean couple"
OF_MEAN = Model(lambda turned, tilt: small_angle_part(turned, sine=0.0, cosine=0.0, constant=1.0))


@reported
class Tilting:
    """How fast small tilting motions of a rigid shaft grow over the speed of its joint's driving shaft."""

    joint: str = result("", (), "that drives the shaft")
    shaft: MisalignedShaft  # `length` 1 m and `torque` 1 N m: stiffness N m/rad, load N m
    frequency: tuple[float, float]  # Hz of y and of z at rest, without torque
    speed: FloatArray  # (speeds,) rad/s of the driving shaft
    growth: FloatArray = result("1/s", ("speed",), "of the fastest small motion; positive: unstable")
    zones: tuple[Zone, ...] = result("", (), "unstable ranges", key="unstable")
    ratio: float  # speed of the driving shaft / reference speed

    @derived("kg*m**2", (), "about the centre of the joint")
    def transverse_inertia(self) -> float:
        """Of the shaft."""
        return self.shaft.inertia

    @derived("kg*m**2", (), "of the same body")
    def polar_inertia(self) -> float:
        """Of the shaft."""
        return self.shaft.polar * self.shaft.inertia

    @derived("", (), "of the tilt at rest", key="frequency_Hz")
    def frequency_by_plane(self) -> dict[str, float]:
        """Hz, along the normal of the joint's plane and in the plane."""
        return dict(zip("yz", self.frequency, strict=True))

    @derived("rad/s", ("speed",), "reference speeds", key="speed_rad_per_s")
    def reference_speed(self) -> FloatArray:
        """(speeds,)."""
        return self.speed / self.ratio

    @property
    def is_damped(self) -> bool:
        """Both directions of the tilt are damped."""
        return min(self.shaft.damping) > 0.0


def tilting(
    shaft: BendingShaft, placed: Sequence[Placed], torque: Torques, speeds: FloatArray, bending: Bending
) -> tuple[Tilting | None, str]:
    """Growth and unstable ranges of the tilt, and why there are none; torque, speeds (rad/s) are of the reference.

    bending: (modes,) Hz of y and of z at rest, of the same shaft as it bends.
    """
    why = _untold(shaft, placed)
    if why is not None:
        return None, why
    joint = next(one for one in placed if one.part == shaft.joints[0].part)
    ratio = float(joint.ratio)
    last = float(speeds[-1]) * ratio
    first = max(float(speeds[0]) * ratio, last / POINTS)
    rigid = _rigid(shaft.beam, shaft.joints[0], joint.joint.angle, lambda own: torque(own / ratio))
    z, y = (np.sqrt(rigid.square) / (2.0 * np.pi)).tolist()  # the angle about y moves the shaft along z
    if why := _too_soft((y, z), bending):
        return None, why
    unstable = tuple(replace(_named(rigid, zone), ratio=ratio) for zone in zones(rigid, first, last, EXACT))
    around = [speed for zone in unstable for speed in _around(zone) if first < speed < last]
    known = [one for one in resonances(rigid).values() if first < one < last]
    grid = np.unique(np.concatenate([np.linspace(first, last, POINTS), known, around]))
    return Tilting(joint.name, rigid, (y, z), grid, growth(rigid, grid).rate, unstable, ratio), ""


def _around(zone: Zone) -> list[float]:
    """Speeds in a zone, as far again on both sides, and its own."""
    wide = zone.upper - zone.lower
    return [zone.lower, zone.worst, zone.upper, *np.linspace(zone.lower - wide, zone.upper + wide, 37).tolist()]


def _untold(shaft: BendingShaft, placed: Sequence[Placed]) -> str | None:
    """Why the tilt of a held shaft is left out, "" where there is none to speak of; None where it is told."""
    if len(shaft.joints) != 1 or not any(max(point.stiffness) for point in shaft.beam.points):
        return ""
    at = shaft.joints[0]
    if at.shaft == "driving":
        return "it drives its joint; the parametric terms of its tilt are built for driven shafts"
    if next(one for one in placed if one.part == at.part).joint.kind != "cross":
        return "the parametric terms of its tilt are built for cross joints"
    return None


def _too_soft(frequency: tuple[float, float], bending: Bending) -> str:
    """Why the shaft is not rigid; empty where it is."""
    for plane, rigid, soft in zip("yz", frequency, bending, strict=True):
        if soft.size and soft[0] < (1.0 - RIGID) * rigid:
            return (
                f"it bends too easily to be taken for rigid (lowest frequency in {plane} {soft[0]:.4g} Hz, rigid "
                f"{rigid:.4g} Hz); the parametric stability of its tilt is left out"
            )
    return ""


def _rigid(beam: Beam, joint: JointAt, tilt: float, torque: Torques) -> MisalignedShaft:
    """The whole beam as one body about the centre of its joint."""
    centre = beam.points[joint.point].at
    transverse, polar = np.sum([*_pieces(beam, centre), *_masses(beam, centre)], axis=0).tolist()
    arms = np.array([(point.at - centre) ** 2 for point in beam.points])
    stiffness, damping = (arms @ np.array([getattr(p, what) for p in beam.points]) for what in ("stiffness", "damping"))
    return MisalignedShaft(
        transverse, polar / transverse, 1.0, tuple(stiffness.tolist()), tuple(damping.tolist()), 1.0, tilt, torque
    )


def _pieces(beam: Beam, centre: float) -> Iterator[tuple[float, float]]:
    """Transverse inertia about the centre and polar inertia of every segment, kg m2."""
    starts = accumulate((segment.length for segment in beam.segments), initial=0.0)  # and the end
    for segment, start in zip(beam.segments, starts, strict=False):
        yield _piece(segment, start - centre)


def _piece(segment: Segment, start: float) -> tuple[float, float]:
    """Five points of Gauss are exact for the sixth degree of a cone."""
    node, weight = np.polynomial.legendre.leggauss(5)
    share = 0.5 * (1.0 + node)
    outer, bore = (ends[0] + (ends[1] - ends[0]) * share for ends in (segment.outer, segment.bore))
    slice_ = 0.5 * segment.length * weight * segment.density * np.pi
    area, second = (outer**2 - bore**2) / 4.0, (outer**4 - bore**4) / 64.0
    place = start + segment.length * share
    return float(slice_ @ (area * place**2 + second)), float(slice_ @ (2.0 * second))


def _masses(beam: Beam, centre: float) -> Iterator[tuple[float, float]]:
    for point in beam.points:
        yield point.mass * (point.at - centre) ** 2 + point.diametral, point.polar


def _named(shaft: MisalignedShaft, zone: Zone) -> Zone:
    """A zone that the mean part of the couple alone makes as strongly has its name."""
    alone = float(growth(shaft, np.array([zone.worst]), OF_MEAN).rate[0])
    return replace(zone, kind=MEAN) if alone > 0.5 * zone.rate else zone
