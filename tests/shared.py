"""What is slow to make and the same in every worker of a run of the tests: made once, under a lock, and read again."""

import contextlib
import os
import pickle
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeVar

try:
    import fcntl
except ImportError:  # not a POSIX system: every worker makes its own
    fcntl = None  # type: ignore[assignment]

Made = TypeVar("Made")
_folders: list[Path] = []  # of the run; none where a single process runs all tests


@contextlib.contextmanager
def sharing(folder: Path) -> Iterator[None]:
    """Share through a folder that all workers know."""
    if fcntl is not None:
        _folders.append(folder)
    try:
        yield
    finally:
        _folders.clear()


def shared(name: str, make: Callable[[], Made]) -> Made:
    """Return what `make` returns, or the copy that a worker has left under this name."""
    if not _folders:
        return make()
    (folder,) = _folders
    folder.mkdir(exist_ok=True)
    with (folder / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        file = folder / f"{name}.pickle"
        if file.exists():
            return pickle.loads(file.read_bytes())
        made = make()
        # What holds a function of its own cannot be copied: the other worker makes it again.
        with contextlib.suppress(AttributeError, TypeError, pickle.PicklingError):
            copy = pickle.dumps(made, pickle.HIGHEST_PROTOCOL)
            whole = file.with_suffix(f".{os.getpid()}")
            whole.write_bytes(copy)
            whole.replace(file)
        return made
