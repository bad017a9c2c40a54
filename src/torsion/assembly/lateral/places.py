"""Displacement, slope and bending moment along a shaft from its unknowns, at places inside every element."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.lateral.elements import functions, scaled
from torsion.assembly.lateral.shaft import LateralSystem

SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)  # of an element; both ends, as a moment may jump between two of them


@dataclass(frozen=True)
class Places:
    """Rows that give the values of one plane, (places, unknowns); an end between two elements is there twice."""

    position: FloatArray  # (places,) m from the start
    displacement: FloatArray  # m
    slope: FloatArray  # 1: of the section; with shear the line of the shaft is steeper
    moment: FloatArray  # N m: E I u'', which bends in the plane of y (about z) or of z
    moment_of_loss: FloatArray  # N m: loss factor times that, in quadrature


def places(system: LateralSystem, shares: tuple[float, ...] = SHARES) -> Places:
    """The rows at shares of the length of every element."""
    local = np.array(shares)
    unknowns = len(system.inertia)
    position, displacement, slope, moment, loss = [], [], [], [], []
    for cell in system.cells:
        section = cell.section
        shapes = scaled(functions(shares, system.shear), section.length, system.shear)
        stiff = section.youngs_modulus * section.moment(local)
        rows = np.zeros((3, len(shares), unknowns))
        for row, values in zip(rows, (shapes.deflection, shapes.rotation, shapes.bending * stiff), strict=True):
            row[:, cell.unknowns] = values.T
        position.append(cell.start + section.length * local)
        displacement.append(rows[0])
        slope.append(rows[1])
        moment.append(rows[2])
        loss.append(section.loss_factor * rows[2])
    return Places(
        np.concatenate(position), np.concatenate(displacement), np.concatenate(slope), np.concatenate(moment),
        np.concatenate(loss),
    )  # fmt: skip
