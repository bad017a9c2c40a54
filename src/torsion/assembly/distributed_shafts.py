"""Shafts as spans with distributed inertia, for the models `fem` and `exact`; exact: continua that add no error."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from torsion.assembly.distributed_spans import BarSpans
from torsion.assembly.lumped import MOST
from torsion.assembly.shafts import Piece, bar_segments, is_uniform, phase
from torsion.assembly.spans import Span
from torsion.assembly.system import Discretisation, System
from torsion.assembly.system_builder import Collected
from torsion.primitives import Bar
from torsion.train import Train

LARGEST_PHASE = 1.0  # rad along a piece at the highest frequency requested; far below pi, from where counts need more
FEWEST = 4  # pieces of a shaft, for the picture of its shape
STEEPEST = 3.0  # a diameter or wall changes by at most this factor over a piece, so that its integrals converge fast


def collect(train: Train, number_of: Callable[[Bar], int]) -> tuple[Collected, BarSpans | None, dict[str, int]]:
    """Everything of a train with every shaft in `number_of` pieces, and these pieces; a massless shaft is a spring.

    Between the last piece and the driven station there is a rigid span with the torque there, but not where that
    station is one of several fixed ones. Where no shaft has inertia there are no pieces: None.
    """
    found = Collected.of(train)
    held = {lump.station for lump in train.inertias if math.isinf(lump.inertia)}
    lumped = list(found.inertia)
    spans, pieces, numbers = list[int](), list[Piece](), dict[str, int]()
    stated_at = list[tuple[int, int]]()
    for bar in train.bars:
        massless = bar.density == 0
        tells_end = not massless and not (bar.driven in held and len(held) > 1)
        numbers[bar.name] = number = (bar.segments or 1) if massless else number_of(bar)
        ends = found.inside(bar, number)
        last = bar.driven if not tells_end else found.station(bar, f"{bar.name} end")
        between = found.pieces(bar, [*ends, last], *bar_segments(bar, number))
        if tells_end:
            found.inertia[bar.driven] += found.inertia[last]
            found.inertia[last] = 0.0
            found.add(Span(f"{bar.name}, driven end", bar.part, last, bar.driven), 0.0)
        if not massless:
            spans.extend(between)
            stated_at.extend(pairwise([*ends, bar.driven]))
            pieces.extend(Piece(bar, position, number) for position in range(number))
    lumped += [0.0] * (len(found.stations) - len(lumped))
    if not pieces:
        return found, None, numbers
    order = sorted(range(len(pieces)), key=lambda k: not is_uniform(pieces[k].bar))
    halves = np.array([stated_at[k] for k in order], dtype=np.int64).reshape(-1, 2)
    where = np.array([spans[k] for k in order], dtype=np.int64)
    return found, BarSpans(where, np.array(lumped), halves, tuple(pieces[k] for k in order)), numbers


def steepness(bar: Bar) -> float:
    """The largest ratio of both ends of a shaft in diameter, wall or mean diameter."""
    outer, bore = np.array(bar.outer), np.array(bar.bore)
    sizes = np.array([outer, outer - bore, outer + bore])
    return float((sizes.max(axis=1) / sizes.min(axis=1)).max())


def pieces_for_steepness(bar: Bar) -> int:
    """Pieces of equal length, none of which is steeper than STEEPEST."""
    return max(1, int(np.ceil((steepness(bar) - 1.0) / (STEEPEST - 1.0))))


def pieces_for(bar: Bar, frequency: float) -> int:
    """Pieces of a shaft for a highest frequency (Hz); its `segments` are the least number."""
    needed = math.ceil(phase(bar, frequency) / LARGEST_PHASE)
    return max(min(max(needed, FEWEST, pieces_for_steepness(bar)), MOST), bar.segments or 1)


def assemble_exact(train: Train, *, frequency: float = 0.0) -> System:
    """The system in which every shaft is a continuum, in pieces short enough for a highest frequency (Hz).

    Raises SolveError for a train with closed loops.
    """
    found, bars, pieces = collect(train, lambda bar: pieces_for(bar, frequency))
    return found.system("exact", pieces, Discretisation(frequency), math.inf, bars)
