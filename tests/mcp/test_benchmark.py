"""``benchmark`` and ``get_job``: the table, episodes that failed, policies of the workspace."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import irsim
from irsim.lookup.topics import lookup
from irsim.policies.networks import save_network
from irsim.policies.registry import POLICIES
from irsim_mcp.services import RecentTexts
from tests.mcp.conftest import CRASH, ERAS, LONG, ROOM, Caller, data_of, error_of, text_of
from tests.policies.networks.examples import go_to_goal

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]

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
    "policies": ["dash", "rvo", "orca"],
    "seeds": 100,
    "wait_s": 0,
}
"""Short episodes for several seconds."""


@pytest.mark.parametrize("era", ERAS)
async def test_the_same_as_in_python(client: Caller, workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (workspace / "random.yaml").write_text(RANDOM)
    result = await client.call("benchmark", scenarios=["random.yaml", ROOM], policies=["dash", "rvo"], seeds=4)
    data = data_of(result)
    assert (data["status"], data["done"], data["total"]) == ("finished", 10, 10)
    monkeypatch.chdir(workspace)
    sources = {"random.yaml": "random.yaml", RecentTexts().remember(ROOM): ROOM}
    same = irsim.benchmark(sources, ["dash", "rvo"], 4, strict=True, limits=None)
    kept = json.loads((workspace / data["artifact"]).read_text())
    assert kept["episodes"] == json.loads(same.model_dump_json())["episodes"]
    assert [(row["scenario"], row["behavior"], row["episodes"]) for row in data["rows"]] == [
        (row.scenario, row.behavior, row.episodes) for row in same.rows
    ]
    first = same.rows[0]
    assert data["rows"][0]["success"] == [
        round(x, 3) for x in (first.success.rate, first.success.low, first.success.high)
    ]
    assert "diff" in data["rows"][1]
    assert any("nothing is random" in note for note in data["notes"])
    assert "reproduce" not in data  # no file has the text
    for row in data["rows"]:
        assert f"{row['success'][0]:g} [" in text_of(result)
    assert len(json.dumps(data)) < 6000
    assert (workspace / ".irsim" / ".gitignore").read_text() == "*\n"


async def test_other_seeds_and_the_episodes_that_failed(client: Caller, workspace: Path) -> None:
    long = "{name: dash, wander: false, loop: false}"
    arguments = {"scenarios": [RANDOM], "behaviors": ["dash", long], "seeds": 6, "first_seed": 1000}
    result = await client.call_tool("benchmark", arguments)
    more = (await client.data("get_job", job_id=data_of(result)["job_id"], detailed=True))["rows"][0]
    data = data_of(result)
    assert " of 6" in more["failed"]
    assert {"path_length", "spl", "min_clearance"} <= set(more)
    assert "reproduce" not in data  # which would need a file
    kept = json.loads((workspace / data["artifact"]).read_text())
    assert kept["seeds"] == list(range(1000, 1006))
    bad = [e["seed"] for e in kept["episodes"] if e["behavior"] == "dash" and e["outcome"] == "collision"]
    row, same = data["rows"]
    assert row["failed"].startswith(f"collision: seed{'s' * (len(bad) > 1)} {', '.join(map(str, bad))}")
    assert " of 6" not in row["failed"]  # which robots failed how is detailed
    assert "path_length" not in row
    assert same["behavior"] == "dash #2"
    assert data["notes"][0] == f"dash #2 is {long}"
    assert set(same["diff"]) >= {"success", "collision", "timeout"}
    assert same["diff"]["success"][0] == 0
    assert same["diff"]["success"][1] < 0 < same["diff"]["success"][2]
    told = text_of(result)
    assert told.count(long) == 1  # in the note
    assert row["failed"] in told
    assert f"seed={bad[0]} policy='dash' (collision)" in data["next"]


async def test_the_largest_seeds_can_be_run_again(client: Caller, workspace: Path) -> None:
    job = (await client.data("benchmark", scenarios=[RANDOM], seeds=2, first_seed=2**53 - 2))["job_id"]
    table = await client.data("inspect_run", run_id=job)
    assert sorted(row[2] for row in table["rows"]) == [2**53 - 2, 2**53 - 1]
    for row in table["rows"]:
        again = await client.data("run_episode", scenario_yaml=RANDOM, seed=row[2])
        assert (again["outcome"], again["steps"]) == (row[3], row[5])


async def test_means_of_fewer_episodes_say_so_and_the_period_is_told(client: Caller, workspace: Path) -> None:
    arguments = {"scenarios": [RANDOM], "behaviors": ["dash", "rvo"], "seeds": 10}
    result = await client.call_tool("benchmark", arguments)
    data, told = data_of(result), text_of(result)
    kept = json.loads((workspace / data["artifact"]).read_text())["rows"]
    assert kept[0]["metrics"]["time_to_goal"]["n"] < 10
    for row, all_of in zip(data["rows"], kept, strict=True):
        n = {key: all_of["metrics"][key]["n"] for key in row if key in all_of["metrics"]}
        assert row.get("n", {}) == {key: count for key, count in n.items() if count < 10}
    assert data["rows"][1]["diff"]["n"] == {"time_to_goal": kept[1]["paired"]["time_to_goal"]["n"]}
    assert f"] n={data['rows'][0]['n']['time_to_goal']};" in told
    assert f"] n={data['rows'][1]['diff']['n']['time_to_goal']}" in told
    assert "20 episodes, step_time 0.1 s; success" in told


async def test_times_beside_failures_are_those_of_robots_that_arrived(client: Caller, workspace: Path) -> None:
    two = ROOM + "  - {name: still, kinematics: {name: diff}, state: [6, 5, 0], goal: [7, 5, 0]}\n"
    told = await client.text("benchmark", scenarios=[two], seeds=1)
    whole = await client.text("benchmark", scenarios=[ROOM], seeds=1)
    assert "success 0; " in told
    assert "; time_to_goal of robots that arrived 3" in told
    assert "; time_to_goal 3" in whole
    assert "the mean of the robots that arrived" in lookup("time_to_goal").text


async def test_what_is_not_random_has_no_interval(client: Caller, workspace: Path) -> None:
    data = await client.data("benchmark", scenarios=[ROOM])
    assert [len(data["rows"][0][key]) for key in ("success", "collision", "timeout")] == [1, 1, 1]


async def test_limits(client: Caller, workspace: Path) -> None:
    for arguments, product in (
        ({"scenarios": [ROOM], "seeds": 101}, "1 scenarios x 1 policies x 101 seeds = 101 episodes"),
        ({"scenarios": [ROOM] * 21, "seeds": 1}, "21 scenarios x 1 policies x 1 seeds = 21 episodes"),
        ({"scenarios": [ROOM], "behaviors": list("abcdefghi")}, "1 scenarios x 9 policies x 10 seeds = 90 episodes"),
        ({"scenarios": [ROOM] * 20, "behaviors": list("abc"), "seeds": 100}, "= 6,000 episodes"),
    ):
        told = await client.error("benchmark", **arguments)
        assert told.startswith("over-limit: ")
        assert product in told
    for arguments, start in (
        ({"scenarios": []}, "bad-argument: there must be at least one scenario"),
        ({"scenarios": [ROOM], "seeds": 0}, "bad-argument: seeds must be at least 1, got 0"),
        (
            {"scenarios": [ROOM], "first_seed": 2**53 - 9},
            (
                f"bad-argument: 10 seeds from {2**53 - 9} on exceed {2**53 - 1}, the largest that "
                f"run_episode takes (first_seed). Fix: give at most {2**53 - 10}."
            ),
        ),
        ({"scenarios": [ROOM, ROOM]}, "bad-argument: the scenario 'text-"),
        ({"scenarios": ["../x.yaml"]}, "path-outside-workspace"),
        ({"scenarios": ["none.yaml"]}, "file-not-found"),
        ({"scenarios": ["#\n" * 200_000]}, "file-too-large"),
        ({"scenarios": [ROOM], "behaviors": ["rov"]}, "unknown-policy: there is no policy"),
        ({"scenarios": [ROOM.replace("goal", "gaol")]}, "invalid-scenario: 1 error: (text) robot[0].gaol"),
        ({"scenarios": [ROOM], "wait_s": 51}, "bad-argument: 51 is not accepted"),
        ({"scenarios": [ROOM], "seed": 3}, "unknown-argument: there is no argument 'seed'"),
    ):
        assert (await client.error("benchmark", **arguments)).startswith(start)


@pytest.mark.parametrize(
    ("behavior", "told"),
    [
        (
            "{name: orca, timeHorizn: 5}",
            "'timeHorizn' is not a key of behavior orca {}. Fix: rename it to 'timeHorizon'.",
        ),
        ("{name: orca, timeHorizon: -5}", "'timeHorizon' must be > 0 [s], got -5 {}. Fix: allowed is > 0 [s]."),
        ("{name: follow, planner: {name: astr}}", "planner.name: 'astr' is not a planner {}. Fix: name: astar."),
        ("orcaa", "there is no policy 'orcaa' {}. Fix: did you mean orca?"),
        ("{orca", "'{{orca' is not a policy {}. Fix: give a name such as orca, a file"),
    ],
)
async def test_a_wrong_behavior_is_told_by_its_argument_and_leaves_nothing(
    client: Caller, workspace: Path, behavior: str, told: str
) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    one = await client.call("run_episode", scenario_path="room.yaml", behavior=behavior)
    many = await client.call("benchmark", scenarios=["room.yaml"], behaviors=["dash", behavior])
    code = "unknown-policy" if behavior == "orcaa" else "bad-argument"
    assert error_of(one).startswith(f"{code}: " + told.format("(policy)"))
    assert error_of(many).startswith(f"{code}: " + told.format("(policies[1])"))
    assert [path for path in (workspace / ".irsim" / "jobs").iterdir() if path.name != ".clock"] == []


async def test_with_another_behavior_a_wrong_scenario_is_still_told_by_line(client: Caller, workspace: Path) -> None:
    wrong = {"scenario_yaml": ROOM.replace("goal:", "gaol:"), "behavior": "orca"}
    told = await client.error("run_episode", **wrong)
    assert "robot[0].gaol line 7 unknown-key" in told
    await client.error("benchmark", scenarios=[wrong["scenario_yaml"]], behaviors=["orca"])
    assert [path for path in (workspace / ".irsim" / "jobs").iterdir() if path.name != ".clock"] == []


async def test_episodes_are_read_by_inspect_run(client: Caller, workspace: Path) -> None:
    (workspace / "random.yaml").write_text(RANDOM, encoding="utf-8")
    long = "{name: orca, timeHorizon: 5, loop: false}"
    arguments = {"scenarios": [CRASH, "random.yaml", ROOM], "behaviors": ["dash", long], "seeds": 4, "max_steps": 90}
    result = await client.call_tool("benchmark", arguments)
    job = data_of(result)["job_id"]
    assert f"Episodes: inspect_run run_id={job}" in text_of(result)
    first = await client.call("inspect_run", run_id=job, limit=5)
    pages, cursor = [data_of(first)], data_of(first)["next_cursor"]
    while cursor is not None:
        pages.append(await client.data("inspect_run", run_id=job, limit=5, cursor=cursor))
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
    crash, room = RecentTexts().remember(CRASH), RecentTexts().remember(ROOM)
    assert f"{crash}, dash, 0, collision, 2.2, 22" in text_of(first)
    assert {row["scenario"] for row in rows} == {crash, "random.yaml", room}
    assert "rover: collision with 'crate'" in text_of(first)
    assert f"orca #2 is {long}" in text_of(first)
    call = f"run_episode scenario_path={crash!r} seed=0 policy='dash' max_steps=90"
    assert call in text_of(first)
    assert call in data_of(result)["next"]
    assert "cursor=5" in pages[0]["next"]
    assert "scenario_path='random.yaml'" in pages[-2]["next"] + pages[-1]["next"]


async def test_what_inspect_run_cannot_tell_of_a_benchmark(client: Caller, workspace: Path) -> None:
    job = (await client.data("benchmark", scenarios=[ROOM]))["job_id"]
    for asked, told in (
        ({"view": "closest"}, "(view). Fix: leave it out"),
        ({"robot": "rover"}, "(robot). Fix: leave it out"),
        ({"from_step": 3}, "(from_step). Fix: leave it out"),
        ({"cursor": "1"}, "'1' is not a valid cursor (cursor)"),
    ):
        assert told in await client.error("inspect_run", run_id=job, **asked)
    begun = (await client.data("benchmark", scenarios=[LONG], seeds=4, wait_s=0))["job_id"]
    told = await client.error("inspect_run", run_id=begun)
    assert f"{begun} is running, 0 of 4 episodes are done (run_id). Fix: get_job waits for it." in told
    await client.call("get_job", job_id=begun, cancel=True)
    told = await client.error("inspect_run", run_id=begun)
    assert "is cancelled" in told
    assert told.endswith("Fix: call benchmark again.")


async def test_a_note_tells_what_deciding_costs(client: Caller, workspace: Path) -> None:
    result = await client.call("benchmark", scenarios=[ROOM], policies=["orca", "random"], seeds=2)
    [note] = [
        note
        for note in data_of(result)["notes"]
        if note.startswith("deciding for one robot takes, in ms on this machine")
    ]
    for name in ("orca", "random"):
        mean, p95 = re.search(rf"{name} ([0-9.e-]+) \(([0-9.e-]+)\)", note).groups()
        assert 0 < float(mean) < 1000
        assert 0 < float(p95) < 1000
    assert note in text_of(result)


SCENE = ROOM.replace("omni", "diff")


async def test_a_network_of_the_workspace_is_compared_and_run(client: Caller, empty: Path) -> None:
    save_network(empty / "net.npz", go_to_goal())
    (empty / "scene.yaml").write_text(
        "world: {time_limit: 20}\n"
        "robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 3], behavior: {name: dash}}\n"
    )
    table = await client.data("benchmark", scenarios=["scene.yaml"], policies=["dash", "net.npz", "random"], seeds=2)
    one = await client.data("run_episode", scenario_path="scene.yaml", policy="net.npz")
    last = {"run_id": one["run_id"], "step": -1, "return_image": False}
    picture = await client.call_tool("render_snapshot", last)
    shares = {row["behavior"]: row["success"][0] for row in table["rows"]}
    assert shares == {"dash": 1.0, "net.npz": 1.0, "random": 0.0}
    assert (one["outcome"], one["behavior"]) == ("success", "net.npz")
    assert "--policy net.npz" in one["reproduce"]
    assert not picture.is_error


async def test_files_outside_and_plug_ins_are_refused(
    client: Caller, empty: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save_network(empty.parent / "outside.npz", go_to_goal())
    (empty / "link.npz").symlink_to(empty.parent / "outside.npz")
    (empty / "bad.npz").write_bytes(b"PK\x03\x04 nothing")
    monkeypatch.setattr(POLICIES, "_makers", {"plugged": go_to_goal})
    expected = {
        "../outside.npz": "path-outside-workspace",
        str(empty.parent / "outside.npz"): "path-outside-workspace",
        "link.npz": "path-outside-workspace",
        "gone.npz": "unknown-policy",
        "plugged": "unknown-policy",
        "bad.npz": "policy-file",
    }
    for policy, code in expected.items():
        for name, arguments in (
            ("run_episode", {"scenario_yaml": SCENE, "policy": policy}),
            ("benchmark", {"scenarios": [SCENE], "policies": [policy], "seeds": 1}),
        ):
            assert (await client.error(name, **arguments)).split(":")[0] == code, policy


async def test_two_names_of_one_argument_are_not_mixed(client: Caller) -> None:
    assert (await client.error("run_episode", scenario_yaml=ROOM, policy="dash", behavior="dash")).startswith(
        "bad-argument: policy and behavior are"
    )


@pytest.mark.parametrize("text", ["[]", "{}", '{"rows": 1}', '{"rows": [], "episodes": [1]}', '{"error": 3}', "null"])
async def test_files_of_a_job_that_others_changed_are_refused(client: Caller, workspace: Path, text: str) -> None:
    data = data_of(await client.call("benchmark", scenarios=[ROOM], policies=["dash"], seeds=2))
    result = workspace / data["artifact"]
    result.write_text(text)
    for name, words in (("get_job", {"job_id": data["job_id"]}), ("inspect_run", {"run_id": data["job_id"]})):
        answer = await client.call(name, **words)
        assert answer.is_error, name
        assert error_of(answer).startswith(("unreadable-run", "worker-failed", "bad-argument: job")), (
            name,
            error_of(answer),
        )
