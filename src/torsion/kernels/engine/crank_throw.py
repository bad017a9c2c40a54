"""Torsional stiffness of a crank throw from its dimensions, by two formulas of the handbooks: estimates."""

import math
from dataclasses import dataclass

from torsion.sources import source


@dataclass(frozen=True)
class Throw:
    """Dimensions in m; journal and pin hollow or solid, web as a rectangle."""

    journal: tuple[float, float, float]  # diameter, bore, length
    pin: tuple[float, float, float]
    web: tuple[float, float]  # thickness along the shaft, width
    radius: float  # of the crank


@source("Carter")
def carter(throw: Throw, shear_modulus: float) -> float:
    """N m/rad after Carter (Nestorides, handbook; to be verified)."""
    (d_j, bore_j, l_j), (d_p, bore_p, l_p), (thick, wide) = throw.journal, throw.pin, throw.web
    length = (l_j + 0.8 * thick) / (d_j**4 - bore_j**4) + 0.75 * l_p / (d_p**4 - bore_p**4)
    return math.pi * shear_modulus / 32.0 / (length + 1.5 * throw.radius / (thick * wide**3))


@source("KerWilson")
def ker_wilson(throw: Throw, shear_modulus: float) -> float:
    """N m/rad after Ker Wilson (Nestorides, handbook; to be verified)."""
    (d_j, bore_j, l_j), (d_p, bore_p, l_p), (thick, wide) = throw.journal, throw.pin, throw.web
    length = (l_j + 0.4 * d_j) / (d_j**4 - bore_j**4) + (l_p + 0.4 * d_p) / (d_p**4 - bore_p**4)
    return (
        math.pi
        * shear_modulus
        / 32.0
        / (length + (throw.radius - 0.2 * (d_j + d_p)) / (thick * wide**3))
    )
