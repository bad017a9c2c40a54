"""What `torsion live` follows: a file and those it reads, a thread that solves, and what its pages show."""

import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from torsion.commands import one_case
from torsion.errors import InputError, SolveError
from torsion.live import pictures, sliders
from torsion.schema.scene_reader import read, reread
from torsion.schema.variation import Variation, movable
from torsion.study import Study
from torsion.user_files import OPENED, Stamp, stamp

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
            except Exception as error:  # the page outlives what is our fault
                faults = self._in_words(error)
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
        words = "; ".join(pictures.left_out(study))
        notes = f"Left out on this page: {words}." if words else ""
        self._show(sliders={"turn": turn, "each": sliders.shown(variation, positions)})
        self._show(notes={"text": notes})
        solved = sliders.moved_study(study, variation, positions)
        modes, report = pictures.drawn(solved, positions, progress)
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

    def _in_words(self, error: Exception) -> str:
        """Return what keeps a picture from being made, as the commands say it."""
        match error:
            case InputError():
                return str(error)
            case SolveError():
                return error.located or str(error)
            case LateError():
                limit = "(`torsion solve` has no such limit)"
                return f"{self.file}: there is no picture within {LIMIT:.0f} s {limit}"
            case MemoryError():
                return "this machine has too little memory for it; request fewer speeds, orders or modes"
        return f"torsion has failed: {type(error).__name__}: {error}; please report it"

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
