"""The train as a mechanism: bodies that turn as one, joints between them, springs, and the coordinates that are free.

All is referred to one speed: angle = own angle / speed ratio. Bodies joined by joints follow one coordinate, the angle
of the body in front of the joints (or of the fixed body among them, whose motion is prescribed).
"""

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.spans import Span
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.tree import connected, walk


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

    @property
    def strength(self) -> float:
        """Half of the amplitude by which the ratio varies: q of a cross joint, order times error / 2 of a series."""
        return (
            abs(self.unevenness)
            + sum(order * abs(amplitude) for order, amplitude in self.series) / 2.0
        )

    def undone(self) -> "JointMap":
        """Return the map from the driven side back; raises SolveError where only a series is known."""
        if self.series:
            raise SolveError(
                "a tripod joint that is driven from its driven side by a fixed station is not built"
            )
        return replace(self, unevenness=-self.unevenness)


def joint_map(system: System, span: Span) -> JointMap:
    """Return the map of a span with an error."""
    ratios = float(system.speed_ratio[span.driving]), float(system.speed_ratio[span.driven])
    joint = system.train.parts[span.part].joint
    if joint is None or joint.kind != "cross":
        return JointMap(*ratios, 0.0, 0.0, span.error)
    amplitude = span.error[0][1]
    return JointMap(*ratios, abs(amplitude), float(np.angle(1j * amplitude)) / 2.0)


def error(
    joint: JointMap, angle: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return the transmission error (rad) and its derivatives over the driving angle, at driving angles at own speed.

    With w = q z/(1 - q z): e' = 2 Re w, e'' = -4 Im(w + w^2), e''' = -8 Re(w (1 + w)(1 + 2 w)).
    """
    if joint.series:
        sums = np.zeros((4, *angle.shape))
        for order, amplitude in joint.series:
            part = amplitude * np.exp(1j * order * angle)
            for k in range(4):
                sums[k] += ((1j * order) ** k * part).real
        return sums[0], sums[1], sums[2], sums[3]
    turned = joint.unevenness * np.exp(2j * (angle + joint.yoke))
    w = turned / (1.0 - turned)
    bent = w * (1.0 + w)
    return (
        -np.angle(1.0 - turned),
        2.0 * w.real,
        -4.0 * bent.imag,
        -8.0 * (bent * (1.0 + 2.0 * w)).real,
    )


@dataclass(frozen=True)
class Turning:
    """Deviation of a station's angle from the mean motion, and the derivatives of its angle over its coordinate.

    All at one speed (own angle / speed ratio).
    """

    deviation: FloatArray  # rad
    first: FloatArray
    second: FloatArray
    third: FloatArray


def beyond(before: Turning, joint: JointMap, turned: FloatArray) -> Turning:
    """Return the turning of the station behind a joint; `turned` is the mean angle of the reference station, rad."""
    r = joint.driving_ratio
    s = joint.driven_ratio
    e0, e1, e2, e3 = error(joint, r * (turned + before.deviation))
    g1 = 1.0 + e1 * r / s
    g2 = e2 * r * r / s
    g3 = e3 * r**3 / s
    f1 = before.first
    f2 = before.second
    f3 = before.third
    return Turning(
        before.deviation + e0 / s,
        g1 * f1,
        g2 * f1**2 + g1 * f2,
        g3 * f1**3 + 3.0 * g2 * f1 * f2 + g1 * f3,
    )


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

    @property
    def bodies(self) -> int:
        """Number of bodies of the whole train."""
        return len(self.inertia)

    @property
    def loose(self) -> BoolArray:
        """(groups, free) members of the floating groups that no joint is in and that others drive by damping alone.

        No force depends on the angle of such a group.
        """
        if len(self.floating) < 2:
            return np.zeros((0, self.free), dtype=bool)
        driven = {int(self.coordinate[step.outer]) for step in self.steps}
        groups = [
            np.isin(np.arange(self.free), group)
            for group in self.floating
            if not driven & set(group)
        ]
        return np.array(groups, dtype=bool).reshape(-1, self.free)


def gathered(layout: Layout, onto: FloatArray) -> FloatArray:
    """Return (free, ...) on the free coordinates from what acts on the bodies (bodies, ...)."""
    out = np.zeros((len(layout.root), *onto.shape[1:]))
    np.add.at(out, layout.coordinate, onto)
    return out[: layout.free]


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
    steps = list[JointStep]()
    coordinate[root] = np.arange(len(root))
    for outer in way.order[way.parent[way.order] >= 0].tolist():
        inner = int(way.parent[outer])
        above = way.above[outer]
        joint = joint_map(system, system.spans[joints[above]])
        steps.append(JointStep(inner, outer, joint if driving[above] == inner else joint.undone()))
        coordinate[outer] = coordinate[inner]
    if len(steps) < len(joints):
        raise SolveError(
            "joints close a loop, or hold one body from two sides; give one of them an elastic coupling"
        )
    return coordinate, root, int(np.count_nonzero(~held[root])), tuple(steps)
