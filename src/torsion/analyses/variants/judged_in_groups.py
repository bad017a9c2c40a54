"""Verdicts of variants of any figures: of groups that differ in numbers alone side by side, of the others one by one.

What a group's figures do to the train is found once, and holds for all later variants of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from torsion.analyses.variants.judged_together import judged_of
from torsion.analyses.variants.one_by_one import Answers, read, solved
from torsion.analyses.variants.variant_shares import Swept, swept, unfit
from torsion.arrays import BoolArray, FloatArray
from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.study import Group, Variation

WORTH = 24  # variants of a group from which it pays to find what its figures do
MOSTLY = 0.9  # of variants
TRIED = 32  # variants of a group that are tried side by side first
COMPARED = 4  # of these, that are solved by themselves as well


@dataclass
class JudgedInGroups:
    """The variants of a file, or of one of its cases."""

    work: Work
    variation: Variation
    modes: int
    trains: dict[tuple[float, ...], Swept | None] = field(
        default_factory=dict
    )  # by group; None: one by one
    apart: tuple[int, ...] | None = (
        None  # figures that do otherwise than by powers, and make a group by each value
    )
    why: str = ""  # not side by side
    alone: int = 0  # variants solved by themselves

    def answers(self, values: FloatArray) -> Answers:
        """What the variants (variants, figures) answer."""
        found, alone = (
            Answers.unknown(self.modes, len(values)),
            np.ones(len(values), dtype=np.bool_),
        )
        for group in self._groups(values):
            train = self._train(group)
            if train is None:
                continue
            fit = np.flatnonzero(_enter(train, group.values))
            if not fit.size:
                continue
            order = fit[np.lexsort(group.values[fit].T)]  # a chunk has trains that are alike
            own = judged_of(train, group.values[order], self.modes, self.work.progress)
            at = np.flatnonzero(~own.left)
            found.take(group.places[order[at]], own.answers, at)
            alone[group.places[order[at]]] = False
        places = np.flatnonzero(alone).tolist()
        self.alone += len(places)
        return solved(
            self.work, self.variation, values, self.modes, judged=True, known=found, places=places
        )

    def is_fast(self, values: FloatArray) -> bool:
        """Most of variants like these (variants, figures) are judged side by side, as far as their figures say."""
        together = sum(
            len(group.places) for group in self._groups(values) if self._train(group) is not None
        )
        return not self.apart and together > MOSTLY * len(values)

    def _groups(self, values: FloatArray) -> Iterator[Group]:
        if self.why or (len(values) < WORTH and not self.trains):
            return
        if self.apart is None:
            self.apart = tuple(self._odd(values))
        if not self.why:
            yield from self.variation.groups(values, self.apart)

    def _odd(self, values: FloatArray) -> Iterator[int]:
        """The figures that neither enter as powers nor as a share, each tried by itself."""
        variation = self.variation.ahead
        values = values[:, : len(variation.figures)]
        for place in range(values.shape[1]):
            one, others = np.repeat(values[:1], len(values), axis=0), [*range(values.shape[1])]
            one[:, place] = values[:, place]
            others.remove(place)
            try:
                group = max(
                    variation.groups(one, others), key=lambda group: len(group.places), default=None
                )
                train = None if group is None else self._tried(group)
            except (InputError, SolveError):
                train = None
            if train is None and self.why:
                return
            if train is None:
                yield place

    def _train(self, group: Group) -> Swept | None:
        """What the figures of a group do; None where that is not known, or not worth finding out."""
        if group.key in self.trains or len(group.places) < WORTH:
            return self.trains.get(group.key)
        try:
            train = self._tried(group)
            if train is not None and not self._agrees(train, group):
                train = None
        except (InputError, SolveError):
            train = None
        self.trains[group.key] = train
        return train

    def _tried(self, group: Group) -> Swept | None:
        """The train of the group's own file, solved as the work's is."""
        if self.work.solve is None or not len(group.variation.figures):
            return None
        study = group.variation.study([one.nominal for one in group.variation.figures])
        found = self.work.solve(study, only=(*read(self.work, judged=True), "response"))
        work = replace(self.work, study=study, results=dict(found.results))
        if why := unfit(work) or "; ".join(one.why for one in found.plan.unanswered):
            self.why = why
            return None
        values = np.vstack([group.ends, group.values])
        least = np.where(values != 0.0, np.abs(values), np.inf).min(axis=0)
        return swept(work, group.variation, np.where(values != 0.0, values, least))

    def _agrees(self, train: Swept, group: Group) -> bool:
        """A few of the group say the same by themselves."""
        fit = group.values[_enter(train, group.values)]
        if not len(fit):
            return False
        some = fit[:: -(-len(fit) // TRIED)]
        tried = judged_of(train, some, self.modes)
        places = tried.some(COMPARED)
        alone = solved(self.work, group.variation, some[places], self.modes, judged=True)
        return bool(places) and tried.agrees(alone, places)


def _enter(train: Swept, values: FloatArray) -> BoolArray:
    """(variants,) those without a figure that is 0, but for what turns phasors alone."""
    return np.asarray(((values != 0.0) | train.enters.turn.any(axis=0)).all(axis=1))
