"""Attacks on the HTTP server without a token: each ends, costs bounded memory, and others are served afterwards."""

from __future__ import annotations

import logging
import os
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx2
import pytest

from irsim.common import connections
from irsim.common.connections import most_connections, server_of
from irsim_mcp import bodies, http, log, worker
from irsim_mcp.bodies import WholeMessages
from irsim_mcp.hosts import Address
from irsim_mcp.http import application
from irsim_mcp.server import build_server
from tests.mcp.conftest import ROOM, Caller, linux
from tests.mcp.test_http import DISCOVER, HEADERS, served

if sys.platform != "win32":
    import resource

pytestmark = [pytest.mark.one_python, pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")]

HEAD = b"POST /mcp HTTP/1.1\r\nHost: localhost\r\n"


@contextmanager
def files(process: int, most: int) -> Iterator[None]:
    """A limit of the number of open files of a process."""
    soft, hard = resource.prlimit(process, resource.RLIMIT_NOFILE)
    resource.prlimit(process, resource.RLIMIT_NOFILE, (most, hard))
    yield
    resource.prlimit(process, resource.RLIMIT_NOFILE, (soft, hard))


def memory(process: subprocess.Popen[str]) -> float:
    """Memory of a process [MB]."""
    text = Path(f"/proc/{process.pid}/status").read_text()
    return int(text.partition("VmRSS:")[2].split()[0]) / 1024


def answers(url: str, seconds: float = 20) -> bool:
    """Whether a server answers before a time is over."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with suppress(httpx2.HTTPError):
            if httpx2.post(url, json=DISCOVER, headers=HEADERS).status_code == 200:
                return True
        time.sleep(0.1)
    return False


def received(connection: socket.socket, seconds: float = 10) -> bytes:
    """Everything until the other side closes the connection."""
    connection.settimeout(seconds)
    data = b""
    with suppress(ConnectionResetError):
        while part := connection.recv(65536):
            data += part
    return data


@linux
@pytest.mark.usefixtures("ordinary_processes")
@pytest.mark.parametrize(("limit", "count", "most"), [(1024, 1100, 256), (256, 300, 144)])
def test_idle_connections(empty: Path, limit: int, count: int, most: int) -> None:
    with served(empty, "--http", "0") as (url, process), files(process.pid, limit), files(0, count + 200):
        assert answers(url)
        before = memory(process)
        where = (urlsplit(url).hostname, urlsplit(url).port)
        with ExitStack() as stack:
            clients = [stack.enter_context(socket.create_connection(where, 10)) for _ in range(count)]
            assert received(clients[-1]).startswith(b"HTTP/1.1 503 ")
            refused = sum(received(client).startswith(b"HTTP/1.1 503 ") for client in reversed(clients[most:]))
            assert process.poll() is None
            assert refused >= (count - most) / 2  # on a busy machine, others get the places of slow ones
        assert answers(url)
        assert memory(process) - before < 20


@linux
@pytest.mark.usefixtures("ordinary_processes")
def test_no_descriptors_left(empty: Path) -> None:
    with served(empty, "--http", "0") as (url, process):
        assert answers(url)
        used = len(list(Path(f"/proc/{process.pid}/fd").iterdir()))
        where = (urlsplit(url).hostname, urlsplit(url).port)
        with files(process.pid, used + 2), ExitStack() as stack:
            for _ in range(30):
                stack.enter_context(socket.create_connection(where, 10))
            time.sleep(1.5)
            assert process.poll() is None
        assert answers(url)


def test_the_limit_of_connections_follows_that_of_files(monkeypatch: pytest.MonkeyPatch) -> None:
    for files, most in ((256, 144), (64, 8), (1024, 256), (resource.RLIM_INFINITY, 256)):
        monkeypatch.setattr(resource, "getrlimit", lambda _, files=files: (files, files))
        assert most_connections() == most


@contextmanager
def serving(app: Any) -> Iterator[tuple[Callable[[], socket.socket], Any]]:
    """A server of an application in a thread: what connects to it, and the server."""
    listening = socket.create_server(("127.0.0.1", 0))
    server = server_of(app)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    where = listening.getsockname()
    with ExitStack() as stack:
        yield lambda: stack.enter_context(socket.create_connection(where, 10)), server
    server.should_exit = True
    thread.join(20)
    assert not thread.is_alive()


async def plain(scope: Any, receive: Any, send: Any) -> None:
    """An application that answers with 20 MB to GET, and with the size of the body to the rest."""
    if scope["type"] != "http":
        return
    size = 20_000_000
    if scope["method"] != "GET":
        size = len((await receive())["body"])
    await send({"type": "http.response.start", "status": 200, "headers": [(b"content-length", b"%d" % size)]})
    for start in range(0, size, 1_000_000):
        part = b" " * min(1_000_000, size - start)
        await send({"type": "http.response.body", "body": part, "more_body": start + 1_000_000 < size})


MESSAGE = b'{"jsonrpc":"2.0","id":1,"method":"ping"}'
WHOLE = HEAD + b"Content-Length: %d\r\n\r\n" % len(MESSAGE) + MESSAGE


@pytest.mark.parametrize("first", [b"", WHOLE])
@pytest.mark.parametrize("begin", [b"", HEAD, b"P"])
def test_headers_have_their_time(monkeypatch: pytest.MonkeyPatch, first: bytes, begin: bytes) -> None:
    monkeypatch.setattr(connections, "_HEADER_S", 0.4)
    with serving(plain) as (connect, _):
        client = connect()
        client.sendall(first)
        if first:
            assert client.recv(1000).startswith(b"HTTP/1.1 200 OK")
        client.sendall(begin)
        begun = time.monotonic()
        client.settimeout(0.1)
        data: bytes | None = None
        while data is None and time.monotonic() - begun < 8:
            try:
                data = client.recv(1000)
            except TimeoutError:
                if begin:
                    with suppress(OSError):
                        client.sendall(b"x")  # a byte now and then does not help
            except ConnectionResetError:
                data = b""
        assert data is not None
        assert not data or data.startswith((b"HTTP/1.1 408 ", b"HTTP/1.1 400 ", b" "))
        assert connect().sendall(WHOLE) is None


def test_a_client_that_never_reads_is_let_go(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connections, "_UNREAD_S", 0.3)
    with serving(plain) as (connect, server):
        client = connect()
        client.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
        end = time.monotonic() + 10
        while server.server_state.total_requests == 0 and not server.server_state.connections:
            time.sleep(0.01)
        while server.server_state.connections and time.monotonic() < end:
            time.sleep(0.05)
        assert not server.server_state.connections


def test_bodies_have_their_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bodies, "_SECONDS", 0.4)
    with serving(WholeMessages(plain)) as (connect, _):
        slow, quick = connect(), connect()
        slow.sendall(HEAD + b"Content-Length: 1000\r\n\r\n{")
        quick.sendall(WHOLE)
        assert quick.recv(1000).startswith(b"HTTP/1.1 200 OK")
        assert received(slow).startswith(b"HTTP/1.1 408 ")


def test_a_body_that_is_announced_as_too_large_is_refused_at_once() -> None:
    with serving(WholeMessages(plain)) as (connect, _):
        waiting, sending, asking = connect(), connect(), connect()
        began = time.monotonic()
        size = 50_000_000
        waiting.sendall(HEAD + b"Content-Length: %d\r\n\r\n" % size)
        asking.sendall(HEAD + b"Expect: 100-continue\r\nContent-Length: %d\r\n\r\n" % size)
        sending.sendall(HEAD + b"Content-Length: %d\r\n\r\n" % size + b" " * size)
        for client in (waiting, asking, sending):
            answer = received(client)
            assert answer.startswith(b"HTTP/1.1 413 ")
            assert b"at most 4,194,304 bytes" in answer
        assert time.monotonic() - began < 8
        clients = [connect(), connect()]
        clients[0].sendall(HEAD + b"Content-Length: %d\r\n\r\n" % 4_194_304)
        clients[1].sendall(WHOLE)
        assert clients[1].recv(1000).startswith(b"HTTP/1.1 200 OK")


def test_bodies_share_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bodies, "_MOST_TOGETHER", 100_000)
    with serving(WholeMessages(plain)) as (connect, _):
        clients = [connect() for _ in range(3)]
        for client in clients:
            client.sendall(HEAD + b"Content-Length: 50000\r\n\r\n" + b" " * 40_000)
        assert received(clients[2]).startswith(b"HTTP/1.1 503 ")
        for client in clients[:2]:
            client.sendall(b" " * (10_000 - len(MESSAGE)) + MESSAGE)
            assert client.recv(1000).startswith(b"HTTP/1.1 200 OK")
        clients.append(connect())
        clients[3].sendall(WHOLE)
        assert clients[3].recv(1000).startswith(b"HTTP/1.1 200 OK")


def test_streams_without_end_leave_connections_for_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bodies, "_MOST_STREAMS", 2)
    listen = MESSAGE.replace(b"ping", b"subscriptions/listen")
    whole = HEAD + b"Content-Length: %d\r\n\r\n" % len(listen) + listen

    async def app(scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] == "http" and b"listen" in (await receive())["body"]:
            await send({"type": "http.response.start", "status": 200, "headers": []})
            await send({"type": "http.response.body", "body": b":", "more_body": True})
            await receive()
        elif scope["type"] == "http":
            await plain(scope, receive, send)

    with serving(WholeMessages(app)) as (connect, server):
        clients = [connect() for _ in range(3)]
        heads = []
        for client in clients:
            client.sendall(whole)
            heads.append(client.recv(100)[:13])
        assert heads == [b"HTTP/1.1 200 ", b"HTTP/1.1 200 ", b"HTTP/1.1 503 "]
        clients[0].close()
        end = time.monotonic() + 10
        while len(server.server_state.tasks) > 1 and time.monotonic() < end:
            time.sleep(0.01)
        clients.append(connect())
        clients[3].sendall(whole)
        assert clients[3].recv(100).startswith(b"HTTP/1.1 200 ")


def test_answers_are_sent_without_delay(empty: Path) -> None:
    with served(empty, "--http", "0") as (url, _), httpx2.Client() as client:
        times = []
        for _ in range(15):
            begin = time.monotonic()
            assert client.post(url, content=b"{}", headers=HEADERS).status_code == 400
            times.append(time.monotonic() - begin)
    assert min(times) < 0.03  # the system delays acknowledgements by 40 ms, for which an answer in two parts would wait


@pytest.mark.anyio
async def test_a_worker_that_cannot_be_started_is_said(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said = "worker-failed: the process that does the work could not be started: No such file or directory"
    async with Caller(build_server(workspace)) as client:
        with monkeypatch.context() as patch:
            patch.setattr(worker, "_command", lambda: ["/nowhere/python"])
            assert (await client.error("lookup", topic="dash")).startswith(said)
            assert (await client.error("run_episode", scenario_yaml=ROOM)).startswith(said)
            assert said in str(await client.call("benchmark", scenarios=[ROOM], seeds=1))
        assert not (await client.call("lookup", topic="dash")).is_error


@pytest.mark.anyio
async def test_sessions_have_a_limit_and_end(empty: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert (http._MAX_SESSIONS, http._IDLE_SECONDS) == (64, 1800)
    monkeypatch.setattr(http, "_MAX_SESSIONS", 3)
    monkeypatch.setattr(http, "_IDLE_SECONDS", 0.5)
    server = build_server(empty)
    app = application(server, Address("127.0.0.1", 80), None)
    transport = httpx2.ASGITransport(app=app)
    async with server.session_manager.run(), httpx2.AsyncClient(transport=transport, headers=HEADERS) as client:

        async def opened() -> int:
            return (await client.post("http://localhost/mcp", json=DISCOVER)).status_code

        assert [await opened() for _ in range(4)] == [200, 200, 200, 503]
        end = time.monotonic() + 10
        while (status := await opened()) == 503 and time.monotonic() < end:
            time.sleep(0.1)
        assert status == 200


def test_a_log_that_nobody_reads_stops_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    reading, writing = os.pipe()
    monkeypatch.setattr(log, "_STDERR", writing)
    handler = log._Plain()
    record = logging.makeLogRecord({"msg": "x" * 3000, "levelno": logging.ERROR})
    for _ in range(100):  # more than a pipe holds
        handler.emit(record)
    os.close(reading)
    handler.emit(record)
    os.close(writing)
    handler.emit(record)
