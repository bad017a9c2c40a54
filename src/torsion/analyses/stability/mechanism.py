"""The train as a mechanism: bodies that turn as one, joints between them, springs, and the coordinates that are free.

All is referred to one speed: angle = own angle / speed ratio. Bodies joined by joints follow one coordinate, the angle
of the body in front of the joints (or of the fixed body among them, whose motion is prescribed).
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import Span, System
from torsion.errors import SolveError
from torsion.kernels.trees.tree import connected, walk


@dataclass(frozen=True)
class JointMap:
    """Driven angle = driving angle + error, at the own speeds of both sides.

    A cross joint is exact: error = -arg(1 - q exp(2 i (angle + yoke))), q = tan(joint angle/2)^2 (convention P); the
    map with -q undoes it. Any other joint is the Fourier sum of its constraint.
    """

    driving_ratio: float  # speed of the driving side / reference speed
    driven_ratio: float
    unevenness: float  # q; 0 where a series is used
    yoke: float  # rad
    series: tuple[tuple[int, complex], ...] = ()


def joint_map(system: System, span: Span) -> JointMap:
    """Return the map of a span with an error."""
    ratios = float(system.speed_ratio[span.driving]), float(system.speed_ratio[span.driven])
    joint = system.train.parts[span.part].joint
    if joint is None or joint.kind != "cross":
        return JointMap(*ratios, 0.0, 0.0, span.error)
    amplitude = span.error[0][1]
    return JointMap(*ratios, abs(amplitude), float(np.angle(1j * amplitude)) / 2.0)


def error(joint: JointMap, angle: FloatArray) -> FloatArray:
    """Return (4, ...) the transmission error (rad) and three derivatives over the driving angle, at own speed.

    With w = q z/(1 - q z): e' = 2 Re w, e'' = -4 Im(w + w^2), e''' = -8 Re(w (1 + w)(1 + 2 w)).
    """
    if joint.series:
        parts = [amplitude * np.exp(1j * order * angle) for order, amplitude in joint.series]
        return np.array(
            [
                sum(
                    ((1j * order) ** rank * part).real
                    for (order, _), part in zip(joint.series, parts, strict=True)
                )
                for rank in range(4)
            ]
        )
    turned = joint.unevenness * np.exp(2j * (angle + joint.yoke))
    w = turned / (1.0 - turned)
    bent = w * (1.0 + w)
    third = -8.0 * (bent * (1.0 + 2.0 * w)).real
    return np.array([-np.angle(1.0 - turned), 2.0 * w.real, -4.0 * bent.imag, third])


@dataclass(frozen=True)
class JointStep:
    """A joint on the way from a coordinate's own body to the others."""

    inner: int  # body
    outer: int
    joint: JointMap


@dataclass(frozen=True)
class Dampers:
    """Viscous dampers across several springs at once: torque of the springs = onto (size * ontoᵀ rate of twist)."""

    onto: FloatArray  # (springs, dampers) unit columns
    size: FloatArray  # (dampers,) N m s/rad


@dataclass(frozen=True)
class Layout:
    """The mechanism of a train; coordinates below `free` are unknown, the others follow the mean motion exactly."""

    body: IntArray  # (stations,)
    inertia: FloatArray  # (bodies,) kg m2; 0 where fixed
    coordinate: IntArray  # (bodies,)
    root: IntArray  # (coordinates,) the body whose angle each coordinate is
    free: int
    steps: tuple[JointStep, ...]  # from the coordinates' own bodies on
    spring: IntArray  # (springs,) spans with stiffness or damping
    driving: IntArray  # (springs,) bodies
    driven: IntArray
    stiffness: FloatArray  # (springs,) N m/rad
    viscous: FloatArray  # (springs,) N m s/rad
    hysteretic: FloatArray  # (springs,) N m/rad: stiffness times loss factor
    dampers: (
        Dampers  # what stands for loss factors that are not in `hysteretic`; none unless put there
    )
    floating: tuple[
        tuple[int, ...], ...
    ]  # coordinates that springs join to each other and to nothing fixed
    orders: tuple[Fraction, ...]  # of the joints, per turn of the reference station, ascending

    @cached_property
    def incidence(self) -> Any:
        """Sparse matrix (bodies, springs): 1 on the driving body of a spring, -1 on the driven one."""
        from scipy.sparse import csr_matrix

        springs = np.arange(len(self.driving))
        places = np.append(self.driving, self.driven), np.append(springs, springs)
        signs = np.repeat([1.0, -1.0], len(springs))
        return csr_matrix((signs, places), shape=(len(self.inertia), len(springs)))

    @cached_property
    def damper_twist(self) -> FloatArray:
        """(dampers, bodies): the twist of each damper is the sum over the bodies of it times their angles."""
        return np.asarray(self.incidence @ self.dampers.onto).T


def gathered(layout: Layout, onto: FloatArray) -> FloatArray:
    """Return (free, ...) on the free coordinates from what acts on the bodies (bodies, ...)."""
    out = onto[layout.root[: layout.free]]
    for step in layout.steps:  # every body that is no root stands behind one joint
        if (coordinate := layout.coordinate[step.outer]) < layout.free:
            out[coordinate] += onto[step.outer]
    return out


def layout(system: System) -> Layout:
    """Return the mechanism of a system; raises SolveError where joints close a loop."""
    rigid = system.flexibility == 0
    joints = np.array([bool(span.error) for span in system.spans], dtype=bool)
    if np.any(joints & ~rigid):
        raise SolveError(
            "a mesh with a transmission error and a flexibility is not built in the exact motion"
        )
    joined = rigid & ~joints  # stations that turn as one body
    first = connected(len(system.stations), system.driving[joined], system.driven[joined])
    body = np.unique(first, return_inverse=True)[1]
    number = int(body.max()) + 1
    inertia = np.zeros(number)
    np.add.at(inertia, body, np.where(system.held, 0.0, system.inertia) * system.speed_ratio**2)
    held = np.zeros(number, dtype=bool)
    held[body[system.held]] = True
    orders = {
        order * system.stations[system.spans[k].driving].ratio
        for k in np.flatnonzero(joints).tolist()
        for order, _ in system.spans[k].error
    }
    coordinate, root, free, steps = _coordinates(system, body, held, np.flatnonzero(joints))
    springs = np.flatnonzero(~rigid & (np.isfinite(system.flexibility) | (system.viscous > 0)))
    ratio2 = system.span_ratio[springs] ** 2
    stiffness = np.zeros(len(springs))
    elastic = np.isfinite(system.flexibility[springs])
    stiffness[elastic] = ratio2[elastic] / system.flexibility[springs][elastic]
    driving = body[system.driving[springs]]
    driven = body[system.driven[springs]]
    group = connected(len(root), coordinate[driving[elastic]], coordinate[driven[elastic]])
    floating = [
        np.flatnonzero(group[:free] == number_of_group).tolist()
        for number_of_group in np.setdiff1d(group[:free], group[free:])
    ]
    return Layout(
        body,
        inertia,
        coordinate,
        root,
        free,
        steps,
        springs,
        driving,
        driven,
        stiffness,
        system.viscous[springs] * ratio2,
        stiffness * system.loss_factor[springs],
        Dampers(np.zeros((len(springs), 0)), np.zeros(0)),
        tuple(tuple(group) for group in floating),
        tuple(sorted(orders)),
    )


def _coordinates(
    system: System, body: IntArray, held: BoolArray, joints: IntArray
) -> tuple[IntArray, IntArray, int, tuple[JointStep, ...]]:
    """Coordinate of each body, own body of each coordinate, number of free ones, and the joints in order."""
    number = len(held)
    driving = body[system.driving[joints]]
    driven = body[system.driven[joints]]
    in_front = np.setdiff1d(np.flatnonzero(~held), driven)
    starts = [*np.flatnonzero(held).tolist(), *in_front.tolist()]
    way = walk(number, driving, driven, np.ones(len(joints), dtype=bool), starts)
    root = np.flatnonzero(way.parent < 0)
    root = np.concatenate([root[~held[root]], root[held[root]]])
    coordinate = np.zeros(number, dtype=np.int64)
    steps = []
    coordinate[root] = np.arange(len(root))
    for outer in way.order[way.parent[way.order] >= 0].tolist():
        inner = int(way.parent[outer])
        above = way.above[outer]
        joint = joint_map(system, system.spans[joints[above]])
        if driving[above] != inner:
            if joint.series:
                raise SolveError(
                    "a tripod joint that is driven from its driven side by a fixed station is not built"
                )
            joint = replace(joint, unevenness=-joint.unevenness)
        steps.append(JointStep(inner, outer, joint))
        coordinate[outer] = coordinate[inner]
    if len(steps) < len(joints):
        raise SolveError(
            "joints close a loop, or hold one body from two sides; give one of them an elastic coupling"
        )
    return coordinate, root, int(np.count_nonzero(~held[root])), tuple(steps)
