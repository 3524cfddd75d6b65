"""A program at the other end of ``json_lines``, in a thread: it answers each line with what a function returns."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any


def _until_reset(lines: Iterator[bytes]) -> Iterator[bytes]:
    try:
        yield from lines
    except OSError:
        return


class Peer:
    """Listens on a free port; answers each message with what a function returns: bytes as they are, None is silence."""

    def __init__(self, answer: Callable[[dict[str, Any]], Any]) -> None:
        self.received: list[dict[str, Any]] = []
        self._answer = answer
        self._server = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._server.getsockname()[1]}"
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def __enter__(self) -> Peer:
        return self

    def __exit__(self, *error: object) -> None:
        self._server.close()
        self._thread.join(5)

    def kinds(self) -> list[str]:
        return [message["kind"] for message in self.received]

    def _serve(self) -> None:
        try:
            connection, _ = self._server.accept()
        except OSError:
            return
        with connection, connection.makefile("rb") as lines:
            for line in _until_reset(lines):
                message = json.loads(line)
                self.received.append(message)
                answer = self._answer(message)
                if answer is not None:
                    try:
                        connection.sendall(answer if isinstance(answer, bytes) else json.dumps(answer).encode() + b"\n")
                    except OSError:
                        return
                if message["kind"] == "end":
                    return
