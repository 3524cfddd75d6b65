"""Processes: start, end of input, cancellation, a kill at any moment, too many calls. Nothing is left behind."""

from __future__ import annotations

import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import anyio
import numpy as np
import pytest

import irsim
from irsim.runs import list_runs, open_run
from irsim.runs.store import prune, runs_folder
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
)
from tests.processes import runs, wait_until_gone

pytestmark = [pytest.mark.one_python, pytest.mark.usefixtures("ordinary_processes")]


@linux
def test_end_of_input_ends_server_and_worker(wire: Wire, workspace: Path) -> None:
    workers = wire.start_long_run()
    assert len(workers) == 1
    assert wire.process.stdin is not None
    wire.process.stdin.close()
    wait_until_gone([*workers, wire.process.pid], 8)
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


ENDLESS = "threading.Event().wait()"
NOISY = "print('from Python') or os.write(1, b'from a library') and '[1]'"


def start(folder: Path, work: str) -> subprocess.Popen[bytes]:
    """A worker whose task evaluates an expression."""
    code = (
        f"import os, threading\nfrom irsim_mcp import job\njob._TASKS['x'] = lambda job, progress: {work}\njob.main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    resources = {"memory": 10**10, "cpu": 60, "written": 10**6}
    where = {"path": str(folder), "descriptor": None}
    line = json.dumps({"task": "x", "workspace": where, "resources": resources, "limits": {}})
    assert process.stdin is not None
    process.stdin.write(line.encode() + b"\n")
    process.stdin.flush()
    return process


def test_what_libraries_print_does_not_mix_with_the_answer(tmp_path: Path) -> None:
    with start(tmp_path, NOISY) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.read() == b'{"result": [1]}\n'
        assert b"from a library" in process.stderr.read()


@pytest.mark.parametrize("work", [ENDLESS, "exec('while True: pass')"])
def test_it_ends_when_its_input_is_closed(tmp_path: Path, work: str) -> None:
    with start(tmp_path, work) as process:
        assert process.stdin is not None
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.5)
        process.stdin.close()
        try:
            assert process.wait(20) == 1
        finally:
            process.kill()


CALM = ROOM.replace("goal: [4, 3, 0]", "goal: [7, 5, 0]").replace("height: 6", "height: 6, step_time: 0.005")


def one_life(workspace: Path, rng: random.Random) -> list[str]:
    """A server at work that is, or whose worker is, killed at a random moment; the runs it has told of."""
    wire, told = Wire(workspace), list[str]()
    try:
        for number in range(1, 4):
            wire.call("run_episode", number, scenario_yaml=CALM, seed=number)
            if number > rng.randint(0, 2):
                break
            told.append(wire.receive()["result"]["structuredContent"]["run_id"])
        time.sleep(rng.uniform(0.0, 1.6))
        workers = children_of(wire.process.pid)
        if workers and rng.random() < 0.4:
            os.kill(workers[0], signal.SIGKILL)
            answer = wire.receive()["result"]
            text = answer["content"][0]["text"]
            if answer.get("isError"):
                assert text.startswith("worker-failed: ")
                assert "Traceback" not in text
            else:  # it had just answered
                told.append(answer["structuredContent"]["run_id"])
        wire.process.kill()
        wait_until_gone([*workers, wire.process.pid], 5)
    finally:
        wire.close()
    return told


def check_files(workspace: Path) -> None:
    """Whatever has a name of its own is whole."""
    runs = runs_folder(workspace)
    for path in runs.rglob("*"):
        if path.name.startswith(".new-") or path.is_dir():
            continue
        if path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        elif path.suffix == ".npz":
            with np.load(path) as file:
                assert all(file[name] is not None for name in file.files)


def live_and_die(workspace: Path, seed: int, lives: int) -> None:
    rng, told = random.Random(seed), list[str]()
    for _ in range(lives):
        told += one_life(workspace, rng)
        check_files(workspace)
        for run_id in told:
            run = open_run(run_id, workspace)
            assert run.status == "finished"
            assert run.result is not None
            assert run.trace().step[-1] == run.result.steps
    assert {run.status for run in list_runs(workspace)} <= {"finished", "interrupted"}
    later = time.time() - 120
    for path in runs_folder(workspace).rglob("*"):
        os.utime(path, (later, later))
    prune(runs_folder(workspace))
    assert list((workspace / ".irsim").rglob(".new-*")) == []
    assert all((path / "run.json").is_file() for path in runs_folder(workspace, make=True).iterdir() if path.is_dir())
    assert irsim.run(text=ROOM, seed=1).outcome == "success"


@linux
@pytest.mark.slow
def test_killed_twice(workspace: Path) -> None:
    live_and_die(workspace, 1, 2)


@linux
@pytest.mark.slow(40)
def test_killed_over_and_over(workspace: Path) -> None:
    live_and_die(workspace, 2, 15)
