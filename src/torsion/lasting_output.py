"""Standard output and error that last: where they cannot be written any more, a command goes on."""

import io
import os
import sys
from typing import Any, TextIO


class Output(io.FileIO):
    """Standard output or error: where it cannot be written any more the command goes on, and its files are written."""

    lost: OSError | None = None  # the first reason for which something was not written

    def write(self, data: Any, /) -> int:
        """Bytes written, or given up."""
        if self.lost is None:
            try:
                return super().write(data)
            except OSError as error:
                self.lost = error
        return memoryview(data).nbytes


def lasting(stream: TextIO, number: int) -> tuple[io.TextIOWrapper, Output]:
    """A standard stream that lasts, and what it writes to."""
    stream.flush()
    raw = Output(number, "wb", closefd=False)
    buffered = io.BufferedWriter(raw)
    return io.TextIOWrapper(buffered, "utf-8", "replace", line_buffering=number == 2 or raw.isatty()), raw


def replace_closed_streams() -> None:
    """Open the null device for each standard stream that was closed when the program started.

    Else the next file that is opened takes the number of the stream, and what is written to the stream goes into it.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            stream = os.fdopen(os.open(os.devnull, os.O_RDWR), mode, encoding="utf-8", errors="replace")
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)
