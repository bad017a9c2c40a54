"""Every form of a report in one registry: what renders it, and the file that it is written to."""

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.document import Document

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

    def __call__(self, document: Document, *findings: Findings) -> Any:
        """The document in this form: text, bytes, or what the terminal prints."""
        return resolve_name(self.render)(document, *findings)


OUTPUTS = {
    "json": Output("torsion.output.results_json:rendered", ".json", of_findings=True),
    "html": Output("torsion.output.html:html", ".html"),
    "csv": Output("torsion.output.csv_table:csv_text", ".csv", of_findings=True),
    "motion": Output("torsion.output.motion_files:motion", ".npz", of_findings=True),
    "fitted": Output("torsion.output.fitted_scene:fitted", "-fitted.yaml", of_findings=True),
    "designed": Output("torsion.output.designed_scene:designed", ".yaml", of_findings=True),
    "pdf": Output("torsion.output.pdf:pdf", ".pdf", on_request=True),
    "vtu": Output("torsion.output.mode_lines:vtu", ".vtu", on_request=True, of_findings=True),
    "figures": Output("torsion.output.figure_csv:tables", "-figures.csv", on_request=True),
    "tables": Output("torsion.output.table_files:archive", ".zip", on_request=True),
    "data": Output(
        "torsion.output.data_tables:archive", "-data.zip", on_request=True, of_findings=True
    ),
    "xlsx": Output(
        "torsion.output.data_tables:workbook", ".xlsx", on_request=True, of_findings=True
    ),
    "long": Output("torsion.output.renderers:beside", "-table.csv"),
    "terminal": Output("torsion.output.terminal:screen"),
}


def beside(document: Document) -> Callable[[Path], list[Path]] | None:
    """What writes the files with all that is too long for the page; None where nothing is."""

    def written(target: Path) -> list[Path]:
        made = [target.with_name(name) for name in document.beside]
        for path, text in zip(made, document.beside.values(), strict=True):
            path.write_text(text(), encoding="utf-8")
        return made

    return written if document.beside else None


def files(
    document: Document,
    findings: Findings | None = None,
    also: Collection[str] = (),
    faults: list[Fault] | None = None,
    without: Collection[str] = (),
) -> dict[str, Content]:
    """Name and content of every file of a report, `also` of the outputs on request and not of those `without`.

    Without the findings: of every file that the document alone makes. An output on request that cannot be made is noted
    in `faults`, where they are given.
    """
    found = {}
    for name, output in OUTPUTS.items():
        is_made = output.suffix and name not in without and (not output.on_request or name in also)
        if is_made and not (output.of_findings and findings is None):
            try:
                content = output(document, *([findings] if output.of_findings and findings else []))
            except InputError as error:
                if faults is None or not output.on_request:
                    raise
                faults += [
                    replace(one, message=f"the {name} cannot be made: {one.message}")
                    for one in error.faults
                ]
                continue
            if content is not None:
                found[document.report.files.get(name, document.report.stem + output.suffix)] = (
                    content
                )
    return found
