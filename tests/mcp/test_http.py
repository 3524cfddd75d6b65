"""Serving over HTTP: who may connect, that nothing else changes, and that it ends when told to."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

import anyio
import httpx2
import pytest
from mcp.client.streamable_http import streamable_http_client

from irsim_mcp.hosts import Address, HttpRefused, address, allowed_hosts, why_refused
from irsim_mcp.http import application, token_from
from irsim_mcp.sandbox import Workspace
from irsim_mcp.server import build_server
from tests.mcp.conftest import ERAS, LONG, ROOM, Caller, children_of, linux
from tests.processes import wait_until_gone
from tests.warm import warm_mcp

TOKEN = "a-token-that-is-long-enough"
DISCOVER = {
    "jsonrpc": "2.0",
    "id": 1,
    "method": "initialize",
    "params": {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "t", "version": "0"}},
}
HEADERS = {"Accept": "application/json, text/event-stream", "Content-Type": "application/json"}


@contextmanager
def served(
    workspace: Path, *options: str, environment: dict[str, str] | None = None
) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """A server in a process of its own, and its address."""
    process = subprocess.Popen(
        warm_mcp("--workspace", str(workspace), *options),
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, **(environment or {})},
    )
    assert process.stderr is not None
    try:
        match = re.fullmatch(r"irsim-mcp: serving (http://\S+)\n", process.stderr.readline())
        assert match is not None
        yield match[1], process
    finally:
        process.terminate()
        process.wait(20)
        process.stderr.close()


@pytest.fixture(scope="module")
def local(empty: Path) -> Iterator[str]:
    with served(empty, "--http", "0") as (url, _):
        yield url


@pytest.mark.anyio
@pytest.mark.parametrize("era", ERAS)
async def test_the_same_server_answers(local: str, era: str) -> None:
    async with Caller(local, mode=era) as client:
        data = await client.data("validate_scenario", scenario_yaml=ROOM)
        assert data["valid"]
        assert len((await client.list_prompts()).prompts) == 3
        assert len((await client.list_tools()).tools) == 7


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"Origin": "http://localhost:3000"}, 200),
        ({"Origin": "https://evil.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Origin": "http://localhost.evil.example"}, 403),
        ({"Host": "evil.example"}, 421),
        ({"Host": "localhost.evil.example:80"}, 421),
        ({"Host": "127.0.0.1.nip.io:8000"}, 421),
        ({"Content-Type": "text/plain"}, 400),
        ({"Host": "LOCALHOST:80"}, 200),
        ({"Host": "localhost."}, 200),
        ({"Host": "[::1]:80", "Origin": "HTTP://127.1"}, 200),
        ({"Host": "127.0.0.1:80@evil"}, 421),
        ({"Host": "127.0.0.1:80@evil.example:80"}, 421),
        ({"Host": "user@localhost"}, 421),
        ({"Host": "localhost:80, evil.example"}, 421),
        ({"Host": "localhost:port"}, 421),
        ({"Host": "localhost/evil"}, 421),
        ({"Host": "0.0.0.0"}, 421),
        ({"Host": ""}, 421),
        ({"Origin": ""}, 403),
        ({"Origin": "http://localhost http://evil.example"}, 403),
        ({"Origin": "http://localhost, https://evil.example"}, 403),
        ({"Origin": "http://localhost:80@evil.example"}, 403),
        ({"Origin": "http://localhost:80.evil.example"}, 403),
        ({"Origin": "http://localhost/evil"}, 403),
        ({"Origin": "file://localhost"}, 403),
        ({"Origin": "localhost"}, 403),
    ],
)
def test_pages_of_other_sites_are_not_let_in(local: str, headers: dict[str, str], status: int) -> None:
    answer = httpx2.post(local, json=DISCOVER, headers={**HEADERS, **headers})
    assert answer.status_code == status
    assert "Traceback" not in answer.text


@pytest.mark.parametrize(
    ("name", "values", "status"),
    [
        ("Origin", ["http://localhost", "https://evil.example"], 403),
        ("Origin", ["http://localhost", "http://localhost"], 403),
        ("Host", ["localhost", "evil.example"], 400),
        ("Host", ["localhost", "localhost"], 400),
    ],
)
def test_several_lines_of_one_header_are_refused(local: str, name: str, values: list[str], status: int) -> None:
    lines = {"Host": "localhost", **HEADERS, "Content-Length": "0"}
    text = "".join(f"{key}: {value}\r\n" for key, value in lines.items() if key != name)
    text += "".join(f"{name}: {value}\r\n" for value in values)
    url = urlsplit(local)
    with socket.create_connection((url.hostname, url.port), 10) as client:
        client.sendall(f"POST /mcp HTTP/1.1\r\n{text}\r\n".encode())
        assert client.recv(1000).startswith(f"HTTP/1.1 {status} ".encode())


def test_bodies_have_a_limit(local: str) -> None:
    big = httpx2.post(local, content=b"[" + b" " * (5 * 1024 * 1024) + b"]", headers=HEADERS)
    assert big.status_code == 413


def test_nothing_else_is_served(local: str) -> None:
    root = local.removesuffix("/mcp")
    for path in ("/", "/docs", "/openapi.json", "/mcp/../etc/passwd", "/.irsim/runs"):
        assert httpx2.get(root + path).status_code == 404


@pytest.mark.anyio
async def test_a_token_is_asked_for(empty: Path, tmp_path: Path) -> None:
    file = tmp_path / "token"
    file.write_text(TOKEN + "\n", encoding="utf-8")
    with served(empty, "--http", "0", "--token-file", str(file)) as (url, _):
        for sent in (None, "", TOKEN, f"Bearer {TOKEN[:-1]}", f"Bearer {TOKEN}x", f"Basic {TOKEN}", "Bearer"):
            headers = HEADERS if sent is None else {**HEADERS, "Authorization": sent}
            answer = httpx2.post(url, json=DISCOVER, headers=headers)
            assert (answer.status_code, answer.headers["WWW-Authenticate"]) == (401, "Bearer")
            assert TOKEN not in answer.text
        for method in ("GET", "DELETE", "OPTIONS"):
            assert httpx2.request(method, url).status_code == 401
        for sent in (f"bearer {TOKEN}", f"BEARER  {TOKEN}"):
            assert httpx2.post(url, json=DISCOVER, headers={**HEADERS, "Authorization": sent}).status_code == 200
        async with (
            httpx2.AsyncClient(headers={"Authorization": f"Bearer {TOKEN}"}) as http,
            Caller(streamable_http_client(url, http_client=http)) as client,
        ):
            assert len((await client.list_tools()).tools) == 7


def test_the_token_may_come_from_the_environment_and_workers_do_not_get_it(empty: Path) -> None:
    from irsim_mcp.worker import process_options

    os.environ["IRSIM_MCP_TOKEN"] = TOKEN
    try:
        assert token_from(None) == TOKEN
        assert TOKEN not in process_options(Workspace(empty))[1]["env"].values()
    finally:
        del os.environ["IRSIM_MCP_TOKEN"]
    with served(empty, "--http", "0", environment={"IRSIM_MCP_TOKEN": TOKEN}) as (url, _):
        assert httpx2.post(url, json=DISCOVER, headers=HEADERS).status_code == 401


@pytest.mark.parametrize("text", ["", "short", "with blanks in between it", "ümläüte-sind-keine-token", "x" * 2000])
def test_tokens_that_are_none(tmp_path: Path, text: str) -> None:
    file = tmp_path / "token"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(HttpRefused, match="letters, digits"):
        token_from(file)


@pytest.mark.parametrize("options", [("0.0.0.0:0",), ("[::]:0",), ("192.0.2.1:0",), ("example.org:80",)])
def test_other_machines_need_a_token(empty: Path, options: tuple[str, ...]) -> None:
    done = subprocess.run(
        warm_mcp("--workspace", str(empty), "--http", *options),
        capture_output=True,
        text=True,
        check=False,
        env={name: value for name, value in os.environ.items() if name != "IRSIM_MCP_TOKEN"},
    )
    assert done.returncode == 2
    assert "needs a token: give --token-file FILE or set IRSIM_MCP_TOKEN" in done.stderr


@pytest.mark.anyio
async def test_other_machines_connect_by_names_that_were_told(empty: Path) -> None:
    server = build_server(empty)
    with pytest.raises(HttpRefused, match="--allow-host NAME"):
        application(server, Address("0.0.0.0", 80), TOKEN)
    app = application(server, Address("0.0.0.0", 80), TOKEN, ["robots.example"])
    headers = {**HEADERS, "Authorization": f"Bearer {TOKEN}"}
    transport = httpx2.ASGITransport(app=app)
    async with server.session_manager.run(), httpx2.AsyncClient(transport=transport, headers=headers) as client:
        for host, origin, status in (
            ("robots.example", None, 200),
            ("robots.example:8000", "https://robots.example", 200),
            ("other.example", None, 421),
            ("localhost:80", None, 421),
            ("robots.example", "https://other.example", 403),
        ):
            more = {"Host": host} | ({"Origin": origin} if origin else {})
            answer = await client.post("http://robots.example/mcp", json=DISCOVER, headers=more)
            assert answer.status_code == status


@pytest.mark.parametrize(
    "text",
    [
        "0.0.0.0", "0", "00", "0x0", "0.0", "0.0.0", "000.0.0.0", "0x0.0.0.0", "[::]", "[::0]", "[0:0:0:0:0:0:0:0]",
        "[::ffff:0.0.0.0]", "[::ffff:0:0]", "[0:0:0:0:0:FFFF:0:0]", "[::0.0.0.0]", "[::%1]",
        "\uff10.\uff10.\uff10.\uff10", "every.example",
    ],
)  # fmt: skip
def test_every_spelling_of_all_addresses_needs_names(empty: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    resolve = socket.getaddrinfo
    monkeypatch.setattr(
        socket, "getaddrinfo", lambda host, *a, **k: resolve(host.replace("every.example", "::"), *a, **k)
    )
    with pytest.raises(HttpRefused, match="needs a token"):
        application(build_server(empty), address(f"{text}:0"), None)
    with pytest.raises(HttpRefused, match="--allow-host NAME"):
        application(build_server(empty), address(f"{text}:0"), TOKEN)


@pytest.mark.parametrize(
    "name",
    [
        "", "0", "0.0.0.0", "[::]", "*", "http://robots.example", "a@b", "a b", "0x0.", "00.0", "::%eth0",
        "[::%25eth0]", "0::0.0.0.0", "..", "0..", "a..b", "4294967296",
        "08.0.0.1", "1.2.3.4.5", "robots.0x", "a\n", "０",
    ],
)  # fmt: skip
def test_names_that_are_none(empty: Path, name: str) -> None:
    with pytest.raises(HttpRefused, match="--allow-host"):
        application(build_server(empty), Address("0.0.0.0", 80), TOKEN, [name])


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("robots.example.:80", ["robots.example", "ROBOTS.example.:9"]),
        ("0xA.1", ["10.0.0.1", "012.0.0.1:80", "167772161", "[::ffff:a00:1]"]),
        ("fe80::1%eth0", ["[fe80::1]", "[fe80::1%25eth0]:80", "[FE80:0::1%eth1]"]),
        ("0a.example", ["0A.example"]),
    ],
)
def test_names_have_many_spellings(name: str, said: list[str]) -> None:
    allowed = allowed_hosts(address("[fe80::2%25lo]:80"), [name])
    for host in (*said, "[fe80::2%lo]", "[fe80::2]:80"):
        assert why_refused([(b"host", host.encode()), (b"origin", f"http://{host}".encode())], allowed) is None
    assert "" not in allowed_hosts(address("[%lo]:80"), [name])
    for host in ("", "robots.example..", "fe80::1", "[fe80::1%]", "[fe80::1%a%b]", "10.0.0.1%eth0", "[%lo]", "[..]"):
        assert why_refused([(b"host", host.encode())], allowed) == (421, "Invalid Host header")


@pytest.mark.parametrize(
    ("text", "read", "loopback"),
    [
        ("8000", ("127.0.0.1", 8000), True),
        ("localhost:1", ("localhost", 1), True),
        ("127.1.2.3:1", ("127.1.2.3", 1), True),
        ("[::1]:65535", ("::1", 65535), True),
        ("0.0.0.0:0", ("0.0.0.0", 0), False),
        ("localhost.evil.example:1", ("localhost.evil.example", 1), False),
        ("127.1:1", ("127.0.0.1", 1), True),
        ("[::ffff:127.0.0.1]:1", ("127.0.0.1", 1), True),
        ("LocalHost.:1", ("localhost", 1), True),
        ("2130706433:1", ("127.0.0.1", 1), True),
    ],
)
def test_addresses(text: str, read: tuple[str, int], loopback: bool) -> None:
    assert address(text) == read
    assert address(text).loopback is loopback


@pytest.mark.parametrize("text", ["", ":80", "::1:80", "host", "host:", "host:x", "host:70000", "1:2:3", "-1", "80 "])
def test_no_addresses(text: str) -> None:
    with pytest.raises(ValueError, match=re.escape("[HOST:]PORT")):
        address(text)


def test_a_port_in_use_is_told(local: str, empty: Path) -> None:
    port = local.removesuffix("/mcp").rpartition(":")[2]
    done = subprocess.run(
        warm_mcp("--workspace", str(empty), "--http", port), capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert f"--http 127.0.0.1:{port}: " in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@linux
@pytest.mark.anyio
@pytest.mark.usefixtures("ordinary_processes")
async def test_it_ends_soon_with_a_run_under_way_and_leaves_nobody(workspace: Path) -> None:
    with served(workspace, "--http", "0") as (url, process):
        async with anyio.create_task_group() as group:

            async def run() -> None:
                with suppress(Exception):
                    async with Caller(url) as client:
                        await client.call("run_episode", scenario_yaml=LONG)

            group.start_soon(run)
            workers: list[int] = []
            while not workers:
                await anyio.sleep(0.1)
                workers = children_of(process.pid)
            start = time.monotonic()
            process.terminate()
            await anyio.to_thread.run_sync(process.wait)
            assert time.monotonic() - start < 10
            group.cancel_scope.cancel()
    wait_until_gone(workers, 5)
