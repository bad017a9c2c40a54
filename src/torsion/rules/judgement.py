"""The verdict on a value that is computed over speed: the worst point against its limit."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.response.grid import missed_peaks
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.tree_response import Status
from torsion.rules.check import Check, Standing, verdict_of
from torsion.rules.evidence import in_rpm

if TYPE_CHECKING:
    from torsion.analyses.response.over_speed import Line, Response

OBVIOUS = 100.0  # times its limit: a larger value needs no sharper place


@dataclass(frozen=True)
class Curve:
    """A value and its limit over speed."""

    speed: FloatArray  # (speeds,) rad/s of the reference station
    value: FloatArray  # (speeds,)
    limit: FloatArray  # (speeds,) NaN where the rule has no limit
    status: IntArray  # (speeds,) kernels.tree_response.Status of the worst line

    def utilisation(self) -> FloatArray:
        """(speeds,) value / limit; infinite where the response is not ok, 0 where both are nothing."""
        with np.errstate(divide="ignore", invalid="ignore"):
            share = self.value / self.limit
        share[(self.value == 0) & (self.limit == 0)] = 0.0
        return np.where((self.status != Status.OK) | ~np.isfinite(self.value), np.inf, share)

    def exceeds(self) -> BoolArray:
        """(speeds,) where the limit exists and is not kept."""
        return np.isfinite(self.limit) & (self.utilisation() > 1.0)


@dataclass(frozen=True)
class Clause:
    """What a verdict is about."""

    rule: str
    clause: str
    where: str
    what: str
    unit: str
    standing: Standing  # of its limit


def worst_status(response: "Response") -> IntArray:
    """(speeds,) the worst status of any line at each speed."""
    return np.asarray(np.max(response.status, axis=1, initial=Status.OK), dtype=np.int64)


def judge(clause: Clause, curve: Curve, within: BoolArray) -> Check | None:
    """The check at the worst of the speeds `within`; None where there is no speed."""
    if not np.any(within):
        return None
    share = np.where(within, curve.utilisation(), -np.inf)
    at = worst_of(share, curve.value)
    unknown = status_words(curve, at)  # never a pass, whatever the limit
    value = stated(curve.value[at]) if curve.status[at] == Status.OK else math.inf
    return Check(
        clause.rule, clause.clause, clause.where, clause.what,
        value=value, limit=float(curve.limit[at]), unit=clause.unit,
        verdict="fail" if unknown else verdict_of(bool(share[at] <= 1.0), clause.standing),
        standing=clause.standing, speed=float(curve.speed[at]), note=unknown,
    )  # fmt: skip


def between(curves: Iterable[tuple[Curve, BoolArray]]) -> FloatArray:
    """(speeds,) rad/s, ascending: where a share of a limit stands higher than at the computed speeds beside it.

    curves: over the same speeds, each with the speeds at which it is judged.
    """
    shares, speed = [], np.empty(0)
    for curve, within in curves:
        share, speed = curve.utilisation(), curve.speed
        shares.append(np.where(within & (share <= OBVIOUS), share, np.nan))
    if not shares:
        return speed
    share = np.array(shares).T[:, None, :]
    return missed_peaks(speed, share, np.ones((len(speed), 1), dtype=bool))[0]


def noted(check: Check, *notes: str) -> Check:
    """The check with further notes; empty ones are left out."""
    return replace(check, note="; ".join(text for text in (check.note, *notes) if text))


def worst_of(share: FloatArray, value: FloatArray) -> int:
    """The place of the greatest share; among infinite ones that of the greatest value."""
    top = np.flatnonzero(share == np.max(share))
    return int(top[np.argmax(np.where(np.isfinite(value[top]), value[top], np.inf))])


def stated(value: float) -> float:
    """A value as printed; infinite where there is none."""
    return float(value) if np.isfinite(value) else float("inf")


def status_words(curve: Curve, at: int) -> str:
    """Why a number is not one to pass on; empty where the response is ok."""
    if curve.status[at] == Status.OK:
        return "" if np.isfinite(curve.value[at]) else f"no value at {in_rpm(curve.speed[at])}"
    word = Status(int(curve.status[at])).name.lower().replace("_", "-")
    return f"the response is {word} at {in_rpm(curve.speed[at])}, which is never a pass"


def largest_line(response: "Response", check: Check, spans: IntArray) -> str:
    """Words for the line with the greatest torque in the spans at the speed of a check."""
    if not response.lines or check.speed is None:
        return ""
    at = int(np.argmin(np.abs(response.speed - check.speed)))
    size = np.abs(response.torque[at][:, spans]).max(axis=1)
    if not np.all(np.isfinite(size)) or not np.any(size > 0):
        return ""
    line: Line = response.lines[int(np.argmax(size))]
    name = f"order {line.order}" if line.order is not None else f"{line.frequency:.5g} Hz"
    return f"mostly {name} ({', '.join(line.sources)})"
