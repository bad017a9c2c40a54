"""Chunks of the variants of a file: what is solved at once, in this process or on another machine, and kept as one."""

import time
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from torsion.arrays import FloatArray
from torsion.findings import Progress, silent
from torsion.what_if.variants.one_by_one import Answers


@dataclass(frozen=True)
class Chunk:
    """Variants from `begin` up to `end`, which it does not hold; their samples follow from these and the seed alone."""

    number: int
    begin: int
    end: int

    @property
    def size(self) -> int:
        """Number of variants from `begin` to `end`."""
        return self.end - self.begin


Part = tuple[FloatArray, Answers]  # values (variants, figures) of a chunk, and what they answer


def chunks(count: int, length: int) -> tuple[Chunk, ...]:
    """Variants in chunks of one length, the last one shorter.

    >>> [(one.begin, one.end) for one in chunks(10, 4)]
    [(0, 4), (4, 8), (8, 10)]
    """
    begins = range(0, count, length)
    return tuple(
        Chunk(number, begin, min(begin + length, count)) for number, begin in enumerate(begins)
    )


def joined(count: int, modes: int, parts: Iterable[Part]) -> Part:
    """All variants as one, of parts in the order of their chunks; each part is let go before the next is taken."""
    total, values, begin = Answers.empty(modes, count), np.empty((0, 0)), 0
    for chunk_values, answers in parts:
        if not values.size:
            values = np.empty((count, chunk_values.shape[1]))
        values[begin : begin + len(chunk_values)] = chunk_values
        total.take(begin, answers)
        begin += len(chunk_values)
    return values, total


@dataclass
class Pace:
    """How fast variants are solved, and the time that is left."""

    count: int
    progress: Progress = silent
    kept: int = 0  # variants that were solved before
    solved: int = 0
    start: float = field(default_factory=time.perf_counter)

    def within(self, chunk: Chunk) -> Progress:
        """The progress of one chunk as that of all."""
        return lambda what, share: self.show(share * chunk.size)

    def finish(self, chunk: Chunk) -> None:
        """Note that a chunk is solved, and show the progress."""
        self.solved += chunk.size
        self.show()

    def show(self, under_way: float = 0.0) -> None:
        """Variants, rate and time left, `more` being those of chunks under way."""
        solved, words = self.solved + under_way, ""
        if solved:
            rate = solved / max(time.perf_counter() - self.start, 1e-9)
            words = f", {rate:.3g} variants/s, {duration((self.count - self.kept - solved) / rate)} left"
        done = self.kept + solved
        self.progress(f"sweep, variant {done:.0f} of {self.count}{words}", done / self.count)


def duration(seconds: float) -> str:
    """A time in words.

    >>> duration(0.4), duration(200.0), duration(9000.0)
    ('about 1 s', 'about 3 min 20 s', 'about 2 h 30 min')
    """
    total = max(round(seconds), 1)
    if total < 60:
        return f"about {total} s"
    minutes, remainder = divmod(total, 60)
    return (
        f"about {minutes} min {remainder} s"
        if minutes < 60
        else f"about {minutes // 60} h {minutes % 60} min"
    )
