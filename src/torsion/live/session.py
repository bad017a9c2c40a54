"""What `torsion live` follows: a file and those it reads, a process that solves, and what its pages show."""

import multiprocessing
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from multiprocessing.connection import Connection
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from torsion.live.worker import Request, Stamp, stamp, work

TICK = 0.025  # s between two looks at the files
GONE = 8  # ticks that a file may be missing for, while an editor puts another in its place
LIMIT = 20.0  # s that a picture may take
PATIENCE = 1.0  # s for which a solver may go on that a later request has overtaken
WAIT = 20.0  # s after which a page that waits for news hears that there are none


class Session:
    """One file, followed until `end`."""

    def __init__(self, file: str | Path, case: str | None = None) -> None:
        self.file, self.case = str(file), case
        self._lock = threading.Condition(threading.RLock())
        self._news: dict[
            str, tuple[int, Any]
        ] = {}  # what pages show, each with the count of its change
        self._count, self._turn = 0, 0
        self._latest: Request | None = None
        self._is_busy, self._is_ended = False, False
        self._at, self._began = 0, 0.0  # the request that the solver has begun last, and when
        self._limit, self._overtaken = float("inf"), float("inf")  # when the solver is stopped
        self._pipe: Connection | None = None
        self._process: BaseProcess | None = None
        self._files: dict[str, Stamp] = {path: stamp(path) for path in [str(Path(file).absolute())]}
        self._context = warm_context()
        self._show(name=self.file if case is None else f"{self.file}, case {case}")

    def start(self) -> None:
        """Begin to solve, and to look at the files."""
        self._request(None)
        for task in (self._receive, self._watch):
            threading.Thread(target=task, daemon=True).start()

    def end(self) -> None:
        """Stop the solver, and let every page go that waits."""
        with self._lock:
            self._is_ended = True
            self._lock.notify_all()
            if self._process is not None:
                self._process.kill()

    def move(self, positions: Mapping[str, float]) -> int:
        """Solve with the sliders at these positions; the number of the request."""
        return self._request(dict(positions))

    def news(self, seen: int, wait: float = WAIT) -> dict[str, Any]:
        """Return what has changed since a page has seen that many changes, as soon as there is anything."""
        with self._lock:
            if seen > self._count:  # of another run
                seen = 0
            self._lock.wait_for(lambda: self._count > seen or self._is_ended, wait)
            news = {key: value for key, (count, value) in self._news.items() if count > seen}
            return {"seen": self._count, **news}

    def _show(self, **found: Any) -> None:
        with self._lock:
            for key, value in found.items():
                if self._news.get(key, (0, None))[1] != value:
                    self._count += 1
                    self._news[key] = self._count, value
            self._lock.notify_all()

    def _request(self, positions: Mapping[str, float] | None) -> int:
        """Request the file read again, or its sliders at other positions."""
        with self._lock:
            self._turn += 1
            if positions is None:
                self._show(file={"turn": self._turn})
            self._latest = Request(self._turn, self.file, self.case, positions)
            if self._is_busy:
                self._overtaken = min(self._overtaken, time.monotonic() + PATIENCE)
            self._send()
            return self._turn

    def _send(self) -> None:
        self._show(state={"text": "solving …"})
        if self._pipe is None:  # it is being started
            return
        if not self._is_busy:
            self._limit = time.monotonic() + LIMIT
        self._is_busy = True
        with suppress(OSError):  # it has just ended; who hears that sends it again
            self._pipe.send(self._latest)

    def _start_worker(self) -> None:
        """Start a process that solves, with the latest request; the first takes a second or two, others start warm."""
        near, far = self._context.Pipe()
        process: BaseProcess = self._context.Process(target=work, args=(far,), daemon=True)  # type: ignore[attr-defined]
        process.start()
        far.close()
        with self._lock:
            self._at, self._is_busy = 0, False
            self._limit = self._overtaken = float("inf")
            self._pipe, self._process = near, process
            if self._is_ended:
                process.kill()

    def _receive(self) -> None:
        """Show what the solver finds; where it ends, start another."""
        self._start_worker()
        with self._lock:
            self._send()
        while not self._is_ended and self._pipe is not None:
            try:
                turn, news = self._pipe.recv()
            except (EOFError, OSError):
                self._restart()
                continue
            with self._lock:
                self._heard(turn, news)

    def _heard(self, turn: int, news: dict[str, Any]) -> None:
        """Take one message of the solver."""
        self._files = news.pop("files", self._files)
        if "began" in news:
            self._at, self._began = turn, time.monotonic()
            self._limit = self._began + LIMIT
            self._overtaken = float("inf") if turn == self._turn else self._began + PATIENCE
        elif "done" in news:
            self._limit = float("inf")
            if turn == self._turn:
                self._is_busy = False
                took = 1e3 * (time.monotonic() - self._began)
                self._show(
                    state={"text": "" if self._faults else f"solved and drawn in {took:.0f} ms"}
                )
        else:
            self._show(**news)

    @property
    def _faults(self) -> str:
        return str(self._news.get("faults", (0, {"text": ""}))[1]["text"])

    def _restart(self) -> None:
        """Start another solver in place of one that has ended; repeat the latest request if that came later."""
        with self._lock:
            if self._is_ended or self._process is None:
                return
            self._process.join()
            is_late, is_pending = time.monotonic() > self._limit, 0 < self._at < self._turn
            self._start_worker()
            if is_pending:
                self._send()
                return
            why = (
                f"there is no picture within {LIMIT:.0f} s"
                if is_late
                else "the process that solves has ended"
            )
            self._show(
                faults={"text": f"{self.file}: {why} (`torsion solve` has no such limit)"},
                state={"text": ""},
            )

    def _watch(self) -> None:
        """Request a picture when a file has changed, and stop a solver that takes too long."""
        before, missing, is_settled = self._files, 0, True
        while not self._is_ended:
            time.sleep(TICK)
            with self._lock:
                if self._process is not None and time.monotonic() > min(
                    self._limit, self._overtaken
                ):
                    self._process.kill()
            before = {
                path: before.get(path, read) for path, read in self._files.items()
            }  # followed before, or as read
            stamps = {path: stamp(path) for path in before}
            missing = (
                missing + 1 if any(before[path] and not stamps[path] for path in stamps) else 0
            )
            if 0 < missing < GONE:
                continue
            if stamps != before:
                before, is_settled = stamps, False
            elif not is_settled:
                is_settled = True
                self._request(None)


def warm_context() -> BaseContext:
    """Return a context of processes that begin warm, if the system has them."""
    is_known = "forkserver" in multiprocessing.get_all_start_methods()
    context = multiprocessing.get_context("forkserver" if is_known else "spawn")
    if is_known:
        context.set_forkserver_preload(["torsion.live.warm"])
    return context
