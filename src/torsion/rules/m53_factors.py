"""Stress concentration and fatigue strength of crank throws after IACS UR M53 (KR 2025, Part 5, Annex 5-3).

Lengths in mm, stresses in N/mm2. The bores of pin and journal lie in their axes.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray

LEAST_OVERLAP = -0.5  # s below which the factors are those at it
LEAST_RADIUS = 2.0  # mm, that counts in the fatigue strength


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
    pin_bore: float = 0.0  # D_BH
    journal_bore: float = 0.0  # D_BG
    pin_recess: float = 0.0  # T_H, of the fillet in the web
    journal_recess: float = 0.0  # T_G

    @property
    def ratios(self) -> dict[str, float]:
        """Those that the formulas have, all over the diameter of the pin."""
        return {
            "s": ((self.pin + self.journal) / 2.0 - self.radius) / self.pin,
            "w": self.web_thickness / self.pin,
            "b": self.web_width / self.pin,
            "r of the pin": self.pin_fillet / self.pin,
            "r of the journal": self.journal_fillet / self.pin,
            "d of the oil bore": self.oil_bore / self.pin,
            "d of the bore of the pin": self.pin_bore / self.pin,
            "d of the bore of the journal": self.journal_bore / self.pin,
        }

    @property
    def overlap(self) -> float:
        """s as the factors take it: below -0.5 they hold at -0.5."""
        return max(self.ratios["s"], LEAST_OVERLAP)

    @property
    def recess(self) -> float:
        """Factor of the recesses of both fillets, at least 1; of the overlap as it is."""
        depth = (self.pin_recess + self.journal_recess) / self.pin
        return max(1.0, 1.0 + depth * (1.8 + 3.2 * self.ratios["s"]))


RANGES = {  # in which the factors were measured
    "s": (-np.inf, 0.5),
    "w": (0.2, 0.8),
    "b": (1.1, 2.2),
    "r of the pin": (0.03, 0.13),
    "r of the journal": (0.03, 0.13),
    "d of the oil bore": (0.0, 0.2),
    "d of the bore of the pin": (0.0, 0.8),
    "d of the bore of the journal": (0.0, 0.8),
}


def alpha_b(throw: Throw) -> float:
    """Return the stress concentration factor of bending in the fillet of the pin."""
    _, w, b, r, _, _, d_h, d_g = throw.ratios.values()
    overlap = (
        (-4.1883, 29.2004, -77.5925, 91.9454, -40.0416),
        (9.5440, -58.3480, 159.3415, -192.5846, 85.2916),
        (-3.8399, 25.0444, -70.5571, 87.0328, -39.1832),
    )
    of_web = 2.1790 * w**0.7171 * (0.6840 - 0.0077 * b + 0.1473 * b**2)
    of_journal = 0.9993 + 0.27 * d_g - 1.0211 * d_g**2 + 0.5306 * d_g**3
    of_pin = 0.9978 + 0.3145 * d_h - 1.5241 * d_h**2 + 2.4147 * d_h**3
    of_bores = of_journal * of_pin * throw.recess
    return float(
        2.6914 * _overlap(overlap, throw.overlap, w) * of_web * 0.2081 * r**-0.5231 * of_bores
    )


def beta_b(throw: Throw) -> float:
    """Return the stress concentration factor of bending in the fillet of the journal."""
    _, w, b, _, r, _, d_h, d_g = throw.ratios.values()
    overlap = (-1.7625, 2.9821, -1.5270), (5.1169, -5.8089, 3.1391), (-2.1567, 2.3297, -1.2952)
    of_web = 2.2422 * w**0.7548 * (0.5616 + 0.1197 * b + 0.1176 * b**2)
    of_journal = 1.0012 - 0.6441 * d_g + 1.2265 * d_g**2
    of_bores = of_journal * (1.0022 - 0.1903 * d_h + 0.0073 * d_h**2) * throw.recess
    return float(
        2.7146 * _overlap(overlap, throw.overlap, w) * of_web * 0.1908 * r**-0.5568 * of_bores
    )


def beta_q(throw: Throw) -> float:
    """Return the stress concentration factor of shear in the fillet of the journal.

    The rule does not name its overlap below -0.5. The polynomial is negative there from -0.6, which would take stress
    away: s at -0.5 is larger, the safe side.
    """
    _, w, b, _, r, _, d_h, _ = throw.ratios.values()
    x = 1.0 - throw.overlap
    overlap = 0.4368 + 2.1630 * x - 1.5212 * x**2
    of_bores = (0.9937 - 1.1949 * d_h + 1.7373 * d_h**2) * throw.recess
    return float(
        3.0128 * overlap * w / (0.0637 + 0.9369 * w) * (b - 0.5) * 0.5331 * r**-0.2038 * of_bores
    )


def alpha_t(throw: Throw, *, journal: bool = False) -> float:
    """Return the stress concentration factor of torsion in the fillet of the pin, or in that of the journal.

    That of the journal has its fillet over its own diameter; where both are those of the pin it is alpha_T.
    """
    w, b = throw.ratios["w"], throw.ratios["b"]
    r = throw.journal_fillet / throw.journal if journal else throw.pin_fillet / throw.pin
    of_width = 7.8955 - 10.654 * b + 5.3482 * b**2 - 0.85 * b**3
    return float(0.8 * r ** (-0.322 + 0.1015 * (1.0 - throw.overlap)) * of_width * w**-0.145)


def gamma_b(throw: Throw) -> float:
    """Return the stress concentration factor of bending at the outlet of the oil bore."""
    d = throw.ratios["d of the oil bore"]
    return 3.0 - 5.88 * d + 34.6 * d**2


def gamma_t(throw: Throw) -> float:
    """Return the stress concentration factor of torsion at the outlet of the oil bore."""
    d = throw.ratios["d of the oil bore"]
    return 4.0 - 6.0 * d + 30.0 * d**2


def _overlap(rows: tuple[tuple[float, ...], ...], s: float, w: float) -> float:
    """Return the sum of polynomials of w, lowest power first, each times the next power of 1 - s."""
    return float(
        sum((1.0 - s) ** k * sum(c * w**j for j, c in enumerate(row)) for k, row in enumerate(rows))
    )


def fatigue_strength(strength: float, diameter: float, radius: float, factor: float) -> float:
    """Return sigma_DW of a fillet or an oil bore of that radius, at least 2 mm of it; factor: K of the manufacture."""
    of_radius = 196.0 / strength * max(radius, LEAST_RADIUS) ** -0.5
    size = 0.264 + 1.073 * diameter**-0.2 + (785.0 - strength) / 4900.0 + of_radius
    return float(factor * (0.42 * strength + 39.3) * size)


def of_fillet(bending: float, torsion: ArrayLike) -> FloatArray:
    """Return the equivalent alternating stress of a fillet, from the local ones, the additional bending included."""
    return np.asarray(np.sqrt(bending**2 + 3.0 * np.square(np.asarray(torsion, dtype=float))))


def of_bore(bending: float, torsion: ArrayLike) -> FloatArray:
    """Return the equivalent alternating stress at the outlet of an oil bore; without bending the limit, |torsion|.

    sigma/3 (1 + 2 sqrt(1 + 9/4 (tau/sigma)^2)), written so that nothing is divided by a bending of 0.
    """
    local = np.asarray(torsion, dtype=float)
    return np.asarray((bending + 2.0 * np.sqrt(bending**2 + 2.25 * np.square(local))) / 3.0)
