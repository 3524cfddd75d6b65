"""The version of a server, asked for with a few bytes."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.bridges.carla.client import server_version

Serve = Callable[..., int]


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Starts a server that answers one connection with pieces, and returns its port."""
    servers: list[socket.socket] = []

    def start(*pieces: bytes, stay: bool = False) -> int:
        server = socket.create_server(("127.0.0.1", 0))
        servers.append(server)

        def run() -> None:
            try:
                connection, _ = server.accept()
                with connection:
                    assert connection.recv(100) == b"\x94\x00\x01\xa7version\x91\x91\xc2"  # as the official client
                    for piece in pieces:
                        connection.sendall(piece)
                        time.sleep(0.02)
                    if stay:
                        connection.recv(1)
            except OSError:
                pass

        threading.Thread(target=run, daemon=True).start()
        return int(server.getsockname()[1])

    yield start
    for server in servers:
        server.close()


def test_versions(serve: Serve) -> None:
    assert server_version("127.0.0.1", serve(b"\x94\x01\x01\xc0\x91\x92\x01\xa60.9.16", stay=True), 5) == "0.9.16"
    pieces = (b"\x94\x01", b"\x01\xc0\x91\x92", b"\x01\xa60.", b"9.16")
    assert server_version("127.0.0.1", serve(*pieces, stay=True), 5) == "0.9.16"
    long = "0.9.16-" + "a" * 40
    assert (
        server_version("127.0.0.1", serve(b"\x94\x01\x01\xc0\x91\x92\x01\xd9" + bytes((47,)) + long.encode()), 5)
        == long
    )


@pytest.mark.parametrize(
    "answer",
    [
        b"HTTP/1.1 400 Bad Request\r\n\r\n",
        bytes(range(256)) * 100,
        b"\x94\x01\x01\xc0\x91\x92\x00\x91\xa2no",
        b"\x94\x01\x01\xc0\x91\x92\x01\xbf cut",
    ],
)
def test_others_are_refused(serve: Serve, answer: bytes) -> None:
    with pytest.raises(BridgeError, match=r"is not a CARLA server: it answered|does not say its version") as caught:
        server_version("127.0.0.1", serve(answer), 5)
    assert caught.value.code == "bridge-mismatch"


def test_silence_and_nobody(serve: Serve) -> None:
    for port in (serve(stay=True), serve(), 9):
        began = time.monotonic()
        with pytest.raises(BridgeLostError, match=r"no CARLA server answers at .* within 0\.5 s") as caught:
            server_version("127.0.0.1", port, 0.5)
        assert time.monotonic() - began < 3
        assert "CarlaUE4.sh" in str(caught.value)


def test_a_server_that_is_about_to_start() -> None:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        port = server.getsockname()[1]

        def run() -> None:
            time.sleep(0.5)
            server.listen()
            connection, _ = server.accept()
            connection.sendall(b"\x94\x01\x01\xc0\x91\x92\x01\xa60.9.16")
            connection.close()

        thread = threading.Thread(target=run)
        thread.start()
        assert server_version("127.0.0.1", port, 10) == "0.9.16"
        thread.join()
