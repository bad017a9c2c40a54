"""Permissible stress amplitudes of a shaft over its speed ratio, the ranges to be barred, and the shafts with a role.

The stress is the half range of the synthesis of all orders, nominal on the plain section. Stresses in N/mm2; the speed
ratio is the speed of a shaft / its rated speed.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.section.solved_sections import span_moduli
from torsion.assembly.system import System
from torsion.errors import Fault
from torsion.findings import Results
from torsion.model.component import STEEL, Material
from torsion.model.parts import Part, ShaftRecord
from torsion.rules.demands import BARRED_BELOW
from torsion.rules.rule_over_speed import Curve, rated_speed, spans_of, worst_of
from torsion.rules.verdict_line import BarredRange, Rule
from torsion.study import Study
from torsion.train import Train

PA = 1e-6  # N/mm2
MM = 1e3  # mm/m
Mark = Literal["rule text", "to be verified"]
Limit = Callable[[FloatArray], FloatArray]  # of speed ratios (speeds,)

NEAR_LIMIT = 0.9  # of the limit of continuous use, from which a stress is near it (ours)
ROUNDING = 1e-9  # relative: a speed ratio this near to a bound is at the bound


@dataclass(frozen=True)
class Piece:
    """A limit over a range of the speed ratio, up to its end, from where the piece before it ends."""

    clause: str
    last: float
    limit: Limit
    is_open: bool = False  # at its end the next piece holds


@dataclass(frozen=True)
class LimitCurve:
    """Stress amplitudes that are permissible in continuous use, and while a barred range is passed."""

    pieces: tuple[Piece, ...]  # ascending
    passing: Piece | None = None  # None where nothing may be barred

    @property
    def last(self) -> float:
        """Speed ratio above which there is no limit."""
        return self.pieces[-1].last

    @property
    def corners(self) -> tuple[float, ...]:
        """Speed ratios at which the limits bend, step or end, and the rated one."""
        passing = () if self.passing is None else (self.passing.last,)
        return (*passing, *(piece.last for piece in self.pieces), 1.0)

    def _holds(self, ratio: FloatArray) -> Iterator[tuple[Piece, BoolArray]]:
        """Yield every piece with (speeds,) where it holds."""
        left = np.ones(ratio.shape, dtype=bool)
        for piece in self.pieces:
            rounding = -ROUNDING if piece.is_open else ROUNDING
            holds = left & (ratio < piece.last * (1.0 + rounding))
            left = left & ~holds
            yield piece, holds

    def ranges(self, ratio: FloatArray) -> dict[str, BoolArray]:
        """Return by clause (speeds,) where it holds."""
        by_clause = dict[str, BoolArray]()
        for piece, holds in self._holds(ratio):
            by_clause[piece.clause] = holds | by_clause.get(piece.clause, False)
        return by_clause

    def continuous(self, ratio: FloatArray) -> FloatArray:
        """Return (speeds,) the limit of continuous use; NaN above the last piece."""
        limit = np.full(ratio.shape, np.nan)
        for piece, holds in self._holds(ratio):
            limit[holds] = piece.limit(ratio[holds])
        return limit

    def while_passing(self, ratio: FloatArray) -> FloatArray:
        """Return (speeds,) the limit while a barred range is passed; NaN where none may be."""
        if self.passing is None:
            return np.full(ratio.shape, np.nan)
        return np.where(
            ratio <= self.passing.last * (1 + ROUNDING), self.passing.limit(ratio), np.nan
        )


@dataclass(frozen=True)
class LimitedShaft:
    """A shaft with its limits."""

    part: int
    name: str
    curve: LimitCurve
    standing: Mark
    notes: tuple[str, ...]  # what was taken for it, in words
    keyways: tuple[str, ...] = ()  # features that do not go with a barred range
    restrictions: tuple[str, ...] = ()  # conditions of its limits that the file does not answer
    doubts: tuple[str, ...] = ()  # conditions of its limits that are known to be broken
    near_limit: tuple[str, ...] = ()  # conditions of a stress near the limit of continuous use


def barred_range(critical: float, rated: float) -> tuple[float, float]:
    """Return the least barred range (M68, KR; rule text): 16 n_c/(18 - lambda) to (18 - lambda) n_c/16."""
    width = 18.0 - critical / rated
    return 16.0 * critical / width, width * critical / 16.0


def with_role(train: Train, *roles: str) -> Iterator[tuple[int, Part, ShaftRecord]]:
    """Yield shafts with one of the roles and a known stress: round shafts, and crank spans whose journal is given."""
    meshed = {bar.part for bar in train.bars if bar.section is not None}
    for number, part in enumerate(train.parts):
        if part.shaft is not None and part.shaft.role in roles and number not in meshed:
            yield number, part, part.shaft


def no_crank(study: Study, rule: Rule[Any]) -> Iterator[Fault]:
    """Yield the fault of a train without a crankshaft whose stress is known."""
    if not any(with_role(study.train, "crank")):
        message, hint = f"{rule.name} finds no crankshaft", "role: crank, on a round shaft"
        yield Fault(rule.path(study), message, hint)


def unknown_strengths(
    study: Study, rule: Rule[Any], *roles: str, assumed: Material | None = STEEL
) -> Iterator[Fault]:
    """Yield a fault for each shaft of a role without a tensile strength; that of the `assumed` material is known."""
    for _, part, shaft in with_role(study.train, *roles):
        material = study.train.materials[shaft.material]
        if material.tensile_strength is None and material != assumed:
            message = f"`tensile_strength` of '{shaft.material}' is not given, and {rule.name} needs it for '{part.name}'"
            hint = f"materials: {{{shaft.material}: {{..., tensile_strength: 600 MPa}}}}"
            yield Fault((*part.path, "material"), message, hint)


def diameters(train: Train, part: int) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return in m (outer, bore) at the driving and the driven end of a shaft, of a crank span twice those of its journal."""
    for bar in train.bars:
        if bar.part == part:
            return (bar.outer[0], bar.bore[0]), (bar.outer[1], bar.bore[1])
    record = train.parts[part].shaft
    if record is None or record.journal is None:
        raise ValueError(f"{train.parts[part].name} has no diameter")
    return record.journal, record.journal


def stress_modulus(system: System, part: int) -> tuple[IntArray, FloatArray]:
    """Return the spans of a shaft (spans,) and the W_p of each (spans,) m3: the smaller end's of a conical piece."""
    spans = spans_of(system, part)
    return spans, span_moduli(diameters(system.train, part), len(spans))


def nominal_stress(system: System, part: int, torque: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the spans of a shaft, and (speeds,) N/mm2 the greatest torque / W_p in them; torque: (speeds, spans) N m."""
    spans, modulus = stress_modulus(system, part)
    return spans, np.asarray(np.max(torque[:, spans] / modulus * PA, axis=1))


class Limits(NamedTuple):
    """Stress amplitude of a shaft and its limits over speed."""

    speed: FloatArray  # (speeds,) rad/s of the reference station
    tau_c: FloatArray  # (speeds,) N/mm2 in continuous use, NaN where there is no limit
    tau_t: FloatArray  # (speeds,) N/mm2 while a barred range is passed, NaN where none is permitted
    tau: FloatArray  # (speeds,) N/mm2, half range of the synthesis


@dataclass(frozen=True)
class Barring:
    """What is to be barred for the stress above its limit, and where the rule permits it."""

    permitted: tuple[BarredRange, ...]  # ascending and apart
    refused: tuple[BarredRange, ...]  # those that reach 0.8 of the rated speed, ascending and apart
    passed: BoolArray  # (speeds,) inside a permitted range, and not above the limit within a refused one


def limits_of(evidence: Results, shaft: LimitedShaft) -> Limits:
    """Return stress and limits of one shaft over speed."""
    speed, torque = evidence.need(Response).speed, evidence.need(Synthesis).half_range
    _, tau = nominal_stress(evidence.system, shaft.part, torque)
    ratio, curve = speed / rated_speed(evidence.study), shaft.curve
    return Limits(speed, curve.continuous(ratio), curve.while_passing(ratio), tau)


def barring(curve: Curve, rated: float, shaft: str, tolerance: float = 0.0) -> Barring:
    """Return the barred ranges for stress over speed against its limit; rated in rad/s.

    A run of speeds above it has its critical speed at its worst, wherever that lies; the range about it is refused
    where its upper end reaches 0.8 of the rated speed (M68, KR; rule text). Both ends move apart by the `tolerance` of
    the tachometer.
    """
    share, permitted, refused = curve.utilisation(), list[BarredRange](), list[BarredRange]()
    passed, above = np.zeros((2, len(curve.speed)), dtype=bool)
    exceeds = np.isfinite(curve.limit) & (share > 1.0)
    edges = np.flatnonzero(np.diff(exceeds, prepend=False, append=False))
    for first, end in edges.reshape(-1, 2).tolist():
        critical = float(curve.speed[first + worst_of(share[first:end], curve.value[first:end])])
        formula = barred_range(critical, rated)
        lower = min(formula[0], _crossing(curve, first, first - 1)) * (1.0 - tolerance)
        upper = max(formula[1], _crossing(curve, end - 1, end)) * (1.0 + tolerance)
        is_permitted = upper / rated < BARRED_BELOW * (1 - ROUNDING)
        ranges = permitted if is_permitted else refused
        ranges.append(BarredRange(lower, upper, critical, shaft, *formula))
        above[first:end] |= not is_permitted
    merged = _merged(curve, permitted)
    for barred in merged:
        passed |= (curve.speed > barred.lower) & (curve.speed < barred.upper)
    return Barring(merged, _merged(curve, refused), passed & ~above)


def _merged(curve: Curve, ranges: list[BarredRange]) -> tuple[BarredRange, ...]:
    """Return ascending ranges, those that overlap as one about the worst of their critical speeds."""
    merged: list[BarredRange] = []
    for barred in ranges:
        if not merged or barred.lower > merged[-1].upper:
            merged.append(barred)
            continue
        pair = merged.pop(), barred
        rows = [int(np.flatnonzero(curve.speed == band.critical)[0]) for band in pair]
        worse = pair[worst_of(curve.utilisation()[rows], curve.value[rows])]
        lower, upper = min(band.lower for band in pair), max(band.upper for band in pair)
        merged.append(replace(worse, lower=lower, upper=upper))
    return tuple(merged)


def _crossing(curve: Curve, above: int, beyond: int) -> float:
    """Return the speed between two neighbours at which the stress meets its limit, by a straight line.

    The flank of a resonance is hollow, so the line errs toward the wider range. The far neighbour where a value is not
    finite.
    """
    if not 0 <= beyond < len(curve.speed):
        return float(curve.speed[above])
    share = curve.utilisation()[[above, beyond]]
    if not np.all(np.isfinite(share)):
        return float(curve.speed[beyond])
    step = (share[0] - 1.0) / (share[0] - share[1])
    return float(curve.speed[above] + step * (curve.speed[beyond] - curve.speed[above]))
