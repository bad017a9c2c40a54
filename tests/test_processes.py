"""Calls shared out to processes: the answers of one process in order, its errors, and no copies of copies."""

import os

import pytest

from torsion import processes
from torsion.errors import InputError, SolveError, refusal
from torsion.processes import shared_out


@pytest.fixture
def two(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "processors", lambda: 2)


@pytest.mark.usefixtures("two")
def test_answers_of_processes_come_in_order_from_others_than_this_one() -> None:
    answers = list(shared_out(lambda item: (item, os.getpid()), range(100)))
    assert [item for item, _ in answers] == list(range(100))
    assert os.getpid() not in {process for _, process in answers}


@pytest.mark.usefixtures("two")
def test_a_process_begins_no_others_and_few_calls_none() -> None:
    def inner(item: int) -> bool:
        own = set(shared_out(lambda _: os.getpid(), range(50)))
        return own == {os.getpid()}

    assert all(shared_out(inner, range(50)))
    assert inner(0) is False  # this process does
    assert set(shared_out(lambda _: os.getpid(), range(5))) == {os.getpid()}


@pytest.mark.usefixtures("two")
def test_an_error_of_a_process_is_raised_whole_and_later_calls_work() -> None:
    def fails(item: int) -> int:
        if item == 30:
            raise refusal("no", "try")
        return item

    with pytest.raises(InputError, match="no"):
        list(shared_out(fails, range(60)))
    assert list(shared_out(abs, range(60))) == list(range(60))


@pytest.mark.usefixtures("two")
def test_a_process_that_is_killed_is_said_and_leaves_nothing_behind() -> None:
    with pytest.raises(SolveError, match="ended from outside"):
        list(shared_out(lambda item: os.kill(os.getpid(), 9), range(60)))
    assert list(shared_out(abs, range(60))) == list(range(60))
