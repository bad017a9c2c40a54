"""The chapters of a report, in their order; each gives no block where the scene has nothing for it."""

from importlib import import_module

from torsion.findings import Findings
from torsion.report.blocks import Block

CHAPTERS = (
    "verdict", "plant", "mass_elastic", "frequencies", "critical", "excitations", "damping", "steady", "response",
    "stress", "gears", "couplings", "barred", "joints", "sweep", "conclusion", "plan", "source",
)  # fmt: skip


def chapters(findings: Findings) -> list[Block]:
    """Every chapter that the findings have something for, one after another."""
    found: list[Block] = []
    for name in CHAPTERS:
        found.extend(import_module(f"torsion.report.chapters.{name}").chapter(findings))
    return found
