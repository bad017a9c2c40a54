"""Torsional vibration of shaft trains: read, assemble, solve, judge and report.

>>> study = parse("name: pair\\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]")
>>> modes(assemble(study.train), count=1).frequency.round(6).tolist()  # sqrt(120 (1/2 + 1/3))/2π Hz
[1.591549]
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from torsion.errors import Fault, InputError, SolveError, TorsionError

if TYPE_CHECKING:
    from torsion.analyses.response.over_speed import response
    from torsion.analyses.undamped_modes import modes
    from torsion.assembly import assemble
    from torsion.commands import solve
    from torsion.output.report_figures import figures
    from torsion.runner import run
    from torsion.schema.scene_reader import parse, read

__version__ = "0.1.0"
__all__ = [
    "Fault", "InputError", "SolveError", "TorsionError", "assemble", "figures", "modes", "parse", "read",
    "response", "run", "solve",
]  # fmt: skip

_PLACES = {
    "assemble": "torsion.assembly",
    "figures": "torsion.output.report_figures",
    "modes": "torsion.analyses.undamped_modes",
    "parse": "torsion.schema.scene_reader",
    "read": "torsion.schema.scene_reader",
    "response": "torsion.analyses.response.over_speed",
    "run": "torsion.runner",
    "solve": "torsion.commands",
}


def __getattr__(name: str) -> Any:
    """Public functions are imported when first used, so that a scene loads only what it needs."""
    if name not in _PLACES:
        raise AttributeError(f"module 'torsion' has no attribute '{name}'")
    return getattr(import_module(_PLACES[name]), name)
