"""The server of a page: it listens on this machine only, behind a guard, in a thread of its own."""

from __future__ import annotations

import asyncio
import os
import socket
import threading
import webbrowser
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import anyio.to_thread
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route

from irsim.common.connections import server_of
from irsim.common.records import ContentError, read_json
from irsim.common.screen import has_screen
from irsim.diagnostics.errors import InputError
from irsim.studio.access import Access
from irsim.studio.guard import Guard

if TYPE_CHECKING:
    from starlette.routing import BaseRoute

__all__ = ["Refused", "Server", "given"]

_HOST = "127.0.0.1"
_MAX_BODY = 4096
"""Size of the largest body of a request that has no other limit [bytes]."""
_LINGER_S = 1.0
"""Time in which answers may end after the server is closed [s]."""
_END_S = 10.0
"""Longest time in which the thread of the server ends [s]."""


class Refused(Exception):
    """A request that cannot be answered.

    Args:
        status: Status of the answer.
        why: One sentence.
    """

    def __init__(self, status: int, why: str) -> None:
        super().__init__(status, why)
        self.status, self.why = status, why


class Server:
    """A server that listens; each of its routes is behind a :class:`irsim.studio.guard.Guard`.

    Args:
        port: Port to listen at; 0 chooses a free one.
        routes: Its routes, besides ``POST /session``, which exchanges the token for a cookie.
        most: Path → size of the largest body of a request to it [bytes], where it is not 4 kB.
        opened: Beginnings of paths that are read without a cookie.

    Attributes:
        access: Who may ask.
        port: The port.

    Raises:
        InputError: The port is not free, or may not be used.
    """

    def __init__(
        self,
        port: int,
        routes: Sequence[BaseRoute],
        most: Mapping[str, int] | None = None,
        opened: tuple[str, ...] = (),
    ) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        try:
            if os.name == "posix":  # else a port is not free for a while; on Windows two programs could share it
                self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            self._socket.bind((_HOST, port))
            self._socket.listen()
        except OSError as error:
            self._socket.close()
            what = f"port {port} cannot be used: {error.strerror or error}"
            raise InputError(what, "name another port, or leave --port out", where="port") from None
        self.port: int = self._socket.getsockname()[1]
        self.access = Access(self.port)
        session = Route("/session", self._enter, methods=["POST"])
        app = Starlette(routes=[session, *routes], exception_handlers={Refused: _refusal})
        self._server = server_of(Guard(app, self.access, {"": _MAX_BODY, **(most or {})}, opened))
        self._server.config.lifespan = "off"
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """Address of the page with the token, which browsers keep to themselves: it stands after the ``#``."""
        return f"http://{_HOST}:{self.port}/#{self.access.token}"

    def show(self) -> None:
        """Open the page in a browser without waiting for it, if there is a screen or ``BROWSER`` names a browser."""
        if "BROWSER" in os.environ or has_screen():
            threading.Thread(target=webbrowser.open, args=[self.address], daemon=True).start()

    def close(self) -> None:
        """End all connections."""
        self._closed.set()
        self._thread.join(_END_S)

    def _serve(self) -> None:
        asyncio.run(self._serve_until_closed())

    async def _serve_until_closed(self) -> None:
        serving = asyncio.create_task(self._server.serve(sockets=[self._socket]))
        await anyio.to_thread.run_sync(self._closed.wait)
        self._server.should_exit = True
        await asyncio.wait([serving], timeout=_LINGER_S)
        for connection in list(self._server.server_state.connections):
            connection.transport.abort()  # it reads too slowly, or its answer has no end
        await serving
        await asyncio.sleep(0)  # in which connections that were aborted are closed

    async def _enter(self, request: Request) -> Response:
        entered = self.access.has_cookie(request.headers.getlist("cookie"))
        token = (await request.body()).decode(errors="replace")
        cookie = None if entered else self.access.exchange(token)
        if cookie is None and not entered:
            raise Refused(403, "this token is not valid, or has been used")
        return Response(status_code=204, headers={} if cookie is None else {"Set-Cookie": cookie})


async def given(request: Request) -> dict[str, Any]:
    """The JSON object in the body of a request; an empty one for anything else."""
    try:
        data = read_json(await request.body())
    except ContentError:
        return {}
    return data if isinstance(data, dict) else {}


def _refusal(_: Request, error: Exception) -> Response:
    assert isinstance(error, Refused)
    return PlainTextResponse(error.why, error.status, {"Connection": "close"})
