"""How every command ends: a report or results printed, a message and its exit status where there is no answer.

Standard output and error last: where they cannot be written any more, a command goes on.
"""

import io
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from inspect import getdoc, signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from torsion.errors import BAD_INPUT, REFUSED, InputError, SolveError
from torsion.user_files import without_controls

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
        limits: dict[str, Any] = next(iter(getattr(parameter.annotation, "__metadata__", ())), {})
        traits = {"help": helps.get(name), **limits}
        if parameter.kind is not parameter.KEYWORD_ONLY:
            stated = typer.Argument(**traits)
        else:
            flags = [SHORT[name]] if name in SHORT else []
            stated = typer.Option(*flags, f"--{name.replace('_', '-')}", **traits)
        command.__annotations__[name] = Annotated[parameter.annotation, stated]
    without_help = lambda line: line[0] * (line[1] not in command.__annotations__)  # noqa: E731
    command.__doc__ = HELP.sub(without_help, text).rstrip()
    return command


def say(words: str, err: bool = False) -> None:
    """Print words that may quote names of files: no control character reaches the terminal."""
    print(without_controls(words), file=sys.stderr if err else sys.stdout)


class Output(io.FileIO):
    """Standard output or error: where it cannot be written any more the command goes on, and its files are written."""

    lost: OSError | None = None  # the first reason for which something was not written

    def write(self, data: Any, /) -> int:
        """Write the bytes, or drop them after the first failure; return their number."""
        if self.lost is None:
            try:
                return super().write(data)
            except OSError as error:
                self.lost = error
        return memoryview(data).nbytes


def make_streams_last() -> Output | None:
    """Replace standard output and error by streams that last; return what standard output writes to.

    Streams that were redirected inside of Python stay, as do those of another system than POSIX: None then.
    """
    # The null device is opened for each stream that was closed when the program started: else the next file that is
    # opened takes the number of the stream, and what is written to the stream goes into it.
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            null = os.open(os.devnull, os.O_RDWR)
            opened = os.fdopen(null, mode, encoding="utf-8", errors="replace")
            setattr(sys, name, opened)
            setattr(sys, f"__{name}__", opened)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="replace")
    if (
        os.name != "posix"
        or sys.stdout is not sys.__stdout__
        or sys.stdout is None
        or sys.stderr is None
    ):
        return None
    for number, name in ((2, "stderr"), (1, "stdout")):
        getattr(sys, name).flush()
        output = Output(number, "wb", closefd=False)
        is_by_line, buffered = number == 2 or output.isatty(), io.BufferedWriter(output)
        lasting = io.TextIOWrapper(buffered, "utf-8", "replace", line_buffering=is_by_line)
        setattr(sys, name, lasting)
    return output


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
    with refusals(file):
        with show_progress() as report_progress:
            findings = solve(progress=report_progress)
        if as_json:
            from torsion.output.stored.results_json import KEYS, text

            typer.echo(text(findings, KEYS.get(report, ())), nl=False)
        else:
            from torsion.commands import folder_of, write
            from torsion.output.pages.terminal import show

            folder = folder_of(file, out, findings.study.case)
            document = write(findings, folder, report, also=also, is_full=is_full)
            show(document, folder, is_verbose=is_verbose)
        if matrices is not None:
            from torsion.commands import write_matrices

            say(write_matrices(findings, matrices))
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
    from torsion.output.pages.terminal import progress

    return progress()


def outputs(**requested: bool) -> tuple[str, ...]:
    """Return the outputs that are requested by their name."""
    return tuple(name for name, is_requested in requested.items() if is_requested)


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
