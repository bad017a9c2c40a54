"""Faults of electrical machines whose sense or time of reclosing the file leaves open: all are computed."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

from torsion.analyses.motion.short_circuit import FINER, ShortCircuit
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError, Path

MOST_FAULTS = 500  # motions of one file's motion
WORST_TIMES = 3  # faults beside whose times of reclosing the scan is finer


@dataclass(frozen=True)
class FaultScan:
    """The faults of a motion; frequency: (modes,) Hz, the natural ones of the train."""

    settings: TransientSettings
    frequency: FloatArray
    place: Path  # of the settings in the file

    @property
    def faults(self) -> dict[int, ShortCircuit]:
        """By the number of their event."""
        bodies = ((number, event.body) for number, event in enumerate(self.settings.events))
        return {number: body for number, body in bodies if isinstance(body, ShortCircuit)}

    @property
    def scanned(self) -> dict[int, ShortCircuit]:
        """Those that close again at a time between two."""
        return {
            number: one
            for number, one in self.faults.items()
            if one.reclose and one.reclose[0] < one.reclose[1]
        }

    def variants(self) -> list[TransientSettings]:
        """Every combination of the senses and times of reclosing of all faults.

        Raises InputError where these and the finer ones may be more than MOST_FAULTS.
        """
        variants = {number: fault.variants(self.frequency) for number, fault in self.faults.items()}
        count = math.prod(map(len, variants.values())) + WORST_TIMES * 2 * (FINER - 1) * len(
            self.scanned
        )
        if count > MOST_FAULTS:
            message = (
                f"{count} short circuits would be computed, for all senses and times of reclosing: more than "
                f"{MOST_FAULTS}"
            )
            raise InputError(
                [
                    Fault(
                        (*self.place, "events"),
                        message,
                        "a narrower range `reclose`, or state `sense`",
                    )
                ]
            )
        combinations = product(*variants.values())
        return [
            _with_faults(self.settings, dict(zip(variants, each, strict=True)))
            for each in combinations
        ]

    def finer_variants(self, worst: Sequence[TransientSettings]) -> Iterator[TransientSettings]:
        """Between the times of reclosing of the worst of `variants` and those before and after, each of them once."""
        seen = list[TransientSettings]()
        for settings in worst[:WORST_TIMES]:
            for number, fault in self.scanned.items():
                now = settings.events[number].body
                assert isinstance(now, ShortCircuit)
                assert now.reclose is not None
                for body in fault.variants_beside(now.reclose[0], self.frequency):
                    finer = _with_faults(
                        settings, {number: body.model_copy(update={"sense": now.sense})}
                    )
                    if finer not in seen:
                        seen.append(finer)
                        yield finer


def faults_in_words(settings: TransientSettings) -> str:
    """Their senses and times of reclosing, with their points where there are several."""
    faults = [
        (event.at, event.body) for event in settings.events if isinstance(event.body, ShortCircuit)
    ]
    return "; ".join(
        f"{body.words}{f' at {name}' if len(faults) > 1 else ''}" for name, body in faults
    )


def _with_faults(settings: TransientSettings, faults: dict[int, ShortCircuit]) -> TransientSettings:
    events = list(settings.events)
    for number, fault in faults.items():
        events[number] = events[number].model_copy(update={"short_circuit": fault})
    return settings.model_copy(update={"events": tuple(events)})
