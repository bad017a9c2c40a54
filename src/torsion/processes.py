"""One function called many times, shared out to processes of this machine; the answers come in order."""

import ctypes
import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from torsion.errors import SolveError

FEWEST = 24  # calls for which processes are begun: that takes as long as a few calls
CHUNKS = 16  # of calls sent to each process, so that none waits long for another at the end
SET_DEATH_SIGNAL = 1  # of prctl: what a process gets when its parent has ended
LONGEST_CHUNK = 16  # calls between two answers
Item = TypeVar("Item")
Answer = TypeVar("Answer")
# What the processes were begun for.
_task: "tuple[Callable[[Any], Any], Sequence[Any]] | None" = None


def shared_out(
    function: Callable[[Item], Answer],
    items: Sequence[Item],
    *,
    fewest: int = FEWEST,
    most: int | None = None,
) -> Iterator[Answer]:
    """Yield the answer to every item in order, from as many processes as this one may use processors.

    The processes are copies of this one (fork): they know the function and the items, and send back the answers
    alone, which must be picklable. An exception of the function is raised here. Where there are fewer items than
    `fewest`, one processor (or `most` is 1), other threads, or no fork, this process answers alone. Raises SolveError
    where a process is killed.

    >>> list(shared_out(abs, [-1, 2, -3]))
    [1, 2, 3]
    """
    global _task  # noqa: PLW0603 - the copies find the task there
    workers = min(most or processors(), len(items))

    # A copy is whole where no other thread is at work; the libraries of macOS do not stand a fork.
    may_copy = (
        _task is None
        and sys.platform == "linux"
        and threading.active_count() == 1
        and not multiprocessing.current_process().daemon
    )
    if len(items) < fewest or workers < 2 or not may_copy:
        yield from map(function, items)
        return

    length = max(1, min(len(items) // (workers * CHUNKS), LONGEST_CHUNK))
    pool = ProcessPoolExecutor(workers, multiprocessing.get_context("fork"), _begin)
    _task = function, items
    try:
        with warnings.catch_warnings():
            # Python warns of threads at a fork; those of OpenBLAS stop before it.
            warnings.simplefilter("ignore", DeprecationWarning)
            answers = pool.map(_call, range(len(items)), chunksize=length)
        yield from answers
    except BrokenProcessPool:
        raise SolveError(
            "a process of this machine that solved variants was ended from outside",
            "more memory, or fewer programs beside this one",
        ) from None
    finally:
        _task = None
        pool.shutdown(cancel_futures=True)


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1


def _begin() -> None:
    """Begin a copy: Ctrl-C and the end of this process are heard by this one, which ends its copies."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # A handler of the command would raise within the call of a copy, which would answer with it and wait for ever.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    ctypes.CDLL(None).prctl(SET_DEATH_SIGNAL, signal.SIGKILL)


def _call(position: int) -> Any:
    if _task is None:
        raise LookupError("the process was begun without a task")
    function, items = _task
    return function(items[position])
