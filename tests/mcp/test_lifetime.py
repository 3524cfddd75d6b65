"""Processes: start, end of input, cancellation, a killed server, too many calls. Nothing is left behind."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import anyio
import pytest

from tests.mcp.conftest import ERAS, LONG, ROOM, Caller, as_process, connected, error_of
from tests.warm import SERVERS

HANDSHAKE = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "0"}}
pytestmark = [pytest.mark.one_python, pytest.mark.usefixtures("ordinary_processes")]
linux = pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")


class Wire:
    """A server process, line by line."""

    def __init__(self, workspace: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "irsim_mcp", "--workspace", str(workspace)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def send(self, **message: Any) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.process.stdin.flush()

    def receive(self) -> dict[str, Any]:
        assert self.process.stdout is not None
        return dict(json.loads(self.process.stdout.readline()))

    def start_long_run(self) -> list[int]:
        """Begin a run that takes minutes and wait for its first progress; the ids of the worker processes."""
        self.send(id=1, method="initialize", params=HANDSHAKE)
        self.receive()
        self.send(method="notifications/initialized")
        arguments = {"scenario_yaml": LONG}
        params = {"name": "run_episode", "arguments": arguments, "_meta": {"progressToken": "p"}}
        self.send(id=2, method="tools/call", params=params)
        assert self.receive()["method"] == "notifications/progress"
        return children_of(self.process.pid)


@pytest.fixture
def wire(workspace: Path) -> Iterator[Wire]:
    wire = Wire(workspace)
    yield wire
    for stream in (wire.process.stdin, wire.process.stdout):
        if stream is not None:
            stream.close()
    wire.process.kill()
    wire.process.wait()


def children_of(pid: int) -> list[int]:
    folders = Path(f"/proc/{pid}/task").iterdir()
    children = [int(child) for folder in folders for child in (folder / "children").read_text().split()]
    return [child for child in children if child not in SERVERS]


def runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def wait_until_gone(pids: list[int], seconds: float) -> None:
    end = time.monotonic() + seconds
    while any(map(runs, pids)) and time.monotonic() < end:
        time.sleep(0.02)
    assert [pid for pid in pids if runs(pid)] == []


@linux
def test_end_of_input_ends_server_and_worker(wire: Wire, workspace: Path) -> None:
    workers = wire.start_long_run()
    assert len(workers) == 1
    assert wire.process.stdin is not None
    wire.process.stdin.close()
    wait_until_gone([*workers, wire.process.pid], 3)
    assert wire.process.wait() == 0
    assert [path.name for path in workspace.iterdir()] == [".irsim"]


@linux
@pytest.mark.parametrize(
    "how", [*(pytest.param(how, marks=pytest.mark.slow) for how in ("kill", "terminate")), "interrupt"]
)
@pytest.mark.usefixtures("interruptible")
def test_a_server_that_is_killed_takes_its_workers_along(wire: Wire, how: str) -> None:
    workers = wire.start_long_run()
    assert len(workers) == 1
    {"kill": wire.process.kill, "terminate": wire.process.terminate, "interrupt": lambda: wire.process.send_signal(2)}[
        how
    ]()
    wait_until_gone([*workers, wire.process.pid], 3)


def test_it_survives_nonsense(wire: Wire) -> None:
    assert wire.process.stdin is not None
    wire.process.stdin.write("not a message\n{}\n")
    wire.send(id=1, method="initialize", params=HANDSHAKE)
    answers = [wire.receive()]
    while answers[-1].get("id") != 1:
        answers.append(wire.receive())
    assert answers[-1]["result"]["serverInfo"]["name"] == "irsim"
    wire.send(id=2, method="no/such/method", params={})
    assert wire.receive()["error"]["code"] == -32601


@linux
@pytest.mark.anyio
@pytest.mark.parametrize("era", [ERAS[0], pytest.param(ERAS[1], marks=pytest.mark.slow)])
async def test_cancelling_a_call_ends_its_worker(workspace: Path, era: str) -> None:
    started = anyio.Event()

    async def on_progress(done: float, total: float | None, message: str | None) -> None:
        started.set()

    async with Caller(as_process(workspace), mode=era) as client:
        server = children_of(os.getpid())
        async with anyio.create_task_group() as tasks:
            arguments = {"scenario_yaml": LONG}

            async def call() -> None:
                await client.call_tool("run_episode", arguments, progress_callback=on_progress)

            tasks.start_soon(call)
            await started.wait()
            workers = [worker for pid in server for worker in children_of(pid)]
            assert len(workers) == 1
            tasks.cancel_scope.cancel()
        end = time.monotonic() + 3
        while any(map(runs, workers)) and time.monotonic() < end:
            await anyio.sleep(0.02)
        assert not any(map(runs, workers))
        assert (await client.data("validate_scenario", scenario_yaml=ROOM))["valid"]


@pytest.mark.slow
@linux
@pytest.mark.anyio
async def test_of_a_run_whose_worker_is_killed_the_beginning_can_be_read(client: Caller, workspace: Path) -> None:
    async def on_progress(done: float, total: float | None, message: str | None) -> None:
        if list(workspace.rglob("trace*")):  # some of it is written down
            for pid in children_of(os.getpid()):
                os.kill(pid, signal.SIGKILL)

    told = error_of(await client.call_tool("run_episode", {"scenario_yaml": LONG}, progress_callback=on_progress))
    match = re.search(r"inspect_run run_id=(\S+) shows the steps until then", told)
    assert match is not None, told
    assert re.match(r"worker-failed: the process that did the work ended with code -9 after \d+ of [0-9,]+ steps", told)
    table = await client.data("inspect_run", run_id=match[1], limit=1)
    assert "interrupted" in json.dumps(table)


@pytest.mark.anyio
async def test_more_calls_than_workers_are_told_to_come_back(empty: Path) -> None:
    async with connected(empty, workers=1) as client:
        async with anyio.create_task_group() as tasks:

            async def occupy() -> None:
                await client.call("run_episode", scenario_yaml=LONG)

            tasks.start_soon(occupy)
            await anyio.sleep(0.3)
            told = await client.error("validate_scenario", scenario_yaml=ROOM)
            tasks.cancel_scope.cancel()
        assert told.startswith("busy: 1 calls are being processed")
        assert (await client.data("validate_scenario", scenario_yaml=ROOM))["valid"]


@pytest.mark.anyio
async def test_calls_at_the_same_time_do_not_mix(empty: Path) -> None:
    goals = {2: "success", 3: "success", 4: "success"}
    results: dict[int, Any] = {}

    async with connected(empty) as client, anyio.create_task_group() as tasks:

        async def call(goal: int) -> None:
            scenario = ROOM.replace("goal: [4, 3, 0]", f"goal: [{goal}, 3, 0]").replace("rover", f"rover_{goal}")
            results[goal] = await client.data("run_episode", scenario_yaml=scenario, seed=goal)

        for goal in goals:
            tasks.start_soon(call, goal)
    assert {goal: data["outcome"] for goal, data in results.items()} == goals
    assert all(data["robots"][0]["name"] == f"rover_{goal}" and data["seed"] == goal for goal, data in results.items())
