"""``benchmark`` and ``get_job``: the table, jobs that go on, jobs that end."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import anyio
import pytest
from mcp import Client

import irsim
from tests.mcp.conftest import CRASH, ERAS, LONG, ROOM, as_process, connected, data_of, error_of, text_of
from tests.warm import SERVERS

pytestmark = pytest.mark.anyio

RANDOM = """\
world: {width: 8, height: 8, time_limit: 12}
robot:
  - kinematics: {name: diff}
    number: 3
    distribution: {name: random, range_low: [1, 1, -3], range_high: [7, 7, 3]}
    shape: {name: circle, radius: 0.2}
    behavior: {name: dash}
    goal: [4, 4, 0]
"""

MANY = {
    "scenarios": [RANDOM.replace("12}", f"12, step_time: 0.01{digit}}}") for digit in range(6)],
    "behaviors": ["dash", "rvo", "orca"],
    "seeds": 100,
    "wait_s": 0,
}
"""Short episodes for several seconds."""


@pytest.mark.parametrize("era", ERAS)
async def test_the_same_as_in_python(workspace: Path, era: str, monkeypatch: pytest.MonkeyPatch) -> None:
    (workspace / "random.yaml").write_text(RANDOM)
    async with connected(workspace, era) as client:
        result = await client.call_tool(
            "benchmark", {"scenarios": ["random.yaml", ROOM], "behaviors": ["dash", "rvo"], "seeds": 4}
        )
    found = data_of(result)
    assert (found["status"], found["done"], found["total"]) == ("finished", 10, 10)
    monkeypatch.chdir(workspace)
    same = irsim.benchmark(["random.yaml", ROOM], ["dash", "rvo"], 4, strict=True, limits=None)
    kept = json.loads((workspace / found["artifact"]).read_text())
    assert kept["episodes"] == json.loads(same.model_dump_json())["episodes"]
    assert [(row["scenario"], row["behavior"], row["episodes"]) for row in found["rows"]] == [
        (row.scenario, row.behavior, row.episodes) for row in same.rows
    ]
    first = same.rows[0]
    assert found["rows"][0]["success"] == [
        round(x, 3) for x in (first.success.rate, first.success.low, first.success.high)
    ]
    assert "diff" in found["rows"][1]
    assert any("nothing is random" in note for note in found["notes"])
    assert found["reproduce"].startswith("irsim benchmark random.yaml scenario.yaml --behaviors dash,rvo")
    for row in found["rows"]:
        assert f"{row['success'][0]:g} [" in text_of(result)
    assert len(json.dumps(found)) < 6000
    assert (workspace / ".irsim" / ".gitignore").read_text() == "*\n"


async def test_other_seeds_and_the_episodes_that_failed(workspace: Path) -> None:
    long = "{name: dash, wander: false, loop: false}"
    arguments = {"scenarios": [RANDOM], "behaviors": ["dash", long], "seeds": 6, "first_seed": 1000}
    async with connected(workspace) as client:
        result = await client.call_tool("benchmark", arguments)
    found = data_of(result)
    assert "--seeds 1000-1005 " in found["reproduce"]
    kept = json.loads((workspace / found["artifact"]).read_text())
    assert kept["seeds"] == list(range(1000, 1006))
    bad = [e["seed"] for e in kept["episodes"] if e["behavior"] == "dash" and e["outcome"] == "collision"]
    row, same = found["rows"]
    assert row["failed"].startswith(f"collision: seed{'s' * (len(bad) > 1)} {', '.join(map(str, bad))}")
    assert " of 6" in row["failed"]
    assert same["behavior"] == "dash #2"
    assert found["notes"][0] == f"dash #2 is {long}"
    assert set(same["diff"]) >= {"success", "collision", "timeout"}
    assert same["diff"]["success"][0] == 0
    assert same["diff"]["success"][1] < 0 < same["diff"]["success"][2]
    told = text_of(result)
    assert told.count(long) == 2  # in the note, and in the command that repeats it
    assert row["failed"] in told
    assert f"seed={bad[0]} behavior='dash' (collision)" in found["next"]


async def test_the_largest_seeds_can_be_run_again(workspace: Path) -> None:
    async with connected(workspace) as client:
        asked = {"scenarios": [RANDOM], "seeds": 2, "first_seed": 2**53 - 2}
        job = data_of(await client.call_tool("benchmark", asked))["job_id"]
        table = data_of(await client.call_tool("inspect_run", {"run_id": job}))
        assert sorted(row[2] for row in table["rows"]) == [2**53 - 2, 2**53 - 1]
        for row in table["rows"]:
            again = data_of(await client.call_tool("run_episode", {"scenario_yaml": RANDOM, "seed": row[2]}))
            assert (again["outcome"], again["steps"]) == (row[3], row[5])


async def test_means_of_fewer_episodes_say_so_and_the_period_is_told(workspace: Path) -> None:
    arguments = {"scenarios": [RANDOM], "behaviors": ["dash", "rvo"], "seeds": 10}
    async with connected(workspace) as client:
        result = await client.call_tool("benchmark", arguments)
    found, told = data_of(result), text_of(result)
    kept = json.loads((workspace / found["artifact"]).read_text())["rows"]
    assert kept[0]["metrics"]["time_to_goal"]["n"] < 10
    for row, all_of in zip(found["rows"], kept, strict=True):
        n = {key: all_of["metrics"][key]["n"] for key in row if key in all_of["metrics"]}
        assert row.get("n", {}) == {key: count for key, count in n.items() if count < 10}
    assert found["rows"][1]["diff"]["n"] == {"time_to_goal": kept[1]["paired"]["time_to_goal"]["n"]}
    assert f"] n={found['rows'][0]['n']['time_to_goal']};" in told
    assert f"] n={found['rows'][1]['diff']['n']['time_to_goal']}" in told
    assert "20 episodes, step_time 0.1 s; success" in told


async def test_what_is_not_random_has_no_interval(workspace: Path) -> None:
    async with connected(workspace) as client:
        found = data_of(await client.call_tool("benchmark", {"scenarios": [ROOM]}))
    assert [len(found["rows"][0][key]) for key in ("success", "collision", "timeout")] == [1, 1, 1]


async def test_what_takes_longer_goes_on_as_a_job(workspace: Path) -> None:
    async with connected(workspace) as client:
        begun = data_of(await client.call_tool("benchmark", {"scenarios": [RANDOM], "seeds": 60, "wait_s": 0}))
        assert begun["status"] == "running"
        assert begun["next"] == f"get_job job_id={begun['job_id']}"
        found = data_of(await client.call_tool("get_job", {"job_id": begun["job_id"], "wait_s": 50}))
        assert (found["status"], found["done"]) == ("finished", 60)
        again = data_of(await client.call_tool("get_job", {"job_id": begun["job_id"]}))
        assert again == found


@pytest.mark.usefixtures("ordinary_processes")
async def test_a_job_that_is_cancelled_leaves_no_process(workspace: Path) -> None:
    async with connected(workspace) as client:
        begun = data_of(await client.call_tool("benchmark", {"scenarios": [LONG], "seeds": 4, "wait_s": 2}))
        assert begun["status"] == "running"
        assert descendants(os.getpid())
        ended = data_of(await client.call_tool("get_job", {"job_id": begun["job_id"], "cancel": True}))
        assert ended["status"] == "cancelled"
        assert "call benchmark again" in ended["next"]
        await gone(os.getpid())


async def test_a_job_that_is_cancelled_keeps_the_episodes_that_were_done(workspace: Path) -> None:
    async with connected(workspace) as client:
        asked = {"scenarios": [ROOM, LONG], "behaviors": ["as-written", "dash"], "seeds": 2, "wait_s": 0}
        job = data_of(await client.call_tool("benchmark", asked))["job_id"]
        with anyio.fail_after(30):
            while not kept_of(workspace, job):
                await anyio.sleep(0.1)
        result = await client.call_tool("get_job", {"job_id": job, "cancel": True})
        ended = data_of(result)
        assert ended["status"] == "cancelled"
        assert 0 < ended["done"] < ended["total"] == 6
        assert sum(row["episodes"] for row in ended["rows"]) == ended["done"]
        assert ended["rows"][0]["success"][0] == 1
        assert f"the {ended['done']} episodes that were done; call benchmark again for all" in ended["next"]
        assert text_of(result).startswith(f"cancelled: {ended['done']} episodes, ")
        table = data_of(await client.call_tool("inspect_run", {"run_id": job}))
        assert (table["status"], table["total"]) == ("cancelled", ended["done"])
        assert (workspace / ended["artifact"]).is_file()


async def test_cancelling_throws_no_episode_away(workspace: Path) -> None:
    async with connected(workspace) as client:
        job = data_of(await client.call_tool("benchmark", MANY))["job_id"]
        told = [await done_of(client, job, 30)]
        ended = data_of(await client.call_tool("get_job", {"job_id": job, "cancel": True}))
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
async def test_a_job_whose_process_is_killed_keeps_every_episode_and_says_so(workspace: Path) -> None:
    async with connected(workspace) as client:
        job = data_of(await client.call_tool("benchmark", MANY))["job_id"]
        told = await done_of(client, job, 30)
        for pid in descendants(os.getpid()):
            os.kill(pid, signal.SIGKILL)
        ended = data_of(await client.call_tool("get_job", {"job_id": job}))
        assert ended["status"] == "interrupted"
        assert told <= ended["done"] < 1800
        assert ended["next"].startswith("the process that did the work ended without a result. This is of the ")
        table = data_of(await client.call_tool("inspect_run", {"run_id": job, "limit": 5}))
        assert table["total"] == ended["done"]
        await gone(os.getpid())


async def test_a_job_that_fails_half_way_says_why_and_keeps_the_episodes_before(workspace: Path) -> None:
    crowd = RANDOM.replace("number: 3", "number: 9").replace("radius: 0.2", "radius: 0.37")
    crowd = crowd.replace("[1, 1, -3]", "[0.5, 0.5, -3]").replace("[7, 7, 3]", "[3.5, 3.5, 3]")
    async with connected(workspace) as client:
        ended = data_of(await client.call_tool("benchmark", {"scenarios": [crowd], "seeds": 60}))
    assert ended["status"] == "interrupted"
    assert 0 < ended["done"] == ended["rows"][0]["episodes"] < 60
    assert ended["next"].startswith("no room for 'robot_8' with seed ")
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


async def test_two_jobs_at_a_time(workspace: Path) -> None:
    async with connected(workspace) as client:
        jobs = [
            data_of(await client.call_tool("benchmark", {"scenarios": [LONG], "seeds": 2, "wait_s": 0}))["job_id"]
            for _ in range(2)
        ]
        told = error_of(await client.call_tool("benchmark", {"scenarios": [LONG], "wait_s": 0}))
        assert told.startswith("busy: 2 jobs are running")
        assert all(job in told for job in jobs)
        for job in jobs:
            await client.call_tool("get_job", {"job_id": job, "cancel": True})
        begun = data_of(await client.call_tool("benchmark", {"scenarios": [ROOM], "wait_s": 50}))
        assert begun["status"] == "finished"


async def test_limits(workspace: Path) -> None:
    async with connected(workspace) as client:
        for arguments, product in (
            ({"scenarios": [ROOM], "seeds": 101}, "1 scenarios x 1 behaviors x 101 seeds = 101 episodes"),
            ({"scenarios": [ROOM] * 21, "seeds": 1}, "21 scenarios x 1 behaviors x 1 seeds = 21 episodes"),
            ({"scenarios": [ROOM], "behaviors": list("abcdef")}, "1 scenarios x 6 behaviors x 10 seeds = 60 episodes"),
            ({"scenarios": [ROOM] * 20, "behaviors": list("abc"), "seeds": 100}, "= 6,000 episodes"),
        ):
            told = error_of(await client.call_tool("benchmark", arguments))
            assert told.startswith("over-limit: ")
            assert product in told
        for arguments, start in (
            ({"scenarios": []}, "bad-argument: there must be at least one scenario"),
            ({"scenarios": [ROOM], "seeds": 0}, "bad-argument: 0 seeds"),
            (
                {"scenarios": [ROOM], "first_seed": 2**53 - 9},
                (
                    f"bad-argument: the seeds {2**53 - 9} to {2**53} exceed {2**53 - 1}, the largest that "
                    f"run_episode takes (first_seed). Fix: give at most {2**53 - 10}."
                ),
            ),
            ({"scenarios": ["../x.yaml"]}, "path-outside-workspace"),
            ({"scenarios": ["none.yaml"]}, "file-not-found"),
            ({"scenarios": ["#\n" * 200_000]}, "file-too-large"),
            ({"scenarios": [ROOM], "behaviors": ["rov"]}, "bad-argument: there is no behavior"),
            ({"scenarios": [ROOM.replace("goal", "gaol")]}, "invalid-scenario: 1 error: (text) robot[0].gaol"),
            ({"scenarios": [ROOM], "wait_s": 51}, "bad-argument: 51 is not accepted"),
            ({"scenarios": [ROOM], "seed": 3}, "unknown-argument: there is no argument 'seed'"),
        ):
            assert error_of(await client.call_tool("benchmark", arguments)).startswith(start)


@pytest.mark.parametrize(
    ("behavior", "told"),
    [
        (
            "{name: orca, timeHorizn: 5}",
            "'timeHorizn' is not a key of behavior orca {}. Fix: rename it to 'timeHorizon'.",
        ),
        ("{name: orca, timeHorizon: -5}", "'timeHorizon' must be > 0 [s], got -5 {}. Fix: allowed is > 0 [s]."),
        ("{name: follow, planner: {name: astr}}", "planner.name: 'astr' is not a planner {}. Fix: name: astar."),
        ("orcaa", "there is no behavior 'orcaa' {}. Fix: did you mean orca?"),
        ("{orca", "'{{orca' is not a valid behavior {}. Fix: give a name such as orca, or "),
    ],
)
async def test_a_wrong_behavior_is_told_by_its_argument_and_leaves_nothing(
    workspace: Path, behavior: str, told: str
) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    async with connected(workspace) as client:
        one = await client.call_tool("run_episode", {"scenario_path": "room.yaml", "behavior": behavior})
        many = await client.call_tool("benchmark", {"scenarios": ["room.yaml"], "behaviors": ["dash", behavior]})
    assert error_of(one).startswith("bad-argument: " + told.format("(behavior)"))
    assert error_of(many).startswith("bad-argument: " + told.format("(behaviors[1])"))
    assert list((workspace / ".irsim" / "jobs").iterdir()) == []


async def test_with_another_behavior_a_wrong_scenario_is_still_told_by_line(workspace: Path) -> None:
    async with connected(workspace) as client:
        wrong = {"scenario_yaml": ROOM.replace("goal:", "gaol:"), "behavior": "orca"}
        told = error_of(await client.call_tool("run_episode", wrong))
        assert "robot[0].gaol line 7 unknown-key" in told
        error_of(await client.call_tool("benchmark", {"scenarios": [wrong["scenario_yaml"]], "behaviors": ["orca"]}))
    assert list((workspace / ".irsim" / "jobs").iterdir()) == []


async def test_episodes_are_read_by_inspect_run(workspace: Path) -> None:
    (workspace / "random.yaml").write_text(RANDOM, encoding="utf-8")
    long = "{name: orca, timeHorizon: 5, loop: false}"
    arguments = {"scenarios": [CRASH, "random.yaml", ROOM], "behaviors": ["dash", long], "seeds": 4, "max_steps": 90}
    async with connected(workspace) as client:
        result = await client.call_tool("benchmark", arguments)
        job = data_of(result)["job_id"]
        assert f"Episodes: inspect_run run_id={job}" in text_of(result)
        first = await client.call_tool("inspect_run", {"run_id": job, "limit": 5})
        pages, cursor = [data_of(first)], data_of(first)["next_cursor"]
        while cursor is not None:
            more = {"run_id": job, "limit": 5, "cursor": cursor}
            pages.append(data_of(await client.call_tool("inspect_run", more)))
            cursor = pages[-1]["next_cursor"]
    kept = json.loads((workspace / data_of(result)["artifact"]).read_text())["episodes"]
    rows = [dict(zip(page["columns"], row, strict=True)) for page in pages for row in page["rows"]]
    assert len(rows) == pages[0]["total"] == len(kept) == 12
    told = {(row["scenario"], row["behavior"], row["seed"]): row for row in rows}
    for episode in kept:
        row = told[episode["scenario"], {long: "orca #2"}.get(episode["behavior"], "dash"), episode["seed"]]
        assert (row["outcome"], row["steps"]) == (episode["outcome"], episode["steps"])
        assert all(name in row["failed"] for name in episode["failures"])
    ends = [row["outcome"] == "success" for row in rows]
    assert ends == sorted(ends)
    assert "(text 1), dash, 0, collision, 2.2, 22" in text_of(first)
    assert "rover: collision with 'crate'" in text_of(first)
    assert f"orca #2 is {long}" in text_of(first)
    call = "run_episode scenario_yaml=<text 1 of scenarios> seed=0 behavior='dash' max_steps=90"
    assert call in text_of(first)
    assert call in data_of(result)["next"]
    assert "cursor=5" in pages[0]["next"]
    assert "scenario_path='random.yaml'" in pages[-2]["next"] + pages[-1]["next"]


async def test_what_inspect_run_cannot_tell_of_a_benchmark(workspace: Path) -> None:
    async with connected(workspace) as client:
        job = data_of(await client.call_tool("benchmark", {"scenarios": [ROOM]}))["job_id"]
        for asked, told in (
            ({"view": "closest"}, "(view). Fix: leave it out"),
            ({"robot": "rover"}, "(robot). Fix: leave it out"),
            ({"from_step": 3}, "(from_step). Fix: leave it out"),
            ({"cursor": "1"}, "'1' is not a valid cursor (cursor)"),
        ):
            assert told in error_of(await client.call_tool("inspect_run", {"run_id": job, **asked}))
        begun = data_of(await client.call_tool("benchmark", {"scenarios": [LONG], "seeds": 4, "wait_s": 0}))["job_id"]
        told = error_of(await client.call_tool("inspect_run", {"run_id": begun}))
        assert f"{begun} is running, 0 of 4 episodes are done (run_id). Fix: get_job waits for it." in told
        await client.call_tool("get_job", {"job_id": begun, "cancel": True})
        told = error_of(await client.call_tool("inspect_run", {"run_id": begun}))
        assert "is cancelled" in told
        assert told.endswith("Fix: call benchmark again.")


async def test_jobs_that_are_not_there(workspace: Path) -> None:
    async with connected(workspace) as client:
        assert error_of(await client.call_tool("get_job", {"job_id": "benchmark-123456"})).startswith("unknown-job")
        done = data_of(await client.call_tool("benchmark", {"scenarios": [CRASH]}))
        told = error_of(await client.call_tool("get_job", {"job_id": "../../etc"}))
        assert f"recent ones are {done['job_id']}" in told


@pytest.mark.parametrize("link", [".irsim", ".irsim/jobs"])
async def test_links_are_not_followed(workspace: Path, tmp_path: Path, link: str) -> None:
    (tmp_path / "elsewhere").mkdir()
    (workspace / link).parent.mkdir(exist_ok=True)
    (workspace / link).symlink_to(tmp_path / "elsewhere")
    async with connected(workspace) as client:
        told = error_of(await client.call_tool("benchmark", {"scenarios": [ROOM]}))
    assert told.startswith("path-outside-workspace")
    assert not list((tmp_path / "elsewhere").iterdir())


@pytest.mark.skipif(os.name != "posix", reason="signals")
@pytest.mark.usefixtures("ordinary_processes")
@pytest.mark.parametrize("how", ["end of input", "kill -9"])
@pytest.mark.parametrize("world", ["long", "short"])
async def test_a_server_that_ends_leaves_no_process_and_all_that_was_done(
    workspace: Path, how: str, world: str
) -> None:
    command = as_process(workspace)
    server = subprocess.Popen([command.command, *command.args], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    try:
        asked = {"scenarios": [LONG], "seeds": 4, "wait_s": 0} if world == "long" else MANY
        call = {"name": "benchmark", "arguments": asked}
        hello = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "t", "version": "0"}}
        for message in (
            {"id": 1, "method": "initialize", "params": hello},
            {"method": "notifications/initialized"},
            {"id": 2, "method": "tools/call", "params": call},
        ):
            server.stdin.write(json.dumps({"jsonrpc": "2.0", **message}).encode() + b"\n")
        server.stdin.flush()
        answers = [json.loads(server.stdout.readline()) for _ in range(2)]
        job = answers[1]["result"]["structuredContent"]["job_id"]
        until = time.monotonic() + 10
        while not descendants(server.pid) and time.monotonic() < until:
            await anyio.sleep(0.1)
        if world == "long":
            await anyio.sleep(2.0)
        else:
            with anyio.fail_after(30):
                while not kept_of(workspace, job):
                    await anyio.sleep(0.05)
        children = descendants(server.pid)
        assert children
        told = kept_of(workspace, job)
        if how == "kill -9":
            server.send_signal(signal.SIGKILL)
        else:
            server.stdin.close()
        server.wait(10)
        until = time.monotonic() + 5
        while any(alive(child) for child in children) and time.monotonic() < until:
            await anyio.sleep(0.1)
        assert not [child for child in children if alive(child)]
    finally:
        server.kill()
        server.wait()
        server.stdout.close()
        if not server.stdin.closed:
            server.stdin.close()
    async with Client(as_process(workspace)) as client:
        ended = data_of(await client.call_tool("get_job", {"job_id": job}))
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
            done = int(data_of(await client.call_tool("get_job", {"job_id": job, "wait_s": 0}))["done"])
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
    found, level = [], [pid]
    while level:
        level = [child for child, parent in parents.items() if parent in level and child not in SERVERS]
        found += level
    return found


def alive(pid: int) -> bool:
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


async def gone(pid: int) -> None:
    until = time.monotonic() + 5
    while descendants(pid) and time.monotonic() < until:
        await anyio.sleep(0.1)
    assert not descendants(pid)
