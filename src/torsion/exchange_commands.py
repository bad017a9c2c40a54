"""The commands that compare results and exchange files with other programs."""

from pathlib import Path

import typer

from torsion.command_endings import refusals, say, stop, write_new


def compare(before: Path, after: Path, *, html: Path | None = None, json: bool = False) -> None:
    """Compare two results: input, natural frequencies and checks of every case; nothing is solved.

    Exit status: 0 no change, 1 something changed, 2 a file cannot be read.

    before: results.json A, or its folder.
    after: results.json B, or its folder.
    html: Write the comparison as a page.
    json: Print the comparison as JSON.
    """
    from torsion.exchange import compare_command

    with refusals(before):
        is_changed = compare_command.compare(before, after, html, as_json=json)
    raise typer.Exit(int(is_changed))


def import_(
    file: Path | None = None,
    *,
    out: Path | None = None,
    referred: bool = False,
    template: bool = False,
) -> None:
    """Write the model file of a mass-elastic table: one mass a row, with the stiffness to the next mass.

    Exit status: 0, or 2 if the table is faulty.

    file: Mass-elastic table (.csv), or openTorsion-Editor file (.json).
    out: Model file to write (default: print it).
    referred: All values are referred to the speed of the first mass.
    template: Print a table to fill in.
    """
    from torsion.exchange.mass_elastic_table import TEMPLATE, import_table

    if template == (file is not None):
        stop("give a table, or --template for one to fill in")
    text = TEMPLATE
    if file is not None:
        with refusals(file):
            text = import_table(file, referred=referred)
    if out is None:
        typer.echo(text, nl=False)
        return
    write_new(out, text)
    say(f"{out} written; add `operation` and `rules`, then: torsion solve {out}")


def export(
    file: Path,
    *,
    out: Path,
    rpm: float | None = None,
    order: str | None = None,
    at: float | None = None,
    inputs: str = "",
    outputs: str = "",
    case: str | None = None,
) -> None:
    """Write the lumped train as a Modelica model, or as a state space for Python or MATLAB.

    Exit status: 0, or 2 if the train has no counterpart there.

    out: Train.mo (Modelica), or .npz or .mat (state space).
    rpm: Reference speed (default: the rated speed).
    order: Modelica: one order only, as 2 or 1/2.
    at: State space: Hz at which loss factors are exact.
    inputs: State space: stations with a torque, by commas.
    outputs: State space: stations with a speed, by commas.
    case: One case of the file.
    """
    from torsion.exchange.export_command import export as write

    with refusals(file):
        say(
            write(file, out, rpm=rpm, order=order, at=at, inputs=inputs, outputs=outputs, case=case)
        )
