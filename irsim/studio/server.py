"""The server of the page: four addresses, for one page in browsers of this machine.

``GET /`` is the page, which holds nothing of a run. ``POST /session`` exchanges the token for a cookie, ``POST
/stream`` sends frames without an end, and ``POST /command`` holds the simulation or has steps executed. GET changes
nothing, and POST needs an ``Origin``, which browsers send with it.
"""

from __future__ import annotations

import os
import re
import threading
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, TypeGuard

from irsim.common.records import ContentError, read_json
from irsim.diagnostics.errors import InputError
from irsim.runs.replay.page import page
from irsim.studio.access import Access
from irsim.studio.feed import ALIVE, Feed, frame

__all__ = ["Server", "serving"]

_HOST = "127.0.0.1"
_MAX_BODY = 4096
"""Size of the largest body of a request [bytes]."""
_MAX_CONNECTIONS = 32
"""Number of connections at the same time; further ones are closed."""
_MAX_STEPS = 10_000
"""Largest number of steps of one command."""
_REQUEST_S = 30.0
"""Time in which a request has to arrive [s]."""
_ALIVE_S = 1.0
"""Time after which a viewer is sent a frame without content, which shows whether it is still there [s]."""
_POLICY = re.compile(r'http-equiv="Content-Security-Policy" content="([^"]*)"')
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}
_NOTHING = "default-src 'none'; frame-ancestors 'none'; base-uri 'none'"
"""Policy of all answers but the page."""


class Server(ThreadingHTTPServer):
    """Listens on this machine only; each connection has a thread, which ends with the process.

    Args:
        port: Port to listen at; 0 chooses a free one.
        feed: Frames for the page.
    """

    daemon_threads = True
    block_on_close = False
    allow_reuse_address = (
        os.name == "posix"
    )  # else a port is not free for a while; on Windows two programs could share it

    def __init__(self, port: int, feed: Feed) -> None:
        self.feed = feed
        self.page = page(title="irsim run", feed=Path(__file__).with_name("web"))
        self._free = threading.BoundedSemaphore(_MAX_CONNECTIONS)
        super().__init__((_HOST, port), _Handler)
        self.access = Access(self.server_port)

    @property
    def address(self) -> str:
        """Address of the page with the token, which browsers keep to themselves: it stands after the ``#``."""
        return f"http://{_HOST}:{self.server_port}/#{self.access.token}"

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread, unless there are too many connections."""
        if self._free.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """Answer, and make room for another connection."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a client that is gone in the middle of an answer."""


def serving(port: int, feed: Feed) -> Server:
    """A server that listens, and whose thread answers.

    Raises:
        InputError: The port is not free, or may not be used.
    """
    try:
        server = Server(port, feed)
    except OSError as error:
        what = f"port {port} cannot be used: {error.strerror or error}"
        raise InputError(what, "name another port, or leave --port out", where="port") from None
    threading.Thread(target=partial(server.serve_forever, poll_interval=0.1), daemon=True).start()
    return server


class _Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: Server
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "irsim", ""
    error_content_type, error_message_format = "text/plain; charset=utf-8", "%(code)d %(message)s"
    timeout = _REQUEST_S
    disable_nagle_algorithm = True
    _policy = _NOTHING

    def do_GET(self) -> None:
        """Answer with the page."""
        self._policy = _NOTHING
        if not self._is_ours():
            return
        if self.path != "/":
            self.send_error(404)
            return
        text = self.server.page
        policy = _POLICY.search(text)
        assert policy is not None
        self._policy = f"{policy[1]}; frame-ancestors 'none'"  # which browsers do not read in the page
        self._answer(200, text.encode(), "text/html; charset=utf-8")

    def do_POST(self) -> None:
        """Exchange the token, send the run, or pass a command on."""
        self._policy = _NOTHING
        if not self._is_ours() or (body := self._body()) is None:
            return
        access, cookies = self.server.access, self.headers.get_all("Cookie", [])
        if not access.is_own_origin(self.headers.get_all("Origin", []), self.headers["Host"]):
            self._refuse(403, "this request comes from another page")
        elif self.path == "/session":
            self._enter(body.decode(errors="replace"), entered=access.has_cookie(cookies))
        elif self.path not in ("/stream", "/command"):
            self._refuse(404, "there is nothing at this address")
        elif not access.has_cookie(cookies):
            self._refuse(403, "open the address that irsim has printed")
        elif self.path == "/stream":
            self._stream(_read(body))
        else:
            self._command(_read(body))

    def _is_ours(self) -> bool:
        ours = self.server.access.is_ours(self.headers.get_all("Host", []))
        if not ours:
            self._refuse(403, "this server has another name")
        return ours

    def _body(self) -> bytes | None:
        """The body of a request; None if it was answered because it is too large or has no length."""
        length = self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdigit() or "Transfer-Encoding" in self.headers:
            self._refuse(411, "a request needs a length")
        elif int(length) > _MAX_BODY:
            self._refuse(413, f"a request may have {_MAX_BODY:,} bytes")
        else:
            return self.rfile.read(int(length))
        return None

    def _enter(self, token: str, *, entered: bool) -> None:
        cookie = None if entered else self.server.access.exchange(token)
        if cookie is None and not entered:
            self._refuse(403, "this token is not valid, or has been used")
            return
        self._answer(204, cookie=cookie)

    def _stream(self, wanted: dict[str, Any]) -> None:
        number, feed = wanted.get("from"), self.server.feed
        if not _is_count(number):
            self._refuse(400, 'write from which frame on: {"from": 0}')
            return
        self.close_connection = True
        self.connection.settimeout(None)  # a viewer may read as slowly as it likes
        feed.enter()
        try:
            self._begin(200, "application/octet-stream")
            while True:
                frames = feed.after(number, _ALIVE_S)
                number += len(frames)
                for one in frames or [frame(ALIVE, number)]:
                    self.wfile.write(one)
        except OSError:
            pass  # the viewer is gone
        finally:
            feed.leave()

    def _command(self, given: dict[str, Any]) -> None:
        hold, steps = given.get("hold"), given.get("steps")
        if given.keys() == {"hold"} and isinstance(hold, bool):
            self.server.feed.hold(hold)
        elif given.keys() == {"steps"} and _is_count(steps) and 0 < steps <= _MAX_STEPS:
            self.server.feed.advance(steps)
        else:
            self._refuse(400, 'write {"hold": true}, {"hold": false} or {"steps": 1}')
            return
        self._answer(204)

    def _refuse(self, status: int, why: str) -> None:
        self.close_connection = True  # what is left of the request is not read
        self._answer(status, why.encode(), "text/plain; charset=utf-8")

    def _answer(self, status: int, content: bytes = b"", kind: str = "", cookie: str | None = None) -> None:
        self._begin(status, kind, len(content), cookie)
        self.wfile.write(content)

    def _begin(self, status: int, kind: str = "", length: int | None = None, cookie: str | None = None) -> None:
        self.send_response(status)
        if kind:
            self.send_header("Content-Type", kind)
        if length is not None:
            self.send_header("Content-Length", str(length))
        if cookie is not None:
            self.send_header("Set-Cookie", cookie)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()

    def end_headers(self) -> None:
        """End the headers of an answer with the ones that all answers have."""
        for name, value in {**_HEADERS, "Content-Security-Policy": self._policy}.items():
            self.send_header(name, value)
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Write nothing: the terminal belongs to the run."""


def _read(body: bytes) -> dict[str, Any]:
    """The object in a body; an empty one for anything else."""
    try:
        given = read_json(body)
    except ContentError:
        return {}
    return given if isinstance(given, dict) else {}


def _is_count(value: Any) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0
