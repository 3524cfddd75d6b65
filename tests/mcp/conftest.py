"""Clients of the server, in this process and of a process of its own, in both eras of the protocol."""

from __future__ import annotations

import functools
import json
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from mcp import Client, StdioServerParameters
from mcp.types import CallToolResult, ImageContent, TextContent

from irsim_mcp.limits import ServerLimits
from irsim_mcp.server import IrsimServer, build_server
from tests.warm import SERVERS, warm_mcp

ERAS = ("auto", "legacy")
"""Newest protocol, without a handshake, and the one before."""

ROOM = """\
world: {width: 8, height: 6}
robot:
  - name: rover
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.3}
    state: [1, 1, 0]
    goal: [4, 3, 0]
    behavior: {name: dash}
"""

CRASH = ROOM.replace("goal: [4, 3, 0]", "goal: [7, 1, 0]") + (
    "obstacle:\n  - {name: crate, shape: {name: circle, radius: 0.5}, state: [4, 1, 0]}\n"
)

HANDSHAKE = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "0"}}

linux = pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")

LONG = """\
world: {width: 100, height: 100}
robot:
  - number: 300
    kinematics: {name: diff}
    behavior: {name: dash, wander: true}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [99, 99, 3]}
    shape: {name: circle, radius: 0.2}
    sensors: [{name: lidar2d, number: 1000}]
"""
"""Takes minutes."""


@pytest.fixture
def anyio_backend() -> str:
    return "asyncio"


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    folder = tmp_path / "workspace"
    folder.mkdir()
    return folder


@pytest.fixture(scope="session")
def empty(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that no test writes to, so that tests can share a server."""
    return tmp_path_factory.mktemp("empty")


@functools.lru_cache(maxsize=8)
def server_for(workspace: Path, limits: ServerLimits) -> IrsimServer:
    return build_server(workspace, limits)


class Caller(Client):
    """A client that calls tools with their arguments by name and takes apart what they answer."""

    async def call(self, tool: str, **arguments: Any) -> CallToolResult:
        return await self.call_tool(tool, arguments)

    async def text(self, tool: str, **arguments: Any) -> str:
        return text_of(await self.call_tool(tool, arguments))

    async def error(self, tool: str, **arguments: Any) -> str:
        return error_of(await self.call_tool(tool, arguments))

    async def data(self, tool: str, **arguments: Any) -> dict[str, Any]:
        return data_of(await self.call_tool(tool, arguments))

    async def image(self, tool: str, **arguments: Any) -> ImageContent:
        return image_of(await self.call_tool(tool, arguments))


@asynccontextmanager
async def connected(workspace: Path, era: str = ERAS[0], **limits: Any) -> AsyncIterator[Caller]:
    """A client of a server in this process."""
    server = server_for(workspace, ServerLimits(**limits))
    async with Caller(server, mode=era, raise_exceptions=True) as client:
        yield client


@pytest.fixture
def era() -> str:
    return ERAS[0]


@pytest.fixture
async def client(request: pytest.FixtureRequest, era: str) -> AsyncIterator[Caller]:
    """A client of a server in this process, in ``workspace`` if the test has one, else in ``empty``."""
    folder = request.getfixturevalue("workspace" if "workspace" in request.fixturenames else "empty")
    async with connected(folder, era) as client:
        yield client


@pytest.fixture
async def writer(workspace: Path, era: str) -> AsyncIterator[Caller]:
    """A client of a server in this process that may write."""
    async with Caller(build_server(workspace, writing=True), mode=era, raise_exceptions=True) as client:
        yield client


def as_process(workspace: Path) -> StdioServerParameters:
    """How a host starts the server."""
    command, *arguments = warm_mcp("--workspace", str(workspace))
    return StdioServerParameters(command=command, args=arguments)


def text_of(result: CallToolResult) -> str:
    """The text of a result, which every result has."""
    first = result.content[0]
    assert isinstance(first, TextContent)
    return first.text


def error_of(result: CallToolResult) -> str:
    """The line of an error: its form is checked."""
    assert result.is_error
    assert result.structured_content is None
    text = text_of(result)
    assert len(result.content) == 1
    assert len(text) <= 400
    assert "\n" not in text
    assert "Traceback" not in text
    assert "pydantic" not in text
    return text


def data_of(result: CallToolResult) -> dict[str, Any]:
    """The structure of a result that is not an error."""
    assert not result.is_error, text_of(result)
    assert result.structured_content is not None
    return dict(result.structured_content)


def image_of(result: CallToolResult) -> ImageContent:
    """The picture of a result that is not an error."""
    assert not result.is_error, text_of(result)
    assert result.structured_content is None
    image = result.content[1]
    assert isinstance(image, ImageContent)
    return image


class Wire:
    """A server process, line by line."""

    program: tuple[str, ...] = ("irsim_mcp",)

    def __init__(self, workspace: Path, *options: str, **how: Any) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", *self.program, "--workspace", str(workspace), *options],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, **how,
        )  # fmt: skip
        self.ready = False

    def send(self, **message: Any) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.process.stdin.flush()

    def receive(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        return dict(json.loads(self.process.stdout.readline()))

    def call(self, tool: str, number: int = 2, more: dict[str, Any] | None = None, **arguments: Any) -> None:
        """Ask for a call, after the handshake if it is the first one."""
        self.ask("tools/call", number, name=tool, arguments=arguments, **(more or {}))

    def ask(self, method: str, number: int = 2, **params: Any) -> None:
        """Send a request, after the handshake if it is the first one."""
        if not self.ready:
            self.send(id=1, method="initialize", params=HANDSHAKE)
            assert self.receive()["id"] == 1
            self.send(method="notifications/initialized")
            self.ready = True
        self.send(id=number, method=method, params=params)

    def start_long_run(self) -> list[int]:
        """Begin a run that takes minutes and wait for its first progress; the ids of the worker processes."""
        self.call("run_episode", more={"_meta": {"progressToken": "p"}}, scenario_yaml=LONG)
        assert self.receive()["method"] == "notifications/progress"
        return children_of(self.process.pid)

    def close(self) -> None:
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None:
                stream.close()
        self.process.kill()
        self.process.wait()


@pytest.fixture
def wire(workspace: Path) -> Iterator[Wire]:
    wire = Wire(workspace)
    yield wire
    wire.close()


def children_of(pid: int) -> list[int]:
    folders = Path(f"/proc/{pid}/task").iterdir()
    children = [int(child) for folder in folders for child in (folder / "children").read_text().split()]
    return [child for child in children if child not in SERVERS]
