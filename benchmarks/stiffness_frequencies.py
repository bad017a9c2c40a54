"""Sweeps of natural frequencies: stiffness, inertia, length, near-rigid, massless, repeated."""

from collections.abc import Callable, Iterable, Sequence
from time import perf_counter
from typing import Any

import numpy as np
from mpmath import mp

from benchmarks import dense_peers, ours, peers_opentorsion, references
from benchmarks.cases import Case
from benchmarks.extremes import Sweep
from benchmarks.references import worst
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree

TREE, PLAIN, PEER = "torsion tree_modes", "torsion plain_modes", "openTorsion"
SIZE, FEW = 10, 5
LOWEST = 10  # modes of long chains
LARGEST = {
    PEER: 1000,
    dense_peers.EIGH: 1000,
}  # spans beyond which a program of full matrices is not run


def line(
    name: str, inertia: Sequence[float], stiffness: Sequence[float], **damping: Sequence[float]
) -> Case:
    """A free chain; `stiffness` of its spans, `damping` of its discs to ground and `viscous` of its spans."""
    size = len(inertia)
    return Case(
        name,
        tuple(range(-1, size - 1)),
        tuple(inertia),
        (0.0, *stiffness),
        (None,) * size,
        tuple(damping.get("damping", (0.0,) * size)),
        (0.0, *damping.get("viscous", (0.0,) * (size - 1))),
    )


def stiffness_ratio(ratios: Sequence[float]) -> Sweep:
    """Nine springs, even in the logarithm over the ratio."""
    random = np.random.default_rng(1)
    inertia, place = (
        random.uniform(0.5, 2.0, SIZE),
        random.permutation(np.linspace(0.0, 1.0, SIZE - 1)),
    )
    trains = ((inertia, 1e4 * ratio**place) for ratio in ratios)
    what = f"of 0.5 to 2 kg m2, {SIZE - 1} springs in random order from 1e4 N m/rad up, even in the logarithm"
    return _ratio("stiffness", what, ratios, trains)


def inertia_ratio(ratios: Sequence[float]) -> Sweep:
    """Ten discs, even in the logarithm over the ratio."""
    random = np.random.default_rng(2)
    stiffness, place = (
        random.uniform(1e4, 5e4, SIZE - 1),
        random.permutation(np.linspace(0.0, 1.0, SIZE)),
    )
    trains = ((ratio**-place, stiffness) for ratio in ratios)
    what = "in random order from 1 kg m2 down, even in the logarithm, springs of 1e4 to 5e4 N m/rad"
    return _ratio("inertia", what, ratios, trains)


def _ratio(
    of: str, what: str, ratios: Sequence[float], trains: Iterable[tuple[np.ndarray, np.ndarray]]
) -> Sweep:
    sweep = Sweep(
        f"{of}_ratio",
        f"{of.capitalize()} ratio",
        f"Free chain of {SIZE} discs {what}; the largest relative error of all elastic frequencies (eigsh: of the "
        f"lowest {FEW}).",
        f"largest / smallest {of}",
    )
    for ratio, (inertia, stiffness) in zip(ratios, trains, strict=True):
        _add(sweep, ratio, line(of, inertia.tolist(), stiffness.tolist()), range(1, SIZE))
    return sweep


def near_rigid(stiffnesses: Sequence[float]) -> Sweep:
    """One spring of a benign chain grows stiff; the frequencies an engineer wants are the low ones."""
    sweep = Sweep(
        "near_rigid_frequencies",
        "Near-rigid coupling: frequencies",
        "Free chain of six discs with springs of 1e4 to 5e4 N m/rad, one of which grows; the largest relative error of "
        "the lowest three elastic frequencies.",
        "stiffness of the coupling, N m/rad",
    )
    inertia, springs = near_rigid_data()
    for stiffness in stiffnesses:
        springs[2] = stiffness
        _add(sweep, stiffness, line("near-rigid", inertia, springs), range(1, 4), few=3)
    springs[2] = 1e60
    exact = references.frequencies(line("rigid", inertia, springs), [1, 2, 3])
    flexibility = np.array([0.0, *(1 / k for k in springs)])
    flexibility[3] = 0.0
    found = tree_modes(_chain(np.array(inertia), flexibility), 3).frequency
    sweep.remarks.append(
        f"Rigid altogether (flexibility 0): torsion is {worst(found, exact):.1e} off the limit."
    )
    return sweep


def near_rigid_data() -> tuple[list[float], list[float]]:
    """Inertias (6,) and stiffnesses (5,) of the chain of the near-rigid coupling, which is span 3."""
    random = np.random.default_rng(3)
    return random.uniform(0.5, 2.0, 6).tolist(), random.uniform(1e4, 5e4, 5).tolist()


def massless(inertias: Sequence[float]) -> Sweep:
    """Two stations of a chain lose their inertia."""
    sweep = Sweep(
        "massless",
        "Massless stations",
        "Free chain of six discs, two of which lose their inertia, the others 1 kg m2, springs of 1e4 N m/rad and "
        "more; the largest relative error of the lowest three elastic frequencies.",
        "inertia of two of the stations, kg m2",
    )
    springs = [1e4, 2e4, 3e4, 1.5e4, 2.5e4]

    def case(value: float) -> Case:
        return line("massless", [1.0, value, 1.0, 1.0, value, 1.0], springs)

    for value in inertias:
        _add(sweep, value, case(value), range(1, 4), few=3)
    exact = references.frequencies(case(1e-60), [1, 2, 3])
    none = Sweep("", "", "", "")
    _add(none, 0.0, case(0.0), [], few=3, exact=exact)
    words = (f"{name} {p[0].fault or f'error {p[0].error:.1e}'}" for name, p in none.points.items())
    sweep.remarks.append("With no inertia at all: " + "; ".join(words) + ".")
    return sweep


def repeated(splits: Sequence[float]) -> tuple[Sweep, Sweep]:
    """Three branches on a hub that become equal: frequencies, and orthogonality of the shapes."""
    what = "A hub of 2 kg m2 with three equal branches, whose stiffnesses differ by the split; below 2e-16 not at all: "
    along = "relative split of the branches"
    frequency = Sweep(
        "repeated_frequencies", "Repeated frequencies", what + "error of all frequencies.", along
    )
    shape = Sweep(
        "repeated_shapes",
        "Repeated frequencies: shapes",
        what + "largest x'Jy / sqrt(x'Jx y'Jy) of two shapes x and y, which should be 0.",
        along,
    )
    zero = (0.0,) * 4
    for split in splits:
        springs = (0.0, 1e4, 1e4 * (1 + split), 1e4 * (1 - split / 2))
        case = Case("star", (-1, 0, 0, 0), (2.0, 1.0, 1.0, 1.0), springs, (None,) * 4, zero, zero)
        _add(frequency, split, case, [1, 2, 3], few=2)
        inertia = np.diag(case.inertia)
        assembly = peers_opentorsion.assembled(peers_opentorsion.elements(case))
        shape.add(
            TREE,
            split,
            lambda case=case, j=inertia: _crossing(ours.modes(ours.tree(case)).angle, j),
        )
        shape.add(
            PLAIN,
            split,
            lambda case=case, j=inertia: _crossing(ours.plain(ours.tree(case)).angle, j),
        )
        shape.add(PEER, split, lambda a=assembly: _crossing(a.undamped_modal_analysis()[1], a.M))
        shape.add(
            "scipy eigh",
            split,
            lambda case=case, j=inertia: _crossing(dense_peers.dense_modes(case)[1], j),
        )
    return frequency, shape


def length(sizes: Sequence[int]) -> Sweep:
    """Uniform free chains of many spans, in closed form."""
    sweep = Sweep(
        "length",
        "Number of spans",
        f"Uniform free chain, J = 1 kg m2, k = 1 N m/rad; the largest relative error of the lowest {LOWEST} elastic "
        "frequencies against 2 sin(j pi/(2 n)). eigsh is given the shift minus the square of the first frequency.",
        "stations",
    )
    for size in sizes:
        with mp.workdps(60):
            exact = [2 * mp.sin(j * mp.pi / (2 * size)) for j in range(1, LOWEST + 1)]
        bare = _chain(np.ones(size), np.ones(size))
        case = (
            line("uniform", (1.0,) * size, (1.0,) * (size - 1))
            if size <= max(LARGEST.values())
            else None
        )
        programs: dict[str, Callable[[], np.ndarray]] = {
            TREE: lambda bare=bare: tree_modes(bare, LOWEST).frequency,
            dense_peers.EIGSH: lambda n=size, w=exact: dense_peers.chain_frequencies(
                n, LOWEST, -(float(w[0]) ** 2)
            ),
        }
        if case is not None:
            programs[dense_peers.EIGH] = lambda case=case: dense_peers.dense_frequencies(case)[
                :LOWEST
            ]
            programs[PEER] = lambda case=case: _peer(case)[:LOWEST]
        for name, program in programs.items():
            if size > LARGEST.get(name, size):
                continue
            start = perf_counter()
            sweep.add(name, size, lambda program=program, w=exact: worst(program(), w))
            if size == sizes[-1]:
                words = f"{name} took {perf_counter() - start:.2g} s for {size} stations, errors included."
                sweep.remarks.append(words)
    return sweep


def _add(
    sweep: Sweep,
    at: float,
    case: Case,
    modes: Sequence[int],
    *,
    few: int = FEW,
    exact: list[Any] | None = None,
) -> None:
    """Every program's largest error of the modes (1 is the lowest elastic one), which are the lowest."""
    known = references.frequencies(case, modes) if exact is None else exact
    count = len(known)
    bare = ours.tree(case)
    shift = -(float(known[0]) ** 2)
    sweep.add(TREE, at, lambda: worst(ours.modes(bare).frequency[:count], known))
    sweep.add(PLAIN, at, lambda: worst(ours.plain(bare).frequency[:count], known))
    sweep.add(PEER, at, lambda: worst(_peer(case)[:count], known))
    sweep.add(
        dense_peers.EIGH, at, lambda: worst(dense_peers.dense_frequencies(case)[:count], known)
    )
    sweep.add(
        dense_peers.EIGSH,
        at,
        lambda: worst(dense_peers.sparse_frequencies(case, few, shift), known[:few]),
    )


def _peer(case: Case) -> np.ndarray:
    return peers_opentorsion.undamped_frequencies(
        peers_opentorsion.assembled(peers_opentorsion.elements(case))
    )


def _chain(inertia: np.ndarray, flexibility: np.ndarray) -> Tree:
    size = len(inertia)
    return Tree(
        np.arange(size) - 1,
        np.concatenate(([0.0], flexibility[1:])),
        inertia,
        np.zeros(size, dtype=bool),
    )


def _crossing(shape: np.ndarray, inertia: np.ndarray) -> float:
    """The largest x'Jy of shapes scaled to x'Jx = 1."""
    scaled = np.real(shape) / np.sqrt(
        np.einsum("im,ij,jm->m", np.real(shape), inertia, np.real(shape))
    )
    product = scaled.T @ inertia @ scaled
    return float(np.abs(product - np.diag(np.diag(product))).max())
