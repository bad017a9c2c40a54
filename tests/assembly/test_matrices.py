"""Matrices in full, for export."""

import numpy as np
import pytest
from scipy.linalg import eigh

from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.assembly.matrices import matrices
from torsion.errors import InputError
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.train import train


def _system(*components):
    return assemble(train(list(components)))


def test_chain_has_its_textbook_matrices():
    system = _system(
        Disc(inertia=1.0, damping=0.5),
        Coupling(stiffness=10.0, viscous=0.2),
        Disc(inertia=2.0),
        Coupling(stiffness=20.0, loss_factor=0.1),
        Disc(inertia=3.0),
    )
    view = matrices(system)
    assert view.inertia.tolist() == np.diag([1.0, 2.0, 3.0]).tolist()
    assert view.stiffness == pytest.approx(
        np.array([[10, -10, 0], [-10, 30, -20], [0, -20, 20.0]]), rel=1e-15
    )
    assert view.damping == pytest.approx(
        np.array([[0.7, -0.2, 0], [-0.2, 0.2, 0], [0, 0, 0]]), rel=1e-15
    )
    assert view.loss == pytest.approx(np.array([[0, 0, 0], [0, 2, -2], [0, -2, 2.0]]), rel=1e-15)
    assert view.names == ("disc-1", "disc-2", "disc-3")


def test_rigid_spans_and_gears_share_one_free_angle_and_held_stations_have_none():
    system = _system(
        Disc(held=True),
        Coupling(stiffness=10.0),
        Disc(inertia=1.0),
        Gear(ratio=2),
        Disc(inertia=4.0),
        Coupling(flexibility=0),
        Disc(inertia=8.0),
    )
    view = matrices(system)
    assert view.inertia == pytest.approx(np.array([[1.0 + 12.0 / 4.0]]), rel=1e-15)
    assert view.stiffness == pytest.approx(np.array([[10.0]]), rel=1e-15)
    assert sorted(view.basis[:, 0].tolist()) == [0.0, 0.5, 0.5, 1.0]


def test_eigenvalues_of_the_matrices_are_the_modes_of_a_mild_train():
    system = _system(
        Disc(inertia=1.0, stiffness=3.0),
        Coupling(stiffness=10.0),
        Disc(inertia=2.0),
        Branch(train=(Coupling(stiffness=7.0), Disc(inertia=1.5))),
        Gear(ratio=3, mesh_stiffness=40.0),
        Coupling(stiffness=90.0),
        Disc(inertia=20.0),
    )
    view, found = matrices(system), modes(system, None)
    massive = np.flatnonzero(np.diag(view.inertia) > 0)
    massless = np.flatnonzero(np.diag(view.inertia) == 0)
    inner = view.stiffness[np.ix_(massless, massless)]
    coupled = view.stiffness[np.ix_(massless, massive)]
    condensed = view.stiffness[np.ix_(massive, massive)] - coupled.T @ np.linalg.solve(
        inner, coupled
    )
    w2 = eigh(condensed, view.inertia[np.ix_(massive, massive)], eigvals_only=True)
    assert np.sqrt(w2) / (2 * np.pi) == pytest.approx(found.frequency, rel=1e-12)


def test_unknown_model_is_a_fault_of_the_input():
    with pytest.raises(InputError, match="give lumped, fem, exact"):
        assemble(train([Disc(inertia=1.0), Coupling(stiffness=10.0), Disc(inertia=1.0)]), "foo")
