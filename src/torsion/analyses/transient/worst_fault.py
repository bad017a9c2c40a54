"""Faults of electrical machines whose sense or time of reclosing the file leaves open: all are computed."""

import math
from collections.abc import Iterator
from itertools import product

from torsion.analyses.transient.short_circuit import ShortCircuit
from torsion.analyses.transient.transient_settings import TransientSettings
from torsion.errors import Fault, InputError, Path

MOST_FAULTS = 500  # motions of one file's motion


def scans_reclosing(settings: TransientSettings) -> bool:
    """A fault is scanned over the time at which it closes again."""
    faults = (event.body for event in settings.events if isinstance(event.body, ShortCircuit))
    return any(fault.reclose is not None and fault.reclose[0] < fault.reclose[1] for fault in faults)


def fault_variants(settings: TransientSettings, period: float, place: Path) -> Iterator[tuple[str, TransientSettings]]:
    """Every combination of the senses and times of reclosing of all faults, in words and as settings.

    period: s, the longest natural period. Raises InputError where there are more than MOST_FAULTS.
    """
    numbers = [number for number, event in enumerate(settings.events) if isinstance(event.body, ShortCircuit)]
    bodies = [settings.events[number].body for number in numbers]
    variants = [body.variants(period) for body in bodies if isinstance(body, ShortCircuit)]
    count = math.prod(map(len, variants))
    if count > MOST_FAULTS:
        message = f"{count} faults would be computed, of all senses and times of reclosing: more than {MOST_FAULTS}"
        raise InputError([Fault((*place, "events"), message, "narrow `reclose`, or state `sense`")])
    for combination in product(*variants):
        events = list(settings.events)
        for number, fault in zip(numbers, combination, strict=True):
            events[number] = events[number].model_copy(update={"short_circuit": fault})
        words = (
            f"{fault.words}{f' at {events[number].at}' if len(numbers) > 1 else ''}"
            for number, fault in zip(numbers, combination, strict=True)
        )
        yield "; ".join(words), settings.model_copy(update={"events": tuple(events)})
