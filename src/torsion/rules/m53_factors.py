"""Stress concentration and fatigue strength of solid crank throws after IACS UR M53 (KR 2025, Part 5, Annex 5-3).

Lengths in mm, stresses in N/mm2. Without bores and recesses, whose factors are 1 but for the constants printed here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray


@dataclass(frozen=True)
class Throw:
    """A crank throw."""

    pin: float  # D
    journal: float  # D_G
    pin_fillet: float  # R_H
    journal_fillet: float  # R_G
    web_thickness: float  # W
    web_width: float  # B
    radius: float  # E, half the stroke
    oil_bore: float = 0.0  # D_O

    @property
    def ratios(self) -> dict[str, float]:
        """Those that the formulas have, all over the diameter of the pin."""
        return {
            "s": ((self.pin + self.journal) / 2.0 - self.radius) / self.pin, "w": self.web_thickness / self.pin,
            "b": self.web_width / self.pin, "r of the pin": self.pin_fillet / self.pin,
            "r of the journal": self.journal_fillet / self.pin, "d of the oil bore": self.oil_bore / self.pin,
        }  # fmt: skip


RANGES = {  # in which the factors were measured
    "s": (-np.inf, 0.5), "w": (0.2, 0.8), "b": (1.1, 2.2), "r of the pin": (0.03, 0.13),
    "r of the journal": (0.03, 0.13), "d of the oil bore": (0.0, 0.2),
}  # fmt: skip


def alpha_b(throw: Throw) -> float:
    """Of bending in the fillet of the pin."""
    s, w, b, r, *_ = throw.ratios.values()
    overlap = (
        (-4.1883, 29.2004, -77.5925, 91.9454, -40.0416), (9.5440, -58.3480, 159.3415, -192.5846, 85.2916),
        (-3.8399, 25.0444, -70.5571, 87.0328, -39.1832),
    )  # fmt: skip
    of_web = 2.1790 * w**0.7171 * (0.6840 - 0.0077 * b + 0.1473 * b**2)
    return float(2.6914 * _overlap(overlap, s, w) * of_web * 0.2081 * r**-0.5231 * 0.9993 * 0.9978)


def beta_b(throw: Throw) -> float:
    """Of bending in the fillet of the journal."""
    s, w, b, _, r, _ = throw.ratios.values()
    overlap = (-1.7625, 2.9821, -1.5270), (5.1169, -5.8089, 3.1391), (-2.1567, 2.3297, -1.2952)
    of_web = 2.2422 * w**0.7548 * (0.5616 + 0.1197 * b + 0.1176 * b**2)
    return float(2.7146 * _overlap(overlap, s, w) * of_web * 0.1908 * r**-0.5568 * 1.0012 * 1.0022)


def beta_q(throw: Throw) -> float:
    """Of shear in the fillet of the journal."""
    s, w, b, _, r, _ = throw.ratios.values()
    overlap = 0.4368 + 2.1630 * (1.0 - s) - 1.5212 * (1.0 - s) ** 2
    return float(3.0128 * overlap * w / (0.0637 + 0.9369 * w) * (b - 0.5) * 0.5331 * r**-0.2038 * 0.9937)


def alpha_t(throw: Throw, *, journal: bool = False) -> float:
    """Of torsion in the fillet of the pin, or in that of the journal."""
    s, w, b, pin, own, _ = throw.ratios.values()
    r = own if journal else pin
    of_width = 7.8955 - 10.654 * b + 5.3482 * b**2 - 0.85 * b**3
    return float(0.8 * r ** (-0.322 + 0.1015 * (1.0 - s)) * of_width * w**-0.145)


def gamma_b(throw: Throw) -> float:
    """Of bending at the outlet of the oil bore."""
    d = throw.ratios["d of the oil bore"]
    return 3.0 - 5.88 * d + 34.6 * d**2


def gamma_t(throw: Throw) -> float:
    """Of torsion at the outlet of the oil bore."""
    d = throw.ratios["d of the oil bore"]
    return 4.0 - 6.0 * d + 30.0 * d**2


def _overlap(rows: tuple[tuple[float, ...], ...], s: float, w: float) -> float:
    """Sum of polynomials of w, lowest power first, each times the next power of 1 - s."""
    return float(sum((1.0 - s) ** k * sum(c * w**j for j, c in enumerate(row)) for k, row in enumerate(rows)))


def fatigue_strength(strength: float, diameter: float, radius: float, factor: float) -> float:
    """sigma_DW of a fillet of that radius, or of an oil bore of that radius; factor: K of the manufacture."""
    size = 0.264 + 1.073 * diameter**-0.2 + (785.0 - strength) / 4900.0 + 196.0 / strength * radius**-0.5
    return float(factor * (0.42 * strength + 39.3) * size)


def of_fillet(bending: float, torsion: ArrayLike) -> FloatArray:
    """Equivalent alternating stress of a fillet, from the local ones, the additional bending included."""
    return np.asarray(np.sqrt(bending**2 + 3.0 * np.square(np.asarray(torsion, dtype=float))))


def of_bore(bending: float, torsion: ArrayLike) -> FloatArray:
    """Equivalent alternating stress at the outlet of an oil bore; without bending the limit, |torsion|.

    sigma/3 (1 + 2 sqrt(1 + 9/4 (tau/sigma)^2)), written so that nothing is divided by a bending of 0.
    """
    local = np.asarray(torsion, dtype=float)
    return np.asarray((bending + 2.0 * np.sqrt(bending**2 + 2.25 * np.square(local))) / 3.0)
