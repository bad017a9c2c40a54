"""How many modes exact motions beside a response have, and how much work they may be.

A band holds all modes up to some multiple of what is excited and of the couplings' own frequencies, and as many more as
cost little; the others are a compliance (T114). Work is counted and not timed, so that a result is the same on
every machine.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from torsion.analyses.motion.train.built_train import Built
from torsion.analyses.response.amplitudes import Balanced, Response
from torsion.analyses.undamped_modes import modes_as_discretised
from torsion.arrays import FloatArray
from torsion.findings import Progress
from torsion.kernels.motion.march import NEWS
from torsion.study import Study

# of the highest frequency of excitation, and of the modes of which the couplings have most
MULTIPLE = 8.0
CHEAP = 2e5  # rad of the fastest mode in the first windows, up to which modes are kept anyway
MOST_WORK = 2.5e5  # blocks of a small train in all comparisons: about 25 s
ALONE = 3.0  # one motion has this share of what is left: 1/ALONE
LARGE = 60.0  # states of a train, whose blocks are twice the work


class WorkEnds(Exception):
    """The work that a comparison may be is done."""


@dataclass
class Band:
    """A response that is compared, the modes that exact motions keep, and the work that is left for them."""

    study: Study
    response: Response
    balanced: Balanced
    progress: Progress
    modes: int = 0  # 0: not known yet
    # largest of an amplitude or a peak on doubling the band; None: not known yet
    change: float | None = None
    is_complete: bool = False
    left: float = field(default_factory=lambda: MOST_WORK)
    left_of_motion: float = math.inf
    cost: float = 1.0  # of a block
    done: float = 0.0  # share of the comparisons
    number: int = 1  # of comparisons

    def limit(self, duration: float) -> int:
        """Number of modes, of motions whose first windows last so long (s)."""
        if not self.modes:
            modes = modes_as_discretised(self.response.system, None)
            w = 2.0 * math.pi * np.sort(modes.frequency)
            mainly = modes.frequency[modes.elastic[list(self.balanced.spans)].argmax(axis=1)]
            highest = max(float(mainly.max()), float(self.response.frequency.max()))
            kept = max(MULTIPLE * 2.0 * math.pi * highest, CHEAP / duration)
            self.modes = max(int(np.searchsorted(w, kept)), 1)
        return self.modes

    def begin_motion(self, built: Built) -> None:
        """Allot work to the motion of a train."""
        self.is_complete = not built.is_band
        if self.is_complete:
            self.change = 0.0
        self.cost = 1.0 + ((2 * built.train.motions + built.train.inputs) / LARGE) ** 2
        self.left_of_motion = self.left / ALONE

    def spend(self, what: str, share: float) -> None:
        """The work of some blocks; raises WorkEnds."""
        self.left -= NEWS * self.cost
        self.left_of_motion -= NEWS * self.cost
        self.progress(f"exact motion at peaks, {what}", self.done + share / self.number)
        if self.left_of_motion < 0.0:
            raise WorkEnds

    def raised(self, torque: FloatArray) -> FloatArray:
        """By what a wider band may add, for verdicts."""
        return np.asarray(torque * (1.0 + 2.0 * (self.change or 0.0)))

    @property
    def words(self) -> str:
        """What the plan says of the band; empty if all modes are kept."""
        if not self.change:
            return ""
        return f"; {self.modes} modes of the parts, half as many change torques by {100.0 * self.change:.2g} %"
