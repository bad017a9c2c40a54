"""The discretisation of a study: its system for a highest frequency, and what the plan says of it."""

from torsion.analyses.modes import Modes
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.study import Study

LARGEST_ESTIMATE = 0.1  # relative error; the estimate holds for small ones


def assembled(study: Study, frequency: float = 0.0) -> System:
    """The system of a study in its model, for a highest frequency (Hz)."""
    return assemble(study.train, study.model, frequency=frequency, degree=study.fem.degree, elements=study.fem.elements)


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
