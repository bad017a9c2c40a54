"""The commands that compare results and exchange files with other programs."""

from pathlib import Path
from typing import Annotated

import typer

from torsion.command_endings import refusals


def compare(
    before: Annotated[Path, typer.Argument(help="results.json A, or its folder.", show_default=False)],
    after: Annotated[Path, typer.Argument(help="results.json B, or its folder.", show_default=False)],
    html: Annotated[Path | None, typer.Option("--html", help="Write the comparison as a page.")] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the comparison as JSON.")] = False,
) -> None:
    """Compare two results: input, natural frequencies and checks of every case; nothing is solved.

    Exit status: 0 no change, 1 something changed, 2 a file cannot be read.
    """
    from torsion.exchange import compare_command

    with refusals(before):
        is_changed = compare_command.compare(before, after, html, as_json=json)
    raise typer.Exit(int(is_changed))
