"""A command that is stated to end while it writes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

SCENE = "name: x\ntrain:\n" + "- disc: {inertia: 1}\n- coupling: {stiffness: 1e4}\n" * 60


@pytest.mark.skipif(os.name != "posix", reason="ends by signals")
def test_a_command_that_is_told_to_end_leaves_the_earlier_report_alone_and_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("earlier", encoding="utf-8")
    command = [sys.executable, "-m", "torsion", "solve", str(tmp_path / "scene.yaml"), "-o", str(out), "--pdf"]
    started = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    while not list(out.glob(".report-*")) and started.poll() is None:
        time.sleep(0.01)
    started.send_signal(signal.SIGTERM)
    _, stated = started.communicate(timeout=60)
    assert started.returncode == 128 + signal.SIGTERM, stated
    assert [path.name for path in out.iterdir()] == ["report.html"]
    assert (out / "report.html").read_text(encoding="utf-8") == "earlier"
    assert stated == b""
