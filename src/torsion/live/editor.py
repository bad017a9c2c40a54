"""The editor's process: it reads texts and writes the file, and is stopped where a text takes too long."""

import multiprocessing
import signal
import threading
from collections.abc import Callable, Mapping
from multiprocessing.pool import Pool
from typing import Any

from torsion.live import editing
from torsion.live.session import LIMIT, warm_context


class Editor:
    """One file, edited until `end`."""

    def __init__(self, file: str, case: str | None = None) -> None:
        self._file, self._case = file, case
        self._lock = threading.Lock()
        self._pool: Pool | None = None

    def opened(self) -> editing.Answer:
        """The text of the file, what it was read from, its faults, and the keys that may stand in it."""
        return self._answer(editing.opened)

    def checked(self, text: str) -> editing.Answer:
        """The faults of another text."""
        return self._answer(editing.faults, text)

    def saved(self, text: str, of: str) -> editing.Answer:
        """A text written in place of that which was read."""
        return self._answer(editing.saved, text, of)

    def put(self, positions: Mapping[str, float], of: str) -> editing.Answer:
        """The figures of moved sliders written into the file."""
        return self._answer(editing.put, positions, of, self._case)

    def end(self) -> None:
        """Stop the process, also while it reads."""
        self._stop()

    def _answer(self, function: Callable[..., editing.Answer], *details: Any) -> editing.Answer:
        with self._lock:
            if self._pool is None:
                self._pool = warm_context().Pool(1, signal.signal, (signal.SIGINT, signal.SIG_IGN))
            try:
                return self._pool.apply_async(function, (self._file, *details)).get(LIMIT)
            except multiprocessing.TimeoutError:
                self._stop()
                return {"refused": f"{self._file}: no answer within {LIMIT:.0f} s"}
            except (OSError, ValueError) as error:
                return {"refused": f"{self._file}: {error}"}

    def _stop(self) -> None:
        if self._pool is not None:
            self._pool.terminate()
        self._pool = None
