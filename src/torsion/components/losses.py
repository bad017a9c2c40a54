"""The internal damping of an elastic piece, in any of the ways in which makers give it."""

import math
from typing import Annotated, Any

from torsion.fields import Quantity, refuse

DAMPINGS = ("viscous", "loss_factor", "psi", "magnifier")
Psi = Annotated[float, Quantity("1", at_least=0, usual=(None, 4.0 * math.pi), slip=("%",))]
Magnifier = Annotated[float, Quantity("1", above=0, usual=(0.5, None), mistaken="a loss factor")]
PSI = "relative damping: energy lost in a cycle / peak elastic energy; eta = psi/(2 pi)"
MAGNIFIER = "dynamic magnifier M; eta = 1/M"


def given_damping(component: Any, keys: tuple[str, ...] = DAMPINGS) -> tuple[str, Any] | None:
    """Key and value of the damping that a component gives; None without one. Raises where it gives several.

    Of a table the value is one at each of its points.
    """
    found = [(key, value) for key in keys if (value := getattr(component, key)) is not None]
    if len(found) > 1:
        both = " and ".join(key for key, _ in found)
        raise refuse(f"{both} exclude each other", "give one kind of damping", found[1][0])
    return found[0] if found else None


def loss_factor(damping: tuple[str, float] | None) -> float:
    """The loss factor eta of a damping by its key and value; 0 where it is viscous or there is none."""
    key, value = damping or ("", 0.0)
    return {"loss_factor": value, "psi": value / (2.0 * math.pi), "magnifier": 1.0 / (value or 1.0)}.get(key, 0.0)
