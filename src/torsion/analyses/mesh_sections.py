"""The cross-sections by mesh, solved before the train is assembled with them."""

from torsion.assembly.section.solved_sections import section_results
from torsion.findings import Work


def run(work: Work) -> None:
    """Solve every one; the assembly reads what is found."""
    with work.log.step("cross-sections", "a shaft has a `section`") as step:
        found = section_results(work.study.train)
        step.method = "stress function and warping by finite elements, on refined meshes"
        step.size = "; ".join(f"{name}: {one.words}" for name, one in found.items())
