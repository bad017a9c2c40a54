"""Primitives to a system: stations and spans in the lumped model, and each other model of the shafts from its file."""

import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pkgutil import resolve_name
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import FloatArray
from torsion.assembly.segments import bar_segments, is_uniform, phase
from torsion.assembly.system import Discretisation, Row, Span, System
from torsion.errors import Fault, InputError, SolveError
from torsion.primitives import Bar, Station
from torsion.train import Train

if TYPE_CHECKING:
    from torsion.assembly.distributed_spans import BarSpans

MODELS = {
    "lumped": "torsion.assembly:assemble_lumped",
    "fem": "torsion.assembly.fem:assemble_fem",
    "exact": "torsion.assembly.distributed_shafts:assemble_exact",
}
ROUNDING = 1e-9  # relative, of a frequency that was itself computed


def assemble(
    train: Train,
    model: str = "lumped",
    *,
    frequency: float = 0.0,
    degree: int | None = None,
    elements: int | None = None,
    excited: float = 0.0,
) -> System:
    """The system of a train; shafts are discretised finely enough for a highest frequency (Hz).

    excited: highest frequency (Hz) of a response; 0 where none is computed. degree, elements: of every shaft, of the
    model `fem` alone; None: what the frequency needs. The system's
    `resolved_to` is the frequency up to which it keeps the error of its model (lumped 1e-3, fem 1e-6); infinite in the
    exact model, and where nothing is left to choose: no shaft has inertia, or its segments or elements are stated.
    Raises InputError for an unknown model, SolveError where a model cannot take the train.
    """
    if model not in MODELS:
        raise InputError(
            [Fault(("model",), f"no model is called '{model}'", f"give {', '.join(MODELS)}")]
        )
    if train.has_steps:
        from torsion.assembly.junction.stepped_shafts import with_steps

        train = with_steps(train)
    if train.has_meshed_sections:
        from torsion.assembly.section.solved_sections import resolved

        train = resolved(train)
    system: System = resolve_name(MODELS[model])(
        train, Discretisation(frequency, degree, elements, excited)
    )
    return system


def rediscretised(system: System, frequency: float, excited: float = 0.0) -> System:
    """The same train in the same model, its shafts discretised for another highest frequency (Hz).

    excited: as of `assemble`, where it is higher than that of the system.
    """
    requested = system.requested
    changed = replace(requested, frequency=frequency, excited=max(requested.excited, excited))
    return assemble(system.train, system.model, **vars(changed))


def of_train(system: System, train: Train) -> System:
    """Another train in the same model, its shafts discretised for the same highest frequency."""
    return rediscretised(replace(system, train=train), system.requested.frequency)


def as_divided(system: System, train: Train) -> System:
    """The same, its lumped shafts in as many segments as those of the system with these names."""
    bars = tuple(
        replace(bar, segments=system.segments.get(bar.name, bar.segments)) for bar in train.bars
    )
    return of_train(system, replace(train, bars=bars))


def is_as_fine(system: System, reference: System) -> bool:
    """No shaft of the `other` system has more pieces, nor elements of a higher degree."""
    degree, least_degree = (
        0 if assembled.bars is None else assembled.bars.degree for assembled in (system, reference)
    )
    return degree >= least_degree and all(
        system.segments[name] >= number for name, number in reference.segments.items()
    )


def resolving(
    system: System, frequency: float, *, excited: float = 0.0, refine: bool = True
) -> System:
    """The system itself, or the same train discretised finely enough for a highest frequency (Hz).

    excited: as of `assemble`. Raises SolveError where it does not resolve that frequency and must not be refined.
    """
    if not refine:
        demand_resolution(system, frequency)
        return system
    requested, more = system.requested, 1.0 + ROUNDING
    if frequency <= requested.frequency * more and excited <= requested.excited * more:
        return system
    finer = rediscretised(system, max(frequency, requested.frequency), excited)
    if is_as_fine(system, finer):
        return system
    demand_resolution(finer, frequency)
    return finer


def demand_resolution(system: System, frequency: float) -> None:
    """Raise SolveError where the shafts of a system do not resolve a frequency (Hz)."""
    if frequency > system.resolved_to * (1.0 + ROUNDING):
        needed = f"up to {frequency:.6g} Hz" if math.isfinite(frequency) else "for so many modes"
        raise SolveError(
            f"the shafts of this {system.model} system are resolved up to {system.resolved_to:.6g} Hz, not {needed}; "
            "assemble with a higher `frequency`, let it refine, or use the exact model"
        )


MOST_STATIONS = 20_000


@dataclass
class Collected:
    """The stations of a train, its springs and its constraints; then its shafts, one after another."""

    train: Train
    stations: list[Station]
    inertia: list[float]  # kg m2 at own speed
    spans: list[Span] = field(default_factory=list)
    elastic: list[tuple[float, float, float]] = field(
        default_factory=list
    )  # rad/(N m), N m s/rad, loss factor
    rows: list[Row] = field(
        default_factory=list
    )  # shafts in segments, behind all stations and spans

    @classmethod
    def of(cls, train: Train) -> "Collected":
        """Everything of a train but its shafts."""
        collected = cls(train, list(train.stations), [0.0] * len(train.stations))
        for lump in train.inertias:
            collected.inertia[lump.station] += lump.inertia
        for spring in train.springs:
            span = Span(spring.name, spring.part, spring.driving, spring.driven)
            collected.add(span, spring.flexibility, spring.viscous, spring.loss_factor)
        for mesh in train.constraints:
            collected.add(
                Span(mesh.name, mesh.part, mesh.driving, mesh.driven, mesh.ratio, mesh.error),
                mesh.flexibility,
            )
        return collected

    def add(
        self, span: Span, flexibility: float, viscous: float = 0.0, loss_factor: float = 0.0
    ) -> None:
        self.spans.append(span)
        self.elastic.append((flexibility, viscous, loss_factor))

    def add_shaft(self, row: Row, flexibility: FloatArray, lumps: FloatArray) -> None:
        """Add the stations between the pieces of a shaft, its inertia lumped at their ends, and its spans."""
        part, begin, number = row.bar.part, row.begin, row.number
        stations = row.stations.tolist()
        self.stations += [
            Station(f"{row.bar.name} {k}/{number}", part, begin.ratio, begin.sense)
            for k in range(1, number)
        ]
        self.inertia += [0.0] * (number - 1)
        for end, lump in zip(stations, lumps.tolist(), strict=True):
            self.inertia[end] += lump
        names = [f"{row.bar.name} [{k}]" for k in range(1, number + 1)]
        spans = zip(
            [row.bar.name] if number == 1 else names,
            pairwise(stations),
            flexibility.tolist(),
            strict=True,
        )
        for name, ends, segment_flexibility in spans:
            self.add(Span(name, part, *ends), segment_flexibility, 0.0, row.bar.loss_factor)

    def refuse_more(self, number: int, segments: dict[str, int]) -> None:
        """Refuse more than MOST_STATIONS: InputError where the file states them, SolveError where the program does."""
        if number <= MOST_STATIONS:
            return
        message = f"the train has {number} stations; at most {MOST_STATIONS} are computed"
        finest = max(self.train.bars, key=lambda bar: segments[bar.name], default=None)
        if finest is None or finest.segments is not None:
            path = () if finest is None else (*self.train.parts[finest.part].path, "segments")
            raise InputError([Fault(path, message, "give fewer segments, or `model: exact`")])
        raise SolveError(f"{message}; request fewer modes, a lower frequency, or another `model`")

    def system(
        self,
        model: str,
        segments: dict[str, int],
        requested: Discretisation,
        resolved_to: float,
        bars: "BarSpans | None" = None,
    ) -> System:
        """Return the system of all that was collected; resolved_to: Hz.

        Raises SolveError for distributed shafts in a train with closed loops, and for more than MOST_STATIONS stations
        of shafts that the program divides; InputError for as many that the file states.
        """
        self.refuse_more(len(self.stations), segments)
        elastic = np.array(self.elastic, dtype=float).reshape(-1, 3)
        flexibility, viscous, loss_factor = elastic.T.copy()
        system = System(
            self.train,
            model,
            tuple(self.stations),
            tuple(self.spans),
            np.array(self.inertia, dtype=float),
            flexibility,
            viscous,
            loss_factor,
            self.train.dampers,
            segments,
            bars,
            tuple(self.rows),
            requested,
            resolved_to,
            tables={
                span: spring.table
                for span, spring in enumerate(self.train.springs)
                if spring.table is not None
            },
        )
        if bars is not None and system.condensed.extra.size:
            why = "no closed loops, and no train that rigid spans hold at several points"
            raise SolveError(f"the model {model} takes {why}; use the lumped model")
        return system


SHARE_OF_ERROR = 1e-3  # a frequency of a lumped shaft is right to this share
LARGEST_PHASE = math.sqrt(24.0 * SHARE_OF_ERROR)  # rad along a segment of a uniform shaft
FEWEST, MOST = 1, 19_999  # with both ends the stations that a train may have


def segments_along(phase: ArrayLike, excess: ArrayLike) -> FloatArray:
    """Segments of shafts with a phase (rad) along each, and as many times more as a uniform one.

    They keep the error of a frequency below SHARE_OF_ERROR: n lumped segments lower it by (mu/n)^2/24, with mu the
    phase along the shaft (from 2n/mu sin(mu/2n), the closed form of a uniform chain). A cone is given twice as many.
    """
    return np.clip(np.ceil(np.asarray(phase) / LARGEST_PHASE) * excess, FEWEST, MOST)


def is_refined(bar: Bar) -> bool:
    """The number of its segments depends on the highest frequency."""
    return bar.density > 0 and bar.segments is None


def excess(bar: Bar) -> int:
    """How many times more segments a shaft is given than a uniform one."""
    return 1 if is_uniform(bar) else 2


def assemble_lumped(train: Train, requested: Discretisation) -> System:
    """The system in which every shaft has enough segments for a highest frequency (Hz)."""
    collected = Collected.of(train)
    segments = {
        bar.name: int(segments_along(phase(bar, requested.frequency), excess(bar)))
        if is_refined(bar)
        else bar.segments or 1
        for bar in train.bars
    }
    collected.refuse_more(len(train.stations) + sum(segments.values()) - len(segments), segments)
    for bar in train.bars:
        row = Row(bar, segments[bar.name], len(collected.stations), collected.stations[bar.driving])
        collected.add_shaft(row, *bar_segments(bar, row.number))
        collected.rows.append(row)
    resolved = (
        segments[bar.name] / excess(bar) * LARGEST_PHASE / phase(bar, 1.0)
        for bar in filter(is_refined, train.bars)
    )
    return collected.system("lumped", segments, requested, min(resolved, default=math.inf))
