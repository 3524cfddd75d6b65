"""Many servers on one workspace, many clients of one server: every answer belongs to its call; busy ones try again."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import anyio
import pytest
from mcp import Client

from irsim.runs import list_runs
from tests.mcp.conftest import ROOM, Caller, as_process, data_of, text_of
from tests.mcp.test_http import served

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]


async def patiently(client: Client, name: str, arguments: dict[str, Any]) -> Any:
    """The result of a call, asked for again as long as others are at work."""
    while True:
        result = await client.call_tool(name, arguments)
        if not (result.is_error and text_of(result).startswith("busy: ")):
            return result
        await anyio.sleep(0.3)


async def talk(client: Client, who: int, calls: int, runs: list[str]) -> None:
    """Calls of all kinds, each with an answer that only this one can get."""
    rng = random.Random(who)
    mine = ROOM.replace("rover", f"rover_{who}")
    last: str | None = None
    for number in range(calls):
        kind = rng.choice(("validate", "run", "run", "inspect", "lookup", "broken", "render", "benchmark"))
        if kind == "run" or (kind in ("inspect", "render") and last is None):
            seed = 1000 * who + number
            run = data_of(await patiently(client, "run_episode", {"scenario_yaml": mine, "seed": seed}))
            assert (run["seed"], run["robots"][0]["name"], run["outcome"]) == (seed, f"rover_{who}", "success")
            last = run["run_id"]
            runs.append(last)
        elif kind == "validate":
            assert data_of(await patiently(client, "validate_scenario", {"scenario_yaml": mine}))["valid"]
        elif kind == "broken":
            wrong = mine.replace("radius", f"radius_{who}")
            told = data_of(await patiently(client, "validate_scenario", {"scenario_yaml": wrong}))
            assert f"radius_{who}" in str(told["issues"])
        elif kind == "lookup":
            assert not (await patiently(client, "lookup", {"topic": "crossing"})).is_error
        elif kind == "render":
            assert not (await patiently(client, "render_snapshot", {"run_id": last, "step": -1})).is_error
        elif kind == "inspect":
            assert f"rover_{who}" in text_of(await patiently(client, "inspect_run", {"run_id": last}))
        else:
            arguments = {"scenarios": [mine], "seeds": 2, "wait_s": 50}
            assert data_of(await patiently(client, "benchmark", arguments))["status"] == "finished"
    assert (await client.error("inspect_run", run_id="no-000000")).startswith("unknown-run")


async def servers(workspace: Path, count: int, calls: int, url: str | None = None) -> None:
    """So many servers, one client each; or as many clients of the server at an address."""
    runs: list[str] = []

    async def serve(who: int) -> None:
        async with Caller(url or as_process(workspace)) as client:
            await talk(client, who, calls, runs)

    async with anyio.create_task_group() as tasks:
        for who in range(count):
            tasks.start_soon(serve, who)
    kept = {run.id: run for run in list_runs(workspace)}
    assert set(runs) == set(kept)
    assert {run.status for run in kept.values()} == {"finished"}
    assert list((workspace / ".irsim").rglob(".new-*")) == []


async def test_three_servers(workspace: Path) -> None:
    await servers(workspace, 3, 4)


@pytest.mark.slow(110)
async def test_eight_servers(workspace: Path) -> None:
    await servers(workspace, 8, 50)


async def test_three_clients(workspace: Path) -> None:
    with served(workspace, "--http", "0") as (url, _):
        await servers(workspace, 3, 4, url)


@pytest.mark.slow(110)
async def test_eight_clients(workspace: Path) -> None:
    with served(workspace, "--http", "0") as (url, _):
        await servers(workspace, 8, 50, url)
