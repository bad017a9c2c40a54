"""The cross-section of a shaft as a file of triangles."""

import math
from typing import Literal

from torsion.fields import WIDEST, Declared, given, required
from torsion.primitives import SectionMesh

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254}


class MeshedSection(Declared):
    """A cross-section by mesh."""

    mesh: str = required(
        "file of triangles, relative to this file (.msh, .vtk, ...); its origin is the axis", min_length=1
    )
    unit: Literal["m", "cm", "mm", "in"] = given("unit of the mesh's coordinates", "m")

    def lowered(self, *, unusual: bool) -> SectionMesh:
        """The mesh, yet to be solved; one that is not unusual is at most as wide as a usual shaft."""
        return SectionMesh(self.mesh, UNITS[self.unit], math.inf if unusual else WIDEST)
