"""Sweeps of damped modes, from no damping to overdamped, and of a cross joint, up to a right angle."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from mpmath import mp, mpc, mpf

from benchmarks import dense_peers, ours, peers_opentorsion, references
from benchmarks.cases import Case, condensed
from benchmarks.extremes import Sweep
from benchmarks.stiffness_frequencies import PEER, line
from torsion.kernels.joints.cross import transfer
from torsion.kernels.modes.damped_tree_modes import damped_modes

DAMPED, JOINT, TEXTBOOK = (
    "torsion damped_modes",
    "torsion speed_ratio",
    "textbook cos b/(1 - (sin b cos x)^2)",
)
DIGITS = 80


def damping(scales: Sequence[float]) -> tuple[Sweep, Sweep]:
    """Dampers in the spans and one to ground, scaled together: oscillating roots, and how fast all roots decay."""
    what = "Free chain of five discs, dampers in all spans and one disc to ground; 1 is about critical. "
    along = "scale of the dampers"
    swinging = Sweep(
        "damping_roots",
        "Damping from none to overdamped: oscillating roots",
        what
        + "The largest distance of an oscillating root from the nearest one found, over its modulus.",
        along,
    )
    decay = Sweep(
        "damping_decay",
        "Damping from none to overdamped: decay of all roots",
        what
        + "The largest relative error of the real part of any root but the one at 0, overdamped ones included.",
        along,
    )
    known_from: dict[int, float] = {}
    for scale in scales:
        case = damped_chain(scale)
        exact = _roots(case)
        oscillating = [root for root in exact if root.imag != 0]
        for name, program in (
            (DAMPED, _ours),
            (PEER, _peers),
            (dense_peers.COMPANION, dense_peers.eigenvalues),
        ):
            if oscillating:
                swinging.add(
                    name,
                    scale,
                    lambda run=program, case=case, want=oscillating: nearest(run(case), want),
                )
            decay.add(
                name,
                scale,
                lambda run=program, case=case, want=exact: nearest(run(case), want, real=True),
            )
        known_from.setdefault(len(exact) - len(oscillating), scale)
    words = ", ".join(f"{count} from {scale:.2g}" for count, scale in known_from.items())
    swinging.remarks.append(f"Real roots (the one at 0 omitted) by scale of the dampers: {words}.")
    return swinging, decay


def damped_chain(scale: float) -> Case:
    """Five discs, dampers of `scale` times k / w in the spans and w times 1 kg m2 on one disc, w in the middle."""
    random = np.random.default_rng(6)
    inertia, springs = random.uniform(0.5, 2.0, 5), random.uniform(1e4, 5e4, 4)
    middle = float(np.sqrt(np.median(springs) / np.median(inertia)))
    viscous = (scale * springs / middle).tolist()
    return line(
        "damped",
        inertia.tolist(),
        springs.tolist(),
        viscous=viscous,
        damping=[0.0, 0.0, scale * middle, 0.0, 0.0],
    )


def joint(gaps: Sequence[float]) -> Sweep:
    """One cross joint, whose angle comes near 90 degrees."""
    sweep = Sweep(
        "joint",
        "Joint angle up to a right angle",
        "Speed ratio of one cross joint at 400 driving angles, half of them within 1e-8 to 1 rad of the place where it "
        "is largest; the largest relative error. 0.1 on the axis is an angle of 89.9 degrees.",
        "90 degrees minus the angle of the joint, degrees",
    )
    random = np.random.default_rng(7)
    driving = np.concatenate(
        [random.uniform(0.0, 2 * np.pi, 200), 10 ** random.uniform(-8, 0, 200)]
    )
    for gap in gaps:
        angle = float(np.radians(90.0 - gap))
        with mp.workdps(DIGITS):
            bend = mpf(angle)
            exact = [
                mp.cos(bend) / (1 - (mp.sin(bend) * mp.cos(mpf(x))) ** 2) for x in driving.tolist()
            ]
        plain = np.cos(angle) / (1.0 - (np.sin(angle) * np.cos(driving)) ** 2)
        sweep.add(
            JOINT,
            gap,
            lambda angle=angle, exact=exact: references.worst(
                transfer(driving, angle).ratio, exact
            ),
        )
        sweep.add(TEXTBOOK, gap, lambda plain=plain, exact=exact: references.worst(plain, exact))
    return sweep


def nearest(found: np.ndarray, exact: Sequence[Any], *, real: bool = False) -> float:
    """The largest relative distance of a root from the nearest one found; `real`: of its real part from that one's."""
    if len(found) == 0:
        return float("inf")
    with mp.workdps(DIGITS):
        values = [mpc(complex(value)) for value in found]
        pairs = [(min(values, key=lambda value: abs(value - root)), root) for root in exact]
        if real:
            return max(float(abs(value.real / root.real - 1)) for value, root in pairs)
        return max(float(abs(value - root) / abs(root)) for value, root in pairs)


def _roots(case: Case) -> list[Any]:
    """The roots above or on the real axis but those at 0, from the companion matrix in 80 digits."""
    with mp.workdps(DIGITS):
        flat = condensed(case, mpf)
        size = case.size
        matrix = mp.zeros(2 * size)
        for i in range(size):
            matrix[i, size + i] = mpf(1)
            matrix[size + i, size + i] -= flat.damping[i] / flat.inertia[i]
        for i in range(1, size):
            parent = flat.parent[i]
            for row, column, sign in (
                (i, i, -1),
                (i, parent, 1),
                (parent, parent, -1),
                (parent, i, 1),
            ):
                matrix[size + row, column] += sign * flat.stiffness[i] / flat.inertia[row]
                matrix[size + row, size + column] += sign * flat.viscous[i] / flat.inertia[row]
        values = mp.eig(matrix, left=False, right=False)
        largest = max(abs(value) for value in values)
        tiny = mpf(10) ** (-DIGITS // 2)
        above = [
            value
            for value in values
            if value.imag > -tiny * abs(value) and abs(value) > tiny * largest
        ]
        return [mpc(v.real, 0) if abs(v.imag) < tiny * abs(v) else v for v in above]


def _ours(case: Case) -> np.ndarray:
    flat = condensed(case)
    found = damped_modes(
        ours.tree(case), ground_damping=np.array(flat.damping), viscous=np.array(flat.viscous)
    )
    return np.concatenate([found.eigenvalue, found.real_root])


def _peers(case: Case) -> np.ndarray:
    """openTorsion gives moduli, imaginary parts and damping ratios."""
    modulus, imaginary, ratio = peers_opentorsion.assembled(
        peers_opentorsion.elements(case)
    ).modal_analysis()
    with np.errstate(invalid="ignore"):
        found = -np.asarray(ratio) * np.asarray(modulus) + 1j * np.asarray(imaginary)
    return np.asarray(found[np.isfinite(found)])
