"""One command at a time in the folder of a sweep."""

import subprocess
import sys
from pathlib import Path

import pytest

from torsion.errors import InputError
from torsion.sweeping.sweep_folder import LOCK, alone

HOLDING = """
import sys
from pathlib import Path
from torsion.sweeping.sweep_folder import alone

with alone(Path(sys.argv[1])):
    print("at work", flush=True)
    sys.stdin.read()
"""


def test_a_folder_in_which_a_process_is_at_work_is_refused_until_it_ends(tmp_path: Path) -> None:
    command = [sys.executable, "-c", HOLDING, str(tmp_path)]
    holder = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert holder.stdout is not None
    holder.stdout.readline()
    with pytest.raises(InputError, match=f"process {holder.pid} on .* is at work"), alone(tmp_path):
        pass
    holder.kill()
    holder.communicate()
    with alone(tmp_path):
        assert (tmp_path / LOCK).exists()
    assert list(tmp_path.iterdir()) == []
