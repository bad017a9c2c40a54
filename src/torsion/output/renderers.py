"""Every form of a report in one registry: what renders it, and the file that it is written to."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from torsion.output.document import Document

Content = str | bytes | Callable[[Path], list[Path]]  # or what writes it into a file, and others beside it


@dataclass(frozen=True)
class Output:
    """A form of a report, rendered by `module:function` of a document; None where the document has nothing for it."""

    render: str
    suffix: str = ""  # of its file; "" for what is printed
    on_request: bool = False  # written where it is requested by its name

    def __call__(self, document: Document) -> Any:
        """The document in this form: text, bytes, or what the terminal prints."""
        return resolve_name(self.render)(document)


OUTPUTS = {
    "json": Output("torsion.output.results_json:rendered", ".json"),
    "html": Output("torsion.output.html:html", ".html"),
    "csv": Output("torsion.output.csv_table:csv_text", ".csv"),
    "motion": Output("torsion.output.motion_files:motion", ".npz"),
    "pdf": Output("torsion.output.pdf:pdf", ".pdf", on_request=True),
    "vtu": Output("torsion.output.surface.vtu:vtu", ".vtu", on_request=True),
    "figures": Output("torsion.output.figure_csv:tables", "-figures.csv", on_request=True),
    "tables": Output("torsion.output.table_files:archive", ".zip", on_request=True),
    "terminal": Output("torsion.output.terminal:screen"),
}


def files(document: Document, also: Collection[str] = (), without: Collection[str] = ()) -> dict[str, Content]:
    """Name and content of every file of a report, `also` of the outputs on request and not of those `without`."""
    found = {}
    for name, output in OUTPUTS.items():
        if output.suffix and name not in without and (not output.on_request or name in also):
            content = output(document)
            if content is not None:
                found[document.report.files.get(name, document.report.stem + output.suffix)] = content
    return found
