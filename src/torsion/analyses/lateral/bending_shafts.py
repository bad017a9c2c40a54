"""The shafts of a train that bend: each from joint to joint or end, with its supports, by the train's own data."""

from dataclasses import dataclass
from fractions import Fraction
from operator import itemgetter
from typing import Literal

import numpy as np

from torsion.analyses.lateral.beam_matrices import Beam, LateralSystem, Point, Segment
from torsion.arrays import FloatArray
from torsion.errors import Fault, Path, SolveError
from torsion.kernels.trees.tree import connected
from torsion.model.shafts.shaft_details import Support, both_ends
from torsion.primitives import Bar
from torsion.train import Train

SOFTEST = 1e-8  # of E I/L^3: the lowest frequency is wrong by about 1e-13 over this share (measured), here 1e-5
Side = Literal["driving", "driven"]
SIDES: tuple[Side, Side] = ("driven", "driving")


@dataclass(frozen=True, slots=True)
class JointAt:
    """A joint at an end of a shaft."""

    part: int  # of the joint
    point: int  # of the beam
    shaft: Side  # which of the joint's two shafts this one is


@dataclass(frozen=True)
class BendingShaft:
    """Shafts in a row without joint, gear or elastic coupling between them; it bends as one."""

    name: str
    parts: tuple[int, ...]  # its shafts, in the direction of power flow
    ratio: Fraction  # its speed / reference speed
    beam: Beam
    joints: tuple[JointAt, ...]  # before it, then behind it
    loads: tuple[str, ...]  # components that stand on it, whose mass the file does not say
    lacks: str = ""  # why its bending is not computed; empty where it is
    place: Path = ()  # of the key in the file that this is about; empty where it is about none


def bending_shafts(train: Train) -> tuple[tuple[BendingShaft, ...], list[Fault]]:
    """Return every shaft line of a train, and the faults of their data.

    Joints hold both their shafts in place and let them tilt; everything else but a `support` leaves them free.
    """
    # The same number for stations that are joined rigidly.
    rigid = [(spring.driving, spring.driven) for spring in train.springs if spring.flexibility == 0]
    ends = np.array(rigid, dtype=np.int64).reshape(-1, 2)
    node: list[int] = connected(len(train.stations), ends[:, 0], ends[:, 1]).tolist()

    # Distributed shafts that touch each other; in a row each starts where the one before it ends.
    ends = np.array([(node[bar.driving], node[bar.driven]) for bar in train.bars], dtype=np.int64)
    group = connected(len(train.stations), *ends.reshape(-1, 2).T).tolist()
    rows: dict[int, list[Bar]] = {}
    for bar in train.bars:
        number = group[node[bar.driving]]
        rows[number] = [*rows.pop(number, []), bar]
    faults: list[Fault] = []
    shafts = tuple(_shaft(train, row, node, faults) for row in rows.values())
    return shafts, faults


def _shaft(train: Train, row: list[Bar], node: list[int], faults: list[Fault]) -> BendingShaft:
    names = ", ".join(bar.name for bar in row)
    parts = tuple(bar.part for bar in row)
    ratio = train.stations[row[0].driving].ratio
    stations = [node[row[0].driving], *(node[bar.driven] for bar in row)]
    if [node[bar.driving] for bar in row] != stations[:-1] or len(set(stations)) < len(stations):
        return BendingShaft(names, parts, ratio, Beam(()), (), (), "it branches")

    # The joints by their position among the stations; those that share one have one pinned point.
    joints = [
        (stations.index(node[getattr(mesh, side)]), mesh.part, side)
        for mesh in train.constraints
        if train.parts[mesh.part].joint is not None
        for side in SIDES
        if node[getattr(mesh, side)] in stations
    ]
    joints.sort(key=itemgetter(0))
    part_at: dict[int, int] = {}
    for position, part, _ in joints:
        part_at.setdefault(position, part)
    points = [
        Point(sum(bar.length for bar in row[:position]), train.parts[part].name, fixation="pinned")
        for position, part in part_at.items()
    ]
    held = list(part_at)
    joints_at = tuple(JointAt(part, held.index(position), side) for position, part, side in joints)

    before = len(faults)
    of_material = []
    segments = []
    for bar in row:
        material = train.shaft(bar).material
        modulus = train.materials[material].youngs_modulus
        if modulus is None:
            path = (*train.parts[bar.part].path, "material")
            message = f"bending needs the `youngs_modulus` of '{material}'"
            of_material.append(Fault(path, message, f"write it under materials: {material}"))
        sizes = bar.length, bar.outer, bar.bore, modulus or 1.0
        segments.append(Segment(*sizes, bar.density, bar.shear_modulus, bar.loss_factor))
    supports, given = _supports(train, row, bool(held) and held[0] > 0, faults)
    points += supports
    beam = Beam(tuple(segments), tuple(points), names)
    lacks, path = "", Path()
    if set(held) - {0, len(row)}:
        lacks = "a joint lies between its ends"
    elif len(faults) == before:
        lacks, path = _lacking(train, row, beam, given)
    faults += [] if lacks else of_material
    on_shaft = {station for station in range(len(node)) if node[station] in stations}
    loads = tuple(
        part.name
        for number, part in enumerate(train.parts)
        if number not in parts and not (part.joint or part.is_bar) and on_shaft & set(part.stations)
    )
    return BendingShaft(names, parts, ratio, beam, joints_at, loads, lacks, path)


def _supports(
    train: Train, row: list[Bar], is_from_behind: bool, faults: list[Fault]
) -> tuple[list[Point], list[tuple[Support, Path]]]:
    """The supports of every shaft, counted from its end that faces the joint; and where each stands in the file."""
    points = []
    given = []
    begin = 0.0
    for bar in row:
        name = train.parts[bar.part].name
        supports = train.shaft(bar).support
        for number, support in enumerate(supports):
            path: Path = (*train.parts[bar.part].path, "support")
            path = path if len(supports) == 1 else (*path, number)
            given.append((support, path))
            if support.at > bar.length:
                message = f"the support lies {support.at:g} m along a shaft of {bar.length:g} m"
                faults.append(Fault((*path, "at"), message, "at most the length of the shaft"))
                continue
            points.append(
                Point(
                    begin + (bar.length - support.at if is_from_behind else support.at),
                    f"support of {name}" + (f" {number + 1}" if len(supports) > 1 else ""),
                    support.mass,
                    stiffness=both_ends(support.stiffness),
                    damping=both_ends(support.damping),
                )
            )
        begin += bar.length
    return points, given


def _lacking(
    train: Train, row: list[Bar], beam: Beam, given: list[tuple[Support, Path]]
) -> tuple[str, Path]:
    """Why a shaft made of `row` cannot be computed, with the key it is about; empty where it can.

    A section that is a mesh has no diameters; joints and supports must hold it in both planes, and stiffly enough to
    differ from none; and it needs a mass.
    """
    of_mesh = [bar for bar in row if bar.section is not None]
    if of_mesh:
        path = (*train.parts[of_mesh[0].part].path, "section")
        return "its section is a mesh, and bending needs diameters", path
    free = [beam.rigid_motions(plane) for plane in (0, 1)]
    if any(free) and not given:
        why = "it needs a joint at either end, a joint and a `support`, or two supports"
        return f"it is not supported: {why}", ()
    if free[0] != free[1]:
        plane = free.index(max(free))
        path = next(path for support, path in given if not both_ends(support.stiffness)[plane] > 0)
        why = "in which its support has no stiffness"
        return f"it is not supported in the plane {'yz'[plane]}, {why}", (*path, "stiffness")
    if any(free) and len({point.at for point in beam.points}) < len(beam.points):
        pinned = any(point.fixation == "pinned" for point in beam.points)
        where = "on the joint itself" if pinned else "where another does"
        why = f"it is supported at one place only, because its support lies {where}"
        return why, (*given[-1][1], "at")
    if any(free):
        why = "add another `support`, or a joint at an end"
        return f"it is supported at one place only: {why}", given[-1][1]
    if given and (hold := min(beam.hold(0), beam.hold(1))) < SOFTEST:
        bent = f"{beam.bending_stiffness:.3g} N/m, E I/L^3"
        why = f"its supports hold it with {hold:.2g} of its bending stiffness ({bent}), which is too soft"
        _, path = min(given, key=lambda pair: min(pair[0].stiffness))
        return f"{why} to compute; at least {SOFTEST:g} of it is needed", (*path, "stiffness")
    if not any(bar.density for bar in row) and not any(point.mass for point in beam.points):
        path = (*train.parts[row[0].part].path, "material")
        return "it has no mass: neither its material a density nor a support a `mass`", path
    return "", ()


EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Plane:
    """One plane; shapes (unknowns, modes) have the elastic energy 1/2 and the kinetic energy square/2."""

    shape: FloatArray
    square: FloatArray  # (modes,) 1/frequency^2, s2, descending; 0 of a mode without inertia


@dataclass(frozen=True)
class Planes:
    """A turning shaft in modal coordinates p, for motions exp(i w t): (1 - w2 M + i w C + w Omega G) p = load.

    Isotropic supports: p is that of y + i z, of length n; w < 0 is backward whirl. Else p holds y and i z, of length
    2 n. All matrices are real and symmetric.
    """

    system: LateralSystem
    y: Plane
    z: Plane  # `y` itself where the supports are isotropic
    square: FloatArray  # (coordinates,) s2: M
    gyroscopic: FloatArray  # (coordinates, coordinates) s2: G
    damping: FloatArray  # (coordinates, coordinates) s: C, dampers of the supports
    lossy: FloatArray  # (coordinates, coordinates) 1: stiffness of the shaft times its loss factors
    crossed: FloatArray  # (n, n) 1: the same between a shape of y and one of z

    @property
    def is_isotropic(self) -> bool:
        """The supports are alike in both planes, which are then one."""
        return self.y is self.z


def planes(system: LateralSystem) -> Planes:
    """Return the modal coordinates of a shaft on its joints and supports; raises SolveError where it is not supported."""
    for name, plane in (("y", 0), ("z", 1)):
        if system.beam.rigid_motions(plane):
            where = system.beam.name or "the shaft"
            raise SolveError(
                f"{where} is not supported in the plane {name}; give it a `support`, or a joint at either end"
            )
    y = _plane(system, 0)
    # With supports that are the same in both planes one stands for both.
    supports = [sides for p in system.beam.points for sides in (p.stiffness, p.damping)]
    isotropic = all(in_y == in_z for in_y, in_z in supports)
    z = y if isotropic else _plane(system, 1)
    turning, crossed = (
        y.shape.T @ matrix @ z.shape for matrix in (system.gyroscopic, system.lossy)
    )
    dampers = [system.support("damping", plane) for plane in (0, 1)]
    damping, lossy = (
        [plane.shape.T @ matrix @ plane.shape for plane, matrix in zip((y, z), pair, strict=True)]
        for pair in (dampers, (system.lossy, system.lossy))
    )
    if isotropic:
        return Planes(system, y, y, y.square, turning, damping[0], lossy[0], crossed)
    none = np.zeros_like(turning)
    square = np.concatenate([y.square, z.square])
    both_ways = np.block([[none, turning], [turning.T, none]])
    damps, loses = (np.block([[in_y, none], [none.T, in_z]]) for in_y, in_z in (damping, lossy))
    return Planes(system, y, z, square, both_ways, damps, loses, crossed)


def _plane(system: LateralSystem, plane: int) -> Plane:
    """Modes of a supported plane, by the inverse of the stiffness scaled to a diagonal of 1."""
    from scipy.linalg import cho_factor, eigh, solve_triangular

    stiffness = system.stiffness + system.support("stiffness", plane)
    free = np.ix_(system.free, system.free)
    scale = 1.0 / np.sqrt(np.diagonal(stiffness)[system.free])
    factor = np.tril(cho_factor(scale[:, None] * stiffness[free] * scale, lower=True)[0])
    half = solve_triangular(factor, scale[:, None] * system.inertia[free] * scale, lower=True)
    inverse = solve_triangular(factor, half.T, lower=True)
    square, turned = eigh((inverse + inverse.T) / 2.0)
    shape = np.zeros((stiffness.shape[0], len(square)))
    shape[system.free] = scale[:, None] * solve_triangular(
        factor, turned[:, ::-1], lower=True, trans="T"
    )
    square = square[::-1]
    return Plane(shape, np.where(square > len(square) * EPS * square[0], square, 0.0))
