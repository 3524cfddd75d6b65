"""Who may ask the page's server for something: this page, in a browser that was given the token, on this machine."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Sequence
from http.cookies import CookieError, SimpleCookie

__all__ = ["Access"]

_BYTES = 32
"""Length of the token and of the secret in the cookie."""
_HOSTS = ("127.0.0.1", "localhost", "[::1]")
"""Names of this machine. A page of another site whose name was made to lead here has another one (DNS rebinding)."""
_HTTP_PORT = 80
"""Port that browsers leave out of ``Host`` and ``Origin``."""


class Access:
    """The token in the address that irsim prints, and the cookie for which a browser exchanges it, once.

    Args:
        port: Port of the server.

    Attributes:
        token: The token, as it stands in the address.
    """

    def __init__(self, port: int) -> None:
        self.token = secrets.token_urlsafe(_BYTES)
        self._secret = secrets.token_urlsafe(_BYTES)
        self._cookie = f"irsim_{port}"  # cookies do not tell ports apart
        self._used = False
        endings = [f":{port}", *([""] if port == _HTTP_PORT else [])]
        self._hosts = {f"{host}{ending}" for host in _HOSTS for ending in endings}

    def is_ours(self, hosts: Sequence[str]) -> bool:
        """Whether the values of ``Host`` of a request name this server."""
        return len(hosts) == 1 and hosts[0].lower() in self._hosts

    def is_own_origin(self, origins: Sequence[str], host: str) -> bool:
        """Whether the values of ``Origin`` of a request say that a page of this server sends it.

        Args:
            origins: The values.
            host: Value of ``Host``, which names this server.
        """
        return len(origins) == 1 and origins[0].lower() == f"http://{host.lower()}"

    def exchange(self, token: str) -> str | None:
        """The header ``Set-Cookie`` for a browser that sends the token; None if it is wrong or has been used."""
        if not hmac.compare_digest(token.encode(), self.token.encode()) or self._used:
            return None
        self._used = True
        return f"{self._cookie}={self._secret}; Path=/; HttpOnly; SameSite=Strict"

    def has_cookie(self, headers: Sequence[str]) -> bool:
        """Whether the values of ``Cookie`` of a request have the secret."""
        try:
            cookie = SimpleCookie("; ".join(headers)).get(self._cookie)
        except CookieError:
            return False
        return cookie is not None and hmac.compare_digest(cookie.value.encode(), self._secret.encode())
