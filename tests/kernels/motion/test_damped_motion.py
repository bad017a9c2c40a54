"""Motion of modes over time against matrix exponentials, high-precision references and closed forms."""

import mpmath
import numpy as np
import pytest

from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion
from torsion.kernels.motion.loaded_modes import (
    LoadedModes,
    ModalTrain,
    Piece,
    answers,
    history,
    value,
)
from torsion.kernels.motion.march import March
from torsion.kernels.trees.tree import Tree

PIECES = [
    Piece(0.0, 0.3, 2.0, 5.0),
    Piece(0.1, 0.35, 1.0 + 1.0j, 2.0, -3.0 + 40.0j),
    Piece(0.2, np.inf, 3.0, 0.0, -1.0),
    Piece(0.05, 0.06, 7.0, 0.0, 1e-9),
]
TIMES = np.array([0.0, 0.01, 0.055, 0.1, 0.2, 0.33, 0.5, 2.0])


def motion(
    train: ModalTrain, force: np.ndarray, loads, position: np.ndarray, speed: np.ndarray
) -> EventDrivenMotion:
    """Up to the last of TIMES."""
    loaded = LoadedModes(train, loads, force, np.zeros((0, len(force))))
    (moved,) = March(loaded, TIMES[-1], np.empty(0), position, speed).until([TIMES[-1]])
    return moved


def chain(
    inertia: list[float], stiffness: list[float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """rad/s, shapes (discs, rigid motion + modes) and torques (springs, modes), generalised inertias 1."""
    n = len(inertia)
    tree = Tree(
        np.arange(-1, n - 1),
        np.array([0.0, *(1.0 / np.array(stiffness))]),
        np.array(inertia),
        np.zeros(n, dtype=bool),
    )
    found = tree_modes(tree, None)
    norm = 1.0 / np.sqrt((np.array(inertia)[:, None] * found.angle**2).sum(axis=0))
    rigid = np.ones((n, 1)) / np.sqrt(sum(inertia))
    return (
        found.frequency,
        np.concatenate([rigid, found.angle * norm], axis=1),
        found.torque[1:] * norm,
    )


def convolved(root: complex, time: float, start: float) -> complex:
    """y(t) of y' = root y + f, with 40 digits."""
    with mpmath.workdps(40):
        total = start * mpmath.e ** (mpmath.mpc(root) * time)
        for piece in PIECES:
            end = min(piece.end, time)
            if end <= piece.begin:
                continue
            for part in (complex, lambda number: complex(number).conjugate()):
                level, slope, rate = (
                    mpmath.mpc(part(one)) for one in (piece.level, piece.slope, piece.rate)
                )
                d, length = rate - root, mpmath.mpf(end) - piece.begin
                once = (mpmath.e ** (d * length) - 1) / d
                twice = (length * mpmath.e ** (d * length) - once) / d
                decay = mpmath.e ** (mpmath.mpc(root) * (time - mpmath.mpf(piece.begin)))
                total += decay * (level * once + slope * twice) / 2
        return complex(total)


def answered(root: complex, loads, force: np.ndarray, start: float) -> np.ndarray:
    """y(t) of y' = root y + force times the loads, at TIMES."""
    found, acting = np.empty(len(TIMES), dtype=complex), history(loads)
    for k, time in enumerate(TIMES.tolist()):
        y = complex(start)
        ends = [*acting.begin[1:], np.inf]
        for begin, end, terms in zip(acting.begin, ends, acting.acting, strict=True):
            if begin < time:
                length = np.array([min(end, time) - begin])
                y = y * np.exp(root * length[0])
                every = terms.load, terms.level, terms.slope, terms.rate
                for load, level, slope, rate in zip(*every, strict=True):
                    decay = np.exp(np.array([[root * length[0]]]))
                    once, ramp = answers(np.array([root]), rate, length, 2, decay)[:, 0, 0]
                    late = float(length[0])
                    y += force[load] * (level * late * once + slope * late**2 * ramp)
        found[k] = y
    return found


@pytest.mark.parametrize("root", [-1 + 50j, -3 + 40.0000001j, -500 + 1e3j, -1e6 + 1e8j, -2.0 + 0j])
def test_a_coordinate_answers_ramps_and_exponentials_as_the_convolution_does(root: complex) -> None:
    found = answered(root, [PIECES], np.ones(1), 1.0)
    exact = np.array([convolved(root, float(time), 1.0) for time in TIMES])
    assert np.abs(found - exact).max() <= 2e-15 * np.abs(exact).max()


def test_a_torque_at_the_root_itself_grows_with_time() -> None:
    root = -3.0 + 40.0j
    pieces = [
        Piece(0.0, np.inf, 1.0, 2.0, root),
        Piece(0.0, np.inf, 1j, 2j, root),
    ]  # of two loads: 1 and -i
    found = answered(root, [[one] for one in pieces], np.array([1.0, -1j]), 0.0)
    exact = np.exp(root * TIMES) * (TIMES + TIMES**2)
    assert found == pytest.approx(exact, rel=1e-14)


def test_a_rigid_motion_is_the_double_integral() -> None:
    """By Gauss's rule of 40 points between all ends of pieces."""
    train = ModalTrain(np.empty(0), np.empty(0), np.zeros((1, 1)))
    moved = motion(train, np.array([[2.0]]), [PIECES], np.array([0.1]), np.array([3.0])).at(TIMES)
    place, speed = moved.position, moved.speed
    cuts = sorted({end for piece in PIECES for end in (piece.begin, piece.end)})
    points, weights = np.polynomial.legendre.leggauss(40)
    for k, time in enumerate(TIMES.tolist()):
        ends = np.array([0.0, *(cut for cut in cuts if 0.0 < cut < time), time])[:, None]
        half = np.diff(ends, axis=0) / 2.0
        at, weight = (ends[:-1] + half * (1.0 + points)).ravel(), (half * weights).ravel()
        force = weight * value(PIECES, at)
        assert speed[0, k] == pytest.approx(3.0 + 2.0 * force.sum(), rel=1e-14)
        assert place[0, k] == pytest.approx(0.1 + 3.0 * time + 2.0 * force @ (time - at), rel=1e-14)


def test_an_impulse_on_a_stiff_chain_to_the_digits_of_sixty() -> None:
    """Inertias 1e-6 to 1e3, stiffnesses 3e2 to 1e12; reference: mpmath with 60 digits."""
    w, shape, torque = chain([0.5, 1e-05, 0.002, 1000.0, 1e-06, 4.0], [1e9, 300.0, 1e12, 5e4, 1e7])
    train = ModalTrain(w, np.full(5, 0.005), np.zeros((6, 6)))
    moved = motion(train, np.zeros((6, 0)), [], np.zeros(6), shape[0])
    place = moved.at(np.array([0.01, 1.0])).position
    known = [
        [5.932641087540208, -12.804027824118625],
        [5.932759740326346, -12.804283904598247],
        [5.932747884319703, -12.804258378189374],
        [0.004741001293015897, -0.04104625509031352],
        [0.004741000084170077, -0.04104624481630629],
    ]
    assert torque @ place[1:] == pytest.approx(np.array(known), rel=2e-14)


def test_a_ground_damper_couples_the_modes_and_slows_the_rigid_motion() -> None:
    """Reference: matrix exponential with 50 digits."""
    w, shape, torque = chain([1.0, 0.2, 3.0], [2e4, 3e4])
    train = ModalTrain(w, np.zeros(2), 30.0 * np.outer(shape[1], shape[1]))
    found = motion(train, shape[[0]].T, [[Piece(0.0, np.inf, 100.0)]], np.zeros(3), np.zeros(3))
    moved = found.at(np.array([0.05]))
    place, speed = moved.position, moved.speed
    assert torque @ place[1:, 0] == pytest.approx(
        [11.801041895822886, -24.05050049823451], rel=1e-13
    )
    assert shape[1] @ speed[:, 0] == pytest.approx(0.9929708079951427, rel=1e-13)


@pytest.mark.parametrize("viscous", [(40.0, 5.0), (4000.0, 3e4)], ids=["light", "beyond critical"])
def test_viscous_springs_that_couple_modes_as_the_matrix_exponential(
    viscous: tuple[float, float],
) -> None:
    inertia, stiffness = [1.0, 0.2, 3.0], [2e4, 3e4]
    w, shape, torque = chain(inertia, stiffness)
    twist = np.concatenate([np.zeros((2, 1)), torque / np.array(stiffness)[:, None]], axis=1)
    train = ModalTrain(w, np.zeros(2), twist.T @ (np.array(viscous)[:, None] * twist))
    found = motion(
        train, shape[[2]].T, [[Piece(0.0, np.inf, 7.0, 0.0, -2.0)]], np.zeros(3), shape[0]
    )
    times = np.array([0.001, 0.02, 0.3])
    B = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])
    K, C = (B.T @ np.diag(one) @ B for one in (stiffness, viscous))
    with mpmath.workdps(40):
        A = mpmath.zeros(7)
        for i in range(3):
            A[i, i + 3] = 1
            for j in range(3):
                A[i + 3, j], A[i + 3, j + 3] = (
                    -K[i, j] / mpmath.mpf(inertia[i]),
                    -C[i, j] / mpmath.mpf(inertia[i]),
                )
        A[5, 6], A[6, 6] = 7 / mpmath.mpf(inertia[2]), -2
        start = mpmath.matrix([0, 0, 0, 1 / mpmath.mpf(inertia[0]), 0, 0, 1])
        exact = [mpmath.expm(A * mpmath.mpf(float(time))) * start for time in times]
        twisted = [[float(k * (z[i] - z[i + 1])) for z in exact] for i, k in enumerate(stiffness)]
        turning = [[float(z[i + 3]) for z in exact] for i in range(3)]
    moved = found.at(times)
    place, speed = moved.position, moved.speed
    assert shape @ speed == pytest.approx(np.array(turning), rel=1e-12)
    assert torque @ place[1:] == pytest.approx(
        np.array(twisted), rel=1e-11, abs=1e-13 * np.abs(twisted).max()
    )


def test_accelerations_are_the_rates_of_the_speeds() -> None:
    w, shape, _ = chain([1.0, 0.2, 3.0], [2e4, 3e4])
    train = ModalTrain(w, np.array([0.01, 0.02]), np.zeros((3, 3)))
    found = motion(train, shape[[0]].T, [PIECES], np.zeros(3), shape[1])
    step, middle = 1e-6, np.array([0.04, 0.13, 0.7])
    before, after = (found.at(middle + side * step).speed for side in (-1.0, 1.0))
    slope = (after - before) / (2.0 * step)
    assert found.at(middle).acceleration == pytest.approx(
        slope, rel=1e-6, abs=1e-5 * np.abs(slope).max()
    )
