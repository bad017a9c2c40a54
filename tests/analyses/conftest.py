"""Small trains, and an independent dense solution of them in own angles and span torques."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.study import Operation, Study
from torsion.train import train


def make_study(components: list, **keywords: object) -> tuple[Study, System]:
    """A study of a train and its system; keywords: operation, excitations, links, analyses."""
    operation = keywords.pop("operation", Operation())
    analyses = keywords.pop("analyses", {})
    built = train(components, reference=operation.at, **keywords)
    return Study("test", built, operation=operation, analyses=analyses), assemble(built)


def dense_answer(
    system: System,
    w: float,
    force: np.ndarray,
    ground: np.ndarray,
    errors: dict[int, complex] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Own angles (stations,) and span torques (spans,) by one dense solve, without folding any ratio.

    Unknown are all angles x and all torques T: station by station -w^2 J x + i w c x + sum of torques = force; span by
    span x_driving - (x_driven - e)/ratio - hc T = 0, with T on the driven side as T/ratio.
    """
    stations, spans = len(system.stations), len(system.spans)
    matrix = np.zeros((stations + spans, stations + spans), dtype=complex)
    right = np.zeros(stations + spans, dtype=complex)
    for s in range(stations):
        if system.held[s]:
            matrix[s, s] = 1.0
            continue
        matrix[s, s] = -w * w * system.inertia[s] + 1j * w * ground[s]
        right[s] = force[s]
    for k, span in enumerate(system.spans):
        row, ratio = stations + k, float(span.ratio)
        h, c, eta = system.flexibility[k], system.viscous[k], system.loss_factor[k]
        static = 0.0 if h == 0 or math.isinf(h) else (1 + 1j * eta) / h
        hc = 0.0 if h == 0 else 1.0 / (static + 1j * w * c)
        matrix[row, span.driving] += 1.0
        matrix[row, span.driven] -= 1.0 / ratio
        matrix[row, row] = -hc
        right[row] = -(errors or {}).get(k, 0.0) / ratio
        if not system.held[span.driving]:
            matrix[span.driving, row] += 1.0
        if not system.held[span.driven]:
            matrix[span.driven, row] -= 1.0 / ratio
    found = np.linalg.solve(matrix, right)
    return found[:stations], found[stations:]


def random_components(random: np.random.Generator, points: int, depth: int = 0) -> list:
    """A train of mild figures with gears, branches, rigid and viscous couplings and dampers to ground."""
    line: list = []
    for k in range(points):
        if k:
            line.append(_random_link(random))
        damping = float(random.uniform(0.1, 3.0)) if random.random() < 0.5 else None
        line.append(Disc(inertia=float(random.uniform(0.5, 5.0)), damping=damping))
        if depth < 2 and random.random() < 0.3:
            branch = [
                _random_link(random),
                *random_components(random, int(random.integers(1, 4)), depth + 1),
            ]
            line.append(Branch(train=tuple(branch)))
    return line


def _random_link(random: np.random.Generator) -> Coupling | Gear:
    sort = random.random()
    if sort < 0.2:
        teeth = (int(random.integers(15, 60)), int(random.integers(15, 60)))
        mesh = float(10 ** random.uniform(3, 5)) if random.random() < 0.5 else None
        return Gear(teeth=teeth, inertia=(0.1, 0.2), mesh_stiffness=mesh)
    if sort < 0.3:
        return Coupling(flexibility=0)
    stiffness = float(10 ** random.uniform(3, 5))
    if sort < 0.6:
        return Coupling(stiffness=stiffness, viscous=float(random.uniform(1, 30)))
    return Coupling(stiffness=stiffness, loss_factor=float(random.uniform(0.0, 0.1)))


@pytest.fixture
def build() -> Callable:
    """`make_study`."""
    return make_study


@pytest.fixture
def dense() -> Callable:
    """`dense_answer`."""
    return dense_answer


@pytest.fixture
def random_train() -> Callable:
    """`random_components`."""
    return random_components


@pytest.fixture
def operation() -> Callable:
    """An operation over speeds in rad/s, without the text of units."""

    def made(first: float, last: float, steps: int = 11, **more: object) -> Operation:
        speeds = {"from": f"{first!r} rad/s", "to": f"{last!r} rad/s", "steps": steps}
        rated = more.pop("rated", None)
        if rated is not None:
            more["rated"] = {"speed": f"{rated[0]!r} rad/s", "power": rated[1]}
        return Operation(speeds=speeds, **more)

    return made
