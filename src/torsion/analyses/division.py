"""Shafts divided finely enough for what is asked: the highest frequency of the response, and the modes."""

import math
from collections.abc import Callable

from torsion.analyses.modes import Modes, modes, undamped_tree
from torsion.analyses.requests import has_inertia, highest_excited, modes_settings
from torsion.assembly import assemble
from torsion.assembly.shafts import phase
from torsion.assembly.system import System
from torsion.findings import Work
from torsion.study import Study

LARGEST_ESTIMATE = 0.1  # relative error; the estimate holds for small ones
ROUNDS = 6  # of dividing the shafts more finely until the highest frequency asked for stays put
REACHING = 40  # times that shafts are divided more finely until the modes asked for lie in reach of their counts


def assembled(study: Study, frequency: float = 0.0) -> System:
    """The system of a study in its model, for a highest frequency (Hz)."""
    return assemble(study.train, study.model, frequency=frequency, degree=study.fem.degree, elements=study.fem.elements)


def divided_modes(
    study: Study, system: System, highest: float, count: int, *, progress: Callable[[int, int], None] | None = None
) -> tuple[System, Modes]:
    """The lowest `count` modes, and the train divided finely enough for them and for `highest` (Hz).

    system: the train divided for `highest`. progress: as of `modes`.
    """
    system = _for_bars(study, system, highest, count)
    found = modes(system, count, progress=progress)
    system, found = _with_all(study, system, found, count)
    for _ in range(ROUNDS):
        top = max(highest, float(found.frequency[-1]) if found.frequency.size else 0.0)
        finer = assembled(study, top)
        if _division(finer) == _division(system):
            return (system if system.bars is None else finer), found
        if system.bars is not None and _is_enough(system, finer):
            break
        system = finer
        found = modes(system, count, progress=progress)
    return system, found


def _with_all(study: Study, system: System, found: Modes, count: int) -> tuple[System, Modes]:
    """Lumped shafts in more segments until the train has as many modes as are asked, as far as the settings allow."""
    frequency = 0.0
    while system.bars is None and found.frequency.size < count:
        half_waves = [math.pi / phase(bar, 1.0) for bar in study.train.bars if bar.density > 0 and bar.segments is None]
        if not half_waves:
            break
        frequency = max(2.0 * frequency, min(half_waves))
        finer = assembled(study, frequency)
        if _division(finer) != _division(system):
            system, found = finer, modes(finer, count)
    return system, found


def _for_bars(study: Study, system: System, highest: float, count: int) -> System:
    """The train divided for the last of `count` modes, which counts find beforehand, as far as the settings allow."""
    for _ in range(REACHING):
        bars = system.folded_bars
        if bars is None or not math.isfinite(bars.limit):
            break
        from torsion.analyses.bars import above_mode, reach

        tree = undamped_tree(system.folded)
        known = reach(tree, bars)
        if known.count >= count:
            return assembled(study, max(highest, above_mode(tree, bars, count) / (2.0 * math.pi)))
        finer = assembled(study, known.frequency / (2.0 * math.pi))
        if _division(finer) == _division(system):
            break
        system = finer
    return system


def _is_enough(system: System, asked: System) -> bool:
    """No shaft is asked to have more pieces than it has, nor elements of a higher degree."""
    (pieces, degree), (needed, least) = _division(system), _division(asked)
    return degree >= least and all(pieces[name] >= number for name, number in needed.items())


def _division(system: System) -> tuple[dict[str, int], int]:
    return system.segments, 0 if system.bars is None else system.bars.degree


def told_model(system: System) -> str:
    """The model and how its shafts are treated, in words."""
    words = {
        "lumped": "lumped, kept in factors",
        "exact": "exact: shafts as continua, no error of division",
    }
    if system.model != "fem" or system.bars is None:
        return words.get(system.model, system.model)
    return f"fem: elements of degree {system.bars.degree}, consistent inertia (scikit-fem)"


def told_method(system: System, found: Modes) -> str:
    """How the modes were found, in words."""
    if system.bars is not None and not found.certified:
        return "dense problem of all unknowns, not certified: the elements are too few for counts"
    return "tree elimination in mixed form, certified by Sturm counts"


def told_division(system: System) -> str:
    """How many pieces every shaft has, in words."""
    if not system.segments:
        return "no distributed shaft"
    what = {"lumped": "segments", "fem": "elements", "exact": "pieces"}[system.model]
    numbers = ", ".join(f"{name} {number}" for name, number in system.segments.items())
    error = system.bars.error if system.bars is not None else 0.0
    if error > LARGEST_ESTIMATE:
        return f"{what}: {numbers}; too few for an estimate of their error"
    return f"{what}: {numbers}" + (f"; estimated error of the highest frequency {error:.1g}" if error else "")


def run_assembly(work: Work) -> None:
    """The train divided finely enough for the highest frequency of the response that is requested."""
    with work.log.step("assembly", "everything stands on it") as step:
        system = assembled(work.study)
        highest = highest_excited(work.study, system, work.ruled)
        if highest:
            system = assembled(work.study, highest)
        step.method = told_model(system)
        step.size = _size(system)
    work.put(system=system)
    if system.bars is not None and system.bars.degree:
        work.log.libraries["scikit-fem"] = None


def run_modes(work: Work) -> None:
    """The modes, where they are requested, and the train divided finely enough for them."""
    study, system, settings = work.study, work.system, modes_settings(work.study, work.ruled)
    if not has_inertia(system):
        work.log.without("natural frequencies", "no component has an inertia")
        return
    if settings is None:
        work.log.without("natural frequencies", "`analyses` does not name modes")
        return
    with work.log.step("natural frequencies", "asked" if "modes" in study.analyses else "the default") as step:
        system, found = divided_modes(
            study, system, highest_excited(study, system, work.ruled), settings.count,
            progress=lambda done, of: work.progress("natural frequencies", done / of),
        )  # fmt: skip
        step.method = told_method(system, found)
        step.size = f"{found.frequency.size} of {_size(system)}; {told_division(system)}"
    work.put(system=system, modes=found)


def _size(system: System) -> str:
    return f"{len(system.stations)} stations, {len(system.spans)} spans"
