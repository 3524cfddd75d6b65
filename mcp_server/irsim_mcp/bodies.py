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
_LINGER_S = 1.0
"""Time in which a client may go on sending what was refused, or the end of the connection would lose the answer [s]."""

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
        if _announced(scope) > _MOST:
            await _refuse(_too_large(), scope, receive, send)
            return
        body = bytearray()
        try:
            with anyio.move_on_after(_SECONDS) as late:
                refused = await self._read(body, receive)
            if late.cancelled_caught:
                refused = PlainTextResponse("The body took too long", status_code=408)
        finally:
            self._held -= len(body)
        if refused is not None:
            body.clear()
            await _refuse(refused, scope, receive, send)
            return
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
                return _too_large()
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


def _announced(scope: Scope) -> int:
    """Size of a body as its headers say it [bytes]; 0 if they do not."""
    sizes = [value for name, value in scope["headers"] if name == b"content-length"]
    return max((int(size) for size in sizes if size.isdigit()), default=0)


def _too_large() -> Response:
    return PlainTextResponse(f"The body is too large: at most {_MOST:,} bytes", status_code=413)


async def _refuse(refused: Response, scope: Scope, receive: Receive, send: Send) -> None:
    """Send an answer at once, drop for a moment what the client still sends, and end the connection."""

    async def send_open(message: Message) -> None:
        await send({**message, "more_body": True} if message["type"] == "http.response.body" else message)

    refused.headers["connection"] = "close"
    await refused(scope, receive, send_open)
    with anyio.move_on_after(_LINGER_S):
        while (await receive())["type"] == "http.request":
            pass
    await send({"type": "http.response.body", "body": b"", "more_body": False})
