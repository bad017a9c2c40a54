"""The formulas of IACS UR M68 (Rev. 3, 2021) for shafts; diameters in mm, stresses in N/mm2.

"rule text" was compared with a class society's printed rules (KR 2025, Part 5, Ch. 4); "to be verified" is to be
compared with the edition in force before it is relied on.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import BoolArray, FloatArray

Mark = Literal["rule text", "to be verified"]
Role = Literal["intermediate", "thrust", "propeller"]

LAST_CONTINUOUS = 1.05  # speed ratio above which the rule has no limit
FLAT_FROM = 0.9  # speed ratio from which tau_C no longer falls
BARRED_BELOW = 0.8  # no barred range reaches this speed ratio in normal firing
ROUNDING = 1e-9  # relative: a speed ratio this near to a bound is at the bound


@dataclass(frozen=True, slots=True)
class Detail:
    """What a design feature does to the permissible stress (C_K) and to the least diameter (k)."""

    c_k: float
    k: float
    has_keyway: bool = False
    condition: str = ""  # what the factor assumes
    c_k_mark: Mark = "rule text"
    k_mark: Mark = "to be verified"


DETAILS: Mapping[str, Detail] = {
    "flange": Detail(1.0, 1.0),
    "shrink fit": Detail(1.0, 1.0),
    "taper keyway": Detail(0.60, 1.10, has_keyway=True),
    "cylinder keyway": Detail(0.45, 1.10, has_keyway=True),
    "radial hole": Detail(0.50, 1.10, condition="hole at most 0.3 of the diameter"),
    "slot": Detail(0.30, 1.20),
    "thrust collar": Detail(0.85, 1.10),
    "roller bearing": Detail(0.85, 1.10),
    "propeller flange": Detail(0.55, 1.22),
    "propeller keyless": Detail(0.55, 1.22),
    "propeller keyed": Detail(0.55, 1.26, has_keyway=True),
    "tube shaft": Detail(0.80, 1.15, condition="forward of the aftmost bearing"),
}
ASSUMED: Mapping[Role, Detail] = {  # for a shaft whose features are not given
    "intermediate": Detail(1.0, 1.0, condition="integral flange assumed"),
    "thrust": Detail(0.85, 1.10, condition="thrust collar assumed"),
    "propeller": Detail(0.55, 1.26, condition="kind of propeller mounting not given, the least favourable taken"),
}
STRENGTH_CAP = 600.0  # N/mm2, the greatest tensile strength that counts (rule text)
ALLOY_STRENGTH_CAP = 800.0  # N/mm2, of intermediate and thrust shafts of alloy steel (rule text)
LEAST_STRENGTH = 400.0  # N/mm2 of shaft steel; taken for the built-in steel, of which none is stated (to be verified)
SMOOTH_DRIVE_FACTOR = 95.0  # F of intermediate shafts behind a turbine, motor or slip coupling (to be verified)
DRIVE_FACTOR = 100.0  # F of any other drive and any other shaft (to be verified)


def used_strength(strength: float, role: Role, *, alloy: bool) -> float:
    """The tensile strength that may be used (rule text)."""
    return min(strength, ALLOY_STRENGTH_CAP if alloy and role != "propeller" else STRENGTH_CAP)


def size_factor(diameter: float) -> float:
    """C_D = 0.35 + 0.93 d^-0.2 (rule text)."""
    return float(0.35 + 0.93 * diameter**-0.2)


def tau_c(strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike) -> FloatArray:
    """Stress amplitude permissible in continuous use (rule text); NaN above 1.05 of the rated speed."""
    ratio = np.asarray(speed_ratio, dtype=float)
    shape = np.where(ratio < FLAT_FROM, 3.0 - 2.0 * ratio**2, 1.38)
    limit = (strength + 160.0) / 18.0 * c_k * size_factor(diameter) * shape
    return np.asarray(np.where(ratio <= LAST_CONTINUOUS * (1 + ROUNDING), limit, np.nan))


def tau_t(strength: float, diameter: float, c_k: float, speed_ratio: ArrayLike) -> FloatArray:
    """Stress amplitude permissible while a barred range is passed, 1.7 tau_C/sqrt(C_K) (rule text); NaN above 0.8."""
    ratio = np.asarray(speed_ratio, dtype=float)
    limit = 1.7 * tau_c(strength, diameter, c_k, ratio) / np.sqrt(c_k)
    return np.asarray(np.where(ratio <= BARRED_BELOW * (1 + ROUNDING), limit, np.nan))


def may_be_barred(speed_ratio: ArrayLike) -> BoolArray:
    """Where a barred range is accepted in normal firing (rule text): below 0.8 of the rated speed."""
    return np.asarray(np.asarray(speed_ratio, dtype=float) < BARRED_BELOW * (1 - ROUNDING))


def barred_range(critical: float, rated: float) -> tuple[float, float]:
    """Least barred range about a critical speed (rule text): 16 n_c/(18 - lambda) to (18 - lambda) n_c/16."""
    width = 18.0 - critical / rated
    return 16.0 * critical / width, width * critical / 16.0


def slot_concentration(diameter: float, bore: float, length: float, width: float) -> float:
    """Stress concentration factor of a longitudinal slot (to be verified)."""
    e, hollow = width / diameter, bore / diameter
    a = 2.3 - 3.0 * e + 15.0 * e**2 + 10.0 * e**2 * hollow**2
    return float(a + 0.8 * (length - width) / diameter / np.sqrt((1.0 - hollow) * e))


def slot_c_k(concentration: float) -> float:
    """C_K = 1.45/scf of a longitudinal slot (to be verified)."""
    return 1.45 / concentration


def drive_factor(role: Role, *, smooth: bool) -> float:
    """F of the least diameter (to be verified)."""
    return SMOOTH_DRIVE_FACTOR if smooth and role == "intermediate" else DRIVE_FACTOR


def least_diameter(power_per_speed: float, strength: float, factor: float, k: float, bore_share: float = 0.0) -> float:
    """Least diameter, mm (to be verified), from kW per rpm, F and k; a bore up to 0.4 of it does not count."""
    hollow = 1.0 - bore_share**4 if bore_share > 0.4 else 1.0
    return float(factor * k * (power_per_speed / hollow * 560.0 / (strength + 160.0)) ** (1.0 / 3.0))
