"""Natural frequencies: every program's error against the references, and its time, on one case."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import torsion
from benchmarks import ours, peers_opentorsion, references
from benchmarks.cases import Case, undamped
from benchmarks.programs import Effort, Row, measure, program
from torsion.analyses.compare.timing import Candidate

CHAIN = "torsion chain_frequencies"
KERNEL = "torsion tree_modes"
PLAIN = "torsion plain_modes"
LOWEST = "torsion tree_modes, lowest 20"
PUBLIC = "torsion assemble + modes"
PUBLIC_LOWEST = "torsion assemble + modes, lowest 20"
UNDAMPED = "openTorsion undamped_modal_analysis"
DAMPED = "openTorsion modal_analysis"
MODAL = "ROSS run_modal"
LARGEST_OF_PLAIN = 100  # stations; the time of one-sided rotations grows with the cube


def compare(damped_case: Case, effort: Effort, folder: Path) -> Row:
    """Errors and times of all frequencies, dampers omitted; the peers' assembly is timed apart from their analysis."""
    case = undamped(damped_case)
    modes = _chosen(case.size - 1, effort.modes)
    exact = references.frequencies(case, modes)
    row = Row(case.name, case.size, referenced=len(modes))

    def errors(answer: Any, name: str, few: int | None, factor: float = 1.0) -> tuple[float, ...]:
        found = answer if isinstance(answer, np.ndarray) else factor * np.asarray(answer.frequency)
        requested = [mode for mode in modes if few is None or mode <= few]
        total = case.size - 1 if few is None else min(few, case.size - 1)
        if name == KERNEL:
            row.enclosed = _enclosed(answer, modes, exact)
        row.lost[name] = total - len(found)
        return (_worst(found, requested, exact[: len(requested)], row.lost[name]),)

    def of(
        name: str,
        solve: Callable[[Any], Any],
        assemble: Callable[[], Any] = lambda: None,
        **how: Any,
    ) -> Candidate:
        return program(name, solve, partial(errors, name=name, **{"few": None, **how}), assemble)

    bare, arguments = ours.tree(case), peers_opentorsion.elements(case)
    programs = [of(KERNEL, lambda _: ours.modes(bare), few=None)]
    if case.size <= LARGEST_OF_PLAIN:
        programs.append(of(PLAIN, lambda _: ours.plain(bare)))
    if case.is_chain:
        chain = ours.frequencies_of_chain(case)
        programs.append(of(CHAIN, lambda _: chain()))
    train = ours.read(case, folder).train
    whole = partial(of, assemble=lambda: torsion.assemble(train, model="lumped"), factor=2 * np.pi)
    programs.append(whole(PUBLIC, lambda system: torsion.modes(system, count=None)))
    if case.size > ours.FEW:
        programs.append(of(LOWEST, lambda _: ours.modes(bare, ours.FEW), few=ours.FEW))
        programs.append(
            whole(PUBLIC_LOWEST, lambda system: torsion.modes(system, count=ours.FEW), few=ours.FEW)
        )
    peer = partial(of, assemble=lambda: peers_opentorsion.assembled(arguments))
    programs.append(peer(UNDAMPED, peers_opentorsion.undamped_frequencies))
    if case.size <= effort.largest_of_damped:
        programs.append(peer(DAMPED, peers_opentorsion.damped_frequencies))
    if effort.ross and case.is_chain and case.size <= effort.largest_of_ross:
        from benchmarks import peers_ross

        programs.append(of(MODAL, peers_ross.frequencies, lambda: peers_ross.rotor(case)))
    return measure(row, programs, effort.seconds)


def _enclosed(answer: Any, modes: Sequence[int], exact: Sequence[Any]) -> int:
    """How many references lie in the enclosures that the kernel calls proven."""
    pairs = zip(modes, exact, strict=True)
    return sum(
        answer.lower[mode - 1].item() <= value <= answer.upper[mode - 1].item()
        for mode, value in pairs
    )


def _chosen(total: int, limit: int) -> list[int]:
    """All modes, or the lowest and highest tenth of `limit` and the rest evenly between."""
    if total <= limit:
        return list(range(1, total + 1))
    ends = limit // 10
    between = np.linspace(ends + 1, total - ends, limit - 2 * ends).round().astype(int)
    return sorted({*range(1, ends + 1), *between.tolist(), *range(total - ends + 1, total + 1)})


def _worst(found: np.ndarray, modes: Sequence[int], exact: Sequence[Any], lost: int) -> float:
    """Worst relative error by rank; where frequencies are missing, each reference against the nearest one found."""
    if lost == 0:
        return references.worst(found[[mode - 1 for mode in modes]], exact)
    if len(found) == 0:
        return float("nan")
    nearest = (found[np.argmin(np.abs(found - float(value)))] for value in exact)
    errors = sorted(references.worst([w], [value]) for w, value in zip(nearest, exact, strict=True))
    return errors[: max(1, len(errors) - max(lost, 0))][-1]
