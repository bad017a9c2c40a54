"""One command at a time in the folder of a sweep: the system's lock on a file, which ends with its process."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from torsion.errors import printable, refusal

LOCK = "sweep.lock"


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """The folder for this process alone; raises InputError where another one is at work there.

    On Windows, which has no such lock, it is for the user to see to it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / LOCK).open("a+", encoding="utf-8", errors="replace") as file:
        if os.name == "posix":
            import fcntl

            try:
                fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                file.seek(0)
                message = f"{printable(file.read()) or 'another command'} is at work in {folder}"
                raise refusal(message, "wait for it, or choose another folder with -o") from None
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}")
        file.flush()
        try:
            yield
        finally:
            (folder / LOCK).unlink(missing_ok=True)
