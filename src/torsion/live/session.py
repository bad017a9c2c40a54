"""What `torsion live` follows: a file and those it reads, a thread that solves, and what its pages show."""

import math
import threading
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from torsion.analyses import ANALYSES
from torsion.analyses.undamped_modes import Modes
from torsion.errors import Fault, InputError, SolveError
from torsion.findings import Progress, silent
from torsion.output.blocks import Block, Heading, PageEnd, Paragraph
from torsion.output.chapters import verdict
from torsion.output.chapters.modes import critical_speeds, natural_frequencies
from torsion.output.chapters.response import forced_response
from torsion.output.document import numbered
from torsion.output.figures.figure import Figure
from torsion.output.pages.html import fragment
from torsion.results import listed
from torsion.rules import rule
from torsion.runner import one_case, run
from torsion.schema.scene_reader import read, reread
from torsion.schema.variants.overlay import in_words
from torsion.schema.variants.variation import Variation, movable
from torsion.schema.variants.varied_figures import Figure as VariedFigure
from torsion.study import Study
from torsion.user_files import OPENED, Stamp, stamp

LEFT_OUT = (  # what a picture cannot wait for
    "tolerances",
    "sweep",
    "design",
    "fit",
    "periodic",
    "stability",
    "stability map",
    "transient",
    "check",
)
ELSEWHERE = "the live page leaves it out; `torsion solve` computes it"
Fragment = dict[str, str]


def left_out(study: Study) -> tuple[str, ...]:
    """Return what the pictures of a study omit, in words."""
    names = [
        ANALYSES[name].title if name in ANALYSES else name
        for name in LEFT_OUT
        if _is_wanted(study, name)
    ]
    rules = [
        f"rule {name}"
        for name, settings in study.rules
        if set(rule(name, settings).needs) & set(LEFT_OUT)
    ]
    return (*names, *rules, *([f"cases {', '.join(study.cases)}"] if study.cases else []))


def _is_wanted(study: Study, name: str) -> bool:
    return name in study.analyses or (name in ANALYSES and ANALYSES[name].is_wanted(study))


def drawn(
    study: Study, moved: Iterable[str], progress: Progress = silent
) -> tuple[Fragment, Fragment]:
    """Return frequencies with the Campbell diagram, and the first page with the response.

    moved: figures that are not those of the file.
    """
    quick = [name for name in ANALYSES if name not in LEFT_OUT and _is_wanted(study, name)]
    findings = run(replace(study, cases={}), only=quick, progress=progress)
    plan = replace(
        findings.plan,
        left_out=(*findings.plan.left_out, *((name, ELSEWHERE) for name in left_out(study))),
    )
    if moved_names := listed(moved):  # no checksum of a file stands for them
        study = replace(study, file=f"{study.file} with another {moved_names}", text="")
    findings = replace(findings, plan=plan, study=study)
    changed = [Paragraph(f"{study.shown_file}.", "note")] if moved_names else []
    blocks = [
        Heading("Verdict"),
        *changed,
        *verdict.blocks(findings),
        *forced_response.without_tables(findings),
    ]
    page = fragment([*numbered([block for block in blocks if not isinstance(block, PageEnd)])])
    modes = findings.get(Modes)
    if modes is None or not modes.frequency.size:
        why = dict(findings.plan.left_out).get(ANALYSES["modes"].title, "there are none")
        above: list[Block] = [Paragraph(f"No natural frequencies: {why}.", "note")]
    else:
        # The Campbell diagram, where an order excites.
        of_critical_speeds = "critical_speeds" in findings.results
        chapter = critical_speeds.chapter(findings) if of_critical_speeds else ()
        above = [block for block in chapter if isinstance(block, Heading | Figure)]
        above += [Heading("Natural frequencies"), natural_frequencies.frequencies(modes)]
    return fragment([*numbered(above)]), page


STEPS = 100  # of a slider without steps of its own, about


@dataclass(frozen=True)
class Slider:
    """Figures that vary as one, and the positions of their slider: a value, or the number of one."""

    name: str
    figures: tuple[VariedFigure, ...]
    low: float
    high: float
    step: float

    @property
    def nominal(self) -> float | None:
        """The position that is the file as it stands; None where there is none."""
        first = self.figures[0]
        places = (
            np.flatnonzero(np.isclose(first.all_values(), first.nominal)) if first.places else None
        )
        if places is not None:
            return float(places[0]) if places.size else None
        return None if math.isnan(first.nominal) else first.nominal

    def value(self, position: float) -> float:
        """Return the value of its figures at a position; raises InputError where it has no such position."""
        slack = 1e-6 * self.step  # of decimals
        if not self.low - slack <= position <= self.high + slack:
            message = f"the slider '{self.name}' goes from {self.low:g} to {self.high:g}"
            raise InputError([Fault((), message)], message)
        first = self.figures[0]
        return float(first.all_values()[round(position)]) if first.places else position


def sliders_of(variation: Variation) -> dict[str, Slider]:
    """Return the sliders of a file by their names."""
    columns: dict[int, list[VariedFigure]] = {}
    for figure in variation.figures:
        columns.setdefault(figure.column, []).append(figure)
    sliders = {}
    for figures in columns.values():
        name, first = ", ".join(figure.name for figure in figures), figures[0]
        ends, step = [0.0, first.places - 1.0], 1.0
        if not first.places:
            low, high = np.sort(first.ends).tolist()
            digits = 1 - math.floor(math.log10((high - low) / STEPS))
            step = 10.0 ** (1 - digits)
            ends = [math.ceil(low / step - 0.01) * step, math.floor(high / step + 0.01) * step]
            ends = [round(end, max(digits, 0)) for end in ends]
        sliders[name] = Slider(name, tuple(figures), ends[0], ends[1], step)
    return sliders


def moved_study(study: Study, variation: Variation, positions: Mapping[str, float]) -> Study:
    """Return the study with its sliders at these positions; the others are as in the file. Raises InputError."""
    sliders, pairs = sliders_of(variation), list[tuple[VariedFigure, float]]()
    for name, position in positions.items():
        if name not in sliders:
            message = f"the file has no figure '{name}' that may vary"
            raise InputError([Fault((), message)], message)
        value = sliders[name].value(position)
        pairs += [(figure, value) for figure in sliders[name].figures]
    if not pairs:
        return study
    figures, values = zip(*pairs, strict=True)
    return replace(replace(variation, figures=figures).study(values), case=study.case)


def shown(variation: Variation, positions: Mapping[str, float]) -> list[dict[str, Any]]:
    """Return every slider as the page shows it, with the figure of the file in words."""
    sliders = []
    for name, slider in sliders_of(variation).items():
        first, position = slider.figures[0], positions.get(name, slider.nominal)
        # What the file states, or would state with the slider at its position.
        nominal = variation.source.at(first.paths[0][0]) if first.paths else None
        text = "as in the file" if nominal is None else in_words(nominal.value)
        if name in positions:
            value = slider.value(positions[name])
            text = first.words(value)
            if not first.rows:
                _, node = next(first.puts(value, variation.source))
                text = in_words(node.value)
                text += f" ({100.0 * (value - 1.0):+.3g} %)" if first.law.first is None else ""
        sliders.append(
            {
                "name": name,
                "low": slider.low,
                "high": slider.high,
                "step": slider.step,
                "nominal": slider.nominal,
                "now": slider.low if position is None else position,
                "moved": name in positions,
                "text": text,
            }
        )
    return sliders


TICK = 0.025  # s between two looks at the files
GONE = 8  # ticks that a file may be missing for, while an editor puts another in its place
LIMIT = 20.0  # s that a picture may take
WAIT = 20.0  # s after which a page that waits for news hears that there are none


class OvertakenError(Exception):
    """A later request has come, or the command ends."""


class LateError(Exception):
    """A picture takes longer than a page should wait."""


class Session:
    """One file, followed until `end`."""

    def __init__(self, file: str | Path, case: str | None = None) -> None:
        self.file, self.case = str(file), case
        self._lock = threading.Condition(threading.RLock())
        # What pages show, each with the count of its change.
        self._news: dict[str, tuple[int, Any]] = {}
        self._count = self._turn = 0
        self._positions: Mapping[str, float] = {}
        self._read: tuple[Study, Variation] | None = None
        self._is_stale, self._is_ended = True, False
        path = str(Path(file).absolute())
        self._files: dict[str, Stamp] = {path: stamp(path)}
        self._show(name=self.file if case is None else f"{self.file}, case {case}")

    def start(self) -> None:
        """Begin to solve, and to look at the files."""
        self._request_file()
        for task in (self._solve, self._watch):
            threading.Thread(target=task, daemon=True).start()

    def end(self) -> None:
        """Stop the solver, and let every page go that waits."""
        with self._lock:
            self._is_ended = True
            self._lock.notify_all()

    def move(self, positions: Mapping[str, float]) -> int:
        """Solve with the sliders at these positions; the number of the request."""
        with self._lock:
            self._turn += 1
            self._positions = dict(positions)
            self._show(state={"text": "solving …"})
            return self._turn

    def news(self, seen: int, wait: float = WAIT) -> dict[str, Any]:
        """Return what has changed since a page has seen that many changes, as soon as there is anything."""
        with self._lock:
            if seen > self._count:  # of another run
                seen = 0
            self._lock.wait_for(lambda: self._count > seen or self._is_ended, wait)
            news = {key: value for key, (count, value) in self._news.items() if count > seen}
            return {"seen": self._count, **news}

    def _show(self, **entries: Any) -> None:
        with self._lock:
            for key, value in entries.items():
                if self._news.get(key, (0, None))[1] != value:
                    self._count += 1
                    self._news[key] = self._count, value
            self._lock.notify_all()

    def _request_file(self) -> None:
        """Request the file read again, its sliders as it says."""
        with self._lock:
            self._is_stale = True
            self._show(file={"turn": self.move({})})

    def _solve(self) -> None:
        """Answer the latest request, whenever there is a new one."""
        turn = 0
        while not self._is_ended:
            with self._lock:
                self._lock.wait_for(lambda answered=turn: self._turn > answered or self._is_ended)  # type: ignore[misc]
                turn, positions = self._turn, self._positions
            start, faults = time.monotonic(), ""
            try:
                self._draw(turn, positions, start + LIMIT)
            except OvertakenError:
                continue
            except InputError as error:
                faults = str(error)
            except SolveError as error:
                faults = error.located or str(error)
            except LateError:
                limit = "(`torsion solve` has no such limit)"
                faults = f"{self.file}: there is no picture within {LIMIT:.0f} s {limit}"
            except MemoryError:
                faults = "this machine has too little memory for it; request fewer speeds, orders or modes"
            except Exception as error:  # the page outlives what is our fault
                words = f"{type(error).__name__}: {error}"
                faults = f"torsion has failed: {words}; please report it"
            took = f"solved and drawn in {1e3 * (time.monotonic() - start):.0f} ms"
            with self._lock:
                if turn == self._turn:
                    self._show(faults={"text": faults}, state={"text": "" if faults else took})

    def _draw(self, turn: int, positions: Mapping[str, float], deadline: float) -> None:
        """Show the pictures of a request one by one; raises whatever keeps them from being made."""

        def progress(what: str, share: float) -> None:
            if self._turn > turn or self._is_ended:
                raise OvertakenError
            if time.monotonic() > deadline:
                raise LateError

        if self._is_stale or self._read is None:
            self._read = self._open()
        study, variation = self._read
        words = "; ".join(left_out(study))
        notes = f"Left out on this page: {words}." if words else ""
        self._show(sliders={"turn": turn, "each": shown(variation, positions)})
        self._show(notes={"text": notes})
        solved = moved_study(study, variation, positions)
        modes, report = drawn(solved, positions, progress)
        self._show(modes={"turn": turn, **modes}, report={"turn": turn, **report})

    def _open(self) -> tuple[Study, Variation]:
        """Read the file, and note every file that is opened for it, also in vain, as it was then."""
        path = str(Path(self.file).absolute())
        opened = {path: stamp(path)}
        OPENED.set(opened)
        self._is_stale, self._read = False, None
        try:
            scene = read(self.file)
            study = scene if self.case is None else one_case(scene, self.case)
            return study, movable(study, *reread(study))
        finally:
            self._files = opened

    def _watch(self) -> None:
        """Request a picture when a file has changed and is settled."""
        before, missing, is_settled = self._files, 0, True
        while not self._is_ended:
            time.sleep(TICK)
            # Files that are followed already count as they were seen, others as they were read.
            before = {path: before.get(path, opened) for path, opened in [*self._files.items()]}
            stamps = {path: stamp(path) for path in before}
            is_gone = any(before[path] and not stamps[path] for path in stamps)
            missing = missing + 1 if is_gone else 0
            if 0 < missing < GONE:
                continue
            if stamps != before:
                before, is_settled = stamps, False
            elif not is_settled:
                is_settled = True
                self._request_file()
