"""Natural frequencies: every program's error against the references, and its time, on one case."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import ours, peers_opentorsion, references
from benchmarks.cases import Case, undamped
from benchmarks.comparison import Effort, Error, Kept, Row
from benchmarks.timing import interleaved

CHAIN = "torsion chain_frequencies"
KERNEL = "torsion tree_modes"
PLAIN = "torsion plain_modes"
LOWEST = "torsion tree_modes, lowest 20"
PUBLIC = "torsion assemble + modes"
PUBLIC_LOWEST = "torsion assemble + modes, lowest 20"
ASSEMBLY = "openTorsion Assembly"
UNDAMPED = "openTorsion undamped_modal_analysis"
DAMPED = "openTorsion modal_analysis"
ROTOR = "ROSS Rotor"
MODAL = "ROSS run_modal"
LARGEST_OF_PLAIN = 100  # stations; the time of one-sided rotations grows with the cube


def compare(damped_case: Case, effort: Effort, folder: Path) -> Row:
    """Errors and times of all frequencies, dampers left out; the peers' assembly is timed apart from their analysis."""
    case = undamped(damped_case)
    programs, frequencies = _torsion(case, folder)
    assembly = peers_opentorsion.assembled(arguments := peers_opentorsion.elements(case))
    programs[ASSEMBLY] = Kept(lambda: peers_opentorsion.assembled(arguments))
    programs[UNDAMPED] = Kept(lambda: peers_opentorsion.undamped_frequencies(assembly))
    if case.size <= effort.largest_of_damped:
        programs[DAMPED] = Kept(lambda: peers_opentorsion.damped_frequencies(assembly))
    if effort.ross and case.is_chain and case.size <= effort.largest_of_ross:
        programs |= _ross(case)
    times = interleaved(programs, effort.seconds)
    modes = _chosen(case.size - 1, effort.modes)
    few = [mode for mode in modes if mode <= ours.FEW]
    exact = references.frequencies(case, modes)
    row = Row(case.name, case.size, referenced=len(modes))
    for name, program in programs.items():
        if not program.fault:
            row.times[name] = times[name]
        if name not in (ASSEMBLY, ROTOR):
            found = frequencies.get(name, np.asarray)
            asked = few if name in (LOWEST, PUBLIC_LOWEST) else modes
            total = min(ours.FEW, case.size - 1) if asked is few else case.size - 1
            row.errors[name] = _error(program, found, asked, exact[: len(asked)], total)
    if not programs[KERNEL].fault:
        row.enclosed = _enclosed(programs[KERNEL].answer, modes, exact)
    return row


def _enclosed(answer: Any, modes: Sequence[int], exact: Sequence[Any]) -> int:
    """How many references lie in the enclosures that the kernel calls proven."""
    pairs = zip(modes, exact, strict=True)
    return sum(answer.lower[mode - 1].item() <= value <= answer.upper[mode - 1].item() for mode, value in pairs)


def _torsion(case: Case, folder: Path) -> tuple[dict[str, Kept], dict[str, Callable[[Any], np.ndarray]]]:
    """torsion's calls, and how the frequencies in rad/s are had from their answers."""
    bare = ours.tree(case)
    programs = {KERNEL: Kept(lambda: ours.modes(bare))}
    if case.size <= LARGEST_OF_PLAIN:
        programs[PLAIN] = Kept(lambda: ours.plain(bare))
    if case.is_chain:
        programs[CHAIN] = Kept(ours.frequencies_of_chain(case))
    study = Kept(lambda: ours.read(case, folder))
    study()
    programs[PUBLIC] = Kept(lambda: ours.whole_call(study.answer))
    programs[PUBLIC].fault = study.fault
    if case.size > ours.FEW:
        programs[LOWEST] = Kept(lambda: ours.modes(bare, ours.FEW))
        programs[PUBLIC_LOWEST] = Kept(lambda: ours.whole_call(study.answer, ours.FEW))
        programs[PUBLIC_LOWEST].fault = study.fault
    kernels = (KERNEL, PLAIN, LOWEST)
    return programs, dict.fromkeys(kernels, _circular) | dict.fromkeys((PUBLIC, PUBLIC_LOWEST), _from_hertz)


def _circular(answer: Any) -> np.ndarray:
    return np.asarray(answer.frequency)


def _from_hertz(answer: Any) -> np.ndarray:
    return 2 * np.pi * np.asarray(answer.frequency)


def _ross(case: Case) -> dict[str, Kept]:
    from benchmarks import peers_ross

    rotor = Kept(lambda: peers_ross.rotor(case))
    rotor()
    built = rotor.answer
    modal = Kept(lambda: peers_ross.frequencies(built))
    modal.fault = rotor.fault
    return {ROTOR: rotor, MODAL: modal}


def _chosen(total: int, limit: int) -> list[int]:
    """All modes, or the lowest and highest tenth of `limit` and the rest evenly between."""
    if total <= limit:
        return list(range(1, total + 1))
    ends = limit // 10
    between = np.linspace(ends + 1, total - ends, limit - 2 * ends).round().astype(int)
    return sorted({*range(1, ends + 1), *between.tolist(), *range(total - ends + 1, total + 1)})


def _error(
    program: Kept, found: Callable[[Any], np.ndarray], modes: Sequence[int], exact: Sequence[Any], total: int
) -> Error:
    """Worst relative error by rank; where frequencies are missing, each reference against the nearest one found."""
    if program.fault:
        return Error(fault=program.fault)
    frequency = found(program.answer)
    lost = total - len(frequency)
    if lost == 0:
        pairs = zip(modes, exact, strict=True)
        return Error(worst=max(references.relative_error(frequency[mode - 1], value) for mode, value in pairs))
    if len(frequency) == 0:
        return Error(lost=lost)
    nearest = (frequency[np.argmin(np.abs(frequency - float(value)))] for value in exact)
    errors = sorted(references.relative_error(w, value) for w, value in zip(nearest, exact, strict=True))
    return Error(worst=errors[: max(1, len(errors) - max(lost, 0))][-1], lost=lost)
