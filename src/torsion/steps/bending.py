"""Steps: the bending of the shafts of a Cardan line, and the verdicts on its stability."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from torsion.plan import Log
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.lateral.bending import Lateral
    from torsion.rules.check import Check

Progress = Callable[[str, float], None]  # (what, share done 0..1)
BENDING = "bending of the shafts"


def bending(study: Study, log: Log, progress: Progress) -> "tuple[Lateral, tuple[Check, ...]]":
    """The bending of every shaft that is held, of a study that asks it or has a support."""
    from torsion.analyses.lateral.bending import Asked, lateral
    from torsion.rules.bending import bending_checks

    asked = study.analyses.get("lateral")
    with log.step(BENDING, "a shaft has a `support`" if asked is None else "asked") as step:
        settings = asked if isinstance(asked, Asked) else None
        found = lateral(study.train, study.operation, settings, progress=progress)
        step.method, step.size = found.method, found.size
    log.left_out += [("bending, in part", remark) for remark in found.remarks]
    return found, bending_checks(found, study.operation)
