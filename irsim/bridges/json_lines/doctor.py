"""Test of ``json_lines`` over the loopback."""

from __future__ import annotations

import socket

from irsim.bridges.doctor import Part

__all__ = ["PARTS"]


def _loopback() -> str:
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname(), timeout=5) as sender,
    ):
        sender.sendall(b"{}\n")
        receiver, _ = server.accept()
        with receiver, receiver.makefile("rb") as lines:
            if lines.readline() != b"{}\n":
                raise OSError("what was sent did not arrive")
    return "a line crossed a TCP connection of this machine"


PARTS = (Part("socket", None, "part of Python", _loopback),)
