"""The chapters of a report, in their order; each gives no block where the scene has nothing for it."""

from collections.abc import Sequence
from importlib import import_module

from torsion.findings import Findings
from torsion.output.blocks import Block

CHAPTERS = (
    "verdict", "plant", "mass_elastic", "natural_frequencies", "twisted_train", "critical_speeds", "excitations", "damping_given", "mean_torques",
    "forced_response", "exact_response", "stability_ranges", "shaft_stress", "gear_meshes", "coupling_loads", "barred_ranges", "joint_motion", "shaft_bending", "frequency_response",
    "model_comparison", "conclusion", "steps_done", "input_file",
)  # fmt: skip
ON_REQUEST = ("twisted_train",)  # chapters that an option of the command asks for


def chapters(findings: Findings, also: Sequence[str] = ()) -> list[Block]:
    """Every chapter that the findings have something for, one after another; of ON_REQUEST those named in `also`."""
    found: list[Block] = []
    for name in CHAPTERS:
        if name in ON_REQUEST and name not in also:
            continue
        found.extend(import_module(f"torsion.output.chapters.{name}").chapter(findings))
    return found
