"""The columns of a report as CSV: comments before the titles say what it is of; numbers keep every digit."""

import csv
import io
from pkgutil import resolve_name

import numpy as np

import torsion
from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.scene import checksum
from torsion.output.table_text import inert, one_line


def csv_text(document: Document, findings: Findings) -> str | None:
    """One row a place of the axis that all columns run over; None where the report has no columns."""
    if not document.report.columns:
        return None
    columns = resolve_name(f"torsion.output.chapters.{document.report.columns}")(findings)
    study = findings.study
    target = io.StringIO()
    target.write(f"# scene: {inert(one_line(study.name))}\n")
    if study.text:
        target.write(f"# file: {inert(one_line(study.shown_file))}, SHA-256 {checksum(study)}\n")
    target.write(f"# torsion {torsion.__version__}; motion of the shaft downstream of the joint\n")
    rows = csv.writer(target, lineterminator="\n")
    rows.writerow([inert(one_line(title)) for title, _ in columns])
    rows.writerows(np.column_stack([values for _, values in columns]).tolist())
    return target.getvalue()
