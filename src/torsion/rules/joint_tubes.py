"""Tubes between two universal joints, and the speed at which they would bend."""

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from torsion.primitives import Bar, Constraint, Spring
from torsion.train import Train


@dataclass(frozen=True)
class Tube:
    """The shaft from one joint to the next."""

    name: str
    parts: tuple[int, ...]  # of its shafts
    ratio: Fraction  # its speed / reference speed
    critical: float  # rad/s, lowest bending frequency without supports; NaN where it has some or something lacks
    lacks: str  # why it is not judged; empty where it is
    has_support: bool = False  # between the joints, so that the analysis of bending knows its critical speeds


def tubes(train: Train) -> tuple[Tube, ...]:
    """Every shaft between a joint and the one before it; none where rigid or elastic links alone join the two."""
    joints = {mesh.part: mesh for mesh in train.constraints}
    found = [_tube(train, joints[mesh.after], mesh) for mesh in train.constraints if mesh.after is not None]
    return tuple(tube for tube in found if tube is not None)


def critical_speed(length: float, outer: float, bore: float, modulus: float, density: float) -> float:
    """pi^2/4 sqrt(E/rho) sqrt(D^2 + d^2)/L^2, rad/s: first bending frequency of a simply supported tube (Euler).

    In the joint makers' form 15 pi/2 sqrt(E/rho) sqrt(D^2 + d^2)/L^2 per minute.
    """
    return math.pi**2 / 4.0 * math.sqrt(modulus / density) * math.hypot(outer, bore) / length**2


def _tube(train: Train, first: Constraint, second: Constraint) -> Tube | None:
    pieces = list(_between(train, first.driven, second.driving))
    bars = [piece for piece in pieces if isinstance(piece, Bar)]
    if not bars:
        return None
    names = ", ".join(bar.name for bar in bars)
    ratio, bar, parts = train.stations[bars[0].driving].ratio, bars[0], tuple(bar.part for bar in bars)
    if any(train.shaft(bar).support for bar in bars):
        return Tube(names, parts, ratio, math.nan, _cannot_bend(train, parts), has_support=True)
    lacks, critical = "", math.nan
    material = train.materials[train.shaft(bar).material]
    if len(bars) > 1 or any(isinstance(piece, Spring) and piece.flexibility > 0 for piece in pieces):
        lacks = "it is not one tube from joint to joint"
    elif bar.section is not None:
        lacks = "its section is a mesh, which is not solved for bending"
    elif bar.outer[0] != bar.outer[1] or bar.bore[0] != bar.bore[1]:
        lacks = "it is conical"
    elif material.youngs_modulus is None or material.density == 0:
        lacks = "its material has no `youngs_modulus` or no density"
    else:
        critical = critical_speed(bar.length, bar.outer[0], bar.bore[0], material.youngs_modulus, material.density)
    return Tube(names, parts, ratio, critical, lacks)


def _cannot_bend(train: Train, parts: tuple[int, ...]) -> str:
    """Why the bending of shafts on supports is not computed; empty where it is."""
    from torsion.analyses.lateral.bending_shafts import bending_shafts

    shafts, _ = bending_shafts(train)
    return "; ".join(shaft.lacks for shaft in shafts if shaft.lacks and set(shaft.parts) & set(parts))


def _between(train: Train, start: int, end: int) -> Iterator[Spring | Bar]:
    """What lies on the way from one station to another, along springs and shafts."""
    pieces: list[Spring | Bar] = [*train.springs, *train.bars]
    near: dict[int, list[tuple[int, Spring | Bar]]] = {}
    for piece in pieces:
        near.setdefault(piece.driving, []).append((piece.driven, piece))
        near.setdefault(piece.driven, []).append((piece.driving, piece))
    reached: dict[int, tuple[int, Spring | Bar] | None] = {start: None}
    queue = deque([start])
    while queue and end not in reached:
        here = queue.popleft()
        for there, piece in near.get(here, ()):
            if there not in reached:
                reached[there] = (here, piece)
                queue.append(there)
    at = reached.get(end)
    while at is not None:
        yield at[1]
        at = reached[at[0]]
