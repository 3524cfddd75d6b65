"""Connecting to a server of CARLA, and what its errors mean."""

from __future__ import annotations

import socket
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.common.extras import ExtraError, require
from irsim.common.text import clean
from irsim.components.bridges.carla import Carla

__all__ = ["NEWEST_PYTHON", "connect", "import_client", "server_errors", "server_version"]

_CALL = b"\x94\x00\x01\xa7version\x91\x91\xc2"
_ANSWER = b"\x94\x01\x01"
"""How the answer begins."""
_VALUE = b"\xc0\x91\x92\x01"
"""The bytes that follow if there was no error; the text comes next."""
_LONGEST = 300
"""Most bytes of an answer, and most characters of an error."""
_AGAIN = 0.2
"""Time between two attempts to connect [s]: a server may be about to start."""
_START = "start a server first, such as ./CarlaUE4.sh -RenderOffScreen, and check host, port and timeout"


def server_version(host: str, port: int, timeout: float) -> str:
    """The version of the server at an address.

    Args:
        host: Computer.
        port: Port of calls.
        timeout: Time for a connection and an answer together [s].

    Raises:
        BridgeLostError: Nothing listens or answers in time.
        BridgeError: The server that answers is not CARLA.
    """
    deadline = time.monotonic() + timeout
    try:
        with _connected(host, port, deadline) as connection:
            connection.sendall(_CALL)
            answer = _received(connection, deadline)
    except OSError as error:
        why = error.strerror or str(error) or "no answer"
        what = f"no CARLA server answers at {host}:{port} within {timeout:g} s: {why}"
        raise BridgeLostError(what, _START) from None
    version = _text(answer[len(_ANSWER) + len(_VALUE) :])
    if not answer.startswith(_ANSWER + _VALUE) or version is None:
        what = f"what listens at {host}:{port} is not a CARLA server: it answered {answer[:20]!r}"
        if answer.startswith(_ANSWER):
            what = f"the server at {host}:{port} does not say its version, as CARLA much before 0.9.16: {answer[:20]!r}"
        raise BridgeError("bridge-mismatch", what, "check host, port and version; CARLA's usual port is 2000")
    return version


def _connected(host: str, port: int, deadline: float) -> socket.socket:
    while True:
        left = deadline - time.monotonic()
        try:
            return socket.create_connection((host, port), timeout=max(0.01, left))
        except ConnectionRefusedError:
            if left < _AGAIN:
                raise
            time.sleep(_AGAIN)


def _received(connection: socket.socket, deadline: float) -> bytes:
    """The beginning of an answer, until it cannot be a version, or is complete."""
    answer = b""
    while len(answer) < _LONGEST:
        left = deadline - time.monotonic()
        if left <= 0:
            raise TimeoutError
        connection.settimeout(left)
        received = connection.recv(_LONGEST)
        answer += received
        head = _ANSWER + _VALUE
        if not received or answer[: len(head)] != head[: len(answer)] or _text(answer[len(head) :]) is not None:
            break
    if not answer:
        raise ConnectionResetError(0, "the connection was closed")
    return answer


def _text(data: bytes) -> str | None:
    """A short string of msgpack; None if it is something else or incomplete."""
    if data and 0xA0 <= data[0] <= 0xBF:
        start, length = 1, data[0] & 0x1F
    elif len(data) > 1 and data[0] == 0xD9:
        start, length = 2, data[1]
    else:
        return None
    result = data[start : start + length]
    return result.decode("utf-8", "replace") if len(result) == length else None


NEWEST_PYTHON = (3, 12)
"""The newest Python that the client is made for."""
_LOST = ("time-out", "timeout", "rpc::", "connection", "broken pipe")
"""Words of errors of a server that is gone."""


def import_client() -> Any:
    """The module ``carla``.

    Raises:
        ExtraError: It is not installed, or does not exist for this Python.
    """
    try:
        require("carla", "carla")
    except ExtraError:
        if sys.version_info[:2] <= NEWEST_PYTHON:
            raise
        what = f"the client of CARLA is made for Python up to {NEWEST_PYTHON[0]}.{NEWEST_PYTHON[1]}"
        fix = "use another Python: uv venv --python 3.12, then pip install 'irsim-mcp[carla]'"
        raise ExtraError(
            "missing-extra", f"{what}, and this is {sys.version_info[0]}.{sys.version_info[1]}", fix
        ) from None
    import carla

    return carla


@contextmanager
def server_errors(what: str, address: str, lose: Callable[[], None] | None = None) -> Iterator[None]:
    """Turn errors of the client, which all are a ``RuntimeError``, into one that says what failed.

    Args:
        what: The action that is guarded, for messages.
        address: Where the server is.
        lose: Called if the server does not answer.
    """
    try:
        yield
    except BridgeLostError:
        if lose is not None:
            lose()
        raise
    except RuntimeError as error:
        text = clean(str(error), _LONGEST)
        if any(word in text.lower() for word in _LOST):
            if lose is not None:
                lose()
            raise BridgeLostError(f"the CARLA server at {address} did not answer ({what}): {text}") from None
        raise BridgeError("bridge-failed", f"CARLA refused {what}: {text}", "look at the log of the server") from None


def connect(options: Carla) -> tuple[Any, Any, Any]:
    """The module ``carla``, a client of the server, and its world.

    Raises:
        ExtraError: The client library is missing.
        BridgeLostError: No server answers within the timeout.
        BridgeError: The server that answers is not CARLA, or has another version or another town.
    """
    carla = import_client()
    address = f"{options.host}:{options.port}"
    theirs = server_version(options.host, options.port, options.timeout)
    with server_errors("connecting", address):
        client = carla.Client(options.host, options.port)
        client.set_timeout(options.timeout)
        ours = client.get_client_version()
    if theirs != ours and not options.any_version:
        what = f"the CARLA server at {address} has version {clean(theirs, 40)}, and the client of this Python {ours}"
        fix = f"install the client of the server: pip install carla=={clean(theirs, 40)}; or try any_version: true"
        raise BridgeError("bridge-mismatch", what, fix)
    with server_errors("getting the world", address):
        world = client.get_world()
    if options.town is not None:
        with server_errors("getting the map", address):
            name = str(world.get_map().name)
        if name.rsplit("/", 1)[-1] != options.town.rsplit("/", 1)[-1]:
            what = f"the CARLA server at {address} has loaded {clean(name)}, not {clean(options.town)}"
            fix = f"load it: python PythonAPI/util/config.py --map {clean(options.town)}; or write town: {clean(name)}"
            raise BridgeError("bridge-mismatch", what, fix)
    return carla, client, world
