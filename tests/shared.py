"""What is slow to make and the same in every worker of a run of the tests: made once, under a lock, and read again."""

import contextlib
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

try:
    import fcntl
except ImportError:  # not a POSIX system: every worker makes its own
    fcntl = None  # type: ignore[assignment]

Made = TypeVar("Made")
SHARED = (
    "TORSION_TESTS_SHARED"  # names the folder in the environment; none where one process runs all
)


def shared(name: str, make: Callable[[], Made]) -> Made:
    """Return what `make` returns, or the copy that a worker has left under this name."""
    if SHARED not in os.environ or fcntl is None:
        return make()
    folder = Path(os.environ[SHARED])
    file = folder / f"{name}.pickle"
    with (folder / f"{name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if file.exists():
            return pickle.loads(file.read_bytes())
        made = make()
        # What holds a function of its own cannot be copied: the other worker makes it again.
        with contextlib.suppress(AttributeError, TypeError, pickle.PicklingError):
            file.write_bytes(pickle.dumps(made, pickle.HIGHEST_PROTOCOL))
        return made
