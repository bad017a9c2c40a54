"""Lumped assembly: every shaft as segments, half of a segment's inertia at each of its ends."""

import math
from functools import cache

import numpy as np

from torsion.assembly.system import Span, System
from torsion.kernels.sections import polar_area_moment
from torsion.kernels.tree import FloatArray
from torsion.primitives import Bar, Station
from torsion.train import Train

SHARE_OF_ERROR = 1e-3  # a frequency of a lumped shaft is right to this share
FEWEST, MOST = 1, 20_000


def segments_for(bar: Bar, frequency: float) -> int:
    """Segments that keep the error of a frequency (Hz) below SHARE_OF_ERROR.

    n lumped segments lower a frequency by (mu/n)^2/24, with mu = omega length sqrt(density/shear modulus) the phase
    along the shaft (from 2n/mu sin(mu/2n), the closed form of a uniform chain). A cone is given twice as many.
    """
    if bar.segments is not None:
        return bar.segments
    if bar.density == 0:
        return 1
    phase = 2.0 * math.pi * frequency * bar.length * math.sqrt(bar.density / bar.shear_modulus)
    number = math.ceil(phase / math.sqrt(24.0 * SHARE_OF_ERROR))
    return min(max(number * (1 if _is_uniform(bar) else 2), FEWEST), MOST)


def _is_uniform(bar: Bar) -> bool:
    return bar.outer[0] == bar.outer[1] and bar.bore[0] == bar.bore[1]


def assemble_lumped(train: Train, *, frequency: float = 0.0) -> System:
    """The system in which every shaft has enough segments for a highest frequency (Hz)."""
    stations, spans = list(train.stations), []
    inertia = [0.0] * len(stations)
    for lump in train.inertias:
        inertia[lump.station] += lump.inertia
    flexibility, viscous, loss = [], [], []
    for spring in train.springs:
        spans.append(Span(spring.name, spring.part, spring.driving, spring.driven))
        flexibility.append(spring.flexibility)
        viscous.append(spring.viscous)
        loss.append(spring.loss_factor)
    for mesh in train.constraints:
        spans.append(Span(mesh.name, mesh.part, mesh.driving, mesh.driven, mesh.ratio, mesh.error))
        flexibility.append(mesh.flexibility)
        viscous.append(0.0)
        loss.append(0.0)
    segments: dict[str, int] = {}
    for bar in train.bars:
        segments[bar.name] = number = segments_for(bar, frequency)
        pieces, lumps = bar_segments(bar, number)
        ends = _stations(bar, number, stations, inertia)
        for piece in range(number):
            name = bar.name if number == 1 else f"{bar.name} [{piece + 1}]"
            spans.append(Span(name, bar.part, ends[piece], ends[piece + 1]))
        for end, lump in zip(ends, lumps.tolist(), strict=True):
            inertia[end] += lump
        flexibility.extend(pieces.tolist())
        viscous.extend([0.0] * number)
        loss.extend([bar.loss_factor] * number)
    return System(
        train, "lumped", tuple(stations), tuple(spans), np.array(inertia), np.array(flexibility),
        np.array(viscous), np.array(loss), train.dampers, segments,
    )  # fmt: skip


def _stations(bar: Bar, number: int, stations: list[Station], inertia: list[float]) -> list[int]:
    """Stations along a bar, the inner ones new."""
    first = stations[bar.driving]
    new = [Station(f"{bar.name} {k}/{number}", bar.part, first.ratio, first.sense) for k in range(1, number)]
    stations.extend(new)
    inertia.extend([0.0] * len(new))
    return [bar.driving, *range(len(stations) - len(new), len(stations)), bar.driven]


def bar_segments(bar: Bar, number: int) -> tuple[FloatArray, FloatArray]:
    """Flexibility (segments,) rad/(N m) and lumped inertia (segments + 1,) kg m2 along a bar, by exact integrals."""
    edge = np.linspace(0.0, 1.0, number + 1)
    x, weight = _gauss()
    at = edge[:-1, None] + (x + 1.0) / 2.0 / number
    outer = bar.outer[0] + (bar.outer[1] - bar.outer[0]) * at
    bore = bar.bore[0] + (bar.bore[1] - bar.bore[0]) * at
    area = polar_area_moment(outer, bore)
    length = bar.length / number
    mean_flexibility = (1.0 / area) @ weight / 2.0
    mean_inertia = area @ weight / 2.0
    flexibility = length * mean_flexibility / bar.shear_modulus
    half = bar.density * length * mean_inertia / 2.0
    return flexibility, np.concatenate([half, [0.0]]) + np.concatenate([[0.0], half])


@cache
def _gauss() -> tuple[FloatArray, FloatArray]:
    """Points in -1..1 and weights of a Gauss rule that is exact to rounding for every cone."""
    x, weight = np.polynomial.legendre.leggauss(24)
    return x, weight
