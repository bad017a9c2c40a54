"""Every form of a report in one registry: what renders it, and the file that it is written to."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.document import Document
from torsion.output.reports import Report
from torsion.output.table_text import write_beside

Content = (
    str | bytes | Callable[[Path], list[Path]]
)  # or what writes it into a file, and others beside it


@dataclass(frozen=True)
class Output:
    """A form of a report, rendered by `module:function` of a document; None where there is nothing for it."""

    render: str
    suffix: str = ""  # of its file; "" for what is printed
    on_request: bool = False  # written where it is requested by its name
    of_findings: bool = False  # rendered of a document and the findings that it reports

    def __call__(self, document: Document, findings: Findings | None = None) -> Any:
        """Return the document in this form: text, bytes, or what the terminal prints."""
        render = resolve_name(self.render)
        return render(document, findings) if self.of_findings else render(document)

    def file_of(self, name: str, report: Report) -> str:
        """Return the name of its file in the folder of a report."""
        return report.files.get(name, report.stem + self.suffix)


_of_findings = partial(Output, of_findings=True)
OUTPUTS = {
    "json": _of_findings("torsion.output.stored.stored_report:rendered", ".json"),
    "html": Output("torsion.output.pages.html:html", ".html"),
    "csv": _of_findings("torsion.output.files.data_tables:report_columns", ".csv"),
    "motion": _of_findings("torsion.output.files.motion_files:motion", ".npz"),
    "fitted": _of_findings("torsion.output.files.written_scenes:fitted", "-fitted.yaml"),
    "designed": _of_findings("torsion.output.files.written_scenes:designed", ".yaml"),
    "pdf": Output("torsion.output.pages.pdf:pdf", ".pdf", on_request=True),
    "vtu": _of_findings("torsion.output.files.mode_lines:vtu", ".vtu", on_request=True),
    "figures": Output("torsion.output.report_figures:tables", "-figures.csv", on_request=True),
    "tables": Output("torsion.output.files.data_tables:report_tables", ".zip", on_request=True),
    "data": _of_findings("torsion.output.files.data_tables:archive", "-data.zip", on_request=True),
    "xlsx": _of_findings("torsion.output.files.data_tables:workbook", ".xlsx", on_request=True),
    "long": Output("torsion.output.renderers:long_blocks", "-table.csv"),
    "terminal": Output("torsion.output.pages.terminal:screen"),
}


def long_blocks(document: Document) -> Callable[[Path], list[Path]] | None:
    """Return a writer of the files with all that is too long for the page; None if nothing is."""
    return partial(write_beside, document.beside) if document.beside else None


def files(
    document: Document,
    findings: Findings | None = None,
    also: Collection[str] = (),
    faults: list[Fault] | None = None,
    without: Collection[str] = (),
) -> dict[str, Content]:
    """Return name and content of every file of a report, `also` of the outputs on request and not of those `without`.

    Without the findings: of every file that the document alone makes. An output on request that cannot be made is noted
    in `faults`, if they are given.
    """
    contents = {}
    for name, output in OUTPUTS.items():
        is_requested = (
            output.suffix and name not in without and (not output.on_request or name in also)
        )
        if not is_requested or (output.of_findings and findings is None):
            continue
        try:
            content = output(document, findings)
        except InputError as error:
            if faults is None or not output.on_request:
                raise
            faults += [
                replace(fault, message=f"the {name} cannot be made: {fault.message}")
                for fault in error.faults
            ]
            continue
        if content is not None:
            contents[output.file_of(name, document.report)] = content
    return contents
