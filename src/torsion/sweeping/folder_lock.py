"""One command at a time in the folder of a sweep: a file that says which process of which machine is at work."""

import os
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from torsion.errors import Fault, InputError, printable

LOCK = "sweep.lock"


@contextmanager
def alone(folder: Path, notice: Callable[[str], object]) -> Iterator[None]:
    """The folder for this process alone; raises InputError where another one is at work there.

    The lock of a process of this machine that has ended, killed or not, is taken over, and the notice says so.
    """
    folder.mkdir(parents=True, exist_ok=True)
    lock, content = folder / LOCK, f"{os.getpid()} {socket.gethostname()}"
    if not _taken(lock, content):
        before = lock.read_text(encoding="utf-8", errors="replace") if lock.exists() else ""
        if not _has_ended(before):
            process, _, host = before.partition(" ")
            who = (
                f"process {printable(process)} on {printable(host)}" if host else "another command"
            )
            message = f"{who} is at work in {folder}, as {lock} says"
            hint = "wait for it, or choose another folder with -o; if the process has ended, remove that file"
            raise InputError([Fault((), message, hint)], f"{message} ({hint})")
        notice(f"{lock} is from process {before.split()[0]}, which has ended: the sweep continues")
        stale = lock.with_name(f"{LOCK}.{os.getpid()}")
        lock.replace(stale)  # of two commands that find it, one alone moves it
        stale.unlink()
        if not _taken(lock, content):
            raise InputError([Fault((), f"another command has begun in {folder}")])
    try:
        yield
    finally:
        lock.unlink(missing_ok=True)


def _taken(lock: Path, content: str) -> bool:
    """The lock is written, which was not there."""
    try:
        descriptor = os.open(lock, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
    except FileExistsError:
        return False
    try:
        os.write(descriptor, content.encode())
    except OSError:
        lock.unlink(missing_ok=True)
        raise
    finally:
        os.close(descriptor)
    return True


def _has_ended(content: str) -> bool:
    """Of a process of this machine that is there no longer; also of this one, which took the number of that."""
    process, _, host = content.partition(" ")
    if (
        host != socket.gethostname() or not process.isdecimal() or os.name != "posix"
    ):  # elsewhere a signal may end it
        return False
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return True
    except (PermissionError, OverflowError):
        return False
    return int(process) == os.getpid()
