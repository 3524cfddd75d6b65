"""Jobs of ``benchmark``: they go on, are cancelled, fail, end with the server, and leave no process."""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path

import anyio
import pytest
from mcp import Client

import irsim
from tests.mcp.conftest import CRASH, LONG, ROOM, Caller, Wire, as_process, connected, data_of, text_of
from tests.mcp.test_benchmark import MANY, RANDOM
from tests.processes import wait_until_gone
from tests.warm import SERVERS

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]


async def test_what_takes_longer_goes_on_as_a_job(client: Caller, workspace: Path) -> None:
    begun = await client.data("benchmark", scenarios=[RANDOM], seeds=60, wait_s=0)
    assert begun["status"] == "running"
    assert begun["next"] == f"get_job job_id={begun['job_id']}"
    ended = await client.data("get_job", job_id=begun["job_id"], wait_s=50)
    assert (ended["status"], ended["done"]) == ("finished", 60)
    again = await client.data("get_job", job_id=begun["job_id"])
    assert again == ended


@pytest.mark.slow
@pytest.mark.usefixtures("ordinary_processes")
async def test_a_job_that_is_cancelled_leaves_no_process(client: Caller, workspace: Path) -> None:
    others = set(descendants(os.getpid()))
    begun = await client.data("benchmark", scenarios=[LONG], seeds=4, wait_s=2)
    assert begun["status"] == "running"
    started = set(descendants(os.getpid())) - others
    assert started
    ended = await client.data("get_job", job_id=begun["job_id"], cancel=True)
    assert ended["status"] == "cancelled"
    assert "call benchmark again" in ended["next"]
    started |= set(descendants(os.getpid())) - others
    await anyio.to_thread.run_sync(wait_until_gone, sorted(started), 5)


async def test_a_job_that_is_cancelled_keeps_the_episodes_that_were_done(client: Caller, workspace: Path) -> None:
    asked = {"scenarios": [ROOM, LONG], "behaviors": ["as-written", "dash"], "seeds": 2}
    job = (await client.data("benchmark", **asked, wait_s=0))["job_id"]
    with anyio.fail_after(30):
        while not kept_of(workspace, job):
            await anyio.sleep(0.1)
    result = await client.call("get_job", job_id=job, cancel=True)
    ended = data_of(result)
    assert ended["status"] == "cancelled"
    assert 0 < ended["done"] < ended["total"] == 6
    assert sum(row["episodes"] for row in ended["rows"]) == ended["done"]
    assert ended["rows"][0]["success"][0] == 1
    assert f"the {ended['done']} completed episodes; call benchmark again for all" in ended["next"]
    assert text_of(result).startswith(f"cancelled: {ended['done']} episodes, ")
    table = await client.data("inspect_run", run_id=job)
    assert (table["status"], table["total"]) == ("cancelled", ended["done"])
    assert (workspace / ended["artifact"]).is_file()


async def test_cancelling_throws_no_episode_away(client: Caller, workspace: Path) -> None:
    job = (await client.data("benchmark", **MANY))["job_id"]
    told = [await done_of(client, job, 30)]
    ended = await client.data("get_job", job_id=job, cancel=True)
    told.append(ended["done"])
    told.append(await done_of(client, job))
    assert ended["status"] == "cancelled"
    assert told == sorted(told)
    assert told[1] == told[2]
    assert sum(row["episodes"] for row in ended["rows"]) == ended["done"] < ended["total"] == 1800
    kept = json.loads((workspace / ended["artifact"]).read_text())["episodes"]
    whole = irsim.benchmark(MANY["scenarios"][0], "dash", 3)
    assert [one["metrics"] for one in kept[:3]] == [one.metrics for one in whole.episodes]


@pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")
@pytest.mark.usefixtures("ordinary_processes")
async def test_a_job_whose_process_is_killed_keeps_every_episode_and_says_so(client: Caller, workspace: Path) -> None:
    job = (await client.data("benchmark", **MANY))["job_id"]
    told = await done_of(client, job, 30)
    for pid in descendants(os.getpid()):
        os.kill(pid, signal.SIGKILL)
    ended = await client.data("get_job", job_id=job)
    assert ended["status"] == "interrupted"
    assert told <= ended["done"] < 1800
    assert ended["next"].startswith("the process that did the work ended without a result. This is the result of the ")
    table = await client.data("inspect_run", run_id=job, limit=5)
    assert table["total"] == ended["done"]
    await gone(os.getpid())


async def test_a_job_that_fails_half_way_says_why_and_keeps_the_episodes_before(workspace: Path) -> None:
    larger = RANDOM.replace("number: 3", "number: 6")
    async with connected(workspace, work=200) as client:
        ended = await client.data("benchmark", scenarios=[RANDOM, larger], seeds=4, max_steps=60)
    assert ended["status"] == "interrupted"
    assert ended["done"] == ended["rows"][0]["episodes"] == 4
    assert ended["next"].startswith("60 steps are too many: at most 200 steps x objects are run at once")
    assert "fewer seeds" not in ended["next"]


@pytest.mark.slow
async def test_a_job_whose_time_is_over_keeps_the_episodes_that_were_done(workspace: Path) -> None:
    async with connected(workspace, job_seconds=12) as client:
        asked = {"scenarios": [ROOM, LONG], "behaviors": ["as-written", "dash"], "seeds": 2, "wait_s": 50}
        result = await client.call_tool("benchmark", asked)
        ended = data_of(result)
        assert ended["status"] == "interrupted"
        assert 0 < ended["done"] < ended["total"]
        assert ended["next"].startswith("12 s of computing time were used up. This is the result of the ")
        assert sum(row["episodes"] for row in ended["rows"]) == ended["done"]


async def test_two_jobs_at_a_time(client: Caller, workspace: Path) -> None:
    jobs = [(await client.data("benchmark", scenarios=[LONG], seeds=2, wait_s=0))["job_id"] for _ in range(2)]
    told = await client.error("benchmark", scenarios=[LONG], wait_s=0)
    assert told.startswith("busy: 2 jobs are running")
    assert all(job in told for job in jobs)
    for job in jobs:
        await client.call("get_job", job_id=job, cancel=True)
    begun = await client.data("benchmark", scenarios=[ROOM], wait_s=50)
    assert begun["status"] == "finished"


async def test_jobs_that_are_not_there(client: Caller, workspace: Path) -> None:
    assert (await client.error("get_job", job_id="benchmark-123456")).startswith("unknown-job")
    done = await client.data("benchmark", scenarios=[CRASH])
    told = await client.error("get_job", job_id="../../etc")
    assert f"recent ones are {done['job_id']}" in told


@pytest.mark.parametrize("link", [".irsim", ".irsim/jobs"])
async def test_links_are_not_followed(client: Caller, workspace: Path, tmp_path: Path, link: str) -> None:
    (tmp_path / "elsewhere").mkdir()
    (workspace / link).parent.mkdir(exist_ok=True)
    (workspace / link).symlink_to(tmp_path / "elsewhere")
    told = await client.error("benchmark", scenarios=[ROOM])
    assert told.startswith("path-outside-workspace")
    assert not list((tmp_path / "elsewhere").iterdir())


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.usefixtures("ordinary_processes")
@pytest.mark.parametrize(
    ("world", "how"),
    [
        ("short", "end of input"),
        pytest.param("short", "kill -9", marks=pytest.mark.slow),
        pytest.param("long", "end of input", marks=pytest.mark.slow),
        pytest.param("long", "kill -9", marks=pytest.mark.slow),
    ],
)
async def test_a_server_that_ends_leaves_no_process_and_all_that_was_done(
    wire: Wire, workspace: Path, how: str, world: str
) -> None:
    wire.call("benchmark", **({"scenarios": [LONG], "seeds": 4, "wait_s": 0} if world == "long" else MANY))
    job = wire.receive()["result"]["structuredContent"]["job_id"]
    with anyio.fail_after(30):
        while not descendants(wire.process.pid) or (world == "short" and not kept_of(workspace, job)):
            await anyio.sleep(0.05)
    if world == "long":
        await anyio.sleep(2.0)
    children, told = descendants(wire.process.pid), kept_of(workspace, job)
    assert children
    if how == "kill -9":
        wire.process.kill()
    else:
        assert wire.process.stdin is not None
        wire.process.stdin.close()
    wire.process.wait(30)  # a busy machine ends it late
    await anyio.to_thread.run_sync(wait_until_gone, children, 20)
    async with Caller(as_process(workspace)) as client:
        ended = await client.data("get_job", job_id=job)
    assert ended["status"] == "interrupted"
    assert (world == "short") == (told > 0)
    assert told <= ended["done"] < ended["total"]
    assert sum(row["episodes"] for row in ended["rows"]) == ended["done"]


def kept_of(workspace: Path, job: str) -> int:
    """Episodes that a job has done so far, as its files say it."""
    return int(json.loads((workspace / ".irsim" / "jobs" / job / "run.json").read_text())["done"])


async def done_of(client: Client, job: str, least: int = 0) -> int:
    """Episodes that a job has done, as the server says it, once there are some."""
    with anyio.fail_after(30):
        while True:
            done = int((await client.data("get_job", job_id=job, wait_s=0))["done"])
            if done >= least:
                return done
            await anyio.sleep(0.05)


def descendants(pid: int) -> list[int]:
    """Processes below one that are at work."""
    if not sys.platform.startswith("linux"):
        pytest.skip("needs /proc")
    parents = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if fields[0] != "Z":
                parents[int(entry.name)] = int(fields[1])
    processes, level = [], [pid]
    while level:
        level = [child for child, parent in parents.items() if parent in level and child not in SERVERS]
        processes += level
    return processes


async def gone(pid: int) -> None:
    await anyio.to_thread.run_sync(wait_until_gone, descendants(pid), 5)
    assert not descendants(pid)
