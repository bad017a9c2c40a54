"""Deviation from published cases: `python -m tests.validation.published` writes docs/validation/index.md anew.

published.json gives for every case its source, the published numbers, and the relative deviation that the digits of
these allow (`within`). A motion deviates by the greatest difference of a speed over the greatest value of that signal.
"""

import csv
import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.stored.results_json import results

FOLDER = Path(__file__).parent
PAGE = FOLDER.parents[1] / "docs" / "validation" / "index.md"
CASES: dict[str, dict[str, Any]] = json.loads(
    (FOLDER / "published.json").read_text(encoding="utf-8")
)
ROUNDING = (
    1e-12  # smaller deviations are those of floating-point sums, and unlike on another processor
)
HEAD = """# Validation: published cases

Every case is a model file in `tests/validation` with its published values, and a test compares them at each change of
the program. A deviation is relative; the allowed one follows from the published digits, or from the
stated error of the reference. The deviation of a
time history is the largest difference of a speed over its largest value.
The licence of the reference histories of the Modelica Standard Library is in `tests/validation/NOTICE.md`.

| case | source | quantity | deviation | allowed |
|---|---|---|---|---|
"""
TAIL = """
```{toctree}
:maxdepth: 1

your-case
```

Other programs and reference solutions are compared in the studies below. The scripts of `benchmarks/` write them.

```{toctree}
:caption: Studies
:maxdepth: 1
:glob:

../../reports/*
```

```{toctree}
:caption: Published papers computed again
:maxdepth: 1
:glob:

../../reports/papers/*
```
"""


class Deviation(NamedTuple):
    """The largest relative deviation of a case, and the quantity that has it."""

    size: float
    quantity: str


def solve_case(case: str) -> Findings:
    """Read and solve the model file of a case."""
    return torsion.run(torsion.read(FOLDER / f"{case}.yaml"))


def largest_deviation(case: str, findings: Findings) -> Deviation:
    """Compare every published quantity of a case with the results."""
    published, deviations = CASES[case], list[Deviation]()
    if "frequency_Hz" in published:
        computed = findings.need(Modes).frequency
        deviations.append(
            Deviation(relative(computed, published["frequency_Hz"]), "natural frequencies")
        )
    if "damping_ratio" in published:
        computed = findings.need(DampedModes).damping_ratio
        deviations.append(
            Deviation(relative(computed, published["damping_ratio"]), "damping ratio")
        )
    if "eigenvalue_modulus_rad_per_s" in published:
        computed = np.sort(np.abs(findings.need(DampedModes).eigenvalue))
        deviations.append(
            Deviation(relative(computed, published["eigenvalue_modulus_rad_per_s"]), "eigenvalues")
        )
    if "sum_of_magnitudes_Nm" in published:
        deviations.append(magnitude_sum_deviation(published, findings))
    if "reference" in published:
        deviations += history_deviations(FOLDER / published["reference"], findings)
    return max(deviations)


def relative(computed: np.ndarray, published: list[float]) -> float:
    """Return the largest relative deviation of the first values from the published ones."""
    return float(np.abs(computed[: len(published)] / np.array(published) - 1.0).max())


def magnitude_sum_deviation(published: dict[str, Any], findings: Findings) -> Deviation:
    """Compare the sum of the magnitudes of all orders, largest over shafts and speeds, with the published one."""
    written = results(findings)
    bound = np.array(written["synthesis"]["bound_Nm"], dtype=float)
    speed = np.array(written["response"]["speed_rad_per_s"])
    bound = bound if bound.shape[0] == speed.size else bound.T
    names = [
        written["spans"][span]["name"] if isinstance(span, int) else span
        for span in written["synthesis"]["element"]
    ]
    shafts = [index for index, name in enumerate(names) if name.startswith("s")]
    largest = bound[speed >= published["sum_from_rad_per_s"]][:, shafts].max()
    return Deviation(abs(largest / published["sum_of_magnitudes_Nm"] - 1.0), "sum of magnitudes")


def history_deviations(file: Path, findings: Findings) -> list[Deviation]:
    """Compare the speeds of the only motion with a reference, linear between the times of the program."""
    with file.open(newline="", encoding="utf-8") as rows:
        titles, *values = list(csv.reader(rows))
    reference = dict(zip(titles, np.array(values, dtype=float).T, strict=True))
    times = reference.pop("time [s]")
    (motion,) = findings.results["transient"].each
    names = [station.name for station in findings.study.train.stations]
    deviations = []
    for name, speed in reference.items():
        computed = np.interp(times, motion.time, motion.speed[names.index(name)])
        size = float((np.abs(computed - speed) / np.abs(speed).max()).max())
        deviations.append(Deviation(size, f"speed of {name}"))
    return deviations


def write_page() -> str:
    """Return the page with one row for every case."""
    rows = []
    for case, published in CASES.items():
        deviation = largest_deviation(case, solve_case(case))
        size = f"{deviation.size:.1e}" if deviation.size > ROUNDING else f"below {ROUNDING:.0e}"
        rows.append(
            f"| `{case}` | {published['source']} | {deviation.quantity} | {size} | {published['within']:.0e} |"
        )
    return HEAD + "\n".join(rows) + "\n" + TAIL


if __name__ == "__main__":
    PAGE.write_text(write_page(), encoding="utf-8")
