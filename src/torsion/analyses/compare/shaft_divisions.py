"""The shafts of a train in any number of pieces, in every model, and the exact model as the reference of them all."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

from torsion.analyses.compare.timing import Candidate, Effort
from torsion.analyses.discretisation import assembled
from torsion.analyses.undamped_modes import Modes, modes, modes_as_discretised, undamped_tree
from torsion.assembly import assemble
from torsion.assembly.section.solved_sections import resolved
from torsion.assembly.system import System
from torsion.errors import Fault, Path
from torsion.study import FiniteElements, Study
from torsion.train import Train

Named = Callable[
    [str, str, int, Callable[[], System]], Candidate
]  # of method, words, size and what assembles it
COUNT = 6  # elastic modes, where neither the file nor an excitation says how many


def loop_faults(study: Study, path: Path) -> list[Fault]:
    """Return the fault of closed loops in a train whose shafts have inertia: there is no exact model of it."""
    if not (study.train.has_shafts and study.train.has_loops):
        return []
    message = "errors are against the exact model, which does not support closed loops, and `links` closes one"
    return [Fault(path, message, "leave `links` or the check out")]


def plain(study: Study) -> Study:
    """Return the study in the exact model, its shafts without a number of segments of their own, sections already solved."""
    train = divided(resolved(study.train), None)
    return replace(
        study, train=train, model="exact" if train.has_shafts else "lumped", fem=FiniteElements()
    )


def divided(train: Train, number: int | Mapping[str, int] | None) -> Train:
    """Return the train with so many segments a shaft (or by its name); a massless shaft is a spring and stays as it is."""

    def of(name: str) -> int | None:
        return number[name] if isinstance(number, Mapping) else number

    bars = (replace(bar, segments=of(bar.name)) if bar.density > 0 else bar for bar in train.bars)
    return replace(train, bars=tuple(bars))


def ready(
    train: Train,
    model: str,
    *,
    frequency: float = 0.0,
    degree: int | None = None,
    elements: int | None = None,
) -> System:
    """Return a system with its tree and the laws of its shafts, which are made when first used."""
    system = assemble(train, model, frequency=frequency, degree=degree, elements=elements)
    _ = system.condensed, system.condensed_shafts
    return system


def candidates(
    train: Train, frequency: float, effort: Effort, named: Named
) -> list[list[Candidate]]:
    """Return every discretisation of the shafts, a list a curve; frequency (Hz): what the exact model is divided for."""

    def curve(method: str, what: str, most: int, made: Callable[[int], System]) -> list[Candidate]:
        numbers = (2**k for k in range(most.bit_length()))
        return [named(method, counted(n, what), n, partial(made, n)) for n in numbers]

    def finite(degree: int, elements: int) -> System:
        return ready(train, "fem", frequency=frequency, degree=degree, elements=elements)

    curves = [
        curve("lumped", "segment", effort.segments, lambda n: ready(divided(train, n), "lumped"))
    ]
    for degree in effort.degrees:
        most = max(1, effort.unknowns // degree)
        curves.append(curve(f"fem, degree {degree}", "element", most, partial(finite, degree)))
    exact = partial(ready, train, "exact", frequency=frequency)
    pieces = max(exact().segments.values())
    return [*curves, [named("exact", counted(pieces, "piece"), pieces, exact)]]


def counted(number: int, what: str) -> str:
    """Return a number with its noun in the right form."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def reference(study: Study, highest: float, count: int | None) -> tuple[Modes, Modes]:
    """Return the lowest `count` modes (None: those up to `highest`, Hz) of the exact model, and of twice as many pieces."""
    system = assembled(study, highest)
    if count is None:
        count = COUNT
        if highest > 0.0 and system.condensed_shafts is not None:
            from torsion.analyses.modes.bars import reach

            count = max(1, reach(undamped_tree(system), 2.0 * math.pi * highest).count)
    solved_modes = modes(system, count)
    finer = ready(
        divided(study.train, {name: 2 * n for name, n in solved_modes.system.segments.items()}),
        "exact",
    )
    return solved_modes, modes_as_discretised(finer, count)
