"""Orders of a torque while the speed changes: curves, and a waterfall in shades of gray."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from torsion.arrays import FloatArray
from torsion.output.figures.curves_over_speed import over
from torsion.output.figures.style import amplitude_axis, pens, plots

DECADES = 3.0  # below the largest amplitude that shades show


def orders(sheet: Figure, *, x: FloatArray, quantity: str, unit: str, lines: Sequence[tuple[str, FloatArray]]) -> None:
    """x: (windows,) ascending; lines: (label, amplitudes (windows,) in `unit`)."""
    with over(sheet, 2.6, x, f"torque amplitude, {unit}", quantity=quantity) as axes:
        for (label, values), pen in zip(lines, pens(len(lines)), strict=True):
            axes.plot(x, values, label=label, **pen)
        amplitude_axis(axes, [values for _, values in lines])


def waterfall(
    sheet: Figure, *, x: FloatArray, quantity: str, unit: str, order: FloatArray, amplitude: FloatArray, reference: str
) -> None:
    """x: (windows,) ascending; order: (orders,); amplitude: (windows, orders) in `unit`, of which the mean is left out.

    The logarithm of the amplitude is the shade: dark is large.
    """
    (axes,) = plots(sheet, 3.6)
    axes.grid(visible=False)
    shown = amplitude[:, 1:]
    top = float(shown.max()) or 1.0
    shades: dict[str, Any] = {"cmap": "gray_r", "norm": LogNorm(top * 10.0**-DECADES, top)}
    least = np.maximum(shown, top * 10.0**-DECADES)
    drawn = axes.pcolormesh(order[1:], x, least, shading="nearest", rasterized=True, **shades)
    axes.set_xlabel(f"order of {reference}")
    axes.set_ylabel(quantity)
    sheet.colorbar(drawn, ax=axes, extend="min").set_label(f"torque amplitude, {unit}")
