"""Dry friction in the steady vibration, by harmonic balance: a complex stiffness at the amplitude that is found.

A spring k_t in series with a slider T_c, twisted with an amplitude A beyond T_c/k_t, answers at the same order as
    (k_t/pi) (theta - sin(2 theta)/2 + i sin(theta)**2),   theta = arccos(1 - 2 T_c/(k_t A))
would (theory, T115; Caughey, J. Appl. Mech. 27 (1960) 640). The reciprocal of the amplitude in one span is linear in a
stiffness k added there, 1/u = a + b k, so two answers of the linear train give A |a + b k(A)| = 1. The largest harmonic
component of the span sets its amplitude for all of them.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from torsion.analyses.response.solver import Answer
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.tree_response import complex_compliance

Friction = tuple[tuple[float, float], ...]  # N m, N m/rad of every slider of a coupling
Added = Mapping[int, ComplexArray]  # of a span: (columns,) N m/rad
SMALLEST, LARGEST = 1e-18, 1e4  # rad, between which the amplitude is looked for
HALVINGS = 90
ROUNDS = 200  # over several couplings, whose amplitudes depend on each other, until they change by SETTLED
SETTLED = 1e-11


def slider_stiffness(amplitude: FloatArray, friction: Friction) -> ComplexArray:
    """(columns,) N m/rad of sliders side by side, of one twist amplitude (columns,) rad.

    >>> slider_stiffness(np.array([1e-3]), ((5.0, 5e4),)).round(3).tolist()
    [(2602.201+5729.578j)]
    """
    total = np.zeros(len(amplitude), dtype=complex)
    for torque, stiffness in friction:
        slips = amplitude > torque / stiffness
        angle = np.arccos(1.0 - 2.0 * torque / (stiffness * np.where(slips, amplitude, torque / stiffness)))
        turned = angle - np.sin(2.0 * angle) / 2.0 + 1j * np.sin(angle) ** 2
        total += np.where(slips, stiffness / math.pi * turned, stiffness)
    return total


def rubbing_spans(system: System) -> dict[int, Friction]:
    """The spans with friction beside their spring."""
    parts = enumerate(system.train.parts)
    rubbing = {number: part.nonlinear.friction for number, part in parts if part.nonlinear is not None}
    spans = ((span, rubbing.get(part, ())) for span, part in enumerate(system.span_part.tolist()))
    return {span: friction for span, friction in spans if friction} if rubbing else {}


def friction_stiffness(
    system: System, w: Sequence[FloatArray], solved: Callable[[Added], Sequence[Answer]]
) -> dict[int, ComplexArray]:
    """Of every span with friction the stiffness (columns,) N m/rad that harmonic balance adds; none without any.

    w: circular frequencies (columns,) rad/s of every harmonic component. solved: its answer with a stiffness added.
    """
    rubbing, columns = rubbing_spans(system), len(w[0]) if w else 0
    stuck = {span: sum(stiffness for _, stiffness in friction) for span, friction in rubbing.items()}
    added = {span: np.full(columns, stiffness, dtype=complex) for span, stiffness in stuck.items()}
    if not (rubbing and columns):
        return added
    for _ in range(ROUNDS):
        changed = 0.0
        for span, friction in rubbing.items():
            trials = added[span], added[span] + stuck[span] * (0.5 + 0.5j)
            twists = [_twists(system, span, w, solved({**added, span: one}), one) for one in trials]
            added[span] = slider_stiffness(_amplitude(friction, trials, twists), friction)
            changed = max(changed, float(np.abs(added[span] - trials[0]).max()) / stuck[span])
        if len(rubbing) < 2 or changed < SETTLED:
            return added
    raise SolveError(
        "harmonic balance of the friction in several couplings finds no amplitudes", "use motion over time"
    )


def _twists(
    system: System, span: int, w: Sequence[FloatArray], answers: Sequence[Answer], added: ComplexArray
) -> ComplexArray:
    """(components, columns) rad."""
    rows = []
    for frequency, found in zip(w, answers, strict=True):
        flexibility, viscous, loss = (
            values[[span]] for values in (system.flexibility, system.viscous, system.loss_factor)
        )
        compliance = complex_compliance(flexibility, viscous, loss, frequency).reshape(-1)
        rows.append(found.torque[:, span] / (1.0 / compliance + added))
    return np.array(rows)


def _amplitude(
    friction: Friction, trials: tuple[ComplexArray, ComplexArray], twists: Sequence[ComplexArray]
) -> FloatArray:
    """(columns,) rad of the largest component, by bisection of its logarithm."""
    moves = (twists[0] != 0.0) & (twists[1] != 0.0)
    first, second = (1.0 / np.where(moves, one, 1.0) for one in twists)
    slope = (second - first) / (trials[1] - trials[0])
    level = first - slope * trials[0]
    largest = np.zeros(twists[0].shape[1])
    for number in range(len(level)):
        low, high = np.full(len(largest), SMALLEST), np.full(len(largest), LARGEST)
        for _ in range(HALVINGS):
            middle = np.sqrt(low * high)
            short = middle * np.abs(level[number] + slope[number] * slider_stiffness(middle, friction)) < 1.0
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        largest = np.maximum(largest, np.where(moves[number], low, 0.0))
    return largest
