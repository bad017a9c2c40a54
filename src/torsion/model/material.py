"""Materials of shafts."""

import math
from typing import Annotated

from torsion import fields
from torsion.fields import Quantity, Sized, given, refuse, required

Strength = Annotated[float, Quantity("Pa", above=0, usual="strength")]


class Material(Sized):
    """An isotropic elastic material."""

    shear_modulus: fields.Modulus = required("G")
    youngs_modulus: fields.Modulus | None = given("E; needed for bending only")
    density: Annotated[float, Quantity("kg/m**3", at_least=0, usual="density")] = required(
        "rho; 0 makes a massless shaft"
    )
    tensile_strength: Strength | None = given("sigma_B, needed by the class rules")
    yield_strength: Strength | None = given(
        "R_eH or R_p0.2, needed by the rule `ice`; `kr` and `nk` use it"
    )
    loss_factor: fields.LossFactor = given(
        "energy lost in a cycle / (2 pi peak elastic energy)", 0.0
    )

    def refuse_clashes(self) -> None:
        if (self.yield_strength or 0.0) > (self.tensile_strength or math.inf):
            message = "the yield strength is above the tensile strength"
            raise refuse(message, "are they interchanged?", "yield_strength")


STEEL = Material(shear_modulus=79.3e9, youngs_modulus=206e9, density=7850.0)
