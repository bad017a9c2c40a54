"""Designs judged side by side, for the page of `benchmarks.sweeps`; alone: `python -m benchmarks.swept_designs`."""

import tempfile
from dataclasses import replace
from itertools import product
from pathlib import Path
from time import process_time

import numpy as np

import torsion
from benchmarks.papers.writing import table
from torsion import rules
from torsion.analyses.design.design_results import Design
from torsion.analyses.variants.judged_in_groups import JudgedInGroups
from torsion.analyses.variants.one_by_one import solved
from torsion.findings import Work
from torsion.rules import judgement

MANY, FEW, SEEDS = 10_000, 40, range(5)  # rows of a catalogue, and of that of the mixed choice
GRID = (45, 24)  # diameters and phases of the enumeration, of every row
TRAIN = """name: drive
operation: {{speeds: {{from: 300 rpm, to: 1800 rpm, steps: 41}}, rated: {{speed: 1500 rpm, power: 100 kW}}}}
train:
  - motor: {{name: motor, inertia: 1.2, ripple: [{{order: 2, torque: 30 %, phase: 20 deg}}]}}
  - coupling: {{name: rubber, stiffness: 13 kN*m/rad, psi: 0.85, vibratory_torque: 220 N*m}}
  - disc: {{name: hub, inertia: 0.3}}
  - coupling: {{name: head, stiffness: 3 MN*m/rad, psi: 0.05, vibratory_torque: 210 N*m}}
  - shaft: {{name: tail, length: 1.4 m, diameter: 60 mm, material: light}}
  - coupling: {{name: plates, stiffness: 2 MN*m/rad, psi: 0.05, vibratory_torque: 200 N*m}}
  - propeller: {{name: pump, inertia: 0.95, blades: 2, excitation: [{{blade_order: 1, torque: 10 %}}]}}
materials: {{light: {{shear_modulus: 79.3 GPa, density: 0}}}}
analyses:
  modes: {{count: 3}}
  response:
  design:
    choose: {{{chosen}}}
    seed: {seed}
rules: [coupling-maker]
"""
CATALOGUE, DIAMETER = "rubber: {catalogue: rows.csv}", "tail.diameter: {from: 40 mm, to: 75 mm}"
PHASE = "motor.ripple.1.phase: {from: -90 deg, to: 90 deg}"
HEAD = "problem", "choices tried", "method", "smallest margin", "chosen", "solved again", "s"


def designs(*, quick: bool = False) -> list[str]:
    """The section of the page."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = [_catalogue(folder, MANY // (10 if quick else 1)), _map(folder)]
        mixed, true, words = _mixed(folder)
    found = sum(margin >= true - 1e-3 for margin, _ in mixed)
    return [
        "## Designs",
        f"Four stations and limits of three couplings; reading the file is included. {words}",
        table(HEAD, [*rows, *(row for _, row in mixed)]),
        f"Within 0.001 of the best of the enumeration, or better: {found} of {len(mixed)} seeds.",
    ]


def _rows(folder: Path, count: int) -> None:
    """A catalogue whose limits rise with the stiffness, and fall again."""
    rng, place = np.random.default_rng(1), np.linspace(0.0, 23.0, count)
    stiffness, limit = (
        6 * 1.06**place * rng.uniform(0.95, 1.05, count),
        150 + 30 * place - 1.2 * place**2,
    )
    lines = [
        f"r{k},{stiffness[k]:.6g},{0.9 - 0.01 * one:.4g},{limit[k]:.6g}"
        for k, one in enumerate(place)
    ]
    head = "name,stiffness [kN*m/rad],psi,vibratory_torque [N*m]"
    (folder / "rows.csv").write_text("\n".join([head, *lines, ""]), encoding="utf-8")


def _designed(folder: Path, *chosen: str, seed: int = 1) -> tuple[Design, float]:
    begin = process_time()
    study = torsion.parse(
        TRAIN.format(chosen=", ".join(chosen), seed=seed), str(folder / "drive.yaml")
    )
    return torsion.run(study).need(Design), process_time() - begin


def _row(name: str, found: Design, seconds: float) -> tuple[str, ...]:
    best = found.best[(found.chosen or 1) - 1]
    method = found.method.replace("; judged", ", judged")
    return (
        name,
        f"{found.evaluations:,}",
        method,
        f"{best.margin:.5f}",
        ", ".join(best.values),
        best.proven,
        f"{seconds:.1f}",
    )


def _catalogue(folder: Path, count: int) -> tuple[str, ...]:
    _rows(folder, count)
    return _row(f"catalogue of {count:,} rows", *_designed(folder, CATALOGUE))


def _map(folder: Path) -> tuple[str, ...]:
    return _row("map of two values", *_designed(folder, DIAMETER, PHASE))


def _mixed(folder: Path) -> tuple[list[tuple[float, tuple[str, ...]]], float, str]:
    """Of every seed the margin and the row; the best of the enumeration, and how that was found, in words."""
    _rows(folder, FEW)
    text = TRAIN.format(chosen=", ".join([CATALOGUE, DIAMETER, PHASE]), seed=1)
    study = torsion.parse(text, str(folder / "drive.yaml"))
    own = replace(
        study, analyses={key: one for key, one in study.analyses.items() if key != "design"}
    )
    work = Work(own, {}, ruled=rules.needed(own), rules=judgement, solve=torsion.run)
    bench, begin = JudgedInGroups(work, study.variations["design"], 1), process_time()
    grid = np.array(
        list(product(range(FEW), np.linspace(40, 75, GRID[0]), np.linspace(-90, 90, GRID[1])))
    )
    every = -np.log([used for used, _ in bench.answers(grid).checks.values()])
    seconds, true = process_time() - begin, every.min(axis=0)
    at = int(true.argmax())
    begin = process_time()
    solved(work, bench.variation, grid[::500], 1, judged=True)
    alone = (process_time() - begin) / len(grid[::500])
    words = (
        f"Mixed: coupling of {FEW} rows, diameter and phase. The truth: all of {FEW} by {GRID[0]} by {GRID[1]}, "
        f"{len(grid):,} in {seconds:.1f} s ({len(grid) / seconds:,.0f} a second, {bench.alone} of them one by one; "
        f"one by one {1 / alone:.0f} a second): {true[at]:.5f} at r{grid[at, 0]:.0f}, {grid[at, 1]:.4g} mm, "
        f"{grid[at, 2]:.4g} deg, where the margins are {', '.join(f'{one:.3f}' for one in every[:, at])}."
    )
    found = []
    for seed in SEEDS:
        one, spent = _designed(folder, CATALOGUE, DIAMETER, PHASE, seed=seed)
        found.append((one.best[0].margin or 0.0, _row(f"mixed, seed {seed}", one, spent)))
    return found, float(true[at]), words


if __name__ == "__main__":
    print("\n\n".join(designs()))
