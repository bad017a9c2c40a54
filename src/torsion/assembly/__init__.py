"""Primitives to a system: one model a file, imported when it is asked for."""

from importlib import import_module
from typing import TYPE_CHECKING

from torsion.assembly.section.resolved import resolved

if TYPE_CHECKING:
    from torsion.assembly.system import System
    from torsion.train import Train

MODELS = {
    "lumped": "torsion.assembly.lumped:assemble_lumped",
    "fem": "torsion.assembly.fem:assemble_fem",
    "exact": "torsion.assembly.exact:assemble_exact",
}


def assemble(
    train: "Train",
    model: str = "lumped",
    *,
    frequency: float = 0.0,
    degree: int | None = None,
    elements: int | None = None,
) -> "System":
    """The system of a train; shafts are divided finely enough for a highest frequency (Hz).

    degree, elements: of every shaft, of the model `fem` alone; None: what the frequency needs. Raises KeyError for an
    unknown model, SolveError where a model cannot take the train.
    """
    module, name = MODELS[model].split(":")
    finite = {"degree": degree, "elements": elements} if model == "fem" else {}
    system: System = getattr(import_module(module), name)(resolved(train), frequency=frequency, **finite)
    return system
