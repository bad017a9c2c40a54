"""Standard output and error that last: where they cannot be written any more, a command goes on."""

import io
import os
import sys
from typing import Any

from torsion.errors import without_controls


def say(words: str, err: bool = False) -> None:
    """Print words that may quote names of files: no control character reaches the terminal."""
    print(without_controls(words), file=sys.stderr if err else sys.stdout)


class Output(io.FileIO):
    """Standard output or error: where it cannot be written any more the command goes on, and its files are written."""

    lost: OSError | None = None  # the first reason for which something was not written

    def write(self, data: Any, /) -> int:
        """Write the bytes, or drop them after the first failure; return their number."""
        if self.lost is None:
            try:
                return super().write(data)
            except OSError as error:
                self.lost = error
        return memoryview(data).nbytes


def make_streams_last() -> Output | None:
    """Replace standard output and error by streams that last; return what standard output writes to.

    Streams that were redirected inside of Python stay, as do those of another system than POSIX: None then.
    """
    # The null device is opened for each stream that was closed when the program started: else the next file that is
    # opened takes the number of the stream, and what is written to the stream goes into it.
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            null = os.open(os.devnull, os.O_RDWR)
            opened = os.fdopen(null, mode, encoding="utf-8", errors="replace")
            setattr(sys, name, opened)
            setattr(sys, f"__{name}__", opened)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(encoding="utf-8", errors="replace")
    if (
        os.name != "posix"
        or sys.stdout is not sys.__stdout__
        or sys.stdout is None
        or sys.stderr is None
    ):
        return None
    for number, name in ((2, "stderr"), (1, "stdout")):
        getattr(sys, name).flush()
        output = Output(number, "wb", closefd=False)
        is_by_line, buffered = number == 2 or output.isatty(), io.BufferedWriter(output)
        lasting = io.TextIOWrapper(buffered, "utf-8", "replace", line_buffering=is_by_line)
        setattr(sys, name, lasting)
    return output
