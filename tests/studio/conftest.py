"""Servers of pages, asked as browsers and as strangers ask them."""

from __future__ import annotations

import http.client
import json
from collections.abc import Iterator
from typing import Any

import pytest

from irsim.studio.feed import Feed
from irsim.studio.live import live_server
from irsim.studio.server import Server


class Client:
    """Sends requests to a server; by default as its own page does."""

    def __init__(self, server: Server) -> None:
        self.server, self.port = server, server.port
        self.cookie: str | None = None

    def ask(self, method: str, path: str, body: Any = None, **changes: str | None) -> http.client.HTTPResponse:
        """The answer to a request.

        Args:
            method: ``GET``, ``POST``, …
            path: The path.
            body: Text, or data that become JSON.
            **changes: Headers that differ, with ``_`` for ``-``; None leaves one out.
        """
        host = f"127.0.0.1:{self.port}"
        headers: dict[str, str | None] = {"Host": host, "Cookie": self.cookie}
        if method != "GET":
            headers["Origin"] = f"http://{host}"
        headers |= {name.replace("_", "-"): value for name, value in changes.items()}
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        connection.putrequest(method, path, skip_host=True)
        for name, value in headers.items():
            if value is not None:
                connection.putheader(name, value)
        text = body if isinstance(body, str) else "" if body is None else json.dumps(body)
        if "Content-Length" not in headers:
            connection.putheader("Content-Length", str(len(text.encode())))
        connection.endheaders(text.encode())
        answer = connection.getresponse()
        if answer.getheader("Content-Type") != "application/octet-stream":  # which has no end
            answer.text = answer.read().decode()  # type: ignore[attr-defined]
            connection.close()
        return answer

    def status(self, method: str, path: str, body: Any = None, **changes: str | None) -> int:
        """The status of an answer."""
        return self.ask(method, path, body, **changes).status

    def enter(self) -> http.client.HTTPResponse:
        """Exchange the token, and keep the cookie."""
        answer = self.ask("POST", "/session", self.server.access.token)
        cookie = answer.getheader("Set-Cookie")
        if cookie is not None:
            self.cookie = cookie.partition(";")[0]
        return answer


@pytest.fixture
def feed() -> Feed:
    return Feed()


@pytest.fixture
def server(feed: Feed) -> Iterator[Server]:
    made = live_server(0, feed)
    yield made
    made.close()


@pytest.fixture
def client(server: Server) -> Client:
    return Client(server)


@pytest.fixture
def entered(client: Client) -> Client:
    assert client.enter().status == 204
    return client
