"""The discretisation of a study: what it requests, its system for a highest frequency, and what the plan says of it."""

import math

import numpy as np

from torsion.analyses.undamped_modes import (
    Ruled,
    chord_spans,
    modes,
    modes_settings,
)
from torsion.assembly import assemble
from torsion.assembly.section.solved_sections import section_results
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.results import listed
from torsion.study import Study

LARGEST_ESTIMATE = 0.1  # relative error; the estimate holds for small ones


def highest_excited(study: Study, system: System, ruled: Ruled) -> float:
    """Return the highest frequency (Hz) of the response that is requested; 0 where none is."""
    if not response_is_requested(study, ruled):
        return 0.0
    from torsion.analyses.response.harmonic_components import excitations

    frequencies = getattr(study.analyses.get("response"), "frequencies", None)
    highest = frequencies.last if frequencies is not None else 0.0
    speeds = study.operation.speeds
    for excitation in excitations(system):
        if excitation.line.frequency is not None:
            highest = max(highest, excitation.line.frequency)
        elif excitation.line.order is not None and speeds is not None:
            highest = max(highest, float(excitation.line.order) * speeds.last / (2.0 * math.pi))
    return float(highest)


def response_is_requested(study: Study, ruled: Ruled) -> bool:
    """Return whether the file names a response, a rule reads it, or something excites and no analysis is named."""
    is_excited = study.excites or bool(study.train.torques)
    return "response" in {*study.analyses, *ruled} or (is_excited and not study.analyses)


def no_response(study: Study, system: System, ruled: Ruled) -> str:
    """Return why there is no response over speed; empty where there is one."""
    if not study.excites:
        return "nothing excites"
    if not response_is_requested(study, ruled):
        return "it is not requested"
    if not has_inertia(system):
        return "no component has an inertia"
    return "" if study.operation.speeds is not None else "`operation` has no speeds"


def no_mean_torque(study: Study, system: System, ruled: Ruled) -> str:
    """Return why no mean torque is known; empty where one is."""
    if study.has_mean_torque:
        return ""
    return "the file states neither the power of the loads nor a table of the load"


def no_damped_modes(study: Study, system: System, ruled: Ruled) -> str:
    """Return why modes that are requested are undamped, by the train alone; empty where something damps."""
    settings = modes_settings(study, ruled)
    is_requested = settings is not None and settings.damped is not False
    return "nothing in the train damps" if is_requested and not system.damps else ""


def has_inertia(system: System) -> bool:
    """Return whether anything in the system can vibrate."""
    is_heavy = np.isfinite(system.inertia) & (system.inertia > 0)
    return system.train.has_shafts or bool(is_heavy.any())


def assembled(study: Study, frequency: float = 0.0, excited: float = 0.0) -> System:
    """Return the system of a study in its model, for a highest frequency (Hz) and that of its response."""
    return assemble(
        study.train,
        study.model,
        frequency=frequency,
        degree=study.fem.degree,
        elements=study.fem.elements,
        excited=excited,
    )


def discretisation_words(system: System) -> str:
    """Return in words how many pieces every shaft has."""
    if not system.segments:
        return "no distributed shaft"
    what = {"lumped": "segments", "fem": "elements", "exact": "pieces"}[system.model]
    numbers = listed([f"{name} {number}" for name, number in system.segments.items()])
    error = system.bars.error if system.bars is not None else 0.0
    estimate = f"; estimated error of the highest frequency {error:.1g}" if error else ""
    if error > LARGEST_ESTIMATE:
        estimate = "; too few for an estimate of their error"
    return f"{what}: {numbers}{estimate}"


def run_assembly(work: Work) -> None:
    """Put the train divided finely enough for the highest frequency of the response that is requested."""
    with work.log.step("assembly", "everything stands on it") as step:
        system = assembled(work.study)
        highest = highest_excited(work.study, system, work.ruled)
        if highest:
            system = assembled(work.study, highest, highest)
        degree = 0 if system.bars is None else system.bars.degree
        step.method = {
            "lumped": "lumped, kept in factors",
            "exact": "exact: shafts as continua, no error of discretisation",
            "fem": "fem"
            + (f": elements of degree {degree}, consistent inertia (scikit-fem)" if degree else ""),
        }[system.model]
        step.size = f"{len(system.stations)} stations, {len(system.spans)} spans"
    _ = system.condensed  # raises where the train as a whole is at fault: a loop of rigid links
    # Rings of dampers and pendulums close no loop.
    parts = system.train.parts
    links = [span for span in system.tables if not parts[system.spans[span].part].is_point]
    if links and system.condensed.extra.size:
        from torsion.analyses.modes.coupling_tables import HINT
        from torsion.assembly.tabled_spans import table_path

        message = "a train with closed loops, or grounded through rigid spans at several points, does not support a table"
        raise InputError([Fault(table_path(system, min(links)), message, HINT)])
    for part in work.study.train.parts:
        if part.ratings is not None and part.ratings.tolerance and not work.study.varies_tolerances:
            why = f"its {100 * part.ratings.tolerance:.3g} % change only the frequencies"
            why += "; other results use the nominal stiffness"
            if work.study.case is None:
                why += " (`cases: {from: tolerances}` varies them)"
            work.log.without(f"the tolerance of '{part.name}'", why)
    for what, why in work.study.train.taken_as_linear:
        work.log.without(what, why)
    if work.study.train.has_tables_over("mean torque") and "transient" in work.study.analyses:
        why = "the coupling has there the stiffness of the rated, else of the highest speed"
        work.log.without("the stiffness over mean torque in transient responses", why)
    work.put(system=system)
    if degree:
        work.log.libraries["scikit-fem"] = None


def run_modes(work: Work) -> None:
    """Put the modes, where they are requested, and the train divided finely enough for them."""
    study = work.study
    system = work.system
    settings = modes_settings(work.study, work.ruled)
    if not has_inertia(system):
        work.log.without("natural frequencies", "no component has an inertia")
        return
    if settings is None:
        work.log.without("natural frequencies", "`analyses` does not name modes")
        return
    with work.log.step(
        "natural frequencies", "requested" if "modes" in study.analyses else "the default"
    ) as step:
        result = modes(system, settings.count)
        system = result.system
        step.method = "tree elimination in mixed form, certified by Sturm counts"
        if chord_spans(system).size:
            step.method = "closed loops: Jacobi rotations of a factor without differences, "
            step.method += (
                "certified by counts" if result.certified else "with the error bound of the method"
            )
        if tables := system.tables_over("frequency"):
            steepest = max(table.steepest for table in tables.values())
            step.method += f"; by table one root a mode, as d ln k/d ln ω = {steepest:.3g} < 2"
            from torsion.assembly.tabled_spans import reach

            if not all(table.holds for table in tables.values()):
                end = reach(system)[1] / (2.0 * math.pi)
                work.log.without(
                    f"modes above {end:.6g} Hz",
                    "the table of a coupling ends there; `beyond: hold`",
                )
        if system.bars is not None and not result.certified:
            step.method = (
                "dense problem of all unknowns, not certified: the elements are too few for counts"
            )
        size = f"{len(system.stations)} stations, {len(system.spans)} spans"
        step.size = f"{result.frequency.size} of {size}; {discretisation_words(system)}"
    work.put(system=system, modes=result)


def run_sections(work: Work) -> None:
    """Solve every meshed cross-section, whose results the assembly reads."""
    with work.log.step("cross-sections", "a shaft has a `section`") as step:
        sections = section_results(work.study.train)
        step.method = "stress function and warping by finite elements, on refined meshes"
        step.size = "; ".join(f"{name}: {section.words}" for name, section in sections.items())
