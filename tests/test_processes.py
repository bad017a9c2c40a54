"""Calls shared out to processes: the answers of one process in order, its errors, and no copies of copies.

Every test runs in a Python of its own, as a process with other threads (those of earlier tests) begins no copies.
"""

import subprocess
import sys

BEGIN = """
import os
from torsion import processes
from torsion.errors import InputError, SolveError, refusal
from torsion.processes import shared_out
processes.processors = lambda: 2
"""


def run(text: str) -> None:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", BEGIN + text],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_answers_of_processes_come_in_order_from_others_than_this_one() -> None:
    run("""
answers = list(shared_out(lambda item: (item, os.getpid()), range(100)))
assert [item for item, _ in answers] == list(range(100))
assert os.getpid() not in {process for _, process in answers}
""")


def test_a_process_begins_no_others_and_few_calls_none() -> None:
    run("""
def inner(item):
    return set(shared_out(lambda _: os.getpid(), range(50))) == {os.getpid()}

assert all(shared_out(inner, range(50)))
assert inner(0) is False  # this process does
assert set(shared_out(lambda _: os.getpid(), range(5))) == {os.getpid()}
""")


def test_an_error_of_a_process_is_raised_whole_and_later_calls_work() -> None:
    run("""
def fails(item):
    if item == 30:
        raise refusal("no", "try")
    return item

try:
    list(shared_out(fails, range(60)))
except InputError as error:
    assert "no" in str(error)
else:
    raise AssertionError("no error came")
assert list(shared_out(abs, range(60))) == list(range(60))
""")


def test_a_process_that_is_killed_is_said_and_leaves_nothing_behind() -> None:
    run("""
try:
    list(shared_out(lambda item: os.kill(os.getpid(), 9), range(60)))
except SolveError as error:
    assert "ended from outside" in str(error)
else:
    raise AssertionError("no error came")
assert list(shared_out(abs, range(60))) == list(range(60))
""")


def test_a_process_that_is_ended_does_not_go_on_with_the_handler_of_the_command() -> None:
    """The handler raised within a call, which was the answer of the copy: it then waited for ever, and its parent."""
    run("""
import signal, sys
signal.signal(signal.SIGTERM, lambda number, _: sys.exit(128 + number))
handlers = list(shared_out(lambda _: signal.getsignal(signal.SIGTERM), range(60)))
assert set(handlers) == {signal.SIG_DFL}
assert signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL
""")


def test_a_process_with_other_threads_answers_alone() -> None:
    run("""
import threading
end = threading.Event()
thread = threading.Thread(target=end.wait)
thread.start()
assert set(shared_out(lambda _: os.getpid(), range(50))) == {os.getpid()}
end.set()
thread.join()
""")
