"""How files of a user are read: a regular file of a stated size at most, as bytes; nothing else opens one."""

import errno
import os
import stat
from contextvars import ContextVar
from pathlib import Path

LARGEST_SCENE = 10_000_000  # bytes; a train of 20,000 stations has about 3 MB
LARGEST_TABLE = 20_000_000  # bytes; 200 a row of the longest table
LARGEST_SIGNAL = 100_000_000  # bytes; 50 a row of the longest signal
LARGEST_RESULTS = 500_000_000  # bytes
# Of a file: when it was written, its size, which one it is; None of a missing one.
Stamp = tuple[int, int, int] | None
# The files that are opened, also in vain, as they were before: what the live page follows.
OPENED: ContextVar[dict[str, Stamp] | None] = ContextVar("OPENED", default=None)


def stamp(file: str | Path) -> Stamp:
    """Return the stamp of a file as it is now."""
    try:
        status = os.stat(file)
    except (OSError, ValueError):
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


def read_file(file: str | Path, largest: int) -> bytes:
    """The content of a file of at most so many bytes; raises OSError, whose `strerror` says why it is not read.

    A device or a pipe is refused before it is opened: it may have no end, or wait for a writer.
    """
    check_file(file, largest)
    with open(file, "rb") as stream:
        content = stream.read(largest + 1)
    check_file(file, largest, len(content))  # it may have grown since, or state no size
    return content


def check_file(file: str | Path, largest: int, size: int = 0) -> None:
    """Raise OSError for what is no regular file, or larger than that (bytes); for a reader that opens it itself.

    size: as far as more is known of it than the file system says.
    """
    if (opened := OPENED.get()) is not None:
        opened.setdefault(os.path.abspath(file), stamp(file))
    status = os.stat(file)
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, "it is a folder", str(file))
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "it is a device or a pipe, not a file", str(file))
    if (size := max(size, status.st_size)) > largest:
        unit, name = (1e6, "MB") if largest >= 1e6 else (1e3, "kB")
        words = f"it has {size / unit:,.0f} {name}, at most {largest / unit:,.0f} {name} are read"
        raise OSError(errno.EFBIG, words, str(file))
