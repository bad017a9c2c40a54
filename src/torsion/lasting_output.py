"""Standard output and error that last: where they cannot be written any more, a command goes on."""

import io
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
