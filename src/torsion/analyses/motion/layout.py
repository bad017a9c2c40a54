"""The train as a mechanism: bodies that turn as one, joints between them, springs, and the coordinates that are free.

All is referred to one speed: angle = own angle / speed ratio. Bodies joined by joints follow one coordinate, the angle
of the body in front of the joints (or of the held body among them, whose motion is prescribed).
"""

from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm

import numpy as np

from torsion.analyses.motion.joints import JointMap, joint_map
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError


@dataclass(frozen=True)
class JointStep:
    """A joint on the way from a coordinate's own body outward."""

    inner: int  # body
    outer: int
    joint: JointMap


@dataclass(frozen=True)
class Dampers:
    """Viscous dampers across several springs at once: torque of the springs = onto (size * ontoᵀ rate of twist)."""

    onto: FloatArray  # (springs, dampers) unit columns
    size: FloatArray  # (dampers,) N m s/rad; or (dampers, times) where it differs


@dataclass(frozen=True)
class Layout:
    """The mechanism of a train; coordinates below `free` are unknown, the others follow the mean motion exactly."""

    body: IntArray  # (stations,)
    inertia: FloatArray  # (bodies,) kg m2; 0 where held
    coordinate: IntArray  # (bodies,)
    root: IntArray  # (coordinates,) the body whose angle each coordinate is
    free: int
    steps: tuple[JointStep, ...]  # from the coordinates' own bodies outward
    spring: IntArray  # (springs,) spans with stiffness or damping
    driving: IntArray  # (springs,) bodies
    driven: IntArray
    stiffness: FloatArray  # (springs,) N m/rad
    viscous: FloatArray  # (springs,) N m s/rad
    hysteretic: FloatArray  # (springs,) N m/rad: stiffness times loss factor
    dampers: Dampers  # what stands for loss factors that are not in `hysteretic`; none unless put there
    floating: tuple[tuple[int, ...], ...]  # coordinates that hang together by springs and by nothing held
    orders: tuple[Fraction, ...]  # of the joints, per turn of the reference station, ascending

    @property
    def bodies(self) -> int:
        """Number of bodies."""
        return len(self.inertia)

    @property
    def order(self) -> Fraction:
        """Of the common period of all joints, per turn of the reference station; 0 without joints."""
        return common_order(list(self.orders))

    @property
    def loose(self) -> BoolArray:
        """(groups, free) members of the floating groups that no joint is in and that others drive by damping alone.

        No force depends on the angle of such a group.
        """
        if len(self.floating) < 2:
            return np.zeros((0, self.free), dtype=bool)
        driven = {int(self.coordinate[step.outer]) for step in self.steps}
        groups = [np.isin(np.arange(self.free), group) for group in self.floating if not driven & set(group)]
        return np.array(groups, dtype=bool).reshape(-1, self.free)


def layout(system: System) -> Layout:
    """The mechanism of a system; raises SolveError where joints close a loop."""
    rigid = system.flexibility == 0
    joints = np.array([bool(span.error) for span in system.spans], dtype=bool)
    if np.any(joints & ~rigid):
        raise SolveError("a mesh with a transmission error and a flexibility is not built in the exact motion")
    body = _bodies(system, rigid & ~joints)
    number = int(body.max()) + 1
    inertia = np.zeros(number)
    np.add.at(inertia, body, np.where(system.held, 0.0, system.inertia) * system.speed_ratio**2)
    held = np.zeros(number, dtype=bool)
    held[body[system.held]] = True
    coordinate, root, free, steps = _coordinates(system, body, held, np.flatnonzero(joints))
    springs = np.flatnonzero(~rigid & (np.isfinite(system.flexibility) | (system.viscous > 0)))
    ratio2 = system.span_ratio[springs] ** 2
    stiffness = np.zeros(len(springs))
    elastic = np.isfinite(system.flexibility[springs])
    stiffness[elastic] = ratio2[elastic] / system.flexibility[springs][elastic]
    driving, driven = body[system.driving[springs]], body[system.driven[springs]]
    return Layout(
        body, inertia, coordinate, root, free, steps, springs, driving, driven, stiffness,
        system.viscous[springs] * ratio2, stiffness * system.loss_factor[springs],
        Dampers(np.zeros((len(springs), 0)), np.zeros(0)),
        _floating(coordinate, free, driving[elastic], driven[elastic], len(root)), _joint_orders(system, joints),
    )  # fmt: skip


def common_order(orders: list[Fraction]) -> Fraction:
    """The greatest order of which all are whole multiples; 0 of none."""
    if not orders:
        return Fraction(0)
    below = lcm(*(order.denominator for order in orders))
    return Fraction(gcd(*(order.numerator * (below // order.denominator) for order in orders)), below)


def _joint_orders(system: System, joints: BoolArray) -> tuple[Fraction, ...]:
    spans = [system.spans[k] for k in np.flatnonzero(joints).tolist()]
    return tuple(sorted({order * system.stations[span.driving].ratio for span in spans for order, _ in span.error}))


def _roots(number: int, first: IntArray, second: IntArray) -> IntArray:
    """(number,) the smallest member of the group of each, joined pair by pair."""
    group = list(range(number))

    def root(a: int) -> int:
        while group[a] != a:
            group[a] = group[group[a]]
            a = group[a]
        return a

    for a, b in zip(first.tolist(), second.tolist(), strict=True):
        low, high = sorted((root(a), root(b)))
        group[high] = low
    return np.array([root(a) for a in range(number)])


def _bodies(system: System, joined: BoolArray) -> IntArray:
    """(stations,) the body of each station: stations joined rigidly turn as one; bodies count from 0."""
    group = _roots(len(system.stations), system.driving[joined], system.driven[joined])
    return np.unique(group, return_inverse=True)[1]


def _coordinates(
    system: System, body: IntArray, held: BoolArray, joints: IntArray
) -> tuple[IntArray, IntArray, int, tuple[JointStep, ...]]:
    """Coordinate of each body, own body of each coordinate, number of free ones, and the joints in order."""
    spans = [system.spans[k] for k in joints.tolist()]
    near: dict[int, list[tuple[int, JointMap, bool]]] = {}
    for span in spans:
        a, b, joint = int(body[span.driving]), int(body[span.driven]), joint_map(system, span)
        near.setdefault(a, []).append((b, joint, True))
        near.setdefault(b, []).append((a, joint, False))
    number = len(held)
    driven = np.zeros(number, dtype=bool)
    driven[body[[span.driven for span in spans]]] = True
    starts = [*np.flatnonzero(held).tolist(), *np.flatnonzero(~held & ~driven).tolist(), *range(number)]
    owner, steps, roots = np.full(number, -1), list[JointStep](), list[int]()
    for start in starts:
        if owner[start] >= 0:
            continue
        roots.append(start)
        owner[start] = len(roots) - 1
        met = [start]
        for inner in met:
            for outer, joint, is_forward in near.get(inner, []):
                if owner[outer] >= 0:
                    continue
                owner[outer] = owner[inner]
                steps.append(JointStep(inner, outer, joint if is_forward else joint.undone()))
                met.append(outer)
    if len(steps) < len(spans):
        raise SolveError("joints close a loop, or hold one body from two sides; give one of them an elastic coupling")
    free_first = np.argsort([held[one] for one in roots], kind="stable")
    place = np.empty(len(roots), dtype=np.int64)
    place[free_first] = np.arange(len(roots))
    root = np.array(roots, dtype=np.int64)[free_first]
    return place[owner], root, int(np.count_nonzero(~held[root])), tuple(steps)


def _floating(
    coordinate: IntArray, free: int, driving: IntArray, driven: IntArray, number: int
) -> tuple[tuple[int, ...], ...]:
    """Groups of free coordinates that elastic springs join, without those that hang on a prescribed one."""
    group = _roots(number, coordinate[driving], coordinate[driven])
    held = set(group[free:].tolist())
    names = [one for one in np.unique(group[:free]).tolist() if one not in held]
    return tuple(tuple(np.flatnonzero(group[:free] == one).tolist()) for one in names)
