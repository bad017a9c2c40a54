"""`torsion solve` next to `--json` on trains of very many components: `python -m benchmarks.scale [--quick]`.

Writes reports/scale.md: the report is to be below 2 MB and to take at most 5 s beyond the solving; `--quick` takes the
trains of 1,000 stations and fewer, one run each, and prints without writing.
"""

import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from typing import Any

from benchmarks.page_file import Report, verdict
from benchmarks.papers.writing import table

MOST_BYTES, MOST_SECONDS = 2_000_000, 5.0
SPEEDS = "speeds: {from: 300 rpm, to: 1800 rpm, steps: 301}, "
RATED = "rated: {speed: 1500 rpm, power: 100 kW}"
USV = Path(__file__).parents[1] / "shafting_specs" / "usv.yaml"
LARGE = 1_000  # stations; larger trains are no part of a quick run
HOW = f"""\
Time is that of the processor, user and system, of a fresh process, the smallest of the runs: a wall clock of a machine
that others use says little. `--json` prints the results, which no cap shortens and which are written into a pipe; of
very many numbers that takes far longer than the report, which keeps them in series.npz. Meant: report.html below
{MOST_BYTES / 1e6:g} MB, and at most {MOST_SECONDS:g} s beyond `--json`."""


def chain(number: int, link: str = "coupling", orders: int = 0, stiffness: float = 0.0) -> str:
    """A scene of discs with couplings, or shafts of one segment, between them, and harmonic torques at the first.

    By itself the couplings have so much stiffness (N m/rad) that the first mode is near 20 Hz, within the speed range.
    """
    usual = stiffness or 16e3 * number
    lines = [
        f"name: chain of {number} discs",
        f"operation: {{{SPEEDS if orders else ''}{RATED}}}",
        "train:",
    ]
    for k in range(number):
        if k and link == "shaft":
            lines.append(
                f"  - shaft: {{name: s{k}, length: 10 mm, diameter: {100 + 37 * k % 11} mm, segments: 1}}"
            )
        elif k:
            own = usual * (1 + 37 * k % 11 / 40)
            lines.append(f"  - coupling: {{name: c{k}, stiffness: {own:.6g}, loss_factor: 0.02}}")
        damping = "" if k else ", damping: 1"
        lines.append(
            f"  - disc: {{name: d{k}, inertia: {10 / number * (1 + 17 * k % 7 / 7):.6g}{damping}}}"
        )
    analyses = "modes: {count: 12}, response: {}" if orders else "modes: {count: 12}"
    return "\n".join([*lines, *_excited(orders), f"analyses: {{{analyses}}}\n"])


def branched(number: int) -> str:
    """A scene of a main line with a branch of one disc at each of its points."""
    lines = ["name: a train with branches", f"operation: {{{SPEEDS}{RATED}}}", "train:"]
    for k in range(number):
        if k:
            lines.append(f"  - coupling: {{name: c{k}, stiffness: 1e6, loss_factor: 0.02}}")
        branch = f"coupling: {{stiffness: {2e5 * (1 + k / 40):g}, loss_factor: 0.02}}, disc: {{inertia: 0.3}}"
        lines += [f"  - disc: {{name: d{k}, inertia: 1}}", f"  - branch: {{train: [{branch}]}}"]
    return "\n".join([*lines, *_excited(2), ""])


def _excited(orders: int) -> list[str]:
    every = [f"  - {{at: d0, order: {n}, torque: {10 / n:.4g}}}" for n in range(1, orders + 1)]
    return ["excitations:", *every] if orders else []


def long_shaft(segments: int) -> str:
    """usv with a tail shaft of so many segments."""
    shaft = "name: tail shaft, "
    return USV.read_text(encoding="utf-8").replace(shaft, f"{shaft}segments: {segments}, ")


SCENES: dict[str, tuple[int, Callable[[], str]]] = {  # stations, scene
    "chain of 1,000, 2 orders, 301 speeds": (1_000, lambda: chain(1_000, orders=2)),
    "1,000 discs and 999 shafts, 2 orders, 301 speeds": (
        1_000,
        lambda: chain(1_000, "shaft", orders=2),
    ),
    "usv, tail shaft of 1,000 segments": (1_000, lambda: long_shaft(1_000)),
    "40 branches, 2 orders, 301 speeds": (80, lambda: branched(40)),
    "chain of 20, 12 orders, 301 speeds": (20, lambda: chain(20, orders=12)),
    "chain of 10,000, modes": (10_000, lambda: chain(10_000)),
    "10,000 discs and 9,999 shafts, modes": (10_000, lambda: chain(10_000, "shaft")),
    "chain of 10,000 without a resonance in the range, 2 orders, 301 speeds": (
        10_000,
        lambda: chain(10_000, orders=2, stiffness=2e11),
    ),
}


def main() -> None:
    """Measures every scene and writes the page."""
    report = Report(__doc__, "scale", "trains of 1,000 stations and fewer, one run each", runs=3)
    runs = 1 if report.chosen.quick else report.chosen.runs
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, (size, scene) in SCENES.items():
            if size <= LARGE or not report.chosen.quick:
                file = Path(folder) / "scene.yaml"
                file.write_text(scene(), encoding="utf-8")
                rows.append(_measured(name, file, Path(folder) / "report", runs))
    head = (
        "train",
        "--json s",
        "with report s",
        "beyond s",
        "report.html kB",
        "results.json MB",
        "series.npz MB",
        "tables and input next to it MB",
        "meant",
    )
    report.publish(
        "Reports of very long trains", [HOW, f"- Runs of each: {runs}", table(head, rows)]
    )


def _measured(name: str, file: Path, folder: Path, runs: int) -> list[Any]:
    alone = min(_seconds(["--json"], file) for _ in range(runs))
    whole = min(_seconds(["-o", str(folder)], file) for _ in range(runs))
    size = {path.name: path.stat().st_size for path in folder.iterdir()}
    page, results, series = (
        size.pop(one, 0) for one in ("report.html", "results.json", "series.npz")
    )
    is_met = page < MOST_BYTES and whole - alone <= MOST_SECONDS
    return [
        name,
        f"{alone:.1f}",
        f"{whole:.1f}",
        f"{whole - alone:.1f}",
        f"{page / 1e3:.0f}",
        f"{results / 1e6:.1f}",
        f"{series / 1e6:.1f}",
        f"{sum(size.values()) / 1e6:.2f}",
        verdict(is_met),
    ]


def _seconds(options: list[str], file: Path) -> float:
    """Processor time of `torsion solve`; raises RuntimeError where it has no result."""
    before = getrusage(RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "torsion", "solve", str(file), *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as running:
        assert running.stdout is not None
        while running.stdout.read(1 << 20):
            pass
    if running.returncode not in (0, 1):
        raise RuntimeError(f"torsion solve of {file} ended with {running.returncode}")
    after = getrusage(RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


if __name__ == "__main__":
    main()
