"""Primitives to a system: one model a file, imported when it is asked for."""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from torsion.assembly.system import System
    from torsion.train import Train

MODELS = {"lumped": "torsion.assembly.lumped:assemble_lumped"}


def assemble(train: "Train", model: str = "lumped", *, frequency: float = 0.0) -> "System":
    """The system of a train; shafts are divided finely enough for a highest frequency (Hz). Raises KeyError."""
    module, name = MODELS[model].split(":")
    system: System = getattr(import_module(module), name)(train, frequency=frequency)
    return system
