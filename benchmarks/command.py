"""The whole command beside the bare imports: `python -m benchmarks.command`.

`torsion solve scene --json` of a scene of discs and springs, against a fresh interpreter that imports numpy,
scipy.linalg, pydantic, yaml and pint and ends. Runs are paired, one of each in turn; the ratio is the median of the
pairs' ratios.
"""

import argparse
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from benchmarks import cases, machine
from benchmarks.page_file import verdict
from benchmarks.scenes import scene

TARGET = 1.5
IMPORTS = "import numpy, scipy.linalg, pydantic, yaml, pint"


def main() -> int:
    """Measures and prints; the exit status is 1 where the command itself failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=11)
    parser.add_argument("--size", type=int, default=6, help="discs in the scene")
    chosen = parser.parse_args()
    print("\n".join(machine.lines()))
    with tempfile.TemporaryDirectory() as folder:
        command = _command(chosen.size, Path(folder))
        failure = _run(command)[1]
        if failure:
            print(f"torsion solve failed: {failure}")
            return 1
        pairs = [(_run(command)[0], _run([sys.executable, "-c", IMPORTS])[0]) for _ in range(chosen.pairs)]
    ratio = statistics.median(own / bare for own, bare in pairs)
    own, bare = (statistics.median(times) for times in zip(*pairs, strict=True))
    print(f"torsion solve --json, {chosen.size} discs: {own * 1e3:.0f} ms; {IMPORTS}: {bare * 1e3:.0f} ms (medians)")
    print(f"ratio, median of {chosen.pairs} pairs: {ratio:.2f}, meant <= {TARGET}: {verdict(ratio <= TARGET)}")
    return 0


def _command(size: int, folder: Path) -> list[str]:
    file = scene(cases.undamped(cases.chain(size, stiff=False)), folder)
    program = Path(sys.executable).with_name("torsion")
    return [str(program), "solve", str(file), "--json"]


def _run(command: list[str]) -> tuple[float, str]:
    """Seconds, and the last line of what went wrong; a failed check (status 1) is an answer too."""
    start = perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    seconds = perf_counter() - start
    if done.returncode == 0 or (done.returncode == 1 and "Traceback" not in done.stderr):
        return seconds, ""
    return seconds, (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]


if __name__ == "__main__":
    sys.exit(main())
