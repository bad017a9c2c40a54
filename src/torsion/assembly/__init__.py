"""Primitives to a system: one model a file, imported when it is requested."""

import math
from dataclasses import replace
from pkgutil import resolve_name
from typing import TYPE_CHECKING

from torsion.errors import Fault, InputError, SolveError

if TYPE_CHECKING:
    from torsion.assembly.system import System
    from torsion.train import Train

MODELS = {
    "lumped": "torsion.assembly.system_builder:assemble_lumped",
    "fem": "torsion.assembly.fem:assemble_fem",
    "exact": "torsion.assembly.distributed_shafts:assemble_exact",
}
ROUNDING = 1e-9  # relative, of a frequency that was itself computed


def assemble(
    train: "Train",
    model: str = "lumped",
    *,
    frequency: float = 0.0,
    degree: int | None = None,
    elements: int | None = None,
) -> "System":
    """The system of a train; shafts are discretised finely enough for a highest frequency (Hz).

    degree, elements: of every shaft, of the model `fem` alone; None: what the frequency needs. The system's
    `resolved_to` is the frequency up to which it keeps the error of its model (lumped 1e-3, fem 1e-6); infinite in the
    exact model, and where nothing is left to choose: no shaft has inertia, or its segments or elements are stated.
    Raises InputError for an unknown model, SolveError where a model cannot take the train.
    """
    if model not in MODELS:
        raise InputError(
            [Fault(("model",), f"no model is called '{model}'", f"give {', '.join(MODELS)}")]
        )
    from torsion.assembly.system import Discretisation

    if train.has_steps:
        from torsion.assembly.junction.stepped_shafts import with_steps

        train = with_steps(train)
    if train.has_meshed_sections:
        from torsion.assembly.section.solved_sections import resolved

        train = resolved(train)
    system: System = resolve_name(MODELS[model])(train, Discretisation(frequency, degree, elements))
    return system


def rediscretised(system: "System", frequency: float) -> "System":
    """The same train in the same model, its shafts discretised for another highest frequency (Hz)."""
    return assemble(
        system.train, system.model, **{**vars(system.requested), "frequency": frequency}
    )


def of_train(system: "System", train: "Train") -> "System":
    """Another train in the same model, its shafts discretised for the same highest frequency."""
    return rediscretised(replace(system, train=train), system.requested.frequency)


def as_divided(system: "System", train: "Train") -> "System":
    """The same, its lumped shafts in as many segments as those of the system with these names."""
    bars = tuple(
        replace(bar, segments=system.segments.get(bar.name, bar.segments)) for bar in train.bars
    )
    return of_train(system, replace(train, bars=bars))


def is_as_fine(system: "System", reference: "System") -> bool:
    """No shaft of the `other` system has more pieces, nor elements of a higher degree."""
    degree, least_degree = (
        0 if assembled.bars is None else assembled.bars.degree for assembled in (system, reference)
    )
    return degree >= least_degree and all(
        system.segments[name] >= number for name, number in reference.segments.items()
    )


def resolving(system: "System", frequency: float, *, refine: bool = True) -> "System":
    """The system itself, or the same train discretised finely enough for a highest frequency (Hz).

    Raises SolveError where it does not resolve that frequency and must not be refined.
    """
    if not refine:
        demand_resolution(system, frequency)
        return system
    if frequency <= system.requested.frequency * (1.0 + ROUNDING):
        return system
    finer = rediscretised(system, frequency)
    if is_as_fine(system, finer):
        return system
    demand_resolution(finer, frequency)
    return finer


def demand_resolution(system: "System", frequency: float) -> None:
    """Raise SolveError where the shafts of a system do not resolve a frequency (Hz)."""
    if frequency > system.resolved_to * (1.0 + ROUNDING):
        needed = f"up to {frequency:.6g} Hz" if math.isfinite(frequency) else "for so many modes"
        raise SolveError(
            f"the shafts of this {system.model} system are resolved up to {system.resolved_to:.6g} Hz, not {needed}; "
            "assemble with a higher `frequency`, let it refine, or use the exact model"
        )
