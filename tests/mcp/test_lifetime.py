"""Processes: start, end of input, cancellation, a killed server, too many calls. Nothing is left behind."""

from __future__ import annotations

import json
import os
import re
import signal
import time
from pathlib import Path
from typing import Any

import anyio
import pytest

from tests.mcp.conftest import (
    ERAS,
    HANDSHAKE,
    LONG,
    ROOM,
    Caller,
    Wire,
    as_process,
    children_of,
    connected,
    error_of,
    linux,
    runs,
    wait_until_gone,
)

pytestmark = [pytest.mark.one_python, pytest.mark.usefixtures("ordinary_processes")]


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
