"""Server or worker killed at any moment: finished runs stay, what is there can be read, no process is left."""

from __future__ import annotations

import json
import os
import random
import signal
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim.runs import list_runs, open_run
from irsim.runs.store import prune, runs_folder
from tests.mcp.conftest import ROOM, Wire, children_of, wait_until_gone

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc"),
    pytest.mark.usefixtures("ordinary_processes"),
]

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


@pytest.mark.slow
def test_killed_twice(workspace: Path) -> None:
    live_and_die(workspace, 1, 2)


@pytest.mark.slow(40)
def test_killed_over_and_over(workspace: Path) -> None:
    live_and_die(workspace, 2, 15)
