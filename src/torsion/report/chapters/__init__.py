"""The chapters of a report, in their order; each gives no block where the scene has nothing for it."""

from collections.abc import Sequence
from importlib import import_module

from torsion.findings import Findings
from torsion.report.blocks import Block

CHAPTERS = (
    "verdict", "plant", "mass_elastic", "frequencies", "twisted_shaft", "critical", "excitations", "damping", "steady",
    "response", "periodic", "stability", "stress", "gears", "couplings", "barred", "joints", "lateral", "sweep",
    "model_comparison", "conclusion", "plan", "source",
)  # fmt: skip
ON_REQUEST = ("twisted_shaft",)  # chapters that an option of the command asks for


def chapters(findings: Findings, also: Sequence[str] = ()) -> list[Block]:
    """Every chapter that the findings have something for, one after another; of ON_REQUEST those named in `also`."""
    found: list[Block] = []
    for name in CHAPTERS:
        if name in ON_REQUEST and name not in also:
            continue
        found.extend(import_module(f"torsion.report.chapters.{name}").chapter(findings))
    return found
