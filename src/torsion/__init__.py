"""Torsional vibration of shaft trains: read, assemble, solve, judge and report.

>>> study = parse("name: pair\\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]")
>>> modes(assemble(study.train), count=1).frequency.round(6).tolist()  # sqrt(120 (1/2 + 1/3))/2π Hz
[1.591549]
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from torsion.errors import Fault, InputError, SolveError, TorsionError
from torsion.model import KINDS

if TYPE_CHECKING:
    from torsion import formulas
    from torsion.analyses.damped_modes import damped as damped_modes
    from torsion.analyses.joints.joint_analysis import joints
    from torsion.analyses.motion.motion_from_events import transient
    from torsion.analyses.response.over_frequency import frequency_response
    from torsion.analyses.response.over_speed import response
    from torsion.analyses.stability.stability_over_speed import stability
    from torsion.analyses.undamped_modes import modes
    from torsion.assembly import assemble
    from torsion.commands import check, report, solve
    from torsion.exchange.comparison import compare
    from torsion.exchange.export_command import export
    from torsion.exchange.mass_elastic_table import import_table
    from torsion.findings import Findings
    from torsion.output.report_figures import figures
    from torsion.runner import run
    from torsion.schema.builder import Constructor, build
    from torsion.schema.scene_reader import parse, read
    from torsion.study import Study
    from torsion.train import Train

    branch = compressor = coupling = damper = disc = engine = fan = gear = generator = joint = (
        machine
    ) = motor = pendulum = propeller = pump = shaft = turbine = Constructor("")

__version__ = "0.1.0"
_PLACES = {
    "Findings": "torsion.findings:Findings",
    "Study": "torsion.study:Study",
    "Train": "torsion.train:Train",
    "assemble": "torsion.assembly:assemble",
    "build": "torsion.schema.builder:build",
    "check": "torsion.commands:check",
    "compare": "torsion.exchange.comparison:compare",
    "damped_modes": "torsion.analyses.damped_modes:damped",
    "export": "torsion.exchange.export_command:export",
    "figures": "torsion.output.report_figures:figures",
    "formulas": "torsion.formulas",
    "frequency_response": "torsion.analyses.response.over_frequency:frequency_response",
    "import_table": "torsion.exchange.mass_elastic_table:import_table",
    "joints": "torsion.analyses.joints.joint_analysis:joints",
    "modes": "torsion.analyses.undamped_modes:modes",
    "parse": "torsion.schema.scene_reader:parse",
    "read": "torsion.schema.scene_reader:read",
    "report": "torsion.commands:report",
    "response": "torsion.analyses.response.over_speed:response",
    "run": "torsion.runner:run",
    "solve": "torsion.commands:solve",
    "stability": "torsion.analyses.stability.stability_over_speed:stability",
    "transient": "torsion.analyses.motion.motion_from_events:transient",
}
_PLACES |= {kind: f"torsion.schema.builder:{kind}" for kind in KINDS}
__all__ = [
    "Fault",
    "Findings",
    "InputError",
    "SolveError",
    "Study",
    "TorsionError",
    "Train",
    "assemble",
    "branch",
    "build",
    "check",
    "compare",
    "compressor",
    "coupling",
    "damped_modes",
    "damper",
    "disc",
    "engine",
    "export",
    "fan",
    "figures",
    "formulas",
    "frequency_response",
    "gear",
    "generator",
    "import_table",
    "joint",
    "joints",
    "machine",
    "modes",
    "motor",
    "parse",
    "pendulum",
    "propeller",
    "pump",
    "read",
    "report",
    "response",
    "run",
    "shaft",
    "solve",
    "stability",
    "transient",
    "turbine",
]


def __getattr__(name: str) -> Any:
    """Public names are imported when first used, so that a scene loads only what it needs."""
    if name not in _PLACES:
        raise AttributeError(f"module 'torsion' has no attribute '{name}'")
    path, _, attribute = _PLACES[name].partition(":")
    module = import_module(path)
    return getattr(module, attribute) if attribute else module


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
