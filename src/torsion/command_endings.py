"""How every command ends: a report or results printed, a message and its exit status where there is no answer."""

import re
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from inspect import getdoc, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from torsion.errors import BAD_INPUT, REFUSED, InputError, SolveError
from torsion.lasting_output import say

if TYPE_CHECKING:
    from torsion.findings import Findings, Progress

HELP = re.compile(r"\n(\w+): (.+)")  # of a parameter, in the docstring of a command
OF_ALL = """
file: The shaft train, a YAML file.
out: Folder of the report.
case: Only one case of the file (normal: the nominal case).
json: Print the results as JSON; no file is written, and no option that writes one is taken.
pdf: Write report.pdf too.
verbose: Print all tables, not their summary.
"""
SHORT = {"out": "-o", "verbose": "-v"}


def described(command: Callable[..., None]) -> Callable[..., None]:
    """Give the parameters of a command the help that its docstring has of them, or that of all; after `*` are options."""
    text = getdoc(command) or ""
    helps = dict(HELP.findall(OF_ALL + text))
    for name, parameter in signature(command).parameters.items():
        limits = next(iter(getattr(parameter.annotation, "__metadata__", ())), {})
        traits: dict[str, Any] = {"help": helps.get(name), **limits}
        if parameter.kind is not parameter.KEYWORD_ONLY:
            stated = typer.Argument(**traits)
        else:
            flags = [SHORT[name]] if name in SHORT else []
            stated = typer.Option(*flags, f"--{name.replace('_', '-')}", **traits)
        command.__annotations__[name] = Annotated[parameter.annotation, stated]
    without_help = lambda line: line[0] * (line[1] not in command.__annotations__)  # noqa: E731
    command.__doc__ = HELP.sub(without_help, text).rstrip()
    return command


@contextmanager
def refusals(file: Path) -> Iterator[None]:
    """End with a message and its exit status where there is no answer."""
    try:
        yield
    except InputError as error:
        stop(str(error))
    except SolveError as error:
        stop(error.located or f"{file}: {error}", status=REFUSED)
    except MemoryError as error:
        size = f" ({error})" if str(error) else ""
        change = "request fewer speeds, orders, modes or segments"
        stop(f"{file}: this machine has too little memory for it{size}; {change}", status=REFUSED)


def print_report(
    report: str,
    file: Path,
    out: Path | None,
    solve: Callable[..., "Findings"],
    also: tuple[str, ...] = (),
    *,
    as_json: bool,
    matrices: Path | None = None,
    is_full: bool = False,
    is_verbose: bool = True,
) -> NoReturn:
    """Solve, write the files of a report and print it, or print its results as JSON alone; end with its exit status.

    What has no answer is said on the error stream, last.
    """
    from torsion import commands

    with refusals(file):
        with show_progress() as report_progress:
            findings = solve(progress=report_progress)
        if as_json:
            from torsion.output.reports import REPORTS
            from torsion.output.results_json import text

            typer.echo(text(findings, REPORTS[report].keys), nl=False)
        else:
            from torsion.output.terminal import show

            folder = commands.folder_of(file, out, findings.study.case)
            document = commands.write(findings, folder, report, also=also, is_full=is_full)
            show(document, folder, is_verbose=is_verbose)
        if matrices is not None:
            say(commands.write_matrices(findings, matrices))
    stop(*findings.without_answer, status=findings.exit_status)


def stop(*messages: str, status: int = BAD_INPUT) -> NoReturn:
    """Say on the error stream what is wrong or has no answer, and end with the exit status."""
    for message in messages:
        say(message, err=True)
    raise typer.Exit(status)


def show_progress() -> "AbstractContextManager[Progress]":
    """Return a progress indicator; what draws it is loaded only where the error stream is a terminal."""
    if not sys.stderr.isatty():
        return nullcontext(lambda what, share: None)
    from torsion.output.terminal import progress

    return progress()


def refuse_with_json(json: bool, writing: dict[str, object]) -> None:
    """Refuse --json beside an option that writes a file."""
    for option, given in writing.items():
        if json and given:
            stop(f"--json writes no file and {option} writes one; give one of them")


def write_new(file: Path, text: str) -> None:
    """Write a text into a file that must not exist yet; end with a message and its exit status if it cannot be."""
    try:
        with file.open("x", encoding="utf-8") as target:
            target.write(text)
    except FileExistsError:
        stop(f"{file} exists already and is not changed (give another name)")
    except OSError as error:
        stop(f"{file} cannot be written: {error.strerror}")
