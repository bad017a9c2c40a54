"""The train of a study of run times: its shafts divided in any number of pieces, and the reference."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

from torsion.analyses.division import assembled
from torsion.analyses.modes import Modes, modes, modes_as_discretised, undamped_tree
from torsion.analyses.study.timing import Effort
from torsion.assembly import assemble
from torsion.assembly.section.resolved import resolved
from torsion.assembly.system import System
from torsion.study import FiniteElements, Study
from torsion.train import Train

Division = tuple[str, str, int, "partial[System]"]  # method, division in words, size, what assembles it
DEFAULT_COUNT = 6  # modes, where neither the file nor an excitation says how many


def has_shafts(train: Train) -> bool:
    """Some shaft has inertia, and so can be divided."""
    return any(bar.density > 0 for bar in train.bars)


def plain(study: Study) -> Study:
    """The study in the exact model, its shafts without a number of segments of their own, sections already solved."""
    train = divided(resolved(study.train), None)
    return replace(study, train=train, model="exact" if has_shafts(train) else "lumped", fem=FiniteElements())


def divided(train: Train, number: int | Mapping[str, int] | None) -> Train:
    """The train with so many segments a shaft (or by its name); a massless shaft is a spring and stays as it is."""

    def of(name: str) -> int | None:
        return number[name] if isinstance(number, Mapping) else number

    bars = (replace(bar, segments=of(bar.name)) if bar.density > 0 else bar for bar in train.bars)
    return replace(train, bars=tuple(bars))


def ready(
    train: Train, model: str, *, frequency: float = 0.0, degree: int | None = None, elements: int | None = None
) -> System:
    """A system with its tree and the laws of its shafts, which are made when first used."""
    system = assemble(train, model, frequency=frequency, degree=degree, elements=elements)
    _ = system.folded, system.folded_bars
    return system


def divisions(train: Train, frequency: float, effort: Effort, degrees: tuple[int, ...]) -> list[list[Division]]:
    """Every division of the shafts, a list a curve; frequency (Hz): what the exact model is divided for."""
    lumped = [
        ("lumped", _words(number, "segment"), number, partial(ready, divided(train, number), "lumped"))
        for number in _doubled(effort.segments)
    ]
    curves = [lumped]
    for degree in degrees:
        curves.append([
            (f"fem, degree {degree}", _words(number, "element"), number,
             partial(ready, train, "fem", frequency=frequency, degree=degree, elements=number))
            for number in _doubled(max(1, effort.unknowns // degree))
        ])  # fmt: skip
    exact = partial(ready, train, "exact", frequency=frequency)
    pieces = max(exact().segments.values())
    return [*curves, [("exact", _words(pieces, "piece"), pieces, exact)]]


def _words(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _doubled(most: int) -> list[int]:
    """1, 2, 4 .. up to a largest."""
    return [2**k for k in range(most.bit_length())]


@dataclass(frozen=True)
class Reference:
    """The exact model of a train, divided as it is by itself, and twice as finely."""

    system: System
    finer: System
    found: Modes
    finer_found: Modes


def reference(study: Study, highest: float, count: int | None) -> Reference:
    """The lowest `count` modes (None: those up to `highest`, Hz) of the exact model, both divisions of it."""
    system = assembled(study, highest)
    if count is None:
        count = _count_up_to(system, highest)
    found = modes(system, count)
    finer = ready(divided(study.train, {name: 2 * n for name, n in found.system.segments.items()}), "exact")
    return Reference(found.system, finer, found, modes_as_discretised(finer, count))


def _count_up_to(system: System, highest: float) -> int:
    if highest <= 0.0 or system.folded_bars is None:
        return DEFAULT_COUNT
    from torsion.analyses.bars import reach

    return max(1, reach(undamped_tree(system.folded), system.folded_bars, 2.0 * math.pi * highest).count)
