"""A sweep by workers of which one is killed, and then the command itself: nothing is lost and nothing solved twice."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from tests.contracts.frozen import SCENES

import torsion
from torsion.sweeping.sweeper import Sweeper
from torsion.what_if.sweep.sweep_results import Sweep

pytest.importorskip("pyarrow", reason="parts need pip install -e '.[sweep]'")
NAME = "toleranced_drive"
BY_ITSELF = "rules: [coupling-maker, {nvh: {at: motor, fluctuation: 200 rpm}}]"  # by which every variant is solved alone


def parts(folder: Path) -> dict[str, int]:
    """Every finished part, and when it was written."""
    finished = (path for path in (folder / "parts").glob("part-*") if path.suffix != ".part")
    return {path.name: path.stat().st_mtime_ns for path in finished}


def workers_of(process: int) -> list[int]:
    """Processes that a process began as workers."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            words = status.read_text().rpartition(")")[2].split()
            if int(words[1]) == process and b"torsion" in status.with_name("cmdline").read_bytes():
                found.append(int(status.parent.name))
        except OSError:  # it has ended
            continue
    return found


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks for processes in /proc")
def test_a_killed_worker_and_a_killed_command_lose_nothing(tmp_path: Path) -> None:
    text, scene, tmp_path = (
        SCENES[NAME].read_text(encoding="utf-8"),
        tmp_path / "scene.yaml",
        tmp_path / "out",
    )
    text = re.sub(r"\n  tolerances: .*", "", text)  # no part of a sweep, and a quarter of the time
    scene.write_text(text.replace("rules: [coupling-maker]", BY_ITSELF), encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "torsion",
        "sweep",
        str(scene),
        "-o",
        str(tmp_path),
        "--workers",
        "2",
    ]
    began = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)

    def until(count: int) -> None:
        end = time.monotonic() + 120.0
        while len(parts(tmp_path)) < count and began.poll() is None and time.monotonic() < end:
            time.sleep(0.005)

    until(1)
    workers = workers_of(began.pid)
    assert len(workers) == 2, began.stderr and began.stderr.read1().decode()
    os.kill(workers[0], signal.SIGKILL)
    assert b"ended from outside" in began.communicate(timeout=60)[1]
    first = parts(tmp_path)
    assert 1 <= len(first) < 8
    began = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    until(len(first) + 1)
    workers = workers_of(began.pid)
    began.kill()
    began.communicate(timeout=60)
    while any(Path(f"/proc/{worker}").exists() for worker in workers):
        time.sleep(0.01)  # they end with the command
    before = parts(tmp_path)
    assert len(first) < len(before) < 8
    with_workers = Sweeper(tmp_path)
    found = torsion.run(torsion.read(scene), answered=with_workers).need(Sweep)
    unchanged = before.items() & parts(tmp_path).items()
    assert with_workers.kept == len(unchanged)
    assert len(before) - 1 <= len(unchanged)  # the last part may lack its checksum yet
    assert with_workers.solved == 8 - len(unchanged)
    whole = torsion.run(torsion.read(scene)).need(Sweep)
    assert np.array_equal(found.factor, whole.factor)
    assert np.array_equal(found.frequency, whole.frequency)
    for mine, others in zip(found.checks, whole.checks, strict=True):
        assert np.array_equal(mine.utilisation, others.utilisation)
        assert np.array_equal(mine.fails, others.fails)


def test_no_command_of_the_documentation_opens_a_dashboard_to_the_network() -> None:
    root = Path(__file__).parents[2]
    pages = (root / "docs" / "how-to" / "study" / "cluster.md",)
    commands = [line for page in pages for line in page.read_text(encoding="utf-8").splitlines()]
    commands = [line for line in commands if line.startswith(("dask scheduler ", "dask worker "))]
    assert len(commands) == 2
    assert all(" --dashboard-address 127.0.0.1:0 " in line for line in commands)
