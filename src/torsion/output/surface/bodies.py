"""The bodies that a train is drawn with: surfaces of revolution, each ring of them with the angle it has in a mode."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.kernels.round_sections import polar_area_moment, section_modulus
from torsion.primitives import Bar, Section

LENGTHS = {"coupling": 1.2, "joint": 1.0, "gear": 0.5, "motor": 1.3}  # of what has no length, in `Sizes.length`
THIN = 0.5  # of any other point
SHARE_OF_SHAFTS = 0.35  # everything without a length is drawn about this long, of the length of all shafts
FEWEST_RINGS, MOST_RINGS = 16, 200  # along a shaft
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
    kind: str
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
        at = np.unique(np.rint(np.linspace(0.0, number, MOST_RINGS)))
    else:
        times = -(-FEWEST_RINGS // number)
        at = np.arange(number * times + 1) / times
    piece = np.minimum(at.astype(np.int64), number - 1)
    driving, driven = system.driving[pieces], system.driven[pieces]
    outer, bore = (d[0] + (d[1] - d[0]) * at / number for d in (bar.outer, bar.bore))
    body = Body(
        bar.part, "shaft", start + bar.length * at / number, outer / 2, np.column_stack([driving, driven])[piece],
        _share(bar, at, piece, number) if _is_conical(bar) else at - piece, np.array(pieces)[piece[:-1]],
        _modulus(bar, outer, bore),
        0.0 if system.model == "lumped" else bar.length / number * math.sqrt(bar.density / bar.shear_modulus),
        to_scale=bar.section is None,
    )  # fmt: skip
    return _closed(body, bar.bore[0] / 2, bar.bore[1] / 2)


def _modulus(bar: Bar, outer: FloatArray, bore: FloatArray) -> FloatArray:
    """(rings - 1,) m3: torque / largest shear stress, at the weaker end of every strip."""
    if isinstance(bar.section, Section):
        return np.full(outer.size - 1, bar.section.stress_modulus)
    return section_modulus(np.minimum(outer[:-1], outer[1:]), np.maximum(bore[:-1], bore[1:]))


def _is_conical(bar: Bar) -> bool:
    return bar.outer[0] != bar.outer[1] or bar.bore[0] != bar.bore[1]


def _share(bar: Bar, at: FloatArray, piece: IntArray, number: int) -> FloatArray:
    """Share of each piece's flexibility up to its rings (Simpson's rule between two rings)."""

    def flexibility(place: FloatArray) -> FloatArray:
        outer, bore = (d[0] + (d[1] - d[0]) * place / number for d in (bar.outer, bar.bore))
        return 1.0 / polar_area_moment(outer, bore)

    middle = (at[:-1] + at[1:]) / 2
    step = (flexibility(at[:-1]) + 4.0 * flexibility(middle) + flexibility(at[1:])) * np.diff(at)
    along = np.append(0.0, np.cumsum(step))
    start = np.interp(np.arange(number + 1), at, along)
    return np.asarray((along - start[piece]) / (start[piece + 1] - start[piece]))


def _closed(body: Body, first: float, last: float) -> Body:
    """The body with a plane at either end, down to a radius (0: to the axis)."""

    def ends(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values[:1], values, values[-1:]])

    return Body(
        body.part, body.kind, ends(body.x), np.concatenate([[first], body.radius, [last]]), ends(body.between),
        ends(body.share), ends(body.span), ends(body.modulus), body.delay, body.to_scale,
    )  # fmt: skip


def _turned(
    part: int, kind: str, start: float, length: float, profile: tuple[tuple[float, float, float], ...],
    *, ends: tuple[int, int], span: int = -1, to_scale: bool = False,
) -> Body:  # fmt: skip
    """A body by its profile: place (share of the length), radius (m), share of the angle, ring by ring."""
    place, radius, share = np.array(profile).T
    strips = len(profile) - 1
    return Body(
        part, kind, start + length * place, radius, np.tile(np.array(ends, dtype=np.int64), (len(profile), 1)), share,
        np.full(strips, span, dtype=np.int64), np.full(strips, np.nan), to_scale=to_scale,
    )  # fmt: skip


def point(system: System, part: int, spans: list[int], start: float, size: Sizes) -> list[Body]:
    """A point: a disc on a hub, larger by the logarithm of its inertia, or as large as the file says."""
    placed = system.train.parts[part]
    kind, station = placed.kind, placed.stations[0]
    length = length_of(kind, size)
    given = None if placed.propeller is None else placed.propeller.diameter
    radius = given / 2 if given else size.diameter * (0.9 + 1.1 * _grown(float(system.inertia[station]), size))
    hub = min(0.6 * size.diameter, 0.8 * radius)
    rim = 0.12 if kind == "motor" else 0.25
    profile = disc_profile(hub, radius, rim)
    disc = _turned(part, kind, start, length, profile, ends=(station, station), to_scale=bool(given))
    hanging = [system.driven[k] for k in spans if kind == "damper" and system.driving[k] == station]
    rings = [_ring(part, int(ring), (start + rim * length, (1 - 2 * rim) * length), radius) for ring in hanging]
    return [disc, *rings]


def disc_profile(hub: float, radius: float, rim: float) -> tuple[tuple[float, float, float], ...]:
    """A disc between two ends of its hub."""
    return (
        (0.0, 0.0, 0.0), (0.0, hub, 0.0), (rim, hub, 0.0), (rim, radius, 0.0), (1.0 - rim, radius, 0.0),
        (1.0 - rim, hub, 0.0), (1.0, hub, 0.0), (1.0, 0.0, 0.0),
    )  # fmt: skip


def _ring(part: int, station: int, along: tuple[float, float], radius: float) -> Body:
    """The ring of a damper, around its housing."""
    profile = ((0.1, 1.05 * radius, 0.0), (0.1, 1.4 * radius, 0.0), (0.9, 1.4 * radius, 0.0), (0.9, 1.05 * radius, 0.0))
    return _turned(part, "ring", *along, profile, ends=(station, station))


def wheel(part: int, station: int, start: float, size: Sizes, radius: float) -> Body:
    """A gear wheel."""
    profile = disc_profile(min(0.55 * size.diameter, 0.8 * radius), radius, 0.2)
    return _turned(part, "wheel", start, length_of("gear", size), profile, ends=(station, station))


def coupling(part: int, ends: tuple[int, int], span: int, start: float, size: Sizes) -> Body:
    """A coupling (or any massless spring): two flanges that keep their angle, and what is elastic between them."""
    flange, waist = 0.85 * size.diameter, 0.65 * size.diameter
    middle = tuple((0.25 + 0.5 * k / 8, waist, k / 8) for k in range(9))
    profile = (
        (0.0, 0.0, 0.0), (0.0, flange, 0.0), (0.25, flange, 0.0), *middle, (0.75, flange, 1.0), (1.0, flange, 1.0),
        (1.0, 0.0, 1.0),
    )  # fmt: skip
    return _turned(part, "coupling", start, length_of("coupling", size), profile, ends=ends, span=span)


def joint(part: int, ends: tuple[int, int], span: int, start: float, size: Sizes) -> Body:
    """A universal joint, its two shafts in line: two yokes that meet in a waist."""
    yoke, waist = 0.8 * size.diameter, 0.25 * size.diameter
    profile = (
        (0.0, 0.0, 0.0), (0.0, yoke, 0.0), (0.3, yoke, 0.0), (0.5, waist, 0.5), (0.7, yoke, 1.0), (1.0, yoke, 1.0),
        (1.0, 0.0, 1.0),
    )  # fmt: skip
    return _turned(part, "joint", start, length_of("joint", size), profile, ends=ends, span=span)


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
