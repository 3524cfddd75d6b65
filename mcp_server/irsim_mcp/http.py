"""Serve over HTTP, and decide which clients may connect."""

from __future__ import annotations

import hmac
import os
import re
import socket
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from irsim_mcp.hosts import Address, HttpRefused, allowed_hosts, anywhere, why_refused

if TYPE_CHECKING:
    from mcp.server import MCPServer
    from starlette.types import ASGIApp, Receive, Scope, Send

__all__ = ["PATH", "TOKEN_VARIABLE", "serve", "token_from"]

PATH = "/mcp"
TOKEN_VARIABLE = "IRSIM_MCP_TOKEN"
_MIN_TOKEN_LENGTH = 16
_MAX_TOKEN_LENGTH = 1024
_MAX_SESSIONS = 64
"""Number of sessions at the same time; who opens another one is answered with 503."""
_IDLE_SECONDS = 30 * 60
"""Time after which a session without a request ends [s]."""
_TOKEN = re.compile(r"[A-Za-z0-9._~+/=-]+")


def token_from(file: Path | None) -> str | None:
    """The token that clients must send: content of a file, else of the variable ``IRSIM_MCP_TOKEN``, else None.

    Raises:
        HttpRefused: The file cannot be read, or the token is too short or has invalid characters.
    """
    if file is not None:
        try:
            text = file.read_text(encoding="utf-8").strip()
        except (OSError, UnicodeDecodeError) as error:
            raise HttpRefused(f"--token-file: {file} cannot be read: {error}") from None
        source = f"--token-file {file}"
    elif TOKEN_VARIABLE in os.environ:
        text, source = os.environ[TOKEN_VARIABLE].strip(), TOKEN_VARIABLE
    else:
        return None
    if not _MIN_TOKEN_LENGTH <= len(text) <= _MAX_TOKEN_LENGTH or not _TOKEN.fullmatch(text):
        raise HttpRefused(
            f"{source}: a token must be one line of at least {_MIN_TOKEN_LENGTH} letters, digits and ._~+/=-; "
            'python -c "import secrets; print(secrets.token_urlsafe(32))" makes one'
        )
    return text


def application(server: MCPServer, where: Address, token: str | None, names: Sequence[str] = ()) -> ASGIApp:
    """The server as a web application.

    Args:
        server: The server.
        where: Host and port at which it will listen.
        token: Bearer token that clients must send.
        names: Names or addresses by which clients reach the server, besides the host it listens at.

    Raises:
        HttpRefused: Other machines could connect without a token, or the names by which they connect are missing.
    """
    if not where.loopback and token is None:
        raise HttpRefused(
            f"--http {where.name}:{where.port} lets other machines connect, which needs a token: give "
            f"--token-file FILE or set {TOKEN_VARIABLE}, or serve this machine only with --http {where.port}"
        )
    if anywhere(where) and not names:
        raise HttpRefused(
            f"--http {where.name}:{where.port} needs --allow-host NAME, the name or address that clients connect to"
        )
    from mcp.server.transport_security import TransportSecuritySettings

    from irsim_mcp.bodies import WholeMessages

    app: ASGIApp = server.streamable_http_app(
        host=where.host,
        streamable_http_path=PATH,
        transport_security=TransportSecuritySettings(enable_dns_rebinding_protection=False),  # OwnHosts does it
        max_sessions=_MAX_SESSIONS,
        session_idle_timeout=_IDLE_SECONDS,
    )
    app = _OwnHosts(WholeMessages(app), allowed_hosts(where, names))
    return app if token is None else _WithToken(app, token)


class _OwnHosts:
    """Passes on the requests that mean this server, and refuses all others.

    Args:
        app: The application behind it.
        allowed: The hosts that requests may name.
    """

    def __init__(self, app: ASGIApp, allowed: frozenset[str]) -> None:
        self._app, self._allowed = app, allowed

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        refused = why_refused(scope["headers"], self._allowed) if scope["type"] == "http" else None
        if refused is None:
            await self._app(scope, receive, send)
            return
        from starlette.responses import PlainTextResponse

        await PlainTextResponse(refused[1], status_code=refused[0])(scope, receive, send)


class _WithToken:
    """Passes on the requests that have the token, and refuses all others.

    Args:
        app: The application behind it.
        token: The required token.
    """

    def __init__(self, app: ASGIApp, token: str) -> None:
        self._app, self._expected = app, token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan" or (scope["type"] == "http" and self._has_token(scope)):
            await self._app(scope, receive, send)
            return
        from starlette.responses import PlainTextResponse

        response = PlainTextResponse(
            "this server requires a token: send the header Authorization: Bearer TOKEN",
            status_code=401,
            headers={"WWW-Authenticate": "Bearer"},
        )
        await response(scope, receive, send)

    def _has_token(self, scope: Scope) -> bool:
        sent = [value for name, value in scope["headers"] if name == b"authorization"]
        if len(sent) != 1:
            return False
        scheme, _, token = sent[0].partition(b" ")  # the scheme is case-insensitive: RFC 9110, section 11.1
        return scheme.lower() == b"bearer" and hmac.compare_digest(token.lstrip(b" "), self._expected)


def serve(server: MCPServer, where: Address, token: str | None, names: Sequence[str] = ()) -> None:
    """Serve until the process is terminated (see :func:`application`); writes the URL to standard error."""
    from irsim.common.connections import server_of

    app = application(server, where, token, names)
    family = socket.AF_INET6 if ":" in where.host else socket.AF_INET
    with socket.socket(family, proto=socket.IPPROTO_TCP) as listening:  # by which asyncio sends answers without delay
        if os.name == "posix":
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((where.host, where.port))
            listening.listen()
        except OSError as error:
            raise HttpRefused(f"--http {where.name}:{where.port}: {error.strerror or error}") from None
        port = listening.getsockname()[1]
        print(f"irsim-mcp: serving http://{where.name}:{port}{PATH}", file=sys.stderr, flush=True)
        server_of(app).run(sockets=[listening])
