"""How a coupling warms by its own heat, and what that takes of its stiffness."""

import math
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator

from torsion.components.losses import Magnifier, Psi, given_damping
from torsion.fields import Declared, LossFactor, Power, Quantity, given, refuse, required
from torsion.kernels.warming import Warming

Temperature = Annotated[float, Quantity("degC", usual=(-60.0, 250.0))]
Rise = Annotated[float, Quantity("K", above=0, usual=(None, 200.0), mistaken="a temperature")]
Factor = Annotated[float, Quantity("1", above=0, usual=(0.05, 3.0), slip=("%",))]
ROW = "rows are [temperature, value], the temperatures rising: [[30 degC, 1], [100 degC, 0.6]]"


def _rows(value: Any) -> Any:
    if not isinstance(value, list | tuple) or not all(isinstance(row, list | tuple) and len(row) == 2 for row in value):
        raise refuse("this is no table over temperature", ROW)
    return tuple(tuple(row) for row in value)


Factors = Annotated[tuple[tuple[Temperature, Factor], ...], BeforeValidator(_rows)]
LossFactors = Annotated[tuple[tuple[Temperature, LossFactor], ...], BeforeValidator(_rows)]
Psis = Annotated[tuple[tuple[Temperature, Psi], ...], BeforeValidator(_rows)]
Magnifiers = Annotated[tuple[tuple[Temperature, Magnifier], ...], BeforeValidator(_rows)]


class CouplingWarming(Declared):
    """Stiffness and damping over temperature, and the rise of temperature by the heat of the vibration."""

    now: Temperature = required("temperature of the surroundings; all other results are of a coupling as cold as that")
    stiffness: Factors = required("rows [temperature, factor on the stiffness]")
    loss_factor: LossFactors | None = given("rows [temperature, loss factor], in place of the coupling's own")
    psi: Psis | None = given("rows [temperature, relative damping], in place of the coupling's own")
    magnifier: Magnifiers | None = given("rows [temperature, dynamic magnifier], in place of the coupling's own")
    rise: Rise = required("rise of temperature by the heat `at`, in proportion")
    at: Power = required("heat that warms it by `rise`")
    to: Temperature = required("highest permissible temperature")

    def refuse_clashes(self) -> None:
        if self.to <= self.now:
            raise refuse(f"{self.to:g} degC is not above the {self.now:g} degC of `now`", "it warms", "to")
        lost = given_damping(self, ("loss_factor", "psi", "magnifier"))
        for key, rows in (("stiffness", self.stiffness), lost or ("stiffness", self.stiffness)):
            if len(rows) < 2 or any(before[0] >= after[0] for before, after in pairwise(rows)):
                raise refuse("a table over temperature needs two rows or more, rising", ROW, key)
            if rows[0][0] > self.now or rows[-1][0] < self.to:
                message = f"the rows run from {rows[0][0]:g} to {rows[-1][0]:g} degC"
                raise refuse(message, f"they must cover {self.now:g} to {self.to:g} degC, `now` to `to`", key)

    def lowered(self) -> tuple[Warming, float, float | None]:
        """The record, the factor on the stiffness now, and the loss factor now (None: the coupling's own)."""
        key, values = given_damping(self, ("loss_factor", "psi", "magnifier")) or ("", ())
        of_psi = 2.0 * math.pi if key == "psi" else 1.0
        rows = tuple((t, value / of_psi) for t, value in values)
        now = np.array(self.now)
        points, factors = np.array(self.stiffness).T
        first = float(np.interp(now, points, factors))
        factor = tuple((t, value / first) for t, value in self.stiffness)
        found = Warming(self.now, self.to, self.rise / self.at, factor, rows, key == "magnifier")
        return found, first, float(found.loss_factor(now)) if rows else None
