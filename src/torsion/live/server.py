"""The server of `torsion live`: one page and two requests, for this machine alone.

Bound to 127.0.0.1. Host and Origin must be its own (against rebinding of names and requests of other pages), every
request but that for the page bears a token, which stands in the fragment of the address alone, and no path of a
request reaches the disk: nothing is read but what the session follows, and nothing is written.
"""

import hmac
import json
import os
import secrets
import sys
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from torsion.live.session import Session
from torsion.output.pages.html import script, style, template_text

FILES = Path(__file__).parent
NOTHING = '{"lengths":[],"names":[],"doubles":"eJwDAAAAAAE="}'  # numbers of a page without figures
POLICY = (  # of the page and, as it has no address of its own, of its frames
    "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'; "
    "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
)


def page() -> str:
    """Return the page, in which `@NONCE@` stands for what its policy allows to run."""
    frame = _filled(
        "frame.html",
        STYLE=style(),
        SCRIPT=f"{script()}\n{template_text('frame.js', FILES)}",
        NUMBERS=NOTHING,
    )
    shell = json.dumps(frame, ensure_ascii=False).replace("<", "\\u003c")
    look = f"{style()}\n{template_text('live.css', FILES)}"
    return _filled(
        "live.html",
        STYLE=look,
        SCRIPT=template_text("live.js", FILES),
        FRAME=shell,
    )


def _filled(name: str, **texts: str) -> str:
    """Return the text of a file with `@KEY@` replaced; nothing is replaced in what was put there."""
    first, *parts = template_text(name, FILES).split("@")
    return first + "".join(
        texts.get(part, f"@{part}@" if position % 2 == 0 else part)
        for position, part in enumerate(parts)
    )


MOST = 1_000_000  # bytes of a request
TOKEN = "X-Torsion-Token"  # the header that bears it
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}


class Refusal(Exception):
    """A request that is not answered, by its status."""


class Server(ThreadingHTTPServer):
    """Shows one session; raises OSError where the port is taken. Port 0 is any that is free."""

    daemon_threads = True
    allow_reuse_address = (
        os.name == "posix"
    )  # at once after another has ended there; of one that listens none is taken

    def __init__(self, session: Session, port: int = 0) -> None:
        super().__init__(("127.0.0.1", port), Handler)
        self.session, self.token = session, secrets.token_urlsafe(32)
        self.page = page()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Report an error unless the connection broke off, which is no fault."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)

    def end(self) -> None:
        """Answer no more, and stop what solves and reads for it."""
        self.session.end()
        self.server_close()

    @property
    def address(self) -> str:
        """Of the page, with the token."""
        return f"http://127.0.0.1:{self.server_port}/#{self.token}"


class Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: Server
    server_version, sys_version, protocol_version = "torsion", "", "HTTP/1.1"
    timeout, disable_nagle_algorithm = 60, True

    def do_GET(self) -> None:
        """Answer a request for the page itself."""
        try:
            self._is_own()
            if self.path != "/":
                raise Refusal(404)
        except Refusal as refusal:
            self._answer(int(refusal.args[0]))
            return
        nonce = secrets.token_urlsafe(16)
        body = self.server.page.replace("@NONCE@", nonce).encode()
        policy = {"Content-Security-Policy": POLICY.format(nonce=nonce)}
        self._answer(200, body, "text/html; charset=utf-8", policy)

    def do_POST(self) -> None:
        """Answer a request of the page: `/next`, news when there are any, or `/set`, sliders at other positions."""
        try:
            answer = self._requested()
        except Refusal as refusal:
            self._answer(int(refusal.args[0]))
        else:
            self._answer(200, json.dumps(answer, allow_nan=False).encode())

    def _requested(self) -> dict[str, Any]:
        self._is_own()
        if not hmac.compare_digest(
            self.headers.get(TOKEN, "").encode(), self.server.token.encode()
        ):
            raise Refusal(403)
        if self.headers.get("Content-Type") != "application/json":
            raise Refusal(415)
        size = self.headers.get("Content-Length", "")
        if not (size.isascii() and size.isdigit()) or "Transfer-Encoding" in self.headers:
            raise Refusal(411)
        if len(size) > len(str(MOST)) or int(size) > MOST:
            raise Refusal(413)
        try:
            body = json.loads(self.rfile.read(int(size)))
        except (ValueError, RecursionError):
            raise Refusal(400) from None
        session = self.server.session
        match self.path, body:
            case "/next", {"seen": int(seen), **rest} if not rest:
                return session.news(seen)
            case "/set", {"values": dict(values), **rest} if not rest:
                for position in values.values():
                    if not isinstance(position, int | float) or not abs(position) < MOST:  # nor NaN
                        raise Refusal(400)
                return {"turn": session.move({name: float(to) for name, to in values.items()})}
            case "/next" | "/set", _:
                raise Refusal(400)
        raise Refusal(404)

    def _is_own(self) -> None:
        """Raise Refusal of a request that was not made by the page itself, or by whoever typed its address."""
        port = self.server.server_port
        hosts = (f"127.0.0.1:{port}", f"localhost:{port}")
        of_host = self.headers.get_all("Host", []) in [[host] for host in hosts]
        origins = [[], *([f"http://{host}"] for host in hosts)]
        of_origin = self.headers.get_all("Origin", []) in origins
        site = self.headers.get("Sec-Fetch-Site", "none")
        if not of_host or not of_origin or site not in ("none", "same-origin"):
            raise Refusal(403)

    def _answer(
        self,
        status: int,
        body: bytes = b"",
        kind: str = "application/json",
        more: dict[str, str] | None = None,
    ) -> None:
        self.close_connection |= status != 200  # what is left of its body is not read
        try:
            self.send_response(status)
            content = {"Content-Type": kind, "Content-Length": str(len(body))}
            for key, value in {**HEADERS, **content, **(more or {})}.items():
                self.send_header(key, value)
            if self.close_connection:
                self.send_header("Connection", "close")
            self.end_headers()
            self.wfile.write(body)
        except OSError:  # the page has gone
            self.close_connection = True

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing about a request that was answered."""
