"""Serve over HTTP, and decide which clients may connect."""

from __future__ import annotations

import hmac
import ipaddress
import os
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from mcp.server import MCPServer
    from mcp.server.transport_security import TransportSecuritySettings
    from starlette.types import ASGIApp, Receive, Scope, Send

__all__ = ["PATH", "TOKEN_VARIABLE", "Address", "HttpRefused", "address", "serve", "token_from"]

PATH = "/mcp"
TOKEN_VARIABLE = "IRSIM_MCP_TOKEN"
_LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
_MIN_TOKEN_LENGTH = 16
_MAX_TOKEN_LENGTH = 1024
_SHUTDOWN_SECONDS = 2
"""Time that open requests have to end when the server is terminated [s]."""
_TOKEN = re.compile(r"[A-Za-z0-9._~+/=-]+")
_ANYWHERE = ("0.0.0.0", "::")


class HttpRefused(ValueError):
    """Options with which serving would be unsafe or impossible."""


class Address(NamedTuple):
    """Host and port to listen at."""

    host: str
    port: int

    @property
    def loopback(self) -> bool:
        """Whether only this machine can connect."""
        if self.host == "localhost":
            return True
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return False

    @property
    def name(self) -> str:
        """The host as it appears in a URL."""
        return f"[{self.host}]" if ":" in self.host else self.host


def address(text: str) -> Address:
    """Read ``[HOST:]PORT``; without a host it is 127.0.0.1.

    Args:
        text: Text such as ``8000``, ``127.0.0.1:8000`` or ``[::1]:8000``; port 0 chooses a free port.
    """
    host, _, port = text.rpartition(":")
    if ":" in host and not (host.startswith("[") and host.endswith("]")):
        raise ValueError(f"{text} is not [HOST:]PORT; write IPv6 addresses as [::1]:8000")
    host = host.removeprefix("[").removesuffix("]")
    if not re.fullmatch(r"\d{1,5}", port) or int(port) > 65535 or (":" in text and not host):
        raise ValueError(f"{text} is not [HOST:]PORT")
    return Address(host or "127.0.0.1", int(port))


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


def _security(where: Address, names: Sequence[str]) -> TransportSecuritySettings:
    """Values of Host and Origin that are accepted, which excludes pages of other sites."""
    from mcp.server.transport_security import TransportSecuritySettings

    own = _LOOPBACK if where.loopback else ()
    bound = () if where.host in _ANYWHERE else (where.name,)
    hosts = list(dict.fromkeys((*own, *bound, *names)))
    every = [form for host in hosts for form in (host, f"{host}:*")]
    origins = [f"{scheme}://{form}" for scheme in ("http", "https") for form in every]
    return TransportSecuritySettings(allowed_hosts=every, allowed_origins=origins)


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
    if where.host in _ANYWHERE and not names:
        raise HttpRefused(
            f"--http {where.name}:{where.port} needs --allow-host NAME, the name or address that clients connect to"
        )
    app: ASGIApp = server.streamable_http_app(
        host=where.host, streamable_http_path=PATH, transport_security=_security(where, names)
    )
    return app if token is None else _WithToken(app, token)


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
    import socket

    import uvicorn

    app = application(server, where, token, names)
    config = uvicorn.Config(
        app, log_level="warning", server_header=False, timeout_graceful_shutdown=_SHUTDOWN_SECONDS, ws="none"
    )
    family = socket.AF_INET6 if ":" in where.host else socket.AF_INET
    with socket.socket(family) as listening:
        if os.name == "posix":
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((where.host, where.port))
            listening.listen()
        except OSError as error:
            raise HttpRefused(f"--http {where.name}:{where.port}: {error.strerror or error}") from None
        port = listening.getsockname()[1]
        print(f"irsim-mcp: serving http://{where.name}:{port}{PATH}", file=sys.stderr, flush=True)
        uvicorn.Server(config).run(sockets=[listening])
