"""Materials of shafts."""

from torsion import fields
from torsion.fields import Declared, given, required


class Material(Declared):
    """An isotropic elastic material."""

    shear_modulus: fields.Modulus = required("G")
    youngs_modulus: fields.Modulus | None = given("E; needed for bending only")
    density: fields.Density = required("rho; 0 makes a massless shaft")
    tensile_strength: fields.Modulus | None = given("sigma_B, needed by the class rules")
    loss_factor: fields.Share = given("energy lost in a cycle / (2 pi peak elastic energy)", 0.0)


STEEL = Material(shear_modulus=79.3e9, youngs_modulus=206e9, density=7850.0)
