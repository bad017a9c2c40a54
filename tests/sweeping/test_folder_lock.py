"""One command at a time in the folder of a sweep."""

import os
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from torsion.errors import InputError
from torsion.sweeping.folder_lock import LOCK, alone


def test_a_folder_in_which_a_process_is_at_work_is_refused(tmp_path: Path) -> None:
    (tmp_path / LOCK).write_text(f"{os.getppid()} {socket.gethostname()}", encoding="utf-8")
    with (
        pytest.raises(InputError, match=f"process {os.getppid()} on .* is at work"),
        alone(tmp_path, print),
    ):
        pass
    (tmp_path / LOCK).write_text("1 another-machine", encoding="utf-8")
    with pytest.raises(InputError, match="another-machine"), alone(tmp_path, print):
        pass


def test_the_lock_of_a_process_that_has_ended_is_taken_over_and_that_is_said(
    tmp_path: Path,
) -> None:
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    (tmp_path / LOCK).write_text(f"{ended.pid} {socket.gethostname()}", encoding="utf-8")
    said: list[str] = []
    with alone(tmp_path, said.append):
        assert (tmp_path / LOCK).read_text(encoding="utf-8").startswith(f"{os.getpid()} ")
    assert [str(ended.pid) in words for words in said] == [True]
    assert list(tmp_path.iterdir()) == []
