"""The scene with its fitted figures, as a file to solve."""

from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.table_text import one_line
from torsion.what_if.fit.fit_results import Fit


def fitted(document: Document, findings: Findings) -> str | None:
    """The text of the file; None where nothing was fitted."""
    fit = findings.get(Fit)
    if fit is None or document.report.keys:
        return None
    changes = "".join(
        f"# {figure.name}: {figure.given} -> {figure.fitted}\n" for figure in fit.figures
    )
    file = one_line(findings.study.shown_file)
    words = (
        f"# {file} with the figures that fit its measurements best; files that it names count from"
    )
    return f"{words}\n# the folder of that one.\n{changes}{fit.scene}"
