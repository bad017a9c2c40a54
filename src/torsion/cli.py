"""The command `torsion`."""

import ctypes
import gc
import json as json_text
import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

import torsion
from torsion.command_endings import (
    described,
    make_streams_last,
    outputs,
    print_report,
    refusals,
    refuse_with_json,
    say,
    show_progress,
    stop,
    write_new,
)
from torsion.errors import BAD_INPUT
from torsion.exchange_commands import compare, export, import_

SCHEMA_FILE = "torsion.schema.json"  # beside a new scene, whose first line names it to editors
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # parameters of mallopt, by malloc.h
app = typer.Typer(add_completion=False, no_args_is_help=True, pretty_exceptions_enable=False)


def _say_version(is_requested: bool) -> None:
    if is_requested:
        typer.echo(f"torsion {torsion.__version__}")
        raise typer.Exit


VERSION = typer.Option(
    "--version", callback=_say_version, is_eager=True, help="Print the version and end."
)


@app.callback()
def about(version: Annotated[bool, VERSION] = False) -> None:
    """Torsional vibration of shaft trains: frequencies, response, universal joints, class rules, report."""


def command(function: Callable[..., None]) -> Callable[..., None]:
    """Make a function a command by its name."""
    return app.command(function.__name__.strip("_"))(described(function))


@command
def solve(
    file: Path,
    *,
    out: Path | None = None,
    json: bool = False,
    case: str | None = None,
    pdf: bool = False,
    full: bool = False,
    matrices: Path | None = None,
    vtu: bool = False,
    csv: bool = False,
    xlsx: bool = False,
    memory: str | None = None,
    verbose: bool = False,
) -> None:
    """Solve a scene, print its tables and write its report.

    Exit status: 0 solved, and the verdict is PASS, with or without restrictions, or no rule is named; 1 solved, and
    the verdict is FAIL or NOT JUDGED; 2 the input is at fault; 3 no answer to the promised accuracy. Where only some
    analyses have no answer, the report holds all others. Every case of the file is solved beside it; the exit status
    is that of the worst that is judged.

    full: Add appendices: all mode shapes, Holzer tables, angles, engine harmonics.
    matrices: Write J, K, C and H to this .npz file, C at the rated speed.
    vtu: Write the mode shapes as modes.vtu for ParaView.
    csv: Write values (data.zip), tables (tables.zip) and figures as CSV too.
    xlsx: Write the results as a workbook, results.xlsx.
    memory: Memory that a response may need, as 4GB (default: 2GB).
    """
    from torsion.runner import solved

    writing = {"--vtu": vtu, "--pdf": pdf, "--csv": csv, "--xlsx": xlsx, "--full": full}
    refuse_with_json(json, {**writing, "--matrices": matrices, "-o": out})
    requested = outputs(pdf=pdf, vtu=vtu, figures=csv, tables=csv, data=csv, xlsx=xlsx)
    findings = partial(solved, file, case=case, memory=memory)
    shown = {"is_full": full, "is_verbose": verbose}
    print_report("solve", file, out, findings, requested, as_json=json, matrices=matrices, **shown)


@command
def sweep(
    file: Path,
    *,
    out: Path | None = None,
    workers: Annotated[int | None, {"min": 1}] = None,
    scheduler: str = "",
    scheduler_file: Path | None = None,
    fresh: bool = False,
    case: str | None = None,
    pdf: bool = False,
    csv: bool = False,
    verbose: bool = False,
) -> None:
    """Solve a scene as `solve` does, the variants of its sweep by several processes or machines.

    Variants are solved in chunks; each is kept in DIR/parts as soon as it is answered, and the same command goes on
    where it was ended. Results are the same to the last bit however many workers there are. Exit status as of `solve`.

    workers: Processes of this machine (default: all cores).
    scheduler: Address of a dask scheduler: tls://host:8786.
    scheduler_file: File that a scheduler wrote its address to.
    fresh: Remove the parts that are there and begin anew.
    csv: Write every variant to variants.csv, and as `solve` does.
    """
    from torsion.sweeping import sweeper
    from torsion.sweeping.cluster import Workplace

    solved = partial(
        sweeper.swept,
        file,
        out,
        workplace=Workplace(workers, scheduler, scheduler_file),
        fresh=fresh,
        csv=csv,
        case=case,
        notice=partial(say, err=True),
    )
    try:
        requested = outputs(pdf=pdf, figures=csv, tables=csv, data=csv)
        print_report("solve", file, out, solved, requested, as_json=False, is_verbose=verbose)
    except (KeyboardInterrupt, SystemExit) as ended:
        typer.echo(
            "ended; the finished parts stay, and the same command continues from there", err=True
        )
        if isinstance(ended, SystemExit):
            raise
        raise typer.Exit(128 + signal.SIGINT) from None


@command
def joint(
    file: Path,
    *,
    out: Path | None = None,
    json: bool = False,
    case: str | None = None,
    turns: Annotated[int | None, {"min": 1, "max": 100}] = None,
) -> None:
    """Print the universal joints of a scene and write joints.html, joints.json and joints.csv.

    A scene of joints alone is enough: no inertia, speed or torque is needed. Exit status as of `solve`.

    turns: Revolutions of the driving shaft.
    """
    from torsion import commands

    refuse_with_json(json, {"-o": out})
    solved = partial(commands.joint, file, turns=turns, case=case)
    print_report("joint", file, out, solved, as_json=json)


@command
def check(
    file: Path, *, out: Path | None = None, json: bool = False, case: str | None = None
) -> None:
    """Compare the models of the shafts (lumped, fem, exact), print their errors and write check.html and check.json.

    Every error is against the exact model: frequencies, shapes, response torques. Exit status: 0 all within the
    tolerance (0.1 % unless the file says it), 1 a model is not, 2 and 3 as of `solve`.
    """
    from torsion import commands

    refuse_with_json(json, {"-o": out})
    print_report("check", file, out, partial(commands.check, file, case=case), as_json=json)


@command
def study(
    file: Path,
    *,
    out: Path | None = None,
    json: bool = False,
    case: str | None = None,
    tolerance: str = "0.1%",
    quick: bool = False,
) -> None:
    """Time every model and method on this train against its error; write study.html and study.json.

    Exit status: 0 done, 2 and 3 as of `solve`.

    tolerance: Error that is good enough, for the recommendation.
    quick: Fewer elements and runs: seconds, not minutes.
    """
    from torsion import commands
    from torsion.output import run_time_study

    refuse_with_json(json, {"-o": out})
    with refusals(file):
        with show_progress() as progress:
            findings, timings = commands.study(
                file, tolerance=tolerance, quick=quick, case=case, progress=progress
            )
        if json:
            typer.echo(run_time_study.json_text(findings, timings), nl=False)
        else:
            from torsion.output.pages.terminal import show

            folder = commands.folder_of(file, out, findings.study.case)
            show(commands.write_study(findings, timings, folder), folder)


@command
def report(
    results: Path,
    *,
    out: Path | None = None,
    pdf: bool = False,
    csv: bool = False,
    verbose: bool = False,
) -> None:
    """Draw the report again from its results, without solving: the page, and what the options name.

    Exit status: that of the command which wrote the results, or 2 where they hold no report.

    results: results.json, or the folder that holds it.
    out: Folder of the report (default: the same).
    csv: Write values (data.zip), tables (tables.zip) and figures as CSV too.
    """
    from torsion import commands
    from torsion.output.pages.terminal import show

    with refusals(results):
        requested = outputs(pdf=pdf, figures=csv, tables=csv)
        document, folder = commands.report(results, out, also=requested)
        show(document, folder, is_verbose=verbose or document.name != "solve")
    stop(*document.ending.unanswered, status=document.ending.status)


for exchange in (compare, import_, export):
    command(exchange)


@command
def plan(file: Path, *, case: str | None = None) -> None:
    """Print what `solve` would compute of a scene and its cases, with sizes and reasons; nothing is solved.

    Exit status: 0, or 2 the input is at fault.
    """
    from torsion import commands

    with refusals(file):
        nominal = commands.plan(file, case=case)
        for name, planned in {"": nominal, **nominal.cases}.items():
            if name:
                typer.echo(f"\ncase {name}")
            for what, size, why in planned.steps:
                typer.echo(f"{what}: {size} ({why})" if size else f"{what} ({why})")
            for what, why in planned.left_out:
                typer.echo(f"left out: {what}, because {why}")


@command
def sketch(file: Path, *, out: Path | None = None, case: str | None = None) -> None:
    """Draw the train of a scene alone, as SVG; nothing is solved. Exit status as of `plan`.

    out: The SVG file to write (default: <model file>.svg).
    """
    from torsion import commands

    with refusals(file):
        say(f"Sketch: {commands.sketch(file, out, case=case)}")


@command
def live(
    file: Path,
    *,
    case: str | None = None,
    port: Annotated[int, {"min": 0, "max": 65535}] = 0,
    no_browser: bool = False,
) -> None:
    """Show a page that follows the file: verdict, Campbell diagram and response, solved again whenever it is saved.

    Every toleranced figure of the file, and every figure that its sweep, design or fit varies, has a slider. The page
    is for this machine alone and writes nothing; its address bears a token. Ctrl-C ends it. Exit
    status: 0, or 2 where there is no such file or the port is taken.

    port: Port of the page (default: a free one).
    no_browser: Print the address and open no browser.
    """
    from torsion.live.server import Server
    from torsion.live.session import Session

    if not file.is_file():
        stop(f"{file}: this is no file")
    try:
        server = Server(Session(file, case), port)
    except OSError as error:
        stop(
            f"port {port} cannot be taken: {error.strerror} (leave --port out for a free one)",
        )
    try:
        say(f"{file} is shown at {server.address}\nCtrl-C ends it")
        sys.stdout.flush()
        server.session.start()
        if not no_browser:
            import webbrowser

            webbrowser.open(server.address)
        server.serve_forever(0.1)
    except KeyboardInterrupt:
        pass
    finally:
        server.end()


def _schema_text() -> str:
    """Return the JSON Schema of model files as text."""
    from torsion.schema.json_schema import json_schema

    return json_text.dumps(json_schema(), indent=2) + "\n"


@command
def schema() -> None:
    """Print the JSON Schema of the file, by which an editor completes and checks it."""
    typer.echo(_schema_text(), nl=False)


@command
def new(file: Path = Path("train.yaml")) -> None:
    """Write a commented example that solves, and the JSON Schema by which an editor completes and checks it.

    file: The file to write.
    """
    from torsion.schema import template

    head = f"# yaml-language-server: $schema={SCHEMA_FILE}\n"
    write_new(file, head + template("example.yaml"))
    try:
        file.with_name(SCHEMA_FILE).write_text(_schema_text(), encoding="utf-8")
    except OSError as error:
        stop(f"{file} cannot be written: {error.strerror}")
    say(f"{file} written; solve it with: torsion solve {file}")


@command
def sources(*, bib: bool = False) -> None:
    """Print the literature of all formulas, methods and rules; the report lists what its run used.

    bib: Print BibTeX entries.
    """
    from torsion.rules import RULES, rule
    from torsion.sources import SOURCES

    if bib:
        say("\n\n".join(record.bibtex for record in SOURCES.values()))
        return
    for record in SOURCES.values():
        doubt = "" if record.compared else "; edition not confirmed"
        say(f"{record.key}: {record.words}; {record.use}{doubt}")
    for name in RULES:
        say(f"{name}: {rule(name).edition or 'limits of the file or of a manufacturer'}")


def main() -> None:
    """Run the console script.

    A reader that leaves (`| head`) changes no exit status; any other failure to print makes it that of faulty input.
    """
    # Before numpy is imported: threads that spin cost up to 20 times the time on a shared machine.
    for variable in ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"):
        os.environ.setdefault(variable, "1")
    # Freed memory stays with the process: fetched anew, large arrays take up to 3 times the time (glibc only).
    with suppress(OSError, AttributeError, TypeError):
        libc = ctypes.CDLL(None)
        libc.mallopt(M_TRIM_THRESHOLD, 1 << 30)
        libc.mallopt(M_MMAP_THRESHOLD, 1 << 25)  # the most that glibc takes
    gc.set_threshold(100_000, 20, 50)  # looking for cycles took 12 % of the time of a large train
    signal.signal(
        signal.SIGTERM, lambda number, _: sys.exit(128 + number)
    )  # as on Ctrl-C: files stay whole
    output = make_streams_last()

    # Of all commands only the one that is called is built: all of them take 2 % of the time of a small scene.
    for command in app.registered_commands:
        if (command.name or getattr(command.callback, "__name__", "")) in sys.argv[1:2]:
            app.registered_commands = [command]
            break
    try:
        app()
    except SystemExit:
        sys.stdout.flush()
        if output is None or output.lost is None or isinstance(output.lost, BrokenPipeError):
            raise
        sys.stderr.write(f"the output cannot be written: {output.lost.strerror}\n")
        raise SystemExit(BAD_INPUT) from None
