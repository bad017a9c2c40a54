"""A command that is stated to end while it writes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

MOTION = """name: x
train:
- disc: {name: a, inertia: 1}
- coupling: {name: c, stiffness: 1e5, %s}
- disc: {name: b, inertia: 3}
analyses:
  transient:
  - {name: one, duration: %s, initial: rest, samples: 60000, export: npz, events: [{at: a, %s}]}
  - {name: two, duration: 1 s, initial: rest, samples: 60000, export: csv, events: [{at: a, step: {torque: 1}}]}
"""
SOON = MOTION % ("viscous: 10", "1 s", "step: {torque: 1}")  # seconds of writing
LONG = MOTION % (
    "clearance: 0.1 deg",
    "1e4 s",
    "sine: {torque: 100, frequency: 20 Hz}",
)  # minutes of impacts
SCENE = "name: x\ntrain:\n" + "- disc: {inertia: 1}\n- coupling: {stiffness: 1e4}\n" * 60


@pytest.mark.skipif(os.name != "posix", reason="ends by signals")
def test_a_command_that_is_told_to_end_leaves_the_earlier_report_alone_and_nothing_else(
    tmp_path: Path,
) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("earlier", encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "torsion",
        "solve",
        str(tmp_path / "scene.yaml"),
        "-o",
        str(out),
        "--pdf",
    ]
    started = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    while not list(out.glob(".report-*")) and started.poll() is None:
        time.sleep(0.01)
    started.send_signal(signal.SIGTERM)
    _, stated = started.communicate(timeout=60)
    assert started.returncode == 128 + signal.SIGTERM, stated
    assert [path.name for path in out.iterdir()] == ["report.html"]
    assert (out / "report.html").read_text(encoding="utf-8") == "earlier"
    assert stated == b""


@pytest.mark.skipif(os.name != "posix", reason="ends by signals")
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize(
    ("scene", "during"), [(LONG, "motion"), (SOON, "writing")], ids=["motion", "writing"]
)
def test_motions_over_time_that_are_killed_leave_the_earlier_files_whole(
    tmp_path: Path, scene: str, during: str, how: signal.Signals
) -> None:
    (tmp_path / "scene.yaml").write_text(scene, encoding="utf-8")
    out = tmp_path / "out"
    out.mkdir()
    earlier = ("report.html", "results.json", "motion.npz", "motion-two.csv")
    for name in earlier:
        (out / name).write_text("earlier", encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "torsion",
        "solve",
        str(tmp_path / "scene.yaml"),
        "-o",
        str(out),
    ]
    started = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    end = time.monotonic() + (2.0 if during == "motion" else 60.0)
    while (
        not list(out.glob(".report-*/motion*"))
        and started.poll() is None
        and time.monotonic() < end
    ):
        time.sleep(0.005)
    started.send_signal(how)
    started.communicate(timeout=60)
    assert started.returncode == (128 + how if how == signal.SIGTERM else -how)
    left = {path.name for path in out.iterdir() if not path.name.startswith(".report-")}
    assert left == set(earlier)
    assert all((out / name).read_text(encoding="utf-8") == "earlier" for name in earlier)
    assert how == signal.SIGKILL or not list(out.glob(".report-*"))


@pytest.mark.skipif(os.name != "posix", reason="closes streams as a shell does")
@pytest.mark.parametrize(
    ("limit", "status", "closed"),
    [
        ("1 N*m", 1, "2>&-"),
        ("1 N*m", 1, ">&-"),
        ("1 N*m", 1, "<&- >&- 2>&-"),
        ("1 kN*m", 0, ">&- 2>&-"),
    ],
    ids=[
        "fails without errors",
        "fails without output",
        "fails without any",
        "passes without both",
    ],
)
def test_a_closed_stream_changes_neither_the_report_nor_the_exit_status(
    limit: str, status: int, closed: str, tmp_path: Path
) -> None:
    coupling = f"coupling: {{stiffness: 1e4, psi: 1, rated_torque: {limit}}}"
    text = f"""name: x
operation: {{speeds: {{from: 300 rpm, to: 900 rpm, steps: 3}}, rated: {{speed: 900 rpm, power: 10 kW}}}}
train: [motor: {{inertia: 1}}, {coupling}, propeller: {{inertia: 2}}]
rules: [coupling-maker]
"""
    (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
    words = f'exec "{sys.executable}" -m torsion solve scene.yaml -o out {closed}'
    assert subprocess.run(["sh", "-c", words], cwd=tmp_path, check=False).returncode == status
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "report.html",
        "results.json",
    ]
    assert (tmp_path / "out" / "results.json").read_bytes().startswith(b'{\n"format"')
