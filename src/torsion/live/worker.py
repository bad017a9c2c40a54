"""The process that solves for `torsion live`: it stays warm, and its latest request is the one that counts."""

import gc
import os
import signal
import sys
from collections.abc import Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from torsion.errors import InputError, SolveError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from torsion.schema.variation import Variation
    from torsion.study import Study

OWN = tuple(
    str(Path(path).resolve()) for path in (sys.prefix, sys.base_prefix, Path(__file__).parents[1])
)
NO_FILES = tuple(
    os.path.join(path, "") for path in (*OWN, "/proc", "/sys", "/dev")
)  # no folders of scenes
ORPHANED = 60  # s after which a solver ends itself whose command was killed
Stamp = (
    tuple[int, int, int] | None
)  # of a file: when it was written, its size, which one it is; None of a missing one


def stamp(file: str) -> Stamp:
    """Return the stamp of a file as it is now; None if it is missing."""
    try:
        status = os.stat(file)
    except (OSError, ValueError):
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


@dataclass(frozen=True)
class Request:
    """What is to be solved: a file, or one case of it, read again or with its sliders at these positions."""

    turn: int
    file: str
    case: str | None = None
    positions: Mapping[str, float] | None = None  # None: the file is read


class Overtaken(Exception):
    """A later request has come."""


class Reads:
    """The files that are opened for reading, also in vain, as they were then; what a picture follows from."""

    def __init__(self) -> None:
        self.stamps: dict[str, Stamp] = {}
        sys.addaudithook(self._heard)

    def _heard(self, event: str, details: tuple[Any, ...]) -> None:
        if (
            event != "open"
            or not isinstance(details[0], str | bytes)
            or "r" not in (details[1] or "r")
        ):
            return
        path = str(
            Path(details[0].decode() if isinstance(details[0], bytes) else details[0]).absolute()
        )
        if not path.startswith(NO_FILES) and not path.endswith((".py", ".pyc")):
            self.stamps.setdefault(path, stamp(path))


def work(pipe: Connection) -> None:
    """Answer requests until the other end of the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the command, which ends this process
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    gc.set_threshold(100_000, 20, 50)
    solver = Solver(pipe)
    while True:
        try:
            request = pipe.recv()
            while pipe.poll():
                request = pipe.recv()
            solver.answer(request)
        except (EOFError, OSError):
            return


class Solver:
    """Reads and solves; what was read last stays for the sliders."""

    def __init__(self, pipe: Connection) -> None:
        self.pipe, self.reads = pipe, Reads()
        self.read: tuple[Study, Variation] | None = None
        self.is_warm = False

    def answer(self, request: Request) -> None:
        """Send the pictures of a request, or its faults, one by one."""
        turn = request.turn
        if hasattr(signal, "alarm"):
            signal.alarm(ORPHANED)
        self.send(turn, began={})
        try:
            with _words_of_faults():
                self._pictures(request)
            self.send(turn, faults={"text": ""})
        except Overtaken:
            pass
        except _Faulty as fault:
            self.send(turn, faults={"text": str(fault)})
        self.send(turn, done={}, files=self.reads.stamps)
        if hasattr(signal, "alarm"):
            signal.alarm(0)
        if not self.is_warm:
            self.is_warm = True
            gc.freeze()

    def send(self, turn: int, **found: Any) -> None:
        """Send one message: what was found under its name."""
        self.pipe.send((turn, found))

    def _pictures(self, request: Request) -> None:
        from torsion.live import pictures, sliders

        if request.positions is None or self.read is None:
            self.read = None
            try:
                self.read = self._opened(request)
            finally:
                self.send(request.turn, files=self.reads.stamps)
        positions = request.positions or {}
        study, variation = self.read
        words = "; ".join(pictures.left_out(study))
        self.send(
            request.turn,
            sliders={"turn": request.turn, "each": sliders.shown(variation, positions)},
        )
        self.send(request.turn, notes={"text": f"Left out on this page: {words}." if words else ""})
        solved = sliders.moved_study(study, variation, positions)
        self.send(request.turn, modes={"turn": request.turn, **pictures.modes_of(solved)})
        report, modes = pictures.whole_of(solved, positions, self._progress)
        if modes is not None:
            self.send(request.turn, modes={"turn": request.turn, **modes})
        self.send(request.turn, report={"turn": request.turn, **report})

    def _opened(self, request: Request) -> "tuple[Study, Variation]":
        from torsion.commands import one_case
        from torsion.schema.scene_reader import read, reread
        from torsion.schema.variation import movable

        file = str(Path(request.file).absolute())
        self.reads.stamps = {file: stamp(file)}
        scene = read(request.file)
        study = scene if request.case is None else one_case(scene, request.case)
        return study, movable(study, *reread(study))

    def _progress(self, what: str, share: float) -> None:
        if self.pipe.poll():
            raise Overtaken


class _Faulty(Exception):
    """Why there is no picture, in words."""


@contextmanager
def _words_of_faults() -> "Iterator[None]":
    """Turn whatever keeps a picture from being made into words, as the commands say it."""
    try:
        yield
    except Overtaken:
        raise
    except InputError as error:
        raise _Faulty(str(error)) from None
    except SolveError as error:
        raise _Faulty(error.located or str(error)) from None
    except MemoryError:
        raise _Faulty(
            "this machine has too little memory for it; request fewer speeds, orders or modes"
        ) from None
    except Exception as error:  # the page outlives what is our fault
        raise _Faulty(
            f"torsion has failed: {type(error).__name__}: {error}; please report it"
        ) from None
