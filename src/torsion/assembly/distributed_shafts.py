"""Shafts as spans with distributed inertia, for the models `fem` and `exact`; exact: continua that add no error."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import count, pairwise

import numpy as np

from torsion.assembly import MOST, Collected
from torsion.assembly.distributed_spans import BarSpans
from torsion.assembly.pieces import Piece
from torsion.assembly.segments import LARGEST_PHASE_OF_TORQUES, bar_segments, is_uniform, phase
from torsion.assembly.system import Discretisation, Row, Span, System
from torsion.primitives import Bar, Station
from torsion.train import Train

LARGEST_PHASE = 1.0  # rad along a piece at the highest frequency requested; far below pi, from where counts need more
FEWEST = 4  # pieces of a shaft, for the picture of its shape
STEEPEST = 3.0  # a diameter or wall changes by at most this factor over a piece, so that its integrals converge fast


def collect(
    train: Train, number_of: Callable[[Bar], int]
) -> tuple[Collected, BarSpans | None, dict[str, int]]:
    """Everything of a train with every shaft in `number_of` pieces, and these pieces; a massless shaft is a spring.

    Between the last piece and the driven station there is a rigid span with the torque there, but not where that
    station is one of several fixed ones. Where no shaft has inertia there are no pieces: None.
    """
    collected = Collected.of(train)
    held = {lump.station for lump in train.inertias if math.isinf(lump.inertia)}
    lumped = list(collected.inertia)
    numbers, pieces = dict[str, int](), list[tuple[int, tuple[int, int], Piece]]()
    for bar in train.bars:
        massless = bar.density == 0
        tells_end = not massless and not (bar.driven in held and len(held) > 1)
        numbers[bar.name] = number = (bar.segments or 1) if massless else number_of(bar)
        row = Row(bar, number, len(collected.stations), collected.stations[bar.driving])
        if not massless:
            made = (Piece(bar, position, number) for position in range(number))
            pieces += zip(
                count(len(collected.spans)), pairwise(row.stations.tolist()), made, strict=False
            )
        collected.add_shaft(row, *bar_segments(bar, number))
        if tells_end:
            collected.spans[-1] = replace(collected.spans[-1], driven=len(collected.stations))
            collected.add(
                Span(f"{bar.name}, driven end", bar.part, len(collected.stations), bar.driven), 0.0
            )
            collected.stations.append(
                Station(f"{bar.name} end", bar.part, row.begin.ratio, row.begin.sense)
            )
            collected.inertia.append(0.0)
    if not pieces:
        return collected, None, numbers
    pieces.sort(key=lambda piece: not is_uniform(piece[-1].bar))
    lumped += [0.0] * (len(collected.stations) - len(lumped))
    span, halves, made_of = zip(*pieces, strict=True)
    return collected, BarSpans(np.array(span), np.array(lumped), np.array(halves), made_of), numbers


def pieces_for(bar: Bar, requested: Discretisation) -> int:
    """Pieces of a shaft for the highest frequencies, none steeper than STEEPEST; at least its `segments`."""
    outer, bore = np.array(bar.outer), np.array(bar.bore)
    sizes = np.array([outer, outer - bore, outer + bore])
    steepness = float((sizes.max(axis=1) / sizes.min(axis=1)).max())
    needed = (
        phase(bar, requested.frequency) / LARGEST_PHASE,
        phase(bar, requested.excited) / LARGEST_PHASE_OF_TORQUES,
        FEWEST,
        (steepness - 1.0) / (STEEPEST - 1.0),
    )
    return max(min(math.ceil(max(needed)), MOST), bar.segments or 1)


def assemble_exact(train: Train, requested: Discretisation) -> System:
    """The system in which every shaft is a continuum, in pieces short enough for a highest frequency (Hz).

    Raises SolveError for a train with closed loops.
    """
    collected, bars, pieces = collect(train, lambda bar: pieces_for(bar, requested))
    return collected.system("exact", pieces, requested, math.inf, bars)
