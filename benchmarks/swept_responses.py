"""The response part of `benchmarks.sweeps`: peaks of torque of many trains, and a map of stiffness and speed."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import process_time
from typing import TypeVar
from unittest.mock import patch

import numpy as np

import torsion
from benchmarks.cases import Case, chain
from benchmarks.page_file import verdict
from benchmarks.papers.writing import table
from torsion.analyses.sweep import sweep_run
from torsion.analyses.sweep.sweep_results import Sweep
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import tree_response
from torsion.kernels.variant_response import Trains, variant_peaks, vertex

Found = TypeVar("Found")
SIZES = ((5, 20_000), (10, 20_000), (20, 8_000), (100, 500))  # stations, trains
IN_BAND = 3  # modes
EVEN, LOOPED, DENSE = (
    200,
    20,
    6001,
)  # points of the plain ways; trains of the loop; points of the reference
REFERRED = {5: 100, 10: 100, 20: 60, 100: 8}  # trains with a reference
COMPARED = 512  # variants judged both ways
SCENE = Path(__file__).parents[1] / "shafting_specs" / "toleranced_drive.yaml"
MEANT_RATE, MEANT_MEDIAN, MEANT_MAP = 1e4, 1e-4, 0.5  # trains a second at ten stations; relative; s
HOW = """\
Each train has its own inertias (±5 %) and stiffnesses (±15 %), a loss factor of 0.1 in one span and 0.01 in the others,
a torque at its last station, and three modes in the band. `variant_peaks` finds the peak of every span's torque with
the modes of each train, on a grid that knows them, and solves (with status) where each peak stands; even: 200 points,
side by side; a loop: `tree_response` of 200 even points, train by train. Errors are against 6001 even points, and 801
about each mode, each with a parabola; "reported" is what `variant_peaks` says of itself, by half of its points."""
HEAD = (
    "stations",
    "µs a train",
    "trains/s",
    "meant",
    "even µs",
    "loop µs",
    "ratio to loop",
    "error, largest",
    "median",
    "meant",
    "reported, largest",
    "even: largest",
    "median",
)


def responses(quick: bool) -> list[str]:
    """Paragraphs of the page."""
    rows = [_row(size, trains // (5 if quick else 1)) for size, trains in SIZES]
    seconds = min(_map() for _ in range(3))
    words = (
        f"A map of 200 stiffnesses and 200 speeds, 4 orders, 6 stations, every span's torque with residual and status: "
        f"{seconds:.2f} s (meant < {MEANT_MAP:g} s: {verdict(seconds < MEANT_MAP)})."
    )
    return [
        "## Peaks of torque",
        HOW,
        table(HEAD, rows),
        words,
        "## Verdicts",
        _verdicts(2048 if quick else 16384),
    ]


def _verdicts(count: int) -> str:
    """The model file of the toleranced drive, judged side by side and one by one."""
    _swept(COMPARED)  # libraries are imported
    many, few = _swept(count), _swept(COMPARED)
    with patch.object(sweep_run, "judged_together", lambda *given: (None, "timed")):
        alone = _swept(COMPARED)
    side_by_side, by_itself = (many[0] - few[0]) / (count - COMPARED), alone[0] / COMPARED
    pairs = list(
        zip(
            *(sorted(one.checks, key=lambda line: line.clause) for one in (few[1], alone[1])),
            strict=True,
        )
    )
    differ = sum(int((one.fails != other.fails).sum()) for one, other in pairs)
    gap = max(
        float(np.abs(one.utilisation / other.utilisation - 1.0).max()) for one, other in pairs
    )
    return (
        f"`toleranced_drive`, whose eight figures vary, judged by `coupling-maker`: {1.0 / side_by_side:.0f} "
        f"variants/s side by side (those near the limit solved again one by one), {1.0 / by_itself:.0f} one by "
        f"one, a ratio of {by_itself / side_by_side:.0f}. Of {COMPARED} variants found both ways {differ} verdicts "
        f"differ, and utilisations by {gap:.1e} at most."
    )


def _swept(count: int) -> tuple[float, Sweep]:
    """Seconds of a sweep of so many variants with all that the file requests besides, and what it found."""
    study = torsion.parse(
        SCENE.read_text(encoding="utf-8").replace("samples: 128", f"samples: {count}")
    )
    seconds, found = _timed(lambda: torsion.run(study))
    return seconds, found.need(Sweep)


def _row(size: int, count: int) -> tuple[str, ...]:
    trains, band = _trains(chain(size, stiff=False, seed=1), count)
    force = np.zeros(size)
    force[-1] = 100.0
    seconds, peaks = min(
        (_timed(lambda: variant_peaks(trains, force, band)) for _ in range(2)),
        key=lambda run: run[0],
    )
    some = trains.part(slice(0, min(REFERRED[size], count)))
    even = np.broadcast_to(np.linspace(*band, EVEN), (some.count, EVEN))
    of_even, plain = _timed(
        lambda: np.abs(some.response(even, force).torque).reshape(size, -1, EVEN).max(axis=2)
    )
    of_loop, _ = _timed(lambda: [_alone(trains, k, even[0], force) for k in range(LOOPED)])
    exact = _reference(some, force, band)[1:]
    own, other = (np.abs(one[1:, : some.count] / exact - 1.0) for one in (peaks.torque, plain))
    each, of_even, of_loop = seconds / count, of_even / some.count, of_loop / LOOPED
    rate = f">= {MEANT_RATE:g}: {verdict(1.0 / each >= MEANT_RATE)}" if size == 10 else "-"
    return (
        str(size),
        f"{1e6 * each:.3g}",
        f"{1.0 / each:.0f}",
        rate,
        f"{1e6 * of_even:.3g}",
        f"{1e6 * of_loop:.3g}",
        f"{of_loop / each:.3g}",
        f"{own.max():.1e}",
        f"{np.median(own):.1e}",
        f"<= {MEANT_MEDIAN:g}: {verdict(bool(np.median(own) <= MEANT_MEDIAN))}",
        f"{peaks.error.max():.1e}",
        f"{other.max():.1e}",
        f"{np.median(other):.1e}",
    )


def _trains(case: Case, count: int) -> tuple[Trains, tuple[float, float]]:
    """Variants of a case, and the band that holds three modes of its middle."""
    rng, size = np.random.default_rng(1), case.size
    inertia = np.array(case.inertia)[:, None] * rng.uniform(0.95, 1.05, (size, count))
    stiffness = np.array(case.stiffness)[1:, None] * rng.uniform(0.85, 1.15, (size - 1, count))
    flexibility = np.vstack([np.zeros((1, count)), 1.0 / stiffness])
    loss, none = np.full(size, 0.01), np.zeros(size)
    loss[1] = 0.1
    tree = Tree(np.array(case.parent), none, none, np.zeros(size, dtype=bool))
    middle = replace(tree, flexibility=flexibility.mean(axis=1), inertia=inertia.mean(axis=1))
    highest = 1.15 * float(tree_modes(middle, IN_BAND).frequency[-1])
    return Trains(tree, flexibility, inertia, none, loss, none), (highest / EVEN, highest)


def _alone(trains: Trains, k: int, w: np.ndarray, force: np.ndarray) -> object:
    tree = replace(trains.tree, flexibility=trains.flexibility[:, k], inertia=trains.inertia[:, k])
    return tree_response(
        tree, w, force, compliance=tree.flexibility / (1.0 + 1j * trains.loss_factor)
    )


def _reference(trains: Trains, force: np.ndarray, band: tuple[float, float]) -> np.ndarray:
    """Peaks (spans, trains) N m on a dense grid."""
    modes, found = trains.resonances(band[1])[0], []
    for k in range(trains.count):
        near = (modes[:, k, None] * (1.0 + np.linspace(-0.03, 0.03, 801))).ravel()
        w = np.union1d(np.linspace(*band, DENSE), near[(near > band[0]) & (near < band[1])])[None]
        torque = np.abs(trains.part(slice(k, k + 1)).response(w, force, check=False).torque)
        found.append(vertex(w, torque[:, None])[0])
    return np.hstack(found)


def _map() -> float:
    """Seconds of a map of 200 stiffnesses and 200 speeds under four orders."""
    stiffness, speed = np.geomspace(5e3, 1e5, 200), np.linspace(300.0, 1800.0, 200) * np.pi / 30.0
    ones, loss = np.ones(200), np.zeros(6)
    loss[1] = 0.1
    flexibility = np.stack(
        [0.0 * ones, 1.0 / stiffness, *(ones / k for k in (9e5, 1e5, 9e5, 2.5e4))]
    )
    inertia = np.outer([1.2, 0.3, 0.05, 0.05, 0.05, 1.0], ones)
    tree = Tree(np.arange(-1, 5), np.zeros(6), np.zeros(6), np.zeros(6, dtype=bool))
    trains = Trains(tree, flexibility, inertia, np.zeros(6), loss, np.zeros(6))
    force = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 50.0])

    def every() -> None:
        for begin in range(0, 200, 25):
            some = trains.part(slice(begin, begin + 25))
            for order in (1, 2, 4, 8):
                some.response(np.tile(order * speed, (25, 1)), force)

    return _timed(every)[0]


def _timed(work: Callable[[], Found]) -> tuple[float, Found]:
    """Seconds of the processor, and the answer."""
    start = process_time()
    found = work()
    return process_time() - start, found


if __name__ == "__main__":
    print("\n\n".join(responses(quick=True)))
