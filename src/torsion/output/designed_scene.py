"""The scene with the values that its design chose, as a file that is solved like any other."""

from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.table_text import one_line
from torsion.schema.scene_tables import with_tables
from torsion.schema.yaml_source import parse_source
from torsion.what_if.design.design_results import Design


def designed(document: Document, findings: Findings) -> str | None:
    """Its text, with what was chosen in the first lines; None where nothing was."""
    design, variation = findings.get(Design), findings.study.variations.get("design")
    if design is None or variation is None or not design.picked.size or document.report.keys:
        return None
    words = [
        f"{figure.name}: {figure.chosen}" + (f", before {figure.before}" if figure.before else "")
        for figure in design.figures
    ]
    text = variation.text(design.picked.tolist(), without=["design"])
    head = [
        f"{findings.study.name}, with the values that its design chose for {design.aim}:",
        *words,
    ]
    if _names_files(findings, text):
        head.append("It refers to other files: put it into the folder of the model file.")
    return "".join(f"# {one_line(line)}\n" for line in head) + text


def _names_files(findings: Findings, text: str) -> bool:
    """Whether the text names a table, a mesh or another file that the scene was read from."""
    from torsion.output.write import inputs

    study = findings.study
    tables = dict(study.tables)
    still = with_tables(parse_source(text, study.file), tables).tables
    return len(inputs(study)) > len(tables) - len(still) + bool(study.file)
