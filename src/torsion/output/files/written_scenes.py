"""The scene with the values that its design chose, as a file that is solved like any other."""

from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.table_text import one_line


def designed(document: Document, findings: Findings) -> str | None:
    """Its text, with what was chosen in the first lines; None where nothing was."""
    design, variation = findings.results.get("design"), findings.study.variations.get("design")
    if design is None or variation is None or not design.picked.size or document.name != "solve":
        return None
    words = [
        f"{figure.name}: {figure.chosen}" + (f", before {figure.before}" if figure.before else "")
        for figure in design.figures
    ]
    text = variation.text(design.picked.tolist(), without=["design"])
    head = [
        f"{findings.study.name}, with the values that its design chose for {design.aim}:",
        *words,
        "Paths of other files count from the folder of the model file.",
    ]
    return "".join(f"# {one_line(line)}\n" for line in head) + text


def fitted(document: Document, findings: Findings) -> str | None:
    """The text of the file; None where nothing was fitted."""
    fit = findings.results.get("fit")
    if fit is None or document.name != "solve":
        return None
    changes = "".join(
        f"# {figure.name}: {figure.given} -> {figure.fitted}\n" for figure in fit.figures
    )
    file = one_line(findings.study.shown_file)
    words = (
        f"# {file} with the figures that fit its measurements best; files that it names count from"
    )
    return f"{words}\n# the folder of that one.\n{changes}{fit.scene}"
