"""Conditions of every request to the page's server: meant for this server, sent by its page, and small."""

from __future__ import annotations

from collections.abc import Mapping

import anyio
from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from irsim.studio.access import Access

__all__ = ["Guard"]

_BODY_S = 30.0
"""Time in which the body of a request has to arrive [s]."""
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'; base-uri 'none'",
}
"""Headers of all answers; only the page has another policy."""


class Guard:
    """Passes on the requests of the page, and refuses all others.

    GET changes nothing, and needs a cookie unless its path is open. POST needs an ``Origin``, which browsers send with
    it, and the cookie, unless it asks for that.

    Args:
        app: The application behind it.
        access: Who may ask.
        most: Path → size of the largest body of a request to it [bytes]; ``""`` for all others.
        opened: Beginnings of paths that GET reads without a cookie: the page and its parts.
    """

    def __init__(self, app: ASGIApp, access: Access, most: Mapping[str, int], opened: tuple[str, ...] = ()) -> None:
        self._app, self._access, self._most, self._opened = app, access, most, opened

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            return
        answer = _with_headers(send)
        refused = self._why_refused(scope)
        body = b""
        if refused is None and scope["method"] == "POST":
            body, refused = await self._body(scope, receive)
        if refused is not None:
            status, why = refused
            await PlainTextResponse(why, status, {"Connection": "close"})(scope, receive, answer)
            return
        given: list[Message] = [{"type": "http.request", "body": body, "more_body": False}]

        async def again() -> Message:
            return given.pop() if given else await receive()

        await self._app(scope, again, answer)

    def _why_refused(self, scope: Scope) -> tuple[int, str] | None:
        headers, path = Headers(scope=scope), scope["path"]
        if not self._access.is_ours(headers.getlist("host")):
            return 403, "this server has another name"
        cookie = self._access.has_cookie(headers.getlist("cookie"))
        if scope["method"] == "GET":
            if scope["query_string"]:
                return 404, "there is nothing at this address"
            free = path == "/" or path.startswith(self._opened)
            return None if free or cookie else (403, "open the address that irsim has printed")
        if scope["method"] != "POST":
            return 405, "this server answers GET and POST"
        if not self._access.is_own_origin(headers.getlist("origin"), headers["host"]):
            return 403, "this request comes from another page"
        return None if cookie or path == "/session" else (403, "open the address that irsim has printed")

    async def _body(self, scope: Scope, receive: Receive) -> tuple[bytes, tuple[int, str] | None]:
        """The body of a request, and why it is refused."""
        headers = Headers(scope=scope)
        length = headers.get("content-length", "")
        most = self._most.get(scope["path"], self._most[""])
        if not length.isascii() or not length.isdigit() or "transfer-encoding" in headers:
            return b"", (411, "a request needs a length")
        if len(length) > len(str(most)) or int(length) > most:
            return b"", (413, f"this request may have {most:,} bytes")
        body = bytearray()
        with anyio.move_on_after(_BODY_S) as late:
            while len(body) < int(length):
                part = await receive()
                if part["type"] != "http.request":
                    return b"", (400, "the body was cut")
                body += part.get("body", b"")
        return bytes(body), (408, "the body took too long") if late.cancelled_caught else None


def _with_headers(send: Send) -> Send:
    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
        await send(message)

    return sent
