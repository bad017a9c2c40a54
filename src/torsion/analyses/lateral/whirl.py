"""Whirl of a turning shaft: frequencies and decay over speed, and the speeds at which an order meets them.

The inverse v = 1/w of a frequency solves v p = -Omega G p - N r, v r = -N p with N N = M: a symmetric matrix, so that
the lowest frequencies, its largest values, keep all their digits. With dampers z = 1/s, s = i w, in place of v.
"""

import math

import numpy as np

from torsion.analyses.lateral.bending_shafts import EPS, Planes
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.results import derived, reported, result
from torsion.sources import source

SPARE_MODES = 8  # modes at rest, beside as many as are reported, among which damped ones are sought
OVERDAMPED = 1e-7  # |Im s|/|s| below which a motion does not oscillate
SETTLED = 1e-8  # relative step after which a root is found: convergence is cubic, so that the next would be rounding
STEPS = 8
REACH = 0.05  # relative: a root that moves farther than this was not among the few modes
APART = 1e-9  # relative: roots nearer than this may be one found twice


UNSTABLE = (
    -1e-9
)  # a motion grows where its logarithmic decrement is below; between it and 0 is rounding
PURE, FLAT = 0.99, 0.1  # of a direction: a circle from the first on, nearly a line up to the second


def sense(direction: float) -> str:
    """Return forward or backward whirl in words."""
    if abs(direction) < FLAT:
        return "nearly in a plane"
    way = "forward" if direction > 0 else "backward"
    return way if abs(direction) >= PURE else f"{way}, ellipse"


@reported
class WhirlMode:
    """One mode over the speed range."""

    number: int = result("by frequency at the highest speed, from 1")
    first: float = result("Hz", "frequency at the lowest speed")
    last: float = result("Hz", "frequency at the highest speed")
    direction: float = result("1", "1 forward, -1 backward whirl at the highest speed")
    decrement: float = result("1", "least logarithmic decrement; 0 for rounding")
    speed: float = result("rad/s", "reference speed of that")
    grows_from: float | None = result(
        "rad/s", "lowest reference speed at which it is unstable; null if it is not"
    )

    @derived(
        "whirl at the highest speed: forward or backward, a circle, an ellipse or nearly in a plane",
    )
    def whirl(self) -> str:
        return sense(self.direction)


@reported
class Whirl:
    """Modes of a shaft over its speed. Columns ascend by frequency, backward whirl first where directions are pure."""

    speed: FloatArray = result(
        "rad/s", "speed", "reference speeds"
    )  # `whirl` itself returns those of the shaft
    frequency: FloatArray = result(
        "Hz", ("speed", "mode"), "of the oscillation; null if fewer modes oscillate"
    )
    log_decrement: FloatArray = result("1", ("speed", "mode"), "negative: the shaft is unstable")
    direction: FloatArray = result(
        "1", ("speed", "mode"), "1 forward, -1 backward, between them an ellipse"
    )

    @derived("every oscillating mode over the speed range")
    def modes(self) -> tuple[WhirlMode, ...]:
        """Modes by their frequency at the highest speed, what does not oscillate there last."""
        modes = []
        for number, k in enumerate(np.argsort(self.frequency[-1], kind="stable").tolist(), 1):
            decrement = self.log_decrement[:, k]
            if not np.isfinite(decrement).any():
                continue
            row = int(np.nanargmin(decrement))
            grows = decrement < UNSTABLE
            least = float(decrement[row])
            modes.append(
                WhirlMode(
                    number=number,
                    first=float(self.frequency[0, k]),
                    last=float(self.frequency[-1, k]),
                    direction=float(self.direction[-1, k]),
                    decrement=0.0 if abs(least) <= -UNSTABLE else least,
                    speed=float(self.speed[row]),
                    grows_from=float(self.speed[grows][0]) if grows.any() else None,
                )
            )
        return tuple(modes)


@reported
class Critical:
    """A speed at which a frequency of the shaft is `order` times its speed; damping is left out of the speed."""

    order: int = result("per revolution of the shaft: 1 unbalance, others couples of joints")
    mode: int = result("counted from 1 by speed")
    speed: float = result(
        "rad/s", "reference speed"
    )  # `criticals` itself returns that of the shaft
    frequency: float = result("Hz", "order times the speed of the shaft")
    direction: float = result("1", "1 forward, -1 backward whirl, between them an ellipse")
    damping_ratio: float = result(
        "1",
        "first order: half width of the resonance over speed / speed; 0: the amplitude has no bound",
    )

    @derived("whirl: forward or backward, a circle, an ellipse or nearly in a plane")
    def whirl(self) -> str:
        return sense(self.direction)


@source("Genta2005")
def whirl(planes: Planes, speed: FloatArray, modes: int) -> Whirl:
    """Return the lowest modes over speeds (speeds,) rad/s: `modes` backward and as many forward ones.

    Loss factors of the shaft enter the decrement to first order; they drive a forward whirl slower than the shaft
    (Genta 2005). With unequal supports the 2 `modes` lowest are reported, in ascending order.
    """
    speeds = np.atleast_1d(np.asarray(speed, dtype=np.float64))
    columns = np.full((3, len(speeds), 2 * modes), np.nan)
    square = np.concatenate([planes.y.square, planes.z.square])[:, None]
    for k, omega in enumerate(speeds.tolist()):
        # By ascending modulus; at least the lowest that oscillate.
        roots = None
        if planes.damping.any():
            roots = refined(planes, omega, 2 * modes)
        root, shape = roots or roots_among(planes, omega, np.arange(len(planes.square)))
        turns = [-1.0, 1.0] if planes.is_isotropic else [1.0]
        wanted = 2 * modes // len(turns)
        for group, sign in enumerate(turns):
            chosen = np.flatnonzero(sign * root.imag > OVERDAMPED * np.abs(root))[:wanted]
            p = _both(planes, shape[:, chosen], sign)
            w = np.abs(root[chosen].imag)
            # Loss factors add to first order 2 pi lossy energy/(elastic + kinetic energy).
            energy = np.sum(np.abs(p) ** 2 * (1.0 + w**2 * square), axis=0)
            forward, backward = lossy_energies(planes, p)
            lost = (np.sign(w - omega) * forward + backward) / energy
            columns[:, k, group * wanted : group * wanted + len(chosen)] = (
                w / (2.0 * math.pi),
                2.0 * math.pi * (-root[chosen].real / w + lost),
                direction(planes, p),
            )
    return Whirl(speeds, columns[0], columns[1], columns[2])


def _both(planes: Planes, p: ComplexArray, sign: float) -> ComplexArray:
    """Shapes of y and i z, (2 n, modes), from those of y + i z where the supports are isotropic; sign 1 is forward."""
    if not planes.is_isotropic:
        return p
    return np.asarray(np.vstack([p, sign * p]) / math.sqrt(2.0), dtype=np.complex128)


def roots_among(planes: Planes, speed: float, kept: IntArray) -> tuple[ComplexArray, ComplexArray]:
    """Return all roots s, by ascending modulus, and shapes (coordinates, roots) of the coordinates that are kept."""
    square = planes.square[kept]
    moving = np.flatnonzero(square > 0)
    n = len(kept)
    m = len(moving)
    symmetric = np.zeros((n + m, n + m))
    symmetric[:n, :n] = -speed * planes.gyroscopic[np.ix_(kept, kept)]
    symmetric[moving, n + np.arange(m)] = symmetric[n + np.arange(m), moving] = -np.sqrt(
        square[moving]
    )
    if planes.damping.any():  # i v = z
        damped = -1j * symmetric
        damped[:n, :n] -= planes.damping[np.ix_(kept, kept)]
        inverse, vectors = np.linalg.eig(damped)
    else:
        value, real = np.linalg.eigh(symmetric)
        inverse = (-1j * value).astype(np.complex128)
        vectors = real.astype(np.complex128)
    size = np.abs(inverse)
    last = np.argsort(-size, kind="stable")
    last = last[size[last] > (n + m) * EPS * size.max()]
    shape = np.zeros((len(planes.square), len(last)), dtype=np.complex128)
    shape[kept] = vectors[:n, last]
    return 1.0 / inverse[last], shape


def refined(planes: Planes, speed: float, modes: int) -> tuple[ComplexArray, ComplexArray] | None:
    """Return the `modes` lowest oscillating roots of either sense, refined, by modulus; None where they are in doubt.

    The equation (1 + s2 M + s C - i s Omega G) p = 0 has complex symmetric matrices, so that p is also its left vector.
    """
    # Roughly they are those of the lowest modes at rest, some more than are reported.
    kept = np.argsort(-planes.square, kind="stable")[: SPARE_MODES + modes]
    root, shape = roots_among(planes, speed, kept)
    chosen = np.concatenate(
        [np.flatnonzero(sense * root.imag > OVERDAMPED * np.abs(root))[:modes] for sense in (-1, 1)]
    )
    start = root[chosen]
    root = root[chosen].copy()
    shape = shape[:, chosen].copy()
    first = planes.damping - 1j * speed * planes.gyroscopic
    index = np.arange(len(planes.square))
    open_roots = np.arange(len(root))
    for _ in range(STEPS):
        s = root[open_roots][:, None, None]
        turning = first + 2.0 * s * np.diag(planes.square)  # derivative of the matrix by s
        matrix = s * first
        matrix[:, index, index] += 1.0 + s[:, :, 0] ** 2 * planes.square
        try:
            better = np.linalg.solve(matrix, turning @ shape[:, open_roots].T[:, :, None])
        except np.linalg.LinAlgError:  # a root to the last digit
            open_roots = open_roots[:0]
            break
        better /= np.linalg.norm(better, axis=1, keepdims=True)
        left = np.swapaxes(better, 1, 2)
        step = (left @ (matrix @ better) / (left @ (turning @ better)))[:, 0, 0]
        root[open_roots] -= step
        shape[:, open_roots] = better[:, :, 0].T
        open_roots = open_roots[np.abs(step) > SETTLED * np.abs(root[open_roots])]
        if not open_roots.size:
            break
    distance = np.abs(root[:, None] - root) + np.diag(np.abs(root))
    if open_roots.size or (np.abs(root - start) > REACH * np.abs(start)).any():
        return None
    if not np.isfinite(root).all() or (distance < APART * np.abs(root)).any():
        return None
    order = np.argsort(np.abs(root), kind="stable")
    return root[order], shape[:, order]


def _energy(p: ComplexArray, matrix: FloatArray, right: ComplexArray) -> FloatArray:
    """(modes,) real part of p* matrix other."""
    return np.asarray(np.sum(p.conj() * (matrix @ right), axis=0).real)


def _of_both(planes: Planes, p: ComplexArray, matrix: FloatArray) -> FloatArray:
    """(modes,) energy of shapes of both planes, of a matrix of one of them where the supports are isotropic."""
    parts = np.split(p, 2) if planes.is_isotropic else [p]
    return np.asarray(np.sum([_energy(part, matrix, part) for part in parts], axis=0))


def lossy_energies(planes: Planes, p: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Return (modes,) of the loss factors in the forward and in the backward part of shapes of both planes."""
    n = len(planes.y.square)
    direct = 0.5 * _of_both(planes, p, planes.lossy)
    cross = _energy(p[:n], planes.crossed, p[n:])
    return direct + cross, direct - cross


def direction(planes: Planes, p: ComplexArray) -> FloatArray:
    """Return (modes,) forward less backward share of the orbits, weighted by the inertia, of shapes of both planes."""
    n = len(planes.y.square)
    y = planes.y.shape @ p[:n]
    z = planes.z.shape @ (-1j * p[n:])
    forward, backward = (_energy(u, planes.system.inertia, u) for u in (y + 1j * z, y - 1j * z))
    return (forward - backward) / (forward + backward)


def criticals(planes: Planes, order: int, highest: float) -> tuple[Critical, ...]:
    """Return every speed up to the highest, rad/s, at which `order` times the speed is a frequency, ascending.

    1 = Omega2 (order2 M - order G): a definite problem in 1/Omega2, so that none is missed.
    """
    inertia = order**2 * np.diag(planes.square)
    rows: list[tuple[float, float, float]] = []
    for sign in (-1.0, 1.0) if planes.is_isotropic else (1.0,):
        inverse, shape = np.linalg.eigh(inertia - sign * order * planes.gyroscopic)
        above = np.flatnonzero(inverse > len(inverse) * EPS * np.abs(inverse).max())[::-1]
        speed = 1.0 / np.sqrt(inverse[above])
        speed, shape = speed[speed <= highest], shape[:, above[speed <= highest]]
        p = _both(planes, shape.astype(np.complex128), sign)
        # Half of the damping terms of shapes of elastic energy 1/2, at the resonance.
        viscous = _of_both(planes, p, planes.damping)
        forward, backward = lossy_energies(planes, p)
        ratio = (order * speed * viscous + np.sign(order - 1) * forward + backward) / 2.0
        rows += zip(speed.tolist(), direction(planes, p).tolist(), ratio.tolist(), strict=True)
    rows.sort()
    return tuple(
        Critical(order, number, speed, order * speed / (2.0 * math.pi), turns, ratio)
        for number, (speed, turns, ratio) in enumerate(rows, start=1)
    )
