"""Pressures over the volume of one end of a cylinder, or over the travel of its piston, as pressures over the angle."""

import math

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.engine.crank_slider import CrankSlider
from torsion.kernels.engine.gas_torque import Diagram

SAME_ROW = 1e-9  # of the stroke: rows no farther apart are one


def angle_of_travel(crank: CrankSlider, travel: FloatArray) -> FloatArray:
    """rad, 0 to pi: crank angle at which the piston has travelled (m) from its outer dead centre; without an offset.

    With s = l + r - x of the law of cosines, 1 - cos = x (2 l - x)/(2 r s) and 1 + cos = (2 r - x)(2 l + 2 r - x)/(2 r
    s): both without a difference that cancels, so that the dead centres are exact.

    >>> angle_of_travel(CrankSlider(0.05, 0.15), np.array([0.0, 0.1])) == [0.0, math.pi]
    array([ True,  True])
    """
    radius, rod = crank.radius, crank.rod
    inner = np.sqrt(travel * (2.0 * rod - travel))
    outer = np.sqrt(np.maximum(2.0 * radius - travel, 0.0) * (2.0 * (rod + radius) - travel))
    return 2.0 * np.arctan2(inner, outer)


class NoLoop(ValueError):
    """Rows that are no closed loop: the position of the row (None: of all), what is wrong, what would be right."""

    def __init__(self, row: int | None, message: str, hint: str) -> None:
        self.row, self.message, self.hint = row, message, hint
        super().__init__(message)


def of_loop(crank: CrankSlider, travel: FloatArray, pressure: FloatArray, meet: float) -> Diagram:
    """The diagram of rows in the order in which the piston moves, from any of them on; the last repeats the first.

    travel: (rows,) m from the outer dead centre, which rises once from 0 to the stroke and falls once to 0; pressure:
    (rows,) Pa. meet: of the largest pressure, by how much two rows at one place may differ. Raises NoLoop.
    """
    near, kept = SAME_ROW * 2.0 * crank.radius, [0]
    for row in range(1, len(travel)):
        if abs(travel[row] - travel[kept[-1]]) > near:
            kept.append(row)
        elif abs(pressure[row] - pressure[kept[-1]]) > meet * pressure.max():
            raise NoLoop(row, "two pressures at one volume", "rows follow the motion of the piston")
    if abs(travel[-1] - travel[0]) > near:
        raise NoLoop(
            len(travel) - 1,
            "the loop is not closed",
            "the last row repeats the first, a revolution later",
        )
    if abs(pressure[-1] - pressure[0]) > meet * pressure.max():
        raise NoLoop(
            len(travel) - 1,
            "it ends with another pressure than it begins with",
            "the loop is closed",
        )
    rows = np.array(kept[:-1])
    rows = np.roll(rows, -int(np.argmin(travel[rows])))
    turn = int(np.argmax(travel[rows]))
    if not 0 < turn < len(rows) - 1:
        hint = "expansion and suction, then compression and discharge"
        raise NoLoop(None, "the rows do not form a loop of two branches", hint)
    wrong = np.flatnonzero((np.diff(travel[rows]) > 0) != (np.arange(len(rows) - 1) < turn))
    if wrong.size:
        fault_row, turns = int(rows[wrong[0] + 1]), "it rises once and falls once"
        raise NoLoop(
            fault_row, "the volume turns back between its ends", f"in the order of motion {turns}"
        )
    angle = angle_of_travel(crank, travel[rows])
    angle[turn + 1 :] = 2.0 * math.pi - angle[turn + 1 :]
    return Diagram(np.append(angle, 2.0 * math.pi), np.append(pressure[rows], pressure[rows[0]]))
