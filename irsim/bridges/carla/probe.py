"""Asking a server for its version before the client does, which ends the whole process if anything but CARLA answers.

A call of CARLA is an array of msgpack-rpc: 0, a number, a name, and arguments, of which the first says whether an
answer is wanted. The answer is an array of 1, the same number, an error or nil, and the value in two arrays.
"""

from __future__ import annotations

import socket
import time

from irsim.bridges.base import BridgeError, BridgeLostError

__all__ = ["server_version"]

_CALL = b"\x94\x00\x01\xa7version\x91\x91\xc2"
_ANSWER = b"\x94\x01\x01"
"""How the answer begins."""
_VALUE = b"\xc0\x91\x92\x01"
"""What follows if there was no error; the text comes next."""
_LONGEST = 300
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
        BridgeError: What answers is not CARLA.
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
    """A short string of msgpack; None if it is none or incomplete."""
    if data and 0xA0 <= data[0] <= 0xBF:
        start, length = 1, data[0] & 0x1F
    elif len(data) > 1 and data[0] == 0xD9:
        start, length = 2, data[1]
    else:
        return None
    found = data[start : start + length]
    return found.decode("utf-8", "replace") if len(found) == length else None
