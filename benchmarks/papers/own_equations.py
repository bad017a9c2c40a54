"""Pages whose numbers come from equations of their own, as no train file can say what the paper computes."""

from dataclasses import dataclass

from benchmarks.papers.writing import Page


@dataclass(frozen=True)
class PageOfEquations(Page):
    """A page that names the modules it is computed by in place of a scene."""

    computed_by: str = ""
    tested_by: str = ""

    def text(self) -> str:
        """Markdown."""
        scene, test = f"from `shafting_specs/papers/{self.name}.yaml`", f"`tests/papers/test_{self.name}.py`"
        return (
            super().text().replace(scene, f"with {self.computed_by}").replace(test, f"`tests/papers/{self.tested_by}`")
        )
