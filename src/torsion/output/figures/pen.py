"""A pen for drawings of many like strokes: all strokes and areas of one look become one element of the figure."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path

Look = tuple[tuple[str, Any], ...]
Points = list[tuple[float, float]]


class Pen:
    """Collects strokes and areas by their look; `put` draws them, in the order in which the looks were first used."""

    def __init__(self, axes: Axes, thickness: float = 1.0) -> None:
        """thickness: by which all widths of lines are multiplied."""
        self.axes, self.thickness = axes, thickness
        self._strokes: dict[Look, list[Points]] = {}
        self._areas: dict[Look, list[Points]] = {}

    def stroke(self, x: Sequence[float], y: Sequence[float], **look: Any) -> None:
        """A line through places."""
        points = list(zip(x, y, strict=True))
        self._strokes.setdefault(tuple(look.items()), []).append(points)

    def area(self, corners: Points, **look: Any) -> None:
        """A filled polygon."""
        self._areas.setdefault(tuple(look.items()), []).append(corners)

    def put(self) -> None:
        """Draw everything."""
        for look, lines in self._strokes.items():
            gap = [(np.nan, np.nan)]
            points = np.array([point for line in lines for point in line + gap][:-1])
            self.axes.plot(points[:, 0], points[:, 1], **self._scaled(look))
        for look, polygons in self._areas.items():
            points = np.array([point for corners in polygons for point in [*corners, corners[0]]])
            codes = [code for corners in polygons for code in _around(len(corners))]
            self.axes.add_patch(PathPatch(Path(points, codes), **self._scaled(look)))

    def _scaled(self, look: Look) -> dict[str, Any]:
        return {key: value * self.thickness if key in ("lw", "markersize") else value for key, value in look}


def _around(corners: int) -> list[int]:
    """Codes of a closed polygon."""
    return [int(Path.MOVETO), *[int(Path.LINETO)] * (corners - 1), int(Path.CLOSEPOLY)]
