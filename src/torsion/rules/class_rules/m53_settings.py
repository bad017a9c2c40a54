"""Settings of `iacs-m53`: one throw of the crankshaft, its manufacture and its nominal stresses."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.polynomial.polynomial import polyval2d
from numpy.typing import ArrayLike
from pydantic import BeforeValidator

from torsion import fields
from torsion.arrays import FloatArray
from torsion.errors import Fault, Path
from torsion.fields import Quantity, given, refuse
from torsion.rules.class_rules.shaft_limits import MM, PA
from torsion.rules.rule_over_speed import Continuous, UseSettings
from torsion.study import Study

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
    overlap = (  # a row of powers of w for every power of 1 - s
        (-4.1883, 29.2004, -77.5925, 91.9454, -40.0416),
        (9.5440, -58.3480, 159.3415, -192.5846, 85.2916),
        (-3.8399, 25.0444, -70.5571, 87.0328, -39.1832),
    )
    of_web = 2.1790 * w**0.7171 * (0.6840 - 0.0077 * b + 0.1473 * b**2)
    of_journal = 0.9993 + 0.27 * d_g - 1.0211 * d_g**2 + 0.5306 * d_g**3
    of_pin = 0.9978 + 0.3145 * d_h - 1.5241 * d_h**2 + 2.4147 * d_h**3
    of_bores = of_journal * of_pin * throw.recess
    return float(
        2.6914
        * polyval2d(1.0 - throw.overlap, w, overlap)
        * of_web
        * 0.2081
        * r**-0.5231
        * of_bores
    )


def beta_b(throw: Throw) -> float:
    """Return the stress concentration factor of bending in the fillet of the journal."""
    _, w, b, _, r, _, d_h, d_g = throw.ratios.values()
    overlap = (-1.7625, 2.9821, -1.5270), (5.1169, -5.8089, 3.1391), (-2.1567, 2.3297, -1.2952)
    of_web = 2.2422 * w**0.7548 * (0.5616 + 0.1197 * b + 0.1176 * b**2)
    of_journal = 1.0012 - 0.6441 * d_g + 1.2265 * d_g**2
    of_bores = of_journal * (1.0022 - 0.1903 * d_h + 0.0073 * d_h**2) * throw.recess
    return float(
        2.7146
        * polyval2d(1.0 - throw.overlap, w, overlap)
        * of_web
        * 0.1908
        * r**-0.5568
        * of_bores
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


def fatigue_strength(strength: float, diameter: float, radius: float, factor: float) -> float:
    """Return sigma_DW of a fillet or an oil bore of that radius, at least 2 mm of it; factor: K of the manufacture."""
    of_radius = 196.0 / strength * max(radius, LEAST_RADIUS) ** -0.5
    size = 0.264 + 1.073 * diameter**-0.2 + (785.0 - strength) / 4900.0 + of_radius
    return float(factor * (0.42 * strength + 39.3) * size)


def of_bore(bending: float, torsion: ArrayLike) -> FloatArray:
    """Return the equivalent alternating stress at the outlet of an oil bore; without bending the limit, |torsion|.

    sigma/3 (1 + 2 sqrt(1 + 9/4 (tau/sigma)^2)), written so that nothing is divided by a bending of 0.
    """
    local = np.asarray(torsion, dtype=float)
    return np.asarray((bending + 2.0 * np.sqrt(bending**2 + 2.25 * np.square(local))) / 3.0)


AXIAL, MISALIGNMENT = (
    20.0,
    10.0,
)  # N/mm2 of additional bending, of crosshead engines; misalignment of trunk pistons too
SIZES = (
    "pin",
    "journal",
    "pin_fillet",
    "journal_fillet",
    "web_thickness",
    "web_width",
    "radius",
    "bending",
    "shear",
    "strokes",
)
FACTORS, ROUNDING = (1.05, 1.0, 0.93), 1e-9  # K of UR M53; rounding of one
CAST = 0.93  # K of a cast crankshaft with approved cold rolling, the least of all
SAME_SIZE = 1e-3  # relative: sizes of rule and engine that differ by less are one, rounded
Stress = Annotated[float, Quantity("Pa", at_least=0, usual="stress")]


def _read_manufacture(value: Any) -> Any:
    return value if value in ("cast", None) else Quantity("1", above=0, at_most=1.2).read(value)


def _read_bore(value: Any) -> Any:
    bore = Quantity("m", at_least=0, usual="diameter of a shaft")
    return 0.0 if value == "none" else bore.read(value)


Manufacture = Annotated[Any, BeforeValidator(_read_manufacture, float | str)]
OilBore = Annotated[float, BeforeValidator(_read_bore, float | str)]


class M53Settings(UseSettings):
    """Settings of `iacs-m53`: a throw, with bores and recesses."""

    pin: fields.Across | None = given("diameter D of the crank pin")
    journal: fields.Across | None = given("diameter D_G of the journals")
    pin_fillet: fields.Across | None = given("radius R_H of the fillet of the pin")
    journal_fillet: fields.Across | None = given("radius R_G of the fillet of the journal")
    web_thickness: fields.Across | None = given("W, along the shaft")
    web_width: fields.Across | None = given("B")
    radius: fields.Across | None = given("E, of the crank: half the stroke")
    oil_bore: OilBore | None = given(
        "diameter D_O of the oil bore in the pin (m, or text as 20 mm), or none if neither pin nor journals have one; "
        "without it the outlet of the oil bore is NOT JUDGED"
    )
    drilling: Literal["radial", "other"] | None = given(
        "direction of the oil bore; if it is not radial, its outlet is NOT JUDGED (default: radial, as a restriction)"
    )
    built: Literal["solid", "semi-built"] | None = given(
        "solid: forged or cast in one piece; semi-built: only the fillet of the pin is judged, the shrink fits are "
        "NOT JUDGED (default: solid, as a restriction)"
    )
    pin_bore: fields.Bore = given("diameter D_BH of the bore of the pin (default: solid)", 0.0)
    journal_bore: fields.Bore = given(
        "diameter D_BG of the bore of the journals (default: solid)", 0.0
    )
    pin_recess: fields.Bore = given(
        "depth T_H of the recess of the pin's fillet (default: none)", 0.0
    )
    journal_recess: fields.Bore = given(
        "depth T_G of the recess of the journal's fillet (default: none)", 0.0
    )
    bending: Stress | None = given(
        "nominal alternating bending stress of the web, by the engine's maker, with K_e in it (0.8 of two-stroke, 1.0 "
        "of four-stroke engines)"
    )
    shear: Stress | None = given(
        "nominal alternating shear stress of the web, by the engine's maker, with K_e in it"
    )
    bore_bending: Stress | None = given(
        "nominal alternating bending stress at the oil bore, by the engine's maker"
    )
    engine: Literal["crosshead", "trunk piston"] = given(
        "kind of the engine, for the additional bending stress: crosshead 30 MPa (axial vibration 20, "
        "misalignment 10), trunk piston 10 MPa",
        "crosshead",
    )
    axial: Stress | None = given(
        "calculated bending stress by axial vibration of the whole system, in place of the 20 MPa of a crosshead engine"
    )
    additional: Stress | None = given(
        "additional bending stress in place of the values of `engine` and `axial`"
    )
    manufacture: Manufacture = given(
        "factor K: 1.05 continuous grain flow, 1.0 free-form forged, 0.93 cast with approved cold rolling; cast: "
        "without cold rolling, NOT JUDGED (default: 0.93, as a restriction)"
    )
    strokes: Literal[2, 4] | None = given(
        "strokes of a cycle, for the orders that the response must have"
    )
    continuous: Continuous | None = given(
        "speeds without the barred ranges: {from, to} (default: all)"
    )

    @property
    def throw(self) -> Throw:
        """In mm; raises ValueError where a size is missing."""
        if None in [getattr(self, key) for key in SIZES[:7]]:
            raise ValueError("a size of the throw is missing")
        sizes = {key: (getattr(self, key) or 0.0) * MM for key in Throw.__dataclass_fields__}
        if self.built == "semi-built" and self.strokes == 2:
            # W_red: the recess reaches below the fillet.
            sizes["web_thickness"] -= max(0.0, sizes["pin_recess"] - sizes["pin_fillet"])
        return Throw(**sizes)

    @property
    def factor(self) -> float:
        """The factor K of the manufacture, 0.93 where none is stated."""
        return self.manufacture if isinstance(self.manufacture, float) else CAST

    @property
    def added_bending(self) -> tuple[float, str]:
        """Additional bending stress, N/mm2, and where it is from, in words (KR A5-3 4)."""
        if self.additional is not None:
            return self.additional * PA, "stated by user"
        if self.engine == "trunk piston":
            return MISALIGNMENT, "trunk piston engine"
        if self.axial is not None:
            words = "crosshead engine, axial vibration stated by user"
            return self.axial * PA + MISALIGNMENT, words
        return AXIAL + MISALIGNMENT, "crosshead engine"

    def refuse_clashes(self) -> None:
        if self.axial is not None and (self.engine != "crosshead" or self.additional is not None):
            message = "`axial` replaces the 20 MPa of a crosshead engine only"
            raise refuse(message, "leave out `axial`, or `additional`", "axial")
        is_crosshead = self.engine == "crosshead" and bool(
            {"engine", "axial"} & self.model_fields_set
        )
        if self.strokes == 4 and is_crosshead:
            hint = "`strokes: 2`, or `engine: trunk piston` without `axial`"
            raise refuse(
                "a crosshead engine has two strokes a cycle, and `strokes` is 4", hint, "strokes"
            )
        if min(abs(self.factor - factor) for factor in FACTORS) > ROUNDING:
            hint = "1.05 continuous grain flow, 1.0 free-form forged, 0.93 cast with cold rolling"
            raise refuse(f"the text has no factor K of {self.factor:g}", hint, "manufacture")
        for key in ("pin", "journal"):
            outer, bore = getattr(self, key), getattr(self, f"{key}_bore")
            if outer is not None and bore >= outer:
                message = f"`{key}_bore` is not smaller than `{key}`"
                raise refuse(message, "both are diameters", f"{key}_bore")


def contradictions(study: Study, settings: M53Settings, where: Path) -> Iterator[Fault]:
    """Yield sizes of the throw, and strokes, that an engine of the file has otherwise; where: of the settings."""
    for part in study.train.parts:
        if part.engine is None:
            continue
        for key, size, path in part.engine.sizes:
            stated = getattr(settings, key)
            if stated is None or math.isclose(stated, size, rel_tol=SAME_SIZE, abs_tol=0.0):
                continue
            values = [
                f"{value:g}" if key == "strokes" else f"{value * MM:.6g} mm"
                for value in (stated, size)
            ]
            message = (
                f"`{key}` of iacs-m53 is {values[0]}, and the engine '{part.name}' has {values[1]}"
            )
            hint = f"`{key}: {values[1]}`, or correct the engine; one rule judges one crankshaft"
            yield Fault((*where, key), message, hint, other=(*part.path, *path))
