"""The commands that compare results and exchange files with other programs."""

from pathlib import Path
from typing import Annotated

import typer

from torsion.command_endings import refusals, stop, write_new
from torsion.lasting_output import say


def compare(
    before: Annotated[
        Path, typer.Argument(help="results.json A, or its folder.", show_default=False)
    ],
    after: Annotated[
        Path, typer.Argument(help="results.json B, or its folder.", show_default=False)
    ],
    html: Annotated[
        Path | None, typer.Option("--html", help="Write the comparison as a page.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the comparison as JSON.")] = False,
) -> None:
    """Compare two results: input, natural frequencies and checks of every case; nothing is solved.

    Exit status: 0 no change, 1 something changed, 2 a file cannot be read.
    """
    from torsion.exchange import compare_command

    with refusals(before):
        is_changed = compare_command.compare(before, after, html, as_json=json)
    raise typer.Exit(int(is_changed))


def import_(
    file: Annotated[
        Path | None,
        typer.Argument(help="Mass-elastic table (.csv), or openTorsion-Editor file (.json)."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Model file to write (default: print it).")
    ] = None,
    referred: Annotated[
        bool,
        typer.Option("--referred", help="All values are referred to the speed of the first mass."),
    ] = False,
    template: Annotated[bool, typer.Option("--template", help="Print a table to fill in.")] = False,
) -> None:
    """Write the model file of a mass-elastic table: one mass a row, with the stiffness to the next mass.

    Exit status: 0, or 2 if the table is faulty.
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
    file: Annotated[Path, typer.Argument(help="The shaft train, a YAML file.", show_default=False)],
    out: Annotated[
        Path,
        typer.Option("-o", "--out", help="Train.mo (Modelica), or .npz or .mat (state space)."),
    ],
    rpm: Annotated[
        float | None, typer.Option("--rpm", help="Reference speed (default: the rated speed).")
    ] = None,
    order: Annotated[
        str | None, typer.Option("--order", help="Modelica: one order only, as 2 or 1/2.")
    ] = None,
    at: Annotated[
        float | None, typer.Option("--at", help="State space: Hz at which loss factors are exact.")
    ] = None,
    inputs: Annotated[
        str, typer.Option("--inputs", help="State space: stations with a torque, by commas.")
    ] = "",
    outputs: Annotated[
        str, typer.Option("--outputs", help="State space: stations with a speed, by commas.")
    ] = "",
    case: Annotated[str | None, typer.Option("--case", help="One case of the file.")] = None,
) -> None:
    """Write the lumped train as a Modelica model, or as a state space for Python or MATLAB.

    Exit status: 0, or 2 if the train has no counterpart there.
    """
    from torsion.exchange.export_command import export as write

    with refusals(file):
        say(
            write(file, out, rpm=rpm, order=order, at=at, inputs=inputs, outputs=outputs, case=case)
        )
