"""Logarithmic axes with plain numbers, as the figures' style writes no formulae."""

from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

DECADES = 10  # marked on an axis, at most


def plain_numbers(*axes: Axis) -> None:
    """Decades as 1e-06 or 100, nothing between them."""
    for axis in axes:
        axis.set_major_locator(LogLocator(numticks=DECADES))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
