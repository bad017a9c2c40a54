"""Answer of a turning shaft to couples at its points: at rest in space (order 0) and at orders of its speed."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from torsion.analyses.joints.joint_analysis import joint_couples
from torsion.analyses.joints.joint_lines import Placed, motions, path_to
from torsion.analyses.lateral.beam_matrices import places
from torsion.analyses.lateral.bending_shafts import EPS, BendingShaft, Planes
from torsion.analyses.lateral.whirl import Critical, criticals
from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.trees.tree_response import NEAR_SINGULAR_LOSS, Status
from torsion.results import derived, reported, result, words

SINGULAR_LOSS = (
    1e-2  # relative error of the answer, from rounding of the data, from which nothing is reported
)
UNDAMPED = 1e-9  # damping ratio below which the height of a resonance is not known
REACH = 0.01  # of its speed: an amplitude so near an undamped resonance, 50 times the static one, is marked
Lines = NDArray[np.uint8]
CHUNK = 64  # speeds treated at once
STEPS = np.tan(np.linspace(-0.5, 0.5, 13)[1:-1] * np.pi)  # equal steps of phase around a resonance
SAMPLES = 512  # of a revolution; the orders of a joint of 70 degrees fall below rounding before the half of it
Carrier = Literal["driving", "driven"]
ASIDE = np.array([-0.03, -0.01, -0.003, 0.0, 0.003, 0.01, 0.03])  # around one without damping


@reported
class Largest:
    """Largest reliable amplitudes of an order along the shaft and over the speed; null at an undamped resonance."""

    order: int = result("per revolution of the shaft")
    displacement: float | None = result("m", "displacement in any direction")
    at: float | None = result("m", "its place along the shaft")
    speed: float | None = result("rad/s", "its reference speed")
    moment: float | None = result("N*m", "bending moment in any direction")
    moment_at: float | None = result("m", "its place along the shaft")
    moment_speed: float | None = result("rad/s", "its reference speed")
    unreliable: int = result("speeds without a reliable value")


@reported
class PointForce:
    """Largest reliable force of an order on a joint or support; null at an undamped resonance."""

    name: str = result("joint or support")
    at: float = result("m", "its place along the shaft")
    order: int = result("per revolution of the shaft")
    force: float | None = result("N", "largest amplitude in any direction")
    speed: float | None = result("rad/s", "its reference speed")


@reported
class Answer:
    """Complex amplitudes Re[X exp(i order Omega t)] in y and z (last axis); NaN where the status is singular.

    Order 0 stands still and is real. Amplitudes are half ranges.
    """

    order: int = result("per revolution of the shaft; 0 stands still")
    speed: FloatArray = result("rad/s", "speed", "reference speeds, more of them around resonances")
    displacement: ComplexArray = result(
        "m", ("speed", "place", "direction"), "[y, z] complex amplitude (zero to peak)"
    )
    moment: ComplexArray  # (speeds, places, 2) N m, E I u'' with its damping share: [.., 0] bends in y, about z
    force: ComplexArray = result(
        "N",
        ("speed", "point", "direction"),
        "[y, z] complex amplitude, of the shaft on its joints and supports",
    )
    amplification: FloatArray = result("1", "speed", "growth of relative errors of the data")
    status: Lines  # (speeds,) uint8 of `Status`

    @derived(
        "N*m",
        ("speed", "place"),
        "largest amplitude of the bending moment in any direction",
        key="moment_Nm",
    )
    def largest_moment(self) -> FloatArray:
        """Half the long axis of the ellipse of the moment, (speeds, places) N m."""
        return extent(self.moment)

    @derived("", "speed", "ok, near-singular or singular", key="status")
    def status_words(self) -> np.ndarray:
        """How far the values can be relied on, in words, (speeds,)."""
        return words(self.status, Status)

    @property
    def orbit(self) -> FloatArray:
        """(speeds, places) m, largest displacement in any direction."""
        return extent(self.displacement)

    def reliable(self, values: FloatArray) -> FloatArray:
        """Return values (speeds, ...) with NaN where the status is not ok."""
        return np.where(self.status == Status.OK, values.T, np.nan).T

    def peak(self, values: FloatArray) -> tuple[float, int, float] | tuple[None, None, None]:
        """Return the largest of values (speeds, places), its place and its speed; None if one is not reliable."""
        reliable = self.reliable(values)
        if not np.isfinite(reliable).all():
            return None, None, None
        row, place = np.unravel_index(int(np.argmax(reliable)), reliable.shape)
        return float(reliable[row, place]), int(place), float(self.speed[row])


def extent(pairs: ComplexArray) -> FloatArray:
    """Return (...) largest amplitude in any direction of (..., 2) in y and z: half the long axis of the ellipse."""
    y = pairs[..., 0]
    z = pairs[..., 1]
    return 0.5 * (np.abs(y + 1j * z) + np.abs(y - 1j * z))


def speeds_for(requested: FloatArray, resonances: tuple[Critical, ...]) -> FloatArray:
    """Return the speeds requested, and more around the resonances between them, which are there themselves."""
    added = [requested]
    for resonance in resonances:
        ratio = resonance.damping_ratio
        steps = ASIDE if ratio < UNDAMPED else ratio * np.append(STEPS, 0.0)
        added.append(resonance.speed * (1.0 + steps[np.abs(steps) < 1.0]))
    speeds = np.unique(np.concatenate(added))
    return np.asarray(speeds[(speeds >= requested.min()) & (speeds <= requested.max())])


def answer(planes: Planes, order: int, speed: FloatArray, couple: ComplexArray) -> Answer:
    """Return the answer to couples (speeds, points, 2) N m, M_y and M_z at the points, turning at speeds (speeds,) rad/s.

    A loss factor of the shaft acts as E (1 + i eta) at orders from 2 on, as forward and backward whirl then bend it in
    the sense in which they pass (Genta 2005); at order 0 it is left out. Raises ValueError for order 1.
    """
    if order == 1 or order < 0:
        raise ValueError(f"order {order}: joints excite order 0 and orders from 2 on")
    speeds = np.asarray(speed, dtype=np.float64)
    slopes = (
        planes.system.place + 1
    )  # a couple M_y, M_z does the work M_z on the slope y' and -M_y on z'
    y = couple[..., 1] @ planes.y.shape[slopes]
    z = -couple[..., 0] @ planes.z.shape[slopes]
    amplification = np.ones(len(speeds))
    n = len(planes.y.square)
    for part in (slice(k, k + CHUNK) for k in range(0, len(speeds) if order else 0, CHUNK)):
        some = speeds[part]
        if planes.is_isotropic:
            forward, grown = _solved(planes, order, some, 0.5 * (y[part] + 1j * z[part]))
            backward, back = _solved(planes, -order, some, 0.5 * (y[part] - 1j * z[part]))
            y[part], z[part] = forward + backward, -1j * (forward - backward)
            amplification[part] = np.maximum(grown, back)
        else:
            load = np.concatenate([y[part], 1j * z[part]], axis=1)
            p, amplification[part] = _solved(planes, order, some, load)
            y[part], z[part] = p[:, :n], -1j * p[:, n:]
    # By the growth of errors, and by the neighbourhood of resonances that nothing damps.
    loss = EPS * amplification
    status = np.where(loss > NEAR_SINGULAR_LOSS, Status.NEAR_SINGULAR, Status.OK).astype(np.uint8)
    highest = float(speeds.max(initial=0.0)) * (1.0 + REACH)
    for resonance in criticals(planes, order, highest) if order else ():
        if resonance.damping_ratio < UNDAMPED:
            away = np.abs(speeds / resonance.speed - 1.0)
            status[away <= REACH] = Status.NEAR_SINGULAR
            status[away <= NEAR_SINGULAR_LOSS] = Status.SINGULAR
    status[~(loss < SINGULAR_LOSS)] = Status.SINGULAR
    y[status == Status.SINGULAR] = z[status == Status.SINGULAR] = np.nan
    x = np.stack([y @ planes.y.shape.T, z @ planes.z.shape.T], axis=-1)
    rows = places(planes.system)
    bending = rows.moment + 1j * rows.moment_of_loss if order else rows.moment
    force = _forces(planes, order, speeds, x)
    return Answer(order, speeds, rows.displacement @ x, bending @ x, force, amplification, status)


def _solved(
    planes: Planes, order: int, speeds: FloatArray, load: ComplexArray
) -> tuple[ComplexArray, FloatArray]:
    """(speeds, coordinates), and the growth of relative errors of stiffness and inertia (speeds,).

    A negative order is the backward part, conjugate.
    """
    size = len(planes.square)
    speed = speeds[:, None, None]
    w = abs(order) * speed
    matrix = np.eye(size) * (1.0 - w**2 * planes.square) + order * speed**2 * planes.gyroscopic
    matrix = matrix + 1j * (w * planes.damping + planes.lossy)
    unit = np.broadcast_to(np.eye(size), (len(load), size, size))
    right = np.concatenate([load[:, :, None], unit], axis=2)
    try:
        solution = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:  # exactly singular: moved by rounding, its growth then says so
        solution = np.linalg.solve(matrix + EPS * np.eye(size), right)
    terms = solution[:, :, 1:] * (1.0 + w**2 * planes.square)
    grown = np.sqrt(np.max(np.sum(np.abs(terms) ** 2, axis=1), axis=1))
    return np.asarray(solution[:, :, 0]), np.asarray(grown)


def _forces(planes: Planes, order: int, speeds: FloatArray, x: ComplexArray) -> ComplexArray:
    """(speeds, points, 2) N on supports, of springs and dampers, and on joints, what the shaft lacks to balance."""
    system = planes.system
    w = order * speeds[:, None]
    unknowns = system.place
    shaft = system.stiffness[unknowns] + (1j * system.lossy[unknowns] if order else 0.0)
    pushed = shaft @ x - w[:, :, None] ** 2 * (system.inertia[unknowns] @ x)
    turned = (1j * w * speeds[:, None])[:, :, None] * (system.gyroscopic[unknowns] @ x)
    pushed[..., 0] += turned[..., 1]
    pushed[..., 1] -= turned[..., 0]
    force = np.zeros_like(pushed)
    for k, point in enumerate(system.beam.points):
        if point.fixation != "free":
            force[:, k] = -pushed[:, k]
        else:
            spring = np.array(point.stiffness) + 1j * w * np.array(point.damping)
            force[:, k] = spring * x[:, unknowns[k]]
    return force


def orders(joints: Sequence[Placed], shaft: BendingShaft) -> tuple[int, ...]:
    """Return 0, and the orders of all joints up to this shaft and at its end."""
    position = {joint.part: k for k, joint in enumerate(joints)}
    positions = {k for end in shaft.joints for k in path_to(joints, position[end.part])}
    return tuple(sorted({0, *(joints[k].record.order for k in positions)}))


def couples_at(
    joints: Sequence[Placed], shaft: BendingShaft, torque: FloatArray, carrier: Carrier = "driving"
) -> dict[int, ComplexArray]:
    """Return by order (speeds, points, 2) N m: about y and z of Re[C exp(i order x)], x the first shaft's angle.

    torque: (joints of `every`, speeds) N m, mean, constant on the first shaft of the line (carrier driving) or on the
    last. y is the normal of the plane of the joint before the shaft, else of the one behind it.
    """
    turned = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES
    moved = motions(joints, turned)
    result = {
        order: np.zeros((torque.shape[1], len(shaft.beam.points), 2), dtype=np.complex128)
        for order in orders(joints, shaft)
    }
    for end in shaft.joints:
        position = next(k for k, joint in enumerate(joints) if joint.part == end.part)
        joint = joints[position]
        pair, _ = joint_couples(joint, moved[position].yoke, 1.0, "driving", None)
        couple = pair[0] if end.shaft == "driving" else pair[1]
        # The torque in the driving shaft of the joint over the constant one.
        speed = 1.0 if joint.before is None else moved[joint.before].transfer.ratio
        last_ratio: FloatArray | float = 1.0
        if carrier == "driven":
            last = position
            while following := [k for k, behind in enumerate(joints) if behind.before == last]:
                last = following[0]
            last_ratio = moved[last].transfer.ratio
        curve = (couple.normal + 1j * couple.inplane) * (last_ratio / speed)
        if end is not shaft.joints[0] and end.shaft == "driving":
            curve = curve * np.exp(1j * joint.record.plane)
        for order, amplitude in result.items():
            turn = (1.0 if order == 0 else 2.0) / SAMPLES * np.exp(-1j * order * turned)
            pair_of_planes = np.array([curve.real @ turn, curve.imag @ turn])
            amplitude[:, end.point] += torque[position][:, None] * pair_of_planes
    return result
