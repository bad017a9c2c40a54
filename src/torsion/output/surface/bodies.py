"""The bodies that a train is drawn with: surfaces of revolution, each ring of them with the angle it has in a mode."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.kernels.round_sections import polar_area_moment, section_modulus
from torsion.primitives import Bar, Section

LONG = ("motor", "turbine", "generator")  # kinds drawn long and with a thin rim
LENGTHS = {"coupling": 1.2, "joint": 1.0, "gear": 0.5, **dict.fromkeys(LONG, 1.3)}  # of `Sizes.length`
THIN = 0.5  # of any other point
SHARE_OF_SHAFTS = 0.35  # everything without a length is drawn about this long, of the length of all shafts
FEWEST_RINGS, MOST_RINGS = 16, 200  # along a shaft
CARRYING = ("damper", "pendulum")  # kinds with a ring of their own
RING = np.array([(0.1, 1.05, 0.0), (0.1, 1.4, 0.0), (0.9, 1.4, 0.0), (0.9, 1.05, 0.0)])  # its radius in the damper's
LINKS = {  # place, radius in the diameter of the shafts, share of the angle
    "coupling": np.array([  # two flanges that keep their angle, and what is elastic between them
        (0.0, 0.0, 0.0), (0.0, 0.85, 0.0), (0.25, 0.85, 0.0), *((0.25 + 0.5 * k / 8, 0.65, k / 8) for k in range(9)),
        (0.75, 0.85, 1.0), (1.0, 0.85, 1.0), (1.0, 0.0, 1.0),
    ]),
    "joint": np.array([  # two yokes that meet in a waist
        (0.0, 0.0, 0.0), (0.0, 0.8, 0.0), (0.3, 0.8, 0.0), (0.5, 0.25, 0.5), (0.7, 0.8, 1.0), (1.0, 0.8, 1.0),
        (1.0, 0.0, 1.0),
    ]),
}  # fmt: skip
DECADES = 3.0  # of inertia over which the discs of a train grow


@dataclass(frozen=True)
class Sizes:
    """What bodies without dimensions are drawn by, chosen to go with the shafts of the train."""

    length: float  # m
    diameter: float  # m, mean of the shafts
    inertia: tuple[float, float]  # kg m2: of the smallest and the largest disc


@dataclass(frozen=True)
class Body:
    """A surface of revolution, as rings from its driving to its driven end.

    A ring's angle in a mode of omega rad/s lies between those of two stations, as that of a uniform shaft in which a
    wave takes the time `delay` from one to the other.
    """

    part: int
    x: FloatArray  # (rings,) m along the axis
    radius: FloatArray  # (rings,) m; 0 is a point on the axis
    between: IntArray  # (rings, 2) stations
    share: FloatArray  # (rings,) of the way from the first station to the second
    span: IntArray  # (rings - 1,) whose torque the strip behind each ring carries; -1: none
    modulus: FloatArray  # (rings - 1,) m3: torque / shear stress; not a number where no diameter is known
    delay: float = 0.0  # s
    to_scale: bool = False  # its diameters are those of the file

    @property
    def widest(self) -> float:
        """m, its largest radius."""
        return float(self.radius.max())


def sizes(system: System) -> Sizes:
    """Lengths and diameters of what has none, for the whole train."""
    bars = system.train.bars
    known = [j for j in system.inertia.tolist() if 0 < j < math.inf] or [1.0]
    top = max(known)
    inertia = max(min(known), top * 10.0**-DECADES), top
    if not bars:
        return Sizes(0.1, 0.045, inertia)
    total = sum(bar.length for bar in bars)
    diameter = sum(sum(bar.outer) / 2 * bar.length for bar in bars) / total
    others = sum(LENGTHS.get(part.kind, THIN) for part in system.train.parts) - THIN * len(bars)
    length = min(SHARE_OF_SHAFTS * total / max(others, THIN), total / 16.0)
    return Sizes(max(length, diameter / 4.0), diameter, inertia)


def shaft(system: System, bar: Bar, spans: list[int], start: float) -> Body:
    """A shaft of true length and diameters, with a plane (of a tube: an annulus) at either end.

    One whose section is a mesh is drawn as the circle with its polar moment.
    Its stations divide it evenly. Between two of them the angle of a lumped shaft follows the flexibility; that of a
    shaft with distributed inertia follows the wave.
    """
    pieces = [k for k in spans if system.flexibility[k] > 0]
    number = len(pieces)
    if number >= MOST_RINGS:
        rings = np.unique(np.rint(np.linspace(0.0, number, MOST_RINGS)))
    else:
        times = -(-FEWEST_RINGS // number)
        rings = np.arange(number * times + 1) / times
    at = np.pad(rings, 1, mode="edge")  # the first and the last are the inner edges of the ends
    piece = np.minimum(at.astype(np.int64), number - 1)
    outer, bore = _diameters(bar, rings / number)
    return Body(
        bar.part, start + bar.length * at / number, np.concatenate([bore[:1], outer, bore[-1:]]) / 2,
        np.column_stack([system.driving[pieces], system.driven[pieces]])[piece], _share(bar, at, piece, number),
        np.array(pieces)[piece[:-1]], np.pad(_modulus(bar, outer, bore), 1, mode="edge"),
        0.0 if system.model == "lumped" else bar.length / number * math.sqrt(bar.density / bar.shear_modulus),
        to_scale=bar.section is None,
    )  # fmt: skip


def _diameters(bar: Bar, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Outer diameter and bore, m, at shares of the length."""
    outer, bore = (first + (last - first) * place for first, last in (bar.outer, bar.bore))
    return outer, bore


def _modulus(bar: Bar, outer: FloatArray, bore: FloatArray) -> FloatArray:
    """(rings - 1,) m3: torque / largest shear stress, at the weaker end of every strip."""
    if isinstance(bar.section, Section):
        return np.full(outer.size - 1, bar.section.stress_modulus)
    return section_modulus(np.minimum(outer[:-1], outer[1:]), np.maximum(bore[:-1], bore[1:]))


def _share(bar: Bar, at: FloatArray, piece: IntArray, number: int) -> FloatArray:
    """Share of each piece's flexibility up to its rings (Simpson's rule between two rings)."""

    def flexibility(place: FloatArray) -> FloatArray:
        return 1.0 / polar_area_moment(*_diameters(bar, place / number))

    middle = (at[:-1] + at[1:]) / 2
    step = (flexibility(at[:-1]) + 4.0 * flexibility(middle) + flexibility(at[1:])) * np.diff(at)
    along = np.append(0.0, np.cumsum(step))
    start = np.interp(np.arange(number + 1), at, along)
    return np.asarray((along - start[piece]) / (start[piece + 1] - start[piece]))


def _turned(
    part: int, start: float, length: float, profile: FloatArray, ends: tuple[int, int], *, span: int = -1,
    to_scale: bool = False,
) -> Body:  # fmt: skip
    """A body by its profile: place (share of the length), radius (m), share of the angle, ring by ring."""
    place, radius, share = profile.T
    rings, strips = len(profile), len(profile) - 1
    return Body(
        part, start + length * place, radius, np.tile(np.array(ends, dtype=np.int64), (rings, 1)), share,
        np.full(strips, span, dtype=np.int64), np.full(strips, np.nan), to_scale=to_scale,
    )  # fmt: skip


def point(system: System, part: int, spans: list[int], start: float, size: Sizes) -> list[Body]:
    """A point: a disc on a hub, larger by the logarithm of its inertia, or as large as the file says.

    The ring of a damper lies around its housing, the bobs of a pendulum around their carrier.
    """
    placed = system.train.parts[part]
    kind, station = placed.kind, placed.stations[0]
    length = length_of(kind, size)
    given = None if placed.impeller is None else placed.impeller.diameter
    radius = given / 2 if given else size.diameter * (0.9 + 1.1 * _grown(float(system.inertia[station]), size))
    rim = 0.12 if kind in LONG else 0.25
    profile = _disc(min(0.6 * size.diameter, 0.8 * radius), radius, rim)
    disc = _turned(part, start, length, profile, (station, station), to_scale=bool(given))
    hanging = [int(system.driven[k]) for k in spans if kind in CARRYING and system.driving[k] == station]
    first, between = start + rim * length, (1 - 2 * rim) * length
    return [disc, *(_turned(part, first, between, RING * (1.0, radius, 1.0), (ring, ring)) for ring in hanging)]


def _disc(hub: float, radius: float, rim: float) -> FloatArray:
    """The profile of a disc between two ends of its hub."""
    place = [0.0, 0.0, rim, rim, 1.0 - rim, 1.0 - rim, 1.0, 1.0]
    return np.column_stack([place, [0.0, hub, hub, radius, radius, hub, hub, 0.0], np.zeros(8)])


def wheel(part: int, station: int, start: float, size: Sizes, radius: float) -> Body:
    """A gear wheel."""
    profile = _disc(min(0.55 * size.diameter, 0.8 * radius), radius, 0.2)
    return _turned(part, start, length_of("gear", size), profile, (station, station))


def link(part: int, kind: str, ends: tuple[int, int], span: int, start: float, size: Sizes) -> Body:
    """A coupling (or any massless spring), or a universal joint with its two shafts in line."""
    return _turned(part, start, length_of(kind, size), LINKS[kind] * (1.0, size.diameter, 1.0), ends, span=span)


def length_of(kind: str, size: Sizes) -> float:
    """m along the axis of what has no length."""
    return LENGTHS.get(kind, THIN) * size.length


def _grown(inertia: float, size: Sizes) -> float:
    """0 for the smallest disc of the train, 1 for the largest or a fixed one."""
    low, top = size.inertia
    if inertia == 0:
        return 0.0
    if math.isinf(inertia) or low == top:
        return 1.0
    return min(max(math.log(inertia / low) / math.log(top / low), 0.0), 1.0)
