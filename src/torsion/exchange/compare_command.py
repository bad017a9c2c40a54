"""The command `torsion compare`."""

import json
from pathlib import Path

from torsion.errors import printable, refusal
from torsion.exchange.comparison import compare_results, read_results
from torsion.exchange.comparison_page import comparison_data, comparison_document
from torsion.lasting_output import say
from torsion.output.html import html as render_page
from torsion.output.terminal import show


def compare(before: Path, after: Path, page: Path | None = None, *, as_json: bool = False) -> bool:
    """Print the comparison of two results and write its page; return whether something changed.

    Raises InputError if a file cannot be read or the page cannot be written.
    """
    comparison = compare_results(read_results(before), read_results(after))
    document = comparison_document(comparison)
    if as_json:
        say(json.dumps(comparison_data(comparison), indent=2, ensure_ascii=False))
    else:
        show(document)
    if page is not None:
        try:
            page.write_text(render_page(document), encoding="utf-8")
        except OSError as error:
            raise refusal(f"{printable(str(page))} cannot be written: {error.strerror}") from None
        if not as_json:
            say(f"Comparison: {printable(str(page))}")
    return comparison.is_changed
