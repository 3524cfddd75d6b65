"""Bodies of HTTP requests: they come in time, all of them together fit into memory, and each is a message."""

from __future__ import annotations

import anyio
from mcp.types import INVALID_REQUEST, JSONRPCRequest
from starlette.responses import PlainTextResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from irsim_mcp.frames import BadFrame, frame

__all__ = ["WholeMessages"]

_MOST = 4 * 1024**2
"""Size of the largest body [bytes]."""
_MOST_TOGETHER = 64 * 1024**2
"""Size of all bodies that are being received [bytes]."""
_SECONDS = 60.0
"""Time for a body [s]."""

_STREAM = "subscriptions/listen"
"""Method whose answer has no end, and so holds a connection."""
_MOST_STREAMS = 64
"""Number of such answers at the same time."""


class WholeMessages:
    """Passes on requests whose body is a message, and answers all others.

    Args:
        app: The application behind it.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._held = 0
        self._streams = 0
        self._in_use: set[tuple[bytes, str] | None] = set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Read the body of a POST and pass it on, or answer it."""
        if scope["type"] != "http" or scope["method"] != "POST":
            await self._app(scope, receive, send)
            return
        body = bytearray()
        try:
            with anyio.move_on_after(_SECONDS) as late:
                refused = await self._read(body, receive)
            if late.cancelled_caught:
                refused = PlainTextResponse("The body took too long", status_code=408)
            if refused is not None:
                refused.headers["connection"] = "close"
                await refused(scope, receive, send)
                return
        finally:
            self._held -= len(body)
        await self._answer(bytes(body), scope, receive, send)

    async def _read(self, body: bytearray, receive: Receive) -> Response | None:
        """Append the parts of a body; the answer if it is refused."""
        more = True
        while more:
            part = await receive()
            if part["type"] != "http.request":
                return PlainTextResponse("The body was cut", status_code=400)
            data = part.get("body", b"")
            body += data
            self._held += len(data)
            if len(body) > _MOST:
                return PlainTextResponse("The body is too large", status_code=413)
            if self._held > _MOST_TOGETHER:
                return PlainTextResponse("Too many bodies at the same time; try again", status_code=503)
            more = part.get("more_body", False)
        return None

    async def _answer(self, body: bytes, scope: Scope, receive: Receive, send: Send) -> None:
        session = dict(scope["headers"]).get(b"mcp-session-id")
        try:
            message = frame(body)
            request = message if isinstance(message, JSONRPCRequest) else None
            used = (session, str(request.id)) if request is not None and session is not None else None
            if request is not None and used in self._in_use:
                what = "a request with this id is not answered yet; each request needs an id of its own"
                raise BadFrame(INVALID_REQUEST, what, request.id)
        except BadFrame as bad:
            await Response(bad.answer(), status_code=400, media_type="application/json")(scope, receive, send)
            return
        stream = request is not None and request.method == _STREAM
        if stream and self._streams >= _MOST_STREAMS:
            refused = PlainTextResponse("Too many streams of notices at the same time", status_code=503)
            await refused(scope, receive, send)
            return
        given: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]

        async def again() -> Message:
            return given.pop() if given else await receive()

        self._streams += stream
        if used is not None:
            self._in_use.add(used)
        try:
            await self._app(scope, again, send)
        finally:
            self._streams -= stream
            self._in_use -= {used}
