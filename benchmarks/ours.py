"""torsion on the cases: its kernels on a bare tree, and its public calls on a train read from a scene."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.cases import Case, condensed
from benchmarks.decomposition import chain_frequencies, plain_modes
from benchmarks.scenes import scene
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import complex_compliance, tree_response

NAME = "torsion"
FEW = 20  # lowest modes, which is what an engineer wants of a large train


def tree(case: Case) -> Tree:
    """The condensed case as the kernels take it."""
    flat = condensed(case)
    return Tree(
        parent=np.array(flat.parent),
        flexibility=np.array([0.0, *(1 / k for k in flat.stiffness[1:])]),
        inertia=np.array(flat.inertia),
        held=np.zeros(case.size, dtype=bool),
    )


def modes(bare: Tree, count: int | None = None) -> Any:
    """Frequencies with shapes, torques and certificate; the tree is new, so nothing is kept from the last call."""
    return tree_modes(replace(bare), count)


def plain(bare: Tree) -> Any:
    """All frequencies with shapes and torques, no certificate."""
    return plain_modes(replace(bare))


def frequencies_of_chain(case: Case) -> Callable[[], np.ndarray]:
    """What gives all elastic frequencies only, rad/s, from the arrays of inertia and stiffness."""
    inertia, stiffness = np.array(case.inertia), np.array(case.stiffness[1:])
    return lambda: chain_frequencies(inertia, stiffness)


class Response:
    """A steady response prepared as far as the peers' excitation and assembly are; calling it does the rest."""

    def __init__(self, case: Case, force: Sequence[complex], w: np.ndarray):
        flat = condensed(case)
        self.bare, self.w = tree(case), w
        self.force = np.array(flat.ratio) * np.asarray(force)
        self.damping, self.viscous = np.array(flat.damping), np.array(flat.viscous)
        self.span_ratio = np.array(flat.span_ratio)[:, None]

    def __call__(self, *, check: bool = True) -> Any:
        """The kernel's answer in condensed angles; `check` adds the residual of every frequency."""
        bare, compliance = replace(self.bare), None
        if self.viscous.any():
            compliance = complex_compliance(
                bare.flexibility, self.viscous, np.zeros(bare.size), self.w
            )
        return tree_response(
            bare,
            self.w,
            self.force,
            ground_damping=self.damping,
            compliance=compliance,
            check=check,
        )

    def span_torque(self, answer: Any) -> np.ndarray:
        """Torque in span i on station i at the span's own speed, (stations, frequencies)."""
        return np.asarray(answer.torque / self.span_ratio)


def read(case: Case, folder: Path) -> Any:
    """The study of the case, by way of a scene file."""
    import torsion

    return torsion.read(str(scene(case, folder)))
