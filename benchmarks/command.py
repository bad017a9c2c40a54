"""What the whole command costs: `python -m benchmarks.command [--quick]`.

`torsion solve` of examples next to `torsion solve --json` of the same, which draws and writes nothing, in turn; where
the time of each goes; and `--json` next to the bare imports. Every run is a fresh process. Writes reports/command.md;
`--quick` takes half a minute, fewer runs, and prints without writing. Long trains are on scale.md.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

from benchmarks import cases
from benchmarks.page_file import Report, verdict
from benchmarks.papers.writing import table
from benchmarks.scenes import scene

SPECS = Path(__file__).parents[1] / "shafting_specs"
SCENES = ("haixun_06402", "usv", "cardan_bearings", "pump_1200kw", "six_cylinder")
LIMITED = SCENES[:2]  # scenes with a target
MOST, HEAVIEST = 1.6, 450.0  # of solve / --json, and kB of the first scene's page
IMPORTS, BARE = (
    "import numpy, scipy.linalg, pydantic, yaml, pint",
    1.5,
)  # and the ratio of --json to them

HOW = """\
Times are of whole processes, from start to end, in s: the smallest of the runs, which take turns (`solve`, `--json`,
`solve`, ...), and in brackets the processor's. `solve` draws every figure and writes the page, the tables and
results.json; `--json` solves the same and prints results.json. A ratio above its target is MISSED."""
PARTS = """\
Where the time goes, ms of one process: the median of the runs. `read` holds the import of the schema, `solve` that of
the analyses which the model file needs; `blocks` are tables and figures as data, `page` draws and renders them."""


def main() -> None:
    """Measures, and writes the page."""
    report = Report(__doc__, "command", "three runs each", runs=7)
    runs = 3 if report.chosen.quick else report.chosen.runs
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        pairs = [_pair(SPECS / f"{one}.yaml", folder, runs) for one in SCENES]
        parts = [_median_parts(SPECS / f"{one}.yaml", runs) for one in SCENES]
        bare = _beside_imports(folder, runs)
    sections = [
        HOW,
        table(HEAD, map(_row, pairs)),
        _scene_verdicts(pairs),
        "## Where it goes",
        PARTS,
        table(("scene", *parts[0]), _part_rows(parts)),
    ]
    report.publish("The command", [*sections, "## Next to the bare imports", bare])


HEAD = ("scene", "solve", "--json", "ratio", "solve - json", "page kB", "results kB")


def _pair(file: Path, folder: Path, runs: int) -> dict[str, Any]:
    """Smallest seconds of both forms of the command, which take turns, and the weight of what the report holds."""
    out = folder / file.stem
    forms = {"solve": ["solve", str(file), "-o", str(out)], "json": ["solve", str(file), "--json"]}
    times = [{name: _run(words) for name, words in forms.items()} for _ in range(runs)]
    least = {name: tuple(min(one[name][k] for one in times) for k in (0, 1)) for name in forms}
    print(f"{file.stem}: {least}", file=sys.stderr, flush=True)
    weight = {name: (out / name).stat().st_size / 1e3 for name in ("report.html", "results.json")}
    return {"scene": file.stem, **least, **weight}


def _run(words: Sequence[str]) -> tuple[float, float]:
    """Seconds by the clock and of the processor; a failed check (status 1) and no result (3) are answers too."""
    start, before = perf_counter(), os.times()
    done = subprocess.run(
        [sys.executable, "-m", "torsion", *words], capture_output=True, text=True, check=False
    )
    seconds, after = perf_counter() - start, os.times()
    if done.returncode not in (0, 1, 3) or "Traceback" in done.stderr:
        sys.exit(f"torsion {' '.join(words)} failed: {done.stderr[-300:]}")
    processor = (
        after.children_user + after.children_system - before.children_user - before.children_system
    )
    return seconds, processor


def _row(pair: dict[str, Any]) -> tuple[str, ...]:
    solve, plain = pair["solve"], pair["json"]
    times = (f"{clock:.2f} ({processor:.2f})" for clock, processor in (solve, plain))
    weights = (f"{pair[name]:.0f}" for name in ("report.html", "results.json"))
    return (
        pair["scene"],
        *times,
        f"{solve[0] / plain[0]:.2f}",
        f"{solve[0] - plain[0]:.2f}",
        *weights,
    )


def _scene_verdicts(pairs: Sequence[dict[str, Any]]) -> str:
    worst = max(pair["solve"][0] / pair["json"][0] for pair in pairs if pair["scene"] in LIMITED)
    heaviest = pairs[0]["report.html"]
    return (
        f"- largest ratio of {' and '.join(LIMITED)}: {worst:.2f}, meant <= {MOST}: {verdict(worst <= MOST)}\n"
        f"- page of {SCENES[0]}: {heaviest:.0f} kB, meant <= {HEAVIEST:.0f}: {verdict(heaviest <= HEAVIEST)}"
    )


def _median_parts(file: Path, runs: int) -> dict[str, float]:
    """Median seconds of every part of fresh processes."""
    command = [sys.executable, "-m", "benchmarks.command_parts", str(file)]
    done = [
        json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        for _ in range(runs)
    ]
    return {name: statistics.median(one[name] for one in done) for name in done[0]}


def _part_rows(parts: Sequence[dict[str, float]]) -> list[tuple[str, ...]]:
    return [
        (name, *(f"{1e3 * seconds:.0f}" for seconds in one.values()))
        for name, one in zip(SCENES, parts, strict=True)
    ]


def _beside_imports(folder: Path, runs: int) -> str:
    """`--json` of six discs next to an interpreter that imports the libraries it needs and ends."""
    file = scene(cases.undamped(cases.chain(6, stiff=False)), folder)
    pairs = []
    for _ in range(runs):
        own = _run(["solve", str(file), "--json"])[0]
        start = perf_counter()
        subprocess.run([sys.executable, "-c", IMPORTS], check=True)
        pairs.append((own, perf_counter() - start))
    ratio = statistics.median(own / bare for own, bare in pairs)
    own, bare = (statistics.median(times) for times in zip(*pairs, strict=True))
    return (
        f"`torsion solve --json` of six discs takes {own * 1e3:.0f} ms, `{IMPORTS}` {bare * 1e3:.0f} ms (medians); "
        f"ratio, median of the pairs: {ratio:.2f}, meant <= {BARE}: {verdict(ratio <= BARE)}"
    )


if __name__ == "__main__":
    main()
