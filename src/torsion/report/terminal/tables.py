"""The tables of the terminal: the verdict, the frequencies, the critical speeds, the peaks and the plan in short."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console, RenderableType
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table as Grid
from rich.text import Text

from torsion.analyses.check.models import Compared
from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.damped import DampedModes
from torsion.analyses.joints.joint_results import Joints
from torsion.analyses.lateral.shaft_bending import Lateral
from torsion.analyses.modes import Modes
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.findings import Findings
from torsion.report.chapters import verdict
from torsion.report.chapters.lateral import speed_range
from torsion.report.numbers import NONE, number, order, rpm
from torsion.report.reading import NO_VALUE, largest, rounding, synthesis, without
from torsion.report.terminal.check import largest_errors
from torsion.report.terminal.grids import filled, grid, printed, verdicts
from torsion.report.terminal.joints import lines_as_one
from torsion.report.terminal.lateral import bending_speeds
from torsion.report.terminal.motion import largest_by_both, unstable_ranges


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
    joints = None if findings.get(Joints) is None else lines_as_one(findings.need(Joints))
    bent = None if findings.get(Lateral) is None else bending_speeds(findings.need(Lateral), speed_range(findings))
    moved = largest_by_both(findings), unstable_ranges(findings)
    found = (_frequencies(findings), _critical_speeds(findings), _torques(findings), *moved, joints, bent)
    shown += [made for made in (*found, verdicts(findings)) if made is not None and made.row_count]
    if findings.get(Compared) is not None and findings.need(Compared).exact is not None:
        shown.append(largest_errors(findings.need(Compared)))
    return [*shown, *(printed(block) for block in verdict.conclusion(findings))]


def _frequencies(findings: Findings) -> Grid | None:
    modes, damped = findings.get(Modes), findings.get(DampedModes)
    if modes is None:
        return None
    made = grid("Natural frequencies", ("mode", ">"), ("Hz", ">"), ("per minute", ">"), ("nodes", ">"))
    rows = [
        [str(k), number(f, 7), number(60.0 * f, 7), str(int(n))]
        for k, (f, n) in enumerate(zip(modes.frequency.tolist(), modes.nodes.tolist(), strict=True), start=1)
    ]
    if damped is not None and len(damped.frequency) == len(rows):
        made.add_column("damped, Hz", justify="right")
        made.add_column("damping ratio", justify="right")
        pairs = zip(damped.frequency.tolist(), damped.damping_ratio.tolist(), strict=True)
        rows = [[*row, number(f, 7), number(z, 3)] for row, (f, z) in zip(rows, pairs, strict=True)]
    return filled(made, rows)


def _critical_speeds(findings: Findings) -> Grid | None:
    made = grid("Critical speeds in the range", ("rpm", ">"), ("order", ">"), ("mode", ">"), ("excited by", "<"))
    inside = [crossing for crossing in findings.need(CriticalSpeeds).crossings if crossing.is_inside]
    return filled(made, [[rpm(one.speed), order(one.order), str(one.mode), ", ".join(one.sources)] for one in inside])


def _torques(findings: Findings) -> Grid | None:
    """The largest synthesis of every component, of the speeds at which every line is reliable."""
    response = findings.get(Response)
    if response is None or findings.get(Synthesis) is None:
        return None
    made = grid("Largest vibratory torque, all orders", ("element", "<"), ("N m", ">"), ("at rpm", ">"))
    rows, nothing = [], rounding(findings)
    for part, name in enumerate(one.name for one in findings.study.train.parts):
        spans = [k for k, span in enumerate(findings.system.spans) if span.part == part]
        if spans:
            half = without(synthesis(findings, spans), nothing[spans])
            at = largest(half)
            told = [NO_VALUE, NONE] if at is None else [number(float(half[at])), rpm(float(response.speed[at]))]
            rows.append([name, *told])
    return filled(made, rows)


@contextmanager
def progress() -> Iterator[Callable[[str, float], None]]:
    """A bar on the error stream that tells what is being done; nothing where that is no terminal."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=1.0)
        yield lambda what, share: bar.update(task, description=escape(what), completed=share)
