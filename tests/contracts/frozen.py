"""Digits of results, in few words: `python -m tests.contracts.frozen` writes them anew."""

import contextlib
import hashlib
import io
import json
from datetime import date
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from tests.shared import shared

import torsion
from torsion.findings import Findings
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree
from torsion.output.document import Document, document
from torsion.output.renderers import OUTPUTS
from torsion.output.stored.results_json import makers

ROOT = Path(__file__).parents[2]
FILE = Path(__file__).with_name("frozen_digits.json")
SCENES = {path.stem: path for path in sorted((ROOT / "shafting_specs").glob("**/*.yaml"))}
TAKEN = {  # of the results of a scene
    "modes": ("frequency_Hz", "lower_Hz", "upper_Hz", "torque_Nm"),
    "damped_modes": ("frequency_Hz", "damping_ratio"),
    "synthesis": ("half_range_Nm", "peak_Nm"),
    "stability": ("growth_per_s",),
}
Digits = list[Any]  # digest of every bit; how many numbers, their sum, the sum of their magnitudes


@lru_cache(maxsize=4)
def solved(scene: str) -> Findings:
    """Findings of a scene read by a name that is the same in every clone: its length moves lines of the report.

    Solved once for all tests of a run, which change nothing in it.
    """

    def solve() -> Findings:
        with contextlib.chdir(ROOT):
            return torsion.run(torsion.read(SCENES[scene].relative_to(ROOT)))

    return shared(f"scene-{scene}", solve)


@lru_cache(maxsize=1)
def written(scene: str) -> dict[str, Any]:
    """What results.json says of a scene, with arrays in place of lists."""
    return {key: make() for key, make in makers(solved(scene)).items()}


@lru_cache(maxsize=1)
def reported(scene: str) -> Document:
    """The report of a scene, of a day."""
    return document(solved(scene), date(2026, 11, 22))


def terminal(report: Document) -> list[str]:
    """The lines of a report on a wide terminal."""
    console = Console(file=io.StringIO(), width=200, color_system="truecolor", force_terminal=True)
    for item in OUTPUTS["terminal"](report):
        console.print(item)
    return console.file.getvalue().splitlines()  # type: ignore[attr-defined]


def digits(values: Any) -> Digits:
    """Of an array, or nested lists with None for no value; what is not finite is none."""
    array = np.array(values, dtype=float).ravel()
    array[~np.isfinite(array)] = np.nan
    known = array[np.isfinite(array)]
    digest = hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()[:10]
    return [digest, int(known.size), float(known.sum()), float(np.abs(known).sum())]


def of_scene(made: dict[str, Any]) -> dict[str, Digits]:
    """Frequencies with their bounds, torques, half ranges, growth rates and verdicts."""
    taken: dict[str, Digits] = {}
    for key, names in TAKEN.items():
        if made[key] is not None:
            taken |= {f"{key}.{name}": digits(made[key][name]) for name in names}
    if made["response"] is not None:
        for place, line in enumerate(made["response"]["lines"]):
            taken[f"response.lines[{place}].torque_Nm"] = digits(line["torque_Nm"])
    if made["checks"]:
        over_time = ("transient", "ice")  # steps of a motion end where they may
        lines = [line for line in made["checks"] if line["rule"] not in over_time]
        taken["checks"] = digits([[line["value"], line["limit"]] for line in lines])
        taken["verdicts"] = [line["verdict"] for line in made["checks"]]
    return taken


def of_trains() -> dict[str, Digits]:
    """All modes of random trains: chains and trees, benign and of stiffness ratio 1e12."""
    taken = {}
    for size in (10, 100):
        for shape in ("chain", "tree"):
            for spread in (1.0, 12.0):
                rng = np.random.default_rng(size)
                behind = np.arange(size) - 1
                parent = (
                    behind
                    if shape == "chain"
                    else np.array([-1, *(rng.integers(0, k) for k in range(1, size))])
                )
                flexibility, inertia = (
                    10.0 ** (-spread * rng.random(size)),
                    rng.uniform(0.5, 2.0, size),
                )
                found = tree_modes(
                    Tree(parent, flexibility, inertia, np.zeros(size, dtype=bool)), None
                )
                name = f"{shape} of {size}, spread 1e{spread:g}"
                taken |= {
                    f"{name}: {what}": digits(getattr(found, what))
                    for what in ("frequency", "lower", "upper", "torque")
                }
    return taken


def write(file: Path, values: dict[str, Any]) -> None:
    """One line for each scene."""
    lines = (f'"{name}": {json.dumps(value, ensure_ascii=False)}' for name, value in values.items())
    file.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    write(
        FILE, {**{name: of_scene(written(name)) for name in SCENES}, "random trains": of_trains()}
    )
