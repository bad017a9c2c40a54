"""How soon `torsion live` shows what has changed: `python -m benchmarks.live [--quick]`; needs the extra `browser`.

A chain of 20 stations, and examples, in a Chromium without a screen: from the start of the command to the first
picture, from the moment a file is written to the picture of it, and from a slider's event to its picture, each when the
frame has been painted. Writes reports/live.md; `--quick` takes half a minute, and prints without writing.
"""

import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from benchmarks.page_file import Report, verdict
from benchmarks.papers.writing import table

SPECS = Path(__file__).parents[1] / "shafting_specs"
SCENES = ("toleranced_drive", "twin_diesel_ferry", "haixun_06402", "usv")
STATIONS, SAVED, MOVED = (
    20,
    500.0,
    150.0,
)  # and ms to the picture of a saved file, to frequencies of a moved slider
HEAD = (
    "scene",
    "first picture",
    "saved: Campbell",
    "saved: all",
    "slider: Campbell",
    "slider: all",
)
HOW = """\
Times in ms: median and, in brackets, the worst of the runs; of the first picture one run. `Campbell`: the natural
frequencies and the Campbell diagram are painted; `all`: the verdict, the figures of the first page and every curve of
the response too. A file counts from before it is written, a slider from its event; solver, server and browser share the
processors. Where the load printed above is near the number of processors or above it, the times say nothing of a quiet
machine. The chain has 20 stations, 7 couplings with a tolerance, 4 orders and {speeds} speeds."""
DRAWN = """(turn) => new Promise((resolve) => {  // when both frames have shown a later turn, ms since the epoch
    const timer = setInterval(() => {
        if (drawn.report <= turn || drawn.modes <= turn) return;
        clearInterval(timer);
        const at = (which) => Math.min(...TIMES.turns.filter((one) => one.which === which && one.turn > turn).map((one) => one.at));
        const found = { turn: drawn.report, modes: at("modes"), report: at("report"), input: TIMES.input };
        for (const key of ["modes", "report", "input"]) found[key] += performance.timeOrigin;
        resolve(found);
    }, 5);
})"""  # noqa: E501
SLIDE = """(share) => {
    const input = document.querySelector("#each input"), [low, high] = [Number(input.min), Number(input.max)];
    input.value = low + share * (high - low);
    input.dispatchEvent(new Event("input"));
}"""


def chain(stations: int, speeds: int = 151) -> str:
    """A scene of discs with couplings between, every third of which has a tolerance."""
    lines = [
        "name: chain",
        "operation:",
        f"  speeds: {{from: 300 rpm, to: 1800 rpm, steps: {speeds}}}",
        "  rated: {speed: 1500 rpm, power: 400 kW}",
        "train:",
        "  - motor: {name: motor, inertia: 12, ripple: [{order: 1, torque: 1 %}, {order: 2, torque: 2 %}]}",
    ]
    for k in range(1, stations):
        more = (
            "tolerance: 15 %, vibratory_torque: 400 N*m, psi: 0.8"
            if k % 3 == 1
            else "loss_factor: 0.02"
        )
        lines.append(f"  - coupling: {{name: link {k}, stiffness: {(2 + k % 4) * 1e5:g}, {more}}}")
        if k < stations - 1:
            lines.append(f"  - disc: {{name: disc {k}, inertia: {0.5 + 0.1 * k:g}}}")
    waves = "[{blade_order: 1, torque: 5 %}, {blade_order: 2, torque: 1 %}]"
    lines.append(f"  - propeller: {{name: impeller, inertia: 5, blades: 4, excitation: {waves}}}")
    return "\n".join(
        [*lines, "analyses: {modes: {count: 8}, response: }", "rules: [coupling-maker]", ""]
    )


def main() -> None:
    """Measures, and writes the page."""
    from playwright.sync_api import sync_playwright

    report = Report(__doc__, "live", "the chain alone, five runs each", runs=20)
    runs, scenes = (5, ()) if report.chosen.quick else (report.chosen.runs, SCENES)
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as running, tempfile.TemporaryDirectory() as name:
        browser = running.chromium.launch(
            executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]
        )
        folder = Path(name) / "scenes"
        shutil.copytree(SPECS, folder)
        (folder / "chain.yaml").write_text(chain(STATIONS), encoding="utf-8")
        found = {
            one: _measured(browser, folder / f"{one}.yaml", runs) for one in ("chain", *scenes)
        }
        browser.close()
    saved, slid = (
        statistics.median(found["chain"][key]) for key in ("saved: all", "slider: Campbell")
    )
    words = f"- {STATIONS} stations, "
    lines = [
        f"{words}a saved file to its picture: median {saved:.0f} ms, meant < {SAVED:.0f}: {verdict(saved < SAVED)}",
        f"{words}a slider to its Campbell diagram: median {slid:.0f} ms, meant < {MOVED:.0f}: {verdict(slid < MOVED)}",
    ]
    rows = [
        (scene, *(_words(times.get(key, [])) for key in HEAD[1:])) for scene, times in found.items()
    ]
    report.publish("The live page", [HOW.format(speeds=151), table(HEAD, rows), "\n".join(lines)])


def _words(times: list[float]) -> str:
    """Median and worst."""
    if not times:
        return "no slider"
    return f"{statistics.median(times):.0f}" + (f" ({max(times):.0f})" if len(times) > 1 else "")


def _measured(browser: Any, file: Path, runs: int) -> dict[str, list[float]]:
    """Every time of one scene, ms, by the heads of the table."""
    start = _now()
    command = [sys.executable, "-m", "torsion", "live", str(file), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.goto(process.stdout.readline().split()[-1])
        shown = page.evaluate(DRAWN, 0)
        times = {key: list[float]() for key in HEAD[1:]} | {
            "first picture": [shown["report"] - start]
        }
        text = file.read_text(encoding="utf-8")
        for run in range(runs):
            value = re.search(r"(?<=inertia: )[0-9.]+", text)
            assert value is not None
            larger = f"{float(value[0]) * (1.01 + 0.01 * run):.6g}"
            start = _now()
            file.write_text(text[: value.start()] + larger + text[value.end() :], encoding="utf-8")
            shown = page.evaluate(DRAWN, shown["turn"])
            times["saved: Campbell"].append(shown["modes"] - start)
            times["saved: all"].append(shown["report"] - start)
        for run in range(runs if page.locator("#each input").count() else 0):
            page.evaluate(SLIDE, (run + 0.5) * 0.618 % 1.0)
            shown = page.evaluate(DRAWN, shown["turn"])
            times["slider: Campbell"].append(shown["modes"] - shown["input"])
            times["slider: all"].append(shown["report"] - shown["input"])
        page.close()
        process.terminate()
    print({key: _words(one) for key, one in times.items()}, file=sys.stderr, flush=True)
    return {key: one for key, one in times.items() if one}


def _now() -> float:
    """ms since the epoch."""
    return 1e3 * time.time()


if __name__ == "__main__":
    main()
