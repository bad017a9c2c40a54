"""How large a response gets: refused beforehand where it needs more memory than it may, else computed in blocks."""

from collections.abc import Iterator

from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path

BLOCK_VALUES = 2**22  # points times stations of one line solved at once: 64 MB an array
SMALL_BLOCK = 2**20  # the same of the synthesis, which needs some twenty arrays on the way
COMPLEX, REAL = 16, 8  # bytes
COPIES = 2  # of all amplitudes, while points are added or written
REAL_ROWS = 5  # of a span over the points: mean torque, half range, peak, RMS, bound


def blocks(points: int, system: System, values: int = BLOCK_VALUES) -> Iterator[slice]:
    """Points in blocks; one block for all but large trains."""
    length = max(values // max(len(system.stations), len(system.spans), 1), 1)
    return (slice(start, start + length) for start in range(0, max(points, 1), length))


def refuse_too_large(system: System, points: int, lines: int, limit: float, path: Path, axis: str) -> None:
    """Raise InputError where a response of so many points needs more memory than `limit` (bytes).

    `path` is where the file gives the points, `axis` what they are.
    """
    stations, spans = len(system.stations), len(system.spans)
    needed = points * (COPIES * COMPLEX * lines * (stations + spans) + REAL * REAL_ROWS * spans)
    if needed <= limit:
        return
    count = f"up to {points} {axis} (those around resonances included) x {lines} orders x {stations} stations"
    message = f"the response has {count}, which needs about {in_gigabytes(needed)}; {in_gigabytes(limit)} are allowed"
    most = max(system.segments, key=lambda name: system.segments[name], default="")
    finer = f", fewer segments of `{most}` ({system.segments[most]})" if most and system.segments[most] > 1 else ""
    hint = f"a narrower range or fewer steps, fewer orders{finer}, or --memory {in_gigabytes(1.1 * needed, 2)}"
    raise InputError([Fault(path, message, hint.replace(" GB", "GB"))])


def in_gigabytes(number: float, digits: int = 3) -> str:
    """Bytes in words."""
    return f"{number / 1e9:.{digits}g} GB"
