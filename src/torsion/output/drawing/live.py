"""What the script of a page needs beside its drawings: places of the plots, their axes, the values of their lines."""

import json
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.drawing.curves import decimated
from torsion.output.drawing.frame import Frame
from torsion.output.drawing.scales import Scale
from torsion.output.drawing.text import plain
from torsion.output.figures.figure import Axis

DIGITS, PLACES = 5, 8  # significant, of a value and of its coordinate
MOST_POINTS = 1200  # of a line; of a longer one first, least, greatest and last of equal bins


class Page:
    """The coordinates of all lines of a page, each list once."""

    def __init__(self) -> None:
        self._known: dict[str, int] = {}

    def figure(self, frames: list[Frame]) -> str:
        """JSON of the plots of a figure that have numbers along them and lines to read off."""
        plots = (self._plot(frame) for frame in frames if not frame.panel.x.places)
        return f"[{','.join(plot for plot in plots if plot)}]"

    def coordinates(self) -> str:
        """JSON of all coordinates: a list for each number that a line names."""
        return f"[{','.join(self._known)}]"

    def _plot(self, frame: Frame) -> str:
        lines = []
        for line in frame.panel.lines:
            x, y = line.x[np.isfinite(line.x)], line.y[np.isfinite(line.x)]
            if line.name and x.size > 1 and bool(np.all(np.diff(x) >= 0)) and np.isfinite(y).any():
                if x.size > MOST_POINTS:
                    kept = decimated(x, np.nan_to_num(y), MOST_POINTS // 4)
                    x, y = x[kept], y[kept]
                place = self._known.setdefault(numbers(x, PLACES), len(self._known))
                lines.append(f'{{"name":{packed(plain(line.name))},"x":{place},"y":{numbers(y, DIGITS)}}}')
        if not lines:
            return ""
        box = [round(one, 2) for one in (frame.left, frame.top, frame.wide, frame.high)]
        head = {"box": box, "x": _axis(frame.panel.x, frame.x), "y": _axis(frame.panel.y, frame.y)}
        return f'{packed(head)[:-1]},"lines":[{",".join(lines)}]}}'


def _axis(axis: Axis, scale: Scale) -> dict[str, Any]:
    return {
        "title": axis.title, "unit": axis.unit, "ends": [scale.low, scale.high], "log": scale.is_log,
        "reversed": scale.is_reversed,
    }  # fmt: skip


def numbers(values: FloatArray, digits: int) -> str:
    """A list in JSON with so many significant digits, null where there is no value."""
    known = np.isfinite(values).tolist()
    return f"[{','.join(f'{v:.{digits}g}' if ok else 'null' for v, ok in zip(values.tolist(), known, strict=True))}]"


def packed(value: Any) -> str:
    """JSON that may stand in a page: no sign in it can end its element."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
