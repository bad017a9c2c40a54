"""A design of mixed figures next to an enumeration: `python -m benchmarks.design` writes reports/design.md."""

import time
from pathlib import Path

import torsion
from torsion.what_if.design.design_results import Design

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "shafting_specs" / "design_coupling.yaml"
SEEDS, MOST, SIDE = (
    range(5),
    400,
    13,
)  # evaluations of a search; values of each range in the enumeration
RANGES = {"hub.inertia": ("0.05", "0.4", ""), "intermediate shaft.diameter": ("55", "70", " mm")}
FILES = "coupling of a catalogue (6 sizes), inertia of the hub, diameter of the shaft, with its constraints"


def design(
    text: str, *, seed: int = 1, steps: int = 0, evaluations: int = MOST
) -> tuple[Design, float]:
    """What is found, and the time (s) of the process."""
    head, _, tail = text.partition("  design:")
    keep = next(line for line in tail.splitlines() if line.strip().startswith("keep:"))
    choose = ["      rubber coupling: {catalogue: design_coupling_series.csv}"]
    for name, (low, high, unit) in RANGES.items():
        grid = f", steps: {steps}" if steps else ""
        choose.append(f"      {name}: {{from: {low}{unit}, to: {high}{unit}{grid}}}")
    body = [
        "  design:",
        "    choose:",
        *choose,
        keep,
        f"    evaluations: {evaluations}",
        f"    seed: {seed}",
    ]
    begin = time.process_time()
    found = torsion.run(
        torsion.parse(
            "\n".join([head + "\n".join(body), "rules: [coupling-maker]", ""]), str(SCENE)
        )
    )
    return found.need(Design), time.process_time() - begin


def row(name: str, found: Design, seconds: float) -> str:
    """A line of the table."""
    best = found.best[(found.chosen or 1) - 1]
    words = (
        name,
        f"{best.margin:.5f}",
        ", ".join(best.values),
        best.proven,
        str(found.evaluations),
        f"{seconds:.1f}",
    )
    return f"| {' | '.join(words)} |"


def main() -> None:
    """Both, and whether every seed is within 0.01 of the best of the grid, or better."""
    text = SCENE.read_text(encoding="utf-8")
    rows = []
    true, seconds = design(text, steps=SIDE, evaluations=10_000)
    rows.append(row(f"all of a grid, {SIDE} by {SIDE} by 6", true, seconds))
    every = [design(text, seed=seed) for seed in SEEDS]
    rows += [row(f"search, seed {seed}", *one) for seed, one in zip(SEEDS, every, strict=True)]
    limit = (true.best[0].margin or 0.0) - 0.01
    good = sum((one.best[(one.chosen or 1) - 1].margin or 0.0) >= limit for one, _ in every)
    lines = [
        "# Design: the search next to an enumeration",
        "",
        f"{SCENE.name}: {FILES}.",
        "Written by `python -m benchmarks.design`; time of the process, one thread.",
        "",
        "| method | smallest margin | choice | solved again | evaluations | s |",
        "|---|---|---|---|---|---|",
        *rows,
        "",
        f"Within 0.01 of the best of the grid, or better: {good} of {len(every)} seeds.",
        "",
    ]
    (ROOT / "reports" / "design.md").write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
