"""The tables of the terminal: the verdict, the frequencies, the critical speeds, the peaks and the plan in short."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from rich.box import SIMPLE
from rich.console import Console, OverflowMethod, RenderableType
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table as Grid
from rich.text import Text

from torsion.findings import Findings
from torsion.report.blocks import Block, Paragraph, Points
from torsion.report.chapters import verdict
from torsion.report.numbers import given, number, order, rpm

COLOURS = {
    "pass": "green",
    "fail": "bold red",
    "outside": "yellow",
    "to be verified": "yellow",
    "note": "yellow",
    "plain": "",
}
MOST_ROWS = 12
SHORT = {"to be verified": "VERIFY"}  # the report says the whole of it


def show(findings: Findings, folder: Path | None = None, console: Console | None = None) -> None:
    """Print the tables, and where the report is."""
    screen = console or Console()
    for item in tables(findings):
        screen.print(item)
    seconds = sum(line.seconds for line in findings.plan.done)
    screen.print(Text(f"{len(findings.plan.done)} steps in {seconds:.2f} s"))
    if folder is not None:
        screen.print(Text(f"Report: {folder / 'report.html'}"))


def tables(findings: Findings) -> list[RenderableType]:
    """Everything that is printed, narrow enough for 80 columns; the verdict last, where the eye is."""
    shown: list[RenderableType] = [Text(findings.study.name, style="bold")]
    for made in (_frequencies(findings), _critical_speeds(findings), _torques(findings), _verdicts(findings)):
        if made is not None and made.row_count:
            shown.append(made)
    return [*shown, *(printed(block) for block in verdict.conclusion(findings))]


def _frequencies(findings: Findings) -> Grid | None:
    modes, damped = findings.modes, findings.damped
    if modes is None:
        return None
    made = _grid("Natural frequencies", ("mode", ">"), ("Hz", ">"), ("per minute", ">"), ("nodes", ">"))
    rows = [
        [str(k), number(f, 7), number(60.0 * f, 7), str(int(n))]
        for k, (f, n) in enumerate(zip(modes.frequency.tolist(), modes.nodes.tolist(), strict=True), start=1)
    ]
    if damped is not None and len(damped.frequency) == len(rows):
        made.add_column("damped, Hz", justify="right")
        made.add_column("damping ratio", justify="right")
        pairs = zip(damped.frequency.tolist(), damped.damping_ratio.tolist(), strict=True)
        rows = [[*row, number(f, 7), number(z, 3)] for row, (f, z) in zip(rows, pairs, strict=True)]
    return _filled(made, rows)


def _critical_speeds(findings: Findings) -> Grid | None:
    made = _grid("Critical speeds in the range", ("rpm", ">"), ("order", ">"), ("mode", ">"), ("excited by", "<"))
    inside = [crossing for crossing in findings.critical if crossing.is_inside]
    return _filled(made, [[rpm(one.speed), order(one.order), str(one.mode), ", ".join(one.sources)] for one in inside])


def _torques(findings: Findings) -> Grid | None:
    """The largest synthesis of every component."""
    response, total = findings.response, findings.synthesis
    if response is None or total is None:
        return None
    made = _grid("Largest vibratory torque, all orders", ("element", "<"), ("N m", ">"), ("at rpm", ">"))
    rows = []
    for part, name in enumerate(one.name for one in findings.study.train.parts):
        spans = [k for k, span in enumerate(findings.system.spans) if span.part == part]
        if spans:
            half = total.half_range[:, spans]
            speed, _ = np.unravel_index(np.argmax(half), half.shape)
            rows.append([name, number(float(half.max())), rpm(float(response.speed[speed]))])
    return _filled(made, rows)


def _verdicts(findings: Findings) -> Grid | None:
    heads = (("verdict", "<"), ("component", "<"), ("check", "<"), ("value", ">"), ("limit", ">"), ("unit", "<"))
    made = _grid("Checks, each at its worst point", *heads, ("at rpm", ">"))
    for check in findings.checks:
        limit = "none" if np.isnan(check.limit) else ("≥ " if check.at_least else "") + given(check.limit, 4)
        unit = check.unit.replace("mm2", "mm²")
        word = Text(SHORT.get(check.verdict, check.verdict.upper()), style=COLOURS[check.verdict])
        cells = (check.where, check.clause, number(check.value, 4), limit, unit, rpm(check.speed, 4))
        made.add_row(word, *(Text(cell) for cell in cells))
    return made


def _grid(title: str, *columns: tuple[str, str]) -> Grid:
    """An empty table; words may be cut, numbers never."""
    made = Grid(
        title=title, title_justify="left", title_style="italic", header_style="bold", box=SIMPLE, pad_edge=False
    )
    for name, side in columns:
        right = side == ">"
        fold: OverflowMethod = "fold" if right else "ellipsis"
        made.add_column(name, justify="right" if right else "left", no_wrap=right, overflow=fold)
    return made


def _filled(made: Grid, rows: list[list[str]]) -> Grid:
    for row in rows[:MOST_ROWS]:
        made.add_row(*(Text(cell) for cell in row))
    if len(rows) > MOST_ROWS:
        made.caption = f"and {len(rows) - MOST_ROWS} more rows in the report"
    return made


def printed(block: Block) -> RenderableType:
    """A sentence or a list of the conclusion."""
    match block:
        case Paragraph(text=text, kind=kind):
            return Text(plain(text), style=COLOURS[kind])
        case Points(items=items):
            return Text("\n".join(f"- {plain(item)}" for item in items))
        case _:
            return Text("")


def plain(text: str) -> str:
    """Subscripts as they are written on one line: tau_C."""
    return text.replace("_{", "_").replace("}", "")


@contextmanager
def progress() -> Iterator[Callable[[str, float], None]]:
    """A bar on the error stream that tells what is being done; nothing where that is no terminal."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda what, share: bar.update(task, description=escape(what), completed=share)
