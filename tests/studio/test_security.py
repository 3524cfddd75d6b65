"""Who is served: the page itself, in a browser that has the token; no other site, name, machine or program."""

from __future__ import annotations

import http.client
import re
import socket
import time
from urllib.parse import urlsplit

import pytest

from irsim.common.connections import most_connections
from irsim.diagnostics.errors import InputError
from irsim.studio.feed import BEGIN, ROWS, Feed
from irsim.studio.live import live_server
from irsim.studio.server import Server
from tests.studio.conftest import Client

COMMAND = {"hold": True}


def test_only_this_machine_can_connect(server: Server) -> None:
    assert urlsplit(server.address).hostname == "127.0.0.1"
    assert server.port > 0
    others = {entry[4][0] for entry in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)} - {"127.0.0.1"}
    for address in others:
        with pytest.raises(OSError, match=r"."):
            socket.create_connection((address, server.port), timeout=2)


def test_a_port_that_is_taken_is_refused(server: Server) -> None:
    with pytest.raises(InputError, match=f"port {server.port} cannot be used.*leave --port out"):
        live_server(server.port, Feed())


def test_the_token_is_long_new_and_after_the_hash_which_no_browser_sends(server: Server) -> None:
    address = urlsplit(server.address)
    assert (address.path, address.query) == ("/", "")
    assert re.fullmatch(r"[\w-]{43}", address.fragment), "32 bytes"
    other = live_server(0, Feed())
    assert other.access.token != server.access.token
    other.close()


def test_the_token_is_exchanged_once_for_a_cookie_that_scripts_and_other_sites_do_not_get(client: Client) -> None:
    assert client.status("POST", "/session", "x" * 43) == 403
    answer = client.enter()
    assert answer.status == 204
    cookie = answer.getheader("Set-Cookie", "")
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= {part.strip() for part in cookie.split(";")}
    assert client.server.access.token not in cookie
    assert client.status("POST", "/session", client.server.access.token) == 204, "who has entered may load it again"
    stranger = Client(client.server)
    assert stranger.enter().status == 403
    assert stranger.cookie is None


@pytest.mark.parametrize("path", ["/stream", "/command"])
def test_without_the_cookie_there_is_nothing(client: Client, path: str) -> None:
    assert client.status("POST", path, COMMAND) == 403
    client.cookie = f"irsim_{client.port}=wrong"
    assert client.status("POST", path, COMMAND) == 403
    client.cookie = f"irsim_{client.port}={client.server.access.token}"
    assert client.status("POST", path, COMMAND) == 403


@pytest.mark.parametrize("host", ["example.org", "127.0.0.1", "127.0.0.1:1", "localhost.example.org:80", "", None])
@pytest.mark.parametrize(("method", "path"), [("GET", "/"), ("POST", "/session"), ("POST", "/command")])
def test_other_names_for_this_machine_are_refused(entered: Client, method: str, path: str, host: str | None) -> None:
    """A site whose name is made to lead to this machine (DNS rebinding) cannot be told from its Origin."""
    assert entered.status(method, path, COMMAND, Host=host, Origin=f"http://{host}") == (400 if host is None else 403)


@pytest.mark.parametrize("name", ["localhost", "LOCALHOST", "[::1]", "127.0.0.1"])
def test_all_names_of_this_machine_are_served(entered: Client, name: str) -> None:
    host = f"{name}:{entered.port}"
    assert entered.status("GET", "/", Host=host) == 200
    assert entered.status("POST", "/command", COMMAND, Host=host, Origin=f"http://{host}") == 204


@pytest.mark.parametrize("path", ["/session", "/stream", "/command"])
@pytest.mark.parametrize(
    "origin", ["http://example.org", "null", "", None, "http://127.0.0.1", "https://127.0.0.1:PORT"]
)
def test_requests_of_other_pages_are_refused(entered: Client, path: str, origin: str | None) -> None:
    given = origin and origin.replace("PORT", str(entered.port))
    assert entered.status("POST", path, COMMAND, Origin=given) == 403


@pytest.mark.parametrize("path", ["/session", "/stream", "/command", "/?token=x", "/../etc/passwd", "/main.js"])
def test_get_changes_nothing_and_serves_no_files(entered: Client, feed: Feed, path: str) -> None:
    assert entered.status("GET", path, COMMAND) in (404, 405)
    assert not feed.is_held()


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "HEAD"])
def test_other_methods_are_refused(entered: Client, method: str) -> None:
    assert entered.status(method, "/command", COMMAND) == 405


def test_the_headers_of_all_answers(entered: Client) -> None:
    answers = [
        entered.ask("GET", "/"),
        entered.ask("GET", "/nothing"),
        entered.ask("POST", "/command", COMMAND),
        entered.ask("POST", "/command", COMMAND, Origin="http://example.org"),
        entered.ask("PUT", "/"),
    ]
    assert [answer.status for answer in answers] == [200, 404, 204, 403, 405]
    for answer in answers:
        assert answer.getheader("X-Content-Type-Options") == "nosniff"
        assert answer.getheader("Referrer-Policy") == "no-referrer"
        assert answer.getheader("Cross-Origin-Opener-Policy") == "same-origin"
        assert answer.getheader("Cache-Control") == "no-store"
        assert answer.getheader("Access-Control-Allow-Origin") is None
        policy = answer.getheader("Content-Security-Policy", "")
        assert {"default-src 'none'", "frame-ancestors 'none'", "base-uri 'none'"} <= set(policy.split("; "))


def test_the_page_may_load_and_run_only_what_it_is_made_of(client: Client) -> None:
    """No token is needed for it, as nothing of a run is in it."""
    answer = client.ask("GET", "/")
    rules = dict(rule.split(" ", 1) for rule in answer.getheader("Content-Security-Policy", "").split("; "))
    assert rules["connect-src"] == "'self'"
    assert rules["img-src"] == "data:"
    assert re.fullmatch(r"'sha256-[\w+/=]+'", rules["script-src"]), "stricter than 'self'"
    assert re.fullmatch(r"'sha256-[\w+/=]+'", rules["style-src"])
    text = answer.text  # type: ignore[attr-defined]
    assert not re.search(r"(?:https?:)?//[a-z0-9-]+\.[a-z]|\b(?:eval|innerHTML|outerHTML|insertAdjacentHTML)\b", text)


@pytest.mark.parametrize(
    "body", ["", "x", "[]", "{}", '{"hold": 1}', '{"hold": true, "steps": 1}', '{"steps": 0}', "9" * 4000]
)
def test_commands_that_are_not_known_are_refused(entered: Client, feed: Feed, body: str) -> None:
    assert entered.status("POST", "/command", body) == 400
    assert not feed.is_held()


def test_bodies_are_small_and_have_a_length(entered: Client) -> None:
    assert entered.status("POST", "/command", "x" * 5000) == 413
    assert entered.status("POST", "/command", None, Content_Length="-1") == 400
    assert entered.status("POST", "/command", None, Content_Length=None) == 411
    assert entered.status("POST", "/stream", {"from": -1}) == 400
    assert entered.status("POST", "/stream", {"from": "all"}) == 400


def test_too_many_connections_are_closed_and_the_page_goes_on(entered: Client) -> None:
    most = most_connections()
    idle = [socket.create_connection(("127.0.0.1", entered.port), timeout=5) for _ in range(most + 8)]
    assert all(connection.recv(12) == b"HTTP/1.1 503" for connection in idle[-4:])
    for connection in idle:
        connection.close()
    end = time.monotonic() + 10
    while True:  # the server needs a moment to notice that its clients are gone
        try:
            assert entered.status("GET", "/") == 200
        except (http.client.HTTPException, OSError):
            assert time.monotonic() < end
            time.sleep(0.05)
        else:
            break


def test_a_stream_goes_on_from_where_one_was(entered: Client, feed: Feed) -> None:
    feed.put(BEGIN, b"scene")
    feed.put(ROWS, b"rows")
    whole, rest = entered.ask("POST", "/stream", {"from": 0}), entered.ask("POST", "/stream", {"from": 1})
    assert whole.read(9 + 5 + 9 + 4) == b"\5\0\0\0\1\0\0\0\0scene\4\0\0\0\2\1\0\0\0rows"
    assert rest.read(9 + 4) == b"\4\0\0\0\2\1\0\0\0rows"
    feed.put(ROWS, b"more")
    assert rest.read(9 + 4) == b"\4\0\0\0\2\2\0\0\0more"
    whole.close()
    rest.close()
