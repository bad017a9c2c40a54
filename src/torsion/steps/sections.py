"""Step: the cross-sections by mesh."""

from torsion.assembly.section.resolved import section_results
from torsion.plan import Log
from torsion.study import Study


def sections(study: Study, log: Log) -> None:
    """Solve the cross-sections by mesh, before the train is assembled with them."""
    if any(bar.section is not None for bar in study.train.bars):
        with log.step("cross-sections", "a shaft has a `section`") as step:
            found = section_results(study.train)
            step.method = "stress function and warping by finite elements, on refined meshes"
            step.size = "; ".join(f"{name}: {one.words}" for name, one in found.items())
