"""The command `torsion live`: its address, what it refuses, and how it ends."""

import signal
import socket
import subprocess
import sys
from pathlib import Path
from urllib.request import urlopen

import pytest
from typer.testing import CliRunner

from torsion.cli import app
from torsion.live.server import Server
from torsion.live.session import Session

SCENE = "name: pair\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"


@pytest.mark.parametrize("name", ["none.yaml", "."])
def test_what_is_no_file_is_refused(tmp_path: Path, name: str) -> None:
    done = CliRunner().invoke(app, ["live", str(tmp_path / name), "--no-browser"])
    assert (done.exit_code, done.output) == (2, f"{tmp_path / name}: this is no file\n")


def test_a_port_that_is_taken_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "pair.yaml"
    file.write_text(SCENE, encoding="utf-8")
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = CliRunner().invoke(app, ["live", str(file), "--no-browser", "--port", str(port)])
    assert done.exit_code == 2
    assert done.output.startswith(f"port {port} cannot be taken: ")


def test_a_port_is_free_again_as_soon_as_the_command_has_ended(tmp_path: Path) -> None:
    port = 0
    for _ in range(2):
        server = Server(Session(tmp_path / "pair.yaml"), port)
        port = server.server_port
        with socket.create_connection(("127.0.0.1", port)) as made:
            made.sendall(b"GET / HTTP/1.0\r\n\r\n")
            server.handle_request()
            assert (
                made.makefile().read().startswith("HTTP/1.1 403")
            )  # and the server has ended the connection first
        server.server_close()


def test_ctrl_c_ends_it_without_a_word(tmp_path: Path) -> None:
    file = tmp_path / "pair.yaml"
    file.write_text(SCENE, encoding="utf-8")
    command = [sys.executable, "-m", "torsion", "live", str(file), "--no-browser"]
    before = signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # a shell's job in the background ignores Ctrl-C
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        signal.signal(signal.SIGINT, before)
        assert process.stdout is not None
        first, second = process.stdout.readline(), process.stdout.readline()
        with urlopen(first.split()[-1].partition("#")[0]) as page:  # it has begun to answer
            assert page.status == 200
        process.send_signal(signal.SIGINT)
        rest, errors = process.communicate(timeout=60)
    assert first.startswith(f"{file} is shown at http://127.0.0.1:")
    assert (second, rest, errors, process.returncode) == ("Ctrl-C ends it\n", "", "", 0)
    assert [path.name for path in tmp_path.iterdir()] == ["pair.yaml"]
