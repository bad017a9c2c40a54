"""Stiff and extreme trains, every program's error: `python -m benchmarks.stiffness [--quick]`.

Writes reports/stiffness.md and its figures in under five minutes; `--quick` takes half a minute, prints, and writes
only with `--out`.
"""

import sys
from collections.abc import Iterator
from time import perf_counter

import numpy as np

from benchmarks import references
from benchmarks import stiffness_frequencies as frequencies
from benchmarks import stiffness_motion as motion
from benchmarks import stiffness_response as response
from benchmarks.extremes import USEFUL, Sweep, ends_table, figure, reading
from benchmarks.page_file import Report

LENGTHS = (20, 50, 100, 300, 1000, 3000, 10_000, 100_000, 1_000_000)

HOW = f"""\
Each sweep makes one parameter of the train extreme. Errors are relative, against references of at least 60 digits:
{references.ARITHMETIC} for frequencies and torques, mpmath for damped roots and joints. Counts prove the reference
frequencies to {references.PROVEN} digits. Every program gets the same doubles. A result is useful up to
an error of {USEFUL:g}. Crosses at the top of a figure are results that failed or were not finite. For comparison:
openTorsion, and numpy and scipy (eigh, eigsh, solve, eig) on assembled matrices, without long chains. `plain_modes`
gives no certificate and accepts no massless stations."""


def main() -> None:
    """Measures, prints the page and writes it."""
    report, sweeps = Report(__doc__, "stiffness", "half a minute"), list[Sweep]()
    with np.errstate(all="ignore"):
        for sweep in _sweeps(quick=report.chosen.quick):
            sweeps.append(sweep)
            print(
                f"{perf_counter() - report.start:5.0f} s  {sweep.title}",
                file=sys.stderr,
                flush=True,
            )
    figures = {f"stiffness_{sweep.name}.svg": figure(sweep) for sweep in sweeps}
    report.publish(
        "Stiff and extreme: where the numbers hold and where they end", _parts(sweeps), figures
    )


def _sweeps(*, quick: bool) -> Iterator[Sweep]:
    every = 3 if quick else 1
    yield frequencies.stiffness_ratio(_powers(0, 18, every))
    yield frequencies.inertia_ratio(_powers(0, 18, every))
    yield frequencies.length(LENGTHS[: 4 if quick else None])
    yield frequencies.near_rigid(_powers(4, 30, every))
    yield response.near_rigid_torque(_powers(4, 30, every))
    yield frequencies.massless(_powers(0, -30, every))
    yield from frequencies.repeated(_powers(-1, -18, every))
    yield from motion.damping(_powers(-9, 6, every))
    yield response.resonance(_powers(-1, -20, every))
    yield motion.joint([90.0, 45.0, 10.0, *_powers(0, -12, every)])
    yield response.slow(_powers(2, -30, 2 * every))


def _powers(first: int, last: int, step: int) -> list[float]:
    """Powers of ten from the first to the last exponent, which is among them."""
    sign = 1 if last > first else -1
    exponents = [*range(first, last, sign * step), last]
    return [float(f"1e{exponent}") for exponent in exponents]


def _parts(sweeps: list[Sweep]) -> Iterator[str]:
    yield HOW
    for sweep in sweeps:
        yield from (
            f"## {sweep.title}",
            sweep.what,
            f"![{sweep.title}](stiffness_{sweep.name}.svg)",
            reading(sweep),
        )
        yield from (ends_table(sweep), *sweep.remarks)


if __name__ == "__main__":
    main()
