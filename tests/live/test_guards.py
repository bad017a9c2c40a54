"""Who is answered: requests of the page itself alone, as raw bytes on a socket."""

import json
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.for_all import for_all

from torsion.live.server import MOST, Server
from torsion.live.session import Session

OK, BAD, FORBIDDEN, NOT_FOUND, NO_LENGTH, TOO_LARGE, WRONG_TYPE = 200, 400, 403, 404, 411, 413, 415
Send = Callable[..., tuple[int, str]]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server whose solver is not started: what it refuses never comes to it."""
    file = tmp_path_factory.mktemp("scene") / "pair.yaml"
    file.write_text("secret of the scene\n", encoding="utf-8")
    made = Server(Session(file))
    answering = threading.Thread(target=made.serve_forever, args=(0.01,))
    answering.start()
    yield made
    made.shutdown()
    answering.join()
    made.server_close()


@pytest.fixture
def send(server: Server) -> Send:
    """Send a request and return the status and all of the answer; None leaves a header out."""

    def sent(
        method: str, path: str, body: str = '{"seen": 0}', **changed: str | None
    ) -> tuple[int, str]:
        headers = {
            "Host": f"127.0.0.1:{server.server_port}",
            "Content-Type": "application/json",
            "X-Torsion-Token": server.token,
            "Content-Length": str(len(body)),
        } | {key.replace("_", "-"): value for key, value in changed.items()}
        lines = [
            f"{method} {path} HTTP/1.1",
            *(f"{key}: {one}" for key, one in headers.items() if one is not None),
        ]
        with socket.create_connection(("127.0.0.1", server.server_port), timeout=10) as made:
            made.sendall(
                "\r\n".join(
                    [*lines, "Connection: close", "", body if method == "POST" else ""]
                ).encode()
            )
            answer = b"".join(iter(lambda: made.recv(65536), b"")).decode()
        return int(answer.split()[1]), answer

    return sent


def test_the_page_and_its_requests_are_answered(send: Send, server: Server) -> None:
    status, answer = send("GET", "/", Host=f"localhost:{server.server_port}", Sec_Fetch_Site="none")
    assert status == OK
    assert server.token not in answer
    status, answer = send(
        "POST",
        "/next",
        Origin=f"http://127.0.0.1:{server.server_port}",
        Sec_Fetch_Site="same-origin",
    )
    assert status == OK
    assert json.loads(answer.partition("\r\n\r\n")[2])["name"].endswith("pair.yaml")


def test_a_token_has_256_bits_and_stands_in_the_fragment_alone(server: Server) -> None:
    before, _, token = server.address.partition("#")
    assert token == server.token
    assert len(token) * 6 >= 256
    assert before == f"http://127.0.0.1:{server.server_port}/"


@for_all("method", ["GET", "POST"])
@for_all(
    "changed",
    [
        {"Host": "evil.example"},
        {"Host": None},
        {"Host": "127.0.0.1"},
        {"Host": "127.0.0.1:1"},
        {"Host": "localhost"},
        {"Host": "127.0.0.1.evil.example"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "http://127.0.0.1"},
        {"Sec_Fetch_Site": "cross-site"},
        {"Sec_Fetch_Site": "same-site"},
    ],
)
def test_a_foreign_page_is_refused(send: Send, method: str, changed: dict[str, str | None]) -> None:
    assert send(method, "/" if method == "GET" else "/next", **changed)[0] == FORBIDDEN


def test_a_second_host_is_refused(send: Send, server: Server) -> None:
    twice = f"127.0.0.1:{server.server_port}\r\nHost: 127.0.0.1:{server.server_port}"
    assert send("GET", "/", Host=twice)[0] == FORBIDDEN


@pytest.mark.parametrize("token", [None, "", "x", "é"])
def test_a_request_without_the_token_is_refused(send: Send, token: str | None) -> None:
    assert send("POST", "/next", X_Torsion_Token=token)[0] == FORBIDDEN
    assert send("POST", "/set", '{"values": {}}', X_Torsion_Token=token)[0] == FORBIDDEN


@pytest.mark.parametrize(
    "path",
    [
        "/../pair.yaml",
        "/pair.yaml",
        "/%2e%2e/pair.yaml",
        "//etc/passwd",
        "/../../../../etc/passwd",
        "/live.js",
        "/?a",
        "*",
    ],
)
def test_no_path_reaches_the_disk(send: Send, path: str) -> None:
    for method in ("GET", "POST"):
        status, answer = send(method, path)
        assert status == NOT_FOUND
        assert answer.partition("\r\n\r\n")[2] == ""


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "HEAD", "PATCH"])
def test_no_other_method_is_known(send: Send, method: str) -> None:
    assert send(method, "/next")[0] == 501


@for_all(
    ("changed", "status"),
    [
        ({"Content_Type": "text/plain"}, WRONG_TYPE),
        ({"Content_Type": None}, WRONG_TYPE),
        ({"Content_Type": "application/x-www-form-urlencoded"}, WRONG_TYPE),
        ({"Content_Length": None}, NO_LENGTH),
        ({"Content_Length": "-1"}, NO_LENGTH),
        ({"Content_Length": "²"}, NO_LENGTH),
        ({"Transfer_Encoding": "chunked"}, NO_LENGTH),
        ({"Content_Length": str(MOST + 1)}, TOO_LARGE),
        ({"Content_Length": "9" * 5000}, TOO_LARGE),
    ],
)
def test_what_is_no_short_json_is_refused_unread(
    send: Send, changed: dict[str, str | None], status: int
) -> None:
    assert send("POST", "/next", **changed)[0] == status


@for_all(
    ("path", "body"),
    [
        ("/next", "{"),
        ("/next", "[]"),
        ("/next", "{}"),
        ("/next", '{"seen": "0"}'),
        ("/next", '{"seen": 0, "a": 1}'),
        ("/next", "[" * 100_000),
        ("/set", '{"values": [1]}'),
        ("/set", '{"values": {"a": "1"}}'),
        ("/set", '{"values": {"a": NaN}}'),
        ("/set", '{"values": {"a": 1e999}}'),
        ("/set", f'{{"values": {{"a": 1{"0" * 400}}}}}'),
        ("/set", '{"file": "/etc/passwd"}'),
    ],
)
def test_json_of_another_kind_is_refused(send: Send, path: str, body: str) -> None:
    assert send("POST", path, body)[0] == BAD


@pytest.mark.parametrize("path", ["/open", "/check", "/save", "/put"])
def test_no_request_writes(send: Send, path: str) -> None:
    assert send("POST", path, '{"text": "", "of": ""}')[0] == NOT_FOUND


def test_the_policy_lets_nothing_run_but_what_bears_the_nonce(send: Send) -> None:
    answers = [send("GET", "/")[1] for _ in range(2)]
    nonces = [answer.split("script-src 'nonce-")[1].split("'")[0] for answer in answers]
    assert nonces[0] != nonces[1]
    for nonce, answer in zip(nonces, answers, strict=True):
        head, _, page = answer.partition("\r\n\r\n")
        assert "default-src 'none'" in head
        assert "frame-ancestors 'none'" in head
        assert "X-Frame-Options: DENY" in head
        assert "unsafe-eval" not in head
        assert (
            page.count("<script") == page.count(f'<script nonce="{nonce}"') == 1
        )  # those of frames are in a text
        assert page.count("<iframe") == page.count('sandbox="allow-scripts"') == 2


def test_the_server_is_bound_to_this_machine(server: Server) -> None:
    assert server.server_address[0] == "127.0.0.1"


def test_nothing_was_written(server: Server) -> None:
    file = Path(server.session.file)
    assert [path.name for path in file.parent.iterdir()] == ["pair.yaml"]
    assert file.read_text(encoding="utf-8") == "secret of the scene\n"


def test_a_name_that_is_no_unicode_is_answered(send: Send, server: Server) -> None:
    server.session._show(faults={"text": "sc\udce9ne.yaml"})
    status, answer = send("POST", "/next")
    assert status == OK
    assert json.loads(answer.partition("\r\n\r\n")[2])["faults"]["text"] == "sc\udce9ne.yaml"
