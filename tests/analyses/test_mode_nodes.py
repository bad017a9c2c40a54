"""Nodes of modes whose angles differ by many decades: tiny ones that are true."""

import random

import pytest

import torsion
from torsion.analyses.undamped_modes import modes
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc

SHAFTS = """
name: two shafts with next to nothing between them
train:
  - disc: {inertia: 1}
  - shaft: {length: 2 m, diameter: 100 mm}
  - disc: {inertia: 3}
  - coupling: {stiffness: 2e-3}
  - disc: {unusual: true, inertia: 1e6}
  - shaft: {length: 1 m, diameter: 50 mm}
  - disc: {inertia: 1e-3}
"""


def _line(draw: random.Random, size: int) -> list:
    """Discs on couplings, of 21 decades, one coupling in ten rigid."""
    line = [Disc(inertia=10 ** draw.uniform(-12, 9), unusual=True)]
    for _ in range(size - 1):
        rigid = draw.random() < 0.1
        line.append(
            Coupling(flexibility=0) if rigid else Coupling(stiffness=10 ** draw.uniform(-3, 18))
        )
        line.append(Disc(inertia=10 ** draw.uniform(-12, 9), unusual=True))
    return line


def test_heavy_disc_between_light_ones_has_the_sign_of_its_tiny_angle(build):
    line = [
        Disc(inertia=1e-9),
        Coupling(stiffness=1e18),
        Disc(inertia=1e9),
        Coupling(stiffness=1e-2),
    ]
    _, system = build([*line, Disc(inertia=1e-12, unusual=True)])
    assert modes(system).nodes.tolist() == [1, 2]


@pytest.mark.parametrize("seed", range(40))
def test_every_mode_of_a_tree_has_one_node_more_than_the_one_before(build, seed):
    """Of a tree without loops the mode k (from 0, rigid motion included) has k nodes (Fiedler 1975)."""
    draw = random.Random(seed)
    line = _line(draw, draw.randint(2, 6))
    for _ in range(draw.randint(0, 3)):
        branch = Branch(
            train=(Coupling(stiffness=10 ** draw.uniform(-3, 18)), *_line(draw, draw.randint(1, 3)))
        )
        line.insert(draw.randint(1, len(line)), branch)
    if draw.random() < 0.3:
        line = [Disc(held=True), Coupling(stiffness=10 ** draw.uniform(-3, 18)), *line]
    found = modes(build(line)[1], None)
    assert found.nodes.tolist() == list(range(found.rigid, found.rigid + found.frequency.size))


@pytest.mark.parametrize("model", ["lumped", "fem", "exact"])
def test_mode_of_one_shaft_has_nodes_in_the_other_shaft_too(model):
    found = torsion.modes(torsion.assemble(torsion.parse(SHAFTS).train, model, frequency=3000.0), 8)
    assert found.nodes.tolist() == list(range(1, 9))


@pytest.mark.parametrize("ends", [(False, False), (True, False), (True, True)])
def test_localised_modes_of_a_long_chain_have_one_node_more_each(build, ends):
    """Their tails fall below the smallest angle that has a sign."""
    draw = random.Random(0)
    line = [Disc(inertia=1.0 + 0.3 * draw.uniform(-1.0, 1.0)) for _ in range(200)]
    parts = [part for disc in line for part in (Coupling(stiffness=1e6), disc)][1:]
    front, back = ([Disc(held=True)] if fixed else [] for fixed in ends)
    joint = [Coupling(stiffness=1e6)]
    train = [*front, *(joint if front else []), *parts, *(joint if back else []), *back]
    found = modes(build(train)[1], None)
    first = 0 if any(ends) else 1
    assert found.nodes.tolist() == list(range(first, first + found.frequency.size))
