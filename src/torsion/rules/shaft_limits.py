"""Permissible stress amplitudes of a shaft over its speed ratio, and the shafts with a role whose stress is known.

Stresses in N/mm2; the speed ratio is the speed of a shaft / its rated speed.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.section.solved_sections import span_moduli
from torsion.assembly.system import System
from torsion.errors import Fault
from torsion.model.component import STEEL, Material
from torsion.model.parts import Part, ShaftRecord
from torsion.rules.demands import BARRED_BELOW
from torsion.rules.rule_over_speed import spans_of
from torsion.rules.verdict_line import Rule
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


def may_be_barred(speed_ratio: ArrayLike) -> BoolArray:
    """Return where a barred range is accepted in normal firing: below 0.8 of the rated speed (M68, KR; rule text)."""
    return np.asarray(np.asarray(speed_ratio, dtype=float) < BARRED_BELOW * (1 - ROUNDING))


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


def no_crank(study: Study, rule: Rule[Any]) -> list[Fault]:
    """Return the fault of a train without a crankshaft whose stress is known."""
    if any(with_role(study.train, "crank")):
        return []
    hint = "role: crank, on a round shaft"
    return [Fault(rule.path(study), f"{rule.name} finds no crankshaft", hint)]


def unknown_strengths(
    study: Study, rule: Rule[Any], *roles: str, assumed: Material | None = STEEL
) -> list[Fault]:
    """Return a fault for each shaft of a role without a tensile strength; that of the `assumed` material is known."""
    faults = []
    for _, part, shaft in with_role(study.train, *roles):
        material = study.train.materials[shaft.material]
        if material.tensile_strength is None and material != assumed:
            message = f"`tensile_strength` of '{shaft.material}' is not given, and {rule.name} needs it for '{part.name}'"
            hint = f"materials: {{{shaft.material}: {{..., tensile_strength: 600 MPa}}}}"
            faults.append(Fault((*part.path, "material"), message, hint))
    return faults


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
