"""Connections of an HTTP server: how many there are, and how long one may take; a lack of descriptors ends nothing."""

from __future__ import annotations

import asyncio
import errno
import logging
import socket
import sys
import time
from typing import Any

import uvicorn
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

if sys.platform != "win32":
    import resource

__all__ = ["most_connections", "server_of"]

_LOG = logging.getLogger(__name__)
_MOST = 256
"""Number of connections at the same time; further ones are answered with 503."""
_RESERVED = 112
"""Number of descriptors that are left for workers, jobs and files."""
_LINGERING = 32
"""Number of refused connections that are kept until their clients have read why."""
_LINGER_S = 1.0
_HEADER_S = 10.0
"""Time for the headers of a request, from the connection or the answer before [s]."""
_UNREAD_S = 60.0
"""Time in which a client must read something of its answer [s]."""
_SHUTDOWN_S = 2
"""Time that open requests have to end when the server is terminated [s]."""
_ACCEPTED = 64
"""Number of connections that are accepted at once."""
_QUEUE = 1024
"""Number of connections that the operating system keeps until they are accepted."""
_TELL_S = 60.0
"""Least time between two messages about a lack of descriptors [s]."""


def server_of(app: ASGIApp) -> uvicorn.Server:
    """The server of an application; it has its socket from who runs it."""
    config = uvicorn.Config(
        app,
        http=_Connection,
        ws="none",
        loop="asyncio",
        log_config=None,
        log_level="warning",
        access_log=False,
        server_header=False,
        proxy_headers=False,
        backlog=_ACCEPTED,
        timeout_graceful_shutdown=_SHUTDOWN_S,
    )
    return _Server(config)


def most_connections() -> int:
    """Number of connections that the limit of open files leaves room for."""
    if sys.platform == "win32":
        return _MOST
    files = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return _MOST if files == resource.RLIM_INFINITY else max(8, min(_MOST, files - _RESERVED))


class _Server(uvicorn.Server):
    """A server whose event loop survives a lack of descriptors."""

    _told = -_TELL_S

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        asyncio.get_running_loop().set_exception_handler(self._tell)
        await super().startup(sockets)
        for listening in sockets or ():
            listening.listen(_QUEUE)

    def _tell(self, loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Say in one line, now and then, that descriptors are missing; the loop accepts again after a second."""
        error = context.get("exception")
        if not (isinstance(error, OSError) and error.errno in (errno.EMFILE, errno.ENFILE, errno.ENOBUFS)):
            loop.default_exception_handler(context)
        elif time.monotonic() - self._told >= _TELL_S:
            self._told = time.monotonic()
            _LOG.warning("%s: new connections wait until others have ended", error.strerror)


class _Connection(H11Protocol):
    """A connection that has to make progress: send headers in time, and read what it is sent."""

    refused = False
    _header: asyncio.TimerHandle | None = None
    _unread: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        if sum(not other.refused for other in self.connections if isinstance(other, _Connection)) > most_connections():
            self._refuse()
        else:
            self._watch()

    def connection_lost(self, exc: Exception | None) -> None:
        for timer in (self._header, self._unread):
            if timer is not None:
                timer.cancel()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        if self.refused:
            return
        super().data_received(data)
        self._watch()

    def on_response_complete(self) -> None:
        super().on_response_complete()
        self._watch()

    def pause_writing(self) -> None:
        super().pause_writing()
        self._unread = self.loop.call_later(_UNREAD_S, self.transport.abort)

    def resume_writing(self) -> None:
        super().resume_writing()
        if self._unread is not None:
            self._unread.cancel()

    def _watch(self) -> None:
        """Limit the time until the next request has begun; a byte now and then does not prolong it."""
        cycle: Any = self.cycle  # None before the first request
        if cycle is not None and not cycle.response_complete:
            if self._header is not None:
                self._header.cancel()
                self._header = None
        elif self._header is None and not self.transport.is_closing():
            self._header = self.loop.call_later(_HEADER_S, self._give_up)

    def _give_up(self) -> None:
        cycle: Any = self.cycle
        if cycle is None and self.conn.trailing_data[0]:
            self.transport.write(_answer("408 Request Timeout"))
        self.transport.abort()

    def _refuse(self) -> None:
        self.refused = True
        self.transport.write(_answer("503 Service Unavailable"))
        if len(self.connections) > most_connections() + _LINGERING or not self.transport.can_write_eof():
            self.transport.abort()
            return
        self.transport.write_eof()  # what the client still sends is read, or the answer would be lost with a reset
        self._header = self.loop.call_later(_LINGER_S, self.transport.abort)


def _answer(status: str) -> bytes:
    return f"HTTP/1.1 {status}\r\nconnection: close\r\ncontent-length: 0\r\n\r\n".encode()
