"""Messages over standard input and output: each request is answered, and the end of input is the end of the server."""

from __future__ import annotations

import asyncio
import json
import math
import os
import sys
import threading
import time
from collections.abc import AsyncIterator, Callable
from concurrent.futures import Future
from contextlib import asynccontextmanager
from functools import partial
from queue import SimpleQueue
from typing import BinaryIO

import anyio
from anyio.streams.memory import MemoryObjectReceiveStream, MemoryObjectSendStream
from mcp.os.win32.utilities import rebind_std_handle_to_fd
from mcp.shared.message import SessionMessage
from mcp.types import (
    INVALID_REQUEST,
    JSONRPCError,
    JSONRPCMessage,
    JSONRPCNotification,
    JSONRPCRequest,
    JSONRPCResponse,
)

from irsim.common.child import Writer, write_to_pipe
from irsim_mcp.frames import MAX_FRAME, BadFrame, frame

__all__ = ["standard_streams"]

_GRACE_S = 1.5
"""Time in which, after the end of input, the next request must be answered for the server to stay [s]."""
_LOOK_S = 0.02
"""Time between two looks whether every request is answered [s]."""

Messages = tuple[MemoryObjectReceiveStream[SessionMessage | Exception], MemoryObjectSendStream[SessionMessage]]


@asynccontextmanager
async def standard_streams() -> AsyncIterator[Messages]:
    """The messages of the client, and where to put those for it.

    Standard input and output become nothing and standard error for everything else, so that what libraries and child
    processes print does not mix with messages. Threads that wait for the client are left behind at the end.
    """
    send, receive = anyio.create_memory_object_stream[SessionMessage | Exception](math.inf)
    out, outgoing = anyio.create_memory_object_stream[SessionMessage](0)
    wire = _Wire(
        os.fdopen(_own(0, os.open(os.devnull, os.O_RDONLY)), "rb", closefd=False),
        os.fdopen(_own(1, os.dup(2)), "wb", buffering=0, closefd=False),
    )
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(wire.read, send)
        tasks.start_soon(wire.write, outgoing)
        yield receive, out
        tasks.cancel_scope.cancel()


def _own(descriptor: int, other: int) -> int:
    """Move a standard stream to a new descriptor, and put another one in its place."""
    moved = os.dup(descriptor)
    os.dup2(other, descriptor)
    os.close(other)
    if sys.platform == "win32":
        rebind_std_handle_to_fd(descriptor)
    return moved


class _Aside:
    """A thread that does one thing after the other, and keeps no process alive when its last one never ends."""

    def __init__(self) -> None:
        self._works: SimpleQueue[tuple[Callable[[], bytes | None], Future[bytes | None]]] = SimpleQueue()
        threading.Thread(target=self._run, daemon=True).start()

    async def do(self, work: Callable[[], bytes | None]) -> bytes | None:
        """Have something done, unless the caller is cancelled before its turn."""
        done: Future[bytes | None] = Future()
        self._works.put((work, done))
        return await asyncio.wrap_future(done)

    def _run(self) -> None:
        while True:
            work, done = self._works.get()
            if done.set_running_or_notify_cancel():
                try:
                    done.set_result(work())
                except OSError:  # the client has gone; the end of input follows
                    done.set_result(None)


class _Wire:
    """Both directions of one client, and which of its requests have no answer yet."""

    def __init__(self, source: BinaryIO, target: Writer) -> None:
        self._source, self._target = source, target
        self._reader, self._writer = _Aside(), _Aside()
        self._in_use: set[str | int | None] = set()
        self._owed = 0
        self._last = 0.0

    async def read(self, send: MemoryObjectSendStream[SessionMessage | Exception]) -> None:
        """Pass on messages until the end of input and until, within a grace, those before it are answered."""
        async with send, anyio.create_task_group() as answers:
            while line := await self._reader.do(self._line):
                if not line.strip():
                    continue
                try:
                    message = frame(line)
                    self._note(message)
                except BadFrame as bad:
                    self._owed += 1
                    answers.start_soon(self._put, bad.answer(), True)
                else:
                    await send.send(SessionMessage(message))
            self._last = time.monotonic()
            while self._owed and time.monotonic() - self._last < _GRACE_S:
                await anyio.sleep(_LOOK_S)
            answers.cancel_scope.cancel()

    async def write(self, outgoing: MemoryObjectReceiveStream[SessionMessage]) -> None:
        """Write messages of the server."""
        async for item in outgoing:
            message = item.message
            known = message.id if isinstance(message, JSONRPCResponse | JSONRPCError) else None
            answers = known in self._in_use
            self._in_use -= {known}
            await self._put(_json(message), answers)

    def _line(self) -> bytes:
        """The next line; of a longer one than is read, the beginning. Empty at the end of input."""
        line = self._source.readline(MAX_FRAME + 1)
        rest = line
        while len(line) > MAX_FRAME and rest and not rest.endswith(b"\n"):
            rest = self._source.readline(MAX_FRAME)
        return line

    def _note(self, message: JSONRPCMessage) -> None:
        """Remember which requests are to be answered.

        Raises:
            BadFrame: A request with the same id is not answered yet.
        """
        if isinstance(message, JSONRPCRequest):
            if message.id in self._in_use:
                what = "a request with this id is not answered yet; each request needs an id of its own"
                raise BadFrame(INVALID_REQUEST, what, message.id)
            self._in_use.add(message.id)
            self._owed += 1
        elif isinstance(message, JSONRPCNotification) and message.method == "notifications/cancelled":
            cancelled = (message.params or {}).get("requestId")
            if isinstance(cancelled, str | int) and cancelled in self._in_use:  # is never answered
                self._in_use.discard(cancelled)
                self._owed -= 1

    async def _put(self, data: bytes, answers: bool) -> None:
        await self._writer.do(partial(write_to_pipe, self._target, data + b"\n"))
        if answers:
            self._owed -= 1
            self._last = time.monotonic()


def _json(message: JSONRPCMessage) -> bytes:
    """A message as JSON; parts that are not Unicode text, as in some names of files, are replaced."""
    try:
        return message.model_dump_json(by_alias=True, exclude_unset=True).encode()
    except ValueError:
        text = json.dumps(message.model_dump(by_alias=True, exclude_unset=True), ensure_ascii=False)
        return text.encode("utf-8", "replace")
