"""What the exact equations of motion do not take: told as faults of the file where they are asked for."""

from torsion.errors import Fault, Path
from torsion.study import Study

SPEEDS = "`speeds: {from: 300 rpm, to: 1800 rpm}`, here or in `operation`"


def motion_faults(study: Study, path: Path) -> list[Fault]:
    """Why a train has no exact motion: its model of shafts, or its closed loops; at the place that asks for it."""
    if study.model != "lumped" and any(bar.density > 0 for bar in study.train.bars):
        message = f"the exact motion of joints is built for the model lumped, and this is {study.model}"
        return [Fault(path, message, "model: lumped")]
    if any(part.path and part.path[0] == "links" for part in study.train.parts):
        return [
            Fault(path, "the exact motion of joints takes no closed loops, and `links` closes one", "leave one out")
        ]
    return []


def asked_faults(study: Study) -> list[Fault]:
    """Faults of a file that asks for the exact response or for stability."""
    found: list[Fault] = []
    if getattr(study.analyses.get("response"), "method", None) == "harmonic-balance":
        found += motion_faults(study, ("analyses", "response", "method"))
    asked = study.analyses.get("stability")
    if asked is None:
        return found
    path: Path = ("analyses", "stability")
    if all(part.component.keyword != "joint" for part in study.train.parts):
        hint = "leave it out; what damps, the damped modes tell"
        found.append(Fault(path, "the train has no joint, and without one nothing grows", hint))
    if getattr(asked, "speeds", None) is None and study.operation.speeds is None:
        found.append(Fault(path, "stability needs speeds", SPEEDS))
    return [*found, *motion_faults(study, path)]
