"""Settings of `iacs-m53`: one throw of the crankshaft, its manufacture and its nominal stresses."""

import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from torsion import fields
from torsion.errors import Fault, Path
from torsion.fields import Quantity, given, refuse
from torsion.rules.m53_factors import Throw
from torsion.rules.rule_over_speed import Continuous, UseSettings
from torsion.rules.shaft_limits import MM, PA
from torsion.study import Study

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
    return (
        0.0
        if value == "none"
        else Quantity("m", at_least=0, usual="diameter of a shaft").read(value)
    )


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
            return (
                self.axial * PA + MISALIGNMENT,
                "crosshead engine, axial vibration stated by user",
            )
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
