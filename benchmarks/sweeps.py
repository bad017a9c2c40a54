"""Many trains of one layout side by side, next to a loop over them: `python -m benchmarks.sweeps [--quick]`.

Writes reports/sweeps.md; `--quick` takes a fifth of the trains and prints without writing.
"""

from collections.abc import Callable
from dataclasses import replace
from time import process_time

import numpy as np

from benchmarks.cases import Case, chain, geared_tree
from benchmarks.page_file import Report, verdict
from benchmarks.papers.writing import table
from benchmarks.peers_opentorsion import assembled, elements, undamped_frequencies
from benchmarks.references import frequencies, worst
from torsion.kernels.modes.loops import graph_modes
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.modes.variant_modes import variant_modes
from torsion.kernels.modes.variant_networks import network_modes
from torsion.kernels.trees.tree import Tree

SIZES = (
    (5, 4, 20_000),
    (10, 6, 20_000),
    (20, 6, 10_000),
    (100, 6, 1_000),
)  # stations, modes, trains
MEANT = {10: 100.0, 20: 60.0, 100: 30.0}  # times openTorsion
RUNS, LOOPED, PROVEN = 3, 60, 8  # in turn; trains of a loop, and with a reference of 60 digits
SPREAD = (0.05, 0.15)  # inertias and stiffnesses, uniform
HOW = """\
Every train of a case has its own inertias (±5 %) and stiffnesses (±15 %, uniform, one seed). Side by side:
`variant_modes`, the lowest modes of all trains with the counts that prove each; a loop: `tree_modes` of torsion, and
`Assembly` with `undamped_modal_analysis` of openTorsion, which finds all modes with their shapes. Times are of the
processor in one process and one thread, the programs in turn, the smallest of the runs, per train. Errors are against
60 digits, the largest of all modes of the trains compared; "alone" are frequencies that were found train by train."""
HEAD = (
    "stations",
    "train",
    "modes",
    "side by side µs",
    "loop of torsion µs",
    "ratio",
    "openTorsion µs",
    "ratio",
    "meant",
    "error",
    "openTorsion's error",
    "alone of",
)

NETWORKS = (
    (6, 1, 4),
    (10, 1, 6),
    (10, 2, 6),
    (20, 1, 6),
)  # stations, chords, modes
OF_NETWORKS = """\
Chains with one chord from the second station to the last but one, or with one from end to end besides, varied in the
same way: `network_modes`, every mode proven by counts, next to a loop over `graph_modes`. The difference is the
largest between both; width is that of the widest bounds."""
NETWORK_HEAD = (
    "stations",
    "chords",
    "modes",
    "side by side µs",
    "one by one µs",
    "ratio",
    "difference",
    "width",
    "alone of",
)


def main() -> None:
    """Runs all cases and writes the page."""
    report, rows = Report(__doc__, "sweeps", "a fifth of the trains"), []
    for size, modes, trains in SIZES:
        for stiff in (False, True):
            for make in (chain, _tree):
                rows.append(
                    _row(
                        make(size, stiff=stiff), modes, trains // (5 if report.chosen.quick else 1)
                    )
                )
    networks = [_network_row(*case, 2000 // (5 if report.chosen.quick else 1)) for case in NETWORKS]
    page = ["## Natural frequencies", HOW, table(HEAD, rows)]
    page += ["## Closed loops", OF_NETWORKS, table(NETWORK_HEAD, networks)]
    report.publish("Many trains side by side", page)


def _tree(size: int, *, stiff: bool) -> Case:
    """A geared tree without its gears' inertias, which the loops would have to refer."""
    case = (
        geared_tree(max(size, 10), stiff=stiff) if size >= 10 else chain(size, stiff=stiff, seed=1)
    )
    return replace(case, gear=(None,) * case.size)


def _row(case: Case, modes: int, trains: int) -> tuple[str, ...]:
    rng = np.random.default_rng(1)
    inertia = np.array(case.inertia)[:, None] * rng.uniform(
        1 - SPREAD[0], 1 + SPREAD[0], (case.size, trains)
    )
    stiffness = np.array(case.stiffness)[:, None] * rng.uniform(
        1 - SPREAD[1], 1 + SPREAD[1], (case.size, trains)
    )
    tree = Tree(
        np.array(case.parent),
        np.zeros(case.size),
        np.zeros(case.size),
        np.zeros(case.size, dtype=bool),
    )
    flexibility = np.zeros_like(stiffness)
    flexibility[1:] = 1.0 / stiffness[1:]
    looped = range(min(LOOPED, trains) if case.size < 100 else 12)
    each = [
        _variant(case, inertia[:, k], 1.0 / np.where(flexibility[:, k] > 0, flexibility[:, k], 1.0))
        for k in looped
    ]
    given = [elements(one) for one in each]

    def loop() -> list[np.ndarray]:
        own = (replace(tree, flexibility=flexibility[:, k], inertia=inertia[:, k]) for k in looped)
        return [tree_modes(one, modes).frequency for one in own]

    def peer() -> list[np.ndarray]:
        return [undamped_frequencies(assembled(one))[:modes] for one in given]

    times, answers = _in_turn(lambda: variant_modes(tree, flexibility, inertia, modes), loop, peer)
    ours, alone, theirs = times[0] / trains, times[1] / len(looped), times[2] / len(looped)
    exact = [frequencies(one, range(1, modes + 1)) for one in each[:PROVEN]]
    found = answers[0].frequency
    errors = [
        max(worst(one, ref) for one, ref in zip(some, exact, strict=False))
        for some in (found.T, answers[2])
    ]
    meant = MEANT.get(case.size)
    return (
        str(case.size),
        case.name,
        str(modes),
        *(f"{1e6 * one:.3g}" for one in (ours, alone)),
        f"{alone / ours:.3g}",
        f"{1e6 * theirs:.4g}",
        f"{theirs / ours:.3g}",
        "-" if meant is None else f">= {meant:g}: {verdict(theirs / ours >= meant)}",
        *(f"{error:.1e}" for error in errors),
        f"{answers[0].alone} of {trains * modes}",
    )


def _network_row(size: int, chords: int, modes: int, trains: int) -> tuple[str, ...]:
    case, rng = chain(size, stiff=False), np.random.default_rng(1)
    tree = Tree(np.array(case.parent), *np.zeros((2, size)), np.zeros(size, dtype=bool))
    inertia = np.array(case.inertia)[:, None] * rng.uniform(
        1 - SPREAD[0], 1 + SPREAD[0], (size, trains)
    )
    softness = 1.0 / rng.uniform(1 - SPREAD[1], 1 + SPREAD[1], (size + chords, trains))
    flexibility = np.zeros_like(inertia)
    flexibility[1:] = softness[1:size] / np.array(case.stiffness)[1:, None]
    chord = softness[size:] / min(case.stiffness[1:])
    ends = np.array([1, 0][:chords], int), np.array([size - 2, size - 1][:chords], int)

    def one(k: int) -> np.ndarray:
        own = replace(tree, flexibility=flexibility[:, k], inertia=inertia[:, k])
        return graph_modes(own, *ends, chord[:, k], modes).frequency

    times, answers = _in_turn(
        lambda: network_modes(tree, flexibility, inertia, modes, ends, chord),
        lambda: np.array([one(k) for k in range(LOOPED)]).T,
    )
    ours, alone, found = times[0] / trains, times[1] / LOOPED, answers[0]
    difference = np.abs(found.frequency[:, :LOOPED] / answers[1] - 1.0).max()
    width = ((found.upper - found.lower) / found.frequency).max()
    return (
        str(size),
        str(chords),
        str(modes),
        *(f"{1e6 * took:.3g}" for took in (ours, alone)),
        f"{alone / ours:.3g}",
        f"{difference:.1e}",
        f"{width:.1e}",
        f"{found.alone} of {trains * modes}",
    )


def _variant(case: Case, inertia: np.ndarray, stiffness: np.ndarray) -> Case:
    return replace(case, inertia=tuple(inertia.tolist()), stiffness=tuple(stiffness.tolist()))


def _in_turn(*programs: Callable[[], object]) -> tuple[list[float], list]:
    """Smallest processor time of each, and its answer."""
    best, answers = [np.inf] * len(programs), [None] * len(programs)
    for _ in range(RUNS):
        for k, program in enumerate(programs):
            start = process_time()
            answers[k] = program()
            best[k] = min(best[k], process_time() - start)
    return best, answers


if __name__ == "__main__":
    main()
