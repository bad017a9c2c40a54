"""Exact assembly: every shaft as a continuum, whose pieces add no error."""

import math

from torsion.assembly.divided import collect, made, pieces_for_steepness
from torsion.assembly.lumped import MOST
from torsion.assembly.shafts import phase
from torsion.assembly.system import Discretisation, System
from torsion.primitives import Bar
from torsion.train import Train

LARGEST_PHASE = 1.0  # rad along a piece at the highest frequency asked for; far below pi, from where counts need more
FEWEST = 4  # pieces of a shaft, for the picture of its shape


def pieces_for(bar: Bar, frequency: float) -> int:
    """Pieces of a shaft for a highest frequency (Hz); its `segments` are the least number."""
    needed = math.ceil(phase(bar, frequency) / LARGEST_PHASE)
    return max(min(max(needed, FEWEST, pieces_for_steepness(bar)), MOST), bar.segments or 1)


def assemble_exact(train: Train, *, frequency: float = 0.0) -> System:
    """The system in which every shaft is a continuum, in pieces short enough for a highest frequency (Hz).

    Raises SolveError for a train with closed loops.
    """
    found, bars, pieces = collect(train, lambda bar: pieces_for(bar, frequency))
    return made(found, "exact", pieces, Discretisation(frequency), math.inf, bars)
